//! What flat shapes are in object space, and where it lies in the world.

use super::Bounds;
use crate::math::{DAffine3, DVec3};
use serde::Serialize;

/// A map from object space to the world, with its inverse.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Placed {
    /// Object to world; invertible.
    pub world_from_object: DAffine3,
    /// The inverse.
    pub object_from_world: DAffine3,
}

impl Placed {
    /// The unit normal in the world of what has this normal in object space: normals go by the inverse transpose.
    pub fn normal(&self, n: DVec3) -> DVec3 {
        (self.object_from_world.matrix3.transpose() * n).normalize()
    }

    /// World areas of the unit squares of object space that are perpendicular to x, y and z.
    pub fn unit_areas(&self) -> DVec3 {
        let m = self.world_from_object.matrix3;
        let area = |a: DVec3, b: DVec3| a.cross(b).length();
        DVec3::new(area(m.y_axis, m.z_axis), area(m.z_axis, m.x_axis), area(m.x_axis, m.y_axis))
    }

    /// The box around the unit disc of object space: on each axis an ellipse reaches as far as the root of the
    /// squares of its half axes' parts.
    pub(super) fn disk_bounds(&self) -> Bounds {
        let m = self.world_from_object.matrix3;
        let squares = m.x_axis * m.x_axis + m.z_axis * m.z_axis;
        let reach = DVec3::new(squares.x.sqrt(), squares.y.sqrt(), squares.z.sqrt());
        let center = self.world_from_object.translation;
        Bounds { min: center - reach, max: center + reach }
    }

    pub(super) fn reach_of_disk(&self, direction: DVec3, from: DVec3) -> f64 {
        let g = self.world_from_object.matrix3.transpose() * direction;
        direction.dot(self.world_from_object.translation - from) + (g.x * g.x + g.z * g.z).sqrt()
    }

    pub(super) fn reach_of_box(&self, direction: DVec3, from: DVec3) -> f64 {
        let g = self.world_from_object.matrix3.transpose() * direction;
        direction.dot(self.world_from_object.translation - from) + g.abs().element_sum()
    }
}
