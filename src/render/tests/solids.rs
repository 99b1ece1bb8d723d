//! Solids and discs of every kind: what holds of all of them, told without their equations.

use super::*;
use adapter::{Accel, Ray};

/// A map that turns, shears, stretches and moves.
fn skew() -> crate::math::DAffine3 {
    let matrix = DMat3::from_cols(v(0.8, 0.5, 0.1), v(-0.4, 0.9, 0.2), v(0.1, -0.3, 1.2));
    crate::math::DAffine3::from_mat3_translation(matrix, v(0.1, 0.2, -0.3))
}

/// Closed shapes of every kind that has an end, straight and skewed.
fn solids() -> Vec<(&'static str, Shape)> {
    const END: f64 = f64::INFINITY;
    let flip = crate::math::DAffine3::from_scale(v(0.9, -0.7, 0.8));
    [crate::math::DAffine3::IDENTITY, skew(), flip]
        .into_iter()
        .flat_map(|map| {
            let of = |form, ends| Shape::Quadric(quadric(form, map.matrix3, map.translation, ends, true));
            [
                ("ellipsoid", of(Form::Ellipsoid, [-END, END])),
                ("tower", of(Form::OneSheet, [-0.6, 0.9])),
                ("bowls", of(Form::TwoSheet, [-1.5, 1.3])),
                ("paraboloid", of(Form::Paraboloid, [-END, 1.0])),
                ("cone", of(Form::Cone, [-1.0, 0.0])),
                ("stump", of(Form::Cone, [0.4, 1.0])),
                ("cylinder", of(Form::Cylinder, [0.0, 1.0])),
                ("box", Shape::Box(placed(map.matrix3, map.translation))),
            ]
        })
        .collect()
}

/// And one of triangles, which knows less quickly what is inside of it.
fn solids_and_a_mesh() -> Vec<(&'static str, Shape)> {
    let mut all = solids();
    all.push(("mesh", meshes::mesh(&meshes::ball(2), skew().matrix3, skew().translation, false)));
    all
}

#[test]
fn a_white_solid_in_a_white_world_is_not_to_be_seen() {
    for (name, shape) in
        solids().into_iter().chain([("disk", Shape::Disk(placed(skew().matrix3, skew().translation)))])
    {
        let mut seen = scene(v(3.0, 2.5, 4.0), DVec3::ZERO).with(shape, white()).with_sky(1.0).bounces(64);
        seen.camera.half_extent = DVec2::splat(0.2);
        let (mean, error) = measure(&Tracer::new(&seen), 6000);
        assert!((mean - 1.0).abs() < 1e-3 + 5.0 * error, "{name}: {mean} ± {error}");
    }
}

#[test]
fn clear_glass_in_a_white_world_is_not_to_be_seen() {
    for (name, shape) in solids_and_a_mesh() {
        let mut seen =
            scene(v(3.0, 2.5, 4.0), DVec3::ZERO).with(shape, glass(1.5)).with_sky(1.0).bounces(400);
        seen.camera.half_extent = DVec2::splat(0.2);
        let (mean, error) = measure(&Tracer::new(&seen), 6000);
        // Light may be caught between the parallel walls of a box for good.
        assert!((mean - 1.0).abs() < 2e-2 + 5.0 * error, "{name}: {mean} ± {error}");
    }
}

#[test]
fn nothing_leaves_a_solid_from_the_inside() {
    // A path that bounces about inside meets a wall each time, however thin the corner it is in.
    let mut random = Random(9);
    for (name, shape) in solids_and_a_mesh() {
        let closed = scene(DVec3::ZERO, DVec3::Z).with(shape.clone(), white());
        let accel = Accel::of(&closed);
        let mut ray = (0..)
            .map(|_| random.point(1.2))
            .find(|p| shape.contains(*p))
            .map(|origin| Ray { origin, direction: DVec3::X, start: None })
            .expect("some points are inside");
        for bounce in 0..30_000 {
            let hit = accel.closest(&ray);
            let hit = hit.unwrap_or_else(|| panic!("{name}: bounce {bounce} left from {ray:?}"));
            let point = accel.point(&ray, &hit);
            assert!(point.n.dot(ray.direction) >= 0.0, "{name}: bounce {bounce} meets an outside");
            let (x, y) = crate::math::basis(-point.n);
            let local = adapter::cosine(random.pair());
            let direction = (local.x * x + local.y * y - local.z * point.n).normalize();
            ray = Ray { origin: point.p, direction, start: Some(hit.place) };
        }
    }
}
