//! Whether one solid lies in another: what decides which of two dielectrics wins where they overlap.

use super::Shape;
use super::shape::{Bounds, Form, Placed, Quadric};
use crate::math::{DAffine3, DMat3, DVec3};

/// By how much a solid may stick out of another and still lie in it, as a share of the outer one's size. A bubble
/// that touches the wall from inside must not turn into a partial overlap by rounding.
const SLACK: f64 = 1e-9;

/// Whether `inner` lies in `outer`, both closed.
///
/// Yes is always true. It is said whenever it is true of a sphere in a sphere, of anything in a plane's half-space
/// that has bounds or is a plane, and of quadrics about one common axis whose cross-sections have one shape, such as
/// a thing and its enlarged copy about one centre; also of anything in a box, and of a box in what is convex. For
/// other pairs it is said when the box around the inner one, along the axes of the outer one's object space, lies in
/// the outer one; so a solid that fills much of another with other axes is not found to lie in it.
pub fn lies_in(inner: &Shape, outer: &Shape) -> bool {
    match (inner, outer) {
        (Shape::Sphere { center: a, radius: r }, Shape::Sphere { center: b, radius: s }) => {
            a.distance(*b) + r <= s * (1.0 + SLACK)
        }
        (Shape::Plane { point: p, normal: m }, Shape::Plane { point: q, normal: n }) => {
            m == n && n.dot(*p - *q) <= 0.0
        }
        (Shape::Plane { .. }, _) => false,
        (_, Shape::Plane { point, normal }) => {
            let Some(reach) = inner.reach(*normal, *point) else { return false };
            let Some(depth) = inner.reach(-*normal, *point) else { return false };
            reach <= SLACK * (reach + depth)
        }
        (_, Shape::Sphere { center, radius }) => in_quadric(inner, &Quadric::ball(*center, *radius)),
        (_, Shape::Quadric(outer)) => in_quadric(inner, outer),
        (_, Shape::Box(outer)) => in_cuboid(inner, outer),
        // What a mesh holds is not asked; of solids within one, those declared later win.
        (_, Shape::Disk(_) | Shape::Mesh(_)) => false,
    }
}

fn in_quadric(inner: &Shape, outer: &Quadric) -> bool {
    if inner.bounds().is_none() {
        return false;
    }
    // The inner one is seen from the outer one's object space, where lengths are about 1.
    let around = match as_quadric(inner) {
        Some(inner) => {
            let map = outer.object_from_world * inner.world_from_object;
            if profile_lies_in(&inner, outer, map) {
                return true;
            }
            seen(&inner, map)
        }
        None => as_box(inner).map(|(bounds, world_from_object)| {
            let map = outer.object_from_world * world_from_object;
            if corners_lie_in(bounds, map, outer) { Bounds::EMPTY } else { bounds.mapped(&map) }
        }),
    };
    around.is_some_and(|bounds| bounds.is_empty() || box_lies_in(bounds, outer))
}

fn in_cuboid(inner: &Shape, outer: &Placed) -> bool {
    let around = match as_quadric(inner) {
        Some(inner) => seen(&inner, outer.object_from_world * inner.world_from_object),
        None => as_box(inner).map(|(bounds, map)| bounds.mapped(&(outer.object_from_world * map))),
    };
    around.is_some_and(|bounds| bounds.min.abs().max(bounds.max.abs()).max_element() <= 1.0 + SLACK)
}

fn as_quadric(shape: &Shape) -> Option<Quadric> {
    match shape {
        Shape::Sphere { center, radius } => Some(Quadric::ball(*center, *radius)),
        Shape::Quadric(quadric) => Some(**quadric),
        _ => None,
    }
}

/// A box, or the box around a mesh, in its object space, and the map from there.
fn as_box(shape: &Shape) -> Option<(Bounds, DAffine3)> {
    match shape {
        Shape::Box(placed) => Some((Bounds::CUBE, placed.world_from_object)),
        Shape::Mesh(instance) => Some((instance.object_bounds(), instance.placed.world_from_object)),
        _ => None,
    }
}

/// The box around a quadric that a map carries elsewhere; none where it has no end.
fn seen(quadric: &Quadric, map: DAffine3) -> Option<Bounds> {
    let seen = Quadric { world_from_object: map, object_from_world: map.inverse(), ..*quadric };
    Shape::Quadric(Box::new(seen)).bounds()
}

