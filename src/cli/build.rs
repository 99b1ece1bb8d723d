//! `rtc build`: scenes to pictures.

use super::animate::{self, has_number};
use super::args::Build;
use super::denoise::{self, Clear, Denoised};
use super::input::is_standard;
use super::interrupt::Interrupt;
use super::messages::{Messenger, on_standard_output};
use super::progress::duration;
use super::target::{Staged, Target, patiently};
use super::terminal::Terminal;
use super::trace::{Plan, Traced, take, trace};
use super::{Exit, Problem, claim, keep, scene as scenes, shard};
use rayon::{ThreadPool, ThreadPoolBuilder};
use rt_lang::aov::Aov;
use rt_lang::diagnostic::Diagnostic;
use rt_lang::lower::Overrides;
use rt_lang::output::{Channels, Depth, Facts, Format, Picture, encode, encode_exr};
use rt_lang::render::halt::Limit;
use rt_lang::render::making::Making;
use rt_lang::render::{Control, Prepass, Tracer, Window};
use rt_lang::saved::Subject;
use rt_lang::scene::{Background, Scene};
use rt_lang::why::Provenance;
use rt_lang::{FEW_BOUNCES, Finding};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// A scene with the places of its picture.
struct Job {
    scene: PathBuf,
    targets: Vec<Target>,
}

/// What all jobs share.
pub struct Context<'a> {
    /// The flags.
    pub arguments: &'a Build,
    /// On which pictures are traced.
    pub threads: ThreadPool,
    /// Where things are said.
    pub terminal: Terminal,
    /// Whether to end.
    pub interrupt: &'a Interrupt,
}

impl<'a> Context<'a> {
    /// Starts the threads.
    pub fn new(
        arguments: &'a Build,
        terminal: Terminal,
        interrupt: &'a Interrupt,
    ) -> Result<Context<'a>, Problem> {
        let threads = ThreadPoolBuilder::new().num_threads(arguments.taking.threads.unwrap_or(0)).build();
        let threads = threads.map_err(|error| Problem::new(format!("cannot start the threads: {error}")))?;
        interrupt.heed_requests();
        Ok(Context { arguments, threads, terminal, interrupt })
    }

    /// Says what is no error, to who wants to hear it.
    pub fn say(&self, line: &str) {
        if !self.arguments.quiet {
            self.terminal.line(line);
        }
    }

    /// Where nothing is kept, a request to keep what there is cannot be heeded, and is no reason to stop.
    pub fn refuse_request(&self) {
        if self.interrupt.is_requested() {
            self.say(
                "SIGUSR1 asks to keep the samples, and nothing says where: `--checkpoint` does; the picture goes on",
            );
        }
    }
}

/// Makes the pictures in turn, also those behind one that fails; or a film.
pub fn run(arguments: &Build, terminal: Terminal, interrupt: &Interrupt) -> Result<Exit, Problem> {
    if arguments.animating.frames.is_some() {
        return animate::run(arguments, terminal, interrupt);
    }
    let jobs = plan(arguments)?;
    let context = Context::new(arguments, terminal, interrupt)?;
    let mut messenger = Messenger::new(&arguments.messages, terminal, arguments.quiet);
    let mut worst = Exit::Done;
    for job in &jobs {
        worst = worst.max(build(&context, job, &mut messenger).unwrap_or_else(|problem| {
            terminal.problem(&problem);
            Exit::Usage
        }));
    }
    messenger.finish()?;
    Ok(worst)
}

