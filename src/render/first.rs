//! What camera rays meet first: depth, normal, colour, and which surfaces.

use super::control::{Cancelled, Control};
use super::film::Window;
use super::lanes::Lanes;
use super::level::Task;
use super::observer::{Meeting, Observer};
use super::path;
use super::queue::{Arrived, Job, Jobs, View};
use super::{TILE, Tracer};
use crate::color::Rgb;
use crate::math::DVec3;
use crate::scene::{Camera, PrimitiveId};
use rayon::prelude::*;

/// The most samples of a pixel whose rays are asked what they meet first: that is known well long before light is.
pub const MOST_FIRST_SAMPLES: u32 = 64;

/// What a camera ray meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct First {
    primitive: PrimitiveId,
    depth: f64,
    n: DVec3,
    color: Rgb,
}

impl First {
    /// A meeting as seen by a camera.
    pub(super) fn new(meeting: &Meeting, camera: &Camera) -> First {
        First {
            primitive: meeting.place.primitive,
            depth: (meeting.p - camera.position).dot(camera.forward),
            n: meeting.n,
            color: meeting.color,
        }
    }

    /// The surface.
    pub(super) fn primitive(&self) -> PrimitiveId {
        self.primitive
    }
}

/// What the rays of a pixel meet first, each counting as much as its weight in the pixel, which a filter may make negative,
/// is large: with signs there were shares beyond 1, and depths where nothing is. Added up in the order of samples, it has the
/// same bits for any number of threads and lanes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Firsts {
    /// Of all samples, and of those that meet something.
    weight: f64,
    met: f64,
    depth: f64,
    normal: DVec3,
    color: Rgb,
    shown: Vec<(PrimitiveId, f64)>,
}

impl Firsts {
    /// Those of some rays, in their order.
    fn of<'r>(rays: impl Iterator<Item = &'r Ray>) -> Firsts {
        let mut firsts = Firsts::default();
        rays.for_each(|(weight, first)| firsts.add(f64::from(*weight), first.as_ref()));
        firsts
    }

    /// Adds a sample of a weight, and what it meets.
    pub(super) fn add(&mut self, weight: f64, first: Option<&First>) {
        let weight = weight.abs();
        self.weight += weight;
        let Some(first) = first else { return };
        self.met += weight;
        self.depth += weight * first.depth;
        self.normal += weight * first.n;
        self.color += weight * first.color;
        match self.shown.iter_mut().find(|(known, _)| *known == first.primitive) {
            Some((_, sum)) => *sum += weight,
            None => self.shown.push((first.primitive, weight)),
        }
    }

    /// Distance in metres from the camera along its axis, as the lens's `focus` counts: the mean over the rays that meet
    /// something; none where none does.
    pub fn depth(&self) -> Option<f64> {
        self.over_met(self.depth)
    }

    /// The normal to shade with, on the side of the camera, in the world: the mean over the rays that meet something, so that
    /// it is shorter than 1 where they differ.
    pub fn normal(&self) -> Option<DVec3> {
        Some(DVec3::new(
            self.over_met(self.normal.x)?,
            self.over_met(self.normal.y)?,
            self.over_met(self.normal.z)?,
        ))
    }

    /// The colour of the materials, as [`Meeting::color`] has it: the mean over all rays, of which those that meet nothing
    /// are black.
    pub fn albedo(&self) -> Rgb {
        if self.weight > 0.0 { self.color / self.weight } else { Rgb::ZERO }
    }

    /// The surfaces with the shares of the pixel that they cover, the largest first; equal ones by id. With that of the
    /// [background](Firsts::background) they add up to 1.
    pub fn shown(&self) -> Vec<(PrimitiveId, f64)> {
        let share = |(id, sum): &(PrimitiveId, f64)| (*id, sum / self.weight);
        let mut shown: Vec<_> = self.shown.iter().map(share).filter(|(_, share)| *share > 0.0).collect();
        shown.sort_by(|(a, x), (b, y)| y.total_cmp(x).then(a.cmp(b)));
        shown
    }

    /// The share of the pixel whose rays meet nothing.
    pub fn background(&self) -> f64 {
        if self.met < self.weight { (self.weight - self.met) / self.weight } else { 0.0 }
    }

    fn over_met(&self, sum: f64) -> Option<f64> {
        (self.met > 0.0).then(|| sum / self.met)
    }
}

/// Numbers of a pixel's guide: the normal, the albedo, and how near it is.
pub const GUIDES: usize = 7;

/// What tells the things of a picture apart, known long before its light is: of every pixel, row by row, the normal and the
/// albedo as [`Firsts`] has them, and the nearness, 1 at the camera, 1/2 as far away as things are most typically, and 0 where
/// nothing is met. Once by the first half of some rays, and once by the others.
pub type Guides = [Vec<[f32; GUIDES]>; 2];

/// What the camera's rays of a window meet first.
#[derive(Clone, Debug)]
pub struct FirstHits {
    window: Window,
    /// Row by row.
    pixels: Vec<Firsts>,
}

impl FirstHits {
    /// The part of the full picture that it covers.
    pub fn window(&self) -> Window {
        self.window
    }

    /// Those of a pixel of the full picture, which lies in the window.
    pub fn pixel(&self, x: u32, y: u32) -> &Firsts {
        &self.pixels[self.window.index(x, y)]
    }
}

