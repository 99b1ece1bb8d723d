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
//! | `highlights` | pixels that are far brighter than what lies around |
//! | `weights` | how alike pixels are |
//! | `regression` | fits, and what they say of the pixels around |
//!
//! It knows numbers of pixels and nothing of scenes. Only + − × ÷ √ are used, in an order that does not depend on threads, so a
//! picture has the same bits on every processor. It takes about 450 bytes a pixel beside what it is given.

mod highlights;
mod noise;
mod planes;
mod regression;
#[cfg(test)]
mod tests;
mod weights;

use highlights::Highlights;
use planes::Planes;
use regression::{fitted, work};
use weights::{Guide, Kernel, means};

/// What the method is called, with the number of its form: pictures of another number differ in more than their noise.
pub const METHOD: &str = "nfor 1";

/// Red, green and blue.
const COLORS: usize = 3;
/// Features of a pixel.
pub const FEATURES: usize = 7;

/// A picture as it was traced, with what is known of its noise. All lists are row by row from the top left.
#[derive(Clone, Debug, PartialEq)]
pub struct Noisy {
    /// Columns and rows.
    pub size: [u32; 2],
    /// Linear red, green and blue, by one part of the samples and by the others, in any unit; times alpha, if there is any.
    pub halves: [Vec<[f32; 3]>; 2],
    /// The share of each pixel that is covered, from 0 to 1, in the same way; none where all are.
    pub alpha: Option<[Vec<f32>; 2]>,
    /// The share of the samples that the first part has, about a half.
    pub share: Vec<f32>,
    /// The variance of the luminance of the mean of all samples, in that unit squared. Only where it is larger than elsewhere
    /// counts.
    pub variance: Vec<f32>,
    /// What tells things apart, in numbers about 1: normals, albedo and the like, by one half of some samples and by the other.
    pub guides: [Vec<[f32; FEATURES]>; 2],
}

/// What is told of work as it is done, in units of [`whole_work`].
pub type Done<'d> = &'d (dyn Fn(u64) + Sync);

/// A picture without noise, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct Clean {
    /// Its colours, in the unit of the noisy ones.
    pub pixels: Vec<[f32; 3]>,
    /// Its alpha, if the noisy one has any.
    pub alpha: Option<Vec<f32>>,
}

/// What mixes features, each half by what the other shows (section 5.1).
const FEATURE: Kernel = Kernel { radius: 3, patch: 3, bandwidth: 0.5, dense: 3 };
/// What fits colours (section 5.2). Of what is farther away than `dense`, every other pixel is enough.
const FIT: Kernel = Kernel { radius: 9, patch: 3, bandwidth: 1.0, dense: 3 };
/// Squarings of the weights of [`FIT`]: those of bandwidths 1 and 1/2.
const SQUARINGS: [u32; 2] = [0, 2];
/// What mixes estimates of errors, and choices between bandwidths (section 5.3).
const CHOICE: Kernel = Kernel { radius: 3, patch: 1, bandwidth: 1.0, dense: 3 };
/// How many times the noise a fit's error must be where it is not taken: estimates are noisy too.
const MUCH_WORSE: f32 = 2.0;
/// Variance of features that is nothing.
const LEAST_VARIANCE: f32 = 1e-8;

/// All the work that [`denoise`] tells of a picture of this size.
pub fn whole_work([width, height]: [u32; 2]) -> u64 {
    let pixels = width as usize * height as usize;
    2 * work(pixels, SQUARINGS.len()) + work(pixels, 1)
}

/// The picture without noise, in the unit of the noisy one; how far it is is told to `done`, by any thread. No channel is
/// below 0. What is no number counts as 0, and what is more than a hundred million times the mean as that.
///
/// # Panics
///
/// If a list does not have as many entries as the picture has pixels.
pub fn denoise(noisy: &Noisy, done: Done) -> Clean {
    let size = noisy.size.map(|side| side as usize);
    let pixels = size[0] * size[1];
    let alpha = noisy.alpha.iter().flatten().map(Vec::len);
    let lengths = [&noisy.share, &noisy.variance].map(Vec::len).into_iter().chain(alpha);
    let mut lengths =
        lengths.chain(noisy.halves.each_ref().map(Vec::len)).chain(noisy.guides.each_ref().map(Vec::len));
    assert!(lengths.all(|length| length == pixels), "every list has an entry for each pixel");
    if pixels == 0 {
        return Clean { pixels: vec![], alpha: noisy.alpha.as_ref().map(|_| vec![]) };
    }
    let unit = noise::unit(&noisy.halves);
    let (mut halves, mut left) = noise::halves(&noisy.halves, size, unit);
    if let Some(alpha) = &noisy.alpha {
        let share = |v: &f32| if v.is_nan() { 0.0 } else { v.clamp(0.0, 1.0) };
        halves
            .iter_mut()
            .zip(alpha)
            .for_each(|(half, alpha)| half.planes.push(alpha.iter().map(share).collect()));
    }
    let share = |v: &f32| if v.is_nan() { 0.5 } else { v.clamp(0.01, 0.99) };
    let share: Vec<f32> = noisy.share.iter().map(share).collect();
    let highlights = Highlights::taken(&mut halves, &share, &mut left);
    let variance = noise::variance(&halves, &share, &noisy.variance, &left, unit);
    let features = features(noisy, size);
    let [a, b] = first_pass(&halves, &share, &variance, &features, done);
    let mut clean = second_pass(&a, &b, &share, &features, done);
    highlights.give_back(&mut clean);
    finished(&clean, unit)
}

