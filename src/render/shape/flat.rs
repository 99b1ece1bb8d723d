//! Planes.

use super::{Bundle, Nature, ROUNDING, Ratios, lifted};
use crate::math::DVec3;
use crate::render::lanes::{Float, Lanes, Mask, Word};
use crate::render::vector::{V, single};

/// A plane as seen from the origin.
#[derive(Clone, Copy, Debug)]
pub struct Flat {
    /// Unit vector out of the solid half-space.
    pub n: [f32; 3],
    /// Height of the origin over it.
    pub height: f32,
    /// Rounding of heights over it, and how much of a ray's counts: 0 where light may come from below.
    pub slop: [f32; 2],
    /// Whether it glows.
    pub glows: bool,
}

impl Flat {
    /// The plane through a point.
    pub fn new(point: DVec3, normal: DVec3, nature: Nature) -> Flat {
        let height = -normal.dot(point);
        let own = if nature.opaque { height.abs() as f32 * ROUNDING } else { 0.0 };
        Flat {
            n: single(normal),
            height: height as f32,
            slop: [own, f32::from(u8::from(nature.opaque))],
            glows: nature.glows,
        }
    }

    /// The distance. A ray that starts on a plane does not meet it again.
    #[inline(always)]
    pub fn meet<L: Lanes>(&self, l: L, bundle: &Bundle<L>, place: u32) -> Ratios<L> {
        let n = V::splat(l, self.n);
        let height = n.dot(bundle.rays.o) + self.height;
        let height = lifted(l, height, bundle.slop * self.slop[1] + self.slop[0]);
        let height = bundle.rays.start.is(l.u(place)).pick(l.f(0.0), height);
        let slope = n.dot(bundle.rays.d);
        // Towards it, on either side.
        let over = height.signed_as(-(height * slope));
        Ratios { over, under: slope.magnitude() }
    }
}
