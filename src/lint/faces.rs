//! Points of surfaces, and the flat parts of them.

use crate::math::{DVec3, PI, cos, sin};
use crate::scene::Shape;
use crate::scene::shape::{Bounds, Placed, Quadric};

/// Points on a sphere.
const ON_SPHERE: u32 = 256;
/// Heights and angles of points on the side of a quadric.
const HEIGHTS: u32 = 16;
const ANGLES: u32 = 16;

/// Points that stand for a surface with bounds: spread over it, its ends among them.
pub(super) fn points(shape: &Shape) -> Vec<DVec3> {
    match shape {
        Shape::Sphere { center, radius } => (0..ON_SPHERE).map(|i| *center + *radius * spiral(i)).collect(),
        Shape::Plane { .. } => vec![],
        Shape::Mesh(instance) => {
            let count = instance.mesh.len() as u32;
            let step = count.div_ceil(ON_SPHERE).max(1) as usize;
            let corner = |i| instance.placed.world_from_object.transform_point3(instance.mesh.corners(i)[0]);
            (0..count).step_by(step).map(corner).collect()
        }
        Shape::Disk(_) | Shape::Box(_) => flats(shape).iter().flat_map(|flat| flat.points()).collect(),
        Shape::Quadric(quadric) => {
            let mut points = side_points(quadric);
            points.extend(flats(shape).iter().flat_map(|flat| flat.points()));
            points
        }
    }
}

/// The i-th of [`ON_SPHERE`] points of the unit sphere on a spiral of equal steps in height, turned by the golden
/// angle each (Swinbank and Purser, "Fibonacci grids", 2006).
fn spiral(i: u32) -> DVec3 {
    let golden = PI * (3.0 - 5.0f64.sqrt());
    let y = (2.0 * f64::from(i) + 1.0) / f64::from(ON_SPHERE) - 1.0;
    let radius = (1.0 - y * y).sqrt();
    let angle = golden * f64::from(i);
    DVec3::new(radius * cos(angle), y, radius * sin(angle))
}

fn side_points(quadric: &Quadric) -> Vec<DVec3> {
    let bounded = |[low, high]: &[f64; 2]| low < high && low.is_finite() && high.is_finite();
    let mut points = vec![];
    for [low, high] in quadric.stretches().into_iter().filter(bounded) {
        for i in 0..=HEIGHTS {
            let y = low + (high - low) * f64::from(i) / f64::from(HEIGHTS);
            for j in 0..ANGLES {
                let angle = 2.0 * PI * f64::from(j) / f64::from(ANGLES);
                points.push(quadric.world_from_object.transform_point3(quadric.side_point(y, angle)));
            }
        }
    }
    points
}

/// A flat part of a surface: the points `center` + a `u` + b `v`.
pub(super) struct Flat {
    pub(super) outline: Outline,
    pub(super) center: DVec3,
    pub(super) u: DVec3,
    pub(super) v: DVec3,
    /// Unit vector out of the solid, where there is one.
    pub(super) normal: DVec3,
}

/// Which a and b belong to a flat part.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Outline {
    /// All.
    Endless,
    /// a² + b² ≤ 1.
    Ellipse,
    /// |a| ≤ 1 and |b| ≤ 1.
    Parallelogram,
}

/// The flat parts of a shape.
pub(super) fn flats(shape: &Shape) -> Vec<Flat> {
    match shape {
        Shape::Sphere { .. } | Shape::Mesh(_) => vec![],
        Shape::Plane { point, normal } => {
            let (u, v) = crate::math::basis(*normal);
            vec![Flat { outline: Outline::Endless, center: *point, u, v, normal: *normal }]
        }
        Shape::Quadric(quadric) => caps(quadric),
        Shape::Disk(placed) => {
            let map = placed.world_from_object;
            let [u, v] = [map.matrix3.x_axis, map.matrix3.z_axis];
            let normal = placed.normal(DVec3::Y);
            vec![Flat { outline: Outline::Ellipse, center: map.translation, u, v, normal }]
        }
        Shape::Box(placed) => sides(placed),
    }
}

