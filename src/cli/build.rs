//! `rtc build`: scenes to pictures.

use super::args::Build;
use super::input::is_standard;
use super::interrupt::Interrupt;
use super::messages::{Messenger, on_standard_output};
use super::progress::{Progress, duration};
use super::target::{Staged, Target};
use super::terminal::Terminal;
use super::{Exit, Problem, scene as scenes};
use rayon::{ThreadPool, ThreadPoolBuilder};
use rt_lang::aov::{self, Aov};
use rt_lang::diagnostic::Diagnostic;
use rt_lang::output::{Channels, Depth, Facts, Format, Picture, encode, encode_exr};
use rt_lang::render::feedback::Feedback;
use rt_lang::render::{Cancelled, Control, Prepass, Rendered, Shown, Tracer, Window};
use rt_lang::scene::{self, Background, Scene};
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
struct Context<'a> {
    arguments: &'a Build,
    threads: ThreadPool,
    terminal: Terminal,
    interrupt: &'a Interrupt,
}

/// A window of a picture as traced, and what there is to say of it.
struct Traced {
    picture: Picture,
    samples: u32,
    noise: f64,
    target_met: bool,
    /// What it is exposed by, whoever chose it.
    stops: f64,
    /// What would be chosen.
    fitting: f64,
    /// About the share of the light that the limit of bounces loses.
    cut: f64,
    /// What is shown beside the light.
    channels: Channels,
    /// What many paths tell, if that was asked for.
    feedback: Option<Feedback>,
}

