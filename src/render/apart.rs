//! A pixel taken apart: from which lights its radiance comes, by which kinds of paths, and what it shows.

use super::Tracer;
use super::film::{self, Pixel};
use super::first::{First, Firsts};
use super::light::Source;
use super::observer::{Contribution, Meeting, Observer, PathKind, Place};
use crate::color::{Rgb, luminance};
use crate::scene::Camera;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::ops::Range;

/// A pixel taken apart. Its mean is a film's to the bit. The parts are what paths say that they bring, and nothing else: they
/// add up to the mean but for rounding, since paths add in single precision and a film in its fixed point.
#[derive(Clone, Debug, PartialEq)]
pub struct Apart {
    scale: f64,
    pixel: Pixel,
    firsts: Firsts,
    clipped: u32,
    parts: BTreeMap<(Source, PathKind), Rgb>,
}

impl Apart {
    /// Nothing yet, to be counted in the units of a film's scale.
    pub fn new(scale: f64) -> Apart {
        let firsts = Firsts::default();
        Apart { scale, pixel: Pixel::default(), firsts, clipped: 0, parts: BTreeMap::new() }
    }

    /// How many samples it holds.
    pub fn samples(&self) -> u32 {
        self.pixel.samples()
    }

    /// How many of them are brighter than the scale has room for. A film cuts them; so are their parts, all alike.
    pub fn clipped(&self) -> u32 {
        self.clipped
    }

    /// As [`Film::mean`](super::Film::mean).
    pub fn mean(&self) -> Rgb {
        self.pixel.mean(self.scale)
    }

    /// As [`Film::error`](super::Film::error).
    pub fn error(&self) -> f64 {
        self.pixel.error(self.scale)
    }

    /// As [`Film::alpha`](super::Film::alpha).
    pub fn alpha(&self) -> f64 {
        self.pixel.alpha()
    }

    /// What its camera rays meet.
    pub fn firsts(&self) -> &Firsts {
        &self.firsts
    }

    /// What each light adds to the mean by each kind of path. Only those that bring anything.
    pub fn parts(&self) -> impl Iterator<Item = (Source, PathKind, Rgb)> {
        self.parts.iter().map(|((source, kind), sum)| (*source, *kind, self.over_samples(*sum)))
    }

    /// What each light adds to the mean, the most first.
    pub fn by_light(&self) -> Vec<(Source, Rgb)> {
        self.gathered(|source, _| source)
    }

    /// What each kind of path adds to the mean, the most first.
    pub fn by_kind(&self) -> Vec<(PathKind, Rgb)> {
        self.gathered(|_, kind| kind)
    }

    fn gathered<K: Ord + Copy>(&self, key: impl Fn(Source, PathKind) -> K) -> Vec<(K, Rgb)> {
        let mut sums: BTreeMap<K, Rgb> = BTreeMap::new();
        for ((source, kind), part) in &self.parts {
            *sums.entry(key(*source, *kind)).or_default() += *part;
        }
        let mut all: Vec<_> = sums.into_iter().map(|(key, sum)| (key, self.over_samples(sum))).collect();
        all.sort_by(|(a, x), (b, y)| luminance(*y).total_cmp(&luminance(*x)).then(a.cmp(b)));
        all
    }

    fn over_samples(&self, sum: Rgb) -> Rgb {
        sum / f64::from(self.samples())
    }

    fn add(&mut self, watched: &Watched) {
        let Sampled { radiance, weight, open } = watched.sampled;
        self.pixel.add(radiance, self.scale);
        self.pixel.cover(open, weight);
        self.firsts.add(weight, watched.first.as_ref());
        let counted = film::counted(radiance, self.scale);
        self.clipped += u32::from(counted != radiance);
        let kept = |counted: f64, whole: f64| if counted == whole { 1.0 } else { counted / whole };
        let kept =
            Rgb::new(kept(counted.x, radiance.x), kept(counted.y, radiance.y), kept(counted.z, radiance.z));
        // Lights that are hidden are told of as well.
        for part in watched.contributions.iter().filter(|part| part.radiance != Rgb::ZERO) {
            *self.parts.entry((part.source, part.kind())).or_default() += weight * kept * part.radiance;
        }
    }
}

/// What one sample adds to its pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sampled {
    /// In W/(m²·sr), by its weight.
    pub radiance: Rgb,
    /// By the reconstruction filter.
    pub weight: f64,
    /// Whether its ray meets nothing in front of a transparent background.
    pub open: bool,
}

/// A path with all that it did.
#[derive(Clone, Debug)]
pub(super) struct Watched {
    /// What it brought.
    pub(super) sampled: Sampled,
    /// What it met first.
    pub(super) first: Option<First>,
    /// What it is made of.
    pub(super) contributions: Vec<Contribution>,
    /// Every surface that it met, in order.
    pub(super) met: Vec<Place>,
    /// Where the limit of bounces ended it, and the throughput that was left.
    pub(super) cut: Option<(Place, Rgb)>,
}

/// Samples that are watched before what they did is added up.
const BLOCK: u32 = 1024;

impl Tracer<'_> {
    /// Adds a range of samples to a pixel that is taken apart, on the current rayon pool. Its mean is that of a film of the same
    /// scale and samples, to the bit.
    pub fn take_apart(&self, [x, y]: [u32; 2], samples: Range<u32>, apart: &mut Apart) {
        for start in samples.clone().step_by(BLOCK as usize) {
            let block = start..samples.end.min(start.saturating_add(BLOCK));
            let watched: Vec<Watched> =
                block.into_par_iter().map(|sample| self.watched([x, y], sample)).collect();
            watched.iter().for_each(|watched| apart.add(watched));
        }
    }

    /// Traces one path and keeps all that it did.
    pub(super) fn watched(&self, [x, y]: [u32; 2], sample: u32) -> Watched {
        let camera = &self.scene.camera;
        let mut watcher = Watcher { camera, first: None, contributions: vec![], met: vec![], cut: None };
        let sampled = self.sample(x, y, sample, &mut watcher);
        let Watcher { first, contributions, met, cut, .. } = watcher;
        Watched { sampled, first, contributions, met, cut }
    }
}

struct Watcher<'a> {
    camera: &'a Camera,
    first: Option<First>,
    contributions: Vec<Contribution>,
    met: Vec<Place>,
    cut: Option<(Place, Rgb)>,
}

impl Observer for Watcher<'_> {
    fn met(&mut self, meeting: &Meeting) {
        self.first.get_or_insert_with(|| First::new(meeting, self.camera));
        self.met.push(meeting.place);
    }

    fn contributed(&mut self, contribution: &Contribution) {
        self.contributions.push(*contribution);
    }

    fn cut(&mut self, place: Place, throughput: Rgb) {
        self.cut = Some((place, throughput));
    }
}
