//! Traces the picture of one scene: from what was kept of it, if anything was, until a limit is reached.

use super::Problem;
use super::args::Build;
use super::build::{Context, Versions, chosen_stops};
use super::denoise::{self, Clear, Denoised};
use super::keep::{self, Account, Keeper, Places};
use super::progress::{Progress, Work};
use super::shard;
use super::target::{Target, patiently};
use rt_lang::aov::{self, Aov};
use rt_lang::denoise::METHOD;
use rt_lang::output::{Channels, Facts, Picture};
use rt_lang::render::feedback::Feedback;
use rt_lang::render::halt::{Limit, Limits};
use rt_lang::render::making::Making;
use rt_lang::render::{Cancelled, Control, Prepass, Shown, Structure, Tracer, Window};
use rt_lang::saved::{self, Share, Subject};
use rt_lang::scene::{self, Scene, identity::Identity, identity::difference};
use rt_lang::why::Provenance;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

/// What is to be traced.
pub struct Plan<'a> {
    from: Provenance<'a>,
    window: Window,
    limits: Limits,
    share: Option<Share>,
    places: Option<Places>,
    denoises: bool,
}

/// A window of a picture as traced, and what there is to say of it.
pub struct Traced {
    /// The picture.
    pub picture: Picture,
    /// The same without noise, if that was asked for and there were samples enough.
    pub denoised: Option<Denoised>,
    /// How it came about.
    pub facts: Facts,
    /// What is shown beside the light.
    pub channels: Channels,
    /// The least and the most samples of a pixel.
    pub samples: [u32; 2],
    /// The mean over the pixels.
    pub mean_samples: f64,
    /// What it stopped at.
    pub limit: Limit,
    /// Whether there is as little noise as was wanted.
    pub target_met: bool,
    /// What it is exposed by, whoever chose it.
    pub stops: f64,
    /// What would be chosen.
    pub fitting: f64,
    /// About the share of the light that the limit of bounces loses.
    pub cut: f64,
    /// Which samples were there before, and where they are kept.
    pub account: Account,
    /// Its exact sums, and of which share, if it is to be put together with others.
    pub sums: Option<(Subject, Making)>,
    /// What many paths tell, if that was asked for.
    pub feedback: Option<Feedback>,
}

/// What a frame of a film leaves for the next one: what of it fits is not made again.
#[derive(Default)]
pub struct Before {
    /// What rays are tested against.
    pub structure: Option<Structure>,
    /// Its samples, with the hash of the scene that they are of.
    making: Option<(Option<String>, Making)>,
}

impl Before {
    /// The samples, if they are of the same picture, and no more than it is to have. Which there are for a noise depends on
    /// how the picture is exposed.
    fn samples(&mut self, tracing: &Tracing, window: Window) -> Option<Making> {
        let Limits { samples, noise, time, .. } = tracing.limits;
        let (hash, making) = self.making.take()?;
        let fits = hash == tracing.facts.scene
            && making.film().window() == window
            && making.samples()[1] <= samples
            && (noise, time) == (None, None);
        fits.then_some(making)
    }
}

impl<'a> Plan<'a> {
    /// What flags and a scene say of a window that goes to these targets.
    pub fn new(
        arguments: &Build,
        from: Provenance<'a>,
        window: Window,
        targets: &[Target],
    ) -> Result<Plan<'a>, Problem> {
        let share = share(arguments, from.scene)?;
        if let Some(share) = share {
            targets.iter().try_for_each(|target| refuse_other_division(share, &target.path))?;
        }
        let limits = limits(arguments, from.scene, share)?;
        let places = keep::places(&arguments.keeping, targets)?;
        denoise::refuse_samples(arguments, limits.samples)?;
        Ok(Plan { from, window, limits, share, places, denoises: arguments.denoise })
    }

    /// The same for a frame of a film: see [`Places::yielding`].
    pub fn of_frame(self) -> Plan<'a> {
        Plan { places: self.places.map(Places::yielding), ..self }
    }

    /// Refuses to replace by a checkpoint what the picture is made of.
    pub fn refuse_replacing(&self, inputs: &[PathBuf]) -> Result<(), Problem> {
        self.places.as_ref().map_or(Ok(()), |places| places.refuse_replacing(inputs))
    }

    /// The scene and where it came from.
    pub fn from(&self) -> Provenance<'a> {
        self.from
    }

    /// What its samples are of.
    pub fn subject(&self) -> Subject {
        subject(self.from.scene, self.window, self.share)
    }

    /// What is traced of the picture.
    pub fn window(&self) -> Window {
        self.window
    }

    /// Whether its noise is taken out.
    pub fn denoises(&self) -> bool {
        self.denoises
    }

    /// When it is done.
    pub fn limits(&self) -> &Limits {
        &self.limits
    }
}

