//! Traces the newest scene, progressively, and keeps what stays good.

mod showing;

use super::answers::answer_all;
use super::bomb::{Bomb, Broken};
use super::desk::{Desk, Effort, Job};
use super::hub::{Frame, Hub, Shown, State};
use super::mix::Mix;
use super::work::{Step, Work};
use super::writer::Writer;
use crate::cli::progress::duration;
use crate::cli::terminal::Terminal;
use rayon::ThreadPool;
use rayon::prelude::*;
use rt_lang::change::{self, Change, Paths};
use rt_lang::color::Rgb;
use rt_lang::render::halt::{self, FIRST_NOISE_SAMPLES, Limit, MOST_NOISE_SAMPLES};
use rt_lang::render::{Control, Film, Prepass, Structure, Tracer, Window};
use rt_lang::scene::{Scene, Target};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// A first look takes one pixel of so many across and down.
const LOOK: u32 = 8;
/// Pictures of up to so many pixels are seen whole sooner than it is known where caustics come from.
const SOON: u64 = 1 << 18;
/// Between two pictures that are shown so many times as long is traced as it takes to show one.
const SHARE: u32 = 10;
/// And at least so long, unless somebody waits for a window: a page takes as long to paint a picture as this to trace one, and
/// is to have time for whoever uses it.
const CALM: Duration = Duration::from_millis(200);

/// What is traced, where it is shown, and where it goes.
pub struct Painter {
    /// Where work comes from.
    pub desk: Arc<Desk>,
    /// Where pictures are shown.
    pub hub: Arc<Hub>,
    /// Where they are written, if they are.
    pub writer: Option<Writer>,
    /// What traces, behind all else that the machine does.
    pub threads: ThreadPool,
    /// What does what somebody waits for.
    pub front: ThreadPool,
    /// What is said.
    pub terminal: Terminal,
    /// Whether to say only what is wrong.
    pub quiet: bool,
    /// The outputs, as they are named when one is done.
    pub names: String,
    /// What is done where it panics.
    pub broken: Broken,
}

/// What is left of a job when the next one comes.
#[derive(Default)]
struct Left {
    job: Option<Arc<Job>>,
    structure: Option<Structure>,
    mix: Option<Mix>,
    canvas: Option<Canvas>,
    /// Whether a mix is shown in place of a picture with few samples.
    mixing: bool,
    version: u64,
}

/// A picture of one pixel in so many, to look at until there is a better one.
#[derive(Default)]
struct Look {
    step: u32,
    /// As [`Frame::pixels`] has them.
    pixels: Vec<[f32; 5]>,
}

/// Samples that were taken of a scene.
struct Canvas {
    film: Film,
    prepass: Prepass,
    work: Work,
    /// What pixels show that have no sample.
    look: Look,
    /// How long tracing took.
    time: Duration,
    /// The noise when all pixels had a power of two of samples last.
    noise: Option<f64>,
    /// How many samples it went for last.
    aim: u32,
    /// What it stopped at, once it did.
    limit: Option<Limit>,
    /// Whether it is done, and was written as it is developed.
    done: bool,
}

impl Painter {
    /// Paints as long as there may be work.
    pub fn run(&self) {
        let _bomb = Bomb(self.broken.clone());
        let mut left = Left::default();
        while let Some((job, names)) = self.desk.take() {
            left = Painting::new(self, &job, &names, left).run();
            left.job = Some(job);
        }
    }
}

/// A job under way.
struct Painting<'a> {
    painter: &'a Painter,
    job: &'a Job,
    /// What a person calls what is different from the job before.
    names: &'a [String],
    scene: &'a Scene,
    /// What is different from the job before, which need not be the text before: some are overtaken.
    change: Option<Change>,
    /// The scene's, in hexadecimal.
    hash: String,
    left: Left,
}

