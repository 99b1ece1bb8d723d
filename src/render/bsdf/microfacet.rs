//! The GGX distribution of microfacet normals with Smith's shadowing.
//!
//! Formulas from Eric Heitz, "Understanding the masking-shadowing function in microfacet-based BRDFs", JCGT
//! 2014, and "Sampling the GGX distribution of visible normals", JCGT 2018.

use crate::render::lanes::{Float, Lanes, Mask};
use crate::render::vector::V;
use crate::render::warp;
use std::f32::consts::FRAC_1_PI;

/// Density of facet normals `h` on the surface: the integral of D(h) h.z over the hemisphere is 1.
#[inline(always)]
pub(super) fn distribution<L: Lanes>(l: L, h: V<L>, alpha: L::F) -> L::F {
    let squared = alpha * alpha;
    let stretched = h.x * h.x + h.y * h.y + squared * h.z * h.z;
    // Divided one by one: the square of what is stretched may be below the least number.
    let density = squared / stretched / stretched * FRAC_1_PI;
    l.f(0.0).lt(h.z).pick(density, l.f(0.0))
}

/// Smith's Λ: hidden over visible facet area, as seen from `w`.
#[inline(always)]
fn lambda<L: Lanes>(l: L, w: V<L>, alpha: L::F) -> L::F {
    let tangent_squared = (w.x * w.x + w.y * w.y) / (w.z * w.z);
    ((alpha * alpha * tangent_squared + 1.0).root() - l.f(1.0)) * 0.5
}

/// The share of facets that is seen from `w`.
#[inline(always)]
pub(super) fn masking<L: Lanes>(l: L, w: V<L>, alpha: L::F) -> L::F {
    l.f(1.0) / (lambda(l, w, alpha) + 1.0)
}

/// The share of facets seen from both directions on one side, heights correlated.
#[inline(always)]
pub(super) fn shadowing<L: Lanes>(l: L, wo: V<L>, wi: V<L>, alpha: L::F) -> L::F {
    l.f(1.0) / (lambda(l, wo, alpha) + lambda(l, wi, alpha) + 1.0)
}

/// A facet normal among those that `wo` sees, with density [`visible_pdf`].
#[inline(always)]
pub(super) fn sample_visible<L: Lanes>(l: L, wo: V<L>, alpha: L::F, u: [L::F; 2]) -> V<L> {
    let (zero, one) = (l.f(0.0), l.f(1.0));
    // Stretch the view so that the surface becomes a hemisphere, and draw from its projection.
    let v = V::<L>::new(alpha * wo.x, alpha * wo.y, wo.z).normalized(l);
    let length_squared = v.x * v.x + v.y * v.y;
    let inverse = one / length_squared.root();
    let upright = length_squared.le(zero);
    let t1 = V::pick(upright, V::splat(l, [1.0, 0.0, 0.0]), V::new(-v.y * inverse, v.x * inverse, zero));
    let t2 = v.cross(t1);
    let [p1, across] = warp::disc(l, u);
    let s = (v.z + 1.0) * 0.5;
    let p2 = (one - s) * (one - p1 * p1).greater(zero).root() + s * across;
    let p3 = (one - p1 * p1 - p2 * p2).greater(zero).root();
    let h = t1 * p1 + t2 * p2 + v * p3;
    V::new(alpha * h.x, alpha * h.y, h.z.greater(zero)).normalized(l)
}

/// Density of [`sample_visible`] in solid angle of `h`.
#[inline(always)]
pub(super) fn visible_pdf<L: Lanes>(l: L, wo: V<L>, h: V<L>, alpha: L::F) -> L::F {
    masking(l, wo, alpha) * wo.dot(h).greater(l.f(0.0)) * distribution(l, h, alpha) / wo.z
}
