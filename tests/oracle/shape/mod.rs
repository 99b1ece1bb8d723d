//! Where rays meet surfaces.
//!
//! There is no distance that counts as "too near": a ray that starts on a surface knows so, and solves it with
//! the constant term of its equation exactly zero. The root 0 is then the start itself and drops out, and the
//! other root is exact however large the surface. So rooms of giant spheres show no acne and leak no light.

mod cuboid;
mod disk;
mod mesh;
mod plane;
mod quadric;
mod sphere;

pub use mesh::Tree;
pub(super) use mesh::uv as mesh_uv;
use rt_lang::math::DVec3;
use rt_lang::scene::{PrimitiveId, Shape};

/// A half-line, and the surface it starts on.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Where it starts.
    pub origin: DVec3,
    /// Unit vector.
    pub direction: DVec3,
    /// The surface that `origin` lies on, if any.
    pub start: Option<Place>,
}

/// A surface, and which face of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// The surface.
    pub primitive: PrimitiveId,
    /// Which of its faces.
    pub face: Face,
}

/// A smooth piece of a shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Face {
    /// The surface itself.
    Side,
    /// The flat cap at a quadric's lower end.
    Low,
    /// The flat cap at a quadric's upper end.
    High,
    /// A side of a box.
    Wall(Wall),
    /// A triangle of a mesh.
    Triangle(u32),
}

/// A side of a box in object space.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wall {
    /// The axis that it is perpendicular to: 0, 1 or 2.
    pub axis: u8,
    /// Whether it is at the upper end of that axis.
    pub upper: bool,
}

impl Wall {
    /// The outward normal in object space.
    pub fn normal(self) -> DVec3 {
        let mut n = DVec3::ZERO;
        n[usize::from(self.axis)] = if self.upper { 1.0 } else { -1.0 };
        n
    }
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

/// The least distance above 0 at which a ray meets a shape. `start` is the face that the ray starts on, if it
/// starts on this very shape. A mesh is asked triangle by triangle: [`Tree`] is the fast way.
#[inline]
pub fn intersect(shape: &Shape, ray: &Ray, start: Option<Face>) -> Option<(f64, Face)> {
    match shape {
        Shape::Sphere { center, radius } => {
            sphere::intersect(*center, *radius, ray, start.is_some()).map(|t| (t, Face::Side))
        }
        Shape::Plane { point, normal } => {
            plane::intersect(*point, *normal, ray, start.is_some()).map(|t| (t, Face::Side))
        }
        Shape::Quadric(quadric) => quadric::intersect(quadric, ray, start),
        Shape::Disk(placed) => disk::intersect(placed, ray, start.is_some()).map(|t| (t, Face::Side)),
        Shape::Box(placed) => cuboid::intersect(placed, ray, start),
        Shape::Mesh(instance) => mesh::intersect(instance, ray, start),
    }
}

/// The point of a shape that a ray meets at a distance, with its normal.
pub fn surface_point(shape: &Shape, ray: &Ray, t: f64, face: Face) -> SurfacePoint {
    let near = ray.origin + t * ray.direction;
    match shape {
        Shape::Sphere { center, radius } => {
            let n = (near - *center).normalize();
            SurfacePoint::new(*center + *radius * n, n)
        }
        Shape::Plane { point, normal } => {
            SurfacePoint::new(near - normal.dot(near - *point) * *normal, *normal)
        }
        Shape::Quadric(quadric) => quadric::surface_point(quadric, near, face),
        Shape::Disk(placed) => disk::surface_point(placed, near),
        Shape::Box(placed) => cuboid::surface_point(placed, near, face),
        Shape::Mesh(instance) => mesh::surface_point(instance, near, face),
    }
}
