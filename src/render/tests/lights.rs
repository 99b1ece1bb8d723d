//! Light that arrives: closed forms, and the two ways to find it.

use super::*;
use crate::math::{acos, cos, sin};
use crate::render::observer::{Contribution, Place};
use crate::render::path::Sharing;
use adapter::Lamps;
use std::sync::Arc;

/// A white floor seen from straight above, off to the side of the light.
fn floor_below() -> Scene {
    scene(v(0.0, 0.3, 0.0), DVec3::ZERO).with(floor(), white()).bounces(1)
}

#[test]
fn a_point_light_falls_off_with_the_square() {
    for position in [v(0.0, 2.0, 0.0), v(3.0, 1.0, -2.0), v(300.0, 40.0, 0.0)] {
        let scene = floor_below().with_light(Light::Point { position, intensity: Rgb::splat(5.0) });
        let squared = position.length_squared();
        assert_shows(&scene, 10, 5.0 / squared * (position.y / squared.sqrt()) / PI, 1e-5);
    }
    let below = floor_below().with_light(Light::Point { position: v(1.0, -1.0, 0.0), intensity: Rgb::ONE });
    assert_shows(&below, 10, 0.0, 0.0);
}

/// A spot of intensity 1 above the floor, aimed by an angle off the vertical.
fn spot(tilt: f64, inner: f64, outer: f64) -> Light {
    let direction = v(sin(tilt), -cos(tilt), 0.0);
    Light::Spot { position: v(0.0, 2.0, 0.0), direction, intensity: Rgb::ONE, inner, outer }
}

#[test]
fn a_spot_shines_into_its_cone_alone() {
    // Straight down, as a point light does.
    let below = |light| floor_below().with_light(light);
    assert_shows(&below(spot(0.0, 0.3, 0.3)), 10, 0.25 / PI, 1e-9);
    assert_shows(&below(spot(0.299_999, 0.3, 0.3)), 10, 0.25 / PI, 1e-9);
    assert_shows(&below(spot(0.300_001, 0.3, 0.3)), 10, 0.0, 0.0);
    assert_shows(&below(spot(0.35, 0.3, 0.3)), 10, 0.0, 0.0);
    // Half way between the cosines it is half as bright; beyond a straight angle it is a point.
    let half = crate::math::acos(0.5 * (cos(0.2) + cos(0.5)));
    assert_shows(&below(spot(half, 0.2, 0.5)), 10, 0.125 / PI, 1e-6);
    assert_shows(&below(spot(2.5, PI, PI)), 10, 0.25 / PI, 1e-9);
}

#[test]
fn a_spot_radiates_what_its_falloff_integrates_to() {
    let mut random = Random(4);
    for (inner, outer) in [(0.2, 0.2), (0.3, 0.45), (0.0, 1.0), (0.5 * PI, PI)] {
        let lamps = Lamps::of(&scene(DVec3::ZERO, DVec3::Z).with_light(spot(0.4, inner, outer)));
        const N: u32 = 200_000;
        let flux: f64 = (0..N)
            .filter_map(|_| {
                let p = v(0.0, 2.0, 0.0) + random.direction();
                Some(lamps.sample(p, None, 0.5, [0.5; 2])?.radiance.x * 4.0 * PI / f64::from(N))
            })
            .sum();
        let expected = 2.0 * PI * (1.0 - 0.5 * (cos(inner) + cos(outer)));
        assert!((flux / expected - 1.0).abs() < 0.05, "{inner} {outer}: {flux}, {expected}");
    }
}

