//! How alike the surroundings of pixels are: non-local means (A. Buades, B. Coll and J.-M. Morel, "A review of image denoising
//! algorithms, with a new one", 2005), with the distances for noise that differs from pixel to pixel (F. Rousselle, C. Knaus
//! and M. Zwicker, "Adaptive rendering with non-local means filtering", 2012, section 4).

use super::planes::{Cut, LANES, Lane, Planes, Tile, vectorized};
use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch, f32x16};
use rayon::prelude::*;

/// Which pixels are compared, and how strictly.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kernel {
    /// Pixels to every side of one that are compared to it.
    pub(super) radius: usize,
    /// Pixels to every side of both that are looked at.
    pub(super) patch: usize,
    /// How many times the noise two pixels may differ by.
    pub(super) bandwidth: f32,
    /// Pixels to every side among which each one counts; of those farther away, every other one.
    pub(super) dense: usize,
}

impl Kernel {
    /// The places around a pixel that are compared to it, as columns and rows from the top left of their square.
    pub(super) fn places(&self) -> Vec<[usize; 2]> {
        let side = 2 * self.radius + 1;
        let all = (0..side * side).map(|index| [index % side, index / side]);
        let counts = |[x, y]: &[usize; 2]| {
            let distance = x.abs_diff(self.radius).max(y.abs_diff(self.radius));
            // Not as on a chessboard: then its black fields would know nothing of the white ones.
            distance <= self.dense || (x + y / 2) % 2 == 0
        };
        all.filter(counts).collect()
    }
}

/// A picture that tells which pixels are alike.
pub(super) struct Guide<'g> {
    /// What it shows.
    pub(super) values: &'g Planes,
    /// The variance of each of its numbers.
    pub(super) variances: &'g Planes,
}

/// The weight of every pixel around each one of a tile, from 0 to 1.
pub(super) struct Weights {
    /// The places, as [`Kernel::places`] has them.
    places: Vec<[usize; 2]>,
    /// For some pixels of a row after the others, those of all places.
    values: Vec<Lane>,
}

impl Weights {
    /// Compares the pixels of a tile. Those beyond the picture weigh nothing.
    pub(super) fn of(guide: &Guide, tile: &Tile, kernel: &Kernel) -> Weights {
        let mut distances = Distances::new(guide, tile, kernel);
        let (places, area) = (kernel.places(), tile.padded() * tile.height);
        let mut values = vec![[0.0; LANES]; places.len() * area / LANES];
        let mut weights = vec![0.0; area];
        for (index, place) in places.iter().enumerate() {
            dispatch!(Level::new(), simd => simd.vectorize(
                #[inline(always)]
                || distances.weigh(simd, *place, &mut weights),
            ));
            clear_outside(&mut weights, tile, kernel, guide.values.size, *place);
            let lanes = weights.as_chunks().0.iter();
            lanes.zip(values[index..].iter_mut().step_by(places.len())).for_each(|(lane, to)| *to = *lane);
        }
        Weights { places, values }
    }

    /// The places with the weights that the pixels from this one on have for them; its column is one where lanes begin.
    #[inline(always)]
    pub(super) fn around(
        &self,
        tile: &Tile,
        [x, y]: [usize; 2],
    ) -> impl Iterator<Item = ([usize; 2], &Lane)> {
        let start = (y * tile.padded() + x) / LANES * self.places.len();
        self.places.iter().copied().zip(&self.values[start..])
    }
}

/// Zeroes what has no pixel at one of both ends.
fn clear_outside(values: &mut [f32], tile: &Tile, kernel: &Kernel, size: [usize; 2], [dx, dy]: [usize; 2]) {
    let far_inside =
        |at: usize, length: usize, whole: usize| at >= kernel.radius && at + length + kernel.radius <= whole;
    if far_inside(tile.x, tile.padded(), size[0]) && far_inside(tile.y, tile.height, size[1]) {
        return;
    }
    let inside = |at: usize, offset: usize, length: usize| {
        (at + offset).checked_sub(kernel.radius).is_some_and(|there| there < length)
    };
    for (y, row) in values.chunks_exact_mut(tile.padded()).enumerate() {
        let row_inside = inside(tile.y + y, dy, size[1]);
        for (x, value) in row.iter_mut().enumerate() {
            if !(row_inside && x < tile.width && inside(tile.x + x, dx, size[0])) {
                *value = 0.0;
            }
        }
    }
}

/// Compares the pixels of a tile to those around them.
struct Distances<'k> {
    kernel: &'k Kernel,
    values: Cut,
    variances: Cut,
    /// Columns of the tile, and with those of patches, up to whole lanes.
    columns: usize,
    reach: usize,
    /// Of single pixels, and their sums along rows of patches.
    single: Vec<f32>,
    along: Vec<f32>,
}

