//! Watching what paths do.

use super::light::Source;
use super::shape::Face;
use crate::color::Rgb;
use crate::math::DVec3;
use crate::scene::PrimitiveId;

/// Told what a path does as it happens. The integrator is generic over it, so that the one that does nothing
/// costs nothing.
pub trait Observer {
    /// Whether it wants to be told anything at all.
    const WATCHES: bool = true;

    /// The path is scattered at a surface.
    fn scattered(&mut self, vertex: &Vertex) {
        let _ = vertex;
    }

    /// Light reaches the camera along the path. The contributions of a path add up to its radiance.
    fn contributed(&mut self, contribution: &Contribution) {
        let _ = contribution;
    }

    /// The limit of bounces ends the path at a surface, with this throughput left.
    fn cut(&mut self, place: Place, throughput: Rgb) {
        let _ = (place, throughput);
    }
}

/// A surface, and which face of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// The surface.
    pub primitive: PrimitiveId,
    /// Which of its faces.
    pub face: Face,
}

/// Where a path is scattered.
#[derive(Clone, Copy, Debug)]
pub struct Vertex {
    /// How many scattering events went before.
    pub bounce: u32,
    /// The surface.
    pub place: Place,
    /// Where.
    pub p: DVec3,
    /// Unit normal, outwards.
    pub n: DVec3,
    /// What a unit of radiance that arrives at the vertex adds to the camera's, before it is scattered.
    pub throughput: Rgb,
    /// Whether by a mirror or clear glass.
    pub specular: bool,
}

/// Light that reaches the camera.
#[derive(Clone, Copy, Debug)]
pub struct Contribution {
    /// Where it comes from.
    pub source: Source,
    /// Scattering events between the source and the camera.
    pub bounces: u32,
    /// Scattering events among them that were neither at a mirror nor at clear glass.
    pub rough_bounces: u32,
    /// Added to the sample, in W/(m²·sr).
    pub radiance: Rgb,
}

impl Observer for () {
    const WATCHES: bool = false;
}