#[test]
fn a_sun_gives_its_irradiance() {
    for radius in [0.0, 1e-6, 0.0046, 0.3, 0.5 * PI] {
        for tilt in [0.0, 0.6] {
            let direction = v(sin(tilt), cos(tilt), 0.0);
            let sun = Light::Sun { direction, irradiance: Rgb::splat(3.0), radius };
            if radius + tilt < 0.51 * PI {
                assert_shows(&floor_below().with_light(sun), 30_000, 3.0 * cos(tilt) / PI, 1e-5);
            }
            // Seen in the sky, its radiance is the irradiance over π sin².
            let up = scene(DVec3::ZERO, direction).with_light(sun);
            let seen = if radius > 0.0 { 3.0 / (PI * sin(radius) * sin(radius)) } else { 0.0 };
            assert_shows(&up, 10, if radius > 1e-5 { seen } else { measure(&Tracer::new(&up), 10).0 }, 1e-9);
        }
    }
}

#[test]
fn a_glowing_sphere_gives_what_its_closed_form_says() {
    // Wholly above the horizon: E = π L (r/d)² cos θ.
    for (center, radius) in [
        (v(0.0, 2.0, 0.0), 0.5),
        (v(2.0, 1.5, 1.0), 1.4),
        (v(0.0, 1.0, 0.0), 0.69),
        (v(800.0, 600.0, 0.0), 0.01),
    ] {
        let d = center.length();
        let expected = 7.0 * radius * radius / (d * d) * center.y / d;
        assert_shows(&floor_below().with(sphere(center, radius), glow(7.0)), 20_000, expected, 1e-5);
    }
}

#[test]
fn a_glowing_sphere_may_be_partly_below_the_horizon() {
    // Snyder, "Area light sources for real-time graphics", 1996: the clipped form factor of a sphere.
    let (d, radius, theta) = (2.0f64, 1.0f64, 1.4f64);
    let h = d / radius;
    let x = (h * h - 1.0f64).sqrt();
    let y = -x * (1.0 / crate::math::tan(theta));
    let clipped = 1.0 / (PI * h * h) * (cos(theta) * acos(y) - x * sin(theta) * (1.0 - y * y).sqrt())
        + crate::math::atan2(sin(theta) * (1.0 - y * y).sqrt(), x) / PI;
    // Only half of the floor is there to see the lamp: a disc-like cap of an ellipsoid would hide it, so the lamp
    // itself dips below a receiver that is a tiny ball's pole.
    let lamp = d * v(sin(theta), cos(theta), 0.0);
    let ball = sphere(v(0.0, -1e-4, 0.0), 1e-4);
    let mut scene =
        scene(v(0.0, 0.1, 0.0), DVec3::ZERO).with(ball, white()).with(sphere(lamp, radius), glow(1.0));
    scene.camera.half_extent = DVec2::splat(1e-9);
    assert_shows(&scene.bounces(1), 40_000, clipped, 1e-3);
}

#[test]
fn a_sky_lights_evenly() {
    assert_shows(&floor_below().with_sky(2.0), 100, 2.0, 1e-9);
    let rough = Material::Metal { color: Rgb::ONE.into(), alpha: 0.5 };
    let below = scene(v(0.0, -3.0, 0.0), DVec3::ZERO).with(floor(), rough).with_sky(1.0);
    assert_shows(&below, 10, measure(&Tracer::new(&below), 10).0, 0.0);
}

