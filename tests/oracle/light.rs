//! Where light comes from, and how to draw a direction towards it.
//!
//! At every vertex one light is chosen with a probability that follows a cheap estimate of what it gives there.
//! Each `sample` stands beside the `pdf` with which a ray that was scattered towards the light would have been
//! drawn, so that the two ways can share the work (multiple importance sampling).

mod panorama;
mod surface;

use super::shape::{Face, Place, SurfacePoint};
use super::warp;
use panorama::Sky;
use rt_lang::color::{Rgb, luminance};
use rt_lang::math::{DVec3, PI, basis};
use rt_lang::scene::{Light, Material, Paint, PrimitiveId, Scene, Shape};
use std::collections::BTreeMap;
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
#[derive(Clone, Copy, Debug)]
pub struct Receiver {
    /// The point.
    pub p: DVec3,
    /// Unit normal on the side from which light may come; none where it may come from all sides.
    pub n: Option<DVec3>,
}

/// A direction towards a light.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// Towards the light.
    pub wi: DVec3,
    /// How far away it is, maybe infinitely.
    pub distance: f64,
    /// Radiance from there if nothing is in between; of a point or a distant one its irradiance on a surface
    /// that faces it. Of a glowing surface with a pattern it is what the pattern multiplies.
    pub radiance: Rgb,
    /// Density in solid angle; 1 where there is but one direction.
    pub pdf: f64,
    /// Whether there is but one direction, so that no scattered ray finds it.
    pub delta: bool,
    /// The point on a glowing surface that the direction leads to.
    pub target: Option<Target>,
}

/// A point on a glowing surface.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    /// Where, with its normal.
    pub point: SurfacePoint,
    /// On which surface.
    pub place: Place,
    /// Whether the surface may hide its own points.
    pub hides_itself: bool,
}

/// All lights of a scene that can be sampled.
pub struct Lights {
    lamps: Vec<Lamp>,
    by_source: BTreeMap<Source, u32>,
    /// Those that are seen where a ray leaves the scene.
    beyond: Vec<u32>,
}

/// One of them.
pub struct Lamp {
    source: Source,
    /// What a pattern or panorama multiplies, if there is one.
    radiance: Rgb,
    /// Luminance of the mean radiance.
    strength: f64,
    /// The greatest channel of the radiance.
    peak: f64,
    kind: Kind,
}

enum Kind {
    /// The radiance is an intensity.
    Point {
        position: DVec3,
    },
    /// The radiance is the intensity on the axis.
    Spot {
        position: DVec3,
        cone: Cone,
    },
    /// The radiance is that of the disc, or without a disc the irradiance.
    Sun {
        direction: DVec3,
        sine: f64,
    },
    Sky,
    Panorama(Box<Sky>),
    Sphere {
        id: PrimitiveId,
        center: DVec3,
        radius: f64,
    },
    Surface(Box<Glowing>),
}

/// Where a spot shines: the axis, and 1 − cosine of the angles where its light is whole and where it ends, which
/// stay exact for narrow cones.
struct Cone {
    direction: DVec3,
    inner: f64,
    outer: f64,
}

impl Cone {
    /// The share of the intensity on the axis that goes in a direction: see [`Light::Spot`].
    fn share(&self, w: DVec3) -> f64 {
        let height = 0.5 * self.direction.distance_squared(w);
        if height <= self.inner {
            return 1.0;
        }
        let x = ((self.outer - height) / (self.outer - self.inner)).max(0.0);
        x * x * (3.0 - 2.0 * x)
    }
}

/// What the uniform share in choosing a light is. It bounds the noise where the estimates are far off.
const UNIFORM: f64 = 0.1;

