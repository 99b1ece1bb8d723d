//! Axis-aligned boxes.

use crate::math::{DAffine3, DVec3};

/// An axis-aligned box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Least corner.
    pub min: DVec3,
    /// Greatest corner.
    pub max: DVec3,
}

impl Bounds {
    /// Contains nothing; the identity of [`Bounds::union`].
    pub const EMPTY: Bounds = Bounds { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };

    /// The cube [−1, 1]³.
    pub const CUBE: Bounds = Bounds { min: DVec3::NEG_ONE, max: DVec3::ONE };

    /// The smallest box around both.
    pub fn union(self, other: Bounds) -> Bounds {
        Bounds { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The smallest box around what a map makes of it.
    pub fn mapped(self, map: &DAffine3) -> Bounds {
        let (half, m) = (0.5 * self.size(), map.matrix3);
        let reach = half.x * m.x_axis.abs() + half.y * m.y_axis.abs() + half.z * m.z_axis.abs();
        let center = map.transform_point3(self.center());
        Bounds { min: center - reach, max: center + reach }
    }

    /// The point in the middle.
    pub fn center(self) -> DVec3 {
        0.5 * (self.min + self.max)
    }

    /// Edge lengths.
    pub fn size(self) -> DVec3 {
        self.max - self.min
    }

    /// Whether it contains no point.
    pub fn is_empty(self) -> bool {
        self.min.cmpgt(self.max).any()
    }

    /// Twice the area of its surface over two: the measure of the surface-area heuristic.
    pub fn half_area(self) -> f64 {
        let size = self.size();
        size.x * size.y + size.y * size.z + size.z * size.x
    }
}
