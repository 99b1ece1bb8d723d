//! Curved surfaces as triangles.

use crate::math::{DVec3, PI};
use crate::scene::Shape;
use crate::scene::shape::{Instance, Quadric};

/// Triangles with shared corners, anticlockwise as seen from outside.
#[derive(Default)]
pub(super) struct Triangles {
    pub(super) corners: Vec<DVec3>,
    /// Unit normals, one a corner, or none at all of what is flat.
    pub(super) normals: Vec<DVec3>,
    pub(super) indices: Vec<[usize; 3]>,
}

/// A quadric in so many steps around, and as many up, or a mesh as it is; none of a surface without end.
pub(super) fn of(shape: &Shape, steps: u32) -> Option<Triangles> {
    let mut triangles = Triangles::default();
    if let Shape::Mesh(instance) = shape {
        triangles.mesh(instance);
        return Some(triangles);
    }
    let Shape::Quadric(quadric) = shape else { return None };
    shape.bounds()?;
    for [low, high] in quadric.stretches().into_iter().filter(|[low, high]| low < high) {
        triangles.side(quadric, low, high, steps as usize);
    }
    for (y, area) in [quadric.low, quadric.high].into_iter().zip(quadric.cap_areas()) {
        if area > 0.0 {
            triangles.cap(quadric, y, y == quadric.high, steps as usize);
        }
    }
    triangles.turn_out(quadric.world_from_object.matrix3.determinant());
    Some(triangles)
}

impl Triangles {
    fn mesh(&mut self, instance: &Instance) {
        let map = instance.placed.world_from_object;
        for i in 0..instance.mesh.len() as u32 {
            self.indices.push([3 * i as usize, 3 * i as usize + 1, 3 * i as usize + 2]);
            let corners = instance.corners(i);
            if instance.smooth {
                self.normals.extend(instance.mesh.normals(i).map(|normal| smooth(instance, corners, normal)));
            }
            self.corners.extend(corners);
        }
        self.turn_out(map.matrix3.determinant());
    }

    /// A map that mirrors turns triangles inside out.
    fn turn_out(&mut self, determinant: f64) {
        if determinant < 0.0 {
            self.indices.iter_mut().for_each(|corners| corners.swap(1, 2));
        }
    }

    /// As a PLY file in text.
    pub(super) fn ply(&self) -> String {
        let Triangles { corners, normals, indices } = self;
        let mut text = format!("ply\nformat ascii 1.0\nelement vertex {}\n", corners.len());
        let axes = ["x", "y", "z", "nx", "ny", "nz"];
        for axis in &axes[..if normals.is_empty() { 3 } else { 6 }] {
            text += &format!("property float {axis}\n");
        }
        text +=
            &format!("element face {}\nproperty list uchar int vertex_indices\nend_header\n", indices.len());
        for (i, corner) in corners.iter().enumerate() {
            let normal = normals.get(i).map(DVec3::to_array);
            let values = corner.to_array().into_iter().chain(normal.into_iter().flatten());
            text += &(super::numbers(values, " ") + "\n");
        }
        for [a, b, c] in indices {
            text += &format!("3 {a} {b} {c}\n");
        }
        text
    }

    fn side(&mut self, quadric: &Quadric, low: f64, high: f64, steps: usize) {
        let first = self.corners.len();
        for row in 0..=steps {
            // Denser towards both ends, where a surface may close.
            let share = 0.5 - 0.5 * crate::math::cos(PI * row as f64 / steps as f64);
            self.ring(quadric, low + (high - low) * share, steps);
        }
        let corner = |row: usize, column: usize| first + row * steps + column % steps;
        for row in 0..steps {
            for column in 0..steps {
                let [a, b] = [corner(row, column), corner(row, column + 1)];
                let [c, d] = [corner(row + 1, column), corner(row + 1, column + 1)];
                self.indices.extend([[a, c, b], [b, c, d]]);
            }
        }
    }

    fn cap(&mut self, quadric: &Quadric, y: f64, upper: bool, steps: usize) {
        let first = self.corners.len();
        self.ring(quadric, y, steps);
        for i in 1..steps - 1 {
            let [a, b, c] = [first, first + i, first + i + 1];
            self.indices.push(if upper { [a, c, b] } else { [a, b, c] });
        }
    }

    fn ring(&mut self, quadric: &Quadric, y: f64, steps: usize) {
        let angle = |i: usize| 2.0 * PI * i as f64 / steps as f64;
        let point = |i| quadric.world_from_object.transform_point3(quadric.side_point(y, angle(i)));
        self.corners.extend((0..steps).map(point));
    }
}

/// The normal in the world that a corner is shaded by: where neighbours have no common one, the triangle's own.
fn smooth(instance: &Instance, corners: [DVec3; 3], normal: DVec3) -> DVec3 {
    if normal != DVec3::ZERO {
        return instance.placed.normal(normal);
    }
    let [a, b, c] = corners;
    let mirrored = instance.placed.world_from_object.matrix3.determinant() < 0.0;
    let cross = if mirrored { (c - a).cross(b - a) } else { (b - a).cross(c - a) };
    cross.normalize_or_zero()
}