impl Lights {
    /// Collects the lights of a scene. Surfaces without end are left out: only scattered rays find them.
    pub fn new(scene: &Scene) -> Lights {
        let lights =
            (0..).zip(&scene.lights).map(|(i, light)| Lamp::from_light(scene, Source::Light(i), light));
        let glowing = (0..).map(PrimitiveId).zip(scene.primitives.iter()).filter_map(|(id, primitive)| {
            match scene.material(primitive) {
                Material::Emitter { radiance, pattern } => {
                    let pattern = pattern.map_or(Paint::Plain(Rgb::ONE), Paint::Texture);
                    let mean = *radiance * scene.mean(pattern);
                    let peak = *radiance * scene.peak(pattern);
                    Lamp::from_surface(id, &primitive.shape, *radiance, mean, peak)
                }
                _ => None,
            }
        });
        let lamps: Vec<Lamp> = lights.chain(glowing).filter(|lamp| lamp.peak > 0.0).collect();
        let by_source = lamps.iter().zip(0..).map(|(lamp, index)| (lamp.source, index)).collect();
        let is_beyond = |lamp: &Lamp| matches!(lamp.kind, Kind::Sky | Kind::Panorama(_) | Kind::Sun { .. });
        let beyond =
            lamps.iter().zip(0..).filter(|(lamp, _)| is_beyond(lamp)).map(|(_, index)| index).collect();
        Lights { lamps, by_source, beyond }
    }

    /// Whether there is nothing to sample.
    pub fn is_empty(&self) -> bool {
        self.lamps.is_empty()
    }

    /// Sum of the estimates of what each light gives, for [`Lights::choose`] and [`Lights::pdf`].
    pub fn total(&self, receiver: &Receiver) -> f64 {
        // Between one there is no choice, and nothing to estimate.
        if self.lamps.len() == 1 {
            return 0.0;
        }
        self.lamps.iter().map(|lamp| lamp.estimate(receiver)).sum()
    }

    /// Chooses a light, with its probability; the number is made uniform again for further use.
    pub fn choose(&self, receiver: &Receiver, total: f64, u: f64) -> (&Lamp, f64, f64) {
        let mut sum = 0.0;
        let last = self.lamps.len() - 1;
        for (i, lamp) in self.lamps.iter().enumerate() {
            let probability = self.chance(lamp, receiver, total);
            if u < sum + probability || i == last {
                let rest = ((u - sum) / probability).clamp(0.0, 1.0 - f64::EPSILON);
                return (lamp, probability, rest);
            }
            sum += probability;
        }
        unreachable!("the last light is always taken")
    }

    /// Density with which a direction towards a source is drawn at a receiver, the choice of the light included.
    /// `point` is what a ray in that direction meets.
    pub fn pdf(
        &self,
        source: Source,
        receiver: &Receiver,
        total: f64,
        wi: DVec3,
        point: Option<(&SurfacePoint, Face)>,
    ) -> f64 {
        let Some(&index) = self.by_source.get(&source) else { return 0.0 };
        let lamp = &self.lamps[index as usize];
        let density = lamp.pdf(receiver, wi, point);
        if density > 0.0 { density * self.chance(lamp, receiver, total) } else { 0.0 }
    }

    /// The sky and the suns: what is seen beyond the scene in a direction, each with its source.
    pub fn beyond(&self, direction: DVec3) -> impl Iterator<Item = (Source, Rgb)> + '_ {
        self.beyond
            .iter()
            .map(|&index| &self.lamps[index as usize])
            .filter(move |lamp| lamp.is_seen_beyond(direction))
            .map(move |lamp| (lamp.source, lamp.beyond(direction)))
    }

    /// The greatest channel of any light's radiance; of a point its intensity.
    pub fn peak(&self) -> f64 {
        self.lamps.iter().map(|lamp| lamp.peak).fold(0.0, f64::max)
    }

    fn chance(&self, lamp: &Lamp, receiver: &Receiver, total: f64) -> f64 {
        let uniform = 1.0 / self.lamps.len() as f64;
        if total > 0.0 {
            UNIFORM * uniform + (1.0 - UNIFORM) * lamp.estimate(receiver) / total
        } else {
            uniform
        }
    }
}

