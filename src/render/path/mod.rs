//! Path tracing in lanes: the radiance that arrives along camera rays.
//!
//! Each lane holds a path. In every round all of them take one step: to the next surface, to one light directly,
//! and on in one scattered direction. Paths that ended make room for new ones, so that lanes stay full.
//!
//! Light that a scattered ray happens upon is shared between the two ways to find it by the power heuristic (Eric
//! Veach, *Robust Monte Carlo Methods for Light Transport Simulation*, 1997, §9.2).
//!
//! | module | what it holds |
//! |---|---|
//! | `vertices` | where a path meets a surface |
//! | `inside` | what a path is inside of, and boundaries that it passes straight through |
//! | `light`, `sharing` | light that is found or gathered, and how much of it counts |
//! | `scatter` | where a path goes on to |

mod vertices;
mod inside;
mod light;
mod sharing;
mod scatter;

use super::Tracer;
use super::bsdf::Kind;
use super::caustic::walk::{Chains, Here};
use super::lanes::{Float, Lanes, Mask, One, Word};
use super::light::Receivers;
use super::observer::{FirstWays, Meeting, Observer, Place};
use super::queue::{Arrived, Jobs, Queue, View};
use super::sampler::Sampler;
use super::shape::{Hits, NOWHERE, Rays, decode, slot};
use super::space::double;
use super::vector::V;
use crate::color::Rgb;
use crate::scene::Background;
use inside::Media;
pub(super) use inside::transmission;
use scatter::Numbers;
pub(super) use sharing::Sharing;
pub(super) use vertices::Vertices;

/// Boundaries that a straight line crosses before it is given up. Only surfaces that coincide but for rounding
/// could ever hold one that long.
pub(super) const MOST_PASSES: u32 = 10_000;

/// A ray that meets a surface along it comes from above by this cosine at least, so that what is divided by the
/// cosine and its square stays finite.
pub(super) const LEAST_COSINE: f32 = 1e-6;

/// No slot.
const NO_SLOT: u32 = u32::MAX;

/// Paths, from the camera to where they have got.
pub(super) struct Paths<L: Lanes> {
    alive: L::M,
    pub(super) rays: Rays<L>,
    pub(super) sampler: Sampler<L>,
    /// The pixel that a path belongs to.
    pub(super) pixel: L::U,
    /// What a unit of radiance along the ray adds to the pixel's.
    throughput: V<L>,
    /// How much of the throughput is due to refraction alone; roulette must not mistake it for darkness.
    thinning: L::F,
    bounces: L::U,
    rough_bounces: L::U,
    passes: L::U,
    /// The vertex that the ray was scattered at.
    last: Receivers<L>,
    /// Sum of the estimates of lights there.
    last_total: L::F,
    /// Density of the scattered direction; infinite if no light could have been sampled in its place.
    last_pdf: L::F,
    radiance: V<L>,
    /// The weight of the radiance in the pixel.
    pub(super) weight: L::F,
    /// Whether the camera's ray met nothing in front of a transparent background.
    open: L::M,
    media: Media<L>,
    /// What paths remember of their ways, if caustics are looked for.
    chains: Option<Chains<L>>,
    /// How they left the first surface; kept for observers alone.
    first: FirstWays,
}

/// Traces all paths that there are to do.
pub(super) fn trace<L: Lanes, O: Observer>(
    l: L,
    tracer: &Tracer,
    view: &View,
    jobs: &mut dyn Jobs,
    observer: &mut O,
) {
    l.run(
        #[inline(always)]
        || rounds(l, tracer, view, jobs, observer),
    );
}

#[inline(always)]
fn rounds<L: Lanes, O: Observer>(l: L, tracer: &Tracer, view: &View, jobs: &mut dyn Jobs, observer: &mut O) {
    let mut queue = Queue::new();
    let mut paths = Paths::none(l, tracer, view);
    loop {
        paths.refill(l, tracer, view, &mut queue, jobs);
        let alive = paths.alive;
        if !alive.any() {
            paths.answer(l, tracer, true, jobs, observer);
            return;
        }
        paths.step(l, tracer, jobs, observer);
        let open = paths.open.bits();
        for lane in (alive & !paths.alive).lanes() {
            let arrived = Arrived {
                pixel: paths.pixel.get(lane),
                radiance: paths.radiance.get(lane),
                weight: paths.weight.get(lane),
                open: open >> lane & 1 == 1,
            };
            match &mut paths.chains {
                Some(chains) => chains.finish(lane, arrived, jobs),
                None => jobs.finish(&arrived),
            }
        }
        paths.answer(l, tracer, false, jobs, observer);
    }
}

