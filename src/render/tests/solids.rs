//! Solids and discs of every kind: what holds of all of them, told without their equations.

use super::*;
use adapter::{Accel, Lamps, Ray, intersect, surface_point};

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

/// The first distance at which a ray goes into or out of a solid, by steps and bisection.
fn march(shape: &Shape, ray: &Ray) -> Option<f64> {
    const STEPS: u32 = 4000;
    const FAR: f64 = 8.0;
    let inside = |t: f64| shape.contains(ray.origin + t * ray.direction);
    let step = FAR / f64::from(STEPS);
    let change = (0..STEPS).map(|i| f64::from(i) * step).find(|t| inside(*t) != inside(t + step))?;
    let (mut low, mut high) = (change, change + step);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if inside(middle) == inside(change) { low = middle } else { high = middle }
    }
    Some(0.5 * (low + high))
}

#[test]
fn rays_meet_solids_where_a_march_goes_in_and_out() {
    let mut random = Random(5);
    for (name, shape) in solids() {
        let (mut met, mut disputed) = (0, 0);
        for _ in 0..1500 {
            let ray = Ray { origin: random.point(2.0), direction: random.direction(), start: None }.rounded();
            let found = intersect(&shape, &ray, None);
            match (found, march(&shape, &ray)) {
                (None, None) => {}
                (Some((t, face)), Some(s)) if (t - s).abs() < 1e-5 => {
                    met += 1;
                    let point = surface_point(&shape, &ray, t, face);
                    let out = if shape.contains(ray.origin) { 1.0 } else { -1.0 };
                    assert!(out * point.n.dot(ray.direction) > 0.0, "{name}: {face:?} faces the wrong way");
                    assert!(shape.contains(point.p - 1e-5 * point.n), "{name} {face:?}");
                    assert!(!shape.contains(point.p + 1e-5 * point.n), "{name} {face:?}");
                }
                // Corners that are thinner than a step.
                _ => disputed += 1,
            }
        }
        assert!(met > 50 && disputed < 8, "{name}: {met} met, {disputed} disputed");
    }
}

/// Points on the surface of a lamp, as its sampling draws them.
fn drawn(shape: &Shape, random: &mut Random, count: usize) -> Vec<DVec3> {
    let lamps = Lamps::of(&scene(DVec3::ZERO, DVec3::Z).with(shape.clone(), glow(1.0)));
    let mut draw = || {
        let from = 20.0 * random.direction();
        let light = lamps.sample(from, None, random.next(), random.pair())?;
        Some(from + light.distance * light.wi)
    };
    (0..count).filter_map(|_| draw()).collect()
}

#[test]
fn lamps_are_sampled_on_their_surface_within_tight_bounds() {
    let mut random = Random(12);
    let disk = ("disk", Shape::Disk(placed(skew().matrix3, skew().translation)));
    for (name, shape) in solids_and_a_mesh().into_iter().chain([disk]) {
        let bounds = shape.bounds().expect("it has an end");
        let mut seen = crate::scene::shape::Bounds::EMPTY;
        for p in drawn(&shape, &mut random, 40_000) {
            seen = seen.union(crate::scene::shape::Bounds { min: p, max: p });
        }
        // Twenty metres in single precision, to and fro.
        let slack = 1e-5 * bounds.size().length();
        assert!((seen.min - bounds.min).min_element() > -slack, "{name}: {seen:?} {bounds:?}");
        assert!((bounds.max - seen.max).min_element() > -slack, "{name}: {seen:?} {bounds:?}");
        let gap = (seen.min - bounds.min).max(bounds.max - seen.max).max_element();
        assert!(gap < 0.03 * bounds.size().max_element(), "{name}: {seen:?} {bounds:?}");
    }
}

#[test]
fn a_lamp_of_a_given_power_radiates_it() {
    // Seen from all around at a distance, what a convex lamp of radiance 1 gives is π times its area.
    const FAR: f64 = 1000.0;
    let mut random = Random(40);
    let disk = ("disk", Shape::Disk(placed(skew().matrix3, skew().translation)));
    for (name, shape) in solids_and_a_mesh().into_iter().chain([disk]) {
        if matches!(name, "tower" | "bowls") {
            continue;
        }
        let lamps = Lamps::of(&scene(DVec3::ZERO, DVec3::Z).with(shape.clone(), glow(1.0)));
        let (mut sum, mut squares) = (0.0, 0.0);
        const N: u32 = 40_000;
        for _ in 0..N {
            let drawn = lamps.sample(FAR * random.direction(), None, random.next(), random.pair());
            let irradiance = drawn.map_or(0.0, |light| 1.0 / light.pdf);
            let flux = irradiance * 4.0 * PI * FAR * FAR;
            sum += flux / f64::from(N);
            squares += flux * flux / f64::from(N);
        }
        let error = ((squares - sum * sum) / f64::from(N)).sqrt();
        let sides = if shape.is_closed() { 1.0 } else { 2.0 };
        let expected = PI * shape.area() * sides;
        assert!(
            (sum - expected).abs() < 5.0 * error + 2e-3 * expected,
            "{name}: {sum} ± {error}, {expected}"
        );
    }
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
