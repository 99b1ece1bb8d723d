//! The film: sums of samples in fixed point, so that adding is exact and its order does not matter.
//!
//! Any number of threads, tiles, passes, crops or machines give the same bits, and merging films is addition.

mod pixel;

use crate::color::Rgb;
use crate::develop::display;
use crate::math::exp2;
use crate::scene::Tonemap;
pub(super) use pixel::counted;
pub use pixel::{LIGHT_WORDS, LightSums, MOST_SAMPLES, Pixel, WORDS};
use rayon::prelude::*;

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
        self.pixel(x, y).samples()
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

    /// The least error that all but one in a hundred pixels keep in every channel: see [`Film::shown_error`].
    pub fn noise(&self, stops: f64, tonemap: Tonemap) -> f64 {
        let mut errors = self.shown_errors(stops, tonemap);
        if errors.is_empty() {
            return 0.0;
        }
        let rank = errors.len() - most_failing(errors.len()) - 1;
        *errors.select_nth_unstable_by(rank, f64::total_cmp).1
    }

    /// Standard error of each channel of a pixel as a display shows it, as a share of white. It is that of the mean, by way of
    /// half the span between the mean less and plus each of the independent errors that make it, both as shown: curves mix
    /// channels, and are flat where a channel is at its end. Below two samples nothing is known, and it is 1.
    pub fn shown_error(&self, x: u32, y: u32, stops: f64, tonemap: Tonemap) -> Rgb {
        self.error_of(self.pixel(x, y), stops, tonemap)
    }

    /// Those of the worst channel of every pixel, row by row.
    pub(super) fn shown_errors(&self, stops: f64, tonemap: Tonemap) -> Vec<f64> {
        self.pixels.par_iter().map(|pixel| self.error_of(pixel, stops, tonemap).max_element()).collect()
    }

    fn error_of(&self, pixel: &Pixel, stops: f64, tonemap: Tonemap) -> Rgb {
        let Some(errors) = pixel.errors(self.scale) else { return Rgb::ONE };
        let (mean, mut variance) = (pixel.mean(self.scale), Rgb::ZERO);
        for error in errors.into_iter().filter(|error| *error != Rgb::ZERO) {
            let span = display(mean + error, stops, tonemap) - display(mean - error, stops, tonemap);
            variance += 0.25 * span * span;
        }
        Rgb::new(variance.x.sqrt(), variance.y.sqrt(), variance.z.sqrt())
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
