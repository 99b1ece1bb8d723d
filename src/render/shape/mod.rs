//! Where rays meet surfaces.
//!
//! There is no distance that counts as "too near": a ray that starts on a surface knows so, and solves it with
//! the constant term of its equation exactly zero. The root 0 is then the start itself and drops out, and the
//! other root is as exact as any. So rooms of giant spheres show no acne and leak no light.
//!
//! Single precision needs the right form of the equation for each kind of surface:
//!
//! | kind | form | because |
//! |---|---|---|
//! | [`flat`] | signed height over the plane, from the camera | its constant is the camera's height, small where it matters |
//! | [`giant`] | the same with a curvature: no centre, no radius | centre and radius are large numbers whose difference matters |
//! | [`ball`] | offset of the ray from the centre (Haines et al., *Ray Tracing Gems*, ch. 7) | radius squared is lost beside a distance squared |
//! | [`quadric`] | object space, from the point of the ray next to the middle | both |

pub mod ball;
pub mod flat;
pub mod giant;
pub mod quadric;

use super::lanes::{Float, Lanes, Mask, One, Word};
use super::vector::V;
use crate::math::DVec3;
use crate::scene::Material;

/// A half-line a lane, and the surface it starts on.
#[derive(Clone, Copy)]
pub struct Rays<L: Lanes> {
    /// Where it starts.
    pub o: V<L>,
    /// Unit vector.
    pub d: V<L>,
    /// The place that `o` lies on: see [`encode`]; [`NOWHERE`] if it is on no surface.
    pub start: L::U,
    /// The detail of that place.
    pub detail: L::U,
}

/// What rays meet.
#[derive(Clone, Copy)]
pub struct Hits<L: Lanes> {
    /// Distance; infinite where nothing is met.
    pub t: L::F,
    /// The place, [`NOWHERE`] where nothing is met: see [`encode`].
    pub place: L::U,
    /// The detail of the place.
    pub detail: L::U,
}

/// The place of what is on no surface.
pub const NOWHERE: u32 = u32::MAX;

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

/// Bits of a place that tell the face.
pub const FACE_BITS: u32 = 2;

/// Faces that a place tells; the last says to look at the detail.
const CODES: [u32; 4] = [0, 1, 2, 3];
/// Of a detail: the wall of a box, not a triangle.
const WALL: u32 = 1 << 31;

/// The place of a face of a surface, and the detail that tells the face where the place does not.
#[inline(always)]
pub const fn encode(slot: u32, face: Face) -> (u32, u32) {
    let [side, low, high, other] = CODES;
    let (code, detail) = match face {
        Face::Side => (side, 0),
        Face::Low => (low, 0),
        Face::High => (high, 0),
        Face::Wall(wall) => (other, WALL | (wall.axis as u32) << 1 | wall.upper as u32),
        Face::Triangle(triangle) => (other, triangle),
    };
    (slot << FACE_BITS | code, detail)
}

/// The place of a face of the surface in a slot.
#[inline(always)]
pub const fn place(slot: u32, face: Face) -> u32 {
    encode(slot, face).0
}

/// The slot of a place.
#[inline(always)]
pub const fn slot(place: u32) -> u32 {
    place >> FACE_BITS
}

/// The face of a place.
#[inline(always)]
pub const fn decode(place: u32, detail: u32) -> Face {
    match place & ((1 << FACE_BITS) - 1) {
        0 => Face::Side,
        1 => Face::Low,
        2 => Face::High,
        _ if detail & WALL == 0 => Face::Triangle(detail),
        _ => Face::Wall(Wall { axis: (detail >> 1 & 3) as u8, upper: detail & 1 == 1 }),
    }
}

/// What a surface is made of, as far as rays care.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Nature {
    /// A ray to what glows must not be stopped by it.
    pub glows: bool,
    /// No light comes from below.
    pub opaque: bool,
}

impl Nature {
    /// That of what is made of a material.
    pub fn of(material: &Material) -> Nature {
        Nature {
            glows: matches!(material, Material::Emitter { .. }),
            opaque: !matches!(material, Material::Dielectric { .. }),
        }
    }
}

impl<L: Lanes> Rays<L> {
    /// One of them.
    #[inline(always)]
    pub fn lane(&self, lane: usize) -> Rays<One> {
        Rays {
            o: V::splat(One, self.o.get(lane)),
            d: V::splat(One, self.d.get(lane)),
            start: One.u(self.start.get(lane)),
            detail: One.u(self.detail.get(lane)),
        }
    }
}

