//! Fitting the colours around every pixel by its features.
//!
//! Around each pixel the colour is taken for a linear function of the features, fitted to the pixels around it by least squares
//! with the weights of [`Weights`], and every pixel is the mean of what the fits around it say of it, by the same weights
//! (B. Bitterli et al., "Nonlinearly weighted first-order regression for denoising Monte Carlo renderings", 2016, section 5.2).

use super::FEATURES;
use super::planes::{Cut, LANES, Planes, TILE_HEIGHT, Tile};
use super::weights::{Guide, Kernel, Weights};
use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch, f32x8};
use rayon::prelude::*;

/// Unknowns of a fit: one for each feature, and what is there without any.
const UNKNOWNS: usize = FEATURES + 1;
/// Products of two of them.
const PRODUCTS: usize = UNKNOWNS * (UNKNOWNS + 1) / 2;
/// Red, green and blue.
const COLORS: usize = 3;
/// Features that differ less than the root of this do not matter.
const RIDGE: f64 = 1e-4;
/// Weights below are none.
const LEAST_WEIGHT: f32 = 1e-2;

/// A number of each of several pixels.
type Lane = [f32; LANES];

/// Fits the colours of a picture by features, once for each of the bandwidths, which are given as by how many squarings each is
/// narrower than that of the kernel: each squaring divides it by the root of two.
pub(super) fn fitted<const N: usize>(
    guide: &Guide,
    features: &Planes,
    kernel: &Kernel,
    squarings: &[u32; N],
) -> [Planes; N] {
    let rows = guide.values.rows_of_tiles();
    let bands: Vec<Vec<Band>> = rows
        .par_iter()
        .map(|tiles| {
            let mut bands: Vec<Band> =
                squarings.iter().map(|_| Band::new(guide.values.size[0], kernel)).collect();
            for tile in tiles {
                let fits = Fits::new(guide, features, tile, kernel);
                for (band, squarings) in bands.iter_mut().zip(squarings) {
                    dispatch!(Level::new(), simd => simd.vectorize(
                        #[inline(always)]
                        || fits.add(simd, *squarings, band),
                    ));
                }
            }
            bands
        })
        .collect();
    std::array::from_fn(|index| together(&bands, index, guide.values, kernel))
}

/// What fits say of the pixels of a row of tiles and of those around them: colours times weights, and weights.
struct Band {
    stride: usize,
    sums: [Vec<f32>; COLORS + 1],
}

impl Band {
    fn new(width: usize, kernel: &Kernel) -> Band {
        let stride = (width + 2 * kernel.radius).next_multiple_of(LANES) + LANES;
        let length = stride * (TILE_HEIGHT + 2 * kernel.radius);
        Band { stride, sums: std::array::from_fn(|_| vec![0.0; length]) }
    }
}

