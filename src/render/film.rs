//! The film: sums of samples in fixed point, so that adding is exact and its order does not matter.
//!
//! Any number of threads, tiles, passes, crops or machines give the same bits, and merging films is addition.

use crate::color::{Rgb, luminance};
use crate::develop::display;
use crate::math::exp2;
use crate::scene::Tonemap;
use rayon::prelude::*;

/// Samples a pixel may hold without any sum overflowing.
pub const MOST_SAMPLES: u32 = 1 << 20;

/// Greatest magnitude of one channel of one sample, in units of the fixed point: `MOST_SAMPLES` times this
/// fits an `i64`, and `MOST_SAMPLES` times its square fits a `u128`.
const MOST_FIXED: f64 = (1u64 << 42) as f64;

/// Units of the fixed point in a filter weight of 1: `MOST_SAMPLES` weights of less than 8 fit an `i64`.
const WEIGHT_SCALE: f64 = (1u64 << 40) as f64;

/// Greatest magnitude of a filter weight in these units: `MOST_SAMPLES` times it fits an `i64`.
const MOST_WEIGHT: u64 = (8 << 40) - 1;

/// Numbers of 32 bits that hold the sums of a pixel: see [`Pixel::words`].
pub const WORDS: usize = 15;

/// A rectangle of pixels in the full picture, (0, 0) at its top left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// Left column.
    pub x: u32,
    /// Top row.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl Window {
    /// The whole of a picture.
    pub fn whole(size: [u32; 2]) -> Window {
        Window { x: 0, y: 0, width: size[0], height: size[1] }
    }

    /// How many pixels it has.
    pub fn pixels(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// The windows of at most `side`×`side` pixels that tile it, row by row.
    pub fn tiles(self, side: u32) -> impl Iterator<Item = Window> {
        let starts = move |from: u32, length: u32| (0..length.div_ceil(side)).map(move |i| from + i * side);
        starts(self.y, self.height).flat_map(move |y| {
            starts(self.x, self.width).map(move |x| Window {
                x,
                y,
                width: side.min(self.x + self.width - x),
                height: side.min(self.y + self.height - y),
            })
        })
    }

    /// The position of a pixel of the full picture in row-major storage of the window.
    pub(super) fn index(&self, x: u32, y: u32) -> usize {
        debug_assert!(x >= self.x && x - self.x < self.width && y >= self.y && y - self.y < self.height);
        (y - self.y) as usize * self.width as usize + (x - self.x) as usize
    }
}

/// The sums of one pixel, in units of 1/scale.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Pixel {
    sum: [i64; 3],
    luminance_squares: u128,
    /// Sums of the filter weights of samples that met something, and of those that met nothing in front of a
    /// transparent background.
    covered: i64,
    open: i64,
    samples: u32,
}

impl Pixel {
    /// Adds a radiance. One that is too large for the scale is cut; one that is no number counts as black.
    #[inline]
    pub fn add(&mut self, radiance: Rgb, scale: f64) {
        debug_assert!(radiance.is_finite(), "a path carries {radiance}");
        let [r, g, b] = fixed(radiance, scale);
        self.sum[0] += r;
        self.sum[1] += g;
        self.sum[2] += b;
        let value = Rgb::new(r as f64, g as f64, b as f64);
        // Rounded, not cut: a sum of squares that is too small on average would hide the noise of even pixels.
        let magnitude = u128::from(nearest(luminance(value).abs()) as u64);
        self.luminance_squares += magnitude * magnitude;
        self.samples += 1;
    }

    /// Adds the weight of a sample to what is covered, or to what is open to a transparent background.
    #[inline]
    pub fn cover(&mut self, open: bool, weight: f64) {
        let sum = if open { &mut self.open } else { &mut self.covered };
        *sum += nearest(weight * WEIGHT_SCALE);
    }

    /// Adds the samples of another.
    pub fn merge(&mut self, other: &Pixel) {
        for (sum, v) in self.sum.iter_mut().zip(other.sum) {
            *sum += v;
        }
        self.luminance_squares += other.luminance_squares;
        self.covered += other.covered;
        self.open += other.open;
        self.samples += other.samples;
    }

    /// What is left without the samples of another, which are among these.
    fn without(&self, other: &Pixel) -> Pixel {
        Pixel {
            sum: std::array::from_fn(|channel| self.sum[channel] - other.sum[channel]),
            luminance_squares: self.luminance_squares - other.luminance_squares,
            covered: self.covered - other.covered,
            open: self.open - other.open,
            samples: self.samples - other.samples,
        }
    }

