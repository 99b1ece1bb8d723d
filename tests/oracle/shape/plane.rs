//! Planes.

use super::Ray;
use rt_lang::math::DVec3;

/// The distance, if above 0. A ray that starts on a plane does not meet it again.
#[inline]
pub(super) fn intersect(point: DVec3, normal: DVec3, ray: &Ray, on_it: bool) -> Option<f64> {
    if on_it {
        return None;
    }
    let t = normal.dot(point - ray.origin) / normal.dot(ray.direction);
    (t > 0.0 && t < f64::INFINITY).then_some(t)
}
