//! What is far brighter than all around it: lamps that are small, sparkles, and the edges of what is bright. A filter would spread
//! it over its surroundings, where a thousandth of it is more than what is there, so it is taken out before and put back behind.

use super::COLORS;
use super::noise::brightness;
use super::planes::Planes;
use rayon::prelude::*;

/// Pixels to every side of one that are its surroundings.
const AROUND: usize = 3;
/// The share of them, the darkest, that tells how bright they are.
const DARKER: f32 = 0.75;
/// How many times brighter than that a pixel may be.
const MOST: f32 = 10.0;
/// The same share of the brightness of the whole picture is never too bright.
const LEAST: f32 = 0.1;

/// What was taken out of a picture.
pub(super) struct Highlights {
    planes: Planes,
}

impl Highlights {
    /// Takes what is too bright out of both halves of a picture; `left` is what is left of each pixel, of 1. What was in one half
    /// alone is no highlight and has been cut before.
    pub(super) fn taken(halves: &mut [Planes; 2], share: &[f32], left: &mut [f32]) -> Highlights {
        let mean = super::mixed(&halves[1], &halves[0], share);
        let bright = brightness(&mean);
        let limits = limits(&bright, mean.size);
        let factor = |(bright, limit): (&f32, &f32)| if bright > limit { limit / bright } else { 1.0 };
        let factors: Vec<f32> = bright.iter().zip(&limits).map(factor).collect();
        for plane in halves.iter_mut().flat_map(|half| half.planes.iter_mut().take(COLORS)) {
            plane.iter_mut().zip(&factors).for_each(|(v, factor)| *v *= factor);
        }
        left.iter_mut().zip(&factors).for_each(|(left, factor)| *left *= factor);
        let mut planes = mean.scaled(&factors, |v, factor| v - v * factor);
        planes.planes.truncate(COLORS);
        Highlights { planes }
    }

    /// Puts it back.
    pub(super) fn give_back(&self, picture: &mut Planes) {
        for (plane, more) in picture.planes.iter_mut().zip(&self.planes.planes) {
            plane.iter_mut().zip(more).for_each(|(v, more)| *v = v.max(0.0) + more);
        }
    }
}

/// How bright each pixel may be.
fn limits(bright: &[f32], [width, height]: [usize; 2]) -> Vec<f32> {
    let least = LEAST * darker(&mut bright.to_vec());
    let around = |at: usize, length: usize| at.saturating_sub(AROUND)..(at + AROUND + 1).min(length);
    let limit = |index: usize| {
        let (rows, columns) = (around(index / width, height), around(index % width, width));
        let mut near: Vec<f32> = rows.flat_map(|y| &bright[y * width..][columns.clone()]).copied().collect();
        MOST * darker(&mut near).max(least).max(0.0)
    };
    (0..bright.len()).into_par_iter().map(limit).collect()
}

/// The mean of the darker ones.
fn darker(values: &mut [f32]) -> f32 {
    let count = ((values.len() as f32 * DARKER) as usize).max(1);
    values.sort_unstable_by(f32::total_cmp);
    values[..count].iter().sum::<f32>() / count as f32
}
