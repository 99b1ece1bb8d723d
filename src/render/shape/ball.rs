//! Spheres that are not giant.

use super::{Bundle, Nature, Ratios, first_ahead};
use crate::math::DVec3;
use crate::render::lanes::{Float, Lanes, Mask, Word};
use crate::render::vector::{V, single};

/// A sphere as seen from the origin.
#[derive(Clone, Copy, Debug)]
pub struct Ball {
    /// Centre.
    pub center: [f32; 3],
    /// Radius.
    pub radius: f32,
    /// Whether it glows.
    pub glows: bool,
}

impl Ball {
    /// The sphere about a centre.
    pub fn new(center: DVec3, radius: f64, nature: Nature) -> Ball {
        Ball { center: single(center), radius: radius as f32, glows: nature.glows }
    }

    /// The least distance above 0.
    #[inline(always)]
    pub fn meet<L: Lanes>(&self, l: L, bundle: &Bundle<L>, place: u32) -> Ratios<L> {
        let o = bundle.rays.o - V::splat(l, self.center);
        meet(l, o, bundle.rays.d, l.f(self.radius), bundle.rays.start.is(l.u(place)))
    }
}

/// As [`Ball::meet`], for a ray relative to the centre that starts on the sphere or does not: with b = o·d it solves
/// t² + 2bt + o·o − r² = 0; the discriminant is taken from the offset of the ray from the centre.
#[inline(always)]
pub fn meet<L: Lanes>(l: L, o: V<L>, d: V<L>, radius: L::F, on_it: L::M) -> Ratios<L> {
    let b = o.dot(d);
    let offset = o - d * b;
    let squared = radius * radius;
    let root = (squared - offset.squared()).root();
    let c = on_it.pick(l.f(0.0), o.squared() - squared);
    first_ahead(l, b, c, on_it.pick(b.magnitude(), root), l.f(1.0))
}
