//! Path tracing: the radiance that arrives along a camera ray.
//!
//! At every vertex light is gathered from one light directly, and the path goes on in one scattered direction.
//! Light that a scattered ray happens upon is shared between the two ways by the power heuristic (Eric Veach,
//! *Robust Monte Carlo Methods for Light Transport Simulation*, 1997, §9.2).
//!
//! This is the readable form, one path at a time. What it computes is the contract for any faster one.

use super::Tracer;
use super::bsdf::{Bsdf, Sample};
use super::light::{LightSample, Receiver, Source};
use super::media::{Boundary, Inside};
use super::observer::{Contribution, Observer, Vertex};
use super::sampler::{Pair, Sampler};
use super::shape::{Place, Ray, SurfacePoint, surface_point};
use crate::color::Rgb;
use crate::math::{DVec3, basis};
use crate::scene::{Background, Material};

/// Vertices before roulette may end a path. It was measured to cost more than it saves at depth 8.
const FIRST_ROULETTE: u32 = 16;

/// Boundaries that a straight line crosses before it is given up. Only surfaces that coincide but for rounding
/// could ever hold one that long.
const MOST_PASSES: u32 = 10_000;

/// A ray that meets a surface along it comes from above by this cosine at least, so that what is divided by the
/// cosine and its square stays finite.
pub(super) const LEAST_COSINE: f64 = 1e-9;

/// No light is brighter than this, so that products stay finite.
const BRIGHTEST: f64 = 1e100;

/// A path, from the camera to where it has got.
struct Path<'o, O> {
    ray: Ray,
    /// What a unit of radiance along the ray adds to the camera's.
    throughput: Rgb,
    /// How much of the throughput is due to refraction alone; roulette must not mistake it for darkness.
    thinning: f64,
    bounces: u32,
    rough_bounces: u32,
    /// The vertex that the ray was scattered at, if a light might have been sampled there in its place.
    last: Option<Last>,
    radiance: Rgb,
    observer: &'o mut O,
}

/// What the other way to find a light needs to know.
#[derive(Clone, Copy)]
struct Last {
    receiver: Receiver,
    total: f64,
    /// Density of the scattered direction.
    pdf: f64,
}

/// What a camera path brings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Arrived {
    /// Radiance along the camera ray.
    pub radiance: Rgb,
    /// Whether the ray met nothing in front of a transparent background.
    pub open: bool,
}

