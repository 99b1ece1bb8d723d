//! Why a pixel looks as it does: what it shows, and where its light comes from, each by its place in the source.
//!
//! A pixel is taken apart by watching the very paths that make it ([`Apart`]); the parts add up to it. Here they get their
//! names and places.

mod feedback;

use crate::color::{Rgb, luminance};
use crate::eval::Origins;
use crate::lower::Marks;
use crate::render::apart::Apart;
use crate::render::light::Source;
use crate::render::observer::PathKind;
use crate::scene::{Light, Material, OriginId, Primitive, PrimitiveId, Scene};
use crate::source::{Place, Sources};
use crate::span::Span;
use serde::Serialize;

/// A scene with what tells where its parts came from.
#[derive(Clone, Copy)]
pub struct Provenance<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// Where its primitives came from.
    pub origins: &'a Origins,
    /// Where the rest of it came from.
    pub marks: &'a Marks,
    /// The texts of these places.
    pub sources: &'a Sources,
}

/// The version of [`Why`] as JSON. It grows when a field goes or changes its meaning, not when one is added.
pub const SCHEMA: u32 = 1;

/// Why a pixel looks as it does. docs/why-json.md describes it as JSON.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Why<'a> {
    /// [`SCHEMA`].
    pub schema: u32,
    /// Column and row in the full picture, from its top left.
    pub pixel: [u32; 2],
    /// How many paths this is known from.
    pub samples: u32,
    /// What chose how many.
    pub samples_by: SamplesBy,
    /// How many of them are brighter than the picture has room for, and count for as much as it has.
    pub clipped: u32,
    /// Linear red, green and blue (sRGB's primaries) in W/(m²·sr), before exposure.
    pub radiance: [f64; 3],
    /// Standard error of the radiance's luminance; none below two samples.
    pub error: Option<f64>,
    /// The share of the pixel that is covered: below 1 only in front of a transparent background.
    pub coverage: f64,
    /// Distance in metres along the camera's axis, as `focus` counts; none where nothing is met.
    pub depth: Option<f64>,
    /// The mean normal in the world, on the side of the camera; none where nothing is met.
    pub normal: Option<[f64; 3]>,
    /// What the pixel shows, the largest share first, and no more than the few largest.
    pub shows: Vec<Shown<'a>>,
    /// The further things that it shows.
    pub others: Others,
    /// The share of it that shows nothing but the background. It, those of `shows` and that of the others add up to 1.
    pub background: f64,
    /// Where its light comes from, the most first. Adds up to the radiance, but for rounding.
    pub lights: Vec<LightShare<'a>>,
    /// By what kinds of paths, the most first. Adds up to the radiance, but for rounding.
    pub paths: Vec<PathShare>,
}

/// What chose from how many paths a pixel is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum SamplesBy {
    /// Whoever asked. They are the first ones of the picture's.
    Command,
    /// `samples` in the scene: they are the picture's.
    Scene,
    /// Nobody; a scene without `samples` has as many as the language says: they are the picture's.
    Default,
    /// The program: the scene asks for a level of noise, and how many that takes is known once the whole picture is made.
    Noise,
    /// A picture in the making, which has so many by now.
    Picture,
}

/// Things that are only counted.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Others {
    /// How many.
    pub count: usize,
    /// How much of the pixel they cover together.
    pub share: f64,
}

/// Something that a pixel shows.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Shown<'a> {
    /// How much of the pixel it covers, from 0 to 1.
    pub share: f64,
    /// What it is.
    #[serde(flatten)]
    pub thing: ThingAt<'a>,
    /// What it is made of; none of a light.
    pub material: Option<MaterialAt<'a>>,
}

/// A thing with its place in the source.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ThingAt<'a> {
    /// Its kind: `sphere`, `light`, `sky`.
    pub kind: &'static str,
    /// Which of several that came there by the same uses, where a loop has so many turns that they are not told apart; none
    /// where there is but one.
    pub number: Option<Number>,
    /// The uses that led to it, outermost first, itself last; none of what was chosen for the user.
    pub uses: Vec<Used<'a>>,
}

/// Which of how many.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Number {
    /// From 1, in the order written.
    pub this: usize,
    /// How many there are.
    pub of: usize,
}

