//! From the unit square to directions and discs, each with its density.

use super::functions::sin_cos_eighth;
use super::lanes::{Float, Lanes, Mask};
use super::vector::V;
use std::f32::consts::{FRAC_1_PI, FRAC_PI_4};

/// Uniform on the unit disc; neighbours stay neighbours (Shirley and Chiu, "A low distortion map between disk and
/// square", 1997).
#[inline(always)]
pub fn disc<L: Lanes>(l: L, [u, v]: [L::F; 2]) -> [L::F; 2] {
    // Numbers are never 1/2, so not both are zero.
    let a = u * 2.0 - 1.0;
    let b = v * 2.0 - 1.0;
    let wide = b.magnitude().lt(a.magnitude());
    let radius = wide.pick(a, b);
    let angle = wide.pick(b, a) / radius * FRAC_PI_4;
    let (sin, cos) = sin_cos_eighth(l, angle);
    let (along, across) = (radius * cos, radius * sin);
    [wide.pick(along, across), wide.pick(across, along)]
}

/// A direction about +z with density [`cosine_pdf`] (Malley's method).
#[inline(always)]
pub fn cosine<L: Lanes>(l: L, u: [L::F; 2]) -> V<L> {
    let [x, y] = disc(l, u);
    V::new(x, y, (l.f(1.0) - x * x - y * y).greater(l.f(0.0)).root())
}

/// Density of [`cosine`] in solid angle, by the cosine to +z.
#[inline(always)]
pub fn cosine_pdf<L: Lanes>(l: L, cosine: L::F) -> L::F {
    cosine.greater(l.f(0.0)) * FRAC_1_PI
}

/// A direction uniform on the sphere.
#[inline(always)]
pub fn sphere<L: Lanes>(l: L, u: [L::F; 2]) -> V<L> {
    cone(l, u, l.f(2.0))
}

/// Density of [`sphere`] in solid angle.
pub const SPHERE_PDF: f32 = 0.25 * FRAC_1_PI;

/// A direction uniform in the cone about +z whose half angle has 1 − cosine = `height`, which stays exact for
/// narrow cones: a point of the disc whose squared radius, uniform too, says how far down the direction is.
#[inline(always)]
pub fn cone<L: Lanes>(l: L, u: [L::F; 2], height: L::F) -> V<L> {
    let [x, y] = disc(l, u);
    let down = (x * x + y * y) * height;
    let stretch = (height * (l.f(2.0) - down)).greater(l.f(0.0)).root();
    V::new(x * stretch, y * stretch, l.f(1.0) - down)
}

/// Density of [`cone`] in solid angle.
#[inline(always)]
pub fn cone_pdf<L: Lanes>(l: L, height: L::F) -> L::F {
    l.f(0.5 * FRAC_1_PI) / height
}

/// 1 − cosine of the half angle of a cone by its sine squared, exact for narrow ones.
#[inline(always)]
pub fn cone_height<L: Lanes>(l: L, sine_squared: L::F) -> L::F {
    sine_squared / ((l.f(1.0) - sine_squared).greater(l.f(0.0)).root() + 1.0)
}
