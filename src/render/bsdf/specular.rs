//! Polished surfaces: one direction in, one or two out.

use super::{Samples, fresnel};
use crate::render::lanes::{Float, Lanes, Mask};
use crate::render::vector::V;

/// A perfect mirror, or where told a conductor.
#[inline(always)]
pub(super) fn sample_mirror<L: Lanes>(l: L, color: V<L>, metal: L::M, wo: V<L>) -> Samples<L> {
    let weight = V::pick(metal, fresnel::schlick(l, color, wo.z), color);
    let all = l.mask(u32::MAX);
    Samples { some: all, wi: mirrored(wo), weight, pdf: l.f(1.0), specular: all }
}

/// Reflects or refracts, each as often as light does. Radiance over the square of the refractive index is what
/// stays the same along a ray, so what comes from the denser side is thinned.
#[inline(always)]
pub(super) fn sample_dielectric<L: Lanes>(l: L, eta: L::F, wo: V<L>, lobe: L::F) -> Samples<L> {
    let one = l.f(1.0);
    let fresnel = fresnel::dielectric(l, wo.z, eta);
    let reflects = lobe.lt(fresnel.reflectance);
    let inverse = one / eta;
    let refracted = V::new(-(wo.x * inverse), -(wo.y * inverse), -fresnel.cosine);
    Samples {
        some: reflects | l.f(0.0).lt(fresnel.cosine),
        wi: V::pick(reflects, mirrored(wo), refracted),
        weight: V::all(reflects.pick(one, inverse * inverse)),
        pdf: reflects.pick(fresnel.reflectance, one - fresnel.reflectance),
        specular: l.mask(u32::MAX),
    }
}

#[inline(always)]
pub(super) fn mirrored<L: Lanes>(wo: V<L>) -> V<L> {
    V::new(-wo.x, -wo.y, wo.z)
}