impl Traced {
    /// The picture to write.
    pub fn versions(&self) -> Versions<'_> {
        let denoised = self.denoised.as_ref();
        let clear = denoised.map(|denoised| Clear { picture: &denoised.picture, by: Some(METHOD) });
        Versions { traced: &self.picture, denoised: clear }
    }
}

/// The share of the samples that is to be made, if not all.
fn share(arguments: &Build, scene: &Scene) -> Result<Option<Share>, Problem> {
    let Some(shard) = arguments.keeping.shard else { return Ok(None) };
    let scene::Target::Samples(samples) = scene.trace.target else {
        let problem = Problem::new("`--shard` needs a number of samples, and the scene asks for a noise");
        return Err(problem.help("every share must know its samples before: give `--samples N`"));
    };
    shard::share(shard, samples, &|name| std::env::var(name).ok()).map(Some)
}

/// A share does not replace one of another number of shares: that may be the work of others, where a scheduler counts the tasks
/// of a part of them.
fn refuse_other_division(share: Share, path: &Path) -> Result<(), Problem> {
    let there = keep::head(path).and_then(|head| head.subject.share);
    let Some(there) = there.filter(|there| there.of != share.of) else { return Ok(()) };
    let (path, Share { index, of, .. }) = (path.display(), there);
    let problem = Problem::new(format!(
        "`{path}` is share {index} of {of}, and would be replaced by share {} of {}",
        share.index, share.of
    ));
    Err(problem.help(format!("give `--shard {}/{of}` for one that goes with it, or remove it", share.index)))
}

fn limits(arguments: &Build, scene: &Scene, share: Option<Share>) -> Result<Limits, Problem> {
    let mut limits = Limits::from(scene.trace.target);
    if let Some(share) = share {
        limits.samples = share.range().len() as u32;
    }
    if let (Some(_), Some(samples)) = (limits.noise, arguments.taking.samples) {
        limits.samples = samples;
    }
    limits.time = arguments.halting.time;
    if let Some(least) = arguments.halting.min_samples {
        if limits.noise.is_none() {
            let problem = Problem::new("`--min-samples` is for a noise target, and there is none");
            return Err(problem.help("give one with `--noise 1%`, or leave the flag out"));
        }
        limits.least = least;
        match arguments.taking.samples {
            Some(samples) if samples < least => {
                let problem = Problem::new(format!(
                    "`--min-samples {least}` asks for more samples than `--samples {samples}` allows"
                ));
                return Err(problem.help("raise the one, or lower the other"));
            }
            Some(_) => {}
            None => limits.samples = limits.samples.max(least),
        }
    }
    Ok(limits)
}

