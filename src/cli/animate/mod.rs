//! `rtc build --sweep … --frames N`: films.
//!
//! A frame is the picture that `rtc build --set` makes of the values it has, but for what the camera leaves open, its place and
//! the exposure: that is chosen once, by the first frame of the whole film, so that a film neither jumps nor flickers, whoever
//! makes which of its frames. What frames have in common is read, parsed, decoded and built once.
//!
//! | module | what it holds |
//! |---|---|
//! | [`orders`] | what the flags ask for |
//! | [`names`], [`only`] | where frames go, and which are made |
//! | [`mark`] | which frames are done |
//! | [`sink`], [`video`] | films in one file |

mod mark;
mod names;
mod only;
mod orders;
mod sink;
mod video;

use super::args::{Build, Resume};
use super::build::{self, Context};
use super::files::Disk;
use super::interrupt::Interrupt;
use super::messages::Messenger;
use super::progress::duration;
use super::target::{Target, patiently};
use super::terminal::Terminal;
use super::trace::{Before, Plan, Traced, trace};
use super::{Exit, Problem, develop, input, keep, scene as scenes};
use mark::Found;
pub use names::has_number;
use orders::Orders;
use rt_lang::check::Moment;
use rt_lang::diagnostic::Diagnostic;
use rt_lang::lower::Overrides;
use rt_lang::output::animation::Reel;
use rt_lang::output::{Facts, Format, Picture, decode_shown};
use rt_lang::render::Tracer;
use rt_lang::render::halt::Limits;
use rt_lang::saved::Head;
use rt_lang::scene::{Background, Scene};
use rt_lang::{Compiled, Finding, Options, Series};
use sink::Sink;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

/// Makes the frames in turn, and the films that they are in.
pub fn run(arguments: &Build, terminal: Terminal, interrupt: &Interrupt) -> Result<Exit, Problem> {
    let orders = Orders::new(arguments)?;
    let context = Context::new(arguments, terminal, interrupt)?;
    let mut messenger = Messenger::new(&arguments.messages, terminal, arguments.quiet);
    let ended = film(&context, &orders, &mut messenger);
    messenger.finish()?;
    ended
}

fn film(context: &Context, orders: &Orders, messenger: &mut Messenger) -> Result<Exit, Problem> {
    let Build { reading, taking, halting, animating, .. } = context.arguments;
    let start = Instant::now();
    let (disk, input) = scenes::open(&orders.scene, reading)?;
    if let Some(refused) = input.refused {
        return messenger.say(&[refused], &input.sources);
    }
    let overrides = Overrides { limited: halting.time.is_some(), ..taking.overrides() };
    let options = Options { sweep: animating.sweep.clone(), ..reading.options(overrides) };
    let series = Series::new(&disk, input.sources, input.id, options);
    let mut studio = Studio {
        context,
        orders,
        disk: &disk,
        series,
        messenger,
        said: BTreeSet::new(),
        stands: false,
        exposure: None,
        before: Before::default(),
        worst: Exit::Done,
    };
    match studio.shoot() {
        Ok(Some(films)) => {
            if !context.arguments.quiet {
                studio.sum_up(&films, start);
            }
            Ok(studio.worst)
        }
        Ok(None) => Ok(Exit::Diagnostics),
        Err(problem) => Err(problem),
    }
}

/// A film in the making.
struct Studio<'a, 'm> {
    context: &'a Context<'a>,
    orders: &'a Orders,
    disk: &'a Disk,
    series: Series<'a>,
    messenger: &'a mut Messenger<'m>,
    /// What was said, of which frame ever: its code and place.
    said: BTreeSet<(&'static str, String, u32)>,
    /// Whether the first frame chose, for all, where the camera stands or looks.
    stands: bool,
    /// In stops, where the first frame chose it for all.
    exposure: Option<f64>,
    before: Before,
    worst: Exit,
}

/// What came of a frame.
enum Shot {
    /// It was made.
    Made(Picture, Facts),
    /// It was there, in these files.
    There(Vec<Target>),
    /// The scene has errors.
    Failed,
}

impl Studio<'_, '_> {
    /// Makes all frames that are asked for, and gives a line about each film that is done. None where the scene has errors.
    fn shoot(&mut self) -> Result<Option<Vec<String>>, Problem> {
        let orders = self.orders;
        let Some(first) = self.compile(1)? else { return Ok(None) };
        orders.refuse_inputs(&self.disk.read_paths(), self.series.sources())?;
        let Some(scene) = &first.scene else { return Ok(None) };
        if let Some(vantage) = first.vantage {
            self.series.hold(vantage);
            self.stands = vantage.chosen;
        }
        self.choose_exposure(scene);
        // Better now than after a night.
        if orders.of > 1 {
            if self.compile(orders.of)?.is_none() {
                return Ok(None);
            }
            orders.refuse_inputs(&self.disk.read_paths(), self.series.sources())?;
        }
        let wait = self.context.arguments.keeping.wait.unwrap_or_default();
        let mut films = patiently(wait, self.context, || self.open(scene))?;
        orders.make_folder()?;
        let lines = if self.context.arguments.quiet { &[][..] } else { &first.notes };
        lines.iter().for_each(|note| self.context.terminal.line(note));
        drop(first);
        // Frames that others are making come last, but for a film, which wants them in turn.
        let mut busy = vec![];
        for &number in &orders.numbers {
            let patience = if films.is_empty() { Duration::ZERO } else { wait };
            match self.add(number, patience, &mut films) {
                Err(problem) if problem.busy && films.is_empty() => busy.push(number),
                Ok(true) => {}
                Ok(false) => return Ok(None),
                Err(problem) => return Err(problem),
            }
        }
        let (start, mut failed) = (Instant::now(), None);
        for number in busy {
            match self.add(number, wait.saturating_sub(start.elapsed()), &mut films) {
                Err(problem) if problem.busy => failed = failed.or(Some(problem)),
                Ok(true) => {}
                Ok(false) => return Ok(None),
                Err(problem) => return Err(problem),
            }
        }
        match failed {
            Some(problem) => Err(problem),
            None => films.into_iter().map(Sink::finish).collect::<Result<_, _>>().map(Some),
        }
    }

