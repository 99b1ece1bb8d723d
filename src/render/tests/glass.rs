//! Media: absorption, nesting, cameras inside.

use super::*;
use crate::math::exp;
use crate::render::media::Inside;

fn tinted(ior: f64, absorption: f64) -> Material {
    Material::Dielectric { ior, absorption: Rgb::splat(absorption), alpha: 0.0 }
}

fn seen_from_front(primitives: &[(Shape, Material)]) -> Scene {
    primitives
        .iter()
        .fold(scene(v(0.0, 0.0, 9.0), DVec3::ZERO), |scene, (shape, material)| {
            scene.with(shape.clone(), *material)
        })
        .with_sky(1.0)
        .bounces(100)
}

#[test]
fn absorption_is_exponential_in_depth() {
    let fog = |sigma| seen_from_front(&[(sphere(DVec3::ZERO, 1.5), tinted(1.0, sigma))]);
    assert_shows(&fog(0.7), 10, exp(-0.7 * 3.0), 1e-9);
    assert_shows(&fog(f64::INFINITY), 10, 0.0, 0.0);
    // Glass straight through: R + (1 − R)² T / (1 − R T), all reflections counted.
    let (r, t) = (0.04, exp(-0.7 * 3.0));
    let ball = seen_from_front(&[(sphere(DVec3::ZERO, 1.5), tinted(1.5, 0.7))]);
    assert_shows(&ball, 100_000, r + (1.0 - r) * (1.0 - r) * t / (1.0 - r * t), 1e-6);
}

#[test]
fn light_inside_a_medium_is_absorbed_on_its_way() {
    // A lamp and a wall within fog: gathered and found light are dimmed alike.
    let fog = |sigma| {
        scene(v(0.0, 0.3, 0.0), DVec3::ZERO)
            .with(floor(), white())
            .with(sphere(DVec3::ZERO, 50.0), tinted(1.0, sigma))
            .with_light(Light::Point { position: v(0.0, 2.0, 0.0), intensity: Rgb::ONE })
            .bounces(1)
    };
    assert_shows(&fog(0.4), 10, exp(-0.4 * 2.3) / (4.0 * PI), 1e-5);
    assert_shows(&fog(0.0), 10, 1.0 / (4.0 * PI), 1e-5);
}

#[test]
fn glass_within_the_same_glass_is_invisible() {
    let outer = (sphere(DVec3::ZERO, 2.0), tinted(1.5, 0.3));
    let inner = (sphere(v(0.3, 0.2, 0.1), 0.9), tinted(1.5, 0.3));
    let wide = |mut scene: Scene| {
        scene.camera.half_extent = DVec2::splat(0.25);
        scene.with(sphere(v(0.0, 0.0, -6.0), 2.0), white()).with(sphere(v(4.0, 4.0, 0.0), 1.0), glow(9.0))
    };
    let (one, two) =
        (wide(seen_from_front(std::slice::from_ref(&outer))), wide(seen_from_front(&[outer.clone(), inner])));
    let (one, two) = (Tracer::new(&one), Tracer::new(&two));
    let mut equal = 0;
    for i in 0..2000 {
        let a = one.sample(i % 8, i / 8 % 8, i / 64, &mut ()).radiance;
        let b = two.sample(i % 8, i / 8 % 8, i / 64, &mut ()).radiance;
        equal += u32::from((a - b).abs().max_element() <= 1e-6 * a.max_element());
    }
    assert!(equal > 1980, "only {equal} of 2000 samples agree");
}

#[test]
fn nested_and_overlapping_glass_loses_nothing() {
    let ball = |x: f64, radius: f64, ior: f64| (sphere(v(x, 0.1, 0.0), radius), glass(ior));
    for things in [
        vec![ball(0.0, 2.0, 1.5), ball(0.2, 1.0, 1.0)],
        vec![ball(0.0, 2.0, 1.5), ball(0.2, 1.0, 2.0), ball(0.1, 0.5, 1.2)],
        vec![ball(0.0, 2.0, 1.5), ball(1.5, 1.2, 1.33)],
        vec![ball(0.0, 2.0, 1.33), (floor(), glass(1.5))],
    ] {
        let mut scene = seen_from_front(&things).bounces(300);
        scene.camera.half_extent = DVec2::splat(0.15);
        let (mean, error) = measure(&Tracer::new(&scene), 4000);
        let whole = 1.0;
        if things.len() == 2 && matches!(things[1].0, Shape::Plane { .. }) {
            assert!(mean <= whole + 5.0 * error, "{mean}");
        } else {
            assert!((mean - whole).abs() < 1e-3, "{things:?}: {mean} ± {error}");
        }
    }
}