impl<L: Lanes> Paths<L> {
    fn none(l: L, tracer: &Tracer, view: &View) -> Paths<L> {
        let zero = V::all(l.f(0.0));
        Paths {
            alive: l.mask(0),
            rays: Rays { o: zero, d: zero, start: l.u(NOWHERE), detail: l.u(0) },
            sampler: Sampler { key: [l.u(0), l.u(0)], index: l.u(0) },
            pixel: l.u(0),
            throughput: zero,
            thinning: l.f(1.0),
            bounces: l.u(0),
            rough_bounces: l.u(0),
            passes: l.u(0),
            last: Receivers { p: zero, n: zero, open: l.mask(0) },
            last_total: l.f(0.0),
            last_pdf: l.f(f32::INFINITY),
            radiance: zero,
            weight: l.f(1.0),
            open: l.mask(0),
            media: Media::new(l, tracer),
            chains: (view.looks && !tracer.caustics.is_empty()).then(|| Chains::new(l)),
            first: FirstWays::default(),
        }
    }

    /// Starts new paths in the lanes whose paths have ended.
    #[inline(always)]
    fn refill(&mut self, l: L, tracer: &Tracer, view: &View, queue: &mut Queue<L>, jobs: &mut dyn Jobs) {
        let mut free = (!self.alive).bits() & (u32::MAX >> (32 - L::N));
        if free == 0 {
            return;
        }
        let mut taken = 0;
        while free != 0 {
            queue.fill(l, view, jobs);
            if queue.waiting() == 0 {
                break;
            }
            let mut next = free;
            while next.count_ones() as usize > queue.waiting() {
                next &= !(1 << next.ilog2());
            }
            queue.take(l, l.mask(next), next.count_ones() as usize, self);
            free &= !next;
            taken |= next;
        }
        let fresh = l.mask(taken);
        let (zero, one) = (V::all(l.f(0.0)), l.f(1.0));
        self.alive = self.alive | fresh;
        self.rays.start = fresh.pick_word(l.u(NOWHERE), self.rays.start);
        self.throughput = V::pick(fresh, V::all(one), self.throughput);
        self.thinning = fresh.pick(one, self.thinning);
        self.bounces = fresh.pick_word(l.u(0), self.bounces);
        self.rough_bounces = fresh.pick_word(l.u(0), self.rough_bounces);
        self.passes = fresh.pick_word(l.u(0), self.passes);
        self.last_pdf = fresh.pick(l.f(f32::INFINITY), self.last_pdf);
        self.radiance = V::pick(fresh, zero, self.radiance);
        self.open = self.open & !fresh;
        if let Some(chains) = &mut self.chains {
            chains.forget(l, fresh);
        }
        if !tracer.dielectrics.is_empty() {
            self.enter_media(l, tracer, fresh);
        }
    }

