//! Polished surfaces: one direction in, one or two out.

use super::{Sample, fresnel};
use rt_lang::color::Rgb;
use rt_lang::math::DVec3;

pub(super) fn sample_mirror(color: Rgb, wo: DVec3) -> Option<Sample> {
    Some(Sample { wi: mirrored(wo), weight: color, pdf: 1.0, specular: true })
}

pub(super) fn sample_metal(color: Rgb, wo: DVec3) -> Option<Sample> {
    Some(Sample { wi: mirrored(wo), weight: fresnel::schlick(color, wo.z), pdf: 1.0, specular: true })
}

/// Reflects or refracts, each as often as light does. Radiance over the square of the refractive index is what
/// stays the same along a ray, so what comes from the denser side is thinned.
pub(super) fn sample_dielectric(eta: f64, wo: DVec3, lobe: f64) -> Option<Sample> {
    let fresnel = fresnel::dielectric(wo.z, eta);
    if lobe < fresnel.reflectance {
        return Some(Sample { wi: mirrored(wo), weight: Rgb::ONE, pdf: fresnel.reflectance, specular: true });
    }
    let wi = DVec3::new(-wo.x / eta, -wo.y / eta, -fresnel.cosine);
    let pdf = 1.0 - fresnel.reflectance;
    (pdf > 0.0 && wi.z < 0.0).then(|| Sample {
        wi,
        weight: Rgb::splat(1.0 / (eta * eta)),
        pdf,
        specular: true,
    })
}

pub(super) fn mirrored(wo: DVec3) -> DVec3 {
    DVec3::new(-wo.x, -wo.y, wo.z)
}