/// A floor under glowing and reflecting things of many kinds.
fn lamps() -> Vec<(&'static str, Scene)> {
    let tilt = DMat3::from_cols(v(0.5, 0.2, 0.0), v(-0.1, 0.4, 0.1), v(0.0, 0.1, 0.3));
    let at = v(0.3, 1.2, -0.4);
    const END: f64 = f64::INFINITY;
    let lamp = |form, ends, capped| Shape::Quadric(quadric(form, tilt, at, ends, capped));
    vec![
        ("ellipsoid", floor_below().with(lamp(Form::Ellipsoid, [-END, END], true), glow(1.0))),
        ("cut ellipsoid", floor_below().with(lamp(Form::Ellipsoid, [-0.5, 0.8], true), glow(1.0))),
        ("open ellipsoid", floor_below().with(lamp(Form::Ellipsoid, [-0.5, 0.8], false), glow(1.0))),
        ("tower", floor_below().with(lamp(Form::OneSheet, [-1.0, 1.0], true), glow(1.0))),
        ("open tower", floor_below().with(lamp(Form::OneSheet, [-1.0, 1.0], false), glow(1.0))),
        ("bowls", floor_below().with(lamp(Form::TwoSheet, [-1.6, 1.8], true), glow(1.0))),
        ("open bowls", floor_below().with(lamp(Form::TwoSheet, [-1.6, 1.8], false), glow(1.0))),
        ("bowl", floor_below().with(lamp(Form::Paraboloid, [-END, 1.0], true), glow(1.0))),
        ("cone", floor_below().with(lamp(Form::Cone, [-1.0, 0.0], true), glow(1.0))),
        ("open cylinder", floor_below().with(lamp(Form::Cylinder, [-1.0, 1.0], false), glow(1.0))),
        ("box", floor_below().with(Shape::Box(placed(tilt, at)), glow(1.0))),
        ("open disk", floor_below().with(Shape::Disk(placed(tilt, at)), glow(1.0))),
        ("sphere", floor_below().with(sphere(at, 0.5), glow(1.0))),
        ("sky", floor_below().with_sky(1.0)),
        (
            "sun",
            floor_below().with_light(Light::Sun {
                direction: v(0.6, 0.8, 0.0),
                irradiance: Rgb::ONE,
                radius: 0.3,
            }),
        ),
        (
            "several",
            floor_below()
                .with(sphere(at, 0.2), glow(1.0))
                .with(lamp(Form::OneSheet, [-1.0, 1.0], false), glow(0.3))
                .with(sphere(v(-1.0, 0.5, 0.0), 0.4), white())
                .with_sky(0.2),
        ),
    ]
}

/// So many lamps of all kinds that they are chosen by a tree.
pub fn many_lamps() -> Scene {
    let mut random = Random(23);
    let mut scene = scene(v(0.0, 1.0, 5.0), DVec3::ZERO).with(floor(), white());
    for i in 0..120 {
        let at = v(random.within(-4.0, 4.0), random.within(0.2, 3.0), random.within(-4.0, 4.0));
        let color = Rgb::new(1.0, 0.8, 0.5) * random.within(0.1, 3.0);
        scene = match i % 4 {
            0 => scene.with(sphere(at, 0.05), glow(5.0)),
            1 => scene.with_light(Light::Point { position: at, intensity: color }),
            2 => scene.with(Shape::Disk(placed(DMat3::from_diagonal(v(0.1, 0.1, 0.1)), at)), glow(3.0)),
            _ => scene.with_light(Light::Spot {
                position: at,
                direction: v(0.0, -1.0, 0.0),
                intensity: color,
                inner: 0.2,
                outer: 0.6,
            }),
        };
    }
    scene
        .with_light(Light::Sun { direction: v(0.6, 0.8, 0.0), irradiance: Rgb::splat(0.2), radius: 0.01 })
        .with_sky(0.05)
}

#[test]
fn lamps_are_chosen_as_often_as_is_told() {
    const DRAWS: u32 = 20_000;
    let few = Scene { primitives: Arc::default(), ..many_lamps() };
    let few = Scene { lights: few.lights[..10].to_vec(), ..few };
    for scene in [many_lamps(), few] {
        let lamps = Lamps::of(&scene);
        let mut random = Random(5);
        for _ in 0..20 {
            let p = v(random.within(-5.0, 5.0), random.within(0.0, 4.0), random.within(-5.0, 5.0));
            let n = [None, Some(DVec3::Y), Some(DVec3::NEG_Y)][(random.next() * 3.0) as usize];
            let chances = lamps.chances(p, n);
            assert!((chances.iter().sum::<f64>() - 1.0).abs() < 1e-4, "{p} {n:?}");
            let mut counts = vec![0; chances.len()];
            for i in 0..DRAWS {
                let (lamp, probability, rest) = lamps.choose(p, n, (f64::from(i) + 0.5) / f64::from(DRAWS));
                assert!((probability / chances[lamp] - 1.0).abs() < 1e-4);
                assert!((0.0..1.0).contains(&rest));
                counts[lamp] += 1;
            }
            // Evenly spaced numbers: each lamp has an interval of those that choose blindly, and one of the others.
            for (count, chance) in counts.into_iter().zip(chances) {
                let off = f64::from(count) - chance * f64::from(DRAWS);
                assert!(off.abs() < 4.0 + 1e-4 * f64::from(DRAWS), "{p} {n:?}: {count} {chance}");
            }
        }
    }
}