/// What goes where. Everything that can be seen to be wrong before a file is read is found here.
fn plan(arguments: &Build) -> Result<Vec<Job>, Problem> {
    let scenes = &arguments.scenes;
    keep::refuse_loose_files(arguments)?;
    keep::refuse_idle(&arguments.keeping)?;
    if let Some(twice) = first_repeated(scenes) {
        return Err(Problem::new(format!("the scene `{}` is given twice", twice.display())));
    }
    let jobs: Vec<Job> = match (scenes.as_slice(), arguments.outputs.as_slice()) {
        ([scene], []) if is_standard(scene) => {
            let problem = Problem::new("a scene from standard input has no name to put its picture beside");
            return Err(problem.help("say where it goes: `-o picture.png`, or `-o -` for standard output"));
        }
        (_, [numbered, ..]) if has_number(numbered) => {
            let problem =
                Problem::new(format!("`{}` is the name of frames, and there are none", numbered.display()));
            return Err(problem.help("ask for some: `--sweep \"t = 0 to 1\" --frames 48`"));
        }
        ([scene], outputs @ [_, ..]) => vec![Job { scene: scene.clone(), targets: targets(outputs)? }],
        (_, [_, ..]) => {
            let problem = Problem::new(format!("`-o` is for one scene, and here are {}", scenes.len()));
            let help = "leave it out and each picture goes beside its scene, or build them one by one";
            return Err(problem.help(help));
        }
        (scenes, []) => {
            if scenes.iter().any(|scene| is_standard(scene)) {
                return Err(Problem::new("standard input can only be built alone, with `-o`"));
            }
            let beside = |scene: &PathBuf| Job { scene: scene.clone(), targets: vec![Target::beside(scene)] };
            scenes.iter().map(beside).collect()
        }
    };
    let all: Vec<Target> = jobs.iter().flat_map(|job| job.targets.clone()).collect();
    let paths = paths(&all);
    if let Some(twice) = first_repeated(&paths) {
        let problem = Problem::new(format!("two pictures would go to `{}`", twice.display()));
        return Err(problem.help("give one of the scenes another name, or build them one by one with `-o`"));
    }
    refuse_inputs_as_outputs(scenes, &paths)?;
    refuse_idle_depth(arguments.taking.look.bits, &all)?;
    for job in &jobs {
        refuse_idle_aovs(&arguments.aov, &job.targets)?;
    }
    shard::refuse_what_shares_cannot(arguments, &all)?;
    keep::refuse_checkpoints_of_others(arguments)?;
    denoise::refuse(arguments)?;
    if on_standard_output(&arguments.messages) && all.iter().any(|target| is_standard(&target.path)) {
        let problem = Problem::new("the picture and the messages would both go to standard output");
        return Err(problem.help("write the picture to a file, or use `--message-format short`"));
    }
    Ok(jobs)
}

/// The places that `-o` names.
pub fn targets(outputs: &[PathBuf]) -> Result<Vec<Target>, Problem> {
    let targets: Vec<Target> =
        outputs.iter().map(|path| Target::from_argument(path)).collect::<Result<_, _>>()?;
    match first_repeated(&paths(&targets)) {
        Some(twice) => Err(Problem::new(format!("the output `{}` is given twice", twice.display()))),
        None => Ok(targets),
    }
}

/// The files that targets are.
pub fn paths(targets: &[Target]) -> Vec<PathBuf> {
    targets.iter().map(|target| target.path.clone()).collect()
}

/// Nobody means to replace a scene, or what it is made of, by its picture.
pub fn refuse_inputs_as_outputs(inputs: &[PathBuf], outputs: &[PathBuf]) -> Result<(), Problem> {
    if let Some(input) = inputs.iter().find(|input| claim::is_ours(input)) {
        let problem =
            Problem::new(format!("`{}` has the name of a file that rtc is writing", input.display()));
        return Err(problem.help(
            "a scene is read from files of other names: it would be removed as what is left of such a file",
        ));
    }
    let Some(output) = first_replaced(inputs, outputs) else { return Ok(()) };
    let problem = Problem::new(format!("`{}` would be replaced by the picture", output.display()));
    Err(problem.help("name another output with `-o`"))
}

/// The first of the files to be written that would replace one of those that are read.
pub fn first_replaced<'o>(inputs: &[PathBuf], outputs: &'o [PathBuf]) -> Option<&'o PathBuf> {
    // Folders are refused when they are read.
    let files = inputs.iter().filter(|path| !is_standard(path) && !path.is_dir());
    let inputs: Vec<PathBuf> = files.map(|path| same(path)).collect();
    outputs.iter().find(|output| !is_standard(output) && inputs.contains(&same(output)))
}

/// `--bits 16` must find a PNG to apply to.
pub fn refuse_idle_depth(depth: Depth, targets: &[Target]) -> Result<(), Problem> {
    if depth == Depth::Eight || targets.iter().any(|target| target.format == Format::Png) {
        return Ok(());
    }
    let problem = Problem::new("`--bits 16` is for PNG files, and no output is one");
    Err(problem.help("exr, hdr and pfm hold floats, jpg and webp always 8 bits"))
}

