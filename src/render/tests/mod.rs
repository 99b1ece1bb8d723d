//! Pictures whose value is known, and the statistics to check them by.

mod acne;
mod adapter;
mod bsdfs;
mod cameras;
mod caustics;
mod determinism;
mod glass;
mod lights;
mod many;
mod meshes;
mod numbers;
mod reference;
mod shapes;
mod shares;
mod skies;
mod solids;
mod textures;

use super::film::MOST_SAMPLES;
use super::*;
use crate::color::luminance;
use crate::math::{DMat3, DVec2, DVec3, PI, pow};
use crate::scene::shape::{Form, Placed, Quadric};
use crate::scene::{
    Background, Camera, Develop, Filter, Light, MaterialId, OriginId, Primitive, PrimitiveId, Projection,
    Shape, Target, Trace,
};
use std::sync::Arc;

/// A scene without anything, whose camera at `from` looks towards `look` through a narrow pinhole.
fn scene(from: DVec3, look: DVec3) -> Scene {
    let forward = (look - from).normalize();
    let (right, up) = crate::math::basis(-forward);
    Scene {
        primitives: Arc::default(),
        materials: Vec::new(),
        textures: Vec::new(),
        images: Vec::new(),
        frames: Vec::new(),
        lights: Vec::new(),
        camera: Camera {
            projection: Projection::Perspective,
            position: from,
            right,
            up,
            forward,
            half_extent: DVec2::splat(1e-6),
            lens_radius: 0.0,
            focus: 1.0,
        },
        trace: Trace {
            size: [8, 8],
            target: Target::Samples(1),
            bounces: 8,
            indirect: true,
            seed: 1,
            filter: Filter::Box,
            background: Background::Sky,
        },
        develop: Develop { exposure: None, tonemap: Tonemap::Neutral },
    }
}

impl Scene {
    fn with(mut self, shape: Shape, material: Material) -> Scene {
        Arc::make_mut(&mut self.primitives).push(Primitive {
            shape,
            material: MaterialId(self.materials.len() as u32),
            frame: None,
            origin: OriginId(0),
        });
        self.materials.push(material);
        self
    }

    fn with_light(mut self, light: Light) -> Scene {
        self.lights.push(light);
        self
    }

    fn with_sky(self, radiance: f64) -> Scene {
        self.with_light(Light::Sky { radiance: Rgb::splat(radiance), panorama: None })
    }

    fn bounces(mut self, bounces: u32) -> Scene {
        self.trace.bounces = bounces;
        self
    }
}

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

fn sphere(center: DVec3, radius: f64) -> Shape {
    Shape::Sphere { center, radius }
}

fn floor() -> Shape {
    Shape::Plane { point: DVec3::ZERO, normal: DVec3::Y }
}

fn quadric(form: Form, matrix: DMat3, at: DVec3, [low, high]: [f64; 2], capped: bool) -> Box<Quadric> {
    let map = crate::math::DAffine3::from_mat3_translation(matrix, at);
    Box::new(Quadric { form, world_from_object: map, object_from_world: map.inverse(), low, high, capped })
}

fn placed(matrix: DMat3, at: DVec3) -> Box<Placed> {
    let map = crate::math::DAffine3::from_mat3_translation(matrix, at);
    Box::new(Placed { world_from_object: map, object_from_world: map.inverse() })
}

fn white() -> Material {
    Material::Diffuse { color: Rgb::ONE.into() }
}

fn glow(radiance: f64) -> Material {
    Material::Emitter { radiance: Rgb::splat(radiance), pattern: None }
}

fn glass(ior: f64) -> Material {
    Material::Dielectric { ior, absorption: Rgb::ZERO, alpha: 0.0 }
}

/// Mean and standard error of the luminance of many samples, spread over the pixels of the picture.
fn measure(tracer: &Tracer, samples: u32) -> (f64, f64) {
    let [width, height] = tracer.scene.trace.size;
    let each = samples.div_ceil(width * height);
    let (mut sum, mut squares, mut count) = (0.0, 0.0, 0.0);
    for y in 0..height {
        for x in 0..width {
            for sample in 0..each {
                let value = luminance(tracer.sample(x, y, sample, &mut ()).radiance);
                sum += value;
                squares += value * value;
                count += 1.0;
            }
        }
    }
    let mean: f64 = sum / count;
    (mean, ((squares / count - mean * mean).max(0.0) / count).sqrt())
}

/// What paths in single precision may be wrong by, as a share: some dozens of roundings of 6e-8 a vertex, over many
/// vertices.
const SINGLE: f64 = 2e-5;

/// Asserts that a scene shows a radiance, within five standard errors and a relative slack.
#[track_caller]
fn assert_shows(scene: &Scene, samples: u32, expected: f64, slack: f64) {
    let (mean, error) = measure(&Tracer::new(scene), samples);
    let slack = slack.max(SINGLE);
    assert!(
        (mean - expected).abs() <= 5.0 * error + slack * expected.abs(),
        "shows {mean} ± {error}, expected {expected}"
    );
}