/// Adds up what the fits of all bands say, in their order, so that the sums have the same bits on any number of threads.
fn together(bands: &[Vec<Band>], index: usize, noisy: &Planes, kernel: &Kernel) -> Planes {
    let [width, height] = noisy.size;
    let row = |y: usize| -> [Vec<f32>; COLORS] {
        let mut sums: [Vec<f32>; COLORS + 1] = std::array::from_fn(|_| vec![0.0; width]);
        for (number, band) in bands.iter().enumerate() {
            let top = number * TILE_HEIGHT;
            let Some(within) = (y + kernel.radius).checked_sub(top) else { continue };
            if within >= TILE_HEIGHT + 2 * kernel.radius {
                continue;
            }
            let Band { stride, sums: band } = &band[index];
            for (sum, band) in sums.iter_mut().zip(band) {
                let from = &band[within * stride + kernel.radius..][..width];
                sum.iter_mut().zip(from).for_each(|(sum, v)| *sum += v);
            }
        }
        let [colors @ .., weights] = sums;
        let mut channel = 0;
        colors.map(|color| {
            let noisy = &noisy.planes[channel][y * width..][..width];
            channel += 1;
            let mean = |((sum, weight), noisy): ((&f32, &f32), &f32)| {
                let mean = sum / weight;
                if mean.is_finite() { mean } else { *noisy }
            };
            color.iter().zip(&weights).zip(noisy).map(mean).collect()
        })
    };
    let rows: Vec<[Vec<f32>; COLORS]> = (0..height).into_par_iter().map(row).collect();
    let plane = |channel: usize| rows.iter().flat_map(|row| &row[channel]).copied().collect();
    Planes { size: noisy.size, planes: (0..COLORS).map(plane).collect() }
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
    fn add<S: Simd>(&self, simd: S, squarings: u32, band: &mut Band) {
        for y in 0..self.tile.height {
            for x in (0..self.tile.width).step_by(LANES) {
                let lines = self.sums(simd, [x, y], squarings).solved();
                self.say(simd, &lines, [x, y], squarings, band);
            }
        }
    }

    /// The weights that some pixels have for a place around them; none where all are too small.
    #[inline(always)]
    fn weights<S: Simd>(&self, simd: S, weights: &[f32], at: usize, squarings: u32) -> Option<f32x8<S>> {
        let mut weights = lane(simd, weights, at);
        for _ in 0..squarings {
            weights *= weights;
        }
        weights.simd_gt(f32x8::splat(simd, LEAST_WEIGHT)).any_true().then_some(weights)
    }

    /// The features of some pixels.
    #[inline(always)]
    fn center<S: Simd>(&self, simd: S, [x, y]: [usize; 2]) -> [f32x8<S>; FEATURES] {
        let at = (y + self.kernel.radius) * self.features.stride + x + self.kernel.radius;
        let mut center = [f32x8::splat(simd, 0.0); FEATURES];
        for (center, plane) in center.iter_mut().zip(&self.features.planes) {
            *center = lane(simd, plane, at);
        }
        center
    }

    /// By how much the features at some place differ from those of a centre, and 1.
    #[inline(always)]
    fn differences<S: Simd>(
        &self,
        simd: S,
        center: &[f32x8<S>; FEATURES],
        at: usize,
    ) -> [f32x8<S>; UNKNOWNS] {
        let mut differences = [f32x8::splat(simd, 1.0); UNKNOWNS];
        for ((difference, plane), center) in differences.iter_mut().zip(&self.features.planes).zip(center) {
            *difference = lane(simd, plane, at) - *center;
        }
        differences
    }

    #[inline(always)]
    fn sums<S: Simd>(&self, simd: S, [x, y]: [usize; 2], squarings: u32) -> Sums<S> {
        let center = self.center(simd, [x, y]);
        let (stride, at) = (self.features.stride, y * self.tile.padded() + x);
        let [red, green, blue] = [0, 1, 2].map(|channel| self.colors.planes[channel].as_slice());
        let zero = f32x8::splat(simd, 0.0);
        let mut sums = Sums { products: [zero; PRODUCTS], colors: [[zero; UNKNOWNS]; COLORS] };
        for ([dx, dy], weights) in self.weights.each() {
            let Some(weights) = self.weights(simd, weights, at, squarings) else { continue };
            let there = (y + dy) * stride + x + dx;
            let x = self.differences(simd, &center, there);
            let colors = [lane(simd, red, there), lane(simd, green, there), lane(simd, blue, there)];
            sums.add(weights, &x, &colors);
        }
        sums
    }

    /// Adds what the fits of some pixels say of all places around them.
    #[inline(always)]
    fn say<S: Simd>(&self, simd: S, lines: &Lines, [x, y]: [usize; 2], squarings: u32, band: &mut Band) {
        let center = self.center(simd, [x, y]);
        let (stride, at) = (self.features.stride, y * self.tile.padded() + x);
        let mut slopes = [[f32x8::splat(simd, 0.0); UNKNOWNS]; COLORS];
        for (slopes, lines) in slopes.iter_mut().zip(&lines.0) {
            for (slope, line) in slopes.iter_mut().zip(lines) {
                *slope = f32x8::from_slice(simd, line);
            }
        }
        let nothing = f32x8::splat(simd, 0.0);
        let corner = y * band.stride + self.tile.x + x;
        for ([dx, dy], weights) in self.weights.each() {
            let Some(weights) = self.weights(simd, weights, at, squarings) else { continue };
            let differences = self.differences(simd, &center, (y + dy) * stride + x + dx);
            let to = corner + dy * band.stride + dx;
            for (slopes, sums) in slopes.iter().zip(&mut band.sums) {
                let mut said = slopes[FEATURES];
                for (slope, difference) in slopes.iter().zip(&differences).take(FEATURES) {
                    said += *slope * *difference;
                }
                // Beside what is very bright, lines lead below nothing.
                add(simd, sums, to, weights * said.max(nothing));
            }
            add(simd, &mut band.sums[COLORS], to, weights);
        }
    }
}

#[inline(always)]
fn lane<S: Simd>(simd: S, numbers: &[f32], at: usize) -> f32x8<S> {
    f32x8::from_slice(simd, &numbers[at..at + LANES])
}

