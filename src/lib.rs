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
//! | [`asset`] | the bytes of pictures to values | where the bytes came from |
//! | [`math`], [`color`], [`units`], [`develop`] | arithmetic with the same bits everywhere | the language |
//! | [`schema`] | the one table of kinds and fields | how they are checked or drawn |
//! | [`syntax`] | text to tree; never fails | names, types, the scene |
//! | [`import`] | the trees of all files that a scene is made of | names, types |
//! | [`check`] | tree to typed program: names, types, units | values |
//! | [`eval`] | program to things, each with the chain of uses that made it | the renderer |
//! | [`lower`] | things to scene: defaults, cameras, transforms, radiometry | text |
//! | [`scene`] | the picture in its simplest form | where it came from |
//! | [`render`] | scene to film; cannot fail | places, files, syntax |
//! | [`output`] | film to the bytes of image files, and back | files |
//! | [`report`] | diagnostics to text for a person | what they are about |

pub mod asset;
mod allow;
pub mod check;
pub mod color;
pub mod develop;
pub mod diagnostic;
pub mod eval;
pub mod files;
pub mod import;
pub mod lower;
pub mod math;
pub mod output;
pub mod render;
pub mod report;
pub mod scene;
pub mod schema;
pub mod source;
pub mod span;
pub mod syntax;
pub mod units;

use check::Setting;
use diagnostic::{Code, Diagnostic};
use eval::{Limits, Origins};
use files::Files;
use import::Imported;
use lower::Overrides;
use scene::Scene;
use source::Sources;
use span::{SourceId, Span};

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
    /// What can be set by `name=value`, in the order written.
    pub params: Vec<ParamFacts>,
    /// The source that was compiled.
    main: SourceId,
    /// Where the source says how noisy the picture may be.
    noise: Option<Span>,
}

/// A setting of a scene, as it is written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ParamFacts {
    /// What it is called.
    pub name: String,
    /// Its type, such as `length` or `[color]`.
    pub ty: String,
    /// What it is where it is not set.
    pub default: String,
    /// Both ends of what it must lie in.
    pub range: Option<[String; 2]>,
    /// The words above it.
    pub doc: Option<String>,
}

impl ParamFacts {
    fn of(param: &check::Param, sources: &Sources) -> ParamFacts {
        let text = |expr: &check::Expr| sources.text(expr.span).to_string();
        ParamFacts {
            name: param.name.to_string(),
            ty: param.declared.written(),
            default: param.written.clone(),
            range: param.range.as_ref().map(|[low, high]| [text(low), text(high)]),
            doc: param.doc.as_ref().map(|doc| doc.to_string()),
        }
    }
}

/// What a compilation may be told from outside.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// What stands in place of the file's settings of camera and render blocks.
    pub overrides: Overrides,
    /// Values for params of the file, each as `name=value`.
    pub set: Vec<String>,
    /// What evaluating may take.
    pub limits: Limits,
}

/// Bytes of stack for checking and evaluating: expressions within parts within calls go deep.
const STACK: usize = 256 << 20;

/// Compiles a source to a scene: parse it and what it imports, check, evaluate, lower. Every stage runs, also after
/// errors, so that one run reports all that is wrong. `files` is what the source may read; what it imports is added
/// to `sources`, and so is each setting.
pub fn compile(files: &dyn Files, sources: &mut Sources, main: SourceId, options: &Options) -> Compiled {
    let imported = import::import(files, sources, main);
    let (settings, slips) = check::settings(sources, &options.set);
    let sources = &*sources;
    let work = move || stages(files, sources, main, imported, settings, slips, options);
    std::thread::scope(|scope| {
        let thread = std::thread::Builder::new().stack_size(STACK).spawn_scoped(scope, work);
        let thread = thread.expect("the system gives a process one more thread");
        thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    })
}

fn stages(
    files: &dyn Files,
    sources: &Sources,
    main: SourceId,
    mut imported: Imported,
    settings: Vec<Setting>,
    slips: Vec<Diagnostic>,
    options: &Options,
) -> Compiled {
    let mut diagnostics = std::mem::take(&mut imported.diagnostics);
    diagnostics.extend(slips);
    let (program, found) = check::check(files, sources, &imported, &settings);
    // The trees are large.
    drop(imported);
    diagnostics.extend(found);
    if diagnostic::any_errors(&diagnostics) {
        // What could not be understood may use any name.
        diagnostics.retain(|diagnostic| diagnostic.code != Code::W0106);
    }
    let (things, found) = eval::eval(&program, options.limits, lower::measure);
    diagnostics.extend(found);
    let lowered = lower::lower(&things, &options.overrides, files, sources);
    diagnostics.extend(lowered.diagnostics);
    if !diagnostic::any_errors(&diagnostics) {
        diagnostics.extend(lower::nothing_to_see(&things, main));
    }
    let unused = allow::allow(&program.allows, &mut diagnostics);
    diagnostics.extend(unused);
    diagnostics.sort_by_key(|diagnostic| (diagnostic.primary.span, diagnostic.code));
    // What is wrong in a prototype is one error, however often it is used.
    diagnostics.dedup_by(|again, first| {
        (again.code, &again.primary, &again.message) == (first.code, &first.primary, &first.message)
    });
    let scene = lowered.scene.filter(|_| !diagnostic::any_errors(&diagnostics));
    let (notes, noise) = (lowered.notes, lowered.noise);
    let params = program.main().map_or(&[][..], |part| &part.params);
    let params = params.iter().map(|param| ParamFacts::of(param, sources)).collect();
    Compiled { scene, origins: things.origins, diagnostics, notes, params, main, noise }
}

impl Compiled {
    /// The warning of a render that ended noisier than the source asks for: `noise`, as a share of white, after
    /// so many samples a pixel.
    pub fn noise_not_reached(&self, noise: f64, samples: u32) -> Diagnostic {
        let place = self.noise.unwrap_or(Span::new(self.main, 0, 0));
        let message = format!("the noise is still {:.2}% after {samples} samples a pixel", 100.0 * noise);
        Diagnostic::new(Code::W0701, message, place)
            .at("not reached")
            .help("give larger lights, which are found more easily, or allow more noise")
    }
}
