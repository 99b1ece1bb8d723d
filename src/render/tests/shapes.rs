//! Where rays meet shapes, against bisection of the implicit function.

use super::*;
use crate::render::exact::SurfacePoint;
use crate::render::observer::Place;
use crate::render::shape::Face;
use adapter::{Accel, Ray, intersect, surface_point};
use std::sync::Arc;

/// The implicit function of a shape's side along a ray: negative inside.
fn implicit(shape: &Shape, p: DVec3) -> f64 {
    match shape {
        Shape::Sphere { center, radius } => p.distance_squared(*center) / (radius * radius) - 1.0,
        Shape::Plane { point, normal } => normal.dot(p - *point),
        Shape::Quadric(quadric) => quadric.form.q(quadric.object_from_world.transform_point3(p)),
        other => unreachable!("{other:?} is no quadric"),
    }
}

/// Root of a function with different signs at the ends.
fn bisect(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let rising = f(high) > 0.0;
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if (f(middle) > 0.0) == rising {
            high = middle;
        } else {
            low = middle;
        }
    }
    0.5 * (low + high)
}

const FAR: f64 = 1e6;

/// The first hit below `FAR`, by bracketing between the ends and the extreme of the function along the ray.
fn search(shape: &Shape, ray: &Ray) -> Option<(f64, Face)> {
    let f = |t: f64| implicit(shape, ray.origin + t * ray.direction);
    let bend = f(1.0) - 2.0 * f(0.0) + f(-1.0);
    let extreme = if bend == 0.0 { 0.0 } else { -0.5 * (f(1.0) - f(-1.0)) / bend };
    let middle = extreme.clamp(0.0, FAR);
    let mut hits: Vec<(f64, Face)> = [(0.0, middle), (middle, FAR)]
        .into_iter()
        .filter(|(low, high)| (f(*low) > 0.0) != (f(*high) > 0.0))
        .map(|(low, high)| (bisect(f, low, high), Face::Side))
        .collect();
    if let Shape::Quadric(quadric) = shape {
        let height = |t: f64| quadric.object_from_world.transform_point3(ray.origin + t * ray.direction).y;
        hits.retain(|(t, _)| quadric.low <= height(*t) && height(*t) <= quadric.high);
        for (y, face) in [(quadric.low, Face::Low), (quadric.high, Face::High)] {
            if quadric.capped && y.is_finite() && (height(0.0) > y) != (height(FAR) > y) {
                let t = bisect(|t| height(t) - y, 0.0, FAR);
                if f(t) < 0.0 {
                    hits.push((t, face));
                }
            }
        }
    }
    hits.into_iter().min_by(|a, b| a.0.total_cmp(&b.0))
}

const FORMS: [Form; 6] =
    [Form::Ellipsoid, Form::OneSheet, Form::TwoSheet, Form::Paraboloid, Form::Cone, Form::Cylinder];

fn shapes() -> Vec<Shape> {
    let skew = DMat3::from_cols(v(0.8, 0.5, 0.1), v(-0.4, 0.9, 0.2), v(0.1, -0.3, 1.2));
    let flip = DMat3::from_diagonal(v(0.5, -0.7, 1.0));
    const END: f64 = f64::INFINITY;
    let mut shapes = vec![
        sphere(v(0.2, -0.3, 0.1), 1.0),
        sphere(v(0.0, -940.5, 0.0), 940.0),
        sphere(v(3.0, 0.0, 0.0), 0.01),
        Shape::Plane { point: v(0.3, 0.1, -0.2), normal: v(0.6, 0.0, 0.8) },
    ];
    for form in FORMS {
        for matrix in [DMat3::IDENTITY, skew, flip] {
            for (ends, capped) in [
                ([-END, END], true),
                ([-1.5, 1.2], true),
                ([-1.5, 1.2], false),
                ([-END, 1.3], true),
                ([-0.7, 1.6], true),
            ] {
                shapes.push(Shape::Quadric(quadric(form, matrix, v(0.1, 0.2, 0.0), ends, capped)));
            }
        }
    }
    shapes
}

/// Rays of all kinds: from near and far, along axes, and near tangents.
fn ray(random: &mut Random, shape: &Shape, i: usize) -> Ray {
    let extent = if i.is_multiple_of(5) { 100.0 } else { 3.0 };
    let origin = random.point(extent);
    let direction = match i % 7 {
        0 => [DVec3::X, DVec3::NEG_Y, DVec3::Z][i / 7 % 3],
        1 => {
            // Along the slope of the function where it starts, turned by a right angle: nearly a tangent.
            let d =
                |axis: DVec3| implicit(shape, origin + 1e-3 * axis) - implicit(shape, origin - 1e-3 * axis);
            let slope = v(d(DVec3::X), d(DVec3::Y), d(DVec3::Z));
            slope.cross(random.direction()).normalize()
        }
        2 => (random.point(1.0) - origin).normalize(),
        _ => random.direction(),
    };
    Ray { origin, direction, start: None }.rounded()
}

