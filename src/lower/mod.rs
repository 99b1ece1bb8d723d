//! Things to scene: materials and shapes in world space, power as radiance, one camera; and the defaults that
//! make `sphere { radius: 1m }` a picture.

mod blocks;
mod camera;
mod decoded;
mod errors;
mod lights;
mod material;
mod marks;
mod mesh;
mod shape;
mod sky;
mod texture;

use crate::color::Rgb;
use crate::diagnostic::{Diagnostic, Use};
use crate::eval::{Aim, Reach, Thing, Things};
use crate::files::{Contents, Files};
use crate::math::{DAffine3, PI, sin};
use crate::scene::shape::{Bounds, Placed};
use crate::scene::{
    Camera, Develop, FrameId, Light, Material, MaterialId, OriginId, Primitive, Scene, Shape, Tonemap,
};
use crate::schema::{self, Category, KindId, light, sun};
use crate::source::Sources;
use crate::span::{SourceId, Span};
pub use camera::Vantage;
pub use decoded::Decoded;
pub use marks::{Marks, MaterialMarks};
use material::Materials;
pub use mesh::Meshes;
use std::sync::Arc;
use texture::Textures;

/// The most pixels a picture may have.
pub const MAX_PIXELS: u64 = 100_000_000;

/// Settings from outside that stand in place of the file's.
#[derive(Clone, Debug, Default)]
pub struct Overrides {
    /// The name of the camera that takes the picture.
    pub camera: Option<String>,
    /// Whether all cameras are looked at, and so none of several has to be chosen.
    pub every_camera: bool,
    /// Where the camera stands and looks as far as the file leaves that open.
    pub vantage: Option<Vantage>,
    /// Width and height in pixels.
    pub size: Option<[u32; 2]>,
    /// Samples a pixel, in place of the file's samples or noise.
    pub samples: Option<u32>,
    /// A noise target, in place of the file's samples or noise. It goes before the samples here.
    pub noise: Option<f64>,
    /// Whether there is another limit, so that a file that gives none has as many samples as there can be.
    pub limited: bool,
    /// Chooses the random numbers.
    pub seed: Option<u64>,
    /// In stops; an inner none is `auto`.
    pub exposure: Option<Option<f64>>,
    /// The curve from scene to display.
    pub tonemap: Option<Tonemap>,
}

/// What lowering found.
#[derive(Debug, Default)]
pub struct Lowered {
    /// The scene, where nothing is wrong.
    pub scene: Option<Scene>,
    /// One line for each default that was chosen for the user.
    pub notes: Vec<String>,
    /// What is wrong.
    pub diagnostics: Vec<Diagnostic>,
    /// Where settings stand that only a finished picture can judge.
    pub places: Places,
    /// Where the rest of the scene stands.
    pub marks: Marks,
    /// Where the camera stands and looks.
    pub vantage: Option<Vantage>,
    /// The cameras that do not take the picture, each with its places, where they are looked at.
    pub others: Vec<(Camera, Marks)>,
    /// Where its pictures and meshes were read.
    pub contents: Contents,
}

/// Where settings stand that only a finished picture can judge; none where the source does not give them.
#[derive(Clone, Copy, Debug, Default)]
pub struct Places {
    /// The noise target.
    pub noise: Option<Span>,
    /// The limit of bounces.
    pub bounces: Option<Span>,
    /// The exposure that is in force.
    pub exposure: Option<Span>,
}

/// Lowers the things of a picture. Things with errors, which were reported, are left out.
pub fn lower(
    things: &Things,
    overrides: &Overrides,
    files: &dyn Files,
    sources: &Sources,
    meshes: &Meshes,
) -> Lowered {
    let written = written_blocks(things);
    let mut lowering = Lowering {
        things,
        overrides,
        written: &written,
        primitives: vec![],
        materials: Materials::default(),
        textures: Textures::new(files, sources, meshes.decoded),
        meshes,
        frames: vec![],
        lights: vec![],
        extents: vec![Extent::Nowhere; things.len()],
        bare: 0,
        out: Lowered::default(),
    };
    lowering.surfaces_and_lights();
    let blocks = lowering.blocks();
    let size = lowering.size(&blocks);
    lowering.other_cameras(&blocks, size);
    let camera = lowering.camera(&blocks, size);
    lowering.say_defaults();
    if let (Some(camera), Some(size)) = (camera, size) {
        let (trace, tonemap) = lowering.trace(&blocks, size);
        lowering.textures.name(&mut lowering.out.contents);
        meshes.name(&mut lowering.out.contents);
        let (textures, images) = lowering.textures.finish();
        lowering.out.scene = Some(Scene {
            primitives: Arc::new(lowering.primitives),
            materials: lowering.materials.finish(),
            textures,
            images,
            frames: lowering.frames,
            lights: lowering.lights,
            camera: camera.0,
            trace,
            develop: Develop { exposure: overrides.exposure.unwrap_or(camera.1), tonemap },
        });
    }
    lowering.out
}