/// Traces on the current rayon pool, showing how far it is. Asked to end, it ends the process. A frame of a film goes on from
/// the one `before`.
pub fn trace(
    context: &Context,
    name: &Path,
    plan: Plan,
    mut before: Option<&mut Before>,
) -> Result<Traced, Problem> {
    let control = Arc::new(Control::new());
    context.interrupt.watch(control.clone());
    let shown = context.terminal.interactive && !context.arguments.quiet;
    let watch = |work, control: &Arc<Control>| {
        shown.then(|| Progress::watch(control.clone(), work, name.display().to_string()))
    };
    let progress = watch(Work::Tracing, &control);
    let Plan { from, window, limits, share, places, denoises } = plan;
    let structure = before.as_mut().and_then(|before| before.structure.take());
    let Ok(tracing) = Tracing::new(from, window, limits, share, control, structure) else {
        context.interrupt.wait()
    };
    let aovs = &context.arguments.aov;
    let mut keeper = places.map(|places| Keeper::new(places, (&tracing.subject, &tracing.facts), context));
    let kept = match &mut keeper {
        Some(keeper) => {
            // Of a film, others are waited for a frame at a time.
            let wait = context.arguments.keeping.wait.filter(|_| before.is_none()).unwrap_or_default();
            patiently(wait, context, || keeper.hold())?;
            keeper.resume(|kept| {
                let lacks_halves = || denoises.then(|| denoise::refuses(kept)).flatten();
                tracing.refuses(kept).or_else(lacks_halves)
            })?
        }
        None => None,
    };
    let reused = before.as_mut().and_then(|before| before.samples(&tracing, window));
    let mut making = kept.or(reused).unwrap_or_else(|| tracing.begin(window));
    if denoises && !making.is_in_halves() {
        making = making.in_halves();
    }
    let limit = match &mut keeper {
        Some(keeper) => tracing.go_on_keeping(&mut making, keeper, context),
        None => tracing.go_on(&mut making, &mut |_| context.refuse_request()),
    };
    // Where it is to be denoised, another bar tells of that.
    let filter = denoises.then(|| Arc::new(Control::new()));
    let _progress = match &filter {
        Some(filter) => {
            drop(progress);
            watch(Work::Denoising, filter)
        }
        None => progress,
    };
    let ended = limit.and_then(|limit| tracing.finish(&making, limit, aovs, filter.as_deref()));
    let Ok(traced) = ended else { context.interrupt.wait() };
    let traced = Traced { account: keeper.map(Keeper::account).unwrap_or_default(), ..traced };
    if share.is_some() {
        return Ok(Traced { sums: Some((tracing.subject, making)), ..traced });
    }
    if let Some(before) = before {
        before.making = Some((tracing.facts.scene, making));
        before.structure = Some(tracing.tracer.into_structure());
    }
    Ok(traced)
}

/// Traces what a scene says, and nothing besides.
pub fn take(from: Provenance, window: Window, control: Arc<Control>) -> Result<Traced, Cancelled> {
    let limits = Limits::from(from.scene.trace.target);
    let tracing = Tracing::new(from, window, limits, None, control, None)?;
    let mut making = Making::new(window, tracing.prepass.scale);
    let limit = tracing.go_on(&mut making, &mut |_| {})?;
    tracing.finish(&making, limit, &[], None)
}

/// What samples of a window, or of a share of them, are of.
fn subject(scene: &Scene, window: Window, share: Option<Share>) -> Subject {
    let identity = Identity::new(scene, [window.x, window.y, window.width, window.height]);
    Subject { program: Facts::unknown().software, identity, share }
}

/// A picture being traced.
struct Tracing<'a> {
    from: Provenance<'a>,
    tracer: Tracer<'a>,
    prepass: Prepass,
    shown: Shown,
    limits: Limits,
    subject: Subject,
    /// How the picture comes about, as far as that is known before.
    facts: Facts,
    control: Arc<Control>,
}