    /// Takes every path one step on.
    #[inline(always)]
    fn step<O: Observer>(&mut self, l: L, tracer: &Tracer, jobs: &mut dyn Jobs, observer: &mut O) {
        let trace = &tracer.scene.trace;
        // Find what the rays meet, dimmed by what they travel through.
        let hits = tracer.surfaces.closest(l, &self.rays, l.f(f32::INFINITY), l.u(NO_SLOT), self.alive);
        if tracer.dielectrics.any_absorbing() {
            self.throughput = self.throughput.times(transmission(l, self.media.absorption, hits.t));
        }

        // Account for the sky and the suns where rays leave the scene.
        let met = self.alive & !hits.place.is(l.u(NOWHERE));
        let mut missed = self.alive & !met;
        if trace.background == Background::Transparent {
            // What dims or bends the ray on its way is seen, and so is the background through it.
            let one = l.f(1.0);
            let plain = one.le(self.throughput.x) & one.le(self.throughput.y) & one.le(self.throughput.z);
            let open = missed & plain & self.bounces.is(l.u(0));
            self.open = self.open | open;
            missed = missed & !open;
        }
        if O::FOLLOWS && missed.any() {
            self.find_beyond(l, tracer, missed, observer);
        }
        self.alive = met;
        if !met.any() {
            return;
        }
        let points = tracer.surfaces.points(l, &self.rays, &hits, met);
        let entering = points.n.dot(self.rays.d).lt(l.f(0.0));
        let mut bsdfs = tracer.bsdfs(l, &hits, &points, met);

        // Account for what the surfaces give by themselves.
        let glowing = met & bsdfs.are(l, Kind::Emitter);
        if glowing.any() {
            if O::FOLLOWS {
                self.find_surfaces(l, tracer, &hits, &points, entering, bsdfs.color, glowing, observer);
            }
            self.alive = self.alive & !glowing;
        }

        // Go straight through boundaries that part nothing.
        let mut active = self.alive;
        let boundaries = active & bsdfs.transmit(l);
        if boundaries.any() {
            let passing =
                self.meet_boundaries(l, tracer, &hits, &points, entering, boundaries, &mut bsdfs.eta);
            active = active & !passing;
        }
        if O::WATCHES {
            let color = V::pick(glowing, V::all(l.f(0.0)), bsdfs.color);
            for lane in (active | glowing).lanes() {
                let side = if entering.bits() >> lane & 1 == 1 { 1.0 } else { -1.0 };
                observer.met(&Meeting {
                    pixel: self.pixel.get(lane),
                    bounce: self.bounces.get(lane),
                    place: place_at(tracer, &hits.lane(lane)),
                    p: tracer.space.world(points.p, lane),
                    n: side * double(points.shading, lane),
                    color: rgb(color, lane),
                });
            }
        }
        if !O::FOLLOWS {
            self.alive = self.alive & !active;
            return;
        }

        // End at the limits that the scene sets.
        let mut over = active & self.bounces.is(l.u(trace.bounces));
        for lane in over.lanes() {
            let throughput = rgb(self.throughput, lane);
            jobs.cut(throughput);
            if O::WATCHES {
                observer.cut(place_at(tracer, &hits.lane(lane)), throughput);
            }
        }
        if !trace.indirect {
            over = over | (active & !self.rough_bounces.is(l.u(0)));
        }
        self.alive = self.alive & !over;
        let active = active & !over;
        if !active.any() {
            return;
        }

        let numbers = Numbers::draw(l, &self.sampler, self.bounces, self.chains.is_some());

        // Gather light directly from one of the lights.
        let vertices = Vertices::new(l, &points, &hits, entering, self.rays.d);
        self.last_pdf = active.pick(l.f(f32::INFINITY), self.last_pdf);
        let rough = active & !bsdfs.are_specular(l);
        if rough.any() && !tracer.lights.is_empty() {
            self.last = Receivers { p: vertices.p, n: vertices.z, open: bsdfs.transmit(l) };
            self.last_total = tracer.lights.total(l, &self.last);
            self.gather(l, tracer, &bsdfs, &vertices, numbers.light, rough, observer);
        }

        // Look for light that comes by mirrors and glass.
        if let Some(chains) = &mut self.chains {
            let here = Here {
                vertices: &vertices,
                bsdfs: &bsdfs,
                throughput: self.throughput,
                bounces: [self.bounces, self.rough_bounces],
                first: self.first,
                insides: &self.media.inside,
                wet: self.media.any,
            };
            chains.look(l, tracer, &here, numbers.seed, &self.sampler, rough & !bsdfs.transmit(l));
        }

        // Scatter.
        self.scatter(
            l,
            tracer,
            &bsdfs,
            &vertices,
            (numbers.direction, numbers.lobe),
            active,
            rough,
            observer,
        );
    }

    /// Answers what paths wait to know of caustics, if that is worth it or they can wait no longer.
    #[inline(always)]
    fn answer<O: Observer>(
        &mut self,
        l: L,
        tracer: &Tracer,
        now: bool,
        jobs: &mut dyn Jobs,
        observer: &mut O,
    ) {
        if let Some(chains) = &mut self.chains {
            chains.answer(l, tracer, now, jobs, observer);
        }
    }
}

/// One lane of a vector.
#[inline(always)]
pub(super) fn one<L: Lanes>(v: V<L>, lane: usize) -> V<One> {
    V::splat(One, v.get(lane))
}

#[inline]
fn rgb<L: Lanes>(v: V<L>, lane: usize) -> Rgb {
    double(v, lane)
}

#[inline]
fn place_at(tracer: &Tracer, hit: &Hits<One>) -> Place {
    let place = hit.place.get(0);
    Place { primitive: tracer.surfaces.primitive(slot(place)), face: decode(place, hit.detail.get(0)) }
}