    /// Makes a frame, unless it is done, and adds it to the films. Whether the scene has no errors.
    fn add(&mut self, number: u32, patience: Duration, films: &mut [Sink]) -> Result<bool, Problem> {
        let context = self.context;
        let (picture, facts) = match patiently(patience, context, || self.frame(number))? {
            Shot::Made(picture, facts) => (picture, facts),
            Shot::There(_) if films.is_empty() => return Ok(true),
            Shot::There(targets) => read(&targets)?,
            Shot::Failed => return Ok(false),
        };
        for film in films {
            if let Some(warning) = context.threads.install(|| film.add(&picture, &facts))? {
                context.say(&format!("warning: {warning}"));
            }
        }
        Ok(true)
    }

    /// Compiles a frame, and says of it what was not said of another. None where it has errors.
    fn compile(&mut self, number: u32) -> Result<Option<Compiled>, Problem> {
        let Orders { of, .. } = *self.orders;
        let moment = Moment { index: number - 1, of };
        let mut compiled = self.series.at(moment);
        let diagnostics = std::mem::take(&mut compiled.diagnostics);
        let ended = self.say(&diagnostics)?;
        if let (Exit::Done, Some(scene)) = (ended, &mut compiled.scene) {
            scene.develop.exposure = scene.develop.exposure.or(self.exposure);
            return Ok(Some(compiled));
        }
        let swept = self.series.swept(moment, &compiled.inventory).join("`, `");
        let swept = if swept.is_empty() { swept } else { format!(", with `{swept}`,") };
        self.context.terminal.line(&format!("frame {number} of {of}{swept} cannot be made"));
        Ok(None)
    }

    fn say(&mut self, diagnostics: &[Diagnostic]) -> Result<Exit, Problem> {
        let sources = self.series.sources();
        let new = |diagnostic: &&Diagnostic| {
            let place = diagnostic.primary.span;
            self.said.insert((diagnostic.code.as_str(), sources.get(place.source).name.clone(), place.start))
        };
        let new: Vec<Diagnostic> = diagnostics.iter().filter(new).cloned().collect();
        let ended = if new.is_empty() { Exit::Done } else { self.messenger.say(&new, sources)? };
        self.worst = self.worst.max(ended);
        Ok(ended)
    }

    /// Takes the first look that chooses the exposure of all frames, unless the scene or a flag gives it.
    fn choose_exposure(&mut self, scene: &Scene) {
        if scene.develop.exposure.is_some() {
            return;
        }
        let (stops, structure) = self.context.threads.install(|| {
            let tracer = Tracer::at_once(scene, None);
            (build::chosen_stops(&tracer.prepass()), tracer.into_structure())
        });
        self.exposure = Some(stops);
        self.before.structure = Some(structure);
    }

    /// Makes sure before any work that every film can be made and written.
    fn open(&self, scene: &Scene) -> Result<Vec<Sink>, Problem> {
        let Context { arguments, interrupt, .. } = *self.context;
        let window = build::window(scene, arguments.crop)?;
        let reel = Reel {
            size: [window.width, window.height],
            transparent: scene.trace.background == Background::Transparent,
            frames: self.orders.numbers.len() as u32,
            rate: self.orders.rate,
        };
        let (depth, keeps) = (arguments.taking.look.bits, arguments.keeping.keeps());
        let films = self.orders.films.iter();
        films.map(|(path, form)| Sink::open(path, *form, (reel, depth), keeps, interrupt)).collect()
    }

