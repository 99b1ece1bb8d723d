//! A scene-description language and its renderer.
//!
//! The library is pure: text in, values out. The binary `rtc` does all input and output. Data flows one way:
//!
//! ```text
//! text ──syntax──▶ tree ──check──▶ program ──eval──▶ things ──lower──▶ scene ──render──▶ film ──output──▶ bytes
//! ```
//!
//! The modules, in reading order. Each may use only those that `tests/architecture.rs` lists for it.
//!
//! | module | what it holds | what it does not know |
//! |---|---|---|
//! | [`span`], [`source`], [`diagnostic`] | places, texts, what is said of them | terminals |
//! | [`files`] | what a scene may read | the disk |
//! | [`asset`] | the bytes of pictures and meshes to values | where the bytes came from |
//! | [`math`], [`color`], [`units`], [`develop`] | arithmetic with the same bits everywhere | the language |
//! | [`schema`] | the one table of kinds and fields | how they are checked or drawn |
//! | [`syntax`] | text to tree; never fails | names, types, the scene |
//! | [`import`] | the trees of all files that a scene is made of | names, types |
//! | [`check`] | tree to typed program: names, types, units | values |
//! | [`eval`] | program to things, each with the chain of uses that made it | the renderer |
//! | [`lower`] | things to scene: defaults, cameras, transforms, radiometry | text |
//! | [`scene`] | the picture in its simplest form | where it came from |
//! | [`export`] | scene to the texts of other renderers | how this one draws it |
//! | [`expand`] | scene to a flat text of the language | the text it came from |
//! | [`lint`] | what is probably not meant in a scene | text |
//! | [`render`] | scene to film; cannot fail | places, files, syntax |
//! | [`denoise`] | a picture without its noise, by what its pixels show | scenes, how it was traced |
//! | [`output`] | film to the bytes of image files, and back | files |
//! | [`aov`] | what a picture shows besides its light, as channels | files |
//! | [`saved`] | a picture in the making to bytes and back, and shares of one put together | files |
//! | [`explain`] | the page on each diagnostic | how it is shown |
//! | [`change`] | what is different between a scene and the one before it | where it is shown |
//! | [`inventory`] | what stands in a picture, counted | how it is shown |
//! | [`mend`] | applying the edits that diagnostics offer | files |
//! | [`report`] | diagnostics to text, for a person or a program | what they are about |
//! | [`ide`] | what an editor asks of a text | protocols, how it is compiled |
//! | [`why`] | what a pixel shows and where its light comes from, by places in the source | how it is shown |

pub mod asset;
mod allow;
pub mod aov;
pub mod change;
pub mod check;
pub mod color;
pub mod denoise;
pub mod develop;
pub mod diagnostic;
pub mod eval;
pub mod expand;
pub mod explain;
pub mod export;
pub mod files;
pub mod ide;
pub mod import;
pub mod inventory;
pub mod lint;
pub mod lower;
pub mod math;
pub mod mend;
pub mod output;
pub mod render;
pub mod report;
pub mod saved;
pub mod scene;
pub mod schema;
pub mod source;
pub mod span;
mod stack;
pub mod syntax;
pub mod units;
pub mod why;

use check::{Moment, Program, Setting};
use diagnostic::{Code, Diagnostic};
use eval::{Limits, Origins, Thing, Things};
use files::{Contents, Files};
use ide::{Analysis, Stop, Study};
use import::Imported;
use inventory::Inventory;
use lower::{Decoded, Lowered, Marks, Meshes, Overrides, Places, Vantage};
use render::feedback::Feedback;
use scene::Scene;
use source::{Source, Sources};
use span::{SourceId, Span};
use why::Provenance;

/// What compiling a source gives.
#[derive(Debug)]
pub struct Compiled {
    /// The scene; none where there was an error.
    pub scene: Option<Scene>,
    /// Where the primitives of the scene came from.
    pub origins: Origins,
    /// Errors and warnings, by place.
    pub diagnostics: Vec<Diagnostic>,
    /// One line for each default that was chosen for the user.
    pub notes: Vec<String>,
    /// Where the pictures and meshes of the scene were read.
    pub contents: Contents,
    /// What stands in the picture.
    pub inventory: Inventory,
    /// Where those parts of the scene came from that are no primitives.
    pub marks: Marks,
    /// Where the camera stands and looks; none where that is not known.
    pub vantage: Option<Vantage>,
    /// Where settings stand that only a finished picture can judge.
    places: Places,
    /// The source that was compiled.
    main: SourceId,
    /// What the source says is expected.
    allows: Vec<check::Allow>,
}

