//! Where light comes from, and how to draw a direction towards it.
//!
//! At every vertex one light is chosen with a probability that follows a cheap estimate of what it gives there (by a
//! tree where there are many). Each sample stands beside the density with which a ray that was scattered towards the
//! light would have been drawn, so that the two ways can share the work (multiple importance sampling).

mod choice;
mod panorama;
mod sample;
mod surface;
mod tree;

use super::caustic::goal::{Goal, Target};
use super::lanes::{Float, Lanes, Mask, One};
use super::space::{Space, double};
use super::surfaces::Surfaces;
use super::vector::{V, single};
use crate::color::{Rgb, luminance};
use crate::math::PI;
use crate::scene::{Light, Material, Paint, PrimitiveId, Scene, Shape};
use choice::Choice;
use panorama::Sky;
use sample::Columns;
use surface::Glowing;

/// What gives light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Source {
    /// Index into [`Scene::lights`].
    Light(u32),
    /// A glowing surface.
    Primitive(PrimitiveId),
}

/// Where light is wanted.
#[derive(Clone, Copy)]
pub struct Receivers<L: Lanes> {
    /// The point.
    pub p: V<L>,
    /// Unit normal on the side from which light may come.
    pub n: V<L>,
    /// Whether light may come from all sides, whatever the normal.
    pub open: L::M,
}

impl<L: Lanes> Receivers<L> {
    /// One of them.
    #[inline]
    pub fn lane(&self, lane: usize) -> Receivers<One> {
        Receivers {
            p: V::splat(One, self.p.get(lane)),
            n: V::splat(One, self.n.get(lane)),
            open: self.open.bits() >> lane & 1 == 1,
        }
    }
}

/// A direction towards a light a lane.
#[derive(Clone, Copy)]
pub struct LightSamples<L: Lanes> {
    /// Whether there is one: the light may not be seen from there.
    pub some: L::M,
    /// Towards the light.
    pub wi: V<L>,
    /// How far away it is, maybe infinitely.
    pub distance: L::F,
    /// Radiance from there if nothing is in between; of a point or a distant one its irradiance on a surface
    /// that faces it.
    pub radiance: V<L>,
    /// Density in solid angle; 1 where there is but one direction.
    pub pdf: L::F,
    /// Whether there is but one direction, so that no scattered ray finds it.
    pub delta: L::M,
    /// The slot of the glowing surface that the direction leads to.
    pub target: L::U,
}

/// All lights of a scene that can be sampled.
pub struct Lights {
    lamps: Vec<Lamp>,
    /// Those that are surfaces, by slot.
    by_slot: Vec<(u32, u32)>,
    /// Those that are seen where a ray leaves the scene.
    beyond: Vec<u32>,
    choice: Choice,
    columns: Columns,
    space: Space,
}

/// One of them.
pub struct Lamp {
    source: Source,
    /// What a pattern or panorama multiplies, if there is one.
    radiance: [f32; 3],
    /// Luminance of the mean radiance.
    strength: f32,
    /// Whether the radiance of a surface is by place.
    patterned: bool,
    kind: Kind,
}

enum Kind {
    /// The radiance is an intensity.
    Point {
        position: [f32; 3],
    },
    /// The radiance is the intensity on the axis.
    Spot {
        position: [f32; 3],
        cone: Cone,
    },
    /// The radiance is that of the disc, or without a disc the irradiance.
    Sun {
        direction: [f32; 3],
        sine_squared: f32,
    },
    Sky,
    Panorama(Box<Sky>),
    Sphere {
        slot: u32,
        center: [f32; 3],
        radius: f32,
    },
    Surface(Box<GlowingSurface>),
}

/// A surface that is sampled by area, in double precision.
struct GlowingSurface {
    id: PrimitiveId,
    slot: u32,
    glowing: Glowing,
    /// Its area, the middle of its box, and half the diagonal squared, in the tracer's coordinates.
    area: f32,
    center: [f32; 3],
    extent_squared: f32,
}

/// Where a spot shines: the axis, and 1 − cosine of the angles where its light is whole and where it ends, which
/// stay exact for narrow cones.
struct Cone {
    direction: [f32; 3],
    inner: f32,
    outer: f32,
}

impl Cone {
    /// The share of the intensity on the axis that goes in a direction: see [`Light::Spot`].
    #[inline(always)]
    fn share<L: Lanes>(&self, l: L, w: V<L>) -> L::F {
        let height = (V::splat(l, self.direction) - w).squared() * 0.5;
        let x = ((l.f(self.outer) - height) / l.f(self.outer - self.inner)).greater(l.f(0.0));
        let edge = x * x * (l.f(3.0) - x * 2.0);
        height.le(l.f(self.inner)).pick(l.f(1.0), edge)
    }
}