#[test]
fn a_million_rays_meet_what_bisection_finds() {
    let shapes = shapes();
    let each = 1_000_000 / shapes.len() + 1;
    let mut random = Random(23);
    for shape in &shapes {
        let mut disputed = 0;
        for i in 0..each {
            let ray = ray(&mut random, shape, i);
            let found = intersect(shape, &ray, None).filter(|(t, _)| *t < 0.99 * FAR);
            let expected = search(shape, &ray).filter(|(t, _)| *t < 0.99 * FAR);
            let agrees = match (found, expected) {
                (None, None) => true,
                (Some((t, face)), Some((s, other))) => {
                    // The function is known to about 6e-8 of its size, the root to that over its slope.
                    face == other && (t - s).abs() <= 1e-4 * s.max(1.0)
                }
                _ => false,
            };
            if !agrees {
                disputed += 1;
            } else if let Some((t, face)) = found {
                check_point(shape, &ray, t, face);
            }
        }
        // Tangents and seams, where rounding decides, and of single precision more often than of double.
        assert!(disputed <= each / 3000, "{shape:?}: {disputed} of {each} differ");
    }
}

fn check_point(shape: &Shape, ray: &Ray, t: f64, face: Face) {
    let near = ray.origin + t * ray.direction;
    let point = surface_point(shape, ray, t, face);
    assert!(point.p.distance(near) < 1e-4 * t.max(1.0), "{shape:?} {t}: {near} became {}", point.p);
    assert!((point.n.length() - 1.0).abs() < 1e-6);
    let expected = match (face, shape) {
        (Face::Side, _) => {
            let h = 1e-5;
            let d = |axis: DVec3| implicit(shape, point.p + h * axis) - implicit(shape, point.p - h * axis);
            v(d(DVec3::X), d(DVec3::Y), d(DVec3::Z)).normalize()
        }
        (_, Shape::Quadric(quadric)) => {
            let m = quadric.world_from_object.matrix3;
            let n = m.z_axis.cross(m.x_axis).normalize();
            let out = if face == Face::High { m.y_axis } else { -m.y_axis };
            if n.dot(out) > 0.0 { n } else { -n }
        }
        _ => unreachable!("only quadrics have caps"),
    };
    // Next to the tip of a cone a rounding turns it farthest.
    assert!(point.n.distance(expected) < 3e-3, "{shape:?} {face:?}: normal {} is not {expected}", point.n);
}

#[test]
fn a_ray_that_starts_on_a_surface_meets_its_other_side_or_nothing() {
    // Far above what points are rounded by.
    const STEP: f64 = 1e-3;
    let mut random = Random(31);
    let mut told = 0;
    for shape in shapes() {
        for _ in 0..20_000 {
            let Some((start, place)) = on_surface(&mut random, &shape) else { continue };
            let direction = random.direction();
            if start.n.dot(direction).abs() < 0.05 {
                continue;
            }
            let ray = |origin: DVec3| Ray { origin, direction, start: None };
            let exact = intersect(&shape, &ray(start.p), Some(place));
            // A start a little further on, off the surface, must see the same.
            let beside = intersect(&shape, &ray(start.p + STEP * direction), None);
            match (exact, beside) {
                (None, None) => {}
                // The other side of a seam that is nearer than the step.
                (Some((t, a)), _) if t < STEP && a != place => {}
                (Some((t, a)), Some((s, b))) if a == b => {
                    assert!((t - s - STEP).abs() < 1e-4 * t.max(1.0), "{shape:?}: {t} on {a:?}, {s}");
                    told += 1;
                }
                // Nearer to a seam than the step.
                (exact, beside) => {
                    let t = exact.or(beside).map_or(0.0, |(t, _)| t);
                    assert!(!(0.1..=1e4).contains(&t), "{shape:?} from {place:?}: {exact:?}, {beside:?}");
                }
            }
        }
    }
    assert!(told > 10_000);
}

fn on_surface(random: &mut Random, shape: &Shape) -> Option<(SurfacePoint, Face)> {
    let ray = ray(random, shape, 3);
    let (t, face) = intersect(shape, &ray, None).filter(|(t, _)| *t < 100.0)?;
    Some((surface_point(shape, &ray, t, face), face))
}

