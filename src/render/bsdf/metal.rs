//! Conductors: facets that reflect by Schlick's approximation.

use super::microfacet::{distribution, masking, sample_visible, shadowing, visible_pdf};
use super::{Samples, fresnel, reflect};
use crate::render::lanes::{Float, Lanes, Mask};
use crate::render::vector::V;

#[inline(always)]
pub(super) fn sample<L: Lanes>(l: L, color: V<L>, alpha: L::F, wo: V<L>, u: [L::F; 2]) -> Samples<L> {
    let h = sample_visible(l, wo, alpha, u);
    let wi = reflect(wo, h);
    let facing = wo.dot(h);
    let share = shadowing(l, wo, wi, alpha) / masking(l, wo, alpha);
    Samples {
        some: l.f(0.0).lt(wi.z),
        wi,
        weight: fresnel::schlick(l, color, facing) * share,
        pdf: visible_pdf(l, wo, h, alpha) / (facing * 4.0),
        specular: l.mask(0),
    }
}

#[inline(always)]
pub(super) fn eval<L: Lanes>(l: L, color: V<L>, alpha: L::F, wo: V<L>, wi: V<L>) -> (V<L>, L::F) {
    let zero = l.f(0.0);
    let above = zero.lt(wi.z);
    let h = (wo + wi).normalized(l);
    let facing = wo.dot(h);
    let density = distribution(l, h, alpha) * shadowing(l, wo, wi, alpha) / (wo.z * 4.0);
    let pdf = visible_pdf(l, wo, h, alpha) / (facing * 4.0);
    let value = fresnel::schlick(l, color, facing) * above.pick(density, zero);
    (V::pick(above, value, V::all(zero)), above.pick(pdf, zero))
}
