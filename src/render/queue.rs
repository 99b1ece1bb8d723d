//! Paths that wait for a lane.
//!
//! Camera rays are made for all lanes at once, and handed out one by one as lanes become free.

use super::camera::Eye;
use super::lanes::{Float, Lanes, MOST, Word};
use super::path::Paths;
use super::sampler::{Sampler, seed_key};
use super::vector::V;
use crate::color::Rgb;

/// A path to trace.
#[derive(Clone, Copy, Debug, Default)]
pub struct Job {
    /// Column of the full picture.
    pub x: u32,
    /// Row of the full picture.
    pub y: u32,
    /// Which of the pixel's samples.
    pub sample: u32,
    /// Whose radiance it is, as told to [`Jobs::finish`].
    pub pixel: u32,
}

/// What a path brings.
#[derive(Clone, Copy, Debug)]
pub struct Arrived {
    /// As told in [`Job::pixel`].
    pub pixel: u32,
    /// Radiance along the camera ray, in multiples of the unit.
    pub radiance: [f32; 3],
    /// Its weight in the pixel.
    pub weight: f32,
    /// Whether the ray met nothing in front of a transparent background.
    pub open: bool,
}

/// Where paths come from, and where their radiance goes.
pub trait Jobs {
    /// The next path, if any is left.
    fn next(&mut self) -> Option<Job>;
    /// Takes what a path brought that has ended.
    fn finish(&mut self, arrived: &Arrived);
    /// The limit of bounces ends a path, with this throughput left.
    fn cut(&mut self, throughput: Rgb) {
        let _ = throughput;
    }
}

/// How paths begin.
pub struct View<'a> {
    eye: &'a Eye,
    seed: [u32; 2],
    /// Whether caustics are looked for.
    pub(super) looks: bool,
}

impl<'a> View<'a> {
    /// Rays of an eye, with random numbers of a seed.
    pub fn new(eye: &'a Eye, seed: u64) -> View<'a> {
        View { eye, seed: seed_key(seed), looks: true }
    }

    /// The same with caustics left to luck.
    pub fn by_luck(self) -> View<'a> {
        View { looks: false, ..self }
    }
}

/// Numbers of a queue: rays for all lanes, and as many again so that all lanes can be read from its last.
const ROOM: usize = 2 * MOST;

/// Camera rays that are ready.
pub struct Queue<L: Lanes> {
    reals: [[f32; ROOM]; 7],
    words: [[u32; ROOM]; 4],
    from: usize,
    to: usize,
    exhausted: bool,
    lanes: std::marker::PhantomData<L>,
}

impl<L: Lanes> Queue<L> {
    pub fn new() -> Queue<L> {
        Queue {
            reals: [[0.0; ROOM]; 7],
            words: [[0; ROOM]; 4],
            from: 0,
            to: 0,
            exhausted: false,
            lanes: std::marker::PhantomData,
        }
    }

    /// How many are ready.
    #[inline(always)]
    pub fn waiting(&self) -> usize {
        self.to - self.from
    }

    /// Makes rays for all lanes if none are ready.
    #[inline(always)]
    pub fn fill(&mut self, l: L, view: &View, jobs: &mut dyn Jobs) {
        if self.waiting() > 0 || self.exhausted {
            return;
        }
        let mut columns = [[0; MOST]; 3];
        let mut count = 0;
        while count < L::N {
            let Some(job) = jobs.next() else {
                self.exhausted = true;
                break;
            };
            columns[0][count] = job.x;
            columns[1][count] = job.y;
            columns[2][count] = job.sample;
            self.words[3][count] = job.pixel;
            count += 1;
        }
        let [x, y, sample] =
            [l.load_words(&columns[0]), l.load_words(&columns[1]), l.load_words(&columns[2])];
        let sampler = Sampler::new(l, view.seed, x, y, sample);
        let rays = view.eye.rays(l, x, y, &sampler);
        let reals = [rays.o.x, rays.o.y, rays.o.z, rays.d.x, rays.d.y, rays.d.z, rays.weight];
        for (column, real) in self.reals.iter_mut().zip(reals) {
            real.store(column);
        }
        for (column, word) in self.words.iter_mut().zip([sampler.key[0], sampler.key[1], sampler.index]) {
            word.store(column);
        }
        (self.from, self.to) = (0, count);
    }

    /// Hands out rays to the lanes of a mask, of which there are so many.
    #[inline(always)]
    pub fn take(&mut self, l: L, fresh: L::M, count: usize, paths: &mut Paths<L>) {
        let at = self.from;
        let Paths { rays, sampler, pixel, weight: weights, .. } = paths;
        let [ox, oy, oz, dx, dy, dz, weight] = &self.reals;
        rays.o = V::new(
            l.load(&ox[at..]).spread(fresh, rays.o.x),
            l.load(&oy[at..]).spread(fresh, rays.o.y),
            l.load(&oz[at..]).spread(fresh, rays.o.z),
        );
        rays.d = V::new(
            l.load(&dx[at..]).spread(fresh, rays.d.x),
            l.load(&dy[at..]).spread(fresh, rays.d.y),
            l.load(&dz[at..]).spread(fresh, rays.d.z),
        );
        let [low, high, index, pixels] = &self.words;
        sampler.key[0] = l.load_words(&low[at..]).spread(fresh, sampler.key[0]);
        sampler.key[1] = l.load_words(&high[at..]).spread(fresh, sampler.key[1]);
        sampler.index = l.load_words(&index[at..]).spread(fresh, sampler.index);
        *pixel = l.load_words(&pixels[at..]).spread(fresh, *pixel);
        self.from += count;
        *weights = l.load(&weight[at..]).spread(fresh, *weights);
    }
}
