//! Traces the newest scene, progressively, and keeps what stays good.

use super::desk::{Desk, Job, Question};
use super::hub::{Aim, Frame, Hub, Shown, State};
use super::work::{Step, Work};
use super::writer::{Page, Writer};
use crate::cli::build::chosen_stops;
use crate::cli::progress::duration;
use crate::cli::terminal::Terminal;
use rayon::ThreadPool;
use rayon::prelude::*;
use rt_lang::change::Paths;
use rt_lang::output::Facts;
use rt_lang::render::{
    self, Control, FIRST_NOISE_SAMPLES, Film, MOST_NOISE_SAMPLES, Prepass, Structure, Tracer, Window,
};
use rt_lang::scene::{Background, Scene, Target};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// A first look takes one pixel of so many across and down.
const LOOK: u32 = 8;

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
    structure: Option<Structure>,
    canvas: Option<Canvas>,
    version: u64,
}

/// Samples that were taken of a scene.
struct Canvas {
    film: Film,
    prepass: Prepass,
    work: Work,
    /// What pixels show that have no sample.
    look: Vec<[f32; 5]>,
    /// How long tracing took.
    time: Duration,
}

impl Painter {
    /// Paints for ever.
    pub fn run(&self) -> ! {
        let mut left = Left::default();
        loop {
            let job = self.desk.take();
            left = self.threads.install(|| Painting::new(self, &job, left).run());
        }
    }
}

/// A job under way.
struct Painting<'a> {
    painter: &'a Painter,
    job: &'a Job,
    scene: &'a Scene,
    left: Left,
}

impl<'a> Painting<'a> {
    fn new(painter: &'a Painter, job: &'a Job, left: Left) -> Painting<'a> {
        Painting { painter, job, scene: job.scene(), left }
    }

    fn run(mut self) -> Left {
        let tracer = Tracer::with(self.scene, self.left.structure.take());
        let kept = self.job.change.as_ref().is_some_and(|change| change.paths == Paths::Kept);
        let canvas = self.left.canvas.take().filter(|_| kept);
        self.say_reason(canvas.is_some(), tracer.keeps_structure());
        std::thread::scope(|scope| {
            let tracer = &tracer;
            let (desk, job) = (&self.painter.desk, self.job);
            scope.spawn(move || {
                while let Some(question) = desk.question() {
                    answer(tracer, job, question);
                }
            });
            self.paint(tracer, canvas);
        });
        self.left.structure = Some(tracer.into_structure());
        self.left
    }

    fn say_reason(&self, samples_kept: bool, structure_kept: bool) {
        let Some(change) = &self.job.change else { return };
        let what = self.job.reason.as_deref().unwrap_or("the text");
        let how = match (&change.paths, samples_kept) {
            (Paths::Kept, true) if change.developed => "developed anew, no ray traced again".to_string(),
            (Paths::Kept, true) if change.target => "all samples kept, going on".to_string(),
            (Paths::Kept, true) => "the picture is the same, all samples kept".to_string(),
            _ if structure_kept => "re-tracing, structure kept".to_string(),
            _ => "re-tracing".to_string(),
        };
        let reason = format!("{what} changed: {how}");
        if !self.painter.quiet {
            self.painter.terminal.line(&reason);
        }
        self.painter.hub.say(|status| status.reason = Some(reason));
    }

    /// Traces until a new job comes.
    fn paint(&mut self, tracer: &Tracer, canvas: Option<Canvas>) {
        let start = Instant::now();
        let desk = &self.painter.desk;
        let fresh = canvas.is_none();
        let mut canvas = match canvas {
            Some(canvas) => canvas,
            None => {
                let Some(canvas) = self.begin(tracer) else { return };
                canvas
            }
        };
        let mut aim = self.first_aim();
        let mut written = 0;
        if !fresh {
            self.show(&canvas);
        }
        while !desk.is_news() {
            let first = desk.first();
            let Some(step) = canvas.work.next(aim, first) else {
                if let Some(next) = self.next_aim(&canvas, aim) {
                    aim = next;
                    continue;
                }
                self.finish(&canvas, start);
                desk.rest(first);
                continue;
            };
            let Some(control) = desk.begin() else { break };
            self.say_progress(&canvas, aim, State::Rendering);
            if self.step(tracer, &mut canvas, &step, &control) {
                self.show(&canvas);
                let level = canvas.work.level(aim);
                if level > written && level < aim {
                    written = level;
                    self.write(&canvas, None);
                }
            }
        }
        self.left.canvas = Some(canvas);
    }

    /// Takes a first look. None if a new job comes before it is done.
    fn begin(&mut self, tracer: &Tracer) -> Option<Canvas> {
        let start = Instant::now();
        let control = self.painter.desk.begin()?;
        let prepass = tracer.prepass();
        self.say_shown(&prepass);
        let look = tracer.look(LOOK, &control).ok()?;
        let pixel = |seen: Option<rt_lang::color::Rgb>| match seen {
            Some(radiance) => {
                let [r, g, b] = radiance.to_array().map(|v| v as f32);
                [r, g, b, f32::INFINITY, 1.0]
            }
            None => [0.0, 0.0, 0.0, f32::INFINITY, 0.0],
        };
        let look: Vec<[f32; 5]> = look.into_iter().map(pixel).collect();
        self.frame(look.clone(), LOOK, [0, 1]);
        let size = self.scene.trace.size;
        let film = Film::new(Window::whole(size), prepass.scale);
        Some(Canvas { film, prepass, work: Work::new(size), look, time: start.elapsed() })
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
        let noise = (samples > 1).then(|| self.noise(canvas));
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

    /// Shows what there is.
    fn show(&mut self, canvas: &Canvas) {
        self.say_shown(&canvas.prepass);
        self.frame(pixels(canvas, self.scene.trace.size), 1, canvas.work.samples());
    }

    fn frame(&mut self, pixels: Vec<[f32; 5]>, step: u32, samples: [u32; 2]) {
        self.left.version += 1;
        let (generation, size) = (self.job.generation, self.scene.trace.size);
        let version = self.left.version;
        self.painter.hub.show(Frame { generation, version, size, step, samples, pixels, remixed: false });
    }

    fn finish(&mut self, canvas: &Canvas, start: Instant) {
        self.show(canvas);
        let [samples, _] = canvas.work.samples();
        self.say_progress(canvas, samples, State::Done);
        let [width, height] = self.scene.trace.size;
        let unit = if samples == 1 { "sample" } else { "samples" };
        let time = duration(start.elapsed());
        let line = format!("{}{width}×{height}, {samples} {unit} in {time}", self.painter.names);
        match &self.painter.writer {
            Some(_) => self.write(canvas, (!self.painter.quiet).then_some(line)),
            None if !self.painter.quiet => self.painter.terminal.line(&line),
            None => {}
        }
    }

    fn write(&self, canvas: &Canvas, done: Option<String>) {
        let (Some(writer), Some(frame)) = (&self.painter.writer, self.painter.hub.frame()) else { return };
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

/// Answers a question. Whoever asked may be gone.
fn answer(tracer: &Tracer, job: &Job, question: Question) {
    let _ = (tracer, job);
    match question {
        Question::Why { reply, .. } => drop(reply.send(Err("not yet".into()))),
        Question::Light { reply, .. } => drop(reply.send(None)),
    }
}
