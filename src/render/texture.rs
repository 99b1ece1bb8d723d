//! Colour by place: what a texture shows at a point of a surface.

use super::exact::{SurfacePoint, mesh_uv};
use super::sampler::mix_wide as mix;
use super::shape::Face;
use crate::asset::Image;
use crate::color::Rgb;
use crate::math::{DVec2, DVec3, PI, atan2};
use crate::scene::shape::{Form, Quadric};
use crate::scene::texture::upright;
use crate::scene::{Paint, Primitive, Scene, Shape, Texture, TextureId};

/// By how much of its size a solid texture is seen below the surface, so that a face that lies on the border of two
/// cells shows the one inside.
const DEPTH: f64 = 1e-6;

/// The strength of noise: with it 98 of 100 points lie between the two colours, and the rest is one of them.
const CONTRAST: f64 = 0.8;

/// A point of a painted surface.
pub struct Spot<'s> {
    primitive: &'s Primitive,
    face: Face,
    /// In the world.
    point: &'s SurfacePoint,
    /// In the thing's own space.
    o: DVec3,
    /// Unit vector there that leads into the solid.
    inwards: DVec3,
    /// Unit normal there.
    n: DVec3,
}

/// Where a point lies in a picture: (0, 0) is its lower left corner, (1, 1) its upper right one.
struct Place {
    uv: DVec2,
    /// Whether copies follow above and below, as they always do to the sides.
    repeats_up: bool,
}

impl<'s> Spot<'s> {
    /// A point of a primitive that has a frame.
    pub fn new(scene: &Scene, primitive: &'s Primitive, face: Face, point: &'s SurfacePoint) -> Spot<'s> {
        let frame = scene.frame(primitive);
        Spot {
            primitive,
            face,
            point,
            o: frame.transform_point3(point.p),
            inwards: -(frame.matrix3 * point.n).normalize_or_zero(),
            // Normals go by the inverse transpose, and the frame leads from the world.
            n: (frame.matrix3.inverse().transpose() * point.n).normalize_or(DVec3::Y),
        }
    }

    /// A little below the surface, for a texture of this size.
    fn within(&self, size: f64) -> DVec3 {
        self.o / size + DEPTH * self.inwards
    }

    /// Where a picture lies whose copies have this size where it is flat.
    fn place(&self, size: DVec2) -> Place {
        match (&self.primitive.shape, self.face) {
            (Shape::Sphere { .. }, _) => globe(self.o),
            (Shape::Mesh(instance), face) => match (face, &self.point.p) {
                (Face::Triangle(triangle), p) => match mesh_uv(instance, triangle, *p) {
                    Some(uv) => Place { uv, repeats_up: true },
                    None => flat(self.o, self.n, size),
                },
                _ => flat(self.o, self.n, size),
            },
            (Shape::Plane { .. } | Shape::Disk(_) | Shape::Box(_), _)
            | (Shape::Quadric(_), Face::Low | Face::High | Face::Wall(_) | Face::Triangle(_)) => {
                flat(self.o, self.n, size)
            }
            (Shape::Quadric(quadric), Face::Side) => {
                let canonical = quadric.object_from_world.transform_point3(self.point.p);
                match quadric.form {
                    Form::Ellipsoid => globe(canonical),
                    _ => around(quadric, canonical, self.o, size),
                }
            }
        }
    }
}

/// Once around, as a map of the world: its centre faces +z, the left and right edges meet at −z.
fn globe(o: DVec3) -> Place {
    let latitude = atan2(o.y, (o.x * o.x + o.z * o.z).sqrt());
    Place { uv: DVec2::new(longitude(o), 0.5 + latitude / PI), repeats_up: false }
}

/// Once around the axis, as on a globe. Between its ends a picture covers the whole height; without an end copies
/// follow each other, one standing about the origin.
fn around(quadric: &Quadric, canonical: DVec3, o: DVec3, size: DVec2) -> Place {
    let stretches = quadric.stretches();
    let covered = || stretches.iter().filter(|[low, high]| low < high);
    let low = covered().map(|[low, _]| *low).fold(f64::INFINITY, f64::min);
    let high = covered().map(|[_, high]| *high).fold(f64::NEG_INFINITY, f64::max);
    let repeats_up = high - low == f64::INFINITY;
    let v = if repeats_up { 0.5 + o.y / size.y } else { (canonical.y - low) / (high - low) };
    Place { uv: DVec2::new(longitude(canonical), v), repeats_up }
}

/// On a flat face: upright, a copy stands about the origin.
fn flat(o: DVec3, n: DVec3, size: DVec2) -> Place {
    let (right, up) = upright(n);
    Place { uv: 0.5 + DVec2::new(o.dot(right), o.dot(up)) / size, repeats_up: true }
}

/// Around the y axis from −z by way of −x, +z and +x, in [0, 1].
fn longitude(o: DVec3) -> f64 {
    0.5 + atan2(o.x, o.z) / (2.0 * PI)
}