impl<'a> Painting<'a> {
    fn new(painter: &'a Painter, job: &'a Job, names: &'a [String], left: Left) -> Painting<'a> {
        let scene = job.scene();
        let hash = scene.hash().to_hex().to_string();
        let change = left.job.as_ref().map(|before| change::between(before.scene(), scene));
        Painting { painter, job, names, scene, change, hash, left }
    }

    fn run(mut self) -> Left {
        let Painter { front, threads, desk, hub, broken, .. } = self.painter;
        let mut tracer = front.install(|| Tracer::at_once(self.scene, self.left.structure.take()));
        let canvas = self.left.canvas.take().and_then(|canvas| self.keep(canvas));
        let prepass = match &canvas {
            Some(canvas) => canvas.prepass,
            None => front.install(|| tracer.prepass()),
        };
        front.install(|| self.remix(&prepass));
        self.say_reason(canvas.is_some(), tracer.keeps_structure());
        let fresh = canvas.is_none();
        let begun = canvas.or_else(|| front.install(|| self.begin(&tracer, prepass)));
        if let Some(canvas) = begun {
            if threads.install(|| self.find_caustics(&mut tracer)) {
                std::thread::scope(|scope| {
                    let (tracer, prepass, job) = (&tracer, canvas.prepass, self.job);
                    scope.spawn(move || {
                        let _bomb = Bomb(broken.clone());
                        front.install(|| answer_all(desk, hub, tracer, &prepass, job));
                    });
                    threads.install(|| self.paint(tracer, canvas, fresh));
                });
            } else {
                self.left.canvas = Some(canvas);
            }
        }
        self.left.structure = Some(tracer.into_structure());
        self.left
    }

    /// Looks where caustics come from. False if a new job comes before that is known.
    fn find_caustics(&self, tracer: &mut Tracer) -> bool {
        // It is cancelled too where only another window is to come first.
        while let Some(control) = self.painter.desk.begin(Effort::Short) {
            if tracer.find_caustics(&control).is_ok() {
                return true;
            }
        }
        false
    }

    /// What stays good of the samples there are.
    fn keep(&self, mut canvas: Canvas) -> Option<Canvas> {
        let change = self.change.as_ref().filter(|change| change.paths == Paths::Kept)?;
        let [_, most] = canvas.work.samples();
        // It must not have gone on where a picture made afresh would end.
        let unchanged = !change.target && !change.developed;
        let within = match self.scene.trace.target {
            Target::Samples(n) => most <= n.max(1),
            Target::Noise(_) => unchanged || most <= FIRST_NOISE_SAMPLES,
        };
        if !unchanged {
            canvas.aim = self.first_aim();
            canvas.work.refine_all();
            (canvas.limit, canvas.done) = (None, false);
        }
        within.then_some(canvas)
    }

    /// Where only lamps have become brighter or darker, shows at once what that does to the picture that was done; and goes on
    /// to show it where nothing but words, or how it is developed, has changed since.
    fn remix(&mut self, prepass: &Prepass) {
        let was_mixing = std::mem::take(&mut self.left.mixing);
        let Some(change) = &self.change else { return };
        match (&change.paths, &mut self.left.mix) {
            (Paths::Lamps(factors), Some(mix)) => mix.relight(self.scene, factors),
            (Paths::Kept, Some(_)) if was_mixing => {}
            (Paths::New, _) => return self.left.mix = None,
            _ => return,
        }
        let Some(mix) = &self.left.mix else { return };
        let (pixels, samples) = (mix.pixels(), mix.picture.samples);
        let frame = self.frame(pixels, 1, samples, self.shown(prepass), true);
        self.painter.hub.show(frame);
        self.left.mixing = true;
    }

    /// Learns how much of the picture is of which lamp, if nobody wants anything else.
    fn learn_shares(&mut self, tracer: &Tracer, picture: &Arc<Frame>) {
        // It is cancelled too where only another window is to come first.
        while let Some(control) = self.painter.desk.begin(Effort::Long) {
            if let Ok(mix) = Mix::learn(tracer, picture, &control) {
                self.left.mix = mix;
                return;
            }
        }
    }

    /// Traces until a new job comes.
    fn paint(&mut self, tracer: &Tracer, mut canvas: Canvas, fresh: bool) {
        let painter = self.painter;
        let _bomb = Bomb(painter.broken.clone());
        let desk = &painter.desk;
        let mut written = 0;
        let (mut shown, mut cost) = (Instant::now(), Duration::ZERO);
        if !fresh {
            self.show(&mut canvas, false);
        }
        while !desk.is_news() {
            let first = desk.first();
            let Some(step) = canvas.work.next(canvas.aim, first) else {
                if let Some(limit) = self.go_on(&mut canvas) {
                    canvas.limit = Some(limit);
                } else {
                    continue;
                }
                self.finish(tracer, &mut canvas);
                desk.rest(first);
                continue;
            };
            let Some(control) = desk.begin(Effort::Long) else { break };
            self.say_progress(&canvas, State::Rendering);
            if !self.step(tracer, &mut canvas, &step, &control) {
                continue;
            }
            let level = canvas.work.level(canvas.aim);
            if level > written && level < canvas.aim {
                written = level;
                let frame = self.show(&mut canvas, true);
                self.write(frame, None);
            } else if shown.elapsed()
                > (SHARE * cost).max(if first.is_some() { Duration::ZERO } else { CALM })
            {
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
        let size = self.scene.trace.size;
        let mut look = Look::default();
        let soon = !tracer.knows_caustics() && size.map(u64::from).iter().product::<u64>() <= SOON;
        for step in if soon { &[LOOK, 1][..] } else { &[LOOK] } {
            look = self.look(tracer, *step)?;
            if !self.left.mixing {
                let shown = self.shown(&prepass);
                let frame = self.frame(look.pixels.clone(), *step, [0, 1], shown, false);
                self.painter.hub.show(frame);
            }
            // These were of the picture before.
            self.painter.hub.say(|status| {
                (status.samples, status.seconds) = (0, start.elapsed().as_secs_f64());
                (status.noise, status.left) = (None, None);
            });
        }
        let film = Film::new(Window::whole(size), prepass.scale);
        let (work, time) = (Work::new(size), start.elapsed());
        Some(Canvas {
            film,
            prepass,
            work,
            look,
            time,
            noise: None,
            aim: self.first_aim(),
            limit: None,
            done: false,
        })
    }

    /// Looks at one pixel of so many across and down. None if a new job comes before it is done.
    fn look(&self, tracer: &Tracer, step: u32) -> Option<Look> {
        let seen = loop {
            let control = self.painter.desk.begin(Effort::Short)?;
            // It is cancelled too where only another window is to come first.
            if let Ok(seen) = tracer.look(step, &control) {
                break seen;
            }
        };
        let pixel = |seen: Option<Rgb>| match seen {
            Some(radiance) => {
                let [r, g, b] = radiance.to_array().map(|v| v as f32);
                [r, g, b, f32::INFINITY, 1.0]
            }
            None => [0.0, 0.0, 0.0, f32::INFINITY, 0.0],
        };
        Some(Look { step, pixels: seen.into_par_iter().map(pixel).collect() })
    }

    fn step(&self, tracer: &Tracer, canvas: &mut Canvas, step: &Step, control: &Control) -> bool {
        let start = Instant::now();
        let Canvas { film, .. } = canvas;
        let traced = tracer.add_samples_in(&step.windows, film, step.samples.clone(), control).is_ok();
        let time = start.elapsed().saturating_sub(control.paused_for());
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

    /// Aims for more when the samples there were to be are there, as `rtc build` does; or says at what the picture stops.
    fn go_on(&self, canvas: &mut Canvas) -> Option<Limit> {
        let Target::Noise(wanted) = self.scene.trace.target else { return Some(Limit::Samples) };
        let Shown { stops, tonemap } = self.shown(&canvas.prepass);
        let noisy = halt::noisy(&canvas.film, rt_lang::render::Shown { stops, tonemap }, wanted);
        if !noisy.contains(&true) {
            return Some(Limit::Noise);
        }
        if canvas.aim >= MOST_NOISE_SAMPLES {
            return Some(Limit::Samples);
        }
        canvas.work.refine(canvas.film.window().tiles(halt::BLOCK), &noisy);
        canvas.aim *= 2;
        None
    }

    /// The picture is done: says so once, and gets ready for what may come.
    fn finish(&mut self, tracer: &Tracer, canvas: &mut Canvas) {
        if !canvas.done {
            let frame = self.show(canvas, true);
            let [samples, _] = canvas.work.samples();
            let [width, height] = self.scene.trace.size;
            let unit = if samples == 1 { "sample" } else { "samples" };
            let time = duration(canvas.time);
            let line = format!("{}{width}×{height}, {samples} {unit} in {time}", self.painter.names);
            match &self.painter.writer {
                Some(_) => self.write(frame.clone(), (!self.painter.quiet).then_some(line)),
                None if !self.painter.quiet => self.painter.terminal.line(&line),
                None => {}
            }
            canvas.done = true;
            self.say_progress(canvas, State::Done);
            self.learn_shares(tracer, &frame);
        }
        self.say_progress(canvas, State::Done);
    }
}
