//! Fitting the colours around every pixel by its features.
//!
//! Around each pixel the colour is taken for a linear function of the features, fitted to the pixels around it by least squares
//! with the weights of [`Weights`], and every pixel is the mean of what the fits around it say of it, by the same weights
//! (B. Bitterli et al., "Nonlinearly weighted first-order regression for denoising Monte Carlo renderings", 2016, section 5.2).

use super::planes::{Cut, LANES, Lane, Planes, TILE_HEIGHT, Tile};
use super::weights::{Guide, Kernel, Weights};
use super::{Done, FEATURES};
use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch, f32x16};
use rayon::prelude::*;

/// Unknowns of a fit: one for each feature, two for column and row, and what is there without any.
const UNKNOWNS: usize = FEATURES + 3;
/// Those that are no constant.
const SLOPES: usize = UNKNOWNS - 1;
/// Products of two of them.
const PRODUCTS: usize = UNKNOWNS * (UNKNOWNS + 1) / 2;
/// Features that differ less than the root of this do not matter.
const RIDGE: f64 = 1e-4;
/// Weights below are none.
const LEAST_WEIGHT: f32 = 1e-2;

/// Places whose terms are added together, so that the sums stay in registers meanwhile.
const TOGETHER: usize = 16;

/// A number of each of several pixels as the fits are solved, for what nearly cancels.
type Exact = [f64; LANES];

/// Fits the three or four channels of a picture by features and by column and row, once for each of the bandwidths, which are
/// given as by how many squarings each is narrower than that of the kernel: each squaring divides it by the root of two. The
/// [`work`] of each tile is told.
pub(super) fn fitted<const N: usize>(
    guide: &Guide,
    features: &Planes,
    kernel: &Kernel,
    squarings: &[u32; N],
    done: Done,
) -> [Planes; N] {
    match guide.values.planes.len() {
        4 => fitted_channels::<N, 4>(guide, features, kernel, squarings, done),
        _ => fitted_channels::<N, 3>(guide, features, kernel, squarings, done),
    }
}

/// How much work it is to fit so many pixels so many times: to compare them takes about as long as a fit.
pub(super) fn work(pixels: usize, fits: usize) -> u64 {
    pixels as u64 * (1 + fits as u64)
}

/// The same of so many channels.
fn fitted_channels<const N: usize, const C: usize>(
    guide: &Guide,
    features: &Planes,
    kernel: &Kernel,
    squarings: &[u32; N],
    done: Done,
) -> [Planes; N] {
    let rows = guide.values.rows_of_tiles();
    let bands: Vec<Vec<Band<C>>> = rows
        .par_iter()
        .map(|tiles| {
            let mut bands: Vec<Band<C>> =
                squarings.iter().map(|_| Band::new(guide.values.size[0], kernel)).collect();
            for tile in tiles {
                let fits = Fits::new(guide, features, tile, kernel);
                for (band, squarings) in bands.iter_mut().zip(squarings) {
                    dispatch!(Level::new(), simd => simd.vectorize(
                        #[inline(always)]
                        || fits.add(simd, *squarings, band),
                    ));
                }
                done(work(tile.width * tile.height, N));
            }
            bands
        })
        .collect();
    std::array::from_fn(|index| together(&bands, index, guide.values, kernel))
}

/// What fits say of the pixels of a row of tiles and of those around them: colours times weights, and weights.
struct Band<const C: usize> {
    stride: usize,
    colors: [Vec<f32>; C],
    weights: Vec<f32>,
}

impl<const C: usize> Band<C> {
    fn new(width: usize, kernel: &Kernel) -> Band<C> {
        let stride = (width + 2 * kernel.radius).next_multiple_of(LANES) + LANES;
        let length = stride * (TILE_HEIGHT + 2 * kernel.radius);
        Band { stride, colors: std::array::from_fn(|_| vec![0.0; length]), weights: vec![0.0; length] }
    }
}