/// Whether the corners of a box that a map carries to the object space of a quadric lie in it, and so all of the
/// box, since the quadric is convex.
fn corners_lie_in(bounds: Bounds, map: DAffine3, outer: &Quadric) -> bool {
    let corner = |i: u32| {
        let end = |bit: u32, axis: usize| if i & bit == 0 { bounds.min[axis] } else { bounds.max[axis] };
        map.transform_point3(DVec3::new(end(1, 0), end(2, 1), end(4, 2)))
    };
    let lies_in = |p: DVec3| outer.form.q(p) <= SLACK * (1.0 + p.length_squared()) && spans(outer, p.y, p.y);
    let convex = match outer.form {
        Form::Ellipsoid | Form::Paraboloid | Form::Cylinder => true,
        Form::Cone => outer.high <= 0.0 || outer.low >= 0.0,
        Form::OneSheet | Form::TwoSheet => false,
    };
    convex && (0..8).all(|i| lies_in(corner(i)))
}

/// Of quadrics about one axis: whether the inner one's cross-section at every height lies in the outer one's.
fn profile_lies_in(inner: &Quadric, outer: &Quadric, map: DAffine3) -> bool {
    let (m, t) = (map.matrix3, map.translation);
    let size =
        m.x_axis.abs().max_element().max(m.y_axis.abs().max_element()).max(m.z_axis.abs().max_element());
    let off_axis = [m.x_axis.y, m.z_axis.y, m.y_axis.x, m.y_axis.z, t.x, t.z];
    if off_axis.iter().any(|v| v.abs() > SLACK * size.min(1.0)) {
        return false;
    }
    // The greatest stretch across the axis, squared: the greater eigenvalue of the 2×2 block times its transpose.
    let (a, b) = (
        m.x_axis.x * m.x_axis.x + m.x_axis.z * m.x_axis.z,
        m.z_axis.x * m.z_axis.x + m.z_axis.z * m.z_axis.z,
    );
    let c = m.x_axis.x * m.z_axis.x + m.x_axis.z * m.z_axis.z;
    let widening = 0.5 * (a + b) + (0.25 * (a - b) * (a - b) + c * c).sqrt();
    // At height y the outer one's squared radius less the inner one's is a quadratic function of y, least at an end
    // or where its slope vanishes.
    let spare =
        |y: f64| outer.form.radius_squared(m.y_axis.y * y + t.y) - widening * inner.form.radius_squared(y);
    let curvature = -outer.form.y_sign() * m.y_axis.y * m.y_axis.y + widening * inner.form.y_sign();
    let slope =
        -m.y_axis.y * (outer.form.y_sign() * t.y + outer.form.y_slope()) + widening * inner.form.y_slope();
    inner.stretches().iter().filter(|[low, high]| low < high).all(|&[low, high]| {
        let turning = -slope / curvature;
        let least = if low < turning && turning < high { turning } else { low };
        let ends = [low, high].map(|y| m.y_axis.y * y + t.y);
        let wide = [low, high, least].iter().all(|&y| {
            let radius_squared = widening * inner.form.radius_squared(y);
            spare(y) >= -SLACK * (1.0 + radius_squared)
        });
        wide && spans(outer, ends[0].min(ends[1]), ends[0].max(ends[1]))
    })
}

/// Whether a box in the object space of a quadric lies in it.
fn box_lies_in(bounds: Bounds, outer: &Quadric) -> bool {
    let far = bounds.min.abs().max(bounds.max.abs());
    let across = far.x * far.x + far.z * far.z;
    // Where the outer one is narrowest over the box's heights: r² is least at an end, or at y = 0.
    let crosses = bounds.min.y < 0.0 && 0.0 < bounds.max.y;
    let middle = if crosses { 0.0 } else { bounds.min.y };
    let narrowest = [bounds.min.y, bounds.max.y, middle]
        .map(|y| outer.form.radius_squared(y))
        .into_iter()
        .fold(f64::INFINITY, f64::min);
    across <= narrowest + SLACK && spans(outer, bounds.min.y, bounds.max.y)
}