    /// By the weights of the very samples there are, so that it is exactly 1 or 0 where all of them agree. A filter
    /// with negative weights may lead beyond these, and is cut.
    pub(super) fn alpha(&self) -> f64 {
        match (self.covered, self.open) {
            (_, 0) => 1.0,
            (0, _) => 0.0,
            (covered, open) => {
                let share = covered as f64 / (covered as f64 + open as f64);
                if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) }
            }
        }
    }

    pub(super) fn mean(&self, scale: f64) -> Rgb {
        let [r, g, b] = self.sum.map(|sum| sum as f64);
        if self.samples == 0 { Rgb::ZERO } else { Rgb::new(r, g, b) / (scale * f64::from(self.samples)) }
    }

    /// How many samples it holds.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// The sums as they are, each in words of 32 bits, the lowest first: red, green and blue in two each, the squares of
    /// luminance in four, the weights of what is covered and of what is open in two each, and the number of samples.
    pub fn words(&self) -> [u32; WORDS] {
        let [r, g, b] = self.sum.map(|v| halves(v as u64));
        let [covered, open] = [self.covered, self.open].map(|v| halves(v as u64));
        let squares = [self.luminance_squares as u64, (self.luminance_squares >> 64) as u64].map(halves);
        let pairs = [r, g, b, squares[0], squares[1], covered, open];
        std::array::from_fn(|i| if i + 1 == WORDS { self.samples } else { pairs[i / 2][i % 2] })
    }

    /// The pixel with these sums; none where so many samples cannot have them.
    pub fn from_words(words: [u32; WORDS]) -> Option<Pixel> {
        let pair = |i: usize| u64::from(words[i]) | u64::from(words[i + 1]) << 32;
        let pixel = Pixel {
            sum: [0, 2, 4].map(|i| pair(i) as i64),
            luminance_squares: u128::from(pair(6)) | u128::from(pair(8)) << 64,
            covered: pair(10) as i64,
            open: pair(12) as i64,
            samples: words[WORDS - 1],
        };
        if pixel.samples > MOST_SAMPLES {
            return None;
        }
        let n = u64::from(pixel.samples);
        let most = MOST_FIXED as u64;
        let sums = pixel.sum.iter().all(|sum| sum.unsigned_abs() <= n * most);
        let squares = pixel.luminance_squares <= u128::from(n) * u128::from(most) * u128::from(most);
        let weights = [pixel.covered, pixel.open].iter().all(|sum| sum.unsigned_abs() <= n * MOST_WEIGHT);
        (sums && squares && weights).then_some(pixel)
    }

    pub(super) fn error(&self, scale: f64) -> f64 {
        if self.samples < 2 {
            return f64::INFINITY;
        }
        let n = f64::from(self.samples);
        let mean = luminance(self.mean(1.0));
        let variance = (self.luminance_squares as f64 / n - mean * mean).max(0.0);
        (variance / (n - 1.0)).sqrt() / scale
    }
}

/// The lower and the upper half of a number.
fn halves(v: u64) -> [u32; 2] {
    [v as u32, (v >> 32) as u32]
}

/// A radiance as it counts: cut where it is too large for the scale.
pub(super) fn counted(radiance: Rgb, scale: f64) -> Rgb {
    let most = Rgb::splat(MOST_FIXED / scale);
    radiance.clamp(-most, most)
}

/// A radiance in units of 1/scale; what is too large is cut.
#[inline]
fn fixed(radiance: Rgb, scale: f64) -> [i64; 3] {
    let fixed = |v: f64| nearest((v * scale).clamp(-MOST_FIXED, MOST_FIXED));
    [fixed(radiance.x), fixed(radiance.y), fixed(radiance.z)]
}

/// The nearest whole number; 0 of what is no number. `f64::round` is a call where a processor may lack the instruction.
#[inline]
fn nearest(v: f64) -> i64 {
    (v + 0.5f64.copysign(v)) as i64
}

/// Sums over a window of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    window: Window,
    scale: f64,
    pixels: Vec<Pixel>,
}

impl Film {
    /// A film without samples. `scale` is the number of fixed-point units in radiance 1, a power of two.
    pub fn new(window: Window, scale: f64) -> Film {
        Film { window, scale, pixels: vec![Pixel::default(); window.pixels()] }
    }

    /// A film with the samples of these pixels, row by row; none where they are not as many as the window has, or the scale
    /// is none.
    pub fn with_pixels(window: Window, scale: f64, pixels: Vec<Pixel>) -> Option<Film> {
        let is_scale = scale.is_normal() && scale > 0.0 && (1.0 / scale).is_normal();
        (is_scale && pixels.len() == window.pixels()).then_some(Film { window, scale, pixels })
    }

    /// Its pixels, row by row.
    pub fn pixels(&self) -> &[Pixel] {
        &self.pixels
    }

    /// The part of the full picture that it covers.
    pub fn window(&self) -> Window {
        self.window
    }

    /// Fixed-point units in radiance 1.
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// Mean radiance of a pixel of the full picture, in W/(m²·sr).
    pub fn mean(&self, x: u32, y: u32) -> Rgb {
        self.pixel(x, y).mean(self.scale)
    }