/// No slot.
const NO_SLOT: u32 = u32::MAX;

impl Lights {
    /// Collects the lights of a scene, their radiance in multiples of a unit. Surfaces without end are left out:
    /// only scattered rays find them.
    pub fn new(scene: &Scene, surfaces: &Surfaces, space: &Space, unit: f64) -> Lights {
        let lights = (0..)
            .zip(&scene.lights)
            .filter_map(|(i, light)| Lamp::from_light(scene, Source::Light(i), light, space, unit));
        let glowing = (0..).map(PrimitiveId).zip(scene.primitives.iter()).filter_map(|(id, primitive)| {
            match scene.material(primitive) {
                Material::Emitter { radiance, pattern } => {
                    let paint = pattern.map_or(Paint::Plain(Rgb::ONE), Paint::Texture);
                    if (*radiance * scene.peak(paint)).max_element() <= 0.0 {
                        return None;
                    }
                    let mut lamp =
                        Lamp::from_surface(id, surfaces.slot(id), &primitive.shape, *radiance / unit, space)?;
                    lamp.strength = luminance(*radiance * scene.mean(paint) / unit) as f32;
                    lamp.patterned = pattern.is_some();
                    Some(lamp)
                }
                _ => None,
            }
        });
        let lamps: Vec<Lamp> = lights.chain(glowing).collect();
        let mut by_slot: Vec<(u32, u32)> = (0..)
            .zip(&lamps)
            .filter_map(|(index, lamp)| match lamp.source {
                Source::Primitive(id) => Some((surfaces.slot(id), index)),
                Source::Light(_) => None,
            })
            .collect();
        by_slot.sort_unstable();
        let is_beyond = |lamp: &Lamp| matches!(lamp.kind, Kind::Sky | Kind::Panorama(_) | Kind::Sun { .. });
        let beyond =
            lamps.iter().zip(0..).filter(|(lamp, _)| is_beyond(lamp)).map(|(_, index)| index).collect();
        let (choice, columns) = (Choice::new(&lamps), Columns::new(&lamps));
        Lights { lamps, by_slot, beyond, choice, columns, space: *space }
    }

    /// Whether there is nothing to sample.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.lamps.is_empty()
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.lamps.len()
    }

    /// What chains of mirrors and glass may lead to: lamps that have a place. A sky has none, and chance finds it well.
    pub fn goals(&self) -> Vec<Goal> {
        let goals = (0..).zip(&self.lamps).filter_map(|(index, lamp)| lamp.goal(index));
        goals.filter(|goal| goal.strength > 0.0 && goal.strength < f32::INFINITY).collect()
    }

    /// Whether there is more than one, or one of several parts.
    #[inline]
    pub fn needs_choice(&self) -> bool {
        self.lamps.len() > 1 || self.lamps.iter().any(|lamp| matches!(lamp.kind, Kind::Surface(_)))
    }

    /// One of the lights.
    #[inline]
    pub fn lamp(&self, index: u32) -> &Lamp {
        &self.lamps[index as usize]
    }

    /// The light that the surface in a slot is.
    #[inline]
    pub fn of_slot(&self, slot: u32) -> Option<u32> {
        self.by_slot.binary_search_by_key(&slot, |entry| entry.0).ok().map(|at| self.by_slot[at].1)
    }

    /// Those that are seen where a ray leaves the scene.
    #[inline]
    pub fn beyond(&self) -> &[u32] {
        &self.beyond
    }
}

impl Lamp {
    fn new(source: Source, radiance: Rgb, kind: Kind) -> Lamp {
        let radiance = radiance.min(Rgb::splat(f64::from(BRIGHTEST)));
        Lamp {
            source,
            radiance: single(radiance),
            strength: luminance(radiance) as f32,
            patterned: false,
            kind,
        }
    }