#[test]
fn gathering_and_finding_agree() {
    for material in [
        white(),
        Material::Metal { color: Rgb::ONE.into(), alpha: 0.3 },
        Material::Plastic { color: Rgb::splat(0.7).into(), ior: 1.5, alpha: 0.2 },
        Material::Dielectric { ior: 1.5, absorption: Rgb::ZERO, alpha: 0.4 },
    ] {
        for (name, mut scene) in lamps() {
            scene.materials[0] = material;
            let mut results = Vec::new();
            for sharing in [Sharing::Both, Sharing::OnlyGathered, Sharing::OnlyFound] {
                let mut tracer = Tracer::new(&scene);
                tracer.sharing = sharing;
                results.push(measure(&tracer, 30_000));
            }
            let (shared, error) = results[0];
            for (mean, other) in &results[1..] {
                // What is certain is so but for some roundings of 6e-8.
                let slack = 5.0 * (error + other) + 1e-6 * shared;
                assert!((shared - mean).abs() < slack, "{name} on {material:?}: {results:?}");
            }
            assert!(shared > 0.0);
        }
    }
}

#[test]
fn directions_to_lights_have_their_density() {
    let n = Some(DVec3::Y);
    // Over cells of the sphere where the density is smooth; the silhouette of a quadric lamp is not, and is left
    // to `gathering_and_finding_agree`.
    for (name, mut scene) in lamps() {
        if name == "several" || name.contains("open") {
            continue;
        }
        if scene.primitives.len() > 1 {
            Arc::make_mut(&mut scene.primitives).remove(0);
        }
        scene.camera.position = DVec3::ZERO;
        let lamps = Lamps::of(&scene);
        // What hides itself is drawn and then found hidden; the density counts what is seen.
        let draw = |[choice, a, b]: [f64; 3]| {
            let light = lamps.sample(DVec3::ZERO, n, choice, [a, b])?;
            let first = lamps.seen(DVec3::ZERO, light.wi);
            // At the outline a rounding makes the ray miss, or meet the near side of it.
            let off = (first / light.distance - 1.0).abs();
            let visible = light.distance.is_infinite() || off < 1e-3;
            if light.distance.is_infinite() || off < 1e-5 {
                let pdf = lamps.pdf(DVec3::ZERO, n, light.wi);
                // Seen so nearly from its edge that the density is huge, a point is known to fewer digits.
                let slack = 1e-3 + 1e-4 * light.pdf;
                assert!((pdf / light.pdf - 1.0).abs() < slack, "{name}: {pdf} {}", light.pdf);
            }
            visible.then_some(light.wi)
        };
        if matches!(name, "sky" | "sphere" | "sun") {
            assert_density(draw, |wi| lamps.pdf(DVec3::ZERO, n, wi));
        } else {
            let mut random = Random(9);
            for _ in 0..5000 {
                draw([random.next(), random.next(), random.next()]);
            }
        }
    }
}

#[test]
fn closed_lamps_glow_outwards_and_open_ones_both_ways() {
    let inside = |capped| {
        let lamp = Shape::Quadric(quadric(Form::OneSheet, DMat3::IDENTITY, DVec3::ZERO, [-1.0, 1.0], capped));
        scene(DVec3::ZERO, DVec3::X).with(lamp, glow(1.0))
    };
    assert_shows(&inside(true), 10, 0.0, 0.0);
    assert_shows(&inside(false), 10, 1.0, 1e-12);
    assert_shows(&scene(DVec3::ZERO, DVec3::X).with(sphere(DVec3::ZERO, 1.0), glow(1.0)), 10, 0.0, 0.0);
}

