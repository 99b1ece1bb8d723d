//! From the unit square to directions and discs, each with its density.

use rt_lang::math::{DVec2, DVec3, PI, cos, sin};

/// Uniform on the unit disc; neighbours stay neighbours (Shirley and Chiu, "A low distortion map between disk and
/// square", 1997).
pub fn disc(u: [f64; 2]) -> DVec2 {
    let a = 2.0 * u[0] - 1.0;
    let b = 2.0 * u[1] - 1.0;
    if a == 0.0 && b == 0.0 {
        return DVec2::ZERO;
    }
    if a * a > b * b {
        let angle = 0.25 * PI * (b / a);
        a * DVec2::new(cos(angle), sin(angle))
    } else {
        let angle = 0.25 * PI * (a / b);
        b * DVec2::new(sin(angle), cos(angle))
    }
}

/// A direction about +z with density [`cosine_pdf`] (Malley's method).
pub fn cosine(u: [f64; 2]) -> DVec3 {
    let p = disc(u);
    DVec3::new(p.x, p.y, (1.0 - p.length_squared()).max(0.0).sqrt())
}

/// Density of [`cosine`] in solid angle, by the cosine to +z.
pub fn cosine_pdf(cosine: f64) -> f64 {
    cosine.max(0.0) / PI
}

/// A direction uniform on the sphere.
pub fn sphere(u: [f64; 2]) -> DVec3 {
    cone(u, 2.0)
}

/// Density of [`sphere`] in solid angle.
pub const SPHERE_PDF: f64 = 1.0 / (4.0 * PI);

/// A direction uniform in the cone about +z whose half angle has 1 − cosine = `height`, which stays exact for
/// narrow cones.
pub fn cone(u: [f64; 2], height: f64) -> DVec3 {
    let v = u[0] * height;
    let radius = (v * (2.0 - v)).max(0.0).sqrt();
    let angle = 2.0 * PI * u[1];
    DVec3::new(radius * cos(angle), radius * sin(angle), 1.0 - v)
}

/// Density of [`cone`] in solid angle.
pub fn cone_pdf(height: f64) -> f64 {
    1.0 / (2.0 * PI * height)
}