    fn from_light(scene: &Scene, source: Source, light: &Light, space: &Space, unit: f64) -> Option<Lamp> {
        let area = space.unit() * space.unit();
        let (radiance, kind) = match *light {
            Light::Point { position, intensity } => {
                (intensity / area, Kind::Point { position: single(space.point(position)) })
            }
            Light::Spot { position, direction, intensity, inner, outer } => {
                let [inner, outer] = [inner, outer].map(|angle| {
                    let sine = crate::math::sin(0.5 * angle);
                    (2.0 * sine * sine) as f32
                });
                let cone = Cone { direction: single(direction), inner, outer };
                (intensity / area, Kind::Spot { position: single(space.point(position)), cone })
            }
            Light::Sun { direction, irradiance, radius } => {
                let sine = crate::math::sin(radius);
                let disc = (sine * sine) as f32 > f32::MIN_POSITIVE;
                let radiance = if disc { irradiance / (PI * sine * sine) } else { irradiance };
                let sine_squared = if disc { (sine * sine) as f32 } else { 0.0 };
                (radiance, Kind::Sun { direction: single(direction), sine_squared })
            }
            Light::Sky { radiance, panorama: None } => (radiance, Kind::Sky),
            Light::Sky { radiance, panorama: Some(panorama) } => {
                (radiance, Kind::Panorama(Box::new(Sky::new(scene, &panorama))))
            }
        };
        let (mean, peak) = match &kind {
            Kind::Panorama(sky) => (sky.mean(), sky.peak()),
            _ => (Rgb::ONE, 1.0),
        };
        let mut lamp = Lamp::new(source, radiance / unit, kind);
        lamp.strength = luminance(radiance / unit * mean) as f32;
        (radiance.max_element() * peak > 0.0).then_some(lamp)
    }

    fn from_surface(id: PrimitiveId, slot: u32, shape: &Shape, radiance: Rgb, space: &Space) -> Option<Lamp> {
        let kind = match shape {
            Shape::Sphere { center, radius } => Kind::Sphere {
                slot,
                center: single(space.point(*center)),
                radius: space.length(*radius) as f32,
            },
            shape => {
                let glowing = Glowing::new(shape)?;
                let (area, center, extent_squared) = glowing.size();
                let unit_area = space.unit() * space.unit();
                Kind::Surface(Box::new(GlowingSurface {
                    id,
                    slot,
                    glowing,
                    area: (area / unit_area) as f32,
                    center: single(space.point(center)),
                    extent_squared: (extent_squared / unit_area) as f32,
                }))
            }
        };
        Some(Lamp::new(Source::Primitive(id), radiance, kind))
    }

    /// What it is.
    pub fn source(&self) -> Source {
        self.source
    }

    /// What chains of mirrors and glass may lead to, if it has a place.
    fn goal(&self, index: u32) -> Option<Goal> {
        let strength = self.strength;
        let radiance = Some(strength);
        let (target, strength) = match &self.kind {
            Kind::Point { position } | Kind::Spot { position, .. } => {
                (Target::Near { center: *position, radius: 0.0 }, 4.0 * PI as f32 * strength)
            }
            Kind::Sun { direction, sine_squared } => {
                let solid_angle = if *sine_squared > 0.0 { PI as f32 * sine_squared } else { 1.0 };
                let sine = sine_squared.sqrt();
                (Target::Far { direction: *direction, sine }, strength * solid_angle)
            }
            Kind::Sphere { center, radius, .. } => {
                let area = 4.0 * PI as f32 * radius * radius;
                (Target::Near { center: *center, radius: *radius }, PI as f32 * strength * area)
            }
            Kind::Surface(surface) => {
                let radius = surface.extent_squared.sqrt();
                (Target::Near { center: surface.center, radius }, PI as f32 * strength * surface.area)
            }
            Kind::Sky | Kind::Panorama(_) => return None,
        };
        let radiance = radiance.filter(|_| !target.is_point());
        Some(Goal { source: self.source, lamp: index, target, strength, radiance })
    }

    /// What a ray in a direction from beyond all surfaces sees of a lamp that is no surface: radiance; of a point that lies
    /// ahead its intensity, of a distant one without a disc its irradiance.
    pub fn along(&self, d: V<One>) -> Option<[f32; 3]> {
        let share = match &self.kind {
            Kind::Spot { cone, .. } => cone.share(One, -d),
            Kind::Sun { direction, sine_squared } => {
                let off = V::<One>::splat(One, *direction).cross(d).squared();
                f32::from(u8::from(*sine_squared == 0.0 || off <= *sine_squared))
            }
            _ => 1.0,
        };
        (share > 0.0).then(|| self.radiance.map(|v| v * share))
    }

    /// The radiance of what is seen in directions beyond the scene, in multiples of the unit, in the lanes of a mask.
    #[inline(always)]
    pub fn seen<L: Lanes>(&self, l: L, w: V<L>, wanted: L::M) -> V<L> {
        let mut radiance = V::splat(l, self.radiance);
        if let Kind::Panorama(sky) = &self.kind {
            for lane in wanted.lanes() {
                let [r, g, b] = self.radiance.map(f64::from);
                radiance.set(lane, single(Rgb::new(r, g, b) * sky.seen(double(w, lane))));
            }
        }
        radiance
    }
}

/// No light is brighter than this many units, so that products stay finite.
pub const BRIGHTEST: f32 = 1e12;
