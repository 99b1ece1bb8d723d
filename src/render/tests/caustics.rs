//! Caustics: closed forms, derivatives, densities, and luck as the judge.

use super::*;
use crate::math::{cos, sin};
use crate::render::caustic::aim::{Aims, Lobe, Probes, probe};
use crate::render::caustic::chain::{Ways, WaysOf};
use crate::render::caustic::goal::Target;
use crate::render::shape::{Face, Rays, encode};
use crate::render::space::double;
use crate::render::vector::{V, basis, single};
use crate::scene::PrimitiveId;

fn mirror(reflectance: f64) -> Material {
    Material::Mirror { color: Rgb::splat(reflectance).into() }
}

/// A white floor seen from low above, where light comes to `x` only by what is added.
fn floor_at(x: f64) -> Scene {
    scene(v(x, 0.05, 0.01), v(x, 0.0, 0.0)).with(floor(), white())
}

fn point(position: DVec3) -> Light {
    Light::Point { position, intensity: Rgb::splat(5.0) }
}

#[test]
fn a_point_light_through_a_ball_gives_what_paraxial_optics_say() {
    // On the axis, before any ray crosses it: E = I T² / B², where B is how far off a ray arrives for each radian.
    let (r, n, above, below) = (1.0, 1.1, 5.0, 1.2);
    let power = (n - 1.0) / r;
    let (mut x, mut slope) = (above - r, 1.0);
    for (index, way) in [(n, 2.0 * r), (1.0 / n, below - r)] {
        // n₂ θ₂ = n₁ θ₁ − power x.
        slope = if index > 1.0 { (slope - power * x) / n } else { n * slope - power * x };
        x += way * slope;
    }
    let reflectance = (n - 1.0) * (n - 1.0) / ((n + 1.0) * (n + 1.0));
    let through = (1.0 - reflectance) * (1.0 - reflectance);
    let scene = floor_at(0.0)
        .with(sphere(v(0.0, below, 0.0), r), glass(n))
        .with_light(point(v(0.0, below + above, 0.0)))
        .bounces(3);
    let expected = 5.0 * through / (x * x) / PI;
    assert_shows(&scene, 40_000, expected, 2e-3);
    assert_found_without_seeds(&scene, expected);
}

#[test]
fn a_point_light_by_a_mirror_ball_gives_what_curvatures_say() {
    // Rays that spread from a distance s have after reflection the curvatures 1/s + 2/(r cos θ) in the plane of
    // incidence and 1/s + 2 cos θ/r across it.
    let (r, theta, s, d): (f64, f64, f64, f64) = (0.5, 0.6, 2.0, 1.5);
    let meets = DVec3::ZERO;
    let normal = v(sin(0.9), -cos(0.9), 0.0);
    let across = v(cos(0.9), sin(0.9), 0.0);
    let light = meets + s * (cos(theta) * normal + sin(theta) * across);
    let down = cos(theta) * normal - sin(theta) * across;
    let receiver = meets + d * down;
    let spread =
        (1.0 + d * (1.0 / s + 2.0 / (r * cos(theta)))) * (1.0 + d * (1.0 / s + 2.0 * cos(theta) / r));
    let expected = 5.0 * 0.9 / (s * s * spread) * -down.y / PI;
    let shift = v(0.0, -receiver.y, 0.0);
    // A wall hides the light itself from the floor.
    let scene = floor_at(receiver.x)
        .with(sphere(meets - r * normal + shift, r), mirror(0.9))
        .with(sphere(0.5 * (light + receiver) + shift, 0.1), Material::Diffuse { color: Rgb::ZERO.into() })
        .with_light(point(light + shift))
        .bounces(2);
    assert_shows(&scene, 40_000, expected, 2e-3);
    assert_found_without_seeds(&scene, expected);
}

/// Asserts that what no seed knows is found by searching.
fn assert_found_without_seeds(scene: &Scene, expected: f64) {
    let mut tracer = Tracer::new(scene);
    tracer.caustics.forget_seeds();
    let (mean, error) = measure(&tracer, 400_000);
    assert!((mean - expected).abs() < 5.0 * error, "shows {mean} ± {error}, expected {expected}");
    assert!(error < 0.1 * expected, "shows {mean} ± {error}");
}

