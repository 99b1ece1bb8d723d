//! Surfaces that are met one ray at a time, in double precision: discs, boxes, meshes.
//!
//! Rays come from the tracer's coordinates and go back to them; in between everything is in the world.

mod bvh;
mod cuboid;
mod disk;
mod mesh;

use super::lanes::{Lanes, One, Word};
use super::shape::{Face, Hits, ROUNDING, Rays, decode, encode, slot};
use super::space::{Space, double};
use crate::math::DVec3;
use crate::scene::{Primitive, PrimitiveId, Scene, Shape};
pub(super) use bvh::BYTES_A_THING;
pub use bvh::Hierarchy;
use mesh::Tree;
pub(super) use mesh::uv as mesh_uv;
use std::collections::BTreeMap;
use std::sync::Arc;

/// A half-line, and the face of the surface in question that it starts on, if it does.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Where it starts.
    pub origin: DVec3,
    /// Unit vector.
    pub direction: DVec3,
}

/// A point of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// Where.
    pub p: DVec3,
    /// Unit normal, outwards where the shape is closed.
    pub n: DVec3,
    /// Unit normal to shade with, on the side of the other: that of the round surface which a smooth mesh stands for.
    pub shading: DVec3,
}

impl SurfacePoint {
    /// A point of a surface that is what it looks.
    pub fn new(p: DVec3, n: DVec3) -> SurfacePoint {
        SurfacePoint { p, n, shading: n }
    }
}

/// The surfaces of a scene that are met in double precision.
pub struct Exact {
    primitives: Arc<Vec<Primitive>>,
    space: Space,
    /// Of each mesh, once however often it stands in the scene.
    trees: Vec<Tree>,
    /// For each surface the place of its tree among them; empty where there is no mesh.
    tree_of: Vec<u32>,
}

impl Exact {
    /// Those of a scene.
    pub fn new(scene: &Scene, space: &Space) -> Exact {
        let (trees, tree_of) = trees(scene);
        Exact { primitives: scene.primitives.clone(), space: *space, trees, tree_of }
    }

    /// The surfaces they are taken from.
    pub fn primitives(&self) -> &[Primitive] {
        &self.primitives
    }

    /// Takes them from another scene, in which they have the same shapes, so that the first need not be kept.
    pub fn refer_to(&mut self, scene: &Scene) {
        self.primitives = scene.primitives.clone();
    }

    /// The least distance above 0 at which a ray meets a surface in a slot, with place and detail. Infinite if it does
    /// not.
    pub fn meet(&self, id: PrimitiveId, at: u32, ray: &Rays<One>) -> (Hits<One>, f32) {
        let world = Ray { origin: self.space.world(ray.o, 0), direction: double(ray.d, 0) };
        let starts_here = slot(ray.start.get(0)) == at;
        let start = starts_here.then(|| decode(ray.start.get(0), ray.detail.get(0)));
        let found = match &self.shape(id) {
            Shape::Disk(placed) => disk::intersect(placed, &world, starts_here).map(|t| (t, Face::Side)),
            Shape::Box(placed) => cuboid::intersect(placed, &world, start),
            Shape::Mesh(instance) => self.tree(id).intersect(instance, &world, start),
            Shape::Sphere { .. } | Shape::Plane { .. } | Shape::Quadric(_) => None,
        };
        let Some((t, face)) = found else { return (Hits::nothing(One), 0.0) };
        let t = self.space.length(t) as f32;
        let (place, detail) = encode(at, face);
        // The start was rounded, and may lie below the next triangle by as much.
        let o = ray.o;
        let slop = if starts_here { (o.x.abs() + o.y.abs() + o.z.abs()) * ROUNDING } else { 0.0 };
        (Hits { t, place: One.u(place), detail: One.u(detail) }, slop)
    }

    /// The point of a surface that a ray meets at a distance.
    pub fn point(&self, id: PrimitiveId, ray: &Rays<One>, t: f32, face: Face) -> SurfacePoint {
        let near = self.space.world(ray.o, 0) + f64::from(t) * self.space.unit() * double(ray.d, 0);
        self.point_near(id, near, face)
    }

    /// The point of a face next to a point of the world that lies on it but for rounding.
    pub fn point_near(&self, id: PrimitiveId, near: DVec3, face: Face) -> SurfacePoint {
        surface_point(self.shape(id), near, face)
    }

    /// Whether a point of the world lies in a solid.
    pub fn contains(&self, id: PrimitiveId, p: DVec3) -> bool {
        match self.shape(id) {
            Shape::Mesh(instance) => self.tree(id).contains(instance, p),
            shape => shape.contains(p),
        }
    }

    fn shape(&self, id: PrimitiveId) -> &Shape {
        &self.primitives[id.0 as usize].shape
    }

    fn tree(&self, id: PrimitiveId) -> &Tree {
        &self.trees[self.tree_of[id.0 as usize] as usize]
    }
}

/// The point of a disc, box or mesh next to one that lies on it but for rounding.
pub(super) fn surface_point(shape: &Shape, near: DVec3, face: Face) -> SurfacePoint {
    match shape {
        Shape::Disk(placed) => disk::surface_point(placed, near),
        Shape::Box(placed) => cuboid::surface_point(placed, near, face),
        Shape::Mesh(instance) => mesh::surface_point(instance, near, face),
        Shape::Sphere { .. } | Shape::Plane { .. } | Shape::Quadric(_) => {
            unreachable!("{face:?} of {shape:?} is met in lanes")
        }
    }
}

/// The hierarchies of all meshes, and for each surface which of them it has.
fn trees(scene: &Scene) -> (Vec<Tree>, Vec<u32>) {
    let mut known = BTreeMap::new();
    let mut trees = Vec::new();
    let mut tree_of = Vec::new();
    for (id, primitive) in scene.primitives.iter().enumerate() {
        let Shape::Mesh(instance) = &primitive.shape else { continue };
        let place = *known.entry(*instance.mesh.hash().as_bytes()).or_insert_with(|| {
            trees.push(Tree::new(&instance.mesh));
            trees.len() as u32 - 1
        });
        tree_of.resize(scene.primitives.len(), u32::MAX);
        tree_of[id] = place;
    }
    (trees, tree_of)
}