/// What is wrong with things among which there is nothing to see: asked only where nothing else is wrong.
pub fn nothing_to_see(things: &Things, main: SourceId) -> Option<Diagnostic> {
    let seen = |kind: KindId| matches!(kind.get().category, Category::Shape | Category::Light);
    (!things.kinds().any(seen)).then(|| errors::nothing_stands(main))
}

/// Where a thing is, for what asks before there is a scene.
pub fn measure(things: &Things, thing: &Thing, meshes: &Meshes) -> Result<Reach, Box<Diagnostic>> {
    let (made, kind) = (thing.made, thing.made.kind());
    let shape = if kind == schema::mesh::KIND {
        meshes.lower(things, thing)?
    } else if kind.get().category == Category::Shape {
        shape::lower(things, thing)?
    } else if kind == light::KIND {
        let at = things.read(made, light::AT);
        let radius = things.read(made, light::RADIUS);
        if radius == 0.0 {
            let position = thing.world_from_object.transform_point3(at);
            return Ok(Reach::Box(Bounds { min: position, max: position }));
        }
        shape::ball(thing.world_from_object * DAffine3::from_translation(at), radius, made.span())?
    } else {
        return Ok(Reach::Nowhere);
    };
    Ok(shape.bounds().map_or(Reach::Endless, Reach::Box))
}

/// The blocks that are not left out, each with its index among the things.
fn written_blocks(things: &Things) -> Vec<(usize, Thing<'_>)> {
    let blocks = things.of(|kind| kind.get().category == Category::Block);
    blocks.filter(|(_, thing)| !thing.hidden).collect()
}

struct Lowering<'a> {
    things: &'a Things,
    overrides: &'a Overrides,
    /// The blocks, each with its index among the things.
    written: &'a [(usize, Thing<'a>)],
    primitives: Vec<Primitive>,
    materials: Materials,
    textures: Textures<'a>,
    meshes: &'a Meshes<'a>,
    frames: Vec<Placed>,
    lights: Vec<Light>,
    /// By thing.
    extents: Vec<Extent>,
    /// How many shapes name no material.
    bare: usize,
    out: Lowered,
}

/// Where a thing is.
#[derive(Clone, Copy, Debug)]
enum Extent {
    /// Is in no place: a block, a sky.
    Nowhere,
    /// Has no end.
    Endless,
    /// Lies in a box, and is to be seen.
    Box(Bounds),
    /// A lamp: has a place, but a camera that frames the picture need not show it.
    Lamp(Bounds),
}

impl<'a> Lowering<'a> {
    fn report(&mut self, diagnostic: Diagnostic) {
        self.out.diagnostics.push(diagnostic);
    }

    fn surfaces_and_lights(&mut self) {
        let mut sky_place = None;
        let mut spots = vec![];
        for (index, thing) in self.things.iter().enumerate() {
            if thing.hidden {
                self.hidden(index, &thing);
                continue;
            }
            let sound =
                thing.made.is_sound() && thing.material.as_ref().is_none_or(|given| given.value.is_sound());
            let kind = thing.made.kind();
            if kind == schema::sky::KIND {
                if let Some(first) = sky_place {
                    self.report(errors::second("sky", thing.made.span(), first));
                    continue;
                }
                sky_place = Some(thing.made.span());
            }
            if !sound {
                continue;
            }
            if kind.get().category == Category::Shape {
                self.surface(index, &thing);
            } else if kind == light::KIND {
                self.lamp(index, &thing);
                if let Some((aim, span)) = thing.made.given(light::AIM) {
                    spots.push((index, thing, aim, span));
                }
            } else if kind == sun::KIND {
                self.sun(&thing);
            } else if kind == schema::sky::KIND {
                self.sky(&thing);
            }
        }
        for (index, thing, aim, span) in spots {
            self.spot(index, &thing, aim, span);
        }
    }

