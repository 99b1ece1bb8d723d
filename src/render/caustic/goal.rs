//! What chains are to lead to: lamps, as far as aiming cares, in the tracer's coordinates.

use crate::render::light::Source;

/// A lamp.
#[derive(Clone, Copy, Debug)]
pub struct Goal {
    /// Which.
    pub source: Source,
    /// Its place among the lights.
    pub lamp: u32,
    /// Where.
    pub target: Target,
    /// About its power; of a distant one its irradiance.
    pub strength: f32,
    /// Luminance of its mean radiance; none of one that no ray finds by chance.
    pub radiance: Option<f32>,
}

/// Where a lamp is. The size is 0 for one that no ray finds by chance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target {
    /// Within a ball.
    Near {
        /// Its centre.
        center: [f32; 3],
        /// Its radius.
        radius: f32,
    },
    /// A distant disc.
    Far {
        /// Towards its centre.
        direction: [f32; 3],
        /// Sine of its angular radius.
        sine: f32,
    },
}

impl Target {
    /// Radius of the ball, or sine of the disc.
    pub fn size(&self) -> f32 {
        match *self {
            Target::Near { radius, .. } => radius,
            Target::Far { sine, .. } => sine,
        }
    }

    /// Whether no ray finds it by chance.
    pub fn is_point(&self) -> bool {
        self.size() == 0.0
    }
}