/// Asserts by Pearson's χ² test that counts follow expected ones; cells that expect few are pooled. The chance
/// to fail by bad luck is below one in 100 000 (by the cube-root normal approximation of Wilson and Hilferty).
#[track_caller]
fn assert_distributed(observed: &[u64], expected: &[f64]) {
    let mut pool = (0.0, 0.0);
    let mut chi_squared = 0.0;
    let mut freedom = -1.0;
    for (count, mean) in observed.iter().zip(expected) {
        if *mean < 8.0 {
            pool = (pool.0 + *count as f64, pool.1 + mean);
        } else {
            let difference = *count as f64 - mean;
            chi_squared += difference * difference / mean;
            freedom += 1.0;
        }
    }
    if pool.1 > 1.0 {
        chi_squared += (pool.0 - pool.1) * (pool.0 - pool.1) / pool.1;
        freedom += 1.0;
    } else {
        assert!(pool.0 < 12.0, "{} fell where {} were expected", pool.0, pool.1);
    }
    let spread = 2.0 / (9.0 * freedom);
    let z = (pow(chi_squared / freedom, 1.0 / 3.0) - (1.0 - spread)) / f64::sqrt(spread);
    assert!(z < 4.3, "χ² is {chi_squared} at {freedom} degrees of freedom, z = {z}");
}

/// Independent numbers for tests.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let word = ((self.0 >> 18 ^ self.0) >> 27) as u32;
        let word = word.rotate_right((self.0 >> 59) as u32);
        (f64::from(word) + 0.5) / 4_294_967_296.0
    }

    fn pair(&mut self) -> [f64; 2] {
        [self.next(), self.next()]
    }

    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    fn direction(&mut self) -> DVec3 {
        adapter::cone(self.pair(), 2.0)
    }

    fn point(&mut self, extent: f64) -> DVec3 {
        v(self.within(-extent, extent), self.within(-extent, extent), self.within(-extent, extent))
    }
}

/// Draws directions, and checks them against their density over cells of the sphere. A draw may yield none.
#[track_caller]
fn assert_density(mut draw: impl FnMut([f64; 3]) -> Option<DVec3>, pdf: impl Fn(DVec3) -> f64) {
    const ACROSS: usize = 24;
    const AROUND: usize = 36;
    const FINE: usize = 48;
    const DRAWS: usize = 200_000;
    let mut random = Random(7);
    let mut observed = vec![0u64; ACROSS * AROUND + 1];
    for _ in 0..DRAWS {
        let cell = draw([random.next(), random.next(), random.next()]).map_or(ACROSS * AROUND, |w| {
            assert!((w.length() - 1.0).abs() < 1e-5 && pdf(w) > 0.0, "{w} has density {}", pdf(w));
            let z = ((0.5 * (w.z + 1.0) * ACROSS as f64) as usize).min(ACROSS - 1);
            let turn = (crate::math::atan2(w.y, w.x) / (2.0 * PI)).rem_euclid(1.0);
            z * AROUND + ((turn * AROUND as f64) as usize).min(AROUND - 1)
        });
        observed[cell] += 1;
    }
    let mut expected: Vec<f64> = (0..ACROSS * AROUND)
        .map(|cell| {
            // Evenly in the angles, so that a narrow lobe about the pole is resolved.
            let edge = |row: usize| crate::math::acos(2.0 * row as f64 / ACROSS as f64 - 1.0);
            let (top, bottom) = (edge(cell / AROUND + 1), edge(cell / AROUND));
            let (tall, wide) = ((bottom - top) / FINE as f64, 2.0 * PI / (FINE * AROUND) as f64);
            let mut sum = 0.0;
            for i in 0..FINE * FINE {
                let theta = top + ((i / FINE) as f64 + 0.5) * tall;
                let angle = ((cell % AROUND * FINE + i % FINE) as f64 + 0.5) * wide;
                sum += pdf(polar(crate::math::cos(theta), angle)) * crate::math::sin(theta);
            }
            sum * tall * wide * DRAWS as f64
        })
        .collect();
    let total: f64 = expected.iter().sum();
    // By so much the sum may miss the integral, where a density has an edge.
    const SLACK: f64 = 0.002 * DRAWS as f64;
    assert!(total < DRAWS as f64 + SLACK, "the density integrates to {}", total / DRAWS as f64);
    let none = (DRAWS as f64 - total).max(0.0);
    let yielded_none = observed[ACROSS * AROUND] as f64;
    if none.max(yielded_none) < SLACK {
        observed.pop();
    } else {
        expected.push(none);
    }
    assert_distributed(&observed, &expected);
}

fn polar(z: f64, angle: f64) -> DVec3 {
    let radius = (1.0 - z * z).max(0.0).sqrt();
    v(radius * crate::math::cos(angle), radius * crate::math::sin(angle), z)
}