/// What arrives along a camera ray. `inside` is scratch space.
pub(super) fn trace<O: Observer>(
    tracer: &Tracer,
    ray: Ray,
    sampler: &Sampler,
    inside: &mut Scratch,
    observer: &mut O,
) -> Arrived {
    let Scratch { path: inside, shadow } = inside;
    let trace = &tracer.scene.trace;
    tracer.dielectrics.enter_at(&tracer.accel, &ray, inside);
    let mut path = Path {
        ray,
        throughput: Rgb::ONE,
        thinning: 1.0,
        bounces: 0,
        rough_bounces: 0,
        last: None,
        radiance: Rgb::ZERO,
        observer,
    };
    let mut passes = 0;
    loop {
        // Find what the ray meets, dimmed by what it travels through.
        let hit = tracer.accel.closest(&path.ray);
        path.throughput *= tracer.dielectrics.transmission(inside, hit.map_or(f64::INFINITY, |hit| hit.t));

        // Account for the sky and the suns if the ray leaves the scene.
        let Some(hit) = hit else {
            // What dims or bends the ray on its way is seen, and so is the background through it.
            if trace.background == Background::Transparent && path.bounces == 0 && path.throughput == Rgb::ONE
            {
                return Arrived { radiance: Rgb::ZERO, open: true };
            }
            for (source, radiance) in tracer.lights.beyond(path.ray.direction) {
                path.find(tracer, source, radiance, None);
            }
            break;
        };
        let primitive = &tracer.scene.primitives[hit.place.primitive.0 as usize];
        let point = surface_point(&primitive.shape, &path.ray, hit.t, hit.place.face);
        let entering = point.n.dot(path.ray.direction) < 0.0;

        // Account for what the surface gives by itself.
        let material = tracer.scene.material(primitive);
        if let Some(radiance) = tracer.glow(hit.place, &point) {
            if entering || !primitive.shape.is_closed() {
                let source = Source::Primitive(hit.place.primitive);
                path.find(tracer, source, radiance, Some((&point, hit.place)));
            }
            break;
        }

        // Go straight through a boundary that parts nothing.
        let Some(bsdf) = tracer.bsdf(material, hit.place, &point, inside, entering) else {
            tracer.dielectrics.cross(inside, hit.place.primitive, entering);
            path.ray = Ray { origin: point.p, start: Some(hit.place), ..path.ray };
            passes += 1;
            if passes > MOST_PASSES {
                break;
            }
            continue;
        };

        // End at the limits that the scene sets.
        if path.bounces == trace.bounces {
            path.observer.cut(hit.place, path.throughput);
            break;
        }
        if !trace.indirect && path.rough_bounces > 0 {
            break;
        }

        // Gather light directly from one of the lights.
        let vertex = LocalVertex::new(&point, hit.place, entering, path.ray.direction);
        path.last = None;
        if !bsdf.is_specular() && !tracer.lights.is_empty() {
            let receiver = Receiver { p: point.p, n: (!bsdf.transmits()).then_some(vertex.z) };
            let total = tracer.lights.total(&receiver);
            path.gather(tracer, &bsdf, &vertex, &receiver, total, sampler, inside, shadow);
            path.last = Some(Last { receiver, total, pdf: 0.0 });
        }

        // Scatter.
        let [lobe, roulette] = sampler.pair(Pair::Lobe(path.bounces));
        let Some(sample) = bsdf.sample(vertex.wo, lobe, sampler.pair(Pair::Direction(path.bounces))) else {
            break;
        };
        if !vertex.agrees(sample.wi, vertex.world(sample.wi)) {
            break;
        }
        path.scatter(&vertex, &sample, &point);
        if path.throughput == Rgb::ZERO {
            break;
        }
        if sample.wi.z < 0.0 {
            tracer.dielectrics.cross(inside, hit.place.primitive, entering);
            if let Bsdf::Dielectric { eta, .. } = bsdf {
                path.thinning /= eta * eta;
            }
        }

        // Let roulette end a path that carries little.
        if path.bounces >= FIRST_ROULETTE {
            let survival = (path.throughput.max_element() / path.thinning).min(1.0);
            if roulette >= survival {
                break;
            }
            path.throughput /= survival;
        }
    }
    Arrived { radiance: path.radiance, open: false }
}

/// Memory that paths use one after the other.
#[derive(Default)]
pub(super) struct Scratch {
    path: Inside,
    shadow: Inside,
}

/// A vertex with its local frame.
///
/// Scattering is that of the shading normal, and which side a direction is on is told by the surface's own: what the
/// two disagree about is black, so that no light leaks through a smooth mesh (Veach 1997, §5.3.2).
struct LocalVertex {
    place: Place,
    p: DVec3,
    x: DVec3,
    y: DVec3,
    /// The normal to shade with, on the side that the path comes from.
    z: DVec3,
    /// The normal of the surface itself, on that side; none where it is the same.
    rim: Option<DVec3>,
    wo: DVec3,
    /// Whether the path comes from outside.
    entering: bool,
}

impl LocalVertex {
    fn new(point: &SurfacePoint, place: Place, entering: bool, direction: DVec3) -> LocalVertex {
        let [n, shading] = [point.n, point.shading].map(|n| if entering { n } else { -n });
        let rim = (shading != n).then_some(n);
        let z = if rim.is_some() { raised(shading, n, -direction) } else { n };
        let (x, y) = basis(z);
        let mut vertex = LocalVertex { place, p: point.p, x, y, z, rim, wo: DVec3::ZERO, entering };
        vertex.wo = vertex.local(-direction);
        vertex.wo.z = vertex.wo.z.max(LEAST_COSINE);
        vertex
    }

    fn local(&self, w: DVec3) -> DVec3 {
        DVec3::new(w.dot(self.x), w.dot(self.y), w.dot(self.z))
    }

