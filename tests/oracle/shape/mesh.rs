//! Triangle meshes: each with a hierarchy of its own in object space, however often it stands in the scene.

use super::{Face, Ray, SurfacePoint};
use rt_lang::asset::Mesh;
use rt_lang::math::{DVec2, DVec3};
use rt_lang::render::exact::Hierarchy;
use rt_lang::scene::shape::{Bounds, Instance};
use std::sync::Arc;

/// The hierarchy over the triangles of a mesh.
pub struct Tree {
    hierarchy: Hierarchy,
}

impl Tree {
    /// Builds it.
    pub fn new(mesh: &Arc<Mesh>) -> Tree {
        let bounds = |triangle| {
            let corners = mesh.corners(triangle);
            corners.iter().fold(Bounds::EMPTY, |sum, p| sum.union(Bounds { min: *p, max: *p }))
        };
        Tree { hierarchy: Hierarchy::new((0..mesh.len() as u32).map(|i| (i, bounds(i))).collect()) }
    }

    /// The least distance above 0 and the triangle that is met there. A ray that starts on a triangle does not meet
    /// it again; it starts between its corners but for rounding, and nothing else is there but across an edge.
    pub fn intersect(&self, instance: &Instance, ray: &Ray, start: Option<Face>) -> Option<(f64, Face)> {
        let shear = Shear::new(instance, ray);
        let mut nearest = Nearest::new();
        self.hierarchy.walk(shear.origin, shear.direction, f64::INFINITY, |triangle| {
            nearest.consider(&shear, &instance.mesh, triangle, start);
            Some(nearest.t)
        });
        nearest.face()
    }

    /// Whether a point lies in a closed mesh: the first triangle in any direction is then met from behind.
    pub fn contains(&self, instance: &Instance, p: DVec3) -> bool {
        // Not along an axis, where meshes have their edges.
        let ray = Ray { origin: p, direction: DVec3::new(0.48, 0.6, 0.64), start: None };
        let met = instance.mesh.is_closed().then(|| self.intersect(instance, &ray, None)).flatten();
        met.is_some_and(|(t, face)| {
            surface_point(instance, ray.origin + t * ray.direction, face).n.dot(ray.direction) > 0.0
        })
    }
}

/// As [`Tree::intersect`], one triangle after the other.
pub(super) fn intersect(instance: &Instance, ray: &Ray, start: Option<Face>) -> Option<(f64, Face)> {
    let shear = Shear::new(instance, ray);
    let mut nearest = Nearest::new();
    for triangle in 0..instance.mesh.len() as u32 {
        nearest.consider(&shear, &instance.mesh, triangle, start);
    }
    nearest.face()
}

/// The nearest triangle so far; of equally near ones the first.
struct Nearest {
    t: f64,
    triangle: u32,
}

impl Nearest {
    fn new() -> Nearest {
        Nearest { t: f64::INFINITY, triangle: u32::MAX }
    }

    fn consider(&mut self, shear: &Shear, mesh: &Mesh, triangle: u32, start: Option<Face>) {
        if start == Some(Face::Triangle(triangle)) {
            return;
        }
        if let Some(t) = shear.distance(mesh.corners(triangle))
            && (t < self.t || t == self.t && triangle < self.triangle)
        {
            *self = Nearest { t, triangle };
        }
    }

    fn face(&self) -> Option<(f64, Face)> {
        (self.t < f64::INFINITY).then_some((self.t, Face::Triangle(self.triangle)))
    }
}

/// A ray in object space, sheared to run along z (Woop, Benthin and Wald, "Watertight ray/triangle intersection", JCGT
/// 2013). Triangles that share an edge see it by the same products with opposite signs, so that no ray passes between
/// them; one that meets the edge itself meets both.
struct Shear {
    origin: DVec3,
    direction: DVec3,
    /// The axes that x, y and z have become; the last is that along which the ray is longest.
    axes: [usize; 3],
    slope: DVec3,
}

impl Shear {
    fn new(instance: &Instance, ray: &Ray) -> Shear {
        let origin = instance.placed.object_from_world.transform_point3(ray.origin);
        let direction = instance.placed.object_from_world.transform_vector3(ray.direction);
        let size = direction.abs();
        let z = if size.x >= size.y && size.x >= size.z {
            0
        } else if size.y >= size.z {
            1
        } else {
            2
        };
        let (x, y) = ((z + 1) % 3, (z + 2) % 3);
        let slope = DVec3::new(direction[x], direction[y], 1.0) / direction[z];
        Shear { origin, direction, axes: [x, y, z], slope }
    }

    /// The distance to a triangle, if above 0.
    fn distance(&self, corners: [DVec3; 3]) -> Option<f64> {
        let [x, y, z] = self.axes;
        let [a, b, c] = corners.map(|corner| {
            let p = corner - self.origin;
            DVec3::new(p[x] - self.slope.x * p[z], p[y] - self.slope.y * p[z], self.slope.z * p[z])
        });
        let u = c.x * b.y - c.y * b.x;
        let v = a.x * c.y - a.y * c.x;
        let w = b.x * a.y - b.y * a.x;
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let t = (u * a.z + v * b.z + w * c.z) / (u + v + w);
        (t > 0.0 && t < f64::INFINITY).then_some(t)
    }
}

/// The point of a triangle next to one that lies on it but for rounding.
pub(super) fn surface_point(instance: &Instance, near: DVec3, face: Face) -> SurfacePoint {
    let Face::Triangle(triangle) = face else { unreachable!("a mesh has no {face:?}") };
    let [a, b, c] = instance.mesh.corners(triangle);
    let [u, v, w] = weights([a, b, c], instance.placed.object_from_world.transform_point3(near));
    let p = instance.placed.world_from_object.transform_point3(u * a + v * b + w * c);
    // In units of the longest edge, so that no product leaves the range of numbers.
    let (e, f) = (b - a, c - a);
    let n = instance.placed.normal((e / e.length()).cross(f / f.length()));
    let mut shading = n;
    if instance.smooth {
        let [na, nb, nc] = instance.mesh.normals(triangle);
        let mean = instance.placed.object_from_world.matrix3.transpose() * (u * na + v * nb + w * nc);
        let mean = mean.normalize_or_zero();
        // Normals that look away from their triangle are no approximation of it.
        shading = if mean.dot(n) > 0.0 { mean } else { n };
    }
    SurfacePoint { p, n, shading }
}

/// Where a point of a triangle lies in a picture, where the file says so.
pub(crate) fn uv(instance: &Instance, triangle: u32, p: DVec3) -> Option<DVec2> {
    let [a, b, c] = instance.mesh.uvs(triangle)?;
    let o = instance.placed.object_from_world.transform_point3(p);
    let [u, v, w] = weights(instance.mesh.corners(triangle), o);
    Some(u * a + v * b + w * c)
}

/// What each corner of a triangle weighs in a point of it: not negative, and 1 together.
fn weights([a, b, c]: [DVec3; 3], p: DVec3) -> [f64; 3] {
    let n = (b - a).cross(c - a);
    let squared = n.length_squared();
    let v = (p - a).cross(c - a).dot(n) / squared;
    let w = (b - a).cross(p - a).dot(n) / squared;
    let (v, w) = (v.clamp(0.0, 1.0), w.clamp(0.0, 1.0));
    let sum = (v + w).max(1.0);
    let (v, w) = (v / sum, w / sum);
    [1.0 - v - w, v, w]
}
