//! The tracer's parts, asked for one ray of the world at a time.

use super::*;
use crate::render::exact::SurfacePoint;
use crate::render::light::Receivers;
use crate::render::observer::Place;
use crate::render::sampler::{Pair, Sampler, seed_key};
use crate::render::shape::{NOWHERE, Rays, encode};
use crate::render::space::double;
use crate::render::vector::{V, single};

/// A half-line of the world.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    pub origin: DVec3,
    pub direction: DVec3,
    pub start: Option<Place>,
}

impl Ray {
    /// As the tracer sees it: near the origin it is then exactly the same ray.
    pub fn rounded(self) -> Ray {
        let round = |v: DVec3| v.as_vec3().as_dvec3();
        Ray { origin: round(self.origin), direction: round(self.direction), ..self }
    }
}

/// What it meets.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    pub t: f64,
    pub place: Place,
}

/// The surfaces of a scene.
pub struct Accel {
    surfaces: Surfaces,
    space: Space,
}

impl Accel {
    pub fn of(scene: &Scene) -> Accel {
        let scene: &'static Scene = Box::leak(Box::new(scene.clone()));
        let space = Space::new(scene.camera.position, 1.0);
        Accel { surfaces: Surfaces::new(scene, &space), space }
    }

    fn rays(&self, ray: &Ray) -> Rays<One> {
        let (start, detail) =
            ray.start.map_or((NOWHERE, 0), |start| encode(self.surfaces.slot(start.primitive), start.face));
        Rays {
            o: V::splat(One, single(self.space.point(ray.origin))),
            d: V::splat(One, single(ray.direction)),
            start: One.u(start),
            detail: One.u(detail),
        }
    }

    pub fn closest(&self, ray: &Ray) -> Option<Hit> {
        let none = One.u(u32::MAX);
        let hit = self.surfaces.closest(One, &self.rays(ray), f32::INFINITY, none, true);
        let place = hit.place.get(0);
        (place != NOWHERE).then(|| Hit {
            t: f64::from(hit.t),
            place: Place {
                primitive: self.surfaces.primitive(slot(place)),
                face: decode(place, hit.detail.get(0)),
            },
        })
    }

    pub fn contains(&self, id: PrimitiveId, p: DVec3) -> bool {
        self.surfaces.exact().contains(id, p)
    }

    pub fn occluded(&self, ray: &Ray, distance: f64) -> bool {
        self.surfaces.occluded(One, &self.rays(ray), distance as f32, One.u(u32::MAX), true)
    }

    pub fn point(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        let (place, detail) = encode(self.surfaces.slot(hit.place.primitive), hit.place.face);
        let hits = Hits { t: hit.t as f32, place: One.u(place), detail: One.u(detail) };
        let points = self.surfaces.points(One, &self.rays(ray), &hits, true);
        SurfacePoint::new(self.space.world(points.p, 0), double(points.n, 0))
    }
}

thread_local! {
    static LAST: std::cell::RefCell<Option<(Shape, std::rc::Rc<Accel>)>> = const { std::cell::RefCell::new(None) };
}

/// The surface of one shape, kept for the next time.
fn alone(shape: &Shape) -> std::rc::Rc<Accel> {
    LAST.with_borrow_mut(|last| {
        if let Some((known, accel)) = last
            && known == shape
        {
            return accel.clone();
        }
        let accel =
            std::rc::Rc::new(Accel::of(&scene(DVec3::ZERO, DVec3::Z).with(shape.clone(), glass(1.5))));
        *last = Some((shape.clone(), accel.clone()));
        accel
    })
}

pub fn intersect(shape: &Shape, ray: &Ray, start: Option<Face>) -> Option<(f64, Face)> {
    let start = start.map(|face| Place { primitive: PrimitiveId(0), face });
    alone(shape).closest(&Ray { start, ..*ray }).map(|hit| (hit.t, hit.place.face))
}

pub fn surface_point(shape: &Shape, ray: &Ray, t: f64, face: Face) -> SurfacePoint {
    alone(shape).point(ray, &Hit { t, place: Place { primitive: PrimitiveId(0), face } })
}

