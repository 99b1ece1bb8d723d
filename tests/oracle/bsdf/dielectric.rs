//! Rough boundaries of dielectrics: facets that reflect and refract (Walter et al., "Microfacet models for
//! refraction through rough surfaces", 2007).

use super::microfacet::{distribution, masking, sample_visible, shadowing, visible_pdf};
use super::{Sample, fresnel, reflect};
use rt_lang::color::Rgb;
use rt_lang::math::DVec3;

pub(super) fn sample(eta: f64, alpha: f64, wo: DVec3, lobe: f64, u: [f64; 2]) -> Option<Sample> {
    let h = sample_visible(wo, alpha, u);
    let facing = wo.dot(h);
    let fresnel = fresnel::dielectric(facing, eta);
    let seen = visible_pdf(wo, h, alpha);
    if lobe < fresnel.reflectance {
        let wi = reflect(wo, h);
        let weight = Rgb::splat(shadowing(wo, wi, alpha) / masking(wo, alpha));
        let pdf = fresnel.reflectance * seen / (4.0 * facing);
        return (wi.z > 0.0).then_some(Sample { wi, weight, pdf, specular: false });
    }
    let wi = (h * facing - wo) / eta - h * fresnel.cosine;
    // Radiance from the denser side is thinned: see `specular`.
    let weight = Rgb::splat(masking(wi, alpha) / (eta * eta));
    let pdf = (1.0 - fresnel.reflectance) * seen * squeeze(eta, facing, -fresnel.cosine);
    (wi.z < 0.0 && pdf > 0.0).then_some(Sample { wi, weight, pdf, specular: false })
}

pub(super) fn eval(eta: f64, alpha: f64, wo: DVec3, wi: DVec3) -> f64 {
    let Some(facet) = facet(eta, wo, wi) else { return 0.0 };
    if wi.z > 0.0 {
        return facet.reflectance * distribution(facet.h, alpha) * shadowing(wo, wi, alpha) / (4.0 * wo.z);
    }
    let shadowing = masking(wo, alpha) * masking(wi, alpha);
    let share = (1.0 - facet.reflectance) * distribution(facet.h, alpha) * shadowing;
    share * facet.facing / wo.z * squeeze(eta, facet.facing, wi.dot(facet.h)) / (eta * eta)
}

pub(super) fn pdf(eta: f64, alpha: f64, wo: DVec3, wi: DVec3) -> f64 {
    let Some(facet) = facet(eta, wo, wi) else { return 0.0 };
    let seen = visible_pdf(wo, facet.h, alpha);
    if wi.z > 0.0 {
        facet.reflectance * seen / (4.0 * facet.facing)
    } else {
        (1.0 - facet.reflectance) * seen * squeeze(eta, facet.facing, wi.dot(facet.h))
    }
}

/// The facet that carries light between two directions.
struct Facet {
    h: DVec3,
    /// Cosine of `wo` to it, above 0.
    facing: f64,
    reflectance: f64,
}

fn facet(eta: f64, wo: DVec3, wi: DVec3) -> Option<Facet> {
    let h = if wi.z > 0.0 { wo + wi } else { -(wo + eta * wi) };
    // Towards `wo`'s side, whichever side is denser.
    let h = h.normalize_or_zero();
    let h = if h.z < 0.0 { -h } else { h };
    let facing = wo.dot(h);
    let right_side = facing > 0.0 && wi.dot(h) * wi.z > 0.0;
    right_side.then(|| Facet { h, facing, reflectance: fresnel::dielectric(facing, eta).reflectance })
}

/// Solid angle of facet normals for each of refracted directions (Walter's eq. 17), by the cosines of `wo` and
/// `wi` to the facet.
fn squeeze(eta: f64, facing: f64, behind: f64) -> f64 {
    let sum = facing + eta * behind;
    eta * eta * behind.abs() / (sum * sum)
}
