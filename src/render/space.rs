//! The tracer's own coordinates: single precision, from the camera.
//!
//! Metres of the world become multiples of a unit, counted from where the camera is, so that what the picture shows
//! near the camera is resolved finest, and squares of lengths stay within single precision's range.

use super::lanes::Lanes;
use super::vector::V;
use crate::math::{DVec3, exp2, ln};

/// Where the tracer's coordinates lie in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Space {
    /// The camera.
    origin: DVec3,
    /// Metres in a unit of length, a power of two.
    unit: f64,
}

/// Sizes of scenes in metres that are traced in metres.
const METRES: std::ops::RangeInclusive<f64> = 1e-3..=1e6;

impl Space {
    /// Coordinates about a point, for things that are mostly about this far away.
    pub fn new(origin: DVec3, size: f64) -> Space {
        let usual = METRES.contains(&size) || !(1e-300..1e300).contains(&size);
        let unit = if usual { 1.0 } else { exp2((ln(size) / std::f64::consts::LN_2).round()) };
        Space { origin, unit }
    }

    /// A length.
    pub fn length(&self, metres: f64) -> f64 {
        metres / self.unit
    }

    /// Metres in a unit of length.
    #[inline]
    pub fn unit(&self) -> f64 {
        self.unit
    }

    /// A point.
    #[inline]
    pub fn point(&self, p: DVec3) -> DVec3 {
        (p - self.origin) / self.unit
    }

    /// A point of the world.
    #[inline]
    pub fn world<L: Lanes>(&self, p: V<L>, lane: usize) -> DVec3 {
        double(p, lane) * self.unit + self.origin
    }
}

/// One lane in double precision.
#[inline]
pub fn double<L: Lanes>(v: V<L>, lane: usize) -> DVec3 {
    let [x, y, z] = v.get(lane);
    DVec3::new(f64::from(x), f64::from(y), f64::from(z))
}
