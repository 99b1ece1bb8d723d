//! Glowing surfaces, sampled by area.

use super::{LightSample, Receiver, Target};
use crate::oracle::shape::{Face, Place, Ray, SurfacePoint, Wall, surface_point};
use crate::oracle::warp;
use rt_lang::color::Rgb;
use rt_lang::math::{DVec3, PI};
use rt_lang::scene::shape::{Form, Placed, Quadric, triangle_area};
use rt_lang::scene::{PrimitiveId, Shape};

/// A glowing surface that has an end.
pub struct Glowing {
    id: PrimitiveId,
    shape: Shape,
    area: f64,
    /// Middle of its box, and half the diagonal squared.
    center: DVec3,
    extent_squared: f64,
    parts: Vec<Part>,
}

/// A piece of a surface that is sampled by itself.
struct Part {
    face: Face,
    /// Of a quadric's side, from and to in object space's y; of a cap, twice the same.
    stretch: [f64; 2],
    /// Of the whole area.
    share: f64,
    /// Sum of the shares of all parts to this one.
    end: f64,
}

impl Glowing {
    /// Prepares a surface; none where it has no end, or no area.
    pub fn new(id: PrimitiveId, shape: &Shape) -> Option<Glowing> {
        let bounds = shape.bounds()?;
        let pieces = pieces(shape);
        let area: f64 = pieces.iter().map(|(.., area)| area).sum();
        if !(area > 0.0 && area < f64::INFINITY) {
            return None;
        }
        let mut end = 0.0;
        let part = |(face, stretch, piece): (Face, [f64; 2], f64)| {
            let share = piece / area;
            end += share;
            Part { face, stretch, share, end }
        };
        let parts = pieces.into_iter().filter(|(.., area)| *area > 0.0).map(part).collect();
        let extent_squared = 0.25 * bounds.size().length_squared();
        Some(Glowing { id, shape: shape.clone(), area, center: bounds.center(), extent_squared, parts })
    }

    /// About the solid angle that it fills, seen from a point.
    pub fn estimate(&self, from: DVec3) -> f64 {
        self.area / self.center.distance_squared(from).max(self.extent_squared)
    }

    /// A direction to a point by area: the part by its share, and within the side of a quadric uniform in y and
    /// angle.
    pub fn sample(&self, receiver: &Receiver, part: f64, u: [f64; 2], radiance: Rgb) -> Option<LightSample> {
        let index = self.parts.partition_point(|known| known.end <= part).min(self.parts.len() - 1);
        let part = &self.parts[index];
        let point = self.point(part, u);
        let SurfacePoint { p, n, .. } = point;
        let to = p - receiver.p;
        let distance = to.length();
        let wi = to / distance;
        let facing = -n.dot(wi);
        let glows = if self.shape.is_closed() { facing > 0.0 } else { facing != 0.0 };
        let pdf = self.pdf(receiver.p, wi, &point, part.face);
        let place = Place { primitive: self.id, face: part.face };
        let hides_itself = !matches!(self.shape, Shape::Disk(_) | Shape::Box(_));
        (glows && pdf > 0.0 && pdf < f64::INFINITY).then_some(LightSample {
            wi,
            distance,
            radiance,
            pdf,
            delta: false,
            target: Some(Target { point, place, hides_itself }),
        })
    }

    /// Density of [`Glowing::sample`] in solid angle, from a point in the direction of a point of the surface.
    pub fn pdf(&self, from: DVec3, wi: DVec3, point: &SurfacePoint, face: Face) -> f64 {
        let by_area = match (&self.shape, face) {
            (Shape::Quadric(quadric), Face::Side) => self.side_pdf(quadric, point.p),
            _ => 1.0 / self.area,
        };
        by_area * point.p.distance_squared(from) / point.n.dot(wi).abs()
    }