impl<'k> Distances<'k> {
    fn new(guide: &Guide, tile: &Tile, kernel: &'k Kernel) -> Distances<'k> {
        let margin = kernel.radius + kernel.patch;
        let mut variances = Cut::of(guide.variances, tile, margin);
        // What is not a number would spread.
        variances.planes.iter_mut().flatten().for_each(|v| *v = v.max(0.0));
        let columns = tile.padded();
        let reach = (columns + 2 * kernel.patch).next_multiple_of(LANES);
        let rows = tile.height + 2 * kernel.patch;
        Distances {
            kernel,
            values: Cut::of(guide.values, tile, margin),
            variances,
            columns,
            reach,
            single: vec![0.0; rows * reach],
            along: vec![0.0; rows * columns],
        }
    }

    /// The weights of the pixels at a place.
    #[inline(always)]
    fn weigh<S: Simd>(&mut self, simd: S, [dx, dy]: [usize; 2], weights: &mut [f32]) {
        let Kernel { radius, patch, bandwidth, .. } = *self.kernel;
        let strictness = 1.0 / (bandwidth * bandwidth);
        let stride = self.values.stride;
        for (y, single) in self.single.chunks_exact_mut(self.reach).enumerate() {
            single.fill(0.0);
            let (here, there) = ((y + radius) * stride + radius, (y + dy) * stride + dx);
            for (values, variances) in self.values.planes.iter().zip(&self.variances.planes) {
                let reach = self.reach;
                let (a, b) = (&values[here..here + reach], &values[there..there + reach]);
                let (v, w) = (&variances[here..here + reach], &variances[there..there + reach]);
                for ((((single, a), b), v), w) in single.iter_mut().zip(a).zip(b).zip(v).zip(w) {
                    *single += distance(a - b, *v, *w, strictness);
                }
            }
        }
        let (columns, across) = (self.columns, 2 * patch + 1);
        for (single, along) in self.single.chunks_exact(self.reach).zip(self.along.chunks_exact_mut(columns))
        {
            sum(simd, single, 1, across, along);
        }
        let share = 1.0 / ((across * across * self.values.planes.len()) as f32);
        for (y, weights) in weights.chunks_exact_mut(columns).enumerate() {
            sum(simd, &self.along[y * columns..], columns, across, weights);
            for weight in weights {
                *weight = fade(*weight * share);
            }
        }
    }
}

/// The sums of so many numbers a step apart, each from its own place on.
#[inline(always)]
fn sum<S: Simd>(simd: S, numbers: &[f32], step: usize, count: usize, sums: &mut [f32]) {
    for (index, sums) in sums.chunks_exact_mut(LANES).enumerate() {
        let lane = |at: usize| f32x16::from_slice(simd, &numbers[index * LANES + at * step..][..LANES]);
        let mut sum = lane(0);
        for at in 1..count {
            sum += lane(at);
        }
        sum.store_slice(sums);
    }
}

/// How many times more than by noise two numbers differ, squared: about 0 if by noise alone.
#[inline(always)]
fn distance(difference: f32, a: f32, b: f32, strictness: f32) -> f32 {
    (difference * difference - (a + a.min(b))) * strictness / (f32::MIN_POSITIVE + (a + b))
}

/// About e to the power −x, and 1 below 0: (1 − x/256)²⁵⁶, of which nothing is left at 256.
#[inline(always)]
pub(super) fn fade(x: f32) -> f32 {
    let mut v = (1.0 - x.max(0.0) * (1.0 / 256.0)).max(0.0);
    for _ in 0..8 {
        v *= v;
    }
    v
}

/// Mixes every pixel of planes with those around it that a guide has alike.
pub(super) fn means(planes: &Planes, guide: &Guide, kernel: &Kernel) -> Planes {
    let bands: Vec<Vec<Vec<f32>>> = planes
        .rows_of_tiles()
        .par_iter()
        .map(|tiles| {
            let [width, _] = planes.size;
            let mut band =
                vec![vec![0.0; width * tiles.first().map_or(0, |tile| tile.height)]; planes.planes.len()];
            for tile in tiles {
                let weights = Weights::of(guide, tile, kernel);
                let means = vectorized(
                    #[inline(always)]
                    || tile_means(planes, tile, kernel, &weights),
                );
                for (mean, plane) in means.iter().zip(&mut band) {
                    for (row, mean) in mean.chunks_exact(tile.padded()).enumerate() {
                        plane[row * width + tile.x..][..tile.width].copy_from_slice(&mean[..tile.width]);
                    }
                }
            }
            band
        })
        .collect();
    let plane = |index: usize| bands.iter().flat_map(|band| &band[index]).copied().collect();
    Planes { size: planes.size, planes: (0..planes.planes.len()).map(plane).collect() }
}

#[inline(always)]
fn tile_means(planes: &Planes, tile: &Tile, kernel: &Kernel, weights: &Weights) -> Vec<Vec<f32>> {
    let cut = Cut::of(planes, tile, kernel.radius);
    let starts = (0..tile.height).flat_map(|y| (0..tile.padded()).step_by(LANES).map(move |x| [x, y]));
    let mut means = vec![Vec::with_capacity(tile.padded() * tile.height); cut.planes.len()];
    for [x, y] in starts {
        let mut total = [0.0f32; LANES];
        for (_, weights) in weights.around(tile, [x, y]) {
            total.iter_mut().zip(weights).for_each(|(total, weight)| *total += weight);
        }
        for (means, plane) in means.iter_mut().zip(&cut.planes) {
            let mut sum = [0.0f32; LANES];
            for ([dx, dy], weights) in weights.around(tile, [x, y]) {
                let there = &plane[(y + dy) * cut.stride + x + dx..][..LANES];
                sum.iter_mut().zip(weights).zip(there).for_each(|((sum, weight), v)| *sum += weight * v);
            }
            // A pixel is always like itself, but for those that fill up lanes.
            means.extend(sum.iter().zip(&total).map(|(sum, total)| sum / total.max(f32::MIN_POSITIVE)));
        }
    }
    means
}