/// Lamps so large that luck finds them well too.
fn lit_by_luck() -> Vec<(&'static str, Scene)> {
    let lamp = |scene: Scene| scene.with(sphere(v(0.3, 3.0, 0.4), 0.4), glow(20.0)).bounces(7);
    let stretched = |form, matrix: DMat3, at, ends| Shape::Quadric(quadric(form, matrix, at, ends, true));
    let flat = DMat3::from_diagonal(v(0.8, 0.25, 0.8));
    let tower = DMat3::from_diagonal(v(0.2, 0.4, 0.2));
    const END: f64 = f64::INFINITY;
    vec![
        ("ball", lamp(floor_at(0.0).with(sphere(v(0.0, 0.7, 0.0), 0.5), glass(1.5)))),
        ("tinted", {
            let tinted = Material::Dielectric { ior: 1.5, absorption: Rgb::splat(1.2), alpha: 0.0 };
            lamp(floor_at(0.1).with(sphere(v(0.0, 0.7, 0.0), 0.5), tinted))
        }),
        (
            "row",
            lamp(
                floor_at(0.1)
                    .with(sphere(v(0.0, 0.6, 0.0), 0.4), glass(1.33))
                    .with(sphere(v(0.2, 1.6, 0.1), 0.4), glass(1.5)),
            ),
        ),
        (
            "lens",
            lamp(
                floor_at(0.1)
                    .with(stretched(Form::Ellipsoid, flat, v(0.0, 1.0, 0.1), [-END, END]), glass(1.5)),
            ),
        ),
        (
            "tower",
            lamp(
                floor_at(0.5)
                    .with(stretched(Form::OneSheet, tower, v(0.0, 0.5, 0.0), [-1.2, 1.2]), mirror(0.9)),
            ),
        ),
        (
            "bubble",
            lamp(
                floor_at(0.0)
                    .with(sphere(v(0.0, 0.7, 0.0), 0.5), glass(1.5))
                    .with(sphere(v(0.1, 0.75, 0.0), 0.25), glass(1.0)),
            ),
        ),
        ("plastic", {
            let mut scene = lamp(floor_at(0.0).with(sphere(v(0.0, 0.7, 0.0), 0.5), glass(1.5)));
            scene.materials[0] = Material::Plastic { color: Rgb::splat(0.7).into(), ior: 1.5, alpha: 0.2 };
            scene
        }),
    ]
}

#[test]
fn looking_for_caustics_agrees_with_luck() {
    for (name, scene) in lit_by_luck() {
        let mut results = Vec::new();
        for sharing in [Sharing::Both, Sharing::OnlyGathered, Sharing::OnlyFound] {
            let mut tracer = Tracer::new(&scene);
            assert!(!tracer.caustics.is_empty(), "{name}");
            tracer.sharing = sharing;
            results.push(measure(&tracer, 40_000));
        }
        let (shared, error) = results[0];
        for (mean, other) in &results[1..] {
            assert!((shared - mean).abs() < 5.0 * (error + other), "{name}: {results:?}");
        }
        assert!(shared > 0.0 && error < 1.1 * results[2].1, "{name}: {results:?}");
    }
}

/// Directions of the world from a point of the first surface of a scene, as chains of a way see them.
struct Chain<'s> {
    tracer: Tracer<'s>,
    from: DVec3,
    ways: Ways,
    target: Target,
}

impl Chain<'_> {
    fn probe(&self, w: V<One>) -> Option<Probes<One>> {
        let tracer = &self.tracer;
        let (start, detail) = encode(tracer.surfaces.slot(PrimitiveId(0)), Face::Side);
        let o = V::splat(One, single(tracer.space.point(self.from)));
        let starts = Rays { o, d: w, start: One.u(start), detail: One.u(detail) };
        let (to, far) = match self.target {
            Target::Near { center, .. } => (center, false),
            Target::Far { direction, .. } => (direction, true),
        };
        let ways = WaysOf { through: One.u(self.ways.through), end: One.u(self.ways.end) };
        let aims = Aims {
            starts,
            towards: [w; 2],
            ways,
            to: V::splat(One, to),
            far,
            enough: [0.0; 2],
            most: One.u(1),
        };
        let mut insides = [media::Inside::default()];
        let found = probe(One, tracer, &aims, (&[&media::Inside::default()], &mut insides), w, true);
        found.some.then_some(found)
    }
}

