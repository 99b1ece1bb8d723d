//! The GGX distribution of microfacet normals with Smith's shadowing.
//!
//! Formulas from Eric Heitz, "Understanding the masking-shadowing function in microfacet-based BRDFs", JCGT
//! 2014, and "Sampling the GGX distribution of visible normals", JCGT 2018.

use rt_lang::math::{DVec3, PI, cos, sin};

/// Density of facet normals `h` on the surface: the integral of D(h) h.z over the hemisphere is 1.
pub(super) fn distribution(h: DVec3, alpha: f64) -> f64 {
    if h.z <= 0.0 {
        return 0.0;
    }
    let stretched = h.x * h.x + h.y * h.y + alpha * alpha * h.z * h.z;
    alpha * alpha / (PI * stretched * stretched)
}

/// Smith's Λ: hidden over visible facet area, as seen from `w`.
fn lambda(w: DVec3, alpha: f64) -> f64 {
    let tangent_squared = (w.x * w.x + w.y * w.y) / (w.z * w.z);
    0.5 * ((1.0 + alpha * alpha * tangent_squared).sqrt() - 1.0)
}

/// The share of facets that is seen from `w`.
pub(super) fn masking(w: DVec3, alpha: f64) -> f64 {
    1.0 / (1.0 + lambda(w, alpha))
}

/// The share of facets seen from both directions on one side, heights correlated.
pub(super) fn shadowing(wo: DVec3, wi: DVec3, alpha: f64) -> f64 {
    1.0 / (1.0 + lambda(wo, alpha) + lambda(wi, alpha))
}

/// A facet normal among those that `wo` sees, with density [`visible_pdf`].
pub(super) fn sample_visible(wo: DVec3, alpha: f64, u: [f64; 2]) -> DVec3 {
    // Stretch the view so that the surface becomes a hemisphere, and draw from its projection.
    let v = DVec3::new(alpha * wo.x, alpha * wo.y, wo.z).normalize();
    let length_squared = v.x * v.x + v.y * v.y;
    let t1 = if length_squared > 0.0 { DVec3::new(-v.y, v.x, 0.0) / length_squared.sqrt() } else { DVec3::X };
    let t2 = v.cross(t1);
    let radius = u[0].sqrt();
    let angle = 2.0 * PI * u[1];
    let p1 = radius * cos(angle);
    let s = 0.5 * (1.0 + v.z);
    let p2 = (1.0 - s) * (1.0 - p1 * p1).max(0.0).sqrt() + s * radius * sin(angle);
    let p3 = (1.0 - p1 * p1 - p2 * p2).max(0.0).sqrt();
    let h = p1 * t1 + p2 * t2 + p3 * v;
    DVec3::new(alpha * h.x, alpha * h.y, h.z.max(0.0)).normalize()
}

/// Density of [`sample_visible`] in solid angle of `h`.
pub(super) fn visible_pdf(wo: DVec3, h: DVec3, alpha: f64) -> f64 {
    masking(wo, alpha) * wo.dot(h).max(0.0) * distribution(h, alpha) / wo.z
}