    /// The share of a pixel that is covered, in [0, 1]: below 1 only in front of a transparent background. The mean
    /// radiance is that of the whole pixel, so it is multiplied by this already.
    pub fn alpha(&self, x: u32, y: u32) -> f64 {
        self.pixel(x, y).alpha()
    }

    /// Standard error of the mean's luminance in W/(m²·sr), as if samples were independent (stratified ones do
    /// better); infinite below two samples.
    pub fn error(&self, x: u32, y: u32) -> f64 {
        self.pixel(x, y).error(self.scale)
    }

    /// Samples of a pixel.
    pub fn samples(&self, x: u32, y: u32) -> u32 {
        self.pixel(x, y).samples
    }

    /// Adds the samples of another film, whose window lies within this one's.
    ///
    /// # Panics
    ///
    /// If the scales differ or the window does not lie within.
    pub fn merge(&mut self, other: &Film) {
        assert_eq!(self.scale, other.scale, "films of different scales cannot be merged");
        self.merge_pixels(other.window, &other.pixels);
    }

    /// The samples of each pixel in two parts: those that one of two films of the same window and scale has, that which is
    /// nearer to half of them, and the others. This one holds all of them.
    pub(super) fn halved(&self, early: &[Film; 2]) -> [Film; 2] {
        let [first, second] = early.each_ref().map(|film| &film.pixels);
        let halved = |((all, first), second): ((&Pixel, &Pixel), &Pixel)| {
            let from_half = |pixel: &Pixel| (2 * pixel.samples).abs_diff(all.samples);
            let some = if from_half(first) <= from_half(second) { first } else { second };
            (*some, all.without(some))
        };
        let (some, others) = self.pixels.iter().zip(first).zip(second).map(halved).unzip();
        [some, others].map(|pixels| Film { pixels, ..*self })
    }

    /// Takes the pixels of a window from another film of the same window and scale.
    pub(super) fn replace(&mut self, part: Window, other: &Film) {
        debug_assert!(self.window == other.window && self.scale == other.scale);
        for y in part.y..part.y + part.height {
            let row = self.window.index(part.x, y)..self.window.index(part.x, y) + part.width as usize;
            self.pixels[row.clone()].copy_from_slice(&other.pixels[row]);
        }
    }

    /// The least error that all but one in a hundred pixels keep, as shown on a display: half the span between
    /// the mean less and plus its standard error, in the channel where it is greatest, as a share of white.
    pub fn noise(&self, stops: f64, tonemap: Tonemap) -> f64 {
        let mut errors = self.shown_errors(stops, tonemap);
        if errors.is_empty() {
            return 0.0;
        }
        let rank = errors.len() - most_failing(errors.len()) - 1;
        *errors.select_nth_unstable_by(rank, f64::total_cmp).1
    }

    /// The standard errors of the pixels as shown, row by row: see [`Film::noise`].
    pub(super) fn shown_errors(&self, stops: f64, tonemap: Tonemap) -> Vec<f64> {
        self.pixels.par_iter().map(|pixel| self.shown_error(pixel, stops, tonemap)).collect()
    }

    fn shown_error(&self, pixel: &Pixel, stops: f64, tonemap: Tonemap) -> f64 {
        let (mean, error) = (pixel.mean(self.scale), pixel.error(self.scale));
        if error == f64::INFINITY {
            return 1.0;
        }
        let span = display(mean + error, stops, tonemap) - display(mean - error, stops, tonemap);
        0.5 * span.abs().max_element()
    }

    fn pixel(&self, x: u32, y: u32) -> &Pixel {
        &self.pixels[self.window.index(x, y)]
    }

    pub(super) fn merge_pixels(&mut self, window: Window, pixels: &[Pixel]) {
        // A window without columns has no pixels either.
        for (row, y) in pixels.chunks_exact(window.width.max(1) as usize).zip(window.y..) {
            let start = self.window.index(window.x, y);
            for (sum, pixel) in self.pixels[start..start + row.len()].iter_mut().zip(row) {
                sum.merge(pixel);
            }
        }
    }
}

/// How many of so many pixels may be noisier than the noise of their picture: one in a hundred.
pub(super) fn most_failing(pixels: usize) -> usize {
    pixels / 100
}

/// The scale for a picture of this typical radiance in which the brightest thing glows with `peak`: a million
/// times the typical still counts in full, or four times the peak, as long as the typical is kept to 14 bits.
pub fn scale_for(typical: f64, peak: f64) -> f64 {
    let typical = if typical > 0.0 { typical } else { peak };
    let limit = (4.0 * peak).clamp(typical * exp2(20.0), typical * exp2(28.0));
    // Within the range of exponents whose reciprocal is a normal number too.
    let exponent = if limit > 0.0 { (crate::math::ln(limit) / std::f64::consts::LN_2).ceil() } else { 0.0 };
    exp2(42.0 - exponent.clamp(-900.0, 900.0))
}
