//! The sums of one pixel: its light, how its channels vary and vary together, and what covers it.

use crate::color::{Rgb, luminance};

/// Samples a pixel may hold without any sum overflowing.
pub const MOST_SAMPLES: u32 = 1 << 20;

/// Greatest magnitude of one channel of one sample, in units of the fixed point: `MOST_SAMPLES` times this
/// fits an `i64`, and the square of that an `i128`.
const MOST_FIXED: f64 = (1u64 << 42) as f64;

/// Units of the fixed point in a filter weight of 1: `MOST_SAMPLES` weights of less than 8 fit an `i64`.
const WEIGHT_SCALE: f64 = (1u64 << 40) as f64;

/// Greatest magnitude of a filter weight in these units: `MOST_SAMPLES` times it fits an `i64`.
const MOST_WEIGHT: u64 = (8 << 40) - 1;

/// Numbers of 32 bits that hold the sums of a pixel: see [`Pixel::words`].
pub const WORDS: usize = 2 * 3 + 4 * PRODUCTS.len() + 2 * 2 + 1;

/// Those that hold the sums of radiance and coverage alone: see [`LightSums::words`].
pub const LIGHT_WORDS: usize = 2 * 3 + 2 * 2;

/// The channels whose products are summed, red, green and blue being 0, 1 and 2.
const PRODUCTS: [[usize; 2]; 6] = [[0, 0], [1, 1], [2, 2], [0, 1], [0, 2], [1, 2]];

/// What of a pixel's variance is too little to be told from none.
const NEGLIGIBLE: f64 = 1e-6;

/// The sums of radiance and coverage of some samples of a pixel, in units of 1/scale, without those of the products of channels,
/// which tell how samples vary.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LightSums {
    sum: [i64; 3],
    /// Sums of the filter weights of samples that met something, and of those that met nothing in front of a
    /// transparent background.
    covered: i64,
    open: i64,
    samples: u32,
}

impl LightSums {
    /// Mean radiance, in W/(m²·sr).
    pub fn mean(&self, scale: f64) -> Rgb {
        let [r, g, b] = self.sum.map(|sum| sum as f64);
        if self.samples == 0 { Rgb::ZERO } else { Rgb::new(r, g, b) / (scale * f64::from(self.samples)) }
    }

    /// The share that is covered. By the weights of the very samples there are, so that it is exactly 1 or 0 where all of them
    /// agree. A filter with negative weights may lead beyond these, and is cut.
    pub fn alpha(&self) -> f64 {
        match (self.covered, self.open) {
            (_, 0) => 1.0,
            (0, _) => 0.0,
            (covered, open) => {
                let share = covered as f64 / (covered as f64 + open as f64);
                if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) }
            }
        }
    }

    /// How many samples it is of.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// The sums in words as [`Pixel::words`] has them, without the number of samples.
    pub fn words(&self) -> [u32; LIGHT_WORDS] {
        let mut words = [0; LIGHT_WORDS];
        let sums = self.sum.iter().chain([&self.covered, &self.open]);
        for (word, half) in words.iter_mut().zip(sums.flat_map(|sum| halves(*sum as u64))) {
            *word = half;
        }
        words
    }

    /// Those of so many samples, by their words; none where so many cannot have them.
    pub fn from_words(words: [u32; LIGHT_WORDS], samples: u32) -> Option<LightSums> {
        let [r, g, b, covered, open] = [0, 2, 4, 6, 8].map(|i| two(&words, i) as i64);
        LightSums { sum: [r, g, b], covered, open, samples }.checked()
    }

    /// What is left without that of some of these samples; none where it cannot be of some.
    pub(in super::super) fn without(&self, some: &LightSums) -> Option<LightSums> {
        let [r, g, b] = [0, 1, 2].map(|channel| self.sum[channel].checked_sub(some.sum[channel]));
        let others = LightSums {
            sum: [r?, g?, b?],
            covered: self.covered.checked_sub(some.covered)?,
            open: self.open.checked_sub(some.open)?,
            samples: self.samples.checked_sub(some.samples)?,
        };
        others.checked()
    }

    /// The same, if so many samples can have such sums.
    fn checked(self) -> Option<LightSums> {
        let n = u64::from(self.samples);
        let can_be = self.samples <= MOST_SAMPLES
            && self.sum.iter().all(|sum| sum.unsigned_abs() <= n * MOST_FIXED as u64)
            && [self.covered, self.open].iter().all(|sum| sum.unsigned_abs() <= n * MOST_WEIGHT);
        can_be.then_some(self)
    }
}

/// The sums of one pixel, in units of 1/scale.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Pixel {
    light: LightSums,
    /// Of the products of [`PRODUCTS`], sample by sample.
    products: [i128; 6],
}

impl Pixel {
    /// Adds a radiance. One that is too large for the scale is cut; one that is no number counts as black.
    #[inline]
    pub fn add(&mut self, radiance: Rgb, scale: f64) {
        debug_assert!(radiance.is_finite(), "a path carries {radiance}");
        let value = fixed(radiance, scale);
        for (sum, v) in self.light.sum.iter_mut().zip(value) {
            *sum += v;
        }
        for (sum, [a, b]) in self.products.iter_mut().zip(PRODUCTS) {
            *sum += i128::from(value[a]) * i128::from(value[b]);
        }
        self.light.samples += 1;
    }

    /// Adds the weight of a sample to what is covered, or to what is open to a transparent background.
    #[inline]
    pub fn cover(&mut self, open: bool, weight: f64) {
        let sum = if open { &mut self.light.open } else { &mut self.light.covered };
        *sum += nearest(weight * WEIGHT_SCALE);
    }