impl Lamp {
    fn from_light(scene: &Scene, source: Source, light: &Light) -> Lamp {
        let (radiance, kind) = match *light {
            Light::Point { position, intensity } => (intensity, Kind::Point { position }),
            Light::Spot { position, direction, intensity, inner, outer } => {
                let [inner, outer] = [inner, outer].map(|angle| {
                    let sine = rt_lang::math::sin(0.5 * angle);
                    2.0 * sine * sine
                });
                (intensity, Kind::Spot { position, cone: Cone { direction, inner, outer } })
            }
            Light::Sun { direction, irradiance, radius } => {
                let sine = rt_lang::math::sin(radius);
                let radiance = if sine > 0.0 { irradiance / (PI * sine * sine) } else { irradiance };
                (radiance, Kind::Sun { direction, sine })
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
        let (strength, peak) = (luminance(radiance * mean), radiance.max_element() * peak);
        Lamp { source, radiance, strength, peak, kind }
    }

    fn from_surface(id: PrimitiveId, shape: &Shape, radiance: Rgb, mean: Rgb, peak: Rgb) -> Option<Lamp> {
        let kind = match shape {
            Shape::Sphere { center, radius } => Kind::Sphere { id, center: *center, radius: *radius },
            shape => Kind::Surface(Box::new(Glowing::new(id, shape)?)),
        };
        let (source, strength, peak) = (Source::Primitive(id), luminance(mean), peak.max_element());
        Some(Lamp { source, radiance, strength, peak, kind })
    }

    /// What it is.
    pub fn source(&self) -> Source {
        self.source
    }

    /// About the irradiance at a receiver, were nothing in between. Only ratios matter, and they need not be
    /// right, but it is the same each time it is asked.
    fn estimate(&self, receiver: &Receiver) -> f64 {
        let strength = self.strength;
        let estimate = match &self.kind {
            Kind::Point { position } => {
                let to = *position - receiver.p;
                let squared = to.length_squared().max(f64::MIN_POSITIVE);
                strength / squared * cosine_bound(receiver, to / squared.sqrt(), 0.0)
            }
            Kind::Spot { position, cone } => {
                let to = *position - receiver.p;
                let squared = to.length_squared().max(f64::MIN_POSITIVE);
                let wi = to / squared.sqrt();
                strength * cone.share(-wi) / squared * cosine_bound(receiver, wi, 0.0)
            }
            Kind::Sun { direction, sine } => {
                let solid_angle = if *sine > 0.0 { PI * sine * sine } else { 1.0 };
                strength * solid_angle * cosine_bound(receiver, *direction, *sine)
            }
            Kind::Sky | Kind::Panorama(_) => strength * PI,
            Kind::Sphere { center, radius, .. } => {
                let to = *center - receiver.p;
                let squared = to.length_squared();
                let sine_squared = radius * radius / squared;
                if sine_squared >= 1.0 {
                    return 0.0;
                }
                let bound = cosine_bound(receiver, to / squared.sqrt(), sine_squared.sqrt());
                strength * PI * sine_squared * bound
            }
            Kind::Surface(glowing) => strength * glowing.estimate(receiver.p),
        };
        // Finite even for a light in the very point.
        estimate.min(1e200)
    }

    /// Draws a direction towards it, none if it cannot be seen from there.
    pub fn sample(&self, receiver: &Receiver, part: f64, u: [f64; 2]) -> Option<LightSample> {
        let delta = |wi: DVec3, distance: f64, radiance: Rgb| LightSample {
            wi,
            distance,
            radiance,
            pdf: 1.0,
            delta: true,
            target: None,
        };
        let beyond = |wi: DVec3, pdf: f64| LightSample {
            wi,
            distance: f64::INFINITY,
            radiance: self.beyond(wi),
            pdf,
            delta: false,
            target: None,
        };
        match &self.kind {
            Kind::Point { position } => {
                let to = *position - receiver.p;
                let squared = to.length_squared();
                let distance = squared.sqrt();
                (squared > 0.0).then(|| delta(to / distance, distance, self.radiance / squared))
            }
            Kind::Spot { position, cone } => {
                let to = *position - receiver.p;
                let squared = to.length_squared();
                let distance = squared.sqrt();
                let wi = to / distance;
                let share = cone.share(-wi);
                (share > 0.0).then(|| delta(wi, distance, self.radiance * (share / squared)))
            }
            Kind::Sun { direction, sine } if *sine == 0.0 => {
                Some(delta(*direction, f64::INFINITY, self.radiance))
            }
            Kind::Sun { direction, sine } => {
                let height = cone_height(*sine);
                Some(beyond(towards(*direction, warp::cone(u, height)), warp::cone_pdf(height)))
            }
            Kind::Sky => Some(match receiver.n {
                Some(n) => {
                    let local = warp::cosine(u);
                    beyond(towards(n, local), warp::cosine_pdf(local.z))
                }
                None => beyond(warp::sphere(u), warp::SPHERE_PDF),
            }),
            Kind::Panorama(sky) => {
                let (wi, pdf) = sky.sample(u);
                (pdf > 0.0).then(|| beyond(wi, pdf))
            }
            Kind::Sphere { id, center, radius } => {
                let to = *center - receiver.p;
                let d = to.length();
                let sine = radius / d;
                if sine >= 1.0 {
                    return None;
                }
                let height = cone_height(sine);
                let local = warp::cone(u, height);
                let wi = towards(to / d, local);
                let sine_squared = local.x * local.x + local.y * local.y;
                let half_chord = (radius * radius - d * d * sine_squared).max(0.0).sqrt();
                let distance = (d - radius) * (d + radius) / (d * local.z + half_chord);
                let place = Place { primitive: *id, face: Face::Side };
                let p = receiver.p + distance * wi;
                let point = SurfacePoint::new(p, (p - *center) / *radius);
                let target = Target { point, place, hides_itself: false };
                Some(LightSample {
                    wi,
                    distance,
                    radiance: self.radiance,
                    pdf: warp::cone_pdf(height),
                    delta: false,
                    target: Some(target),
                })
            }
            Kind::Surface(glowing) => glowing.sample(receiver, part, u, self.radiance),
        }
    }

    /// Density of [`Lamp::sample`] in solid angle.
    fn pdf(&self, receiver: &Receiver, wi: DVec3, point: Option<(&SurfacePoint, Face)>) -> f64 {
        match &self.kind {
            Kind::Point { .. } | Kind::Spot { .. } => 0.0,
            Kind::Sun { sine, .. } if *sine == 0.0 => 0.0,
            Kind::Sun { sine, .. } => warp::cone_pdf(cone_height(*sine)),
            Kind::Panorama(sky) => sky.pdf(wi),
            Kind::Sky => receiver.n.map_or(warp::SPHERE_PDF, |n| warp::cosine_pdf(n.dot(wi))),
            Kind::Sphere { center, radius, .. } => {
                let sine = radius / center.distance(receiver.p);
                if sine < 1.0 { warp::cone_pdf(cone_height(sine)) } else { 0.0 }
            }
            Kind::Surface(glowing) => {
                point.map_or(0.0, |(point, face)| glowing.pdf(receiver.p, wi, point, face))
            }
        }
    }

    /// The radiance of what is seen in a direction beyond the scene.
    fn beyond(&self, w: DVec3) -> Rgb {
        match &self.kind {
            Kind::Panorama(sky) => self.radiance * sky.seen(w),
            _ => self.radiance,
        }
    }

    fn is_seen_beyond(&self, w: DVec3) -> bool {
        match &self.kind {
            Kind::Sky | Kind::Panorama(_) => true,
            // By the sine, which is exact for a small disc.
            Kind::Sun { direction, sine } => {
                *sine > 0.0 && direction.dot(w) > 0.0 && direction.cross(w).length_squared() <= sine * sine
            }
            _ => false,
        }
    }
}

/// 1 − cosine of the half angle of a cone by its sine, exact for narrow ones.
fn cone_height(sine: f64) -> f64 {
    let squared = sine * sine;
    squared / (1.0 + (1.0 - squared).max(0.0).sqrt())
}

/// The greatest cosine to the normal of any direction in the cone about `w` of this half angle; 1 without normal.
fn cosine_bound(receiver: &Receiver, w: DVec3, sine: f64) -> f64 {
    let Some(n) = receiver.n else { return 1.0 };
    let c = n.dot(w);
    let cosine = (1.0 - sine * sine).max(0.0).sqrt();
    if c >= cosine { 1.0 } else { (c * cosine + (1.0 - c * c).max(0.0).sqrt() * sine).max(0.0) }
}

/// A direction of the local frame about the unit vector `z`, in the world.
fn towards(z: DVec3, local: DVec3) -> DVec3 {
    let (x, y) = basis(z);
    local.x * x + local.y * y + local.z * z
}