/// `--aov` must find an EXR to hold its channels, and each of them once.
pub fn refuse_idle_aovs(wanted: &[Aov], targets: &[Target]) -> Result<(), Problem> {
    let repeated = |(index, aov): (usize, &Aov)| wanted[..index].contains(aov);
    if wanted.iter().enumerate().any(repeated) {
        return Err(Problem::new("`--aov` names something twice"));
    }
    if wanted.is_empty() || targets.iter().any(|target| target.format == Format::Exr) {
        return Ok(());
    }
    let problem = Problem::new("`--aov` is for EXR files, and no output is one");
    Err(problem.help("write one, maybe beside another: `-o picture.png -o picture.exr`"))
}

fn first_repeated(paths: &[PathBuf]) -> Option<&PathBuf> {
    let known: Vec<PathBuf> = paths.iter().map(|path| same(path)).collect();
    (1..paths.len()).find(|&i| known[..i].contains(&known[i])).map(|i| &paths[i])
}

/// A path to compare by: links and dots resolved, as far as the file or its folder exists.
pub fn same(path: &Path) -> PathBuf {
    let in_folder = || {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        Some(fs::canonicalize(folder).ok()?.join(path.file_name()?))
    };
    fs::canonicalize(path).ok().or_else(in_folder).unwrap_or_else(|| path.into())
}

fn build(context: &Context, job: &Job, messenger: &mut Messenger) -> Result<Exit, Problem> {
    let Context { arguments, terminal, .. } = *context;
    let start = Instant::now();
    let overrides = Overrides { limited: arguments.halting.time.is_some(), ..arguments.taking.overrides() };
    let loaded = scenes::load(&job.scene, &arguments.reading, &overrides)?;
    refuse_inputs_as_outputs(&loaded.read(), &paths(&job.targets))?;
    let compiled = &loaded.compiled;
    let mut exit = messenger.say(&compiled.diagnostics, &loaded.sources)?;
    let Some(scene) = compiled.scene.as_ref().filter(|_| exit == Exit::Done) else {
        return Ok(Exit::Diagnostics);
    };
    let window = window(scene, arguments.crop)?;
    let wait = arguments.keeping.wait.unwrap_or_default();
    let staged = patiently(wait, context, || stage(context, &job.targets, scene, window))?;
    let Some(from) = compiled.provenance(&loaded.sources) else { return Ok(Exit::Diagnostics) };
    let plan = Plan::new(arguments, from, window, &job.targets)?;
    plan.refuse_replacing(&loaded.read())?;
    let mut traced = context.threads.install(|| trace(context, &job.scene, plan, None))?;
    context.threads.install(|| match &traced.sums {
        Some((subject, making)) => write_share(subject, making, &traced.facts, staged),
        None => {
            let depth = arguments.taking.look.bits;
            write(traced.versions(), &traced.facts, &traced.channels, depth, staged)
        }
    })?;
    // The picture is safe before it is thought about.
    if arguments.feedback {
        traced.feedback = Some(context.threads.install(|| Tracer::new(scene).feedback(window)));
    }
    let findings = findings(scene, &traced, arguments.taking.samples.is_some());
    let mut warnings: Vec<Diagnostic> =
        findings.iter().filter_map(|finding| compiled.judge(finding)).collect();
    if let Some(feedback) = &traced.feedback {
        warnings.extend(compiled.heed(feedback, traced.facts.noise.unwrap_or(1.0), &loaded.sources));
    }
    if !warnings.is_empty() {
        exit = exit.max(messenger.say(&warnings, &loaded.sources)?);
    }
    if !arguments.quiet {
        compiled.notes.iter().for_each(|note| terminal.line(note));
        terminal.line(&summary(job, scene, &traced, start.elapsed()));
        traced.account.line().iter().for_each(|line| terminal.line(line));
    }
    Ok(exit)
}

/// The share of the light that may be lost to the limit of bounces before it is worth a warning.
const MOST_CUT: f64 = 0.05;
/// The share of a picture that may burn out to white, by an exposure that was given.
const MOST_BURNT_OUT: f64 = 0.25;