/// What a compilation may be told from outside.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// What stands in place of the file's settings of camera and render blocks.
    pub overrides: Overrides,
    /// Values for params of the file, each as `name=value`.
    pub set: Vec<String>,
    /// Values that change through a film, each as `name = a to b` or `name = a until b`.
    pub sweep: Vec<String>,
    /// Which of its frames is compiled.
    pub moment: Moment,
    /// What reading and evaluating may take.
    pub limits: Limits,
}

/// Compiles a source to a scene: parse it and what it imports, check, evaluate, lower. Every stage runs, also after
/// errors, so that one run reports all that is wrong. `files` is what the source may read; what it imports is added
/// to `sources`, and so is each setting.
pub fn compile(files: &dyn Files, sources: &mut Sources, main: SourceId, options: &Options) -> Compiled {
    let (compiled, _) = run(files, sources, main, options, None);
    compiled
}

/// Finds out what a source means, for the questions of an editor: as [`compile`] does, with what is learnt on the way. None
/// where `stop` ended it.
pub fn analyse(files: &dyn Files, main: Source, options: &Options, stop: Stop) -> Option<Analysis> {
    let mut sources = Sources::default();
    let main = sources.add(main);
    let (compiled, study) = run(files, &mut sources, main, options, Some(stop));
    let Compiled { diagnostics, notes, inventory, .. } = compiled;
    let cameras = inventory.cameras.into_iter().flatten().collect();
    (!stop()).then(|| Analysis::new(sources, main, diagnostics, notes, Study { cameras, ..study }))
}

/// Runs all stages. `stop` is asked only by who keeps what is learnt.
fn run(
    files: &dyn Files,
    sources: &mut Sources,
    main: SourceId,
    options: &Options,
    stop: Option<Stop>,
) -> (Compiled, Study) {
    let imported = import::import(files, sources, main, options.limits.levels, options.limits.text);
    let settings = settings(sources, options);
    let decoded = &Decoded::default();
    let world = World { files, sources, main, options, stop, decoded };
    stack::deep(move || world.stages(imported, settings))
}

/// What the source is set to, with the slips in it.
fn settings(sources: &mut Sources, options: &Options) -> (Vec<Setting>, Vec<Diagnostic>) {
    check::settings(sources, &options.set, &options.sweep, options.moment)
}

/// A source that is compiled at one moment after the other: what does not depend on the moment is done once.
pub struct Series<'f> {
    files: &'f dyn Files,
    sources: Sources,
    main: SourceId,
    options: Options,
    imported: Imported,
    decoded: Decoded,
}

impl<'f> Series<'f> {
    /// Parses a source and what it imports.
    pub fn new(files: &'f dyn Files, mut sources: Sources, main: SourceId, options: Options) -> Series<'f> {
        let limits = options.limits;
        let imported = import::import(files, &mut sources, main, limits.levels, limits.text);
        Series { files, sources, main, options, imported, decoded: Decoded::default() }
    }

    /// The texts of the source, of what it imports, and of the settings.
    pub fn sources(&self) -> &Sources {
        &self.sources
    }

    /// What its sweeps set at a moment, as one says it, by what is known of its params: `t = 0.5`.
    pub fn swept(&self, moment: Moment, inventory: &Inventory) -> Vec<String> {
        let is_int =
            |name: &str| inventory.params.iter().any(|param| param.name == name && param.ty == "int");
        check::swept_words(&self.options.sweep, moment, is_int)
    }

    /// Has cameras stand and look so from now on, as far as the source leaves that open.
    pub fn hold(&mut self, vantage: Vantage) {
        self.options.overrides.vantage = Some(vantage);
    }

    /// Compiles it at a moment, as [`compile`] does.
    pub fn at(&mut self, moment: Moment) -> Compiled {
        self.options.moment = moment;
        let (settings, slips) = settings(&mut self.sources, &self.options);
        let Series { files, sources, main, options, imported, decoded } = &*self;
        let world = World { files: *files, sources, main: *main, options, stop: None, decoded };
        stack::deep(move || {
            let (program, found) = check::check(*files, sources, imported, &settings);
            let diagnostics = [imported.diagnostics.clone(), slips, found].concat();
            world.evaluated(program, &settings, diagnostics, Study::default()).0
        })
    }
}

/// What the stages are told.
struct World<'w> {
    files: &'w dyn Files,
    sources: &'w Sources,
    main: SourceId,
    options: &'w Options,
    /// Of who keeps what is learnt.
    stop: Option<Stop<'w>>,
    /// Of scenes before this one.
    decoded: &'w Decoded,
}