    /// Adds the samples of another.
    pub fn merge(&mut self, other: &Pixel) {
        let (own, light) = (&mut self.light, &other.light);
        for (sum, v) in own.sum.iter_mut().zip(light.sum) {
            *sum += v;
        }
        for (sum, v) in self.products.iter_mut().zip(other.products) {
            *sum += v;
        }
        own.covered += light.covered;
        own.open += light.open;
        own.samples += light.samples;
    }

    /// The sums of its radiance and coverage, without the products of channels.
    pub fn light(&self) -> &LightSums {
        &self.light
    }

    /// As [`LightSums::alpha`].
    pub(in super::super) fn alpha(&self) -> f64 {
        self.light.alpha()
    }

    /// As [`LightSums::mean`].
    pub(in super::super) fn mean(&self, scale: f64) -> Rgb {
        self.light.mean(scale)
    }

    /// How many samples it holds.
    pub fn samples(&self) -> u32 {
        self.light.samples
    }

    /// The sums as they are, each in words of 32 bits, the lowest first: red, green and blue in two each, their squares and then
    /// the products of red with green, red with blue and green with blue in four each, the weights of what is covered and of
    /// what is open in two each, and the number of samples.
    pub fn words(&self) -> [u32; WORDS] {
        let two = |v: &i64| halves(*v as u64);
        let four = |v: &i128| [halves(*v as u64), halves((*v >> 64) as u64)];
        let LightSums { sum, covered, open, samples } = &self.light;
        let pairs = sum.iter().map(two);
        let pairs = pairs.chain(self.products.iter().flat_map(four));
        let pairs = pairs.chain([covered, open].map(two));
        let mut words = [*samples; WORDS];
        for (word, half) in words.iter_mut().zip(pairs.flatten()) {
            *word = half;
        }
        words
    }

    /// The pixel with these sums; none where so many samples cannot have them.
    pub fn from_words(words: [u32; WORDS]) -> Option<Pixel> {
        let two = |i: usize| two(&words, i);
        let four = |i: usize| (u128::from(two(i)) | u128::from(two(i + 2)) << 64) as i128;
        const WEIGHTS: usize = WORDS - 5;
        let light = LightSums {
            sum: [0, 2, 4].map(|i| two(i) as i64),
            covered: two(WEIGHTS) as i64,
            open: two(WEIGHTS + 2) as i64,
            samples: words[WORDS - 1],
        };
        let pixel =
            Pixel { light: light.checked()?, products: std::array::from_fn(|product| four(6 + 4 * product)) };
        let greatest = u128::from(light.samples) * (MOST_FIXED as u128) * (MOST_FIXED as u128);
        let products = pixel.products.iter().all(|sum| sum.unsigned_abs() <= greatest);
        let squares = pixel.products[..3].iter().all(|sum| *sum >= 0);
        (products && squares).then_some(pixel)
    }

    /// Errors that are independent of each other, and together that of the mean, in W/(m²·sr), as if samples were independent
    /// too: each is what its three channels are off by, together, at one standard error. None below two samples.
    ///
    /// They are the columns of a Cholesky decomposition of the covariance, begun each time at the channel that varies most
    /// (Higham, "Analysis of the Cholesky decomposition of a semi-definite matrix", 1990): light of one colour has one.
    pub(super) fn errors(&self, scale: f64) -> Option<[Rgb; 3]> {
        let mut left = self.covariance()?;
        let negligible = NEGLIGIBLE * (left[0][0] + left[1][1] + left[2][2]);
        let mut errors = [Rgb::ZERO; 3];
        for error in &mut errors {
            let greatest =
                (1..3).fold(0, |g, channel| if left[channel][channel] > left[g][g] { channel } else { g });
            let variance = left[greatest][greatest];
            if variance <= negligible {
                break;
            }
            let column = left[greatest].map(|v| v / variance.sqrt());
            *error = Rgb::from_array(column) / scale;
            for (row, own) in left.iter_mut().zip(column) {
                for (v, other) in row.iter_mut().zip(column) {
                    *v -= own * other;
                }
            }
        }
        Some(errors)
    }

    /// The covariance of the channels of the mean, in units of the fixed point.
    fn covariance(&self) -> Option<[[f64; 3]; 3]> {
        let LightSums { sum: sums, samples, .. } = self.light;
        if samples < 2 {
            return None;
        }
        let n = f64::from(samples);
        let mut covariance = [[0.0; 3]; 3];
        for (sum, [a, b]) in self.products.iter().zip(PRODUCTS) {
            // Exact: nothing is lost where a pixel is bright and even.
            let products = i128::from(samples) * sum;
            let difference = products - i128::from(sums[a]) * i128::from(sums[b]);
            let v = difference as f64 / (n * n * (n - 1.0));
            (covariance[a][b], covariance[b][a]) = (v, v);
        }
        Some(covariance)
    }

    /// Standard error of the mean's luminance in W/(m²·sr); infinite below two samples.
    pub(in super::super) fn error(&self, scale: f64) -> f64 {
        let Some(errors) = self.errors(scale) else { return f64::INFINITY };
        errors.iter().map(|error| luminance(*error) * luminance(*error)).sum::<f64>().sqrt()
    }
}

/// The number whose lower half is this word, and the upper half the next.
fn two(words: &[u32], i: usize) -> u64 {
    u64::from(words[i]) | u64::from(words[i + 1]) << 32
}

/// The lower and the upper half of a number.
fn halves(v: u64) -> [u32; 2] {
    [v as u32, (v >> 32) as u32]
}

/// A radiance as it counts: cut where it is too large for the scale.
pub(in super::super) fn counted(radiance: Rgb, scale: f64) -> Rgb {
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
