//! What many paths did, all over a picture: which of them make the noise, which lights give nothing, what is never met, and
//! what the limit of bounces costs.

use super::Tracer;
use super::apart::Watched;
use super::film::Window;
use super::light::Source;
use super::observer::PathKind;
use crate::color::luminance;
use crate::scene::PrimitiveId;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// About how many paths are watched, spread over a picture.
pub const PATHS: u32 = 200_000;
/// Paths of a pixel at least, for noise is told by how they differ.
const LEAST_PATHS: u32 = 16;

/// What light makes a difference from path to path: what the camera sees, the light, and how it comes there.
pub type Cause = (Option<PrimitiveId>, Source, PathKind);

/// What many paths did.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Feedback {
    /// How many.
    pub paths: u32,
    /// Shares of the noise, each the variance of what a cause adds to a pixel, beside the pixel's brightness as a viewer
    /// sees it. Shares add up to 1.
    pub noise: BTreeMap<Cause, f64>,
    /// Lights that gave anything.
    pub giving: BTreeSet<Source>,
    /// Surfaces that paths met.
    pub met: BTreeSet<PrimitiveId>,
    /// Where the limit of bounces ended paths, with the shares of the light that was lost there, if what they would have
    /// brought is as bright as the picture on average.
    pub cut: BTreeMap<PrimitiveId, f64>,
    /// How many paths it ended.
    pub cut_paths: u32,
}

/// What the paths of a pixel did.
struct Tally {
    mean: f64,
    /// Of its noise the variance of the mean, and of what was cut the throughput.
    did: Feedback,
}

/// A tenth of the picture's mean is added to a pixel's before its noise is put beside it: noise in the dark is not seen.
const DARK: f64 = 0.1;

impl Tracer<'_> {
    /// Watches some paths all over a window, the same ones each time, on the current rayon pool.
    pub fn feedback(&self, window: Window) -> Feedback {
        let (pixels, samples) = spread(window);
        let tallies: Vec<Tally> = pixels.par_iter().map(|pixel| self.tally(*pixel, samples)).collect();
        let mean = tallies.iter().map(|tally| tally.mean).sum::<f64>() / tallies.len().max(1) as f64;
        let mut feedback = Feedback { paths: pixels.len() as u32 * samples, ..Feedback::default() };
        for Tally { mean: own, did } in tallies {
            feedback.merge(did, own.max(0.0) + DARK * mean);
        }
        let noise: f64 = feedback.noise.values().sum();
        feedback.noise.values_mut().for_each(|share| *share /= noise);
        let paths = f64::from(feedback.paths.max(1));
        feedback.cut.values_mut().for_each(|throughput| *throughput /= paths);
        feedback
    }

    fn tally(&self, pixel: [u32; 2], samples: u32) -> Tally {
        let (mut mean, mut did) = (0.0, Feedback::default());
        let n = f64::from(samples);
        let mut sums: BTreeMap<Cause, [f64; 2]> = BTreeMap::new();
        for path in (0..samples).map(|sample| self.watched(pixel, sample)) {
            let first = path.first.map(|first| first.primitive());
            let mut causes: BTreeMap<Cause, f64> = BTreeMap::new();
            for part in &path.contributions {
                let light = path.sampled.weight * luminance(part.radiance);
                *causes.entry((first, part.source, part.kind())).or_default() += light;
            }
            for (cause, light) in causes {
                let [sum, squares] = sums.entry(cause).or_default();
                *sum += light;
                *squares += light * light;
            }
            mean += luminance(path.sampled.radiance) / n;
            did.add(&path);
        }
        let variance = |[sum, squares]: [f64; 2]| (squares - sum * sum / n) / (n - 1.0) / n;
        did.noise = sums.into_iter().map(|(cause, sums)| (cause, variance(sums))).collect();
        Tally { mean, did }
    }
}

impl Feedback {
    fn add(&mut self, watched: &Watched) {
        let bright = watched.contributions.iter().filter(|part| luminance(part.radiance) > 0.0);
        self.giving.extend(bright.map(|part| part.source));
        self.met.extend(watched.met.iter().map(|place| place.primitive));
        if let Some((place, throughput)) = watched.cut {
            self.cut_paths += 1;
            *self.cut.entry(place.primitive).or_default() += luminance(throughput);
        }
    }

    /// Adds what the paths of a pixel did that shows so bright.
    fn merge(&mut self, other: Feedback, shown: f64) {
        for (cause, variance) in other.noise {
            if variance > 0.0 && shown > 0.0 {
                *self.noise.entry(cause).or_default() += variance / (shown * shown);
            }
        }
        self.giving.extend(other.giving);
        self.met.extend(other.met);
        for (primitive, throughput) in other.cut {
            *self.cut.entry(primitive).or_default() += throughput;
        }
        self.cut_paths += other.cut_paths;
    }
}

/// Pixels spread evenly over a window, and how many paths of each to watch.
fn spread(window: Window) -> (Vec<[u32; 2]>, u32) {
    let all = window.pixels() as u32;
    let most = PATHS / LEAST_PATHS;
    // As many across and down as keep the shape of the window.
    let thin = (f64::from(most) / f64::from(all.max(1))).sqrt().min(1.0);
    let across = ((f64::from(window.width) * thin) as u32).clamp(1, window.width.min(most).max(1));
    let down = (most / across).min(((f64::from(window.height) * thin) as u32).max(1)).max(1);
    let place = |index: u32, count: u32, length: u32| {
        ((2 * u64::from(index) + 1) * u64::from(length) / (2 * u64::from(count))) as u32
    };
    let pixels: Vec<[u32; 2]> = (0..down)
        .flat_map(|j| (0..across).map(move |i| [i, j]))
        .map(|[i, j]| [window.x + place(i, across, window.width), window.y + place(j, down, window.height)])
        .collect();
    let samples = (PATHS / pixels.len().max(1) as u32).clamp(LEAST_PATHS, 4096);
    (pixels, samples)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_are_spread_over_the_window_and_bounded() {
        for (width, height) in [(1, 1), (16, 12), (640, 480), (10_000, 10_000), (100_000, 1), (1, 100_000)] {
            let window = Window { x: 5, y: 7, width, height };
            let (pixels, samples) = spread(window);
            assert!(!pixels.is_empty() && pixels.len() as u32 * samples <= PATHS, "{width}×{height}");
            let distinct: BTreeSet<_> = pixels.iter().collect();
            assert_eq!(distinct.len(), pixels.len());
            let within = |[x, y]: &[u32; 2]| (5..5 + width).contains(x) && (7..7 + height).contains(y);
            assert!(pixels.iter().all(within));
        }
    }
}
