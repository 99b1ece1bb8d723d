//! How alike the surroundings of pixels are: non-local means (A. Buades, B. Coll and J.-M. Morel, "A review of image denoising
//! algorithms, with a new one", 2005), with the distances for noise that differs from pixel to pixel (F. Rousselle, C. Knaus
//! and M. Zwicker, "Adaptive rendering with non-local means filtering", 2012, section 4).

use super::planes::{Cut, Planes, Tile, vectorized};
use rayon::prelude::*;

/// Variance that is nothing, of numbers about 1: below it, differences count as they are.
const LEAST_VARIANCE: f32 = 1e-8;

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
    pub(super) places: Vec<[usize; 2]>,
    /// Pixel by pixel of the tile, its rows in whole lanes, for one place after the other.
    values: Vec<f32>,
    /// Numbers of a place.
    area: usize,
}

impl Weights {
    /// Compares the pixels of a tile. Those beyond the picture weigh nothing.
    pub(super) fn of(guide: &Guide, tile: &Tile, kernel: &Kernel) -> Weights {
        let mut distances = Distances::new(guide, tile, kernel);
        let (places, area) = (kernel.places(), tile.padded() * tile.height);
        let mut values = vec![0.0; places.len() * area];
        for (place, values) in places.iter().zip(values.chunks_exact_mut(area)) {
            vectorized(
                #[inline(always)]
                || distances.weigh(*place, values),
            );
            clear_outside(values, tile, kernel, guide.values.size, *place);
        }
        Weights { places, values, area }
    }

    /// The places with the weights of all pixels for them.
    #[inline(always)]
    pub(super) fn each(&self) -> impl Iterator<Item = ([usize; 2], &[f32])> {
        self.places.iter().copied().zip(self.values.chunks_exact(self.area))
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
    /// Columns and rows of the tile, and columns with those of patches.
    size: [usize; 2],
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
        let (columns, reach) = (tile.padded(), tile.padded() + 2 * kernel.patch);
        let rows = tile.height + 2 * kernel.patch;
        Distances {
            kernel,
            values: Cut::of(guide.values, tile, margin),
            variances,
            size: [columns, tile.height],
            reach,
            single: vec![0.0; rows * reach],
            along: vec![0.0; rows * columns],
        }
    }

    /// The weights of the pixels at a place.
    #[inline(always)]
    fn weigh(&mut self, [dx, dy]: [usize; 2], weights: &mut [f32]) {
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
        let columns = self.size[0];
        for (single, along) in self.single.chunks_exact(self.reach).zip(self.along.chunks_exact_mut(columns))
        {
            along.copy_from_slice(&single[..columns]);
            for step in 1..=2 * patch {
                for (sum, v) in along.iter_mut().zip(&single[step..]) {
                    *sum += v;
                }
            }
        }
        let across = (2 * patch + 1) as f32;
        let share = 1.0 / (across * across * self.values.planes.len() as f32);
        for (y, weights) in weights.chunks_exact_mut(columns).enumerate() {
            weights.copy_from_slice(&self.along[y * columns..][..columns]);
            for step in 1..=2 * patch {
                let along = &self.along[(y + step) * columns..][..columns];
                for (sum, v) in weights.iter_mut().zip(along) {
                    *sum += v;
                }
            }
            for weight in weights {
                *weight = fade(*weight * share);
            }
        }
    }
}

/// How many times more than by noise two numbers differ, squared: about 0 if by noise alone.
#[inline(always)]
fn distance(difference: f32, a: f32, b: f32, strictness: f32) -> f32 {
    (difference * difference - (a + a.min(b))) * strictness / (LEAST_VARIANCE + (a + b))
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
    let (columns, area) = (tile.padded(), tile.padded() * tile.height);
    let mut total = vec![0.0f32; area];
    let mut sums = vec![vec![0.0f32; area]; cut.planes.len()];
    for ([dx, dy], at) in weights.each() {
        total.iter_mut().zip(at).for_each(|(total, weight)| *total += weight);
        for (sum, plane) in sums.iter_mut().zip(&cut.planes) {
            for (y, (sum, weight)) in sum.chunks_exact_mut(columns).zip(at.chunks_exact(columns)).enumerate()
            {
                let there = &plane[(y + dy) * cut.stride + dx..][..columns];
                for ((sum, weight), v) in sum.iter_mut().zip(weight).zip(there) {
                    *sum += weight * v;
                }
            }
        }
    }
    for sum in &mut sums {
        // A pixel is always like itself, but for those that fill up lanes.
        sum.iter_mut().zip(&total).for_each(|(sum, total)| *sum /= total.max(f32::MIN_POSITIVE));
    }
    sums
}
