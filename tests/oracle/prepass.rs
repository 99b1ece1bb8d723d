//! A first look at the scene, from which exposure and the film's scale follow.
//!
//! It depends on nothing but what the picture shows: not on its size, window, seed or samples.

use super::integrator::Scratch;
use super::observer::Observer;
use super::sampler::Sampler;
use super::shape::Place;
use super::{Tracer, film, integrator};
use rayon::prelude::*;
use rt_lang::color::{Rgb, luminance};
use rt_lang::math::{DVec2, exp, ln};
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

/// What paths still carried when the limit of bounces ended them.
#[derive(Default)]
struct Cut(f64);

impl Observer for Cut {
    fn cut(&mut self, _: Place, throughput: Rgb) {
        self.0 += luminance(throughput);
    }
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
    let cells: Vec<(Rgb, f64)> = (0..CELLS * CELLS).into_par_iter().map(|cell| look(tracer, cell)).collect();
    let cut = cells.iter().map(|(_, cut)| cut).sum::<f64>() / f64::from(CELLS * CELLS * PATHS);
    let mut cells: Vec<f64> = cells.iter().map(|(mean, _)| luminance(*mean)).collect();
    cells.sort_unstable_by(f64::total_cmp);
    let typical = log_mean(&cells);
    let bright = cells[cells.len() * 95 / 100].max(typical);
    let scale = film::scale_for(typical, tracer.peak());
    Prepass { exposure_stops: exposure(typical, bright), scale, cut }
}

/// The mean radiance of a cell, and what its paths still carried where they were cut.
fn look(tracer: &Tracer, cell: u32) -> (Rgb, f64) {
    let (x, y) = (cell % CELLS, cell / CELLS);
    let mut scratch = Scratch::default();
    let mut cut = Cut::default();
    let sum: Rgb = (0..PATHS)
        .map(|path| {
            let sampler = Sampler::new(SEED, x, y, path);
            let [u, v] = sampler.pair(super::sampler::Pair::Film);
            let place = DVec2::new(f64::from(x) + u, f64::from(y) + v) / f64::from(CELLS);
            let ray = tracer.eye.through(2.0 * place - 1.0, &sampler);
            integrator::trace(tracer, ray, &sampler, &mut scratch, &mut cut).radiance
        })
        .sum();
    (sum / f64::from(PATHS), cut.0)
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