/// The picture in its own unit. Alpha beyond 1 is cut, and its colours with it.
fn finished(clean: &Planes, unit: f32) -> Clean {
    let (colors, alpha) = clean.planes.split_at(COLORS);
    let alpha = alpha.first();
    let pixel = |index: usize| {
        let whole = alpha.map_or(1.0, |alpha| alpha[index].max(1.0));
        [0, 1, 2].map(|c| (colors[c][index].max(0.0) / whole / unit).min(f32::MAX))
    };
    let pixels = (0..colors[0].len()).map(pixel).collect();
    Clean { pixels, alpha: alpha.map(|alpha| alpha.iter().map(|v| v.clamp(0.0, 1.0)).collect()) }
}

/// Features without noise, each half by what the other shows (section 5.1).
fn features(noisy: &Noisy, size: [usize; 2]) -> [Planes; 2] {
    let guides = [0, 1].map(|half| Planes::of(size, &noisy.guides[half]).finite(1.0, 1e3));
    let variances = guides[0].zip(&guides[1], |a, b| 0.5 * (a - b) * (a - b)).blurred(1);
    let variances = variances.zip(&variances, |v, _| v + LEAST_VARIANCE);
    [0, 1].map(|half| {
        let guide = Guide { values: &guides[1 - half], variances: &variances };
        means(&guides[half], &guide, &FEATURE)
    })
}

/// Both halves fitted, by that bandwidth which leaves the smaller error, or as they are where both leave a larger one than their
/// noise (sections 5.2 and 5.3). `variance` is that of their mean.
fn first_pass(
    halves: &[Planes; 2],
    share: &[f32],
    variance: &Planes,
    features: &[Planes; 2],
    done: Done,
) -> [Planes; 2] {
    let others: Vec<f32> = share.iter().map(|share| 1.0 - share).collect();
    let of_half = [share, &others].map(|share| variance.scaled(share, |v, share| v / share));
    let mean = mixed(&halves[1], &halves[0], share);
    let fits = [0, 1].map(|half| {
        let variances = noise::floored(&of_half[half], &mean);
        let guide = Guide { values: &halves[half], variances: &variances };
        fitted(&guide, &features[1 - half], &FIT, &SQUARINGS, done)
    });
    let [a, b] = &fits;
    let mut estimates: Vec<Vec<f32>> =
        a.iter().zip(b).map(|(a, b)| errors(halves, share, &of_half, [a, b])).collect();
    estimates
        .push((0..share.len()).map(|index| variance.planes.iter().map(|plane| plane[index]).sum()).collect());
    let variances = noise::floored(variance, &mean);
    let guide = Guide { values: &mean, variances: &variances };
    let estimates = means(&Planes { size: mean.size, planes: estimates }, &guide, &CHOICE);
    let choice = |chosen: usize| -> Vec<f32> {
        let is_least = |index: usize| {
            let [wide, narrow, none] = [0, 1, 2].map(|which| estimates.planes[which][index]);
            let least = if MUCH_WORSE * none < wide.min(narrow) {
                2
            } else if narrow < wide {
                1
            } else {
                0
            };
            if least == chosen { 1.0 } else { 0.0 }
        };
        (0..share.len()).map(is_least).collect()
    };
    let choices = means(&Planes { size: mean.size, planes: vec![choice(1), choice(2)] }, &guide, &CHOICE);
    [0, 1].map(|half| {
        let [wide, narrow] = &fits[half];
        let mut chosen = wide.clone();
        for (fit, choice) in [narrow, &halves[half]].into_iter().zip(&choices.planes) {
            let more = fit.zip(wide, |fit, wide| fit - wide).scaled(choice, |more, choice| more * choice);
            chosen = chosen.zip(&more, |v, more| v + more);
        }
        chosen
    })
}

/// What is estimated of the squared error of the mean of two fits: what each differs from the other half by, less that one's
/// noise, and less what the mean of both is better by than each.
fn errors(halves: &[Planes; 2], share: &[f32], of_half: &[Planes; 2], [a, b]: [&Planes; 2]) -> Vec<f32> {
    let mut errors = vec![0.0; share.len()];
    for channel in 0..halves[0].planes.len() {
        let plane = |planes: &Planes, index: usize| planes.planes[channel][index];
        for (index, (error, share)) in errors.iter_mut().zip(share).enumerate() {
            let (a, b) = (plane(a, index), plane(b, index));
            let (to_a, to_b) = (plane(&halves[1], index) - a, plane(&halves[0], index) - b);
            let of_a = to_a * to_a - plane(&of_half[1], index);
            let of_b = to_b * to_b - plane(&of_half[0], index);
            *error += share * of_a + (1.0 - share) * of_b - share * (1.0 - share) * (a - b) * (a - b);
        }
    }
    errors
}

/// So much of one, and the rest of another.
fn mixed(rest: &Planes, one: &Planes, share: &[f32]) -> Planes {
    let more = one.zip(rest, |one, rest| one - rest).scaled(share, |more, share| more * share);
    rest.zip(&more, |rest, more| rest + more)
}

/// The mean of both halves, without what noise is left in it (section 5.4).
fn second_pass(a: &Planes, b: &Planes, share: &[f32], features: &[Planes; 2], done: Done) -> Planes {
    let mean = mixed(b, a, share);
    let left = a.zip(b, |a, b| (a - b) * (a - b)).scaled(share, |v, share| v * (share * (1.0 - share)));
    let features = features[0].zip(&features[1], |a, b| 0.5 * (a + b));
    let left = noise::floored(&left, &mean);
    let guide = Guide { values: &mean, variances: &left };
    let [fitted] = fitted(&guide, &features, &FIT, &[0], done);
    fitted
}