#[test]
fn a_bubble_reflects_like_a_gap() {
    // Glass from 2 to 1, air within: seen straight on, four boundaries of reflectance R = 0.04 in a row pass
    // (1 − R)/(1 + 3R) and reflect the rest; ink far behind would be black, so the sky stands in front alone.
    let r = 0.04;
    let through = (1.0 - r) / (1.0 + 3.0 * r);
    let things = [(sphere(DVec3::ZERO, 2.0), glass(1.5)), (sphere(DVec3::ZERO, 1.0), glass(1.0))];
    let mut scene = seen_from_front(&things).with(
        Shape::Plane { point: v(0.0, 0.0, -5.0), normal: DVec3::Z },
        Material::Diffuse { color: Rgb::ZERO.into() },
    );
    scene.camera.half_extent = DVec2::splat(1e-7);
    assert_shows(&scene, 200_000, 1.0 - through, 1e-6);
}

#[test]
fn a_camera_inside_glass_sees_radiance_times_the_square_of_the_index() {
    let mut inside = seen_from_front(&[(sphere(DVec3::ZERO, 2.0), glass(1.5))]);
    inside.camera.position = v(0.0, 0.0, 0.5);
    assert_shows(&inside, 40_000, 2.25, 1e-6);
}

#[test]
fn an_opaque_ball_in_glass_is_lit_through_it() {
    // In a furnace a white ball in clear glass is as bright as its surroundings.
    let things = [(sphere(DVec3::ZERO, 2.0), glass(1.5)), (sphere(DVec3::ZERO, 1.0), white())];
    let mut scene = seen_from_front(&things).bounces(400);
    scene.camera.half_extent = DVec2::splat(0.1);
    assert_shows(&scene, 20_000, 1.0, 2e-3);
    let frosted = Material::Dielectric { ior: 1.5, absorption: Rgb::ZERO, alpha: 0.2 };
    scene.materials[0] = frosted;
    let (mean, error) = measure(&Tracer::new(&scene), 20_000);
    assert!(mean < 1.0 + 5.0 * error && mean > 0.7, "{mean}");
}

/// Which of the solids that contain a point is the medium there, told by how far light gets.
fn medium_at(p: DVec3, shapes: &[&Shape]) -> Option<usize> {
    let mut scene = scene(p, p + DVec3::Z);
    for (i, shape) in shapes.iter().enumerate() {
        scene = scene.with((*shape).clone(), tinted(1.5, 1.0 + i as f64));
    }
    let dielectrics = Dielectrics::new(&scene);
    let mut inside = Inside::default();
    let exact = exact::Exact::new(&scene, &space::Space::new(DVec3::ZERO, 1.0));
    dielectrics.enter_at(&exact, p, &mut inside);
    let absorption = dielectrics.absorption(&inside).x;
    (absorption > 0.0).then(|| absorption.round() as usize - 1)
}

#[test]
fn the_contained_wins_and_on_a_partial_overlap_the_later() {
    let ball = |x: f64, radius: f64| sphere(v(x, 0.0, 0.0), radius);
    let (large, small) = (ball(0.0, 2.0), ball(0.5, 1.0));
    assert_eq!(medium_at(v(0.6, 0.0, 0.0), &[&large, &small]), Some(1));
    assert_eq!(medium_at(v(0.6, 0.0, 0.0), &[&small, &large]), Some(0));
    assert_eq!(medium_at(v(-1.0, 0.0, 0.0), &[&small, &large]), Some(1));
    // Partly, whichever is larger.
    let other = ball(2.0, 0.9);
    assert_eq!(medium_at(v(1.5, 0.0, 0.0), &[&large, &other]), Some(1));
    assert_eq!(medium_at(v(1.5, 0.0, 0.0), &[&other, &large]), Some(1));
    // The same twice: the later.
    assert_eq!(medium_at(v(0.6, 0.0, 0.0), &[&small, &small]), Some(1));
    // In water without end.
    assert_eq!(medium_at(v(0.0, -3.0, 0.0), &[&sphere(v(0.0, -3.0, 0.0), 1.0), &floor()]), Some(0));
    assert_eq!(medium_at(v(0.0, -0.5, 0.0), &[&sphere(DVec3::ZERO, 1.0), &floor()]), Some(1));
}

#[test]
fn no_order_of_all_solids_is_needed() {
    let ball = |x: f64, radius: f64| sphere(v(x, 0.0, 0.0), radius);
    // The first lies in the third, and the second sticks out of both.
    let [a, c, b] = [ball(0.0, 1.0), ball(3.0, 2.5), ball(0.0, 2.0)];
    let all = [a, c, b];
    assert_eq!(medium_at(v(0.0, 0.0, 0.0), &all.each_ref()), Some(0));
    assert_eq!(medium_at(v(1.5, 0.0, 0.0), &all.each_ref()), Some(2));
    assert_eq!(medium_at(v(0.8, 0.0, 0.0), &all.each_ref()), Some(1), "where all three meet");
    // Energy is kept all the same.
    let things: Vec<(Shape, Material)> = all.into_iter().zip([1.3, 1.7, 1.5].map(glass)).collect();
    let mut scene = seen_from_front(&things).bounces(300);
    scene.camera.half_extent = DVec2::splat(0.3);
    let (mean, error) = measure(&Tracer::new(&scene), 8000);
    assert!((mean - 1.0).abs() < 1e-3, "{mean} ± {error}");
}