fn ways(through: &[bool]) -> Ways {
    through.iter().fold(Ways::NONE, |ways, &way| ways.then(way).unwrap())
}

#[test]
fn derivatives_of_chains_are_those_of_small_differences() {
    let mut count = 0;
    for (name, scene) in lit_by_luck() {
        for ways in [&[false][..], &[true, true], &[true, false, true], &[true, true, true, true]].map(ways) {
            let center = single(v(0.3, 3.0, 0.4) - scene.camera.position);
            let direction = single(v(0.1, 0.9, 0.2).normalize());
            for target in [Target::Near { center, radius: 0.4 }, Target::Far { direction, sine: 0.01 }] {
                let from = v(0.05, 0.0, 0.02);
                let chain = Chain { tracer: Tracer::new(&scene), from, ways, target };
                let w = V::splat(One, single((v(0.12, 0.7, 0.06) - from).normalize()));
                let Some(probed) = chain.probe(w) else { continue };
                let (x, y) = basis(One, w);
                for (i, axis) in [x, y].into_iter().enumerate() {
                    const STEP: f32 = 1e-3;
                    let miss = |step: f32| {
                        let miss = chain.probe((w + axis * step).normalized(One))?.miss;
                        Some(DVec2::new(f64::from(miss[0]), f64::from(miss[1])))
                    };
                    let (Some(after), Some(before)) = (miss(STEP), miss(-STEP)) else { continue };
                    // The frame of a near target turns with the ray, so lengths are compared near the target only.
                    let numeric = (after - before) / (2.0 * f64::from(STEP));
                    let change = DVec2::new(f64::from(probed.change[i][0]), f64::from(probed.change[i][1]));
                    let [a, b] = probed.miss.map(f64::from);
                    let turning = if matches!(target, Target::Near { .. }) { 8.0 * a.hypot(b) } else { 0.0 };
                    let scale = change.length() + 0.1;
                    let error = (numeric - change).length();
                    assert!(error < 2e-3 * scale + turning * scale, "{name} {ways:?}: {numeric} {change}");
                    count += 1;
                }
            }
        }
    }
    assert!(count > 20, "{count}");
}

#[test]
fn directions_about_a_chain_have_their_density() {
    let scene = floor_at(0.0).with(sphere(v(0.0, 1.5, 0.0), 0.7), mirror(1.0));
    let center = single(v(1.5, 1.0, 0.3) - scene.camera.position);
    let from = v(0.6, 0.0, 0.0);
    let chain = Chain {
        tracer: Tracer::new(&scene),
        from,
        ways: ways(&[false]),
        target: Target::Near { center, radius: 0.5 },
    };
    let w = single((v(0.35, 1.0, 0.05) - from).normalize());
    let lobe = Lobe::new(chain.probe(V::splat(One, w)).unwrap(), 3.0).unwrap();
    assert_density(
        |[choice, a, b]| Some(double(lobe.sample(choice as f32, [a as f32, b as f32]), 0)),
        |w| f64::from(lobe.pdf(V::splat(One, single(w)))),
    );
}

#[test]
fn caustics_are_the_same_bits_in_any_number_of_lanes() {
    for (name, scene) in lit_by_luck().into_iter().chain([("point", lit_by_a_point())]) {
        let films = Level::ALL.map(|level| {
            let tracer = Tracer::new(&scene).on(level);
            let shown = Shown { stops: 0.0, tonemap: Tonemap::Neutral };
            let target = crate::scene::Target::Samples(64);
            let window = Window::whole(scene.trace.size);
            tracer.render(window, target, &tracer.prepass(), shown, &Control::new()).unwrap().film
        });
        assert!(films.iter().all(|film| *film == films[0]), "{name}");
    }
}

/// A glass ball over a wide floor.
fn lit_by_a_point() -> Scene {
    let mut scene =
        floor_at(0.3).with(sphere(v(0.0, 1.5, 0.0), 1.0), glass(1.5)).with_light(point(v(0.0, 5.0, 0.0)));
    scene.camera.half_extent = DVec2::splat(0.5);
    scene
}

#[test]
fn ways_read_from_the_other_end() {
    let way = ways(&[true, false, false, true, true]);
    assert_eq!(way.reversed(), ways(&[true, true, false, false, true]));
    assert_eq!(Ways::NONE.reversed(), Ways::NONE);
    assert_eq!(way.count(), 5);
}
