//! Traces the newest scene, progressively, and keeps what stays good.

use super::answers::answer_all;
use super::desk::{Desk, Job};
use super::hub::{Aim, Frame, Hub, Shown, State};
use super::work::{Step, Work};
use super::writer::{Page, Writer};
use crate::cli::build::chosen_stops;
use crate::cli::progress::duration;
use crate::cli::terminal::Terminal;
use rayon::ThreadPool;
use rayon::prelude::*;
use rt_lang::change::{self, Change, Paths};
use rt_lang::color::Rgb;
use rt_lang::output::Facts;
use rt_lang::render::light::Source;
use rt_lang::render::shares::Shares;
use rt_lang::render::{
    self, Control, FIRST_NOISE_SAMPLES, Film, MOST_NOISE_SAMPLES, Prepass, Structure, Tracer, Window,
};
use rt_lang::scene::{Background, Scene, Target};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// A first look takes one pixel of so many across and down.
const LOOK: u32 = 8;
/// Between two pictures that are shown so many times as long is traced as it takes to show one.
const SHARE: u32 = 10;

/// What is traced, where it is shown, and where it goes.
pub struct Painter {
    /// Where work comes from.
    pub desk: Arc<Desk>,
    /// Where pictures are shown.
    pub hub: Arc<Hub>,
    /// Where they are written, if they are.
    pub writer: Option<Writer>,
    /// What traces.
    pub threads: Arc<ThreadPool>,
    /// What is said.
    pub terminal: Terminal,
    /// Whether to say only what is wrong.
    pub quiet: bool,
    /// The outputs, as they are named when one is done.
    pub names: String,
}

/// What is left of a job when the next one comes.
#[derive(Default)]
struct Left {
    job: Option<Arc<Job>>,
    structure: Option<Structure>,
    mix: Option<Mix>,
    canvas: Option<Canvas>,
    version: u64,
}

/// A picture that was done, and how bright its lamps have become since.
struct Mix {
    picture: Arc<Frame>,
    shares: Shares,
    /// Of each of their sources.
    factors: Vec<Rgb>,
}

/// A picture that was mixed anew is shown until the traced one has so many samples a pixel.
const ENOUGH: u32 = 16;

/// Samples that were taken of a scene.
struct Canvas {
    film: Film,
    prepass: Prepass,
    work: Work,
    /// What pixels show that have no sample.
    look: Vec<[f32; 5]>,
    /// How long tracing took.
    time: Duration,
    /// The noise when all pixels had a power of two of samples last.
    noise: Option<f64>,
}

impl Painter {
    /// Paints for ever.
    pub fn run(&self) -> ! {
        let mut left = Left::default();
        loop {
            let job = self.desk.take();
            left = self.threads.install(|| Painting::new(self, &job, left).run());
            left.job = Some(job);
        }
    }
}

/// A job under way.
struct Painting<'a> {
    painter: &'a Painter,
    job: &'a Job,
    scene: &'a Scene,
    /// What is different from the job before, which need not be the text before: some are overtaken.
    change: Option<Change>,
    left: Left,
}

