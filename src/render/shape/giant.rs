//! Spheres so large that they are seen from near: walls, planets.
//!
//! With the gradient g and the height h at the origin of ½(|p − c|² − r²)/r, whose gradient is a unit vector on the
//! sphere, and κ = 1/r: f(p) = ½κ|p|² + g·p + h. No term is larger than the distances that are looked at.

use super::{Bundle, Nature, ROUNDING, Ratios, first_ahead, lifted};
use crate::math::DVec3;
use crate::render::lanes::{Float, Lanes, Mask, Word};
use crate::render::vector::{V, single};

/// A giant sphere as seen from the origin.
#[derive(Clone, Copy, Debug)]
pub struct Giant {
    /// Gradient at the origin.
    pub g: [f32; 3],
    /// f at the origin.
    pub height: f32,
    /// One over the radius.
    pub curvature: f32,
    /// The radius.
    pub radius: f32,
    /// As of a plane.
    pub slop: [f32; 2],
    /// Whether it glows.
    pub glows: bool,
}

/// How many times its distance from the camera the radius of a giant is at least.
const GIANT: f64 = 2.0;

impl Giant {
    /// Whether a sphere is one.
    pub fn is(center: DVec3, radius: f64) -> bool {
        radius >= GIANT * (center.length() - radius).abs()
    }

    /// The sphere about a centre.
    pub fn new(center: DVec3, radius: f64, nature: Nature) -> Giant {
        let distance = center.length();
        let height = (distance - radius) * (0.5 * (distance + radius) / radius);
        let own = if nature.opaque { height.abs() as f32 * ROUNDING } else { 0.0 };
        Giant {
            g: single(-center / radius),
            height: height as f32,
            curvature: (1.0 / radius) as f32,
            radius: radius as f32,
            slop: [own, f32::from(u8::from(nature.opaque))],
            glows: nature.glows,
        }
    }

    /// The least distance above 0.
    #[inline(always)]
    pub fn meet<L: Lanes>(&self, l: L, bundle: &Bundle<L>, place: u32) -> Ratios<L> {
        let g = V::splat(l, self.g);
        let slope = g.dot(bundle.rays.d) + bundle.od * self.curvature;
        let height = g.dot(bundle.rays.o) + bundle.oo * (0.5 * self.curvature) + self.height;
        let height = lifted(l, height, bundle.slop * self.slop[1] + self.slop[0]);
        let height = bundle.rays.start.is(l.u(place)).pick(l.f(0.0), height);
        // κt² + 2·slope·t + 2·height = 0.
        let twice = height + height;
        let root = (slope * slope - twice * self.curvature).root();
        first_ahead(l, slope, twice, root, l.f(self.radius))
    }
}
