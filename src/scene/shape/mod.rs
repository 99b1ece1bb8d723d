//! Surfaces in world space, with what can be said of them without a ray: bounds, area, inside.

mod bounds;
mod instance;
mod placed;
mod quadric;

use crate::math::{DVec3, PI};
pub use bounds::Bounds;
pub use instance::{Instance, area as triangle_area};
pub use placed::Placed;
pub use quadric::{Form, Quadric};
use serde::Serialize;

/// A surface. Normals point out of a closed solid; a plane's normal points out of the half-space it bounds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum Shape {
    /// A ball.
    Sphere {
        /// Centre.
        center: DVec3,
        /// Radius, above 0.
        radius: f64,
    },
    /// The points p with `normal`·(p − `point`) = 0.
    Plane {
        /// Any of its points.
        point: DVec3,
        /// Unit vector out of the solid half-space.
        normal: DVec3,
    },
    /// A canonical quadric of object space, carried to the world by an affine map.
    Quadric(Box<Quadric>),
    /// The points of object space with y = 0 and x² + z² ≤ 1, carried to the world. Its normal is that of +y.
    Disk(Box<Placed>),
    /// The cube [−1, 1]³ of object space, carried to the world.
    Box(Box<Placed>),
    /// Triangles.
    Mesh(Box<Instance>),
}

impl Shape {
    /// The name of its kind in the language.
    pub fn kind(&self) -> &'static str {
        match self {
            Shape::Sphere { .. } => "sphere",
            Shape::Plane { .. } => "plane",
            Shape::Quadric(quadric) => quadric.form.kind(),
            Shape::Disk(_) => "disk",
            Shape::Box(_) => "box",
            Shape::Mesh(_) => "mesh",
        }
    }

    /// The box around it, or none for a surface without end.
    pub fn bounds(&self) -> Option<Bounds> {
        match self {
            Shape::Sphere { center, radius } => {
                Some(Bounds { min: *center - *radius, max: *center + *radius })
            }
            Shape::Plane { .. } => None,
            Shape::Quadric(quadric) => quadric.bounds(),
            Shape::Disk(placed) => Some(placed.disk_bounds()),
            Shape::Box(placed) => Some(Bounds::CUBE.mapped(&placed.world_from_object)),
            Shape::Mesh(instance) => Some(instance.bounds()),
        }
    }

    /// How far it reaches along a unit vector beyond a point; none for a surface without end. Of a mesh, at most how
    /// far.
    pub fn reach(&self, direction: DVec3, from: DVec3) -> Option<f64> {
        match self {
            Shape::Sphere { center, radius } => Some(direction.dot(*center - from) + radius),
            Shape::Plane { .. } => None,
            Shape::Quadric(quadric) => {
                let origin = quadric.world_from_object.translation;
                quadric.is_bounded().then(|| direction.dot(origin - from) + quadric.extent(direction))
            }
            Shape::Disk(placed) => Some(placed.reach_of_disk(direction, from)),
            Shape::Box(placed) => Some(placed.reach_of_box(direction, from)),
            Shape::Mesh(instance) => Some(instance.reach(direction, from)),
        }
    }

    /// Whether a point lies in the solid. A surface that encloses nothing has no inside.
    pub fn contains(&self, p: DVec3) -> bool {
        match self {
            Shape::Sphere { center, radius } => p.distance_squared(*center) < radius * radius,
            Shape::Plane { point, normal } => normal.dot(p - *point) < 0.0,
            Shape::Quadric(quadric) => {
                let o = quadric.object_from_world.transform_point3(p);
                quadric.is_closed() && quadric.low < o.y && o.y < quadric.high && quadric.form.q(o) < 0.0
            }
            Shape::Disk(_) => false,
            Shape::Box(placed) => placed.object_from_world.transform_point3(p).abs().cmplt(DVec3::ONE).all(),
            Shape::Mesh(instance) => instance.contains(p),
        }
    }

    /// Whether it bounds a solid, so that it has an inside and an outside.
    pub fn is_closed(&self) -> bool {
        match self {
            Shape::Sphere { .. } | Shape::Plane { .. } | Shape::Box(_) => true,
            Shape::Disk(_) => false,
            Shape::Mesh(instance) => instance.mesh.is_closed(),
            Shape::Quadric(quadric) => quadric.is_closed(),
        }
    }

    /// The area in m² of one side of the surface, caps included; infinite for a surface without end.
    pub fn area(&self) -> f64 {
        match self {
            Shape::Sphere { radius, .. } => 4.0 * PI * radius * radius,
            Shape::Plane { .. } => f64::INFINITY,
            Shape::Quadric(quadric) => quadric.area(),
            Shape::Disk(placed) => PI * placed.unit_areas().y,
            Shape::Box(placed) => 8.0 * placed.unit_areas().element_sum(),
            Shape::Mesh(instance) => instance.area(),
        }
    }
}
