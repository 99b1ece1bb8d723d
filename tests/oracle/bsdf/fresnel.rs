//! How much a boundary reflects.

use rt_lang::color::Rgb;

/// What a smooth boundary between dielectrics does to light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fresnel {
    /// Reflectance of unpolarised light.
    pub reflectance: f64,
    /// Cosine of the angle of refraction to the far normal; 0 under total internal reflection.
    pub cosine: f64,
}

/// Snell's law and Fresnel's equations. `cosine` is that of incidence, in [0, 1], and `eta` the index behind the
/// boundary over the one before it.
pub fn dielectric(cosine: f64, eta: f64) -> Fresnel {
    let sine_squared = (1.0 - cosine * cosine).max(0.0) / (eta * eta);
    if sine_squared >= 1.0 {
        return Fresnel { reflectance: 1.0, cosine: 0.0 };
    }
    let refracted = (1.0 - sine_squared).sqrt();
    let parallel = (eta * cosine - refracted) / (eta * cosine + refracted);
    let perpendicular = (cosine - eta * refracted) / (cosine + eta * refracted);
    Fresnel { reflectance: 0.5 * (parallel * parallel + perpendicular * perpendicular), cosine: refracted }
}

/// Schlick's approximation for a conductor, by its reflectance at normal incidence ("An inexpensive BRDF model
/// for physically-based rendering", 1994, eq. 15).
pub fn schlick(color: Rgb, cosine: f64) -> Rgb {
    let m = (1.0 - cosine).clamp(0.0, 1.0);
    let squared = m * m;
    color + (Rgb::ONE - color) * (squared * squared * m)
}
