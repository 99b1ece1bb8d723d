//! Meshes in the world.

use super::{Bounds, Placed};
use crate::asset::Mesh;
use crate::math::{DVec3, PI, atan2};
use serde::{Serialize, Serializer};
use std::sync::Arc;

/// A mesh with its place. Copies of a mesh share its triangles.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Instance {
    /// The triangles, in object space. Part of the hash by what they are, not by where they came from.
    #[serde(serialize_with = "by_content")]
    pub mesh: Arc<Mesh>,
    /// Where object space lies in the world.
    pub placed: Placed,
    /// Whether it is shaded as if it were round, by the normals of its vertices.
    pub smooth: bool,
    /// The box around it in the world, which follows from the others.
    #[serde(skip)]
    bounds: Bounds,
}

fn by_content<S: Serializer>(mesh: &Arc<Mesh>, serializer: S) -> Result<S::Ok, S::Error> {
    mesh.hash().as_bytes().serialize(serializer)
}

impl Instance {
    /// A mesh in its place.
    pub fn new(mesh: Arc<Mesh>, placed: Placed, smooth: bool) -> Instance {
        let mut instance = Instance { mesh, placed, smooth, bounds: Bounds::EMPTY };
        for triangle in instance.triangles() {
            for p in instance.corners(triangle) {
                instance.bounds = instance.bounds.union(Bounds { min: p, max: p });
            }
        }
        instance
    }

    /// The corners of a triangle in the world.
    pub fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.mesh.corners(triangle).map(|p| self.placed.world_from_object.transform_point3(p))
    }

    /// The box around it in object space.
    pub fn object_bounds(&self) -> Bounds {
        let [min, max] = self.mesh.extent();
        Bounds { min, max }
    }

    pub(super) fn bounds(&self) -> Bounds {
        self.bounds
    }

    pub(super) fn area(&self) -> f64 {
        self.triangles().map(|triangle| area(self.corners(triangle))).sum()
    }

    /// At most how far it reaches: as far as the box around it in object space.
    pub(super) fn reach(&self, direction: DVec3, from: DVec3) -> f64 {
        let bounds = self.object_bounds();
        let g = self.placed.world_from_object.matrix3.transpose() * direction;
        let center = self.placed.world_from_object.transform_point3(bounds.center());
        direction.dot(center - from) + 0.5 * g.abs().dot(bounds.size())
    }

    /// Whether it winds around a point: the solid angles of its triangles, seen from there, add up to 4π inside of a
    /// closed mesh and to 0 outside (van Oosterom and Strackee, "The solid angle of a plane triangle", 1983).
    pub(super) fn contains(&self, p: DVec3) -> bool {
        if !self.mesh.is_closed() {
            return false;
        }
        let o = self.placed.object_from_world.transform_point3(p);
        let solid_angle = |triangle| {
            let [a, b, c] = self.mesh.corners(triangle).map(|corner| corner - o);
            let (x, y, z) = (a.length(), b.length(), c.length());
            let cosine = x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y;
            2.0 * atan2(a.dot(b.cross(c)), cosine)
        };
        self.triangles().map(solid_angle).sum::<f64>() > 2.0 * PI
    }

    fn triangles(&self) -> std::ops::Range<u32> {
        0..self.mesh.len() as u32
    }
}

/// The area of a triangle.
pub fn area([a, b, c]: [DVec3; 3]) -> f64 {
    0.5 * (b - a).cross(c - a).length()
}