fn sides(placed: &Placed) -> Vec<Flat> {
    let m = placed.world_from_object.matrix3;
    let axes =
        [(DVec3::X, m.y_axis, m.z_axis), (DVec3::Y, m.z_axis, m.x_axis), (DVec3::Z, m.x_axis, m.y_axis)];
    let side = |(axis, u, v): (DVec3, DVec3, DVec3)| Flat {
        outline: Outline::Parallelogram,
        center: placed.world_from_object.transform_point3(axis),
        u,
        v,
        normal: placed.normal(axis),
    };
    axes.into_iter().flat_map(|(axis, u, v)| [side((axis, u, v)), side((-axis, u, v))]).collect()
}

fn caps(quadric: &Quadric) -> Vec<Flat> {
    let map = quadric.world_from_object;
    let out = (quadric.object_from_world.matrix3.transpose() * DVec3::Y).normalize_or_zero();
    let cap = |(y, side): (f64, f64)| {
        let radius_squared = quadric.form.radius_squared(y);
        (quadric.capped && y.is_finite() && radius_squared > 0.0).then(|| Flat {
            outline: Outline::Ellipse,
            center: map.transform_point3(y * DVec3::Y),
            u: radius_squared.sqrt() * map.matrix3.x_axis,
            v: radius_squared.sqrt() * map.matrix3.z_axis,
            normal: side * out,
        })
    };
    [(quadric.low, -1.0), (quadric.high, 1.0)].into_iter().filter_map(cap).collect()
}

/// Steps from the middle of a flat part to its rim.
const STEPS: i32 = 4;
/// How near to the rim, as a share, a point still counts as within: parts that touch do not overlap.
const RIM: f64 = 1e-6;

impl Flat {
    pub(super) fn bounds(&self) -> Option<Bounds> {
        match self.outline {
            Outline::Endless => None,
            Outline::Ellipse | Outline::Parallelogram => {
                let half = self.u.abs() + self.v.abs();
                Some(Bounds { min: self.center - half, max: self.center + half })
            }
        }
    }

    /// Points spread over it, up to nearly its rim; of an endless one there are none.
    fn points(&self) -> Vec<DVec3> {
        let steps = || (-STEPS..=STEPS).map(|i| (1.0 - 2.0 * RIM) * f64::from(i) / f64::from(STEPS));
        let grid = steps().flat_map(|a| steps().map(move |b| [a, b]));
        grid.filter(|ab| self.holds(*ab)).map(|[a, b]| self.center + a * self.u + b * self.v).collect()
    }

    fn holds(&self, [a, b]: [f64; 2]) -> bool {
        match self.outline {
            Outline::Endless => false,
            Outline::Ellipse => a * a + b * b < 1.0 - RIM,
            Outline::Parallelogram => a.abs().max(b.abs()) < 1.0 - RIM,
        }
    }

    /// Whether a point of its plane lies in it.
    fn contains(&self, p: DVec3) -> bool {
        let (d, u, v) = (p - self.center, self.u, self.v);
        let (uu, uv, vv) = (u.dot(u), u.dot(v), v.dot(v));
        let (du, dv) = (d.dot(u), d.dot(v));
        let determinant = uu * vv - uv * uv;
        let ab = [(du * vv - dv * uv) / determinant, (dv * uu - du * uv) / determinant];
        self.outline == Outline::Endless || self.holds(ab)
    }

    /// Whether two parts of one plane have more in common than a rim: whether one holds one of the points that stand
    /// for the other, so that two slivers may cross unseen.
    pub(super) fn overlaps(&self, other: &Flat) -> bool {
        if self.outline == Outline::Endless && other.outline == Outline::Endless {
            return true;
        }
        self.points().iter().any(|p| other.contains(*p)) || other.points().iter().any(|p| self.contains(*p))
    }
}
