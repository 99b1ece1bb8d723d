//! Taking the noise out of a picture that was traced.
//!
//! The method is that of B. Bitterli, F. Rousselle, B. Moon, J. A. Iglesias-Guitián, D. Adler, K. Mitchell, W. Jarosz and J. Novák,
//! "Nonlinearly weighted first-order regression for denoising Monte Carlo renderings", EGSR 2016: what lies around a pixel and looks
//! like it is fitted by a linear function of what is known without noise, the features. Two pictures, each of half of the
//! samples, are denoised apart, and what they differ by tells how well that went.
//!
//! | module | what it holds |
//! |---|---|
//! | `planes` | numbers of pixels, and tiles of them |
//! | `noise` | how noisy the halves are; single samples that are far too bright |
//! | `weights` | how alike pixels are |
//! | `regression` | fits, and what they say of the pixels around |
//!
//! It knows numbers of pixels and nothing of scenes. Only + − × ÷ √ are used, in an order that does not depend on threads, so a
//! picture has the same bits on every processor. It takes about 350 bytes a pixel beside what it is given.

mod noise;
mod planes;
mod regression;
#[cfg(test)]
mod tests;
mod weights;

use planes::Planes;
use regression::fitted;
use weights::{Guide, Kernel, means};

/// Features of a pixel.
pub const FEATURES: usize = 7;

/// A picture as it was traced, with what is known of its noise. All lists are row by row from the top left.
#[derive(Clone, Debug, PartialEq)]
pub struct Noisy {
    /// Columns and rows.
    pub size: [u32; 2],
    /// Linear red, green and blue, by one half of the samples and by the other, in any unit.
    pub halves: [Vec<[f32; 3]>; 2],
    /// The variance of the luminance of the mean of all samples, in that unit squared.
    pub variance: Vec<f32>,
    /// What tells things apart, in numbers about 1: normals, albedo and the like, by one half of some samples and by the other.
    pub guides: [Vec<[f32; FEATURES]>; 2],
}

/// What mixes features, each half by what the other shows (section 5.1).
const FEATURE: Kernel = Kernel { radius: 3, patch: 3, bandwidth: 0.5, dense: 3 };
/// What fits colours (section 5.2). Of what is farther away than `dense`, every other pixel is enough.
const FIT: Kernel = Kernel { radius: 9, patch: 3, bandwidth: 1.0, dense: 3 };
/// Squarings of the weights of [`FIT`]: those of bandwidths 1 and 1/2.
const SQUARINGS: [u32; 2] = [0, 2];
/// What mixes estimates of errors, and choices between bandwidths (section 5.3).
const CHOICE: Kernel = Kernel { radius: 9, patch: 1, bandwidth: 1.0, dense: 1 };

/// The picture without noise, in the unit of the noisy one. No channel is below 0. What is no number counts as 0, and what is
/// more than a hundred million times the mean as that.
///
/// # Panics
///
/// If a list does not have as many entries as the picture has pixels.
pub fn denoise(noisy: &Noisy) -> Vec<[f32; 3]> {
    let size = noisy.size.map(|side| side as usize);
    let pixels = size[0] * size[1];
    let lengths = [
        noisy.halves[0].len(),
        noisy.halves[1].len(),
        noisy.variance.len(),
        noisy.guides[0].len(),
        noisy.guides[1].len(),
    ];
    assert_eq!(lengths, [pixels; 5], "every list has an entry for each pixel");
    if pixels == 0 {
        return vec![];
    }
    let unit = noise::unit(&noisy.halves);
    let halves = noise::halves(&noisy.halves, size, unit);
    let variance = noise::variance(&halves, &noisy.variance, unit);
    let features = features(noisy, size);
    let [a, b] = first_pass(&halves, &variance, &features);
    let fitted = second_pass(&a, &b, &features);
    let channel =
        |channel: usize, index: usize| (fitted.planes[channel][index].max(0.0) / unit).min(f32::MAX);
    (0..pixels).map(|index| [0, 1, 2].map(|c| channel(c, index))).collect()
}

