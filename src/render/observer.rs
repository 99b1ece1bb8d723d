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

    /// Whether paths go on from the first surface that they meet. Where they do not, light is not asked for.
    const FOLLOWS: bool = true;

    /// The path meets a surface. It goes straight through boundaries that part nothing, which are not told.
    fn met(&mut self, meeting: &Meeting) {
        let _ = meeting;
    }

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

/// Where a path meets a surface.
#[derive(Clone, Copy, Debug)]
pub struct Meeting {
    /// The path's, as told to whoever handed it out.
    pub pixel: u32,
    /// How many scattering events went before.
    pub bounce: u32,
    /// The surface.
    pub place: Place,
    /// Where.
    pub p: DVec3,
    /// Unit normal to shade with, on the side that the path comes from.
    pub n: DVec3,
    /// What it is painted with there: how much of white light it reflects or lets through; black of what glows.
    pub color: Rgb,
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
    /// By which way the path leaves the first surface that scatters it, from the camera on; none where nothing does.
    pub first: Option<Way>,
    /// Added to the sample before its weight, in W/(m²·sr).
    pub radiance: Rgb,
}

/// A way on from a surface, against the light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Way {
    /// In any direction, as a matt or rough surface scatters.
    #[default]
    Rough,
    /// Off a mirror, or the polish of something clear.
    Mirrored,
    /// Through something clear.
    Refracted,
}

/// By what kind of path light reaches the camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PathKind {
    /// What glows is seen itself.
    Seen,
    /// From the light to what is seen.
    Direct,
    /// From the light by mirrors and clear glass to what is seen.
    Caustic,
    /// Seen in a mirror or a polished surface, however it got there.
    Mirrored,
    /// Seen through something clear, however it got there.
    Refracted,
    /// By so many other surfaces that scatter, at least one, before the one that is seen.
    Indirect(u32),
}

impl Contribution {
    /// What kind of path it came by.
    pub fn kind(&self) -> PathKind {
        match (self.first, self.rough_bounces) {
            (None, _) => PathKind::Seen,
            (Some(Way::Mirrored), _) => PathKind::Mirrored,
            (Some(Way::Refracted), _) => PathKind::Refracted,
            (Some(Way::Rough), 0 | 1) if self.bounces <= 1 => PathKind::Direct,
            (Some(Way::Rough), 0 | 1) => PathKind::Caustic,
            (Some(Way::Rough), rough) => PathKind::Indirect(rough - 1),
        }
    }
}

/// By which way each of several paths left the first surface that scattered it: a bit a lane. Kept only for observers.
#[derive(Clone, Copy, Default)]
pub(super) struct FirstWays {
    mirrored: u32,
    refracted: u32,
}

impl FirstWays {
    /// Notes the ways of lanes: which are at their first surface, which leave it as from a mirror or clear glass, and which
    /// go through.
    #[inline]
    pub(super) fn note(&mut self, first: u32, specular: u32, through: u32) {
        self.mirrored = self.mirrored & !first | first & specular & !through;
        self.refracted = self.refracted & !first | first & specular & through;
    }

    /// The way of a lane that has left a surface.
    #[inline]
    pub(super) fn of(&self, lane: usize) -> Way {
        match (self.mirrored >> lane & 1, self.refracted >> lane & 1) {
            (1, _) => Way::Mirrored,
            (_, 1) => Way::Refracted,
            _ => Way::Rough,
        }
    }
}

impl Observer for () {
    const WATCHES: bool = false;
}