impl World<'_> {
    /// Checks, evaluates and lowers.
    fn stages(
        &self,
        mut imported: Imported,
        (settings, slips): (Vec<Setting>, Vec<Diagnostic>),
    ) -> (Compiled, Study) {
        let World { files, sources, main, .. } = *self;
        let mut diagnostics = std::mem::take(&mut imported.diagnostics);
        diagnostics.extend(slips);
        let mut study = Study::default();
        let (program, found) = match self.stop {
            None => {
                let found = check::check(files, sources, &imported, &settings);
                // The trees are large.
                drop(imported);
                found
            }
            Some(_) => {
                let (program, found, notes) = check::study(files, sources, &imported, &settings);
                study = Study { files: imported.files, notes, ..study };
                (program, found)
            }
        };
        diagnostics.extend(found);
        if self.is_stopped() {
            return (Compiled::unfinished(main), study);
        }
        self.evaluated(program, &settings, diagnostics, study)
    }

    /// Evaluates what was checked, and lowers it.
    fn evaluated(
        &self,
        program: Program,
        settings: &[Setting],
        mut diagnostics: Vec<Diagnostic>,
        mut study: Study,
    ) -> (Compiled, Study) {
        let World { files, sources, main, options, .. } = *self;
        if diagnostic::any_errors(&diagnostics) {
            // What could not be understood may use any name.
            diagnostics.retain(|diagnostic| diagnostic.code != Code::W0106);
        }
        let meshes = Meshes::new(files, sources, self.decoded);
        let measure = |things: &Things, thing: &Thing| lower::measure(things, thing, &meshes);
        let (things, found) = match self.stop {
            None => eval::eval(&program, options.limits, &measure),
            Some(stop) => {
                let (things, found, values) = eval::watch(&program, options.limits, &measure, &|| stop());
                study.values = values;
                (things, found)
            }
        };
        diagnostics.extend(found);
        if self.is_stopped() {
            return (Compiled::unfinished(main), study);
        }
        let mut lowered = lower::lower(&things, &options.overrides, files, sources, &meshes);
        diagnostics.append(&mut lowered.diagnostics);
        if self.stop.is_some() {
            let taken = lowered.scene.as_ref().map(|scene| (scene.camera, lowered.marks.camera));
            let others = lowered.others.iter().map(|(camera, marks)| (*camera, marks.camera));
            let written =
                taken.into_iter().chain(others).filter_map(|(camera, place)| Some((camera, place?)));
            study.views = written.collect();
        }
        if self.is_stopped() {
            return (Compiled::unfinished(main), study);
        }
        check::blame(settings, sources, main, &mut diagnostics);
        if !diagnostic::any_errors(&diagnostics) {
            diagnostics.extend(lower::nothing_to_see(&things, main));
        }
        if let Some(scene) = lowered.scene.as_ref().filter(|_| !diagnostic::any_errors(&diagnostics)) {
            diagnostics.extend(lint::lint(scene, &things.origins, &lowered.marks));
            for (camera, marks) in &lowered.others {
                diagnostics.extend(lint::look_through(scene, camera, &things.origins, marks));
            }
        }
        let inventory = Inventory::of(&program, sources, &things);
        (self.compiled(program, things, lowered, inventory, diagnostics), study)
    }

    /// Puts together what the stages found.
    fn compiled(
        &self,
        program: Program,
        things: Things,
        lowered: Lowered,
        inventory: Inventory,
        mut diagnostics: Vec<Diagnostic>,
    ) -> Compiled {
        let unused = allow::allow(&program.allows, &mut diagnostics);
        diagnostics.extend(unused);
        diagnostics.sort_by_key(|diagnostic| (diagnostic.primary.span, diagnostic.code));
        // What is wrong in a prototype is one error, however often it is used.
        diagnostics.dedup_by(|again, first| {
            (again.code, &again.primary, &again.message) == (first.code, &first.primary, &first.message)
        });
        let scene = lowered.scene.filter(|_| !diagnostic::any_errors(&diagnostics));
        Compiled {
            scene,
            inventory,
            origins: things.origins,
            diagnostics,
            notes: lowered.notes,
            contents: lowered.contents,
            main: self.main,
            allows: program.allows,
            marks: lowered.marks,
            vantage: lowered.vantage,
            places: lowered.places,
        }
    }

    fn is_stopped(&self) -> bool {
        self.stop.is_some_and(|stop| stop())
    }
}

impl Compiled {
    /// What there is to say of a source that is not worth compiling.
    pub fn refused(diagnostic: Diagnostic) -> Compiled {
        let main = diagnostic.primary.span.source;
        Compiled { diagnostics: vec![diagnostic], ..Compiled::unfinished(main) }
    }

    /// Nothing: nobody waits for it any more.
    fn unfinished(main: SourceId) -> Compiled {
        Compiled {
            scene: None,
            origins: Origins::default(),
            inventory: Inventory::default(),
            notes: vec![],
            contents: Contents::default(),
            main,
            diagnostics: vec![],
            allows: vec![],
            marks: Marks::default(),
            vantage: None,
            places: Places::default(),
        }
    }