/// Adds up what the fits of all bands say, in their order, so that the sums have the same bits on any number of threads.
fn together<const C: usize>(bands: &[Vec<Band<C>>], index: usize, noisy: &Planes, kernel: &Kernel) -> Planes {
    let [width, height] = noisy.size;
    let row = |y: usize| -> [Vec<f32>; C] {
        let (mut colors, mut weights) = ([(); C].map(|()| vec![0.0f32; width]), vec![0.0f32; width]);
        for (number, band) in bands.iter().enumerate() {
            let top = number * TILE_HEIGHT;
            let Some(within) = (y + kernel.radius).checked_sub(top) else { continue };
            if within >= TILE_HEIGHT + 2 * kernel.radius {
                continue;
            }
            let band = &band[index];
            let more = |sum: &mut Vec<f32>, plane: &Vec<f32>| {
                let from = &plane[within * band.stride + kernel.radius..][..width];
                sum.iter_mut().zip(from).for_each(|(sum, v)| *sum += v);
            };
            colors.iter_mut().zip(&band.colors).for_each(|(sum, plane)| more(sum, plane));
            more(&mut weights, &band.weights);
        }
        let mut planes = noisy.planes.iter();
        colors.map(|color| {
            let noisy = planes.next().map_or(&[][..], |plane| &plane[y * width..][..width]);
            let mean = |((sum, weight), noisy): ((&f32, &f32), &f32)| {
                let mean = sum / weight;
                if mean.is_finite() { mean } else { *noisy }
            };
            color.iter().zip(&weights).zip(noisy).map(mean).collect()
        })
    };
    let rows: Vec<[Vec<f32>; C]> = (0..height).into_par_iter().map(row).collect();
    let plane = |channel: usize| rows.iter().flat_map(|row| &row[channel]).copied().collect();
    Planes { size: noisy.size, planes: (0..C).map(plane).collect() }
}

/// The fits of a tile.
struct Fits<'f> {
    tile: &'f Tile,
    kernel: &'f Kernel,
    weights: Weights,
    colors: Cut,
    features: Cut,
}

impl<'f> Fits<'f> {
    fn new(guide: &Guide, features: &Planes, tile: &'f Tile, kernel: &'f Kernel) -> Fits<'f> {
        Fits {
            tile,
            kernel,
            weights: Weights::of(guide, tile, kernel),
            colors: Cut::of(guide.values, tile, kernel.radius),
            features: Cut::of(features, tile, kernel.radius),
        }
    }

    /// Fits all pixels, and adds what the fits say to a band.
    #[inline(always)]
    fn add<S: Simd, const C: usize>(&self, simd: S, squarings: u32, band: &mut Band<C>) {
        for y in 0..self.tile.height {
            for x in (0..self.tile.width).step_by(LANES) {
                let lines = self.sums::<S, C>(simd, [x, y], squarings).solved();
                self.say(simd, &lines, [x, y], squarings, band);
            }
        }
    }

    /// The weights that some pixels have for a place around them, without those that are too small; none where all are.
    #[inline(always)]
    fn weights<S: Simd>(&self, simd: S, weights: &Lane, squarings: u32) -> Option<f32x16<S>> {
        let mut weights = f32x16::from_slice(simd, weights);
        for _ in 0..squarings {
            weights *= weights;
        }
        let counts = weights.simd_gt(f32x16::splat(simd, LEAST_WEIGHT));
        counts.any_true().then(|| counts.select(weights, f32x16::splat(simd, 0.0)))
    }

    /// The features of some pixels.
    #[inline(always)]
    fn center<S: Simd>(&self, simd: S, [x, y]: [usize; 2]) -> [f32x16<S>; FEATURES] {
        let at = (y + self.kernel.radius) * self.features.stride + x + self.kernel.radius;
        let mut center = [f32x16::splat(simd, 0.0); FEATURES];
        for (center, plane) in center.iter_mut().zip(&self.features.planes) {
            *center = lane(simd, plane, at);
        }
        center
    }

    /// By how much the features at some place differ from those of a centre, how far away it is, and 1.
    #[inline(always)]
    fn differences<S: Simd>(
        &self,
        simd: S,
        center: &[f32x16<S>; FEATURES],
        [x, y]: [usize; 2],
        [dx, dy]: [usize; 2],
    ) -> [f32x16<S>; UNKNOWNS] {
        let at = (y + dy) * self.features.stride + x + dx;
        let mut differences = [f32x16::splat(simd, 1.0); UNKNOWNS];
        for ((difference, plane), center) in differences.iter_mut().zip(&self.features.planes).zip(center) {
            *difference = lane(simd, plane, at) - *center;
        }
        let away = |at: usize| at as f32 / self.kernel.radius as f32 - 1.0;
        differences[FEATURES] = f32x16::splat(simd, away(dx));
        differences[FEATURES + 1] = f32x16::splat(simd, away(dy));
        differences
    }

    #[inline(always)]
    fn sums<S: Simd, const C: usize>(&self, simd: S, [x, y]: [usize; 2], squarings: u32) -> Sums<S, C> {
        let center = self.center(simd, [x, y]);
        let stride = self.features.stride;
        let zero = f32x16::splat(simd, 0.0);
        let mut sums = Sums { products: [zero; PRODUCTS], colors: [[zero; UNKNOWNS]; C] };
        let mut terms = [Term { weights: zero, x: [zero; UNKNOWNS], colors: [zero; C] }; TOGETHER];
        let mut count = 0;
        for ([dx, dy], weights) in self.weights.around(self.tile, [x, y]) {
            let Some(weights) = self.weights(simd, weights, squarings) else { continue };
            let there = (y + dy) * stride + x + dx;
            let mut colors = [zero; C];
            for (color, plane) in colors.iter_mut().zip(&self.colors.planes) {
                *color = lane(simd, plane, there);
            }
            terms[count] = Term { weights, x: self.differences(simd, &center, [x, y], [dx, dy]), colors };
            count += 1;
            if count == TOGETHER {
                sums.add(simd, &terms);
                count = 0;
            }
        }
        sums.add(simd, &terms[..count]);
        sums
    }

    /// Adds what the fits of some pixels say of all places around them.
    #[inline(always)]
    fn say<S: Simd, const C: usize>(
        &self,
        simd: S,
        lines: &Lines<C>,
        [x, y]: [usize; 2],
        squarings: u32,
        band: &mut Band<C>,
    ) {
        let center = self.center(simd, [x, y]);
        let mut slopes = [[f32x16::splat(simd, 0.0); UNKNOWNS]; C];
        for (slopes, lines) in slopes.iter_mut().zip(&lines.0) {
            for (slope, line) in slopes.iter_mut().zip(lines) {
                *slope = f32x16::from_slice(simd, line);
            }
        }
        let nothing = f32x16::splat(simd, 0.0);
        let corner = y * band.stride + self.tile.x + x;
        for ([dx, dy], weights) in self.weights.around(self.tile, [x, y]) {
            let Some(weights) = self.weights(simd, weights, squarings) else { continue };
            let differences = self.differences(simd, &center, [x, y], [dx, dy]);
            let to = corner + dy * band.stride + dx;
            for (slopes, sums) in slopes.iter().zip(&mut band.colors) {
                let mut said = slopes[SLOPES];
                for (slope, difference) in slopes.iter().zip(&differences).take(SLOPES) {
                    said += *slope * *difference;
                }
                // Beside what is very bright, lines lead below nothing.
                add(simd, sums, to, weights * said.max(nothing));
            }
            add(simd, &mut band.weights, to, weights);
        }
    }
}

