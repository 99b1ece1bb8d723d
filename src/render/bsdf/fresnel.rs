//! How much a boundary reflects.

use crate::render::lanes::{Float, Lanes, Mask};
use crate::render::vector::V;

/// What a smooth boundary between dielectrics does to light.
#[derive(Clone, Copy)]
pub struct Fresnel<L: Lanes> {
    /// Reflectance of unpolarised light.
    pub reflectance: L::F,
    /// Cosine of the angle of refraction to the far normal; 0 under total internal reflection.
    pub cosine: L::F,
}

/// Snell's law and Fresnel's equations. `cosine` is that of incidence, in [0, 1], and `eta` the index behind the
/// boundary over the one before it.
#[inline(always)]
pub fn dielectric<L: Lanes>(l: L, cosine: L::F, eta: L::F) -> Fresnel<L> {
    let one = l.f(1.0);
    let sine_squared = (one - cosine * cosine).greater(l.f(0.0)) / (eta * eta);
    let total = one.le(sine_squared);
    let refracted = (one - sine_squared).greater(l.f(0.0)).root();
    let parallel = (eta * cosine - refracted) / (eta * cosine + refracted);
    let perpendicular = (cosine - eta * refracted) / (cosine + eta * refracted);
    let reflectance = (parallel * parallel + perpendicular * perpendicular) * 0.5;
    Fresnel { reflectance: total.pick(one, reflectance), cosine: total.pick(l.f(0.0), refracted) }
}

/// Schlick's approximation for a conductor, by its reflectance at normal incidence ("An inexpensive BRDF model
/// for physically-based rendering", 1994, eq. 15).
#[inline(always)]
pub fn schlick<L: Lanes>(l: L, color: V<L>, cosine: L::F) -> V<L> {
    let m = (l.f(1.0) - cosine).greater(l.f(0.0)).lesser(l.f(1.0));
    let squared = m * m;
    color + (V::all(l.f(1.0)) - color) * (squared * squared * m)
}