/// What is probably not meant in a picture that is done. Who limits the samples knows that there may be noise.
pub fn findings(scene: &Scene, traced: &Traced, limited: bool) -> Vec<Finding> {
    let Traced { stops, fitting, samples: [_, samples], .. } = *traced;
    let mut findings = vec![];
    if let Some(noise) = traced.facts.noise
        && (traced.target_met, traced.limit, limited) == (false, Limit::Samples, false)
    {
        findings.push(Finding::Noisy { noise, samples });
    }
    let bounces = scene.trace.bounces;
    // Feedback knows better.
    if traced.feedback.is_none() && bounces >= FEW_BOUNCES && traced.cut > MOST_CUT {
        findings.push(Finding::Cut { share: traced.cut, bounces });
    }
    if scene.develop.exposure.is_some() {
        let share = traced.picture.burnt_out(stops, scene.develop.tonemap);
        // Where nothing darker would be chosen, a white picture is the one that is meant.
        if share >= MOST_BURNT_OUT && fitting < stops {
            findings.push(Finding::BurntOut { share, stops, fitting });
        }
    }
    findings
}

/// One line about a picture that is done.
fn summary(job: &Job, scene: &Scene, traced: &Traced, time: Duration) -> String {
    let stops = traced.stops;
    let exposure = match scene.develop.exposure {
        Some(_) => format!("exposure {stops}"),
        None => format!("exposure chosen; to keep it, write `exposure: {stops}` in the camera"),
    };
    let names = names(&job.targets);
    let Picture { size: [width, height], .. } = traced.picture;
    format!("{names}: {width}×{height}, {}, {exposure}", taken(traced, time))
}

/// What was taken of a picture that is done, and how long that took.
pub fn taken(traced: &Traced, time: Duration) -> String {
    let of_that = |denoised: &Denoised| format!(", denoised in {} of that", duration(denoised.time));
    let denoised = traced.denoised.as_ref().map_or(String::new(), of_that);
    format!("{} in {}{denoised}", samples(traced), duration(time))
}

/// The least and the most samples of a pixel, and their mean, in words.
pub fn count([least, most]: [u32; 2], mean: f64) -> String {
    match (least, most) {
        (1, 1) => "1 sample".to_string(),
        (least, most) if least == most => format!("{most} samples"),
        _ => format!("{least} to {most} samples ({mean:.0} on average)"),
    }
}

/// How many samples were taken, what noise they leave, and why no more.
fn samples(traced: &Traced) -> String {
    let Traced { samples: [least, most], mean_samples, .. } = *traced;
    let count = count([least, most], mean_samples);
    let share = traced.sums.as_ref().and_then(|(subject, _)| subject.share);
    let share = share.map_or(String::new(), |share| format!(", share {share}"));
    let noise = traced.facts.noise.map_or(String::new(), |noise| format!(" (noise {:.2} %)", noise * 100.0));
    let why = match traced.limit {
        Limit::Samples => String::new(),
        Limit::Noise => ", as wanted,".to_string(),
        // Where pixels differ, a noise target chose among them.
        Limit::Time if least != most => {
            let again = format!("`--samples {most}` with the same `--noise` and `--min-samples`");
            format!(", stopped by the time (again by {again}),")
        }
        Limit::Time => format!(", stopped by the time (again by `--samples {most}`),"),
    };
    format!("{count}{share}{noise}{why}")
}

/// The pixels to trace.
pub fn window(scene: &Scene, crop: Option<[u32; 4]>) -> Result<Window, Problem> {
    let whole = Window::whole(scene.trace.size);
    let window = crop.map_or(whole, |[x, y, width, height]| Window { x, y, width, height });
    let ends = |start: u32, length: u32, most: u32| start.checked_add(length).is_some_and(|end| end <= most);
    if !ends(window.x, window.width, whole.width) || !ends(window.y, window.height, whole.height) {
        let [width, height] = scene.trace.size;
        let problem =
            Problem::new(format!("the crop does not lie within the picture, which is {width}×{height}"));
        let help = "`--crop X,Y,W,H`: X + W is at most the width, Y + H the height";
        return Err(problem.help(help));
    }
    Ok(window)
}

