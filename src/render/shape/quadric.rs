//! Quadrics about an axis, cut by two planes, with or without caps.

use super::{Face, Ray, SurfacePoint};
use crate::math::DVec3;
use crate::scene::shape::{Form, Quadric};

/// Where a line is inside a quadric: between its two roots, beyond them, or one and the same all along.
#[derive(Clone, Copy)]
enum Inside {
    Between,
    Beyond,
    Always,
    Never,
}

/// Distances at which a line crosses a quadric, in order. Infinite or NaN where there is no such crossing.
#[derive(Clone, Copy)]
struct Crossings {
    near: f64,
    far: f64,
    inside: Inside,
}

impl Crossings {
    fn contains(&self, t: f64) -> bool {
        match self.inside {
            Inside::Between => self.near < t && t < self.far,
            Inside::Beyond => t < self.near || self.far < t,
            Inside::Always => true,
            Inside::Never => false,
        }
    }
}

/// The least distance above 0 and the face that is met there. The ray goes to object space with its direction
/// not made a unit vector again, so that distances stay those of the world.
///
/// Whether a crossing belongs to the side or a cap is decided by comparing distances alone: a root counts if it
/// lies within the stretch between the two planes, a plane's if it lies within the inside of the quadric. At
/// the seam exactly one of the two holds, whatever was rounded, so a ray cannot slip in between.
pub(super) fn intersect(quadric: &Quadric, ray: &Ray, start: Option<Face>) -> Option<(f64, Face)> {
    let o = quadric.object_from_world.transform_point3(ray.origin);
    let d = quadric.object_from_world.transform_vector3(ray.direction);
    let crossings = crossings(quadric.form, o, d, start == Some(Face::Side));
    let [(enter, enter_face), (leave, leave_face)] = stretch(quadric, o, d, start)?;

    let mut nearest = (f64::INFINITY, Face::Side);
    let mut consider = |t: f64, face: Face| {
        if t > 0.0 && t < nearest.0 {
            nearest = (t, face);
        }
    };
    for t in [crossings.near, crossings.far] {
        if enter <= t && t <= leave {
            consider(t, Face::Side);
        }
    }
    if quadric.capped {
        for (t, face) in [(enter, enter_face), (leave, leave_face)] {
            if crossings.contains(t) {
                consider(t, face);
            }
        }
    }
    (nearest.0 < f64::INFINITY).then_some(nearest)
}

/// Solves A t² + 2B t + C = 0 where q takes the value A t² + 2B t + C at o + t d. A start on the surface makes C
/// exactly zero.
fn crossings(form: Form, o: DVec3, d: DVec3, on_it: bool) -> Crossings {
    let (s, h) = (form.y_sign(), form.y_slope());
    let a = d.x * d.x + s * d.y * d.y + d.z * d.z;
    let b = o.x * d.x + (s * o.y + h) * d.y + o.z * d.z;
    let (first, second, c) = if on_it {
        (0.0, -2.0 * b / a, 0.0)
    } else {
        let c = form.q(o);
        // B² − AC. By Lagrange's identity its quadratic part is a form of o × d, which does not cancel for a
        // small surface far away; so is what the linear part of q adds to it.
        let m = o.cross(d);
        let linear = h * (2.0 * (d.x * m.z - d.z * m.x) + h * d.y * d.y);
        let discriminant = linear - (s * m.x * m.x + m.y * m.y + s * m.z * m.z) - a * form.constant();
        let q = -(b + discriminant.sqrt().copysign(b));
        (c / q, q / a, c)
    };
    if first.is_nan() || second.is_nan() {
        // No root at all, or a line that lies on the surface.
        let inside = if c < 0.0 { Inside::Always } else { Inside::Never };
        return Crossings { near: f64::NAN, far: f64::NAN, inside };
    }
    let (near, far) = if first < second { (first, second) } else { (second, first) };
    // A may be zero of either sign: one root is then infinite, on the side that the sign tells.
    Crossings { near, far, inside: if a.is_sign_negative() { Inside::Beyond } else { Inside::Between } }
}

/// Distances between which a line is between the quadric's two planes, each with the plane's face.
fn stretch(quadric: &Quadric, o: DVec3, d: DVec3, start: Option<Face>) -> Option<[(f64, Face); 2]> {
    if d.y == 0.0 {
        let between = quadric.low <= o.y && o.y <= quadric.high;
        return between.then_some([(f64::NEG_INFINITY, Face::Low), (f64::INFINITY, Face::High)]);
    }
    let distance = |y: f64, face: Face| if start == Some(face) { 0.0 } else { (y - o.y) / d.y };
    let low = (distance(quadric.low, Face::Low), Face::Low);
    let high = (distance(quadric.high, Face::High), Face::High);
    Some(if d.y > 0.0 { [low, high] } else { [high, low] })
}

/// The point of a face next to a point that lies on it but for rounding, with the outward normal.
pub(super) fn surface_point(quadric: &Quadric, near: DVec3, face: Face) -> SurfacePoint {
    let mut p = quadric.object_from_world.transform_point3(near);
    let gradient = match face {
        Face::Side | Face::Wall(_) | Face::Triangle(_) => {
            let slope = quadric.form.half_gradient(p);
            let squared = slope.length_squared();
            if squared.is_normal() {
                p -= quadric.form.q(p) / (2.0 * squared) * slope;
            }
            let slope = quadric.form.half_gradient(p);
            // In the apex of a cone there is no slope: it points along the axis, out of the part that is left.
            let apex = if quadric.low < 0.0 { DVec3::Y } else { DVec3::NEG_Y };
            if slope.length_squared().is_normal() { slope } else { apex }
        }
        Face::Low => {
            p.y = quadric.low;
            DVec3::NEG_Y
        }
        Face::High => {
            p.y = quadric.high;
            DVec3::Y
        }
    };
    // Normals go by the inverse transpose.
    let n = (quadric.object_from_world.matrix3.transpose() * gradient).normalize();
    SurfacePoint::new(quadric.world_from_object.transform_point3(p), n)
}