/// Whether a stretch of heights lies between the ends of a quadric.
fn spans(outer: &Quadric, low: f64, high: f64) -> bool {
    let slack = SLACK * (1.0 + low.abs().max(high.abs()));
    outer.low <= low + slack && high <= outer.high + slack
}

impl Quadric {
    /// A sphere as a quadric.
    fn ball(center: DVec3, radius: f64) -> Quadric {
        let map = DAffine3 { matrix3: DMat3::from_diagonal(DVec3::splat(radius)), translation: center };
        Quadric {
            form: Form::Ellipsoid,
            world_from_object: map,
            object_from_world: map.inverse(),
            low: f64::NEG_INFINITY,
            high: f64::INFINITY,
            capped: true,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const END: f64 = f64::INFINITY;

    fn sphere(x: f64, radius: f64) -> Shape {
        Shape::Sphere { center: DVec3::new(x, 0.3 * x, -0.2 * x), radius }
    }

    fn quadric(form: Form, matrix: DMat3, at: DVec3, [low, high]: [f64; 2]) -> Shape {
        let map = DAffine3 { matrix3: matrix, translation: at };
        let object_from_world = map.inverse();
        Shape::Quadric(Box::new(Quadric {
            form,
            world_from_object: map,
            object_from_world,
            low,
            high,
            capped: true,
        }))
    }

    /// Of few directions and sizes, so that some lie in each other and some touch.
    fn shapes() -> Vec<Shape> {
        let turned = DMat3::from_cols(
            DVec3::new(0.6, 0.8, 0.0),
            DVec3::new(-0.8, 0.6, 0.0),
            DVec3::new(0.0, 0.3, 1.0),
        );
        let mut shapes = vec![
            Shape::Plane { point: DVec3::ZERO, normal: DVec3::Y },
            Shape::Plane { point: 2.0 * DVec3::Y, normal: DVec3::Y },
            Shape::Plane { point: -DVec3::Y, normal: DVec3::new(0.6, 0.8, 0.0) },
            quadric(Form::OneSheet, DMat3::IDENTITY, DVec3::ZERO, [-END, END]),
            quadric(Form::Cylinder, DMat3::IDENTITY, DVec3::ZERO, [-END, END]),
            quadric(Form::Paraboloid, DMat3::IDENTITY, -DVec3::Y, [-END, END]),
        ];
        for size in [0.2, 0.45, 0.9, 1.8] {
            for at in [DVec3::ZERO, DVec3::new(0.1, 0.5, 0.0), DVec3::new(0.0, -1.3, 0.0)] {
                shapes.push(Shape::Sphere { center: at, radius: size });
                for matrix in [DMat3::from_diagonal(DVec3::new(1.0, 0.7, 1.0)), turned] {
                    for (form, ends) in [
                        (Form::Ellipsoid, [-END, END]),
                        (Form::Ellipsoid, [-0.5, 0.8]),
                        (Form::OneSheet, [-1.1, 1.1]),
                        (Form::TwoSheet, [-2.0, 1.5]),
                        (Form::Paraboloid, [-END, 1.0]),
                        (Form::Cone, [-1.0, 0.0]),
                        (Form::Cylinder, [0.0, 1.0]),
                    ] {
                        shapes.push(quadric(form, matrix * size, at, ends));
                    }
                    let world_from_object = DAffine3::from_mat3_translation(0.8 * size * matrix, at);
                    let object_from_world = world_from_object.inverse();
                    shapes.push(Shape::Box(Box::new(Placed { world_from_object, object_from_world })));
                }
            }
        }
        shapes
    }

    #[test]
    fn what_lies_in_another_has_no_point_outside_it() {
        let shapes = shapes();
        let mut found = 0;
        for outer in &shapes {
            for inner in &shapes {
                if !lies_in(inner, outer) {
                    continue;
                }
                found += 1;
                for i in 0..20_000u32 {
                    // A grid without regularities that the shapes have too.
                    let part = |k: f64| 4.2 * ((f64::from(i) * k) % 1.0) - 2.1;
                    let p = DVec3::new(part(0.819_172_5), part(0.671_043_6), part(0.549_700_5));
                    assert!(!inner.contains(p) || outer.contains(p), "{inner:?} in {outer:?} at {p}");
                }
            }
        }
        assert!(found > 2 * shapes.len(), "few pairs were found to nest: {found} of {}", shapes.len());
    }

    #[test]
    fn spheres_nest_exactly_and_may_touch() {
        assert!(
            lies_in(&sphere(0.0, 1.0), &sphere(0.0, 1.5)) && !lies_in(&sphere(0.0, 1.5), &sphere(0.0, 1.0))
        );
        let ball = |y: f64, radius: f64| Shape::Sphere { center: DVec3::new(0.1, y, 0.7), radius };
        assert!(lies_in(&ball(0.3, 0.3), &ball(1.0, 1.0)), "they touch");
        assert!(!lies_in(&ball(0.29999, 0.3), &ball(1.0, 1.0)), "it sticks out");
        assert!(!lies_in(&ball(9.0, 0.3), &ball(1.0, 1.0)));
    }

    #[test]
    fn planes_hold_what_is_wholly_behind_them() {
        let floor = Shape::Plane { point: DVec3::ZERO, normal: DVec3::Y };
        let ball = |y: f64| Shape::Sphere { center: y * DVec3::Y, radius: 1.0 };
        assert!(
            lies_in(&ball(-1.0), &floor) && !lies_in(&ball(-0.99), &floor) && !lies_in(&ball(2.0), &floor)
        );
        let slab = Shape::Plane { point: DVec3::new(3.0, -1.0, 3.0), normal: DVec3::Y };
        assert!(lies_in(&slab, &floor) && !lies_in(&floor, &slab) && !lies_in(&floor, &ball(0.0)));
        let bowls = |y| quadric(Form::TwoSheet, DMat3::IDENTITY, y * DVec3::Y, [-2.0, 2.0]);
        assert!(lies_in(&bowls(-2.0), &floor) && !lies_in(&bowls(-1.9), &floor));
    }

    #[test]
    fn smaller_copies_about_one_centre_nest_whatever_the_form() {
        let matrix = DMat3::from_cols(
            DVec3::new(1.2, 0.3, 0.0),
            DVec3::new(-0.8, 0.6, 0.0),
            DVec3::new(0.0, 0.3, 2.0),
        );
        for (form, ends) in [
            (Form::Ellipsoid, [-END, END]),
            (Form::Ellipsoid, [-0.7, 0.7]),
            (Form::OneSheet, [-1.5, 1.5]),
            (Form::Cylinder, [-1.0, 1.0]),
        ] {
            let copy = |size: f64| quadric(form, matrix * size, DVec3::new(1.0, 2.0, 3.0), ends);
            assert!(lies_in(&copy(0.97), &copy(1.0)), "{form:?}");
            assert!(!lies_in(&copy(1.0), &copy(0.97)), "{form:?}");
        }
        // A ball in a bowl and in a cone, and a die in a ball.
        let ball = |y: f64, radius: f64| Shape::Sphere { center: y * DVec3::Y, radius };
        let bowl = quadric(Form::Paraboloid, DMat3::IDENTITY, DVec3::ZERO, [-END, 2.0]);
        assert!(lies_in(&ball(0.8, 0.7), &bowl) && !lies_in(&ball(0.2, 0.4), &bowl));
        let cone = quadric(Form::Cone, DMat3::IDENTITY, DVec3::Y, [-1.0, 0.0]);
        assert!(lies_in(&ball(0.35, 0.3), &cone) && !lies_in(&ball(0.5, 0.4), &cone));
        let world_from_object = DAffine3::from_scale(DVec3::splat(0.57));
        let object_from_world = world_from_object.inverse();
        let die = Shape::Box(Box::new(Placed { world_from_object, object_from_world }));
        assert!(lies_in(&die, &ball(0.0, 1.0)) && !lies_in(&die, &ball(0.0, 0.95)));
        assert!(lies_in(&ball(0.0, 0.57), &die) && !lies_in(&ball(0.1, 0.57), &die));
        // Two bowls within two steeper ones of the same tips, but not within larger ones.
        let bowls = |x, y| {
            quadric(Form::TwoSheet, DMat3::from_diagonal(DVec3::new(x, y, x)), DVec3::ZERO, [-2.0, 2.0])
        };
        assert!(lies_in(&bowls(0.9, 1.0), &bowls(1.0, 1.0)) && !lies_in(&bowls(1.0, 1.0), &bowls(1.1, 1.1)));
    }
}