#[inline(always)]
fn lane<S: Simd>(simd: S, numbers: &[f32], at: usize) -> f32x16<S> {
    f32x16::from_slice(simd, &numbers[at..at + LANES])
}

#[inline(always)]
fn add<S: Simd>(simd: S, numbers: &mut [f32], at: usize, more: f32x16<S>) {
    let numbers = &mut numbers[at..at + LANES];
    (f32x16::from_slice(simd, numbers) + more).store_slice(numbers);
}

/// What a place around some pixels has to say to their fits.
#[derive(Clone, Copy)]
struct Term<S: Simd, const C: usize> {
    weights: f32x16<S>,
    x: [f32x16<S>; UNKNOWNS],
    colors: [f32x16<S>; C],
}

/// The normal equations of some pixels' fits. The last unknown is that of the constant.
struct Sums<S: Simd, const C: usize> {
    /// Of pairs of unknowns, the second not behind the first.
    products: [f32x16<S>; PRODUCTS],
    colors: [[f32x16<S>; UNKNOWNS]; C],
}

impl<S: Simd, const C: usize> Sums<S, C> {
    #[inline(always)]
    fn add(&mut self, simd: S, terms: &[Term<S, C>]) {
        const { assert!(UNKNOWNS == 10, "a row for each unknown") };
        self.add_row::<0>(simd, terms);
        self.add_row::<1>(simd, terms);
        self.add_row::<2>(simd, terms);
        self.add_row::<3>(simd, terms);
        self.add_row::<4>(simd, terms);
        self.add_row::<5>(simd, terms);
        self.add_row::<6>(simd, terms);
        self.add_row::<7>(simd, terms);
        self.add_row::<8>(simd, terms);
        self.add_row::<9>(simd, terms);
    }

