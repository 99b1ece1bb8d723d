//! Rough conductors: facets that are mirrors.

use super::microfacet::{distribution, masking, sample_visible, shadowing, visible_pdf};
use super::{Sample, fresnel, reflect};
use rt_lang::color::Rgb;
use rt_lang::math::DVec3;

pub(super) fn sample(color: Rgb, alpha: f64, wo: DVec3, u: [f64; 2]) -> Option<Sample> {
    let h = sample_visible(wo, alpha, u);
    let wi = reflect(wo, h);
    if wi.z <= 0.0 {
        return None;
    }
    let share = shadowing(wo, wi, alpha) / masking(wo, alpha);
    let weight = fresnel::schlick(color, wo.dot(h)) * share;
    Some(Sample { wi, weight, pdf: visible_pdf(wo, h, alpha) / (4.0 * wo.dot(h)), specular: false })
}

pub(super) fn eval(color: Rgb, alpha: f64, wo: DVec3, wi: DVec3) -> Rgb {
    if wi.z <= 0.0 {
        return Rgb::ZERO;
    }
    let h = (wo + wi).normalize();
    let density = distribution(h, alpha) * shadowing(wo, wi, alpha) / (4.0 * wo.z);
    fresnel::schlick(color, wo.dot(h)) * density
}

pub(super) fn pdf(alpha: f64, wo: DVec3, wi: DVec3) -> f64 {
    if wi.z <= 0.0 {
        return 0.0;
    }
    let h = (wo + wi).normalize();
    visible_pdf(wo, h, alpha) / (4.0 * wo.dot(h))
}