#[test]
fn bounces_count_scattering() {
    let seen =
        |bounces| scene(v(0.0, 1.0, 0.0), DVec3::ZERO).with(floor(), white()).with_sky(1.0).bounces(bounces);
    assert_shows(&seen(0), 10, 0.0, 0.0);
    assert_shows(&seen(1), 100, 1.0, 1e-9);
    // Two mirrors: each reflection is one.
    let mirrors = |bounces| {
        scene(v(0.5, 1.0, 0.0), v(0.0, 0.0, 0.0))
            .with(floor(), Material::Mirror { color: Rgb::ONE.into() })
            .with(
                Shape::Plane { point: v(-1.0, 0.0, 0.0), normal: DVec3::X },
                Material::Mirror { color: Rgb::ONE.into() },
            )
            .with_sky(1.0)
            .bounces(bounces)
    };
    assert_shows(&mirrors(1), 10, 0.0, 0.0);
    assert_shows(&mirrors(2), 10, 1.0, 1e-12);
}

#[test]
fn without_indirect_light_one_rough_scattering_is_all() {
    // A lamp that only the wall sees: its light comes by the wall to the floor, or straight to a mirror.
    let corner = |indirect, floor_material| {
        let mut scene = scene(v(0.5, 1.0, 0.0), DVec3::ZERO)
            .with(floor(), floor_material)
            .with(Shape::Plane { point: v(-1.0, 0.0, 0.0), normal: DVec3::X }, white())
            .with(sphere(v(-0.5, -0.5, 0.0), 0.3), white())
            .with_light(Light::Point { position: v(3.0, 0.5, 0.0), intensity: Rgb::splat(10.0) });
        scene.trace.indirect = indirect;
        measure(&Tracer::new(&scene), 20_000).0
    };
    let direct = 10.0 / 9.25 * (0.5 / f64::sqrt(9.25)) / PI;
    assert!((corner(false, white()) / direct - 1.0).abs() < 1e-4);
    assert!(corner(true, white()) > 1.1 * direct);
    let mirror = Material::Mirror { color: Rgb::ONE.into() };
    let wall = corner(false, mirror);
    assert!(wall > 0.0, "a mirror shows the lit wall");
}

#[test]
fn contributions_add_up_and_cut_paths_are_told() {
    #[derive(Default)]
    struct Sum {
        radiance: Rgb,
        vertices: u32,
        cut: u32,
        most: u32,
    }
    impl Observer for Sum {
        fn scattered(&mut self, vertex: &crate::render::observer::Vertex) {
            assert_eq!(vertex.bounce, self.vertices);
            self.vertices += 1;
        }
        fn contributed(&mut self, contribution: &Contribution) {
            self.radiance += contribution.radiance;
            self.most = self.most.max(contribution.bounces);
        }
        fn cut(&mut self, _: Place, throughput: Rgb) {
            assert!(throughput.max_element() > 0.0);
            self.cut += 1;
        }
    }
    let scene = reference::room().bounces(4);
    let tracer = Tracer::new(&scene);
    let (mut cut, mut most) = (0, 0);
    for i in 0..500 {
        let mut sum = Sum::default();
        let value = tracer.sample(160 + i % 20, 120 + i / 20, 0, &mut sum).radiance;
        // The tracer adds in single precision.
        assert!((value - sum.radiance).abs().max_element() <= 1e-6 * sum.radiance.max_element());
        assert!(sum.vertices <= 4 && (sum.cut == 0 || sum.vertices == 4));
        cut += sum.cut;
        most = most.max(sum.most);
    }
    assert!(cut > 100 && most == 4);
}
