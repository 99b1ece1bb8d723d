//! Quadrics: ellipsoids and hyperboloids, cut by two planes, with or without caps.

use super::{Face, Nature, Points, ROUNDING, Rays, place};
use crate::render::lanes::{Float, Lanes, Mask, One, Word};
use crate::render::space::Space;
use crate::render::vector::{V, single};
use crate::scene::shape;

/// A quadric as seen from the origin.
#[derive(Clone, Copy, Debug)]
pub struct Quadric {
    /// Rows of the map to object space.
    pub rows: [[f32; 3]; 3],
    /// What that map takes to the origin of object space.
    pub middle: [f32; 3],
    /// The factor of y² in q.
    pub sign: f32,
    /// Half the factor of y in q.
    pub slope: f32,
    /// The constant in q.
    pub constant: f32,
    /// Ends in object space's y.
    pub ends: [f32; 2],
    /// Heights that lie certainly between the ends, whatever was rounded.
    pub within: [f32; 2],
    /// Whether finite ends are closed by caps.
    pub capped: bool,
    /// 1 if rays are looked at from where they are next to the middle, 0 if from their start.
    pub near: f32,
    /// Whether it glows.
    pub glows: bool,
}

impl Quadric {
    /// The quadric in the coordinates of the tracer.
    pub fn new(quadric: &shape::Quadric, space: &Space, nature: Nature) -> Quadric {
        let m = quadric.object_from_world.matrix3 * space.unit();
        let (low, high) = (quadric.low as f32, quadric.high as f32);
        let margin = |end: f32| if end.is_finite() { end.abs().max(1.0) * ROUNDING } else { 0.0 };
        let bounded = shape::Shape::Quadric(Box::new(*quadric)).bounds().is_some();
        Quadric {
            rows: [0, 1, 2].map(|i| single(m.row(i))),
            middle: single(space.point(quadric.world_from_object.translation)),
            sign: quadric.form.y_sign() as f32,
            slope: quadric.form.y_slope() as f32,
            constant: quadric.form.constant() as f32,
            ends: [low, high],
            within: [low + margin(low), high - margin(high)],
            capped: quadric.capped,
            near: f32::from(u8::from(bounded)),
            glows: nature.glows,
        }
    }

    #[inline(always)]
    fn object<L: Lanes>(&self, l: L, v: V<L>) -> V<L> {
        let [x, y, z] = self.rows;
        V::new(V::splat(l, x).dot(v), V::splat(l, y).dot(v), V::splat(l, z).dot(v))
    }

    /// The least distance above 0, not above 0 or no number if there is none, and the face that is met there. The
    /// ray goes to object space with its direction not made a unit vector again, so that distances stay those of
    /// the world.
    ///
    /// Whether a crossing belongs to the side or a cap is decided by comparing distances alone: a root counts if it
    /// lies within the stretch between the two planes, a plane's if it lies within the inside of the quadric. At
    /// the seam exactly one of the two holds, whatever was rounded, so a ray cannot slip in between. A ray that starts
    /// next to the seam starts inside of the face that it is not on.
    #[inline(always)]
    pub fn meet<L: Lanes>(&self, l: L, rays: &Rays<L>, slot: u32) -> (L::F, L::U) {
        let none = l.f(f32::INFINITY);
        let zero = l.f(0.0);
        let on_face = |face: Face| rays.start.is(l.u(place(slot, face)));
        let (on_side, on_low, on_high) = (on_face(Face::Side), on_face(Face::Low), on_face(Face::High));
        let on_it = on_side | on_low | on_high;
        let from = rays.o - V::splat(l, self.middle);
        let shift = on_it.pick(zero, -(from.dot(rays.d) * self.near));
        let o = self.object(l, from + rays.d * shift);
        let d = self.object(l, rays.d);

        // A t² + 2B t + C = 0, where q takes the value A t² + 2B t + C at o + t d. By Lagrange's identity the
        // quadratic part of B² − AC is a form of o × d, which does not cancel for a small surface far away; so is what
        // the linear part of q adds to it.
        let (s, h) = (self.sign, self.slope);
        let a = d.x * d.x + d.y * d.y * s + d.z * d.z;
        let b = o.x * d.x + (o.y * s + h) * d.y + o.z * d.z;
        let across = o.x * o.x + o.z * o.z;
        let c = on_side.pick(zero, across + (o.y * s + 2.0 * h) * o.y + self.constant);
        let m = o.cross(d);
        let linear = ((d.x * m.z - d.z * m.x) * 2.0 + d.y * d.y * h) * h;
        let discriminant = linear - (m.x * m.x * s + m.y * m.y + m.z * m.z * s) - a * self.constant;
        let root = on_side.pick(b.magnitude(), discriminant.root());
        // A start on a cap is inside of the side.
        let inner = -(across * ROUNDING);
        let on_rim = (on_low | on_high) & inner.lt(c);
        let c = on_rim.pick(inner, c);
        let root = on_rim.pick((b * b - a * inner).root(), root);
        let q = -(b + root.signed_as(b));
        let (first, second) = (c / q, q / a);
        let crosses = first.le(first) & second.le(second);
        let (near, far) = (first.lesser(second), first.greater(second));
        // A may be zero of either sign: one root is then infinite, on the side that the sign tells.
        let beyond = l.f(1.0).signed_as(a).lt(zero);
        let all_inside = !crosses & c.lt(zero);

        // Where the line is between the two planes.
        let [lowest, highest] = self.within;
        let y = on_side.pick(o.y.greater(l.f(lowest)).lesser(l.f(highest)), o.y);
        let level = d.y.le(zero) & zero.le(d.y);
        let between = l.f(self.ends[0]).le(y) & y.le(l.f(self.ends[1]));
        let low = on_low.pick(-shift, (l.f(self.ends[0]) - y) / d.y);
        let high = on_high.pick(-shift, (l.f(self.ends[1]) - y) / d.y);
        let upwards = zero.lt(d.y);
        let nothing = level & !between;
        let enter = level.pick(nothing.pick(none, -none), upwards.pick(low, high));
        let leave = level.pick(none, upwards.pick(high, low));

        let side = l.u(place(slot, Face::Side));
        let within = enter.le(near) & near.le(leave) & crosses;
        let best = nearer(l, (none, side), near + shift, within, side);
        let within = enter.le(far) & far.le(leave) & crosses;
        let best = nearer(l, best, far + shift, within, side);
        if !self.capped {
            return best;
        }
        let (low_face, high_face) = (l.u(place(slot, Face::Low)), l.u(place(slot, Face::High)));
        let inside = Inside::<L> { near, far, crosses, beyond, always: all_inside };
        let best =
            nearer(l, best, enter + shift, inside.holds(enter), upwards.pick_word(low_face, high_face));
        nearer(l, best, leave + shift, inside.holds(leave), upwards.pick_word(high_face, low_face))
    }