/// Features without noise, each half by what the other shows (section 5.1).
fn features(noisy: &Noisy, size: [usize; 2]) -> [Planes; 2] {
    let guides = [0, 1].map(|half| Planes::of(size, &noisy.guides[half]).finite(1.0, 1e3));
    let variances = guides[0].zip(&guides[1], |a, b| 0.5 * (a - b) * (a - b)).blurred(1);
    [0, 1].map(|half| {
        let guide = Guide { values: &guides[1 - half], variances: &variances };
        means(&guides[half], &guide, &FEATURE)
    })
}

/// Both halves fitted, by that bandwidth which leaves the smaller error (sections 5.2 and 5.3). `variance` is that of their mean.
fn first_pass(halves: &[Planes; 2], variance: &Planes, features: &[Planes; 2]) -> [Planes; 2] {
    let of_half = variance.zip(variance, |a, b| a + b);
    let [a, b] = [0, 1].map(|half| {
        let guide = Guide { values: &halves[half], variances: &of_half };
        fitted(&guide, &features[1 - half], &FIT, &SQUARINGS)
    });
    let errors: Vec<Vec<f32>> = a.iter().zip(&b).map(|(a, b)| errors(halves, &of_half, [a, b])).collect();
    let mean = halves[0].zip(&halves[1], |a, b| 0.5 * (a + b));
    let guide = Guide { values: &mean, variances: variance };
    let errors = means(&Planes { size: mean.size, planes: errors }, &guide, &CHOICE);
    let narrower = |(wide, narrow): (&f32, &f32)| if narrow < wide { 1.0 } else { 0.0 };
    let narrower = errors.planes[0].iter().zip(&errors.planes[1]).map(narrower).collect();
    let share = means(&Planes { size: mean.size, planes: vec![narrower] }, &guide, &CHOICE);
    [a, b].map(|fits| mixed(&fits[0], &fits[1], &share.planes[0]))
}

/// What is estimated of the squared error of the mean of two fits: what each differs from the other half by, less that one's
/// noise, and less what the mean of both is better by than each.
fn errors(halves: &[Planes; 2], of_half: &Planes, [a, b]: [&Planes; 2]) -> Vec<f32> {
    let mut errors = vec![0.0; of_half.planes[0].len()];
    for channel in 0..of_half.planes.len() {
        let plane = |planes: &Planes, index: usize| planes.planes[channel][index];
        for (index, error) in errors.iter_mut().enumerate() {
            let (a, b) = (plane(a, index), plane(b, index));
            let (to_a, to_b) = (plane(&halves[1], index) - a, plane(&halves[0], index) - b);
            let apart = 0.25 * (a - b) * (a - b);
            *error += 0.5 * (to_a * to_a + to_b * to_b) - plane(of_half, index) - apart;
        }
    }
    errors
}

fn mixed(wide: &Planes, narrow: &Planes, share: &[f32]) -> Planes {
    let plane = |(wide, narrow): (&Vec<f32>, &Vec<f32>)| {
        let both = wide.iter().zip(narrow).zip(share);
        both.map(|((wide, narrow), share)| wide + (narrow - wide) * share).collect()
    };
    Planes { size: wide.size, planes: wide.planes.iter().zip(&narrow.planes).map(plane).collect() }
}

/// The mean of both halves, without what noise is left in it (section 5.4).
fn second_pass(a: &Planes, b: &Planes, features: &[Planes; 2]) -> Planes {
    let mean = a.zip(b, |a, b| 0.5 * (a + b));
    let left = a.zip(b, |a, b| 0.25 * (a - b) * (a - b));
    let features = features[0].zip(&features[1], |a, b| 0.5 * (a + b));
    let guide = Guide { values: &mean, variances: &left };
    let [fitted] = fitted(&guide, &features, &FIT, &[0]);
    fitted
}
