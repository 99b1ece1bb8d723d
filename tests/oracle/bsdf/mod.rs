//! How surfaces scatter light.
//!
//! Directions are unit vectors away from the surface in its local frame, whose z axis is the normal on the side
//! that `wo` (towards the camera) lies on: `wo.z` > 0 always, and `wi.z` < 0 is transmission.

mod dielectric;
mod diffuse;
pub mod fresnel;
mod metal;
mod microfacet;
mod plastic;
mod specular;

pub use plastic::Coat;
use rt_lang::color::Rgb;
use rt_lang::math::DVec3;

/// Widths below this are polished: the reflection of a point is narrower than a thousandth of a degree.
pub const SMOOTH_ALPHA: f64 = 1e-5;

/// A material at a point, ready to be asked.
#[derive(Clone, Copy)]
pub enum Bsdf<'a> {
    /// Lambertian, of this reflectance.
    Diffuse(Rgb),
    /// A perfect mirror of this reflectance.
    Mirror(Rgb),
    /// The boundary of a dielectric.
    Dielectric {
        /// Refractive index on the far side over that on the side of `wo`.
        eta: f64,
        /// GGX α.
        alpha: f64,
    },
    /// A conductor.
    Metal {
        /// Reflectance at normal incidence.
        color: Rgb,
        /// GGX α.
        alpha: f64,
    },
    /// A coat over a Lambertian base.
    Plastic {
        /// Reflectance of the base.
        color: Rgb,
        /// What the coat does.
        coat: &'a Coat,
    },
}

/// A direction that light is scattered from.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Where it comes from.
    pub wi: DVec3,
    /// The BSDF times |cos| of `wi`, divided by the density: what the throughput is multiplied with.
    pub weight: Rgb,
    /// Density in solid angle; for a specular direction the probability to have chosen it.
    pub pdf: f64,
    /// Whether only this very direction reflects or refracts into `wo`.
    pub specular: bool,
}

impl Bsdf<'_> {
    /// Draws a direction. `lobe` chooses between lobes, `u` within one.
    pub fn sample(&self, wo: DVec3, lobe: f64, u: [f64; 2]) -> Option<Sample> {
        match *self {
            Bsdf::Diffuse(color) => diffuse::sample(color, u),
            Bsdf::Mirror(color) => specular::sample_mirror(color, wo),
            Bsdf::Dielectric { eta, alpha } if alpha < SMOOTH_ALPHA => {
                specular::sample_dielectric(eta, wo, lobe)
            }
            Bsdf::Dielectric { eta, alpha } => dielectric::sample(eta, alpha, wo, lobe, u),
            Bsdf::Metal { color, alpha } if alpha < SMOOTH_ALPHA => specular::sample_metal(color, wo),
            Bsdf::Metal { color, alpha } => metal::sample(color, alpha, wo, u),
            Bsdf::Plastic { color, coat } => plastic::sample(color, coat, wo, lobe, u),
        }
    }

    /// The BSDF times |cos| of `wi`, without specular directions.
    pub fn eval(&self, wo: DVec3, wi: DVec3) -> Rgb {
        match *self {
            Bsdf::Diffuse(color) => diffuse::eval(color, wi),
            Bsdf::Mirror(_) => Rgb::ZERO,
            Bsdf::Dielectric { alpha, .. } | Bsdf::Metal { alpha, .. } if alpha < SMOOTH_ALPHA => Rgb::ZERO,
            Bsdf::Dielectric { eta, alpha } => Rgb::splat(dielectric::eval(eta, alpha, wo, wi)),
            Bsdf::Metal { color, alpha } => metal::eval(color, alpha, wo, wi),
            Bsdf::Plastic { color, coat } => plastic::eval(color, coat, wo, wi),
        }
    }

    /// Density with which [`Bsdf::sample`] draws `wi`, without specular directions.
    pub fn pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        match *self {
            Bsdf::Diffuse(_) => diffuse::pdf(wi),
            Bsdf::Mirror(_) => 0.0,
            Bsdf::Dielectric { alpha, .. } | Bsdf::Metal { alpha, .. } if alpha < SMOOTH_ALPHA => 0.0,
            Bsdf::Dielectric { eta, alpha } => dielectric::pdf(eta, alpha, wo, wi),
            Bsdf::Metal { alpha, .. } => metal::pdf(alpha, wo, wi),
            Bsdf::Plastic { color, coat } => plastic::pdf(color, coat, wo, wi),
        }
    }

    /// Whether every direction is specular, so that sampling lights is in vain.
    pub fn is_specular(&self) -> bool {
        match *self {
            Bsdf::Mirror(_) => true,
            Bsdf::Dielectric { alpha, .. } | Bsdf::Metal { alpha, .. } => alpha < SMOOTH_ALPHA,
            Bsdf::Diffuse(_) | Bsdf::Plastic { .. } => false,
        }
    }

    /// Whether light may come through from behind.
    pub fn transmits(&self) -> bool {
        matches!(self, Bsdf::Dielectric { .. })
    }
}

/// `w` mirrored about the half vector `h`.
fn reflect(w: DVec3, h: DVec3) -> DVec3 {
    2.0 * w.dot(h) * h - w
}