    fn world(&self, w: DVec3) -> DVec3 {
        w.x * self.x + w.y * self.y + w.z * self.z
    }

    /// Whether a direction of the world is on the side of the surface that it is on of the shading normal.
    fn agrees(&self, local: DVec3, w: DVec3) -> bool {
        self.rim.is_none_or(|n| (local.z > 0.0) == (n.dot(w) > 0.0))
    }

    fn ray(&self, direction: DVec3) -> Ray {
        Ray { origin: self.p, direction, start: Some(self.place) }
    }
}

/// A shading normal, turned just so far towards the surface's own that the mirror image of `wo` is above the surface
/// (Keller et al., "The Iray light transport simulation and rendering system", 2017, appendix A.3).
fn raised(shading: DVec3, n: DVec3, wo: DVec3) -> DVec3 {
    /// The least cosine of the mirror image to the surface's normal.
    const LEAST: f64 = 1e-4;
    let mirrored = 2.0 * wo.dot(shading) * shading - wo;
    let height = mirrored.dot(n);
    if height >= LEAST && wo.dot(shading) > 0.0 {
        return shading;
    }
    let lifted = (mirrored + (LEAST - height).max(0.0) * n).normalize();
    let raised = (wo + lifted).normalize_or(n);
    if raised.dot(n) > 0.0 { raised } else { n }
}

impl<O: Observer> Path<'_, O> {
    /// Accounts for light that the ray has met, shared with the other way to find it.
    fn find(
        &mut self,
        tracer: &Tracer,
        source: Source,
        radiance: Rgb,
        point: Option<(&SurfacePoint, Place)>,
    ) {
        let share = match self.last {
            None => 1.0,
            Some(last) => {
                let point = point.map(|(point, place)| (point, place.face));
                let wi = self.ray.direction;
                let other = tracer.lights.pdf(source, &last.receiver, last.total, wi, point);
                tracer.sharing.found(last.pdf, other)
            }
        };
        let bounces = (self.bounces, self.rough_bounces);
        self.add(source, bounces, self.throughput * share * radiance.min(Rgb::splat(BRIGHTEST)));
    }

    /// Samples one light, and adds what it gives by way of the vertex.
    #[expect(clippy::too_many_arguments, reason = "all of them is what direct light depends on")]
    fn gather(
        &mut self,
        tracer: &Tracer,
        bsdf: &Bsdf,
        vertex: &LocalVertex,
        receiver: &Receiver,
        total: f64,
        sampler: &Sampler,
        inside: &Inside,
        shadow: &mut Inside,
    ) {
        let [choice, _] = sampler.pair(Pair::Choice(self.bounces));
        let (lamp, probability, part) = tracer.lights.choose(receiver, total, choice);
        let Some(light) = lamp.sample(receiver, part, sampler.pair(Pair::Light(self.bounces))) else {
            return;
        };
        let wi = vertex.local(light.wi);
        if !vertex.agrees(wi, light.wi) {
            return;
        }
        let scattering = bsdf.eval(vertex.wo, wi);
        if scattering == Rgb::ZERO {
            return;
        }
        let pdf = probability * light.pdf;
        let share = if light.delta { 1.0 } else { tracer.sharing.gathered(pdf, bsdf.pdf(vertex.wo, wi)) };
        if share == 0.0 {
            return;
        }
        shadow.clone_from(inside);
        if wi.z < 0.0 {
            tracer.dielectrics.cross(shadow, vertex.place.primitive, vertex.entering);
        }
        let visible = visibility(tracer, vertex, &light, shadow);
        if visible != Rgb::ZERO {
            let glow = light.target.and_then(|target| tracer.glow(target.place, &target.point));
            let radiance = glow.unwrap_or(light.radiance).min(Rgb::splat(BRIGHTEST));
            let bounces = (self.bounces + 1, self.rough_bounces + 1);
            self.add(
                lamp.source(),
                bounces,
                self.throughput * visible * scattering * radiance * (share / pdf),
            );
        }
    }

    fn add(&mut self, source: Source, (bounces, rough_bounces): (u32, u32), radiance: Rgb) {
        self.radiance += radiance;
        self.observer.contributed(&Contribution { source, bounces, rough_bounces, radiance });
    }

    /// Sends the path on in a sampled direction.
    fn scatter(&mut self, vertex: &LocalVertex, sample: &Sample, point: &SurfacePoint) {
        self.observer.scattered(&Vertex {
            bounce: self.bounces,
            place: vertex.place,
            p: vertex.p,
            n: point.n,
            throughput: self.throughput,
            specular: sample.specular,
        });
        self.throughput *= sample.weight;
        self.bounces += 1;
        if sample.specular {
            self.last = None;
        } else {
            self.rough_bounces += 1;
            self.last = self.last.map(|last| Last { pdf: sample.pdf, ..last });
        }
        self.ray = vertex.ray(vertex.world(sample.wi).normalize());
    }
}