    /// The products of one unknown with those up to it, and with the colours. Its number is known when this is compiled, so
    /// that no loop is left but that over the terms.
    #[inline(always)]
    fn add_row<const ROW: usize>(&mut self, simd: S, terms: &[Term<S, C>]) {
        let zero = f32x16::splat(simd, 0.0);
        let (mut products, mut colors) = ([zero; UNKNOWNS], [zero; C]);
        for term in terms {
            let weighted = term.weights * term.x[ROW];
            for (sum, x) in products[..=ROW].iter_mut().zip(&term.x) {
                *sum += weighted * *x;
            }
            for (sum, color) in colors.iter_mut().zip(&term.colors) {
                *sum += weighted * *color;
            }
        }
        for (sum, more) in self.products[first_of(ROW)..].iter_mut().zip(&products[..=ROW]) {
            *sum += *more;
        }
        for (sums, more) in self.colors.iter_mut().zip(&colors) {
            sums[ROW] += *more;
        }
    }

    /// Solves by Cholesky's decomposition. Pixels that only fill up the lanes have no weights and get any lines, which nobody
    /// weighs either.
    #[inline(always)]
    fn solved(&self) -> Lines<C> {
        let total = stored(self.products[PRODUCTS - 1]).map(|v| if v > 0.0 { v } else { 1.0 });
        let mut matrix = [[[0.0; LANES]; UNKNOWNS]; UNKNOWNS];
        for (i, row) in matrix.iter_mut().enumerate() {
            for (j, entry) in row[..=i].iter_mut().enumerate() {
                *entry = over(&stored(self.products[first_of(i) + j]), &total);
            }
            if i < SLOPES {
                row[i].iter_mut().for_each(|v| *v += RIDGE);
            }
        }
        let root = cholesky(&matrix);
        Lines(self.colors.map(|sums| {
            let solved = substituted(&root, sums.map(|sums| over(&stored(sums), &total)));
            solved.map(|v| v.map(|v| v as f32))
        }))
    }
}

/// Where the products of an unknown begin.
const fn first_of(row: usize) -> usize {
    row * (row + 1) / 2
}

#[inline(always)]
fn stored<S: Simd>(lane: f32x16<S>) -> Lane {
    let mut stored = [0.0; LANES];
    lane.store_slice(&mut stored);
    stored
}

/// Slopes along the features, and the colour of the pixel itself, for each channel.
struct Lines<const C: usize>([[Lane; UNKNOWNS]; C]);

#[inline(always)]
fn over(sums: &Lane, total: &Lane) -> Exact {
    let mut shares = [0.0; LANES];
    for ((share, sum), total) in shares.iter_mut().zip(sums).zip(total) {
        *share = f64::from(*sum) / f64::from(*total);
    }
    shares
}

/// What is left of a number without some products.
#[inline(always)]
fn without<'p>(mut left: Exact, products: impl Iterator<Item = (&'p Exact, &'p Exact)>) -> Exact {
    for (a, b) in products {
        left.iter_mut().zip(a).zip(b).for_each(|((left, a), b)| *left -= a * b);
    }
    left
}

#[inline(always)]
fn times(mut a: Exact, b: &Exact) -> Exact {
    a.iter_mut().zip(b).for_each(|(a, b)| *a *= b);
    a
}

/// The lower triangles whose products with their transposes are symmetric matrices, of which the lower halves count. On the
/// diagonal are the reciprocals, since it is divided by them again and again.
#[inline(always)]
fn cholesky(matrix: &[[Exact; UNKNOWNS]; UNKNOWNS]) -> [[Exact; UNKNOWNS]; UNKNOWNS] {
    let mut root = [[[0.0; LANES]; UNKNOWNS]; UNKNOWNS];
    for (i, row) in matrix.iter().enumerate() {
        for (j, entry) in row[..=i].iter().enumerate() {
            let left = without(*entry, root[i][..j].iter().zip(&root[j][..j]));
            root[i][j] = if i == j {
                // Rounding may leave less than nothing where features depend on each other.
                left.map(|left| 1.0 / left.max(1e-12).sqrt())
            } else {
                times(left, &root[j][j])
            };
        }
    }
    root
}

/// The solutions of the equations whose matrices have these roots.
#[inline(always)]
fn substituted(root: &[[Exact; UNKNOWNS]; UNKNOWNS], mut v: [Exact; UNKNOWNS]) -> [Exact; UNKNOWNS] {
    for i in 0..UNKNOWNS {
        v[i] = times(without(v[i], root[i][..i].iter().zip(&v[..i])), &root[i][i]);
    }
    for i in (0..UNKNOWNS).rev() {
        let column = root[i + 1..].iter().map(|row| &row[i]);
        v[i] = times(without(v[i], column.zip(&v[i + 1..])), &root[i][i]);
    }
    v
}
