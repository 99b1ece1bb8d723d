//! A first look at the scene, from which exposure and the film's scale follow.
//!
//! It depends on nothing but what the picture shows: not on its size, window, seed or samples.

use super::camera::Eye;
use super::queue::{Arrived, Job, Jobs, View};
use super::{Tracer, film};
use crate::color::{Rgb, luminance};
use crate::math::{exp, ln};
use crate::scene::Filter;
use rayon::prelude::*;
use std::f64::consts::LN_2;

/// What the first look found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prepass {
    /// The exposure in stops that shows the scene neither dark nor blown out.
    pub exposure_stops: f64,
    /// Fixed-point units in radiance 1: the film's scale, a power of two.
    pub scale: f64,
    /// About the share of the picture's mean radiance that is lost because paths end at the limit of bounces: the
    /// mean throughput of such paths, as if they ended at what the picture shows on average.
    pub cut: f64,
}

/// Cells across and down, and paths in each.
const CELLS: u32 = 32;
const PATHS: u32 = 4;
const SEED: u64 = 0x7072_6570_6173_7321;

/// Radiance that shows as a middle grey.
const MIDDLE: f64 = 0.18;
/// Radiance that the brightest twentieth of the picture begins at.
const BRIGHT: f64 = 0.9;

pub(super) fn prepass(tracer: &Tracer) -> Prepass {
    let eye = Eye::with(&tracer.scene.camera, [CELLS; 2], Filter::Box, &tracer.space);
    // Where light is looked for depends on the size of the picture.
    let view = View::new(&eye, SEED).by_luck();
    let rows: Vec<Row> = (0..CELLS)
        .into_par_iter()
        .map(|row| {
            let mut row = Row::new(row);
            tracer.trace(&view, &mut row);
            row
        })
        .collect();
    let paths = f64::from(PATHS);
    let cut = rows.iter().map(Row::cut).sum::<f64>() / (f64::from(CELLS * CELLS) * paths);
    let means = rows.iter().flat_map(Row::sums);
    let mut cells: Vec<f64> = means.map(|sum| luminance(sum) * tracer.unit / paths).collect();
    cells.sort_unstable_by(f64::total_cmp);
    let typical = log_mean(&cells);
    let bright = cells[cells.len() * 95 / 100].max(typical);
    let scale = film::scale_for(typical, tracer.peak());
    Prepass { exposure_stops: exposure(typical, bright), scale, cut }
}

/// A row of cells. Paths end in any order, so each keeps its own place.
struct Row {
    y: u32,
    next: u32,
    radiance: [Rgb; (CELLS * PATHS) as usize],
    /// What paths still carried when the limit of bounces ended them, in fixed point.
    cut: u64,
}

/// Units of the fixed point in a throughput of 1.
const CUT_SCALE: f64 = (1u64 << 32) as f64;

impl Row {
    fn new(y: u32) -> Row {
        Row { y, next: 0, radiance: [Rgb::ZERO; (CELLS * PATHS) as usize], cut: 0 }
    }

    fn sums(&self) -> impl Iterator<Item = Rgb> {
        self.radiance.chunks_exact(PATHS as usize).map(|paths| paths.iter().sum())
    }

    fn cut(&self) -> f64 {
        self.cut as f64 / CUT_SCALE
    }
}

impl Jobs for Row {
    fn next(&mut self) -> Option<Job> {
        let pixel = self.next;
        self.next += 1;
        let job = Job { x: pixel / PATHS, y: self.y, sample: pixel % PATHS, pixel };
        (job.x < CELLS).then_some(job)
    }

    fn finish(&mut self, arrived: &Arrived) {
        self.radiance[arrived.pixel as usize] = super::jobs::wide(arrived.radiance);
    }

    fn cut(&mut self, throughput: Rgb) {
        self.cut += (luminance(throughput) * CUT_SCALE) as u64;
    }
}

/// The geometric mean of what is not black, each raised to a thousandth of the mean at least: noise in the
/// shadows must not count. The mean cuts the brightest twentieth, where a single light may be above all measure.
pub(super) fn log_mean(sorted: &[f64]) -> f64 {
    let lit: Vec<f64> = sorted.iter().copied().filter(|v| *v > 0.0).collect();
    let Some(&bright) = lit.get(lit.len() * 95 / 100) else { return 0.0 };
    let count = lit.len() as f64;
    let mean = lit.iter().map(|v| v.min(bright) / count).sum::<f64>();
    exp(lit.iter().map(|v| ln(v.max(1e-3 * mean)) / count).sum())
}

/// Between what makes the typical a middle grey and what puts the bright just below white, in stops; nearer to the
/// second, so that a bright scene stays one.
fn exposure(typical: f64, bright: f64) -> f64 {
    if typical == 0.0 {
        return 0.0;
    }
    let stops = (ln(MIDDLE / typical) + 2.0 * ln(BRIGHT / bright)) / (3.0 * LN_2);
    // To a hundredth, so that it can be pinned as it is printed.
    ((stops * 100.0).round() / 100.0).clamp(-100.0, 100.0)
}