#[test]
fn rays_along_asymptotes_and_in_rulings_are_no_trouble() {
    let cone = |form, ends, capped| Shape::Quadric(quadric(form, DMat3::IDENTITY, DVec3::ZERO, ends, capped));
    let one = cone(Form::OneSheet, [-2.0, 2.0], true);
    // Along an asymptote through the middle: q is −1 all the way, only the caps are met.
    let slope = v(1.0, 1.0, 0.0).normalize();
    let hit = intersect(&one, &Ray { origin: DVec3::ZERO, direction: slope, start: None }, None);
    // In single precision, numbers from 2 to 4 lie 2.4e-7 apart.
    assert!(hit.is_some_and(|(t, face)| face == Face::High && (t - f64::sqrt(8.0)).abs() < 5e-7), "{hit:?}");
    // Parallel to one, off the middle: one root.
    let hit = intersect(&one, &Ray { origin: v(3.0, 0.0, 0.0), direction: slope, start: None }, None);
    assert_eq!(hit, None);
    let hit = intersect(&one, &Ray { origin: v(3.0, 0.0, 0.0), direction: -slope, start: None }, None);
    assert!(hit.is_some_and(|(t, face)| face == Face::Side && t > 0.0), "{hit:?}");
    // A ruling lies on the surface: it is not left, and only the cap is beyond it.
    let ruling = v(0.0, 1.0, 1.0).normalize();
    let start = Ray { origin: v(1.0, 0.0, 0.0), direction: ruling, start: None };
    assert_eq!(intersect(&one, &start, Some(Face::Side)).filter(|(_, face)| *face == Face::Side), None);
    // Between the sheets nothing is met.
    let two = cone(Form::TwoSheet, [-3.0, 3.0], true);
    assert_eq!(
        intersect(&two, &Ray { origin: v(-9.0, 0.5, 0.0), direction: DVec3::X, start: None }, None),
        None
    );
}

#[test]
fn the_hierarchy_finds_what_a_list_finds() {
    let mut random = Random(77);
    // Of glass, as the single shapes are: what is opaque lifts rays that start just below it.
    let mut scene = scene(DVec3::ZERO, DVec3::Z);
    for i in 0..700 {
        let at = random.point(10.0);
        let size = random.within(0.05, 0.8);
        scene = if i % 3 == 0 {
            let matrix = DMat3::from_diagonal(v(size, 0.3 * size, 0.7 * size));
            scene.with(Shape::Quadric(quadric(Form::OneSheet, matrix, at, [-1.0, 1.0], true)), glass(1.5))
        } else {
            // Some twice, so that distances tie.
            scene.with(sphere(at, size), glass(1.5)).with(sphere(at, size), glass(1.5))
        };
    }
    scene = scene.with(floor(), glass(1.5));
    let accel = Accel::of(&scene);
    let bare = Scene { primitives: Arc::default(), ..scene.clone() };
    let alone =
        |primitive: &Primitive| Scene { primitives: Arc::new(vec![primitive.clone()]), ..bare.clone() };
    let singles: Vec<Accel> = scene.primitives.iter().map(|primitive| Accel::of(&alone(primitive))).collect();
    let mut last: Option<Ray> = None;
    for i in 0..20_000 {
        let direction = if i % 9 == 0 { DVec3::X } else { random.direction() };
        let free = Ray { origin: random.point(12.0), direction, start: None };
        // Every other one goes on from where the one before has met something.
        let ray = last.take().map_or(free, |from| Ray { direction, ..from });
        let listed = (0..)
            .map(PrimitiveId)
            .zip(&singles)
            .filter_map(|(id, single)| {
                let start = ray.start.filter(|start| start.primitive == id);
                let start = start.map(|start| Place { primitive: PrimitiveId(0), ..start });
                single.closest(&Ray { start, ..ray }).map(|hit| (hit.t, id))
            })
            .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let hit = accel.closest(&ray);
        assert_eq!(hit.map(|hit| (hit.t, hit.place.primitive)), listed);
        let distance = listed.map_or(5.0, |(t, _)| t);
        // Distances are compared as ratios, so but for a rounding.
        assert!(!accel.occluded(&ray, distance * 0.999_999));
        assert_eq!(accel.occluded(&ray, distance * 1.0001), listed.is_some());
        if i % 2 == 0 {
            last = hit.map(|hit| Ray { origin: accel.point(&ray, &hit).p, start: Some(hit.place), ..ray });
        }
    }
}

#[test]
fn a_ray_from_a_sphere_that_does_not_know_it_meets_the_far_side() {
    let ball = sphere(DVec3::ZERO, 1.0);
    let ray = |direction| Ray { origin: DVec3::X, direction, start: None };
    assert_eq!(intersect(&ball, &ray(DVec3::NEG_X), None).map(|(t, _)| t), Some(2.0));
    assert_eq!(intersect(&ball, &ray(DVec3::X), None), None);
    assert_eq!(intersect(&ball, &ray(DVec3::Y), None), None);
}