    /// By area, on the side of a quadric.
    fn side_pdf(&self, quadric: &Quadric, p: DVec3) -> f64 {
        let object = quadric.object_from_world.transform_point3(p);
        // Which of the sheets a height belongs to, where there are two.
        let lower = |y: f64| quadric.form == Form::TwoSheet && y < 0.0;
        let on_it = |part: &&Part| part.face == Face::Side && lower(object.y) == lower(part.stretch[0]);
        let Some(part) = self.parts.iter().find(on_it) else { return 0.0 };
        let [low, high] = part.stretch;
        part.share / ((high - low) * 2.0 * PI * quadric.side_density(object))
    }

    fn point(&self, part: &Part, u: [f64; 2]) -> SurfacePoint {
        match (&self.shape, part.face) {
            (Shape::Quadric(quadric), face) => on_quadric(quadric, face, part.stretch, u),
            (Shape::Disk(placed), _) => {
                let p = warp::disc(u);
                on_placed(placed, DVec3::new(p.x, 0.0, p.y), DVec3::Y)
            }
            (Shape::Box(placed), Face::Wall(wall)) => {
                let n = wall.normal();
                let (a, b) = (2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0);
                let p = match wall.axis {
                    0 => DVec3::new(n.x, a, b),
                    1 => DVec3::new(b, n.y, a),
                    _ => DVec3::new(a, b, n.z),
                };
                on_placed(placed, p, n)
            }
            (Shape::Mesh(instance), Face::Triangle(triangle)) => {
                // Uniform in the triangle (Turk, "Generating random points in triangles", Graphics Gems, 1990).
                let [a, b, c] = instance.corners(triangle);
                let root = u[0].sqrt();
                let p = (1.0 - root) * a + root * (1.0 - u[1]) * b + root * u[1] * c;
                let ray = Ray { origin: p, direction: DVec3::ZERO, start: None };
                surface_point(&self.shape, &ray, 0.0, part.face)
            }
            (shape, face) => unreachable!("{face:?} of {shape:?} is no part"),
        }
    }
}

/// The parts of a surface that has an end: face, stretch and area.
fn pieces(shape: &Shape) -> Vec<(Face, [f64; 2], f64)> {
    const NONE: [f64; 2] = [0.0; 2];
    match shape {
        Shape::Quadric(quadric) => {
            let [low_cap, high_cap] = quadric.cap_areas();
            let [below, above] = quadric.stretches();
            vec![
                (Face::Side, below, quadric.side_area(below[0], below[1])),
                (Face::Side, above, quadric.side_area(above[0], above[1])),
                (Face::Low, [quadric.low; 2], low_cap),
                (Face::High, [quadric.high; 2], high_cap),
            ]
        }
        Shape::Box(placed) => {
            let areas = placed.unit_areas();
            let wall =
                |axis: u8, upper| (Face::Wall(Wall { axis, upper }), NONE, 4.0 * areas[usize::from(axis)]);
            (0..3).flat_map(|axis| [wall(axis, false), wall(axis, true)]).collect()
        }
        Shape::Mesh(instance) => (0..instance.mesh.len() as u32)
            .map(|triangle| (Face::Triangle(triangle), NONE, triangle_area(instance.corners(triangle))))
            .collect(),
        Shape::Sphere { .. } | Shape::Plane { .. } | Shape::Disk(_) => {
            vec![(Face::Side, NONE, shape.area())]
        }
    }
}

fn on_quadric(quadric: &Quadric, face: Face, [low, high]: [f64; 2], u: [f64; 2]) -> SurfacePoint {
    let (object, gradient) = match face {
        Face::Low | Face::High => {
            let p = quadric.form.radius_squared(low).sqrt() * warp::disc(u);
            (DVec3::new(p.x, low, p.y), if face == Face::Low { DVec3::NEG_Y } else { DVec3::Y })
        }
        _ => {
            let p = quadric.side_point(low + u[0] * (high - low), 2.0 * PI * u[1]);
            (p, quadric.form.half_gradient(p))
        }
    };
    let p = quadric.world_from_object.transform_point3(object);
    SurfacePoint::new(p, (quadric.object_from_world.matrix3.transpose() * gradient).normalize())
}

fn on_placed(placed: &Placed, p: DVec3, n: DVec3) -> SurfacePoint {
    SurfacePoint::new(placed.world_from_object.transform_point3(p), placed.normal(n))
}