/// A use of a thing, part, group or loop.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Used<'a> {
    /// Where it stands.
    #[serde(flatten)]
    pub place: Place<'a>,
    /// Its first line.
    pub text: &'a str,
    /// Of a loop the turn, such as `i = 2`, where it is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub turn: Option<&'a str>,
    /// The same place, for those who have the texts.
    #[serde(skip)]
    pub span: Span,
}

/// A material with its place in the source.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MaterialAt<'a> {
    /// Its kind: `diffuse`.
    pub kind: &'static str,
    /// The name of it or of what it was made from.
    pub name: Option<&'a str>,
    /// Where it was written; none where it was chosen for the user.
    pub place: Option<Used<'a>>,
}

/// What a light adds to a pixel. Those that came there by the same uses count together.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LightShare<'a> {
    /// What it is.
    #[serde(flatten)]
    pub thing: ThingAt<'a>,
    /// How many lights that came there by the same uses add anything. Where it is one, `number` tells which.
    pub count: usize,
    /// What it adds to the pixel's.
    pub radiance: [f64; 3],
    /// The share of the pixel's luminance.
    pub share: f64,
}

/// What comes by a kind of paths.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PathShare {
    /// `seen`, `direct`, `caustic`, `mirrored`, `refracted` or `indirect`: see [`PathKind`].
    pub kind: &'static str,
    /// Of indirect light, by how many other surfaces it came.
    pub order: Option<u32>,
    /// What it adds to the pixel's.
    pub radiance: [f64; 3],
    /// The share of the pixel's luminance.
    pub share: f64,
}

/// The most things that a pixel is said to show one by one.
const MOST_SHOWN: usize = 8;

impl<'a> Why<'a> {
    /// Names the parts of a pixel.
    pub fn new(pixel: [u32; 2], apart: &Apart, samples_by: SamplesBy, from: Provenance<'a>) -> Why<'a> {
        let firsts = apart.firsts();
        let error = Some(apart.error()).filter(|error| error.is_finite());
        let shown = firsts.shown();
        let (shows, others) = shown.split_at(shown.len().min(MOST_SHOWN));
        Why {
            schema: SCHEMA,
            pixel,
            samples: apart.samples(),
            samples_by,
            clipped: apart.clipped(),
            radiance: apart.mean().to_array(),
            error,
            coverage: apart.alpha(),
            depth: firsts.depth(),
            normal: firsts.normal().map(|n| n.to_array()),
            shows: shows.iter().map(|(id, share)| from.shown(*id, *share)).collect(),
            others: Others {
                count: others.len(),
                share: others.iter().fold(0.0, |sum, (_, share)| sum + share),
            },
            background: firsts.background(),
            lights: from.lights(apart),
            paths: paths(apart),
        }
    }
}

/// The share that a part has in the luminance of all.
fn share_of(apart: &Apart, part: Rgb) -> f64 {
    let whole = luminance(apart.parts().map(|(.., part)| part).sum());
    if whole == 0.0 { 0.0 } else { luminance(part) / whole }
}

fn paths(apart: &Apart) -> Vec<PathShare> {
    let share = |(kind, radiance): (PathKind, Rgb)| {
        let (kind, order) = match kind {
            PathKind::Seen => ("seen", None),
            PathKind::Direct => ("direct", None),
            PathKind::Caustic => ("caustic", None),
            PathKind::Mirrored => ("mirrored", None),
            PathKind::Refracted => ("refracted", None),
            PathKind::Indirect(order) => ("indirect", Some(order)),
        };
        PathShare { kind, order, radiance: radiance.to_array(), share: share_of(apart, radiance) }
    };
    apart.by_kind().into_iter().map(share).collect()
}

impl<'a> Provenance<'a> {
    /// The thing that a primitive is.
    pub fn thing(&self, id: PrimitiveId) -> ThingAt<'a> {
        let primitive = &self.scene.primitives[id.0 as usize];
        let alike = |other: &Primitive| other.origin == primitive.origin;
        let number = number(self.scene.primitives.iter().map(alike), id.0);
        ThingAt { number, ..self.thing_of(id) }
    }