impl Tracer<'_> {
    /// Finds what the rays of the first samples of each pixel meet first, [`MOST_FIRST_SAMPLES`] at most: the very rays that
    /// the picture is made of.
    ///
    /// # Errors
    ///
    /// If the control cancels.
    pub fn first_hits(
        &self,
        window: Window,
        samples: u32,
        control: &Control,
    ) -> Result<FirstHits, Cancelled> {
        let samples = samples.clamp(1, MOST_FIRST_SAMPLES);
        let pixels = self.of_firsts(window, samples, control, &|rays| Firsts::of(rays.iter()))?;
        Ok(FirstHits { window, pixels })
    }

    /// Finds the guides of a window in the same way, by 2 samples of each pixel at least.
    ///
    /// # Errors
    ///
    /// If the control cancels.
    pub fn guides(&self, window: Window, samples: u32, control: &Control) -> Result<Guides, Cancelled> {
        let samples = samples.clamp(2, MOST_FIRST_SAMPLES);
        let guide = |firsts: &Firsts| {
            let (n, color) = (firsts.normal().unwrap_or(DVec3::ZERO), firsts.albedo());
            let near = firsts.depth().map_or(0.0, |depth| self.size / (self.size + depth.max(0.0)));
            [n.x, n.y, n.z, color.x, color.y, color.z, near].map(|v| v as f32)
        };
        let halves = |rays: &[Ray]| {
            let (some, others) = rays.split_at(rays.len() / 2);
            [some, others].map(|rays| guide(&Firsts::of(rays.iter())))
        };
        let both = self.of_firsts(window, samples, control, &halves)?;
        Ok([0, 1].map(|half| both.iter().map(|pixel| pixel[half]).collect()))
    }

    /// Makes something of what so many rays of each pixel meet first, row by row.
    fn of_firsts<T: Clone + Default + Send>(
        &self,
        window: Window,
        samples: u32,
        control: &Control,
        made: &(dyn Fn(&[Ray]) -> T + Sync),
    ) -> Result<Vec<T>, Cancelled> {
        let tiles: Vec<Window> = window.tiles(TILE).collect();
        let of_tile = |tile: &Window| -> Vec<T> {
            self.rays_of_tile(*tile, samples, control).chunks_exact(samples as usize).map(made).collect()
        };
        let traced: Vec<Vec<T>> = tiles.par_iter().map(of_tile).collect();
        if control.is_cancelled() {
            return Err(Cancelled);
        }
        let mut pixels = vec![T::default(); window.pixels()];
        for (tile, traced) in tiles.iter().zip(traced) {
            for (pixel, index) in traced.into_iter().zip(0..) {
                let (x, y) = (tile.x + index % tile.width, tile.y + index / tile.width);
                pixels[window.index(x, y)] = pixel;
            }
        }
        Ok(pixels)
    }

    /// The rays of a tile, pixel by pixel.
    fn rays_of_tile(&self, tile: Window, samples: u32, control: &Control) -> Vec<Ray> {
        let count = tile.pixels() * samples as usize;
        let mut rays = Rays { tile, samples, next: 0, weights: vec![0.0; count], control };
        let mut meetings = Meetings { camera: &self.scene.camera, firsts: vec![None; count] };
        let view = View::new(&self.eye, self.scene.trace.seed).by_luck();
        self.level.run(FirstTask { tracer: self, view: &view, rays: &mut rays, meetings: &mut meetings });
        rays.weights.into_iter().zip(meetings.firsts).collect()
    }
}

/// The weight of a camera ray in its pixel, and what it meets first.
type Ray = (f32, Option<First>);

struct FirstTask<'a, 's, 'c> {
    tracer: &'a Tracer<'s>,
    view: &'a View<'a>,
    rays: &'a mut Rays<'c>,
    meetings: &'a mut Meetings<'c>,
}

impl Task for FirstTask<'_, '_, '_> {
    type Output = ();
    fn run<L: Lanes>(self, l: L) {
        path::trace(l, self.tracer, self.view, self.rays, self.meetings);
    }
}

/// The camera rays of a tile, pixel by pixel; each has a place of its own.
struct Rays<'a> {
    tile: Window,
    samples: u32,
    next: u32,
    weights: Vec<f32>,
    control: &'a Control,
}

impl Jobs for Rays<'_> {
    fn next(&mut self) -> Option<Job> {
        let place = self.next;
        if place as usize >= self.weights.len() || self.control.is_cancelled() {
            return None;
        }
        self.next += 1;
        let (pixel, sample) = (place / self.samples, place % self.samples);
        let (x, y) = (pixel % self.tile.width, pixel / self.tile.width);
        Some(Job { x: self.tile.x + x, y: self.tile.y + y, sample, pixel: place })
    }

    fn finish(&mut self, arrived: &Arrived) {
        self.weights[arrived.pixel as usize] = arrived.weight;
    }
}

/// What they meet.
struct Meetings<'a> {
    camera: &'a Camera,
    firsts: Vec<Option<First>>,
}

impl Observer for Meetings<'_> {
    const FOLLOWS: bool = false;

    fn met(&mut self, meeting: &Meeting) {
        self.firsts[meeting.pixel as usize] = Some(First::new(meeting, self.camera));
    }
}