/// The colour of a paint at a point of a surface.
pub fn paint(scene: &Scene, paint: Paint, spot: &Spot) -> Rgb {
    match paint {
        Paint::Plain(color) => color,
        Paint::Texture(id) => texture(scene, id, spot),
    }
}

fn texture(scene: &Scene, id: TextureId, spot: &Spot) -> Rgb {
    let either = |odd: bool, a: Paint, b: Paint| paint(scene, if odd { b } else { a }, spot);
    match scene.textures[id.0 as usize] {
        Texture::Checker { a, b, size } => {
            let cell = spot.within(size).floor();
            either(is_odd(cell.x + cell.y + cell.z), a, b)
        }
        Texture::Stripes { a, b, width, along } => {
            either(is_odd(spot.within(width).dot(along).floor()), a, b)
        }
        Texture::Noise { a, b, size, octaves, seed } => {
            let t = clouds(spot.o / size, octaves, seed);
            (1.0 - t) * paint(scene, a, spot) + t * paint(scene, b, spot)
        }
        Texture::Image { image, size } => {
            let Place { uv, repeats_up } = spot.place(size);
            bilinear(&scene.images[image.0 as usize], uv, repeats_up)
        }
    }
}

fn is_odd(whole: f64) -> bool {
    whole.rem_euclid(2.0) >= 1.0
}

/// Fractal noise in [0, 1]: octaves of gradient noise, each twice as fine and half as strong as the last, scaled
/// such that the contrast does not depend on their number.
pub(super) fn clouds(p: DVec3, octaves: u32, seed: u64) -> f64 {
    let (mut sum, mut squares, mut strength, mut frequency) = (0.0, 0.0, 1.0, 1.0);
    for octave in 0..octaves {
        let key = mix(mix(seed) ^ u64::from(octave));
        // Noise is 0 at the corners of its lattice: each octave has its own, so that no surface lies along them all.
        let part = |shift: u32| (mix(key ^ u64::from(shift)) >> 11) as f64 / (1u64 << 53) as f64;
        let offset = DVec3::new(part(1), part(2), part(3));
        sum += strength * gradient_noise(frequency * p + offset, key);
        squares += strength * strength;
        strength *= 0.5;
        frequency *= 2.0;
    }
    // What is not a number, far outside, counts as low.
    let t = 0.5 + CONTRAST * sum / f64::sqrt(squares);
    if t.is_nan() { 0.0 } else { t.clamp(0.0, 1.0) }
}

/// Gradient noise in about [−1, 1], 0 at the corners of the unit lattice (Ken Perlin, "Improving noise", 2002), with
/// the gradients chosen by a hash.
fn gradient_noise(p: DVec3, key: u64) -> f64 {
    let cell = p.floor();
    let within = p - cell;
    let corner = |x: f64, y: f64, z: f64| {
        let at = cell + DVec3::new(x, y, z);
        let hash = [at.x, at.y, at.z].iter().fold(key, |key, at| mix(key ^ (*at as i64 as u64)));
        gradient(hash).dot(within - DVec3::new(x, y, z))
    };
    let fade = |t: f64| t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    let between = |a: f64, b: f64, t: f64| a + t * (b - a);
    let (u, v, w) = (fade(within.x), fade(within.y), fade(within.z));
    let edge = |y: f64, z: f64| between(corner(0.0, y, z), corner(1.0, y, z), u);
    let face = |z: f64| between(edge(0.0, z), edge(1.0, z), v);
    between(face(0.0), face(1.0), w)
}

/// One of the twelve directions to the middles of a cube's edges.
fn gradient(hash: u64) -> DVec3 {
    let sign = |bit: u32| if hash >> bit & 1 == 0 { 1.0 } else { -1.0 };
    match (hash >> 8) % 3 {
        0 => DVec3::new(sign(0), sign(1), 0.0),
        1 => DVec3::new(sign(0), 0.0, sign(1)),
        _ => DVec3::new(0.0, sign(0), sign(1)),
    }
}

/// A picture between its pixels. It repeats to the sides; above and below too, or else goes on as its edge.
pub(super) fn bilinear(image: &Image, uv: DVec2, repeats_up: bool) -> Rgb {
    // So far out that the place is no number, any will do.
    let uv = if uv.is_finite() { uv } else { DVec2::ZERO };
    let (width, height) = (f64::from(image.width()), f64::from(image.height()));
    let (x, y) = (uv.x * width - 0.5, (1.0 - uv.y) * height - 0.5);
    let column = |x: f64| x.floor().rem_euclid(width).min(width - 1.0) as u32;
    let row = |y: f64| {
        let y = y.floor();
        let y = if repeats_up { y.rem_euclid(height) } else { y.max(0.0) };
        y.min(height - 1.0) as u32
    };
    let (right, down) = (x - x.floor(), y - y.floor());
    let line = |y: f64| {
        let row = row(y);
        (1.0 - right) * image.pixel(column(x), row) + right * image.pixel(column(x + 1.0), row)
    };
    (1.0 - down) * line(y) + down * line(y + 1.0)
}
