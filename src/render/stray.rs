//! Rays without pictures, to measure how fast it is found what they meet.

use super::lanes::{Lanes, Mask, One, Word};
use super::shape::{NOWHERE, Rays};
use super::vector::{V, basis};
use super::{Tracer, level};

/// No slot.
const NO_SLOT: u32 = u32::MAX;

/// Rays one after the other.
#[derive(Clone, Debug, Default)]
pub struct Strays {
    o: [Vec<f32>; 3],
    d: [Vec<f32>; 3],
    start: Vec<u32>,
    detail: Vec<u32>,
}

impl Strays {
    /// How many.
    pub fn len(&self) -> usize {
        self.start.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.start.is_empty()
    }

    fn push(&mut self, ray: &Rays<One>) {
        let columns = self.o.iter_mut().chain(&mut self.d);
        for (column, value) in columns.zip(ray.o.get(0).into_iter().chain(ray.d.get(0))) {
            column.push(value);
        }
        self.start.push(ray.start.get(0));
        self.detail.push(ray.detail.get(0));
    }

    #[inline(always)]
    fn load<L: Lanes>(&self, l: L, at: usize) -> Rays<L> {
        let [o, d] = [&self.o, &self.d].map(|[x, y, z]| [&x[at..], &y[at..], &z[at..]]);
        Rays {
            o: V::new(l.load(o[0]), l.load(o[1]), l.load(o[2])),
            d: V::new(l.load(d[0]), l.load(d[1]), l.load(d[2])),
            start: l.load_words(&self.start[at..]),
            detail: l.load_words(&self.detail[at..]),
        }
    }
}

impl Tracer<'_> {
    /// Rays as paths cast them that end after so many: from the camera at random places of the picture, and on from what
    /// they meet in random directions. About so many, a multiple of 16; neighbours have nothing to do with each other.
    pub fn strays(&self, count: usize, bounces: u32) -> Strays {
        let mut random = 0x9e37_79b9_u32;
        let mut next = || {
            // Xorshift (Marsaglia, "Xorshift RNGs", 2003).
            random ^= random << 13;
            random ^= random >> 17;
            random ^= random << 5;
            (random >> 8) as f32 / (1 << 24) as f32
        };
        let mut strays = Strays::default();
        let camera = &self.scene.camera;
        while strays.len() < count {
            let [x, y] = [2.0 * next() - 1.0, 2.0 * next() - 1.0].map(f64::from);
            let d = camera.forward
                + x * camera.half_extent.x * camera.right
                + y * camera.half_extent.y * camera.up;
            let d = V::splat(One, super::vector::single(d.normalize()));
            let mut ray = Rays { o: V::splat(One, [0.0; 3]), d, start: One.u(NOWHERE), detail: One.u(0) };
            for _ in 0..=bounces {
                strays.push(&ray);
                let hits = self.surfaces.closest(One, &ray, f32::INFINITY, One.u(NO_SLOT), true);
                if hits.place.get(0) == NOWHERE {
                    break;
                }
                let points = self.surfaces.points(One, &ray, &hits, true);
                let z = if points.n.dot(ray.d) < 0.0 { points.n } else { -points.n };
                let (x, y) = basis(One, z);
                // Cosine-distributed: a point of the disc of which two numbers are coordinates, if it lies in it.
                let [a, b] = loop {
                    let [a, b] = [2.0 * next() - 1.0, 2.0 * next() - 1.0];
                    if a * a + b * b < 1.0 {
                        break [a, b];
                    }
                };
                let d = x * a + y * b + z * (1.0 - a * a - b * b).sqrt();
                ray = Rays { o: points.p, d: d.normalized(One), start: hits.place, detail: hits.detail };
            }
        }
        let whole = strays.len() / 16 * 16;
        strays.keep(whole, &mut next)
    }

    /// How many of the rays meet a surface, looking for the nearest; or within a distance, for which any will do.
    pub fn cast(&self, strays: &Strays, within: Option<f32>) -> usize {
        self.level.run(Cast { tracer: self, strays, within })
    }

    /// Builds the hierarchy over the surfaces once more, and says how many bytes it takes; none where there are so few
    /// surfaces that there is none.
    pub fn hierarchy(&self) -> Option<usize> {
        Some(self.surfaces.hierarchy(self.scene, &self.space, |_| {})?.bytes())
    }
}

impl Strays {
    /// So many of them in random order.
    fn keep(self, count: usize, next: &mut dyn FnMut() -> f32) -> Strays {
        let mut order: Vec<usize> = (0..self.len()).collect();
        for i in (1..order.len()).rev() {
            order.swap(i, (next() * (i + 1) as f32) as usize);
        }
        order.truncate(count);
        let take = |column: &Vec<f32>| order.iter().map(|at| column[*at]).collect::<Vec<f32>>();
        let words = |column: &Vec<u32>| order.iter().map(|at| column[*at]).collect::<Vec<u32>>();
        Strays {
            o: self.o.each_ref().map(take),
            d: self.d.each_ref().map(take),
            start: words(&self.start),
            detail: words(&self.detail),
        }
    }
}

struct Cast<'a, 's> {
    tracer: &'a Tracer<'s>,
    strays: &'a Strays,
    within: Option<f32>,
}

impl level::Task for Cast<'_, '_> {
    type Output = usize;
    fn run<L: Lanes>(self, l: L) -> usize {
        l.run(
            #[inline(always)]
            || self.count(l),
        )
    }
}

impl Cast<'_, '_> {
    #[inline(always)]
    fn count<L: Lanes>(&self, l: L) -> usize {
        let surfaces = &self.tracer.surfaces;
        let all = l.mask(u32::MAX >> (32 - L::N));
        let mut count = 0;
        for at in (0..self.strays.len()).step_by(L::N) {
            let rays = self.strays.load(l, at);
            let met = match self.within {
                None => {
                    !surfaces.closest(l, &rays, l.f(f32::INFINITY), l.u(NO_SLOT), all).place.is(l.u(NOWHERE))
                }
                Some(limit) => surfaces.occluded(l, &rays, l.f(limit), l.u(NO_SLOT), all),
            };
            count += (met & all).bits().count_ones() as usize;
        }
        count
    }
}