/// Makes sure before any work that every output can be written.
pub fn stage(
    context: &Context,
    targets: &[Target],
    scene: &Scene,
    window: Window,
) -> Result<Vec<Staged>, Problem> {
    refuse_misfits(targets, [window.width, window.height], is_transparent(scene))?;
    let Context { arguments, interrupt, .. } = context;
    let stage = if arguments.keeping.keeps() { Target::stage_again } else { Target::stage };
    targets.iter().map(|target| stage(target, interrupt)).collect()
}

fn is_transparent(scene: &Scene) -> bool {
    scene.trace.background == Background::Transparent
}

/// A format must be able to hold a picture of this size, which may be transparent.
pub fn refuse_misfits(targets: &[Target], size: [u32; 2], transparent: bool) -> Result<(), Problem> {
    for target in targets {
        if let Some(reason) = target.format.refuses(size) {
            return Err(Problem::new(reason.to_string()));
        }
        if transparent && let Some(reason) = target.format.refuses_alpha() {
            let help = "write another format, or leave `background: transparent` out";
            return Err(Problem::new(reason.to_string()).help(help));
        }
    }
    Ok(())
}

/// Makes the picture of a scene, and writes it where it goes. None where it was cancelled.
pub fn make(
    from: Provenance,
    target: &Target,
    control: &Arc<Control>,
    interrupt: &Interrupt,
) -> Result<Option<()>, Problem> {
    let window = Window::whole(from.scene.trace.size);
    let size = [window.width, window.height];
    refuse_misfits(std::slice::from_ref(target), size, is_transparent(from.scene))?;
    let staged = target.stage(interrupt)?;
    let Ok(traced) = take(from, window, control.clone()) else { return Ok(None) };
    write(traced.versions(), &traced.facts, &traced.channels, Depth::Eight, vec![staged]).map(Some)
}

/// The exposure where the scene gives none. Two digits, so that the number that is printed gives the very picture when
/// it is written down; and no negative zero.
pub fn chosen_stops(prepass: &Prepass) -> f64 {
    (prepass.exposure_stops * 100.0).round() / 100.0 + 0.0
}

/// A picture as it is written.
#[derive(Clone, Copy)]
pub struct Versions<'p> {
    /// As it was traced: that of an EXR.
    pub traced: &'p Picture,
    /// Without noise: that of all other formats, and a layer of an EXR.
    pub denoised: Option<Clear<'p>>,
}

impl<'p> From<&'p Picture> for Versions<'p> {
    fn from(traced: &'p Picture) -> Versions<'p> {
        Versions { traced, denoised: None }
    }
}

/// Writes every form of a picture, and only then moves them to their places.
pub fn write<'p>(
    versions: impl Into<Versions<'p>>,
    facts: &Facts,
    channels: &Channels,
    depth: Depth,
    mut staged: Vec<Staged>,
) -> Result<(), Problem> {
    let Versions { traced, denoised } = versions.into();
    for file in &mut staged {
        let bytes = match file.target.format {
            Format::Exr => {
                let mut channels = channels.clone();
                denoised.into_iter().for_each(|clear| denoise::layer(clear, &mut channels));
                encode_exr(traced, facts, channels)
            }
            format => encode(denoised.map_or(traced, |clear| clear.picture), facts, format, depth),
        };
        let bytes = bytes.map_err(|reason| {
            Problem::new(format!("cannot write {}: {reason}", names(std::slice::from_ref(&file.target))))
        })?;
        file.write(&bytes)?;
    }
    staged.into_iter().try_for_each(Staged::finish)
}

/// Writes a share of a picture to all its places.
fn write_share(
    subject: &Subject,
    making: &Making,
    facts: &Facts,
    mut staged: Vec<Staged>,
) -> Result<(), Problem> {
    let bytes = subject.encode(making, facts);
    let bytes = bytes.map_err(|reason| Problem::new(format!("cannot write a share: {reason}")))?;
    for file in &mut staged {
        file.write(&bytes)?;
    }
    staged.into_iter().try_for_each(Staged::finish)
}

/// The outputs as a list.
pub fn names(targets: &[Target]) -> String {
    let name = |target: &Target| match is_standard(&target.path) {
        true => "standard output".to_string(),
        false => target.path.display().to_string(),
    };
    targets.iter().map(name).collect::<Vec<_>>().join(", ")
}
