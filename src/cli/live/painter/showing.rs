//! What is shown of a picture under way, and said of it.

use super::{Canvas, Painting};
use crate::cli::build::chosen_stops;
use crate::cli::live::hub::{Aim, Frame, Shown, State};
use crate::cli::live::said::listed;
use crate::cli::live::writer::Page;
use rayon::prelude::*;
use rt_lang::change::Paths;
use rt_lang::output::Facts;
use rt_lang::render::Prepass;
use rt_lang::scene::{Background, Target};
use std::sync::Arc;

/// A picture that was mixed anew is shown until the traced one has so many samples a pixel.
const ENOUGH: u32 = 16;

impl Painting<'_> {
    pub(super) fn say_reason(&self, samples_kept: bool, structure_kept: bool) {
        let Some(change) = &self.change else { return };
        let what = listed(self.names).unwrap_or_else(|| "the text".into());
        let how = match (&change.paths, samples_kept) {
            (Paths::Kept, true) if change.developed && change.target => {
                "developed anew, all samples kept, going on".to_string()
            }
            (Paths::Kept, true) if change.developed => "developed anew, no ray traced again".to_string(),
            (Paths::Kept, true) if change.target => "all samples kept, going on".to_string(),
            (Paths::Kept, true) => "the picture is the same, all samples kept".to_string(),
            (Paths::Lamps(_), _) if self.left.mixing => {
                "remixed at once, re-tracing, structure kept".to_string()
            }
            _ if structure_kept => "re-tracing, structure kept".to_string(),
            _ => "re-tracing".to_string(),
        };
        let reason = format!("{what} changed: {how}");
        if !self.painter.quiet {
            self.painter.terminal.line(&reason);
        }
        self.painter.hub.say(|status| status.reason = Some(reason));
    }

    fn noise(&self, canvas: &Canvas) -> f64 {
        let Shown { stops, tonemap } = self.shown(&canvas.prepass);
        canvas.film.noise(stops, tonemap)
    }

    pub(super) fn shown(&self, prepass: &Prepass) -> Shown {
        let develop = self.scene.develop;
        let stops = develop.exposure.unwrap_or(chosen_stops(prepass));
        Shown { stops, tonemap: develop.tonemap }
    }

    pub(super) fn say_progress(&self, canvas: &Canvas, state: State) {
        let [samples, _] = canvas.work.samples();
        let left = canvas.work.left(canvas.aim).map(|left| left.as_secs_f64());
        let target = match self.scene.trace.target {
            Target::Samples(n) => Aim::Samples(n),
            Target::Noise(noise) => Aim::Noise(noise),
        };
        let generation = self.job.generation;
        self.painter.hub.say(|status| {
            // A newer text may have errors, or be on its way.
            if status.generation == generation {
                let paused = status.paused && state == State::Rendering;
                status.state = if paused { State::Paused } else { state };
            }
            status.samples = samples;
            status.seconds = canvas.time.as_secs_f64();
            (status.left, status.target, status.noise) = (left, Some(target), canvas.noise);
        });
    }

    /// Shows what there is, unless that is still worse than what was mixed.
    pub(super) fn show(&mut self, canvas: &mut Canvas, even: bool) -> Arc<Frame> {
        let samples = canvas.work.samples();
        if even && samples[0] > 1 {
            canvas.noise = Some(self.noise(canvas));
        }
        let shown = self.shown(&canvas.prepass);
        let mut frame = self.frame(pixels(canvas, self.scene.trace.size), 1, samples, shown, false);
        if let (Some(limit), Some(Frame { facts, .. })) = (canvas.limit, Arc::get_mut(&mut frame)) {
            (facts.noise, facts.limit) = (canvas.noise, Some(limit.word().into()));
        }
        if samples[0] >= ENOUGH.min(canvas.aim) {
            self.left.mixing = false;
        }
        if !self.left.mixing {
            self.painter.hub.show(frame.clone());
        }
        frame
    }

    pub(super) fn frame(
        &mut self,
        pixels: Vec<[f32; 5]>,
        step: u32,
        samples: [u32; 2],
        shown: Shown,
        remixed: bool,
    ) -> Arc<Frame> {
        self.left.version += 1;
        let scene = self.scene;
        let facts = Facts { stops: Some(shown.stops), tonemap: Some(shown.tonemap), ..Facts::unknown() };
        let facts = match remixed {
            // Nothing that could be traced again.
            true => facts,
            false => Facts {
                samples: Some(samples),
                seed: Some(scene.trace.seed),
                scene: Some(self.hash.clone()),
                ..facts
            },
        };
        Arc::new(Frame {
            generation: self.job.generation,
            version: self.left.version,
            size: scene.trace.size,
            step,
            samples,
            pixels,
            remixed,
            shown,
            facts,
            transparent: scene.trace.background == Background::Transparent,
        })
    }

    pub(super) fn write(&self, frame: Arc<Frame>, done: Option<String>) {
        if let Some(writer) = &self.painter.writer {
            writer.put(Page { frame, done });
        }
    }
}

/// What pixels show: their means, or where there are no samples the first look.
fn pixels(canvas: &Canvas, [width, height]: [u32; 2]) -> Vec<[f32; 5]> {
    let Canvas { film, look, .. } = canvas;
    let columns = width.div_ceil(look.step);
    let row = |y: u32| (0..width).map(move |x| (x, y));
    let pixel = |(x, y): (u32, u32)| match film.samples(x, y) {
        0 => look.pixels[(y / look.step * columns + x / look.step) as usize],
        _ => {
            let [r, g, b] = film.mean(x, y).to_array().map(|v| (v as f32).clamp(f32::MIN, f32::MAX));
            [r, g, b, film.error(x, y) as f32, film.alpha(x, y) as f32]
        }
    };
    (0..height).into_par_iter().flat_map_iter(row).map(pixel).collect()
}
