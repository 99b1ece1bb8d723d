//! Boxes: the cube [−1, 1]³ of object space, as three pairs of planes.

use super::{Face, Ray, SurfacePoint, Wall};
use crate::math::DVec3;
use crate::scene::shape::Placed;

/// The least distance above 0 and the wall that is met there. A line is in the box between the last plane that it
/// enters by and the first that it leaves by. The plane that the ray starts on is at distance 0 exactly: a ray
/// that goes out has left the box, one that goes in leaves it by another wall.
pub(super) fn intersect(cuboid: &Placed, ray: &Ray, start: Option<Face>) -> Option<(f64, Face)> {
    let o = cuboid.object_from_world.transform_point3(ray.origin);
    let d = cuboid.object_from_world.transform_vector3(ray.direction);
    let mut enter = (f64::NEG_INFINITY, Face::Side);
    let mut leave = (f64::INFINITY, Face::Side);
    for axis in 0..3u8 {
        let (o, d) = (o[usize::from(axis)], d[usize::from(axis)]);
        let wall = |upper| Face::Wall(Wall { axis, upper });
        if d == 0.0 {
            let starts_here = start == Some(wall(false)) || start == Some(wall(true));
            if starts_here || o.abs() > 1.0 {
                return None;
            }
            continue;
        }
        let distance = |upper: bool| {
            let place = if upper { 1.0 } else { -1.0 };
            (if start == Some(wall(upper)) { 0.0 } else { (place - o) / d }, wall(upper))
        };
        let (first, second) = (distance(d < 0.0), distance(d > 0.0));
        enter = if first.0 > enter.0 { first } else { enter };
        leave = if second.0 < leave.0 { second } else { leave };
    }
    if enter.0 > leave.0 {
        return None;
    }
    [enter, leave].into_iter().find(|(t, _)| *t > 0.0)
}

/// The point of a wall next to one that lies on it but for rounding, with the outward normal.
pub(super) fn surface_point(cuboid: &Placed, near: DVec3, face: Face) -> SurfacePoint {
    let mut o = cuboid.object_from_world.transform_point3(near);
    let Face::Wall(wall) = face else { unreachable!("a box has no {face:?}") };
    let n = wall.normal();
    o[usize::from(wall.axis)] = n[usize::from(wall.axis)];
    SurfacePoint::new(cuboid.world_from_object.transform_point3(o), cuboid.normal(n))
}