    /// Makes a frame, unless it is done.
    fn frame(&mut self, number: u32) -> Result<Shot, Problem> {
        let start = Instant::now();
        let Context { arguments, interrupt, terminal, ref threads, .. } = *self.context;
        let Some(compiled) = self.compile(number)? else { return Ok(Shot::Failed) };
        let targets = self.orders.targets(number)?;
        let Some(from) = compiled.provenance(self.series.sources()) else { return Ok(Shot::Failed) };
        let (scene, depth, keeping) = (from.scene, arguments.taking.look.bits, &arguments.keeping);
        let window = build::window(scene, arguments.crop)?;
        let plan = Plan::new(arguments, from, window, &targets)?.of_frame();
        let subject = mark::subject(scene, &plan, &arguments.aov, depth);
        let mut anew = String::new();
        if keeping.keeps() && keeping.resume != Some(Resume::Never) {
            match mark::find(&subject, &targets) {
                Found::Nothing => {}
                Found::Other(why) => anew = format!(", made anew: {why}"),
                Found::Done => {
                    if !arguments.quiet {
                        terminal.line(&format!("{} is done", self.orders.name(number)));
                    }
                    self.clear(&targets, &plan)?;
                    return Ok(Shot::There(targets));
                }
            }
        }
        let read = self.disk.read_paths();
        build::refuse_inputs_as_outputs(&read, &build::paths(&targets))?;
        plan.refuse_replacing(&read)?;
        let staged = build::stage(self.context, &targets, scene, window)?;
        let name = format!("{} {number}/{}", self.orders.scene.display(), self.orders.of);
        let traced =
            threads.install(|| trace(self.context, Path::new(&name), plan, Some(&mut self.before)))?;
        threads
            .install(|| build::write(traced.versions(), &traced.facts, &traced.channels, depth, staged))?;
        if keeping.keeps() {
            if let Err(problem) = mark::record(&subject, &targets, interrupt) {
                terminal.warning(&problem.help("the frame is made; asked for again, it is made anew"));
            }
            remove_checkpoint(&targets, |_| true)?;
        }
        let findings = self.findings(&compiled, scene, &traced);
        self.say(&findings)?;
        if !arguments.quiet {
            let taken = build::taken(&traced, start.elapsed());
            let went_on = traced.account.went_on().map_or(String::new(), |said| format!(", {said}"));
            terminal.line(&format!("{}: {taken}{went_on}{anew}", self.orders.name(number)));
        }
        let shown = traced.denoised.map_or(traced.picture, |denoised| denoised.picture);
        Ok(Shot::Made(shown, traced.facts))
    }

    /// Removes the checkpoint of a frame that was left when that was done, unless there may be more in it.
    fn clear(&self, targets: &[Target], plan: &Plan) -> Result<(), Problem> {
        let Limits { samples, noise, time, .. } = *plan.limits();
        let has_no_more = |head: &Head| head.facts.samples.is_some_and(|[_, most]| most <= samples);
        let is_fixed = (noise, time) == (None, None);
        remove_checkpoint(targets, |head| is_fixed && head.subject == plan.subject() && has_no_more(head))
    }

    /// What is probably not meant in a frame. An exposure that another frame chose may well burn this one out.
    fn findings(&self, compiled: &Compiled, scene: &Scene, traced: &Traced) -> Vec<Diagnostic> {
        let limited = self.context.arguments.taking.samples.is_some();
        let findings = build::findings(scene, traced, limited).into_iter();
        let findings = findings
            .filter(|finding| self.exposure.is_none() || !matches!(finding, Finding::BurntOut { .. }));
        findings.filter_map(|finding| compiled.judge(&finding)).collect()
    }

    fn sum_up(&self, films: &[String], start: Instant) {
        let terminal = self.context.terminal;
        films.iter().for_each(|film| terminal.line(film));
        let exposure = self.exposure.map_or(String::new(), |stops| {
            format!(
                "; exposure chosen by frame 1 for all; to keep it, write `exposure: {stops}` in the camera"
            )
        });
        let camera = if self.stands { "; camera placed by frame 1 for all" } else { "" };
        let (made, of) = (self.orders.numbers.len(), self.orders.of);
        let unit = if of == 1 { "frame" } else { "frames" };
        let which =
            if made == of as usize { format!("{of} {unit}") } else { format!("{made} of {of} {unit}") };
        terminal.line(&format!("{which} in {}{camera}{exposure}", duration(start.elapsed())));
    }
}

/// Removes a checkpoint, for what is done needs no samples any more. What is none is nobody's to remove.
fn remove_checkpoint(targets: &[Target], needless: impl FnOnce(&Head) -> bool) -> Result<(), Problem> {
    let kept = keep::beside(targets)?;
    if keep::head(&kept).is_some_and(|head| needless(&head)) {
        let _ = fs::remove_file(kept);
    }
    Ok(())
}

/// A frame that was there. One that goes into a film is kept as an EXR, if it is kept.
fn read(targets: &[Target]) -> Result<(Picture, Facts), Problem> {
    let exr = targets.iter().find(|target| target.format == Format::Exr);
    let exr = exr.ok_or_else(|| Problem::new("no EXR holds the frame"))?;
    let bytes = input::read_plain(&exr.path, develop::LARGEST)?;
    decode_shown(&bytes)
        .map_err(|reason| Problem::new(format!("`{}` cannot be read: {reason}", exr.path.display())))
}