    /// How the unit normal of a point changes with small steps along a face. The gradient is linear in the place, so its
    /// change is exact; then its length is made 1 again.
    pub fn bend(&self, point: &Points<One>, face: Face, steps: [V<One>; 2]) -> [V<One>; 2] {
        if face != Face::Side {
            return [V::all(0.0); 2];
        }
        let [x, y, z] = self.rows;
        let (x, y, z) = (V::splat(One, x), V::splat(One, y), V::splat(One, z));
        let world = |o: V<One>| x * o.x + y * o.y + z * o.z;
        let o = self.object(One, point.p - V::splat(One, self.middle));
        let length = world(V::new(o.x, o.y * self.sign + self.slope, o.z)).squared().sqrt();
        let bend = |step| {
            let o = self.object(One, step);
            let change = world(V::new(o.x, o.y * self.sign, o.z));
            (change - point.n * point.n.dot(change)) * (1.0 / length)
        };
        [bend(steps[0]), bend(steps[1])]
    }

    /// The point of a face next to a point that lies on it but for rounding, with the outward normal.
    #[inline(always)]
    pub fn point<L: Lanes>(&self, l: L, near: V<L>, face: Face) -> Points<L> {
        let o = self.object(l, near - V::splat(l, self.middle));
        let [x, y, z] = self.rows;
        let (x, y, z) = (V::splat(l, x), V::splat(l, y), V::splat(l, z));
        let (off, slope) = match face {
            Face::Side => {
                let half = V::<L>::new(o.x, o.y * self.sign + self.slope, o.z);
                let q = half.dot(o) + o.y * self.slope + self.constant;
                (q * 0.5, x * half.x + y * half.y + z * half.z)
            }
            Face::Low => (-(o.y - self.ends[0]), -y),
            _ => (o.y - self.ends[1], y),
        };
        let squared = slope.squared();
        // The normal of the side changes by too little over so small a step.
        let n = slope * (l.f(1.0) / squared.root());
        Points { p: near - slope * (off / squared), n, shading: n }
    }
}

/// Where a line is inside a quadric: between its two roots, beyond them, or one and the same all along.
struct Inside<L: Lanes> {
    near: L::F,
    far: L::F,
    crosses: L::M,
    beyond: L::M,
    always: L::M,
}

impl<L: Lanes> Inside<L> {
    #[inline(always)]
    fn holds(&self, t: L::F) -> L::M {
        let within = self.near.lt(t) & t.lt(self.far) & !self.beyond;
        let without = (t.lt(self.near) | self.far.lt(t)) & self.beyond;
        ((within | without) & self.crosses) | self.always
    }
}

/// The nearer of what is met already and what is met here, if that counts and lies ahead.
#[inline(always)]
fn nearer<L: Lanes>(l: L, best: (L::F, L::U), t: L::F, counts: L::M, face: L::U) -> (L::F, L::U) {
    let nearer = counts & l.f(0.0).lt(t) & t.lt(best.0);
    (nearer.pick(t, best.0), nearer.pick_word(face, best.1))
}