pub fn camera_rays(scene: &Scene, [x, y]: [u32; 2], count: u32) -> Vec<(Ray, f64)> {
    let space = Space::new(scene.camera.position, 1.0);
    let eye = Eye::new(scene, &space);
    let ray = |i| {
        let sampler = Sampler::new(One, seed_key(1), One.u(x), One.u(y), One.u(i));
        let ray = eye.rays(One, One.u(x), One.u(y), &sampler);
        let world = Ray { origin: space.world(ray.o, 0), direction: double(ray.d, 0), start: None };
        (world, f64::from(ray.weight))
    };
    (0..count).map(ray).collect()
}

pub fn pair(seed: u64, [x, y]: [u32; 2], sample: u32, pair: Pair, vertex: u32) -> [f64; 2] {
    let sampler = Sampler::new(One, seed_key(seed), One.u(x), One.u(y), One.u(sample));
    sampler.pair(One, pair, One.u(vertex)).map(f64::from)
}

pub fn cosine(u: [f64; 2]) -> DVec3 {
    double(warp::cosine(One, u.map(|u| u as f32)), 0)
}

pub fn cone(u: [f64; 2], height: f64) -> DVec3 {
    double(warp::cone(One, u.map(|u| u as f32), height as f32), 0)
}

pub fn fresnel(cosine: f64, eta: f64) -> f64 {
    f64::from(bsdf::fresnel::dielectric(One, cosine as f32, eta as f32).reflectance)
}

/// A material in one lane.
pub struct Bsdf {
    bsdf: bsdf::Bsdfs<One>,
    materials: Materials,
}

/// A direction that it scatters to.
#[derive(Debug)]
pub struct Sample {
    pub wi: DVec3,
    pub weight: Rgb,
    pub pdf: f64,
    pub specular: bool,
}

impl Bsdf {
    pub fn of(material: Material) -> Bsdf {
        let scene = scene(DVec3::ZERO, DVec3::Z).with(floor(), material);
        let materials = Materials::new(&scene, &Surfaces::new(&scene, &Space::new(DVec3::ZERO, 1.0)), 1.0);
        let (bsdf, _) = materials.at(One, One.u(0), true);
        Bsdf { bsdf, materials }
    }

    pub fn glass(eta: f64, alpha: f64) -> Bsdf {
        let mut glass = Bsdf::of(Material::Dielectric { ior: 1.5, absorption: Rgb::ZERO, alpha });
        glass.bsdf.eta = eta as f32;
        glass
    }

    pub fn sample(&self, wo: DVec3, lobe: f64, u: [f64; 2]) -> Option<Sample> {
        let wo = V::splat(One, single(wo));
        let u = u.map(|u| u as f32);
        let sample = self.bsdf.sample(One, &self.materials.coats, wo, lobe as f32, u, true);
        sample.some.then(|| Sample {
            wi: double(sample.wi, 0),
            weight: double(sample.weight, 0),
            pdf: f64::from(sample.pdf),
            specular: sample.specular,
        })
    }

    pub fn eval(&self, wo: DVec3, wi: DVec3) -> Rgb {
        double(self.both(wo, wi).0, 0)
    }

    pub fn pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        f64::from(self.both(wo, wi).1)
    }

    fn both(&self, wo: DVec3, wi: DVec3) -> (V<One>, f32) {
        let [wo, wi] = [wo, wi].map(|w| V::splat(One, single(w)));
        self.bsdf.eval(One, &self.materials.coats, wo, wi, true)
    }
}

/// The lights of a scene.
pub struct Lamps {
    tracer: Tracer<'static>,
}

/// A direction to a light, drawn from a point.
#[derive(Debug)]
pub struct Light {
    pub wi: DVec3,
    /// In metres.
    pub distance: f64,
    pub radiance: Rgb,
    /// Without the choice of the light.
    pub pdf: f64,
}

/// A number, and one that is as even on every interval of it: two for the choice of a lamp.
fn twice(choice: f64) -> [f32; 2] {
    [choice, choice * 1000.0 * 0.618_033_988_749_894_9].map(|u| (u - u.floor()) as f32)
}