impl<'a> Painting<'a> {
    fn new(painter: &'a Painter, job: &'a Job, left: Left) -> Painting<'a> {
        let scene = job.scene();
        let change = left.job.as_ref().map(|before| change::between(before.scene(), scene));
        Painting { painter, job, scene, change, left }
    }

    fn run(mut self) -> Left {
        let tracer = Tracer::with(self.scene, self.left.structure.take());
        let kept = self.change.as_ref().is_some_and(|change| change.paths == Paths::Kept);
        let canvas = self.left.canvas.take().filter(|_| kept);
        if !kept {
            self.remix();
        }
        let remixed = self.left.mix.is_some() && !kept;
        self.say_reason(canvas.is_some(), tracer.keeps_structure(), remixed);
        let prepass = canvas.as_ref().map_or_else(|| tracer.prepass(), |canvas| canvas.prepass);
        std::thread::scope(|scope| {
            let (tracer, prepass) = (&tracer, &prepass);
            let Painter { desk, hub, .. } = self.painter;
            let job = self.job;
            scope.spawn(move || answer_all(desk, hub, tracer, prepass, job));
            self.paint(tracer, *prepass, canvas);
        });
        self.left.structure = Some(tracer.into_structure());
        self.left
    }

    fn say_reason(&self, samples_kept: bool, structure_kept: bool, remixed: bool) {
        let Some(change) = &self.change else { return };
        let what = self.job.names.as_deref().unwrap_or("the text");
        let how = match (&change.paths, samples_kept) {
            (Paths::Kept, true) if change.developed => "developed anew, no ray traced again".to_string(),
            (Paths::Kept, true) if change.target => "all samples kept, going on".to_string(),
            (Paths::Kept, true) => "the picture is the same, all samples kept".to_string(),
            _ if remixed => "remixed at once, re-tracing, structure kept".to_string(),
            _ if structure_kept => "re-tracing, structure kept".to_string(),
            _ => "re-tracing".to_string(),
        };
        let reason = format!("{what} changed: {how}");
        if !self.painter.quiet {
            self.painter.terminal.line(&reason);
        }
        self.painter.hub.say(|status| status.reason = Some(reason));
    }

    /// Where only lamps have become brighter or darker, shows at once what that does to the picture that was done.
    fn remix(&mut self) {
        let mix = self.left.mix.take();
        let (Some(mut mix), Some(change)) = (mix, &self.change) else { return };
        let Paths::Lamps(factors) = &change.paths else { return };
        let factor = |source: &Source| match source {
            Source::Light(index) => factors[*index as usize],
            Source::Primitive(id) => {
                let material = self.scene.primitives[id.0 as usize].material;
                factors[self.scene.lights.len() + material.0 as usize]
            }
        };
        for (sum, source) in mix.factors.iter_mut().zip(mix.shares.sources()) {
            *sum *= factor(source);
        }
        let [width, _] = mix.picture.size;
        let pixels = mix.picture.pixels.par_iter().enumerate().map(|(index, pixel)| {
            let (x, y) = (index as u32 % width, index as u32 / width);
            let [r, g, b] = mix.shares.factor(x, y, &mix.factors);
            let [red, green, blue, error, alpha] = *pixel;
            [red * r, green * g, blue * b, error, alpha]
        });
        let pixels = pixels.collect();
        let frame = self.frame(pixels, 1, mix.picture.samples, true);
        self.painter.hub.show(frame);
        self.left.mix = Some(mix);
    }

    /// Learns how much of the picture is of which lamp, if nobody wants anything else.
    fn learn_shares(&mut self, tracer: &Tracer, frame: Arc<Frame>) {
        let Some(control) = self.painter.desk.begin() else { return };
        if let Ok(Some(shares)) = tracer.shares(&control) {
            let factors = vec![Rgb::ONE; shares.sources().len()];
            self.left.mix = Some(Mix { picture: frame, shares, factors });
        }
    }

    /// Traces until a new job comes.
    fn paint(&mut self, tracer: &Tracer, prepass: Prepass, canvas: Option<Canvas>) {
        let start = Instant::now();
        let desk = &self.painter.desk;
        let fresh = canvas.is_none();
        let mut canvas = match canvas {
            Some(canvas) => canvas,
            None => {
                let Some(canvas) = self.begin(tracer, prepass) else { return };
                canvas
            }
        };
        let mut aim = self.first_aim();
        let mut written = 0;
        let (mut shown, mut cost) = (Instant::now(), Duration::ZERO);
        if !fresh {
            self.show(&mut canvas, true);
        }
        while !desk.is_news() {
            let first = desk.first();
            let Some(step) = canvas.work.next(aim, first) else {
                if let Some(next) = self.next_aim(&canvas, aim) {
                    aim = next;
                    continue;
                }
                let frame = self.finish(&mut canvas, start);
                self.learn_shares(tracer, frame);
                desk.rest(first);
                continue;
            };
            let Some(control) = desk.begin() else { break };
            self.say_progress(&canvas, aim, State::Rendering);
            if !self.step(tracer, &mut canvas, &step, &control) {
                continue;
            }
            let level = canvas.work.level(aim);
            if level > written && level < aim {
                written = level;
                let frame = self.show(&mut canvas, true);
                self.write(&canvas, frame, None);
            } else if shown.elapsed() > SHARE * cost {
                let start = Instant::now();
                self.show(&mut canvas, false);
                (shown, cost) = (Instant::now(), start.elapsed());
            }
        }
        self.left.canvas = Some(canvas);
    }

    /// Takes a first look. None if a new job comes before it is done.
    fn begin(&mut self, tracer: &Tracer, prepass: Prepass) -> Option<Canvas> {
        let start = Instant::now();
        let control = self.painter.desk.begin()?;
        self.say_shown(&prepass);
        let look = tracer.look(LOOK, &control).ok()?;
        let pixel = |seen: Option<Rgb>| match seen {
            Some(radiance) => {
                let [r, g, b] = radiance.to_array().map(|v| v as f32);
                [r, g, b, f32::INFINITY, 1.0]
            }
            None => [0.0, 0.0, 0.0, f32::INFINITY, 0.0],
        };
        let look: Vec<[f32; 5]> = look.into_iter().map(pixel).collect();
        if self.left.mix.is_none() {
            let frame = self.frame(look.clone(), LOOK, [0, 1], false);
            self.painter.hub.show(frame);
        }
        let size = self.scene.trace.size;
        let film = Film::new(Window::whole(size), prepass.scale);
        Some(Canvas { film, prepass, work: Work::new(size), look, time: start.elapsed(), noise: None })
    }

    fn step(&self, tracer: &Tracer, canvas: &mut Canvas, step: &Step, control: &Control) -> bool {
        let start = Instant::now();
        let Canvas { film, .. } = canvas;
        let traced = tracer.add_samples_in(&step.windows, film, step.samples.clone(), control).is_ok();
        let time = start.elapsed();
        canvas.time += time;
        if traced {
            canvas.work.done(step, time);
        }
        traced
    }

    /// How many samples to go for.
    fn first_aim(&self) -> u32 {
        match self.scene.trace.target {
            Target::Samples(n) => n.max(1),
            Target::Noise(_) => FIRST_NOISE_SAMPLES,
        }
    }

    /// How many to go for when those are there; none where the picture is done.
    fn next_aim(&self, canvas: &Canvas, aim: u32) -> Option<u32> {
        match self.scene.trace.target {
            Target::Samples(_) => None,
            Target::Noise(wanted) => {
                let noise = self.noise(canvas);
                (noise > wanted && aim < MOST_NOISE_SAMPLES).then_some(aim * 2)
            }
        }
    }

    fn noise(&self, canvas: &Canvas) -> f64 {
        let shown = self.shown(&canvas.prepass);
        canvas.film.noise(shown.stops, shown.tonemap)
    }

    fn shown(&self, prepass: &Prepass) -> render::Shown {
        let develop = self.scene.develop;
        let stops = develop.exposure.unwrap_or(chosen_stops(prepass));
        render::Shown { stops, tonemap: develop.tonemap }
    }

    fn say_shown(&self, prepass: &Prepass) {
        let render::Shown { stops, tonemap } = self.shown(prepass);
        let size = self.scene.trace.size;
        self.painter.hub.say(|status| {
            status.size = size;
            status.develop = Some(Shown { stops, tonemap });
        });
    }

    fn say_progress(&self, canvas: &Canvas, aim: u32, state: State) {
        let [samples, _] = canvas.work.samples();
        let paused = self.painter.desk.is_paused();
        let left = canvas.work.left(aim).map(|left| left.as_secs_f64());
        let target = match self.scene.trace.target {
            Target::Samples(n) => Aim::Samples(n),
            Target::Noise(noise) => Aim::Noise(noise),
        };
        let picture = self.job.generation;
        let noise = canvas.noise;
        self.painter.hub.say(|status| {
            if status.state != State::Error {
                status.state = if paused && state == State::Rendering { State::Paused } else { state };
            }
            status.samples = samples;
            status.seconds = canvas.time.as_secs_f64();
            (status.left, status.target, status.noise) = (left, Some(target), noise);
            status.picture = picture;
        });
    }

    /// Shows what there is, unless that is still worse than what was mixed.
    fn show(&mut self, canvas: &mut Canvas, even: bool) -> Arc<Frame> {
        self.say_shown(&canvas.prepass);
        if even && canvas.work.samples()[0] > 1 {
            canvas.noise = Some(self.noise(canvas));
        }
        let samples = canvas.work.samples();
        let frame = self.frame(pixels(canvas, self.scene.trace.size), 1, samples, false);
        if samples[0] >= ENOUGH {
            self.left.mix = None;
        }
        if self.left.mix.is_none() {
            self.painter.hub.show(frame.clone());
        }
        frame
    }

    fn frame(&mut self, pixels: Vec<[f32; 5]>, step: u32, samples: [u32; 2], remixed: bool) -> Arc<Frame> {
        self.left.version += 1;
        let (generation, size) = (self.job.generation, self.scene.trace.size);
        let version = self.left.version;
        Arc::new(Frame { generation, version, size, step, samples, pixels, remixed })
    }

    fn finish(&mut self, canvas: &mut Canvas, start: Instant) -> Arc<Frame> {
        self.left.mix = None;
        let frame = self.show(canvas, true);
        let [samples, _] = canvas.work.samples();
        self.say_progress(canvas, samples, State::Done);
        let [width, height] = self.scene.trace.size;
        let unit = if samples == 1 { "sample" } else { "samples" };
        let time = duration(start.elapsed());
        let line = format!("{}{width}×{height}, {samples} {unit} in {time}", self.painter.names);
        match &self.painter.writer {
            Some(_) => self.write(canvas, frame.clone(), (!self.painter.quiet).then_some(line)),
            None if !self.painter.quiet => self.painter.terminal.line(&line),
            None => {}
        }
        frame
    }

    fn write(&self, canvas: &Canvas, frame: Arc<Frame>, done: Option<String>) {
        let Some(writer) = &self.painter.writer else { return };
        let render::Shown { stops, tonemap } = self.shown(&canvas.prepass);
        let [samples, _] = canvas.work.samples();
        let facts = Facts {
            samples: Some(u64::from(samples)),
            seed: Some(self.scene.trace.seed),
            scene: Some(self.scene.hash().to_hex().to_string()),
            stops: Some(stops),
            tonemap: Some(tonemap),
            ..Facts::unknown()
        };
        let transparent = self.scene.trace.background == Background::Transparent;
        writer.put(Page { frame, facts, transparent, done });
    }
}

/// What pixels show: their means, or where there are no samples the first look.
fn pixels(canvas: &Canvas, [width, height]: [u32; 2]) -> Vec<[f32; 5]> {
    let Canvas { film, look, .. } = canvas;
    let columns = width.div_ceil(LOOK);
    let row = |y: u32| (0..width).map(move |x| (x, y));
    let pixel = |(x, y): (u32, u32)| match film.samples(x, y) {
        0 => look[(y / LOOK * columns + x / LOOK) as usize],
        _ => {
            let [r, g, b] = film.mean(x, y).to_array().map(|v| (v as f32).clamp(f32::MIN, f32::MAX));
            [r, g, b, film.error(x, y) as f32, film.alpha(x, y) as f32]
        }
    };
    (0..height).into_par_iter().flat_map_iter(row).map(pixel).collect()
}