    /// What is left out is not drawn, and still has its place for those that aim at it.
    fn hidden(&mut self, index: usize, thing: &Thing) {
        if thing.made.is_sound()
            && let Ok(Reach::Box(bounds)) = measure(self.things, thing, self.meshes)
        {
            self.extents[index] = Extent::Lamp(bounds);
        }
    }

    fn surface(&mut self, index: usize, thing: &Thing) {
        let lowered = match thing.made.kind() {
            schema::mesh::KIND => self.meshes.lower(self.things, thing),
            _ => shape::lower(self.things, thing),
        };
        let shape = match lowered {
            Ok(shape) => shape,
            Err(diagnostic) => return self.report(self.used_at(thing, *diagnostic)),
        };
        let extent = shape.bounds().map_or(Extent::Endless, Extent::Box);
        self.extents[index] = extent;
        let material = match self.material(thing, &shape) {
            Ok(material) => material,
            Err(diagnostic) => return self.report(self.used_at(thing, *diagnostic)),
        };
        let mut frame = None;
        if self.materials.get(material).texture().is_some() {
            let world_from_grain = thing.world_from_grain.unwrap_or(thing.world_from_object);
            match shape::placed(world_from_grain, thing.made.span()) {
                Ok(placed) => self.frames.push(placed),
                Err(diagnostic) => return self.report(self.used_at(thing, *diagnostic)),
            }
            frame = Some(FrameId(self.frames.len() as u32 - 1));
        }
        self.out.marks.materials.note(self.primitives.len(), thing.material.as_ref());
        self.add_surface(shape, material, frame, thing.origin);
    }

    /// What a thing is made of, lowered once where things share it.
    fn material(&mut self, thing: &Thing, shape: &Shape) -> Result<MaterialId, Box<Diagnostic>> {
        let given = thing.material.as_ref();
        self.bare += usize::from(given.is_none());
        if let Some(known) = self.materials.known(given) {
            return Ok(known);
        }
        let material = match given {
            Some(given) => material::lower(&mut self.textures, self.things, given, shape)?,
            None => material::bare(self.things),
        };
        let id = self.materials.add(material);
        self.materials.remember(given, id);
        Ok(id)
    }

    fn add_surface(&mut self, shape: Shape, material: MaterialId, frame: Option<FrameId>, origin: OriginId) {
        self.primitives.push(Primitive { shape, material, frame, origin });
    }

    /// Says what was chosen for the user, and chooses light where there is none.
    fn say_defaults(&mut self) {
        if self.bare > 0 {
            let which =
                if self.bare == 1 { "one shape names".into() } else { format!("{} shapes name", self.bare) };
            let color = crate::schema::DEFAULT_COLOR;
            self.out.notes.push(format!("{which} no material: light grey `diffuse {{ color: {color} }}`"));
        }
        let glows = self.materials.all().any(|material| matches!(material, Material::Emitter { .. }));
        if self.lights.is_empty() && !glows {
            let lights =
                self.things.iter().filter(|thing| !thing.hidden).any(|thing| {
                    thing.made.kind().get().category == Category::Light || !thing.made.is_sound()
                });
            if !lights {
                self.lights.push(Light::Sky { radiance: Rgb::ONE, panorama: None });
                self.out.marks.lights.push(None);
                self.out.notes.push("no light: a soft white sky, as `sky {}`".into());
            }
        }
    }

    /// Adds the chain of uses that led to a thing, but for those whose text holds the place anyway.
    fn used_at(&self, thing: &Thing, mut diagnostic: Diagnostic) -> Diagnostic {
        let chain = self.things.origins.chain(thing.origin);
        diagnostic.uses = chain
            .into_iter()
            .filter(|place| !place.contains(diagnostic.primary.span))
            .map(Use::from)
            .collect();
        diagnostic
    }
}

/// A thing of a kind as if it had been written with nothing in it.
fn plain(kind: crate::schema::KindId) -> crate::eval::Made {
    crate::eval::Made::new(kind, Span::new(SourceId(0), 0, 0))
}
