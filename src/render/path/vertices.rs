//! Where paths meet surfaces that scatter.

use super::LEAST_COSINE;
use crate::math::DVec3;
use crate::render::Tracer;
use crate::render::lanes::{Float, Lanes, Mask};
use crate::render::shape::{Hits, Points};
use crate::render::space::double;
use crate::render::vector::{V, basis};

/// A vertex with its local frame.
///
/// Scattering is that of the shading normal, and which side a direction is on is told by the surface's own: what the
/// two disagree about is black, so that no light leaks through a smooth mesh (Veach 1997, §5.3.2).
pub struct Vertices<L: Lanes> {
    pub place: L::U,
    pub detail: L::U,
    pub p: V<L>,
    x: V<L>,
    y: V<L>,
    /// The normal to shade with, on the side that the path comes from.
    pub z: V<L>,
    /// The normal of the surface itself, on that side.
    pub rim: V<L>,
    pub wo: V<L>,
    /// Whether the path comes from outside.
    pub entering: L::M,
}

impl<L: Lanes> Vertices<L> {
    #[inline(always)]
    pub fn new(l: L, points: &Points<L>, hits: &Hits<L>, entering: L::M, d: V<L>) -> Vertices<L> {
        let z = V::pick(entering, points.shading, -points.shading);
        let rim = V::pick(entering, points.n, -points.n);
        let (x, y) = basis(l, z);
        let Hits { place, detail, .. } = *hits;
        let mut vertices = Vertices { place, detail, p: points.p, x, y, z, rim, wo: d, entering };
        vertices.wo = vertices.local(-d);
        vertices.wo.z = vertices.wo.z.greater(l.f(LEAST_COSINE));
        vertices
    }

    #[inline(always)]
    pub fn local(&self, w: V<L>) -> V<L> {
        V::new(w.dot(self.x), w.dot(self.y), w.dot(self.z))
    }

    /// Whether directions of the world are on the side of the surface that they are on of the shading normal.
    #[inline(always)]
    pub fn agree(&self, l: L, tracer: &Tracer, local: V<L>, w: V<L>) -> L::M {
        if !tracer.surfaces.any_smooth() {
            return l.mask(u32::MAX);
        }
        let zero = l.f(0.0);
        let (above, outside) = (zero.lt(local.z), zero.lt(self.rim.dot(w)));
        (above & outside) | (!above & !outside)
    }

    /// Where they lie.
    #[inline]
    pub fn hits(&self, l: L) -> Hits<L> {
        Hits { t: l.f(0.0), place: self.place, detail: self.detail }
    }

    /// The outward normal of a surface in the world.
    #[inline]
    pub fn outward(&self, lane: usize) -> DVec3 {
        let side = if self.entering.bits() >> lane & 1 == 1 { 1.0 } else { -1.0 };
        side * double(self.rim, lane)
    }

    #[inline(always)]
    pub fn world(&self, w: V<L>) -> V<L> {
        self.x * w.x + self.y * w.y + self.z * w.z
    }
}
