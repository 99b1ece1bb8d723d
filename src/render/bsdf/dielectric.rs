//! Rough boundaries of dielectrics: facets that reflect and refract (Walter et al., "Microfacet models for
//! refraction through rough surfaces", 2007).

use super::microfacet::{distribution, masking, sample_visible, shadowing, visible_pdf};
use super::{Samples, fresnel, reflect};
use crate::render::lanes::{Float, Lanes, Mask};
use crate::render::vector::V;

#[inline(always)]
pub(super) fn sample<L: Lanes>(
    l: L,
    eta: L::F,
    alpha: L::F,
    wo: V<L>,
    lobe: L::F,
    u: [L::F; 2],
) -> Samples<L> {
    let (zero, one) = (l.f(0.0), l.f(1.0));
    let h = sample_visible(l, wo, alpha, u);
    let facing = wo.dot(h);
    let fresnel = fresnel::dielectric(l, facing, eta);
    let seen = visible_pdf(l, wo, h, alpha);
    let reflects = lobe.lt(fresnel.reflectance);

    let mirrored = reflect(wo, h);
    let mirrored_weight = shadowing(l, wo, mirrored, alpha) / masking(l, wo, alpha);
    let mirrored_pdf = fresnel.reflectance * seen / (facing * 4.0);

    let inverse = one / eta;
    let refracted = (h * facing - wo) * inverse - h * fresnel.cosine;
    // Radiance from the denser side is thinned: see `specular`.
    let refracted_weight = masking(l, refracted, alpha) * inverse * inverse;
    let refracted_pdf = (one - fresnel.reflectance) * seen * squeeze::<L>(eta, facing, -fresnel.cosine);

    let pdf = reflects.pick(mirrored_pdf, refracted_pdf);
    let right_side = (reflects & zero.lt(mirrored.z)) | (!reflects & refracted.z.lt(zero));
    Samples {
        some: right_side & zero.lt(pdf),
        wi: V::pick(reflects, mirrored, refracted),
        weight: V::all(reflects.pick(mirrored_weight, refracted_weight)),
        pdf,
        specular: l.mask(0),
    }
}

#[inline(always)]
pub(super) fn eval<L: Lanes>(l: L, eta: L::F, alpha: L::F, wo: V<L>, wi: V<L>) -> (L::F, L::F) {
    let (zero, one) = (l.f(0.0), l.f(1.0));
    let above = zero.lt(wi.z);
    // The facet that carries light between the two directions, towards `wo`'s side, whichever side is denser.
    let h = V::pick(above, wo + wi, -(wo + wi * eta)).normalized(l);
    let h = V::pick(h.z.lt(zero), -h, h);
    let facing = wo.dot(h);
    let behind = wi.dot(h);
    let some = zero.lt(facing) & zero.lt(behind * wi.z);
    let reflectance = fresnel::dielectric(l, facing, eta).reflectance;
    let d = distribution(l, h, alpha);
    let seen = visible_pdf(l, wo, h, alpha);

    let mirrored = reflectance * d * shadowing(l, wo, wi, alpha) / (wo.z * 4.0);
    let mirrored_pdf = reflectance * seen / (facing * 4.0);

    let through = one - reflectance;
    let squeezed = squeeze::<L>(eta, facing, behind);
    let share = through * d * masking(l, wo, alpha) * masking(l, wi, alpha);
    let refracted = share * facing / wo.z * squeezed / (eta * eta);
    let refracted_pdf = through * seen * squeezed;
    (
        some.pick(above.pick(mirrored, refracted), zero),
        some.pick(above.pick(mirrored_pdf, refracted_pdf), zero),
    )
}

/// Solid angle of facet normals for each of refracted directions (Walter's eq. 17), by the cosines of `wo` and
/// `wi` to the facet.
#[inline(always)]
fn squeeze<L: Lanes>(eta: L::F, facing: L::F, behind: L::F) -> L::F {
    let sum = facing + eta * behind;
    eta * eta * behind.magnitude() / (sum * sum)
}