/// Makes the pictures in turn, also those behind one that fails.
pub fn run(arguments: &Build, terminal: Terminal, interrupt: &Interrupt) -> Result<Exit, Problem> {
    let jobs = plan(arguments)?;
    let threads = ThreadPoolBuilder::new().num_threads(arguments.taking.threads.unwrap_or(0)).build();
    let threads = threads.map_err(|error| Problem::new(format!("cannot start the threads: {error}")))?;
    let context = Context { arguments, threads, terminal, interrupt };
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
    if let Some(twice) = first_repeated(scenes) {
        return Err(Problem::new(format!("the scene `{}` is given twice", twice.display())));
    }
    let jobs: Vec<Job> = match (scenes.as_slice(), arguments.outputs.as_slice()) {
        ([scene], []) if is_standard(scene) => {
            let problem = Problem::new("a scene from standard input has no name to put its picture beside");
            return Err(problem.help("say where it goes: `-o picture.png`, or `-o -` for standard output"));
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
    let paths: Vec<PathBuf> = all.iter().map(|target| target.path.clone()).collect();
    if let Some(twice) = first_repeated(&paths) {
        let problem = Problem::new(format!("two pictures would go to `{}`", twice.display()));
        return Err(problem.help("give one of the scenes another name, or build them one by one with `-o`"));
    }
    refuse_inputs_as_outputs(scenes, &all)?;
    refuse_idle_depth(arguments.taking.look.bits, &all)?;
    for job in &jobs {
        refuse_idle_aovs(&arguments.aov, &job.targets)?;
    }
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
    let paths: Vec<PathBuf> = targets.iter().map(|target| target.path.clone()).collect();
    match first_repeated(&paths) {
        Some(twice) => Err(Problem::new(format!("the output `{}` is given twice", twice.display()))),
        None => Ok(targets),
    }
}

/// Nobody means to replace a scene by its picture.
pub fn refuse_inputs_as_outputs(inputs: &[PathBuf], targets: &[Target]) -> Result<(), Problem> {
    // Folders are refused when they are read.
    let files = inputs.iter().filter(|path| !is_standard(path) && !path.is_dir());
    let inputs: Vec<PathBuf> = files.map(|path| same(path)).collect();
    match targets.iter().find(|target| !is_standard(&target.path) && inputs.contains(&same(&target.path))) {
        Some(target) => {
            let problem =
                Problem::new(format!("`{}` would be replaced by its picture", target.path.display()));
            Err(problem.help("name another output with `-o`"))
        }
        None => Ok(()),
    }
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
fn refuse_idle_aovs(wanted: &[Aov], targets: &[Target]) -> Result<(), Problem> {
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
fn same(path: &Path) -> PathBuf {
    let in_folder = || {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        Some(fs::canonicalize(folder).ok()?.join(path.file_name()?))
    };
    fs::canonicalize(path).ok().or_else(in_folder).unwrap_or_else(|| path.into())
}

fn build(context: &Context, job: &Job, messenger: &mut Messenger) -> Result<Exit, Problem> {
    let Context { arguments, terminal, .. } = *context;
    let start = Instant::now();
    let loaded = scenes::load(&job.scene, &arguments.reading, &arguments.taking.overrides())?;
    let compiled = &loaded.compiled;
    let mut exit = messenger.say(&compiled.diagnostics, &loaded.sources)?;
    let Some(scene) = compiled.scene.as_ref().filter(|_| exit == Exit::Done) else {
        return Ok(Exit::Diagnostics);
    };
    let window = window(scene, arguments.crop)?;
    let staged = stage(job, scene, window, context.interrupt)?;
    let Some(from) = compiled.provenance(&loaded.sources) else { return Ok(Exit::Diagnostics) };
    let Ok(mut traced) = trace(context, job, from, window) else { context.interrupt.wait() };
    let facts = facts(scene, &traced);
    let depth = arguments.taking.look.bits;
    context.threads.install(|| write(&traced.picture, &facts, &traced.channels, depth, staged))?;
    // The picture is safe before it is thought about.
    if arguments.feedback {
        traced.feedback = Some(context.threads.install(|| Tracer::new(scene).feedback(window)));
    }
    let findings = findings(scene, &traced);
    let mut warnings: Vec<Diagnostic> =
        findings.iter().filter_map(|finding| compiled.judge(finding)).collect();
    if let Some(feedback) = &traced.feedback {
        warnings.extend(compiled.heed(feedback, traced.noise, &loaded.sources));
    }
    if !warnings.is_empty() {
        exit = exit.max(messenger.say(&warnings, &loaded.sources)?);
    }
    if !arguments.quiet {
        compiled.notes.iter().for_each(|note| terminal.line(note));
        terminal.line(&summary(job, scene, &traced, start.elapsed()));
    }
    Ok(exit)
}

/// The share of the light that may be lost to the limit of bounces before it is worth a warning.
const MOST_CUT: f64 = 0.05;
/// The share of a picture that may burn out to white, by an exposure that was given.
const MOST_BURNT_OUT: f64 = 0.25;

/// What is probably not meant in a picture that is done.
fn findings(scene: &Scene, traced: &Traced) -> Vec<Finding> {
    let Traced { stops, fitting, samples, noise, .. } = *traced;
    let mut findings = vec![];
    if !traced.target_met {
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

fn facts(scene: &Scene, traced: &Traced) -> Facts {
    Facts {
        samples: Some(u64::from(traced.samples)),
        seed: Some(scene.trace.seed),
        scene: Some(scene.hash().to_hex().to_string()),
        stops: Some(traced.stops),
        tonemap: Some(scene.develop.tonemap),
        ..Facts::unknown()
    }
}

/// One line about a picture that is done.
fn summary(job: &Job, scene: &Scene, traced: &Traced, time: Duration) -> String {
    let noise = match scene.trace.target {
        scene::Target::Samples(_) => String::new(),
        scene::Target::Noise(_) => format!(" (noise {:.2} %)", traced.noise * 100.0),
    };
    let stops = traced.stops;
    let exposure = match scene.develop.exposure {
        Some(_) => format!("exposure {stops}"),
        None => format!("exposure chosen; to keep it, write `exposure: {stops}` in the camera"),
    };
    let names = names(&job.targets);
    let Traced { samples, picture: Picture { size: [width, height], .. }, .. } = traced;
    let unit = if *samples == 1 { "sample" } else { "samples" };
    format!("{names}: {width}×{height}, {samples} {unit}{noise} in {}, {exposure}", duration(time))
}

/// The pixels to trace.
fn window(scene: &Scene, crop: Option<[u32; 4]>) -> Result<Window, Problem> {
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
fn stage(job: &Job, scene: &Scene, window: Window, interrupt: &Interrupt) -> Result<Vec<Staged>, Problem> {
    for target in &job.targets {
        if let Some(reason) = target.format.refuses([window.width, window.height]) {
            return Err(Problem::new(reason.to_string()));
        }
        if scene.trace.background == Background::Transparent
            && let Some(reason) = target.format.refuses_alpha()
        {
            let help = "write another format, or leave `background: transparent` out";
            return Err(Problem::new(reason.to_string()).help(help));
        }
    }
    job.targets.iter().map(|target| target.stage(interrupt)).collect()
}

/// Traces a window, showing how far it is.
fn trace(context: &Context, job: &Job, from: Provenance, window: Window) -> Result<Traced, Cancelled> {
    let Build { aov, feedback, .. } = context.arguments;
    let control = Arc::new(Control::new());
    context.interrupt.watch(control.clone());
    let shown = context.terminal.interactive && !context.arguments.quiet;
    let _progress = shown.then(|| Progress::watch(control.clone(), job.scene.display().to_string()));
    context.threads.install(|| take(from, window, aov, *feedback, &control))
}

/// Traces a window, with channels of what it shows besides its light, and with the noise of what is shown where feedback is
/// wanted.
fn take(
    from: Provenance,
    window: Window,
    aovs: &[Aov],
    feedback: bool,
    control: &Control,
) -> Result<Traced, Cancelled> {
    let scene = from.scene;
    let tracer = Tracer::new(scene);
    let prepass = tracer.prepass();
    let chosen = chosen_stops(&prepass);
    let stops = scene.develop.exposure.unwrap_or(chosen);
    let shown = Shown { stops, tonemap: scene.develop.tonemap };
    let rendered = tracer.render(window, scene.trace.target, &prepass, shown, control)?;
    let (offset, size) = ([window.x, window.y], [window.width, window.height]);
    let mean = |x, y| rendered.film.mean(x, y);
    let picture = Picture::gather(scene.trace.size, offset, size, mean);
    let picture = match scene.trace.background {
        Background::Sky => picture,
        Background::Transparent => picture.with_alpha(|x, y| rendered.film.alpha(x, y)),
    };
    let Rendered { film, samples, mut noise, target_met } = rendered;
    let of_first = aovs.iter().any(|aov| aov.is_of_first_hits());
    let first = of_first.then(|| tracer.first_hits(window, samples, control)).transpose()?;
    let channels = aov::channels(aovs, &film, first.as_ref(), from);
    if feedback {
        noise = film.noise(stops, scene.develop.tonemap);
    }
    let (fitting, cut) = (chosen, prepass.cut);
    Ok(Traced { picture, samples, noise, target_met, stops, fitting, cut, channels, feedback: None })
}

/// Makes the picture of a scene, and writes it where it goes. None where it was cancelled.
pub fn make(
    from: Provenance,
    target: &Target,
    control: &Control,
    interrupt: &Interrupt,
) -> Result<Option<()>, Problem> {
    let scene = from.scene;
    let window = Window::whole(scene.trace.size);
    let job = Job { scene: PathBuf::new(), targets: vec![target.clone()] };
    let staged = stage(&job, scene, window, interrupt)?;
    let Ok(traced) = take(from, window, &[], false, control) else { return Ok(None) };
    write(&traced.picture, &facts(scene, &traced), &traced.channels, Depth::Eight, staged).map(Some)
}

/// The exposure where the scene gives none. Two digits, so that the number that is printed gives the very picture when
/// it is written down; and no negative zero.
pub fn chosen_stops(prepass: &Prepass) -> f64 {
    (prepass.exposure_stops * 100.0).round() / 100.0 + 0.0
}

/// Writes every form of a picture, and only then moves them to their places.
pub fn write(
    picture: &Picture,
    facts: &Facts,
    channels: &Channels,
    depth: Depth,
    mut staged: Vec<Staged>,
) -> Result<(), Problem> {
    for file in &mut staged {
        let bytes = match file.target.format {
            Format::Exr => encode_exr(picture, facts, channels),
            format => encode(picture, facts, format, depth),
        };
        let bytes = bytes.map_err(|reason| {
            Problem::new(format!("cannot write {}: {reason}", names(std::slice::from_ref(&file.target))))
        })?;
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
