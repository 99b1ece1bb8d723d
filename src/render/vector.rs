//! Vectors and colours in lanes.

use super::lanes::{Float, Lanes, Mask};
use crate::math::DVec3;
use std::ops::{Add, Mul, Neg, Sub};

/// A vector, point or colour a lane.
#[derive(Clone, Copy)]
pub struct V<L: Lanes> {
    pub x: L::F,
    pub y: L::F,
    pub z: L::F,
}

impl<L: Lanes> V<L> {
    #[inline(always)]
    pub fn new(x: L::F, y: L::F, z: L::F) -> V<L> {
        V { x, y, z }
    }

    /// The same number in all components.
    #[inline(always)]
    pub fn all(v: L::F) -> V<L> {
        V { x: v, y: v, z: v }
    }

    /// The same vector in every lane.
    #[inline(always)]
    pub fn splat(l: L, [x, y, z]: [f32; 3]) -> V<L> {
        V { x: l.f(x), y: l.f(y), z: l.f(z) }
    }

    #[inline(always)]
    pub fn dot(self, b: V<L>) -> L::F {
        self.x * b.x + self.y * b.y + self.z * b.z
    }

    #[inline(always)]
    pub fn cross(self, b: V<L>) -> V<L> {
        V { x: self.y * b.z - self.z * b.y, y: self.z * b.x - self.x * b.z, z: self.x * b.y - self.y * b.x }
    }

    /// In one direction of each component's own.
    #[inline(always)]
    pub fn times(self, b: V<L>) -> V<L> {
        V { x: self.x * b.x, y: self.y * b.y, z: self.z * b.z }
    }

    #[inline(always)]
    pub fn squared(self) -> L::F {
        self.dot(self)
    }

    #[inline(always)]
    pub fn normalized(self, l: L) -> V<L> {
        self * (l.f(1.0) / self.squared().root())
    }

    /// The greatest component.
    #[inline(always)]
    pub fn max(self) -> L::F {
        self.x.greater(self.y).greater(self.z)
    }

    /// Luminance of a linear colour (ITU-R BT.709).
    #[inline(always)]
    pub fn luminance(self) -> L::F {
        self.x * 0.2126 + self.y * 0.7152 + self.z * 0.0722
    }

    /// The one where the mask holds, else the other.
    #[inline(always)]
    pub fn pick(mask: L::M, yes: V<L>, no: V<L>) -> V<L> {
        V { x: mask.pick(yes.x, no.x), y: mask.pick(yes.y, no.y), z: mask.pick(yes.z, no.z) }
    }

    #[inline(always)]
    pub fn get(self, lane: usize) -> [f32; 3] {
        [self.x.get(lane), self.y.get(lane), self.z.get(lane)]
    }

    #[inline(always)]
    pub fn set(&mut self, lane: usize, [x, y, z]: [f32; 3]) {
        self.x.set(lane, x);
        self.y.set(lane, y);
        self.z.set(lane, z);
    }
}

impl<L: Lanes> Add for V<L> {
    type Output = V<L>;
    #[inline(always)]
    fn add(self, b: V<L>) -> V<L> {
        V { x: self.x + b.x, y: self.y + b.y, z: self.z + b.z }
    }
}

impl<L: Lanes> Sub for V<L> {
    type Output = V<L>;
    #[inline(always)]
    fn sub(self, b: V<L>) -> V<L> {
        V { x: self.x - b.x, y: self.y - b.y, z: self.z - b.z }
    }
}

/// By a number of each lane's own.
impl<L: Lanes<F = F>, F: Float<L>> Mul<F> for V<L> {
    type Output = V<L>;
    #[inline(always)]
    fn mul(self, b: F) -> V<L> {
        V { x: self.x * b, y: self.y * b, z: self.z * b }
    }
}

impl<L: Lanes> Neg for V<L> {
    type Output = V<L>;
    #[inline(always)]
    fn neg(self) -> V<L> {
        V { x: -self.x, y: -self.y, z: -self.z }
    }
}

/// Two unit vectors that make a right-handed frame (x, y, `z`) with the unit vector `z`: as [`crate::math::basis`].
#[inline(always)]
pub fn basis<L: Lanes>(l: L, z: V<L>) -> (V<L>, V<L>) {
    let sign = l.f(1.0).signed_as(z.z);
    let a = l.f(-1.0) / (sign + z.z);
    let b = z.x * z.y * a;
    (V::new(sign * z.x * z.x * a + 1.0, sign * b, -(sign * z.x)), V::new(b, sign + z.y * z.y * a, -z.y))
}

/// A direction of the local frame about the unit vector `z`, in the world.
#[inline(always)]
pub fn towards<L: Lanes>(l: L, z: V<L>, local: V<L>) -> V<L> {
    let (x, y) = basis(l, z);
    x * local.x + y * local.y + z * local.z
}

/// Rounds to single precision.
pub fn single(v: DVec3) -> [f32; 3] {
    [v.x as f32, v.y as f32, v.z as f32]
}