#[inline(always)]
fn add<S: Simd>(simd: S, numbers: &mut [f32], at: usize, more: f32x8<S>) {
    let numbers = &mut numbers[at..at + LANES];
    (f32x8::from_slice(simd, numbers) + more).store_slice(numbers);
}

/// The normal equations of some pixels' fits. The last unknown is that of the constant.
struct Sums<S: Simd> {
    /// Of pairs of unknowns, the second not behind the first.
    products: [f32x8<S>; PRODUCTS],
    colors: [[f32x8<S>; UNKNOWNS]; COLORS],
}

impl<S: Simd> Sums<S> {
    #[inline(always)]
    fn add(&mut self, weights: f32x8<S>, x: &[f32x8<S>; UNKNOWNS], colors: &[f32x8<S>; COLORS]) {
        let mut index = 0;
        for i in 0..UNKNOWNS {
            let weighted = if i < FEATURES { weights * x[i] } else { weights };
            for (j, x) in x.iter().enumerate().take(i + 1) {
                self.products[index] += if j < FEATURES { weighted * *x } else { weighted };
                index += 1;
            }
            for (sums, color) in self.colors.iter_mut().zip(colors) {
                sums[i] += weighted * *color;
            }
        }
    }

    /// Solves by Cholesky's decomposition, pixel by pixel.
    #[inline(always)]
    fn solved(&self) -> Lines {
        let products: [Lane; PRODUCTS] = self.products.map(stored);
        let colors: [[Lane; UNKNOWNS]; COLORS] = self.colors.map(|colors| colors.map(stored));
        let mut lines = Lines([[[0.0; LANES]; UNKNOWNS]; COLORS]);
        for k in 0..LANES {
            solve(&products, &colors, k, &mut lines);
        }
        lines
    }
}

#[inline(always)]
fn stored<S: Simd>(lane: f32x8<S>) -> Lane {
    let mut stored = [0.0; LANES];
    lane.store_slice(&mut stored);
    stored
}

/// Slopes along the features, and the colour of the pixel itself, for each channel.
struct Lines([[Lane; UNKNOWNS]; COLORS]);

/// Solves the equations of one of the pixels.
fn solve(products: &[Lane; PRODUCTS], colors: &[[Lane; UNKNOWNS]; COLORS], k: usize, lines: &mut Lines) {
    let total = f64::from(products[PRODUCTS - 1][k]);
    // Pixels that only fill up the lanes.
    if total <= 0.0 {
        return;
    }
    let mut matrix = [[0.0f64; UNKNOWNS]; UNKNOWNS];
    let mut index = 0;
    for (i, row) in matrix.iter_mut().enumerate() {
        for entry in &mut row[..=i] {
            *entry = f64::from(products[index][k]) / total;
            index += 1;
        }
        row[i] += if i < FEATURES { RIDGE } else { 0.0 };
    }
    let root = cholesky(&matrix);
    for (line, sums) in lines.0.iter_mut().zip(colors) {
        let sums = std::array::from_fn(|i| f64::from(sums[i][k]) / total);
        for (slope, solved) in line.iter_mut().zip(substituted(&root, sums)) {
            slope[k] = solved as f32;
        }
    }
}

/// The lower triangle whose product with its transpose is a symmetric matrix, of which the lower half counts. On the diagonal are
/// the reciprocals, since it is divided by them again and again.
fn cholesky(matrix: &[[f64; UNKNOWNS]; UNKNOWNS]) -> [[f64; UNKNOWNS]; UNKNOWNS] {
    let mut root = [[0.0; UNKNOWNS]; UNKNOWNS];
    for (i, row) in matrix.iter().enumerate() {
        for (j, entry) in row.iter().enumerate().take(i + 1) {
            let before: f64 = (0..j).map(|k| root[i][k] * root[j][k]).sum();
            let left = entry - before;
            // Rounding may leave less than nothing where features depend on each other.
            root[i][j] = if i == j { 1.0 / left.max(1e-12).sqrt() } else { left * root[j][j] };
        }
    }
    root
}

/// The solution of the equations whose matrix has this root.
fn substituted(root: &[[f64; UNKNOWNS]; UNKNOWNS], mut v: [f64; UNKNOWNS]) -> [f64; UNKNOWNS] {
    for i in 0..UNKNOWNS {
        let before: f64 = (0..i).map(|k| root[i][k] * v[k]).sum();
        v[i] = (v[i] - before) * root[i][i];
    }
    for i in (0..UNKNOWNS).rev() {
        let behind: f64 = (i + 1..UNKNOWNS).map(|k| root[k][i] * v[k]).sum();
        v[i] = (v[i] - behind) * root[i][i];
    }
    v
}
