//! Where light comes from, and how to draw a direction towards it.
//!
//! At every vertex one light is chosen with a probability that follows a cheap estimate of what it gives there.
//! Each `sample` stands beside the `pdf` with which a ray that was scattered towards the light would have been
//! drawn, so that the two ways can share the work (multiple importance sampling).

mod panorama;
mod surface;

use super::Tracer;
use super::caustic::goal::{Goal, Target};
use super::exact::SurfacePoint;
use super::lanes::{Float, Lanes, Mask, One, Word, apart};
use super::shape::{Face, Points, Rays, encode};
use super::space::{Space, double};
use super::surfaces::Surfaces;
use super::vector::{V, single, towards};
use super::warp;
use crate::color::{Rgb, luminance};
use crate::math::{DVec3, PI};
use crate::scene::{Light, Material, Paint, PrimitiveId, Scene, Shape};
use panorama::Sky;
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

/// What the uniform share in choosing a light is. It bounds the noise where the estimates are far off.
const UNIFORM: f32 = 0.1;
/// No estimate is greater, so that sums are finite even for a light in the very point.
const MOST_ESTIMATE: f32 = 1e30;
/// Lamps that are asked at most for what all of them may give.
const ASKED: usize = 256;
/// No slot.
const NO_SLOT: u32 = u32::MAX;