/// The share of a light's radiance that reaches a vertex. Nothing passes a surface, but for boundaries that part
/// nothing, and the medium absorbs.
fn visibility(tracer: &Tracer, vertex: &LocalVertex, light: &LightSample, inside: &mut Inside) -> Rgb {
    let except = light.target.map(|target| target.place.primitive);
    // The glowing surface itself is asked from its own point, where its equation is exact.
    if let Some(target) = light.target.filter(|target| target.hides_itself) {
        let back = Ray { origin: target.point.p, direction: -light.wi, start: Some(target.place) };
        if tracer.meets(&back, light.distance) {
            return Rgb::ZERO;
        }
    }
    let mut ray = vertex.ray(light.wi);
    if !tracer.dielectrics.may_pass(inside) {
        return if tracer.accel.occluded(&ray, light.distance, except) { Rgb::ZERO } else { Rgb::ONE };
    }
    let mut rest = light.distance;
    let mut visible = Rgb::ONE;
    for _ in 0..MOST_PASSES {
        let hit = tracer.accel.closest_but(&ray, rest, except);
        visible *= tracer.dielectrics.transmission(inside, hit.map_or(rest, |hit| hit.t));
        let Some(hit) = hit else { return visible };
        let primitive = &tracer.scene.primitives[hit.place.primitive.0 as usize];
        let material = tracer.scene.material(primitive);
        let point = surface_point(&primitive.shape, &ray, hit.t, hit.place.face);
        let entering = point.n.dot(ray.direction) < 0.0;
        let id = hit.place.primitive;
        let passes = matches!(material, Material::Dielectric { .. })
            && tracer.dielectrics.boundary(inside, id, entering) == Boundary::Nothing;
        if !passes {
            return Rgb::ZERO;
        }
        tracer.dielectrics.cross(inside, id, entering);
        ray = Ray { origin: point.p, start: Some(hit.place), ..ray };
        rest -= hit.t;
    }
    Rgb::ZERO
}

/// Which of the two ways to find a light counts. Both, shared; the others are for tests that compare them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(not(test), expect(dead_code, reason = "tests compare the ways"))]
pub(super) enum Sharing {
    Both,
    OnlyGathered,
    OnlyFound,
}

impl Sharing {
    /// What counts of light that was found by chance, of density `found`, where a light could have been sampled
    /// with density `gathered`.
    fn found(self, found: f64, gathered: f64) -> f64 {
        match self {
            Sharing::Both => power_heuristic(found, gathered),
            Sharing::OnlyGathered if gathered > 0.0 => 0.0,
            Sharing::OnlyGathered | Sharing::OnlyFound => 1.0,
        }
    }

    /// What counts of light that was sampled.
    fn gathered(self, gathered: f64, found: f64) -> f64 {
        match self {
            Sharing::Both => power_heuristic(gathered, found),
            Sharing::OnlyGathered => 1.0,
            Sharing::OnlyFound => 0.0,
        }
    }
}

/// The share of a way to find light that has density `this`, beside one of density `other`.
fn power_heuristic(this: f64, other: f64) -> f64 {
    // By the ratio, which neither overflows nor underflows to 0/0.
    let ratio = other / this;
    1.0 / (1.0 + ratio * ratio)
}
