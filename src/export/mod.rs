//! The scene for other renderers: Mitsuba 3, pbrt-v4 and POV-Ray, such that they make the same picture.
//!
//! What a renderer cannot say is an [`Unsaid`] that names the thing and the reason, and there is no text. Some of it
//! can be said nearly, which has to be asked for ([`Options::approximate`]) and is listed in [`Exported::notes`].
//! Curved surfaces that a renderer does not know can be asked for as triangles ([`Options::tessellate`]).
//!
//! Exposure, tone mapping and seeds are not part of an export: all three write linear radiance.

mod cells;
mod media;
mod mitsuba;
mod pbrt;
mod panorama;
mod pov;
mod triangles;

use crate::scene::shape::Bounds;
use crate::scene::{Background, Filter, OriginId, Scene, Target};
use std::collections::BTreeSet;

/// A renderer to write for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Renderer {
    /// Mitsuba 3, as XML.
    Mitsuba,
    /// pbrt, version 4.
    Pbrt,
    /// POV-Ray 3.7.
    Pov,
}

/// What may be done about that which a renderer cannot say.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// What the names of files beside the scene begin with.
    pub stem: String,
    /// Says nearly what cannot be said exactly.
    pub approximate: bool,
    /// Says curved surfaces as triangles, in this many steps around; at least 3.
    pub tessellate: Option<u32>,
}

/// A scene for another renderer.
#[derive(Clone, Debug, Default)]
pub struct Exported {
    /// The scene file.
    pub text: String,
    /// Files that lie beside it, by name.
    pub files: Vec<(String, Vec<u8>)>,
    /// What is not quite as in the scene, a line each.
    pub notes: BTreeSet<String>,
}

/// Something that a renderer cannot say.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Unsaid {
    /// Where it stands in the scene; none of settings.
    pub origin: Option<OriginId>,
    /// What and why, in one sentence without a full stop.
    pub what: String,
    /// What helps.
    pub help: Option<&'static str>,
}

impl Renderer {
    /// By the extension of a file: `xml`, `pbrt` or `pov`.
    pub fn from_extension(extension: &str) -> Option<Renderer> {
        match extension {
            "xml" => Some(Renderer::Mitsuba),
            "pbrt" => Some(Renderer::Pbrt),
            "pov" => Some(Renderer::Pov),
            _ => None,
        }
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Renderer::Mitsuba => "Mitsuba",
            Renderer::Pbrt => "pbrt",
            Renderer::Pov => "POV-Ray",
        }
    }
}

/// Writes a scene for a renderer.
///
/// # Errors
///
/// Everything that it cannot say, in the order of the scene.
pub fn export(scene: &Scene, renderer: Renderer, options: Options) -> Result<Exported, Vec<Unsaid>> {
    let mut writer =
        Writer { scene, renderer, options, out: Exported::default(), unsaid: vec![], textures: 0 };
    writer.settings();
    match renderer {
        Renderer::Mitsuba => mitsuba::write(&mut writer),
        Renderer::Pbrt => pbrt::write(&mut writer),
        Renderer::Pov => pov::write(&mut writer),
    }
    if writer.unsaid.is_empty() { Ok(writer.out) } else { Err(writer.unsaid) }
}

const APPROXIMATE: &str = "`--approximate` says it nearly";
const TESSELLATE: &str = "`--tessellate 64` makes triangles of it";

/// A scene on its way to a text.
struct Writer<'s> {
    scene: &'s Scene,
    renderer: Renderer,
    options: Options,
    out: Exported,
    unsaid: Vec<Unsaid>,
    /// How many textures were named.
    textures: usize,
}

impl Writer<'_> {
    /// Adds a line.
    fn put(&mut self, line: impl AsRef<str>) {
        self.out.text.push_str(line.as_ref());
        self.out.text.push('\n');
    }

    fn note(&mut self, line: impl Into<String>) {
        self.out.notes.insert(line.into());
    }

    /// Something that cannot be said in any way.
    fn refuse(&mut self, origin: Option<OriginId>, what: &str, help: Option<&'static str>) {
        let what = format!("{} {what}", self.renderer.name());
        // One of each is enough to see it; a loop may have made a million.
        if !self.unsaid.iter().any(|known| known.what == what) {
            self.unsaid.push(Unsaid { origin, what, help });
        }
    }

    /// Something that can only be said nearly: whether to do so.
    fn nearly(&mut self, origin: Option<OriginId>, what: &str, how: &str) -> bool {
        if self.options.approximate {
            self.note(format!("{} {what}: {how}", self.renderer.name()));
        } else {
            self.refuse(origin, what, Some(APPROXIMATE));
        }
        self.options.approximate
    }

    /// Samples a pixel.
    fn samples(&mut self) -> u32 {
        match self.scene.trace.target {
            Target::Samples(samples) => samples,
            Target::Noise(_) => {
                self.note("a noise target is not exported: 256 samples a pixel");
                256
            }
        }
    }

    /// What no renderer has.
    fn settings(&mut self) {
        let trace = &self.scene.trace;
        if !trace.indirect && self.renderer != Renderer::Pov {
            self.refuse(None, "has no way to leave out indirect light alone: `indirect: false`", None);
        }
        if trace.background == Background::Transparent {
            self.refuse(None, "is not told of transparent backgrounds", None);
        }
        if trace.filter == Filter::Gaussian && self.renderer != Renderer::Pov {
            self.note("the gaussian filter ends a little elsewhere; `filter: box` is the same everywhere");
        }
    }
}

/// The size of everything that has an end, and of the camera's distance from it.
fn size(scene: &Scene) -> f64 {
    let camera = Bounds { min: scene.camera.position, max: scene.camera.position };
    let bounds = scene.primitives.iter().filter_map(|primitive| primitive.shape.bounds());
    bounds.fold(camera, Bounds::union).size().length().max(1.0)
}

/// Numbers with something between, each with the fewest digits that read back as the same number.
fn numbers(values: impl IntoIterator<Item = f64>, between: &str) -> String {
    values.into_iter().map(number).collect::<Vec<_>>().join(between)
}

fn number(x: f64) -> String {
    let text = format!("{x:?}");
    text.strip_suffix(".0").map_or(text.clone(), str::to_string)
}