    /// The same without its number, which takes a look at all others.
    pub fn thing_of(&self, id: PrimitiveId) -> ThingAt<'a> {
        let primitive = &self.scene.primitives[id.0 as usize];
        let kind = if self.is_lamp(id) { "light" } else { primitive.shape.kind() };
        ThingAt { kind, number: None, uses: self.uses(primitive.origin) }
    }

    /// The thing that a source of light is.
    pub fn source(&self, source: Source) -> ThingAt<'a> {
        let index = match source {
            Source::Primitive(id) => return self.thing(id),
            Source::Light(index) => index,
        };
        let kind = match self.scene.lights[index as usize] {
            Light::Point { .. } | Light::Spot { .. } => "light",
            Light::Sun { .. } => "sun",
            Light::Sky { .. } => "sky",
        };
        let lights = &self.marks.lights;
        let origin = lights.get(index as usize).copied().flatten();
        let number = origin.and_then(|_| number(lights.iter().map(|other| *other == origin), index));
        ThingAt { kind, number, uses: origin.map_or(vec![], |origin| self.uses(origin)) }
    }

    /// Whether a primitive is the glowing sphere of a light, which has no material of its own.
    fn is_lamp(&self, id: PrimitiveId) -> bool {
        let material = self.scene.material(&self.scene.primitives[id.0 as usize]);
        matches!(material, Material::Emitter { .. }) && self.marks.materials.of(id).is_none()
    }

    fn shown(&self, id: PrimitiveId, share: f64) -> Shown<'a> {
        Shown { share, thing: self.thing(id), material: self.material(id) }
    }

    /// What a primitive is made of; none of a light.
    pub fn material(&self, id: PrimitiveId) -> Option<MaterialAt<'a>> {
        if self.is_lamp(id) {
            return None;
        }
        let mark = self.marks.materials.of(id);
        Some(MaterialAt {
            kind: self.scene.material(&self.scene.primitives[id.0 as usize]).kind(),
            name: mark.and_then(|(_, name)| name),
            place: mark.map(|(span, _)| self.used(span)),
        })
    }

    fn lights(&self, apart: &Apart) -> Vec<LightShare<'a>> {
        // By place; what was chosen for the user stands alone.
        let mut places: Vec<(Option<OriginId>, Vec<Source>, Rgb)> = vec![];
        for (source, radiance) in apart.by_light() {
            let origin = self.origin(source);
            match places.iter_mut().find(|(known, ..)| origin.is_some() && *known == origin) {
                Some((_, sources, sum)) => {
                    sources.push(source);
                    *sum += radiance;
                }
                None => places.push((origin, vec![source], radiance)),
            }
        }
        places.sort_by(|(_, _, a), (_, _, b)| luminance(*b).total_cmp(&luminance(*a)));
        let share = |(_, sources, radiance): (_, Vec<Source>, Rgb)| {
            let mut thing = self.source(sources[0]);
            if sources.len() > 1 {
                thing.number = None;
            }
            let share = share_of(apart, radiance);
            LightShare { thing, count: sources.len(), radiance: radiance.to_array(), share }
        };
        places.into_iter().map(share).collect()
    }

    /// Where a source of light came from.
    pub fn origin(&self, source: Source) -> Option<OriginId> {
        match source {
            Source::Primitive(id) => Some(self.scene.primitives[id.0 as usize].origin),
            Source::Light(index) => self.marks.lights.get(index as usize).copied().flatten(),
        }
    }

    fn uses(&self, origin: OriginId) -> Vec<Used<'a>> {
        let used = |(span, turn)| Used { turn, ..self.used(span) };
        self.origins.uses(origin).into_iter().map(used).collect()
    }

    fn used(&self, span: Span) -> Used<'a> {
        let (place, text) = (self.sources.place_of(span), self.sources.first_line(span));
        Used { place, text, turn: None, span }
    }
}

/// Which of those that are alike one is, by its index among all; none where it is the only one.
fn number(alike: impl Iterator<Item = bool>, index: u32) -> Option<Number> {
    let (mut this, mut of) = (0, 0);
    for (other, alike) in (0..).zip(alike) {
        of += usize::from(alike);
        if other == index {
            this = of;
        }
    }
    (of > 1).then_some(Number { this, of })
}