impl<L: Lanes> Hits<L> {
    /// One of them.
    #[inline(always)]
    pub fn lane(&self, lane: usize) -> Hits<One> {
        Hits { t: self.t.get(lane), place: One.u(self.place.get(lane)), detail: One.u(self.detail.get(lane)) }
    }

    /// Sets one of them.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, hit: &Hits<One>) {
        self.t.set(lane, hit.t);
        self.place.set(lane, hit.place.get(0));
        self.detail.set(lane, hit.detail.get(0));
    }
}

impl Hits<One> {
    /// Takes another hit if it is nearer, or as near and in an earlier place; but for the surface in a slot.
    #[inline(always)]
    pub fn take(&mut self, other: Hits<One>, except: u32) {
        let (place, known) = (other.place.get(0), self.place.get(0));
        if (other.t < self.t || other.t == self.t && place < known) && slot(place) != except {
            *self = other;
        }
    }
}

/// A point of a surface a lane.
#[derive(Clone, Copy)]
pub struct Points<L: Lanes> {
    /// Where.
    pub p: V<L>,
    /// Unit normal, outwards where the shape is closed.
    pub n: V<L>,
    /// Unit normal to shade with, on the same side: that of the round surface which a smooth mesh stands for.
    pub shading: V<L>,
}

impl<L: Lanes> Hits<L> {
    /// Nothing is met.
    #[inline(always)]
    pub fn nothing(l: L) -> Hits<L> {
        Hits { t: l.f(f32::INFINITY), place: l.u(NOWHERE), detail: l.u(0) }
    }
}

/// What all surfaces need to know of rays, computed once.
#[derive(Clone, Copy)]
pub struct Bundle<L: Lanes> {
    /// The rays.
    pub rays: Rays<L>,
    /// o·d.
    pub od: L::F,
    /// o·o.
    pub oo: L::F,
    /// By how much a height over a surface may be wrong.
    pub slop: L::F,
}

/// Rounding of a height relative to the coordinates that it is computed from.
pub const ROUNDING: f32 = 1.0 / (1 << 20) as f32;

impl<L: Lanes> Bundle<L> {
    /// Computes it.
    #[inline(always)]
    pub fn new(rays: Rays<L>) -> Bundle<L> {
        let (o, d) = (rays.o, rays.d);
        let slop = (o.x.magnitude() + o.y.magnitude() + o.z.magnitude()) * ROUNDING;
        Bundle { rays, od: o.dot(d), oo: o.squared(), slop }
    }
}

/// A distance as a fraction, so that distances are compared without dividing.
#[derive(Clone, Copy)]
pub struct Ratios<L: Lanes> {
    /// Above 0 where something is met, and then both are.
    pub over: L::F,
    /// See `over`.
    pub under: L::F,
}

impl<L: Lanes> Ratios<L> {
    /// Whether it is the lesser, and of something that is met.
    #[inline(always)]
    pub fn ahead_of(self, l: L, other: Ratios<L>) -> L::M {
        l.f(0.0).lt(self.over) & (self.over * other.under).lt(other.over * self.under)
    }
}

/// The least root above 0 of a t² + 2bt + c = 0 with a > 0, by b, c, the root of b² − ac and 1/a. With w = |b| + root, the
/// roots are those of the signs of b and c: c/w where they differ, from outside or towards a near wall; else w/a, to the
/// far side; or none.
#[inline(always)]
fn first_ahead<L: Lanes>(l: L, b: L::F, c: L::F, root: L::F, inverse: L::F) -> Ratios<L> {
    let zero = l.f(0.0);
    let w = b.magnitude() + root;
    // Inside or on the surface, and not towards the near side.
    let away = c.le(zero) & b.le(zero);
    let behind = zero.le(c) & zero.le(b);
    let far = away & !behind;
    Ratios { over: behind.pick(-w, far.pick(w * inverse, c.magnitude())), under: far.pick(l.f(1.0), w) }
}

/// A height over an opaque surface of which so much may be due to rounding: what is below by no more than that is on it.
#[inline(always)]
fn lifted<L: Lanes>(l: L, height: L::F, slop: L::F) -> L::F {
    (height + slop).lesser(height.greater(l.f(0.0)))
}