impl Lights {
    /// Collects the lights of a scene, their radiance in multiples of a unit. Surfaces without end are left out:
    /// only scattered rays find them.
    pub fn new(scene: &Scene, surfaces: &Surfaces, space: &Space, unit: f64) -> Lights {
        let lights = (0..)
            .zip(&scene.lights)
            .filter_map(|(i, light)| Lamp::from_light(scene, Source::Light(i), light, space, unit));
        let glowing = (0..).map(PrimitiveId).zip(&scene.primitives).filter_map(|(id, primitive)| match scene
            .material(primitive)
        {
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
        Lights { lamps, by_slot, beyond, space: *space }
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

    /// About the irradiance at a receiver, were nothing in between.
    pub fn irradiance(&self, receiver: &Receivers<One>) -> f32 {
        // Of many lamps some stand for all.
        let step = self.lamps.len().div_ceil(ASKED).max(1);
        let some: f32 = self.lamps.iter().step_by(step).map(|lamp| lamp.estimate(One, receiver)).sum();
        some * step as f32
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

    /// Sum of the estimates of what each light gives, for [`Lights::choose`] and [`Lights::chance`].
    #[inline(always)]
    pub fn total<L: Lanes>(&self, l: L, receivers: &Receivers<L>) -> L::F {
        let mut total = l.f(0.0);
        // Between one there is no choice, and nothing to estimate.
        if self.lamps.len() > 1 {
            for lamp in &self.lamps {
                total = total + lamp.estimate(l, receivers);
            }
        }
        total
    }

    /// Chooses lights, with their probability; the number is made uniform again for further use.
    #[inline(always)]
    pub fn choose<L: Lanes>(
        &self,
        l: L,
        receivers: &Receivers<L>,
        total: L::F,
        u: L::F,
    ) -> (L::U, L::F, L::F) {
        let mut sum = l.f(0.0);
        let mut index = l.u(0);
        let (mut probability, mut rest) = (l.f(1.0), u);
        let mut found = l.mask(0);
        for (at, lamp) in (0..).zip(&self.lamps) {
            let here = self.chance(l, lamp, receivers, total);
            let last = at as usize + 1 == self.lamps.len();
            let below = u.lt(sum + here);
            let takes = if last { !found } else { below & !found };
            index = takes.pick_word(l.u(at), index);
            probability = takes.pick(here, probability);
            rest = takes.pick((u - sum) / here, rest);
            found = found | takes;
            sum = sum + here;
        }
        (index, probability, rest.greater(l.f(0.0)).lesser(l.f(1.0 - f32::EPSILON)))
    }

    /// The probability with which a lamp is chosen.
    #[inline(always)]
    pub fn chance<L: Lanes>(&self, l: L, lamp: &Lamp, receivers: &Receivers<L>, total: L::F) -> L::F {
        let uniform = 1.0 / self.lamps.len() as f32;
        if self.lamps.len() == 1 {
            return l.f(1.0);
        }
        let share = lamp.estimate(l, receivers) / total * (1.0 - UNIFORM) + UNIFORM * uniform;
        l.f(0.0).lt(total).pick(share, l.f(uniform))
    }

    /// Draws directions towards the lights that were chosen.
    #[inline(always)]
    pub fn sample<L: Lanes>(
        &self,
        l: L,
        tracer: &Tracer,
        receivers: &Receivers<L>,
        chosen: (L::U, L::F),
        u: [L::F; 2],
        wanted: L::M,
    ) -> LightSamples<L> {
        apart(
            l,
            #[inline(always)]
            || self.sample_here(l, tracer, receivers, chosen, u, wanted),
        )
    }

    #[inline(always)]
    fn sample_here<L: Lanes>(
        &self,
        l: L,
        tracer: &Tracer,
        receivers: &Receivers<L>,
        (index, part): (L::U, L::F),
        u: [L::F; 2],
        wanted: L::M,
    ) -> LightSamples<L> {
        let mut samples = LightSamples {
            some: l.mask(0),
            wi: V::splat(l, [0.0, 0.0, 1.0]),
            distance: l.f(f32::INFINITY),
            radiance: V::all(l.f(0.0)),
            pdf: l.f(1.0),
            delta: l.mask(0),
            target: l.u(NO_SLOT),
        };
        for (at, lamp) in (0..).zip(&self.lamps) {
            let here = wanted & index.is(l.u(at));
            if here.any() {
                lamp.sample(l, tracer, receivers, part, u, here, &mut samples);
            }
        }
        samples
    }

    /// Density with which the direction of a ray that has met a glowing surface would have been drawn, the choice of
    /// the light included. One lane.
    pub fn pdf_of_surface(
        &self,
        slot: u32,
        face: Face,
        receivers: &Receivers<One>,
        total: f32,
        wi: V<One>,
        point: &Points<One>,
    ) -> f32 {
        let Some(index) = self.of_slot(slot) else { return 0.0 };
        let lamp = self.lamp(index);
        let density = match &lamp.kind {
            Kind::Sphere { center, radius, .. } => {
                let squared = (V::splat(One, *center) - receivers.p).squared();
                let sine_squared = radius * radius / squared;
                if sine_squared < 1.0 {
                    warp::cone_pdf(One, warp::cone_height(One, sine_squared))
                } else {
                    0.0
                }
            }
            Kind::Surface(surface) => {
                let from = self.space.world(receivers.p, 0);
                let point = SurfacePoint::new(self.space.world(point.p, 0), double(point.n, 0));
                surface.glowing.pdf(from, double(wi, 0), &point, face) as f32
            }
            Kind::Point { .. } | Kind::Spot { .. } | Kind::Sun { .. } | Kind::Sky | Kind::Panorama(_) => 0.0,
        };
        if density > 0.0 { density * self.chance(One, lamp, receivers, total) } else { 0.0 }
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

    /// About the irradiance at a receiver, were nothing in between. Only ratios matter, and they need not be
    /// right, but it is the same each time it is asked.
    #[inline(always)]
    fn estimate<L: Lanes>(&self, l: L, receivers: &Receivers<L>) -> L::F {
        let strength = l.f(self.strength);
        let estimate = match &self.kind {
            Kind::Point { position } => {
                let to = V::splat(l, *position) - receivers.p;
                let squared = to.squared().greater(l.f(f32::MIN_POSITIVE));
                let w = to * (l.f(1.0) / squared.root());
                strength / squared * cosine_bound(l, receivers, w, l.f(0.0))
            }
            Kind::Sun { direction, sine_squared } => {
                let solid_angle = if *sine_squared > 0.0 { PI as f32 * sine_squared } else { 1.0 };
                strength
                    * solid_angle
                    * cosine_bound(l, receivers, V::splat(l, *direction), l.f(*sine_squared))
            }
            Kind::Spot { position, cone } => {
                let to = V::splat(l, *position) - receivers.p;
                let squared = to.squared().greater(l.f(f32::MIN_POSITIVE));
                let w = to * (l.f(1.0) / squared.root());
                strength * cone.share(l, -w) / squared * cosine_bound(l, receivers, w, l.f(0.0))
            }
            Kind::Sky | Kind::Panorama(_) => strength * PI as f32,
            Kind::Sphere { center, radius, .. } => {
                let to = V::splat(l, *center) - receivers.p;
                let squared = to.squared();
                let sine_squared = l.f(radius * radius) / squared;
                let w = to * (l.f(1.0) / squared.root());
                let bound = cosine_bound(l, receivers, w, sine_squared);
                sine_squared.lt(l.f(1.0)).pick(strength * sine_squared * bound * PI as f32, l.f(0.0))
            }
            Kind::Surface(surface) => {
                let squared = (V::splat(l, surface.center) - receivers.p).squared();
                strength * surface.area / squared.greater(l.f(surface.extent_squared))
            }
        };
        estimate.lesser(l.f(MOST_ESTIMATE))
    }

    /// Draws directions towards it, where it can be seen from there.
    #[expect(clippy::too_many_arguments, reason = "it is told who asks, and adds to what others drew")]
    #[inline(always)]
    fn sample<L: Lanes>(
        &self,
        l: L,
        tracer: &Tracer,
        receivers: &Receivers<L>,
        part: L::F,
        u: [L::F; 2],
        here: L::M,
        samples: &mut LightSamples<L>,
    ) {
        let radiance = V::splat(l, self.radiance);
        match &self.kind {
            Kind::Point { position } => {
                let to = V::splat(l, *position) - receivers.p;
                let squared = to.squared();
                let distance = squared.root();
                let inverse = l.f(1.0) / distance;
                let some = here & l.f(0.0).lt(squared);
                samples.add(some, to * inverse, distance, radiance * (inverse * inverse), l.f(1.0));
                samples.delta = samples.delta | some;
            }
            Kind::Sun { direction, sine_squared } => {
                let direction = V::splat(l, *direction);
                let far = l.f(f32::INFINITY);
                if *sine_squared == 0.0 {
                    samples.add(here, direction, far, radiance, l.f(1.0));
                    samples.delta = samples.delta | here;
                } else {
                    let height = warp::cone_height(l, l.f(*sine_squared));
                    let wi = towards(l, direction, warp::cone(l, u, height));
                    samples.add(here, wi, far, radiance, warp::cone_pdf(l, height));
                }
            }
            Kind::Spot { position, cone } => {
                let to = V::splat(l, *position) - receivers.p;
                let squared = to.squared();
                let distance = squared.root();
                let wi = to * (l.f(1.0) / distance);
                let share = cone.share(l, -wi);
                let some = here & l.f(0.0).lt(squared) & l.f(0.0).lt(share);
                samples.add(some, wi, distance, radiance * (share / squared), l.f(1.0));
                samples.delta = samples.delta | some;
            }
            Kind::Panorama(sky) => {
                for lane in here.lanes() {
                    let (wi, pdf) = sky.sample([u[0].get(lane), u[1].get(lane)].map(f64::from));
                    let color = radiance.times(V::splat(l, single(sky.seen(wi))));
                    let some = if pdf > 0.0 { l.mask(1 << lane) } else { l.mask(0) };
                    samples.add(some, V::splat(l, single(wi)), l.f(f32::INFINITY), color, l.f(pdf as f32));
                }
            }
            Kind::Sky => {
                let local = warp::cosine(l, u);
                let facing = towards(l, receivers.n, local);
                let wi = V::pick(receivers.open, warp::sphere(l, u), facing);
                let pdf = receivers.open.pick(l.f(warp::SPHERE_PDF), warp::cosine_pdf(l, local.z));
                samples.add(here, wi, l.f(f32::INFINITY), radiance, pdf);
            }
            Kind::Sphere { slot, center, radius } => {
                let to = V::splat(l, *center) - receivers.p;
                let squared = to.squared();
                let d = squared.root();
                let inverse = l.f(1.0) / d;
                let sine_squared = l.f(radius * radius) / squared;
                let height = warp::cone_height(l, sine_squared);
                let local = warp::cone(l, u, height);
                let wi = towards(l, to * inverse, local);
                let off = squared * (local.x * local.x + local.y * local.y);
                let half_chord = (l.f(radius * radius) - off).greater(l.f(0.0)).root();
                let distance = (d - *radius) * (d + *radius) / (d * local.z + half_chord);
                let some = here & sine_squared.lt(l.f(1.0));
                samples.add(some, wi, distance, radiance, warp::cone_pdf(l, height));
                samples.target = some.pick_word(l.u(*slot), samples.target);
            }
            Kind::Surface(surface) => {
                for lane in here.lanes() {
                    let u = [u[0].get(lane), u[1].get(lane)].map(f64::from);
                    let from = tracer.space.world(receivers.p, lane);
                    let sample = surface.sample(tracer, self.patterned, from, part.get(lane), u);
                    let Some((wi, distance, pdf, share)) = sample else { continue };
                    let radiance = radiance.times(V::splat(l, share));
                    samples.add(l.mask(1 << lane), V::splat(l, wi), l.f(distance), radiance, l.f(pdf));
                    samples.target.set(lane, surface.slot);
                }
            }
        }
        if self.patterned
            && let (Kind::Sphere { slot, .. }, Source::Primitive(id)) = (&self.kind, self.source)
        {
            for lane in (here & samples.target.is(l.u(*slot))).lanes() {
                let p = receivers.p + samples.wi * samples.distance;
                let share =
                    tracer.pattern(id, Face::Side, &tracer.sphere_point(id, tracer.space.world(p, lane)));
                samples.radiance.set(lane, radiance.times(V::splat(l, share)).get(lane));
            }
        }
    }

    /// Of a sky or a sun: whether it is seen in a direction, and the density with which that would have been drawn.
    #[inline(always)]
    pub fn beyond<L: Lanes>(&self, l: L, receivers: &Receivers<L>, w: V<L>, wanted: L::M) -> (L::M, L::F) {
        match &self.kind {
            Kind::Sky => {
                let facing = warp::cosine_pdf(l, receivers.n.dot(w));
                (l.mask(u32::MAX), receivers.open.pick(l.f(warp::SPHERE_PDF), facing))
            }
            Kind::Panorama(sky) => {
                let mut pdf = l.f(0.0);
                for lane in wanted.lanes() {
                    pdf.set(lane, sky.pdf(double(w, lane)) as f32);
                }
                (l.mask(u32::MAX), pdf)
            }
            // By the sine, which is exact for a small disc.
            Kind::Sun { direction, sine_squared } => {
                let direction = V::splat(l, *direction);
                let off = direction.cross(w).squared();
                let seen = l.f(0.0).lt(direction.dot(w))
                    & off.le(l.f(*sine_squared))
                    & l.f(0.0).lt(l.f(*sine_squared));
                (seen, warp::cone_pdf(l, warp::cone_height(l, l.f(*sine_squared))))
            }
            Kind::Point { .. } | Kind::Spot { .. } | Kind::Sphere { .. } | Kind::Surface(_) => {
                (l.mask(0), l.f(0.0))
            }
        }
    }
}

impl GlowingSurface {
    /// A direction to one of its points as direction, distance, density, and what the pattern shows there.
    fn sample(
        &self,
        tracer: &Tracer,
        patterned: bool,
        from: DVec3,
        part: f32,
        u: [f64; 2],
    ) -> Option<([f32; 3], f32, f32, [f32; 3])> {
        let sample = self.glowing.sample(from, f64::from(part), u)?;
        let space = &tracer.space;
        let distance = space.length(sample.distance) as f32;
        // Whether the surface hides the point is asked from there, where its equation is exact.
        let (start, detail) = encode(self.slot, sample.face);
        let back = Rays::<One> {
            o: V::splat(One, single(space.point(sample.point.p))),
            d: V::splat(One, single(-sample.wi)),
            start: One.u(start),
            detail: One.u(detail),
        };
        if sample.hides_itself && tracer.surfaces.meets_itself(&back, self.slot, distance) {
            return None;
        }
        let share = if patterned { tracer.pattern(self.id, sample.face, &sample.point) } else { [1.0; 3] };
        Some((single(sample.wi), distance, sample.pdf as f32, share))
    }
}

/// No light is brighter than this many units, so that products stay finite.
pub const BRIGHTEST: f32 = 1e12;

impl<L: Lanes> LightSamples<L> {
    #[inline(always)]
    fn add(&mut self, some: L::M, wi: V<L>, distance: L::F, radiance: V<L>, pdf: L::F) {
        self.some = self.some | some;
        self.wi = V::pick(some, wi, self.wi);
        self.distance = some.pick(distance, self.distance);
        self.radiance = V::pick(some, radiance, self.radiance);
        self.pdf = some.pick(pdf, self.pdf);
    }
}

/// The greatest cosine to the normal of any direction in the cone about `w` of this half angle; 1 without normal.
#[inline(always)]
fn cosine_bound<L: Lanes>(l: L, receivers: &Receivers<L>, w: V<L>, sine_squared: L::F) -> L::F {
    let one = l.f(1.0);
    let zero = l.f(0.0);
    let c = receivers.n.dot(w);
    let cosine = (one - sine_squared).greater(zero).root();
    let outside = (c * cosine + (one - c * c).greater(zero).root() * sine_squared.root()).greater(zero);
    (receivers.open | cosine.le(c)).pick(one, outside)
}
