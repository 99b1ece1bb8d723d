//! The film: sums of samples in fixed point, so that adding is exact and its order does not matter.
//!
//! Any number of threads, tiles, passes, crops or machines give the same bits, and merging films is addition.

use rt_lang::color::{Rgb, luminance};
use rt_lang::develop::display;
use rt_lang::math::{DMat3, exp2};
use rt_lang::scene::Tonemap;

/// Samples a pixel may hold without any sum overflowing.
pub const MOST_SAMPLES: u32 = 1 << 20;

/// Greatest magnitude of one channel of one sample, in units of the fixed point: `MOST_SAMPLES` times this
/// fits an `i64`, and `MOST_SAMPLES` times its square an `i128`.
const MOST_FIXED: f64 = (1u64 << 42) as f64;

/// Units of the fixed point in a filter weight of 1: `MOST_SAMPLES` weights of less than 8 fit an `i64`.
const WEIGHT_SCALE: f64 = (1u64 << 40) as f64;

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
    fn index(&self, x: u32, y: u32) -> usize {
        debug_assert!(x >= self.x && x - self.x < self.width && y >= self.y && y - self.y < self.height);
        (y - self.y) as usize * self.width as usize + (x - self.x) as usize
    }
}

/// The sums of one pixel, in units of 1/scale.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Pixel {
    sum: [i64; 3],
    /// Of the products of each channel with each.
    products: [[i128; 3]; 3],
    /// Sums of the filter weights of samples that met something, and of those that met nothing in front of a
    /// transparent background.
    covered: i64,
    open: i64,
    samples: u32,
}

impl Pixel {
    /// Adds a radiance. One that is too large for the scale is cut; one that is no number counts as black.
    pub fn add(&mut self, radiance: Rgb, scale: f64) {
        debug_assert!(radiance.is_finite(), "a path carries {radiance}");
        let fixed =
            |v: f64| if v.is_nan() { 0.0 } else { (v * scale).clamp(-MOST_FIXED, MOST_FIXED).round() };
        let value = Rgb::new(fixed(radiance.x), fixed(radiance.y), fixed(radiance.z));
        for (sum, v) in self.sum.iter_mut().zip(value.to_array()) {
            *sum += v as i64;
        }
        for (row, own) in self.products.iter_mut().zip(value.to_array()) {
            for (sum, other) in row.iter_mut().zip(value.to_array()) {
                *sum += own as i128 * other as i128;
            }
        }
        self.samples += 1;
    }

    /// Adds the weight of a sample to what is covered, or to what is open to a transparent background.
    pub fn cover(&mut self, open: bool, weight: f64) {
        let sum = if open { &mut self.open } else { &mut self.covered };
        *sum += (weight * WEIGHT_SCALE).round() as i64;
    }

    /// Adds the samples of another.
    pub fn merge(&mut self, other: &Pixel) {
        for (sum, v) in self.sum.iter_mut().zip(other.sum) {
            *sum += v;
        }
        for (row, others) in self.products.iter_mut().zip(other.products) {
            for (sum, v) in row.iter_mut().zip(others) {
                *sum += v;
            }
        }
        self.covered += other.covered;
        self.open += other.open;
        self.samples += other.samples;
    }

    /// By the weights of the very samples there are, so that it is exactly 1 or 0 where all of them agree. A filter
    /// with negative weights may lead beyond these, and is cut.
    fn alpha(&self) -> f64 {
        match (self.covered, self.open) {
            (_, 0) => 1.0,
            (0, _) => 0.0,
            (covered, open) => {
                let share = covered as f64 / (covered as f64 + open as f64);
                if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) }
            }
        }
    }

    fn mean(&self, scale: f64) -> Rgb {
        let [r, g, b] = self.sum.map(|sum| sum as f64);
        if self.samples == 0 { Rgb::ZERO } else { Rgb::new(r, g, b) / (scale * f64::from(self.samples)) }
    }

    /// Of the mean, as if samples were independent; none below two samples.
    fn covariance(&self, scale: f64) -> Option<DMat3> {
        let n = f64::from(self.samples);
        let mean = self.sum.map(|sum| sum as f64 / n);
        let entry = |row: usize, column: usize| {
            (self.products[row][column] as f64 / n - mean[row] * mean[column]) / (n - 1.0) / scale / scale
        };
        let column = |column| Rgb::new(entry(0, column), entry(1, column), entry(2, column));
        (self.samples >= 2).then(|| DMat3::from_cols(column(0), column(1), column(2)))
    }

    fn error(&self, scale: f64) -> f64 {
        // Luminance is linear: its gradient is that of any colour.
        let gradient = Rgb::new(luminance(Rgb::X), luminance(Rgb::Y), luminance(Rgb::Z));
        let variance = |covariance: DMat3| gradient.dot(covariance * gradient);
        self.covariance(scale).map_or(f64::INFINITY, |covariance| variance(covariance).max(0.0).sqrt())
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

    /// The least error that all but one in a hundred pixels keep, as shown on a display, in the channel where it is greatest, as
    /// a share of white.
    pub fn noise(&self, stops: f64, tonemap: Tonemap) -> f64 {
        let mut errors: Vec<f64> =
            self.pixels.iter().map(|pixel| self.error_of(pixel, stops, tonemap).max_element()).collect();
        if errors.is_empty() {
            return 0.0;
        }
        let rank = (errors.len() * 99).div_ceil(100) - 1;
        *errors.select_nth_unstable_by(rank, f64::total_cmp).1
    }

    /// Standard error of the channels of a pixel as shown, by how what is shown changes with each channel of the mean.
    pub fn shown_error(&self, x: u32, y: u32, stops: f64, tonemap: Tonemap) -> Rgb {
        self.error_of(self.pixel(x, y), stops, tonemap)
    }

    fn error_of(&self, pixel: &Pixel, stops: f64, tonemap: Tonemap) -> Rgb {
        let Some(covariance) = pixel.covariance(self.scale) else { return Rgb::ONE };
        let mean = pixel.mean(self.scale);
        let slope = |axis: Rgb| {
            let step = 1e-6 * mean.length().max(1e-3);
            let [below, above] = [mean - axis * step, mean + axis * step];
            (display(above, stops, tonemap) - display(below, stops, tonemap)) / (2.0 * step)
        };
        let slopes = DMat3::from_cols(slope(Rgb::X), slope(Rgb::Y), slope(Rgb::Z));
        let shown = slopes * covariance * slopes.transpose();
        Rgb::new(shown.x_axis.x, shown.y_axis.y, shown.z_axis.z).max(Rgb::ZERO).map(f64::sqrt)
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

/// The scale for a picture of this typical radiance in which the brightest thing glows with `peak`: a million
/// times the typical still counts in full, or four times the peak, as long as the typical is kept to 14 bits.
pub fn scale_for(typical: f64, peak: f64) -> f64 {
    let typical = if typical > 0.0 { typical } else { peak };
    let limit = (4.0 * peak).clamp(typical * exp2(20.0), typical * exp2(28.0));
    // Within the range of exponents whose reciprocal is a normal number too.
    let exponent = if limit > 0.0 { (rt_lang::math::ln(limit) / std::f64::consts::LN_2).ceil() } else { 0.0 };
    exp2(42.0 - exponent.clamp(-900.0, 900.0))
}