    /// The scene with what tells where its parts came from; none where there was an error.
    pub fn provenance<'a>(&'a self, sources: &'a Sources) -> Option<Provenance<'a>> {
        let (origins, marks) = (&self.origins, &self.marks);
        self.scene.as_ref().map(|scene| Provenance { scene, origins, marks, sources })
    }

    /// What many paths of a finished picture tell, unless the source allows it. `noise` is that of the picture, as a share of
    /// white.
    pub fn heed(&self, feedback: &Feedback, noise: f64, sources: &Sources) -> Vec<Diagnostic> {
        /// The share of the light whose loss is worth knowing for who asks.
        const LEAST_CUT: f64 = 0.01;
        let Some(from) = self.provenance(sources) else { return vec![] };
        let mut said = from.findings(feedback, noise);
        said.retain(|warning| !self.explains(warning));
        let (share, bounces) = (feedback.cut.values().sum(), from.scene.trace.bounces);
        if share >= LEAST_CUT && bounces >= FEW_BOUNCES {
            said.push(from.point_at_cut(self.warning(&Finding::Cut { share, bounces }), feedback));
        }
        allow::allow(&self.allows, &mut said);
        said
    }

    /// Whether why a light gives nothing was said before there was a picture, or is allowed: that it is dark, or shut in.
    fn explains(&self, warning: &Diagnostic) -> bool {
        let is_why = |code: Code| matches!(code, Code::W0603 | Code::W0604);
        let place = warning.primary.span;
        let mut said = self.diagnostics.iter().filter(|said| is_why(said.code));
        let mut allowed = self.allows.iter().filter(|allow| is_why(allow.code));
        let names = |said: &Diagnostic| {
            said.primary.span == place || said.labels.iter().any(|label| label.span == place)
        };
        warning.code == Code::W0705 && (said.any(names) || allowed.any(|allow| allow.on.contains(place)))
    }

    /// What a finished picture gives cause to say, unless the source allows it.
    pub fn judge(&self, finding: &Finding) -> Option<Diagnostic> {
        let mut said = vec![self.warning(finding)];
        allow::allow(&self.allows, &mut said);
        said.pop()
    }

    fn warning(&self, finding: &Finding) -> Diagnostic {
        let start = Span::new(self.main, 0, 0);
        match *finding {
            Finding::Noisy { noise, samples } => {
                let place = self.places.noise.unwrap_or(start);
                let message =
                    format!("the noise is still {:.2}% after {samples} samples a pixel", 100.0 * noise);
                Diagnostic::new(Code::W0701, message, place)
                    .at(match self.places.noise {
                        Some(_) => "not reached",
                        None => "the picture of this file",
                    })
                    .help(
                        "give larger lights, which are found more easily, more samples, or allow more noise",
                    )
            }
            Finding::Cut { share, bounces } => {
                let message = format!(
                    "about {:.0}% of the light is lost, since paths end after {bounces} bounces",
                    100.0 * share
                );
                let help =
                    format!("raise it: `render {{ bounces: {} }}`; or use darker colours", 4 * bounces);
                Diagnostic::new(Code::W0702, message, self.places.bounces.unwrap_or(start))
                    .at("too few")
                    .help(help)
            }
            Finding::BurntOut { share, stops, fitting } => {
                let message =
                    format!("{:.0}% of the picture is burnt out to white at exposure {stops}", 100.0 * share);
                let help = match self.places.exposure {
                    Some(_) => format!("write `exposure: {fitting}`, which would fit, or `auto`"),
                    None => format!("`--exposure {fitting}` would fit, or `auto`"),
                };
                Diagnostic::new(Code::W0703, message, self.places.exposure.unwrap_or(start))
                    .at("too much")
                    .help(help)
            }
        }
    }
}

/// Limits of bounces below ask for what glows, or for direct light, and mean it.
pub const FEW_BOUNCES: u32 = 2;

/// Something about a finished picture that is probably not meant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Finding {
    /// It ended noisier than the source asks for.
    Noisy {
        /// As a share of white.
        noise: f64,
        /// Samples a pixel.
        samples: u32,
    },
    /// The limit of bounces ended paths that still carried light.
    Cut {
        /// About the share of the light that is lost.
        share: f64,
        /// The limit.
        bounces: u32,
    },
    /// Much of it is white, and was not before it was exposed.
    BurntOut {
        /// The share of its pixels.
        share: f64,
        /// The exposure that was given.
        stops: f64,
        /// The one that would fit.
        fitting: f64,
    },
}