impl Lamps {
    pub fn of(scene: &Scene) -> Lamps {
        Lamps { tracer: Tracer::new(Box::leak(Box::new(scene.clone()))) }
    }

    pub fn is_empty(&self) -> bool {
        self.tracer.lights.is_empty()
    }

    fn receiver(&self, p: DVec3, n: Option<DVec3>) -> Receivers<One> {
        let p = V::splat(One, single(self.tracer.space.point(p)));
        Receivers { p, n: V::splat(One, single(n.unwrap_or(DVec3::Y))), open: n.is_none() }
    }

    /// Draws a direction from a point, with the normal there if it matters.
    pub fn sample(&self, p: DVec3, n: Option<DVec3>, choice: f64, u: [f64; 2]) -> Option<Light> {
        let receiver = self.receiver(p, n);
        let lights = &self.tracer.lights;
        let total = lights.total(One, &receiver);
        let chosen = lights.choose(One, &receiver, total, twice(choice), true);
        let u = u.map(|u| u as f32);
        let light = lights.sample(One, &self.tracer, &receiver, &chosen, u, true);
        light.some.then(|| Light {
            wi: double(light.wi, 0),
            distance: f64::from(light.distance) * self.tracer.space.unit(),
            radiance: double(light.radiance, 0) * self.tracer.unit,
            pdf: f64::from(light.pdf),
        })
    }

    /// The probability of each lamp to be chosen.
    pub fn chances(&self, p: DVec3, n: Option<DVec3>) -> Vec<f64> {
        let receiver = self.receiver(p, n);
        let lights = &self.tracer.lights;
        let total = lights.total(One, &receiver);
        (0..lights.len() as u32).map(|i| f64::from(lights.chance(One, i, &receiver, total))).collect()
    }

    /// Chooses a lamp by a number: which, its probability, and a number for further use.
    pub fn choose(&self, p: DVec3, n: Option<DVec3>, choice: f64) -> (usize, f64, f64) {
        let receiver = self.receiver(p, n);
        let lights = &self.tracer.lights;
        let total = lights.total(One, &receiver);
        let chosen = lights.choose(One, &receiver, total, twice(choice), true);
        (chosen.index.get(0) as usize, f64::from(chosen.probability), f64::from(chosen.rest))
    }

    /// The density with which a direction is drawn: to a light beyond the scene, or else to what is met first.
    pub fn pdf(&self, p: DVec3, n: Option<DVec3>, w: DVec3) -> f64 {
        let receiver = self.receiver(p, n);
        let lights = &self.tracer.lights;
        let total = lights.total(One, &receiver);
        let w = V::splat(One, single(w));
        if let [index] = *lights.beyond() {
            let lamp = lights.lamp(index);
            let (seen, density) = lamp.beyond(One, &receiver, w, true);
            return if seen { f64::from(density * lights.chance(One, index, &receiver, total)) } else { 0.0 };
        }
        let ray = Rays { o: receiver.p, d: w, start: One.u(NOWHERE), detail: One.u(0) };
        let surfaces = &self.tracer.surfaces;
        let hit = surfaces.closest(One, &ray, f32::INFINITY, One.u(u32::MAX), true);
        let place = hit.place.get(0);
        if place == NOWHERE {
            return 0.0;
        }
        let point = surfaces.points(One, &ray, &hit, true);
        if point.n.dot(w) >= 0.0 && surfaces.is_closed(slot(place)) {
            return 0.0;
        }
        let face = decode(place, hit.detail.get(0));
        f64::from(lights.pdf_of_surface(slot(place), face, &receiver, total, w, &point))
    }

    /// How far a ray goes until it meets something, in metres.
    pub fn seen(&self, p: DVec3, w: DVec3) -> f64 {
        let start = One.u(NOWHERE);
        let o = V::splat(One, single(self.tracer.space.point(p)));
        let ray = Rays { o, d: V::splat(One, single(w)), start, detail: One.u(0) };
        let hit = self.tracer.surfaces.closest(One, &ray, f32::INFINITY, One.u(u32::MAX), true);
        f64::from(hit.t) * self.tracer.space.unit()
    }
}