impl<'a> Tracing<'a> {
    fn new(
        from: Provenance<'a>,
        window: Window,
        limits: Limits,
        share: Option<Share>,
        control: Arc<Control>,
        structure: Option<Structure>,
    ) -> Result<Tracing<'a>, Cancelled> {
        let scene = from.scene;
        let mut tracer = Tracer::at_once(scene, structure);
        tracer.find_caustics(&control)?;
        let prepass = tracer.prepass();
        let stops = scene.develop.exposure.unwrap_or(chosen_stops(&prepass));
        let shown = Shown { stops, tonemap: scene.develop.tonemap };
        let facts = Facts {
            seed: Some(scene.trace.seed),
            scene: Some(scene.hash().to_hex().to_string()),
            stops: Some(stops),
            tonemap: Some(shown.tonemap),
            ..Facts::unknown()
        };
        let subject = subject(scene, window, share);
        Ok(Tracing { from, tracer, prepass, shown, limits, subject, facts, control })
    }

    /// A picture without samples.
    fn begin(&self, window: Window) -> Making {
        let start = self.subject.share.map_or(0, |share| share.range().start);
        Making::from_sample(window, self.prepass.scale, start)
    }

    /// Why samples of this subject are none to go on with, if they are not: those that are there cannot be taken back, and which
    /// there are for a noise depends on how the picture was to be shown.
    fn refuses(&self, kept: &Making) -> Option<String> {
        let (own, other) = (self.prepass.scale, kept.film().scale());
        if own != other {
            return Some(format!("its sums are of another scale ({other:e}, not {own:e})"));
        }
        let ([_, most], limits) = (kept.samples(), &self.limits);
        if most > limits.samples {
            return Some(format!(
                "it has up to {most} samples a pixel already, and no more than {} are asked for: `--samples {most}` goes on",
                limits.samples
            ));
        }
        // Where all pixels have as many, nothing was chosen.
        let judged = kept.judged().filter(|_| limits.noise.is_some() && !kept.is_even());
        let judged = judged.filter(|judged| *judged != self.shown)?;
        let (own, other) = match judged.stops == self.shown.stops {
            false => (format!("`--exposure {}`", self.shown.stops), judged.stops.to_string()),
            true => (format!("`--tonemap {}`", self.shown.tonemap.word()), judged.tonemap.word().to_string()),
        };
        let difference = difference(&own, keep::CALLED, &other);
        Some(format!("a noise target chose where its samples go by how it is shown: {difference}"))
    }

    fn go_on(&self, making: &mut Making, between: &mut dyn FnMut(&Making)) -> Result<Limit, Cancelled> {
        self.tracer.go_on(making, &self.limits, self.shown, &self.control, between)
    }

    /// The same, and keeps the samples: now and then, when it is done, and when it is cancelled.
    fn go_on_keeping(
        &self,
        making: &mut Making,
        keeper: &mut Keeper,
        context: &Context,
    ) -> Result<Limit, Cancelled> {
        let Context { interrupt, terminal, .. } = *context;
        interrupt.keep();
        let limit = self.go_on(making, &mut |making| keeper.consider(making));
        keeper.finish(making);
        interrupt.kept(terminal, keeper.kept());
        limit
    }

    /// The picture without noise, if every pixel has a sample of each half. `filter` tells how far it is.
    fn denoised(
        &self,
        picture: &Picture,
        making: &Making,
        filter: &Control,
    ) -> Result<Option<Denoised>, Cancelled> {
        let [least, most] = making.samples();
        if least < denoise::LEAST_SAMPLES {
            return Ok(None);
        }
        let start = Instant::now();
        let guides =
            self.tracer.guides(making.film().window(), denoise::guide_samples(most), &self.control)?;
        Ok(denoise::denoised(picture, making, guides, start, filter))
    }

    /// What there is to say of a picture that is done; without noise too, if it is known who is told how far that is.
    fn finish(
        &self,
        making: &Making,
        limit: Limit,
        aovs: &[Aov],
        filter: Option<&Control>,
    ) -> Result<Traced, Cancelled> {
        let (samples, mean_samples) = (making.samples(), making.mean_samples());
        let facts = Facts { limit: Some(limit.word().into()), ..self.facts.clone() };
        let facts = saved::judged(facts, making.film(), samples);
        let film = making.film();
        let picture = saved::picture(film, &self.subject.identity);
        let denoised = match filter {
            Some(filter) => self.denoised(&picture, making, filter)?,
            None => None,
        };
        let of_first = aovs.iter().any(|aov| aov.is_of_first_hits());
        let first =
            of_first.then(|| self.tracer.first_hits(film.window(), samples[1], &self.control)).transpose()?;
        Ok(Traced {
            picture,
            denoised,
            target_met: self
                .limits
                .noise
                .is_none_or(|wanted| facts.noise.is_some_and(|noise| noise <= wanted)),
            channels: aov::channels(aovs, film, first.as_ref(), self.from),
            facts,
            samples,
            mean_samples,
            limit,
            stops: self.shown.stops,
            fitting: chosen_stops(&self.prepass),
            cut: self.prepass.cut,
            account: Account::default(),
            sums: None,
            feedback: None,
        })
    }
}
