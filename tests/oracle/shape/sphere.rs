//! Spheres.

use super::Ray;
use rt_lang::math::DVec3;

/// The least distance above 0. With o = origin − centre and b = −o·d it solves t² − 2bt + o·o − r² = 0. The
/// discriminant is taken from the offset of the ray from the centre, which does not cancel for a small sphere
/// far away (Haines et al., *Ray Tracing Gems* ch. 7), and the smaller root from the product of the two.
#[inline]
pub(super) fn intersect(center: DVec3, radius: f64, ray: &Ray, on_it: bool) -> Option<f64> {
    let o = ray.origin - center;
    let b = -o.dot(ray.direction);
    if on_it {
        return (b > 0.0).then_some(2.0 * b);
    }
    let product = o.length_squared() - radius * radius;
    // From outside, a sphere whose centre lies behind is never met: both roots have the sign of b.
    if product > 0.0 && b <= 0.0 {
        return None;
    }
    let offset = o + b * ray.direction;
    let discriminant = radius * radius - offset.length_squared();
    if discriminant < 0.0 {
        return None;
    }
    let larger = b + discriminant.sqrt().copysign(b);
    // From inside, the roots have opposite signs; the greater one is positive. From the surface itself, one is 0.
    let t = if product <= 0.0 && b >= 0.0 { larger } else { product / larger };
    (t > 0.0).then_some(t)
}
