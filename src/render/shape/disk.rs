//! Discs: the unit disc of object space in the plane y = 0.

use super::{Ray, SurfacePoint};
use crate::math::DVec3;
use crate::scene::shape::Placed;

/// The distance, if above 0. A ray that starts on a disc does not meet it again.
pub(super) fn intersect(disk: &Placed, ray: &Ray, on_it: bool) -> Option<f64> {
    if on_it {
        return None;
    }
    let o = disk.object_from_world.transform_point3(ray.origin);
    let d = disk.object_from_world.transform_vector3(ray.direction);
    let t = -o.y / d.y;
    let (x, z) = (o.x + t * d.x, o.z + t * d.z);
    (t > 0.0 && t < f64::INFINITY && x * x + z * z <= 1.0).then_some(t)
}

/// The point of a disc next to one that lies on it but for rounding.
pub(super) fn surface_point(disk: &Placed, near: DVec3) -> SurfacePoint {
    let o = disk.object_from_world.transform_point3(near);
    let p = disk.world_from_object.transform_point3(DVec3::new(o.x, 0.0, o.z));
    SurfacePoint::new(p, disk.normal(DVec3::Y))
}
