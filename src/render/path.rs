//! Path tracing in lanes: the radiance that arrives along camera rays.
//!
//! Each lane holds a path. In every round all of them take one step: to the next surface, to one light directly,
//! and on in one scattered direction. Paths that ended make room for new ones, so that lanes stay full.
//!
//! Light that a scattered ray happens upon is shared between the two ways to find it by the power heuristic (Eric
//! Veach, *Robust Monte Carlo Methods for Light Transport Simulation*, 1997, §9.2).

use super::Tracer;
use super::bsdf::{Bsdfs, Kind};
use super::caustic::walk::{Chains, Here, Luck};
use super::functions::exp_negative;
use super::lanes::{Float, Lanes, Mask, One, Word};
use super::light::{LightSamples, Receivers, Source};
use super::media::{Boundary, Inside};
use super::observer::{Contribution, Observer, Place, Vertex};
use super::queue::{Arrived, Jobs, Queue, View};
use super::sampler::{Pair, Sampler};
use super::shape::{Hits, NOWHERE, Points, Rays, decode, slot};
use super::space::double;
use super::vector::{V, basis};
use crate::color::Rgb;
use crate::math::DVec3;
use crate::scene::{Background, Material, Projection};

/// Vertices before roulette may end a path. It was measured to cost more than it saves at depth 8.
const FIRST_ROULETTE: u32 = 16;

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
}

/// What the paths are inside of.
struct Media<L: Lanes> {
    inside: Vec<Inside>,
    /// Lanes within any solid.
    any: u32,
    /// What absorbs there.
    absorption: V<L>,
    /// What camera rays through a pinhole are inside of.
    start: Inside,
}

/// A vertex with its local frame.
///
/// Scattering is that of the shading normal, and which side a direction is on is told by the surface's own: what the
/// two disagree about is black, so that no light leaks through a smooth mesh (Veach 1997, §5.3.2).
pub(super) struct Vertices<L: Lanes> {
    pub(super) place: L::U,
    pub(super) detail: L::U,
    pub(super) p: V<L>,
    x: V<L>,
    y: V<L>,
    /// The normal to shade with, on the side that the path comes from.
    pub(super) z: V<L>,
    /// The normal of the surface itself, on that side.
    pub(super) rim: V<L>,
    pub(super) wo: V<L>,
    /// Whether the path comes from outside.
    entering: L::M,
}

/// What is drawn at every vertex.
struct Numbers<L: Lanes> {
    direction: [L::F; 2],
    lobe: [L::F; 2],
    light: [L::F; 2],
    seed: [L::F; 2],
}

impl<L: Lanes> Numbers<L> {
    #[inline(always)]
    fn draw(l: L, sampler: &Sampler<L>, vertex: L::U, looks: bool) -> Numbers<L> {
        if looks {
            let pairs = [Pair::Direction, Pair::Lobe, Pair::Light, Pair::Seed];
            let [direction, lobe, light, seed] = sampler.pairs(l, pairs, vertex);
            return Numbers { direction, lobe, light, seed };
        }
        let [direction, lobe, light] = sampler.pairs(l, [Pair::Direction, Pair::Lobe, Pair::Light], vertex);
        Numbers { direction, lobe, light, seed: [l.f(0.0); 2] }
    }
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
        let mut start = Inside::default();
        tracer.dielectrics.enter_at(tracer.surfaces.exact(), tracer.scene.camera.position, &mut start);
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
            media: Media { inside: vec![Inside::default(); L::N], any: 0, absorption: zero, start },
            chains: (view.looks && !tracer.caustics.is_empty()).then(|| Chains::new(l)),
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
        if missed.any() {
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
            self.find_surfaces(l, tracer, &hits, &points, entering, bsdfs.color, glowing, observer);
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

    /// Accounts for the sky and the suns, shared with the other way to find them.
    #[inline(always)]
    fn find_beyond<O: Observer>(&mut self, l: L, tracer: &Tracer, missed: L::M, observer: &mut O) {
        for &index in tracer.lights.beyond() {
            let lamp = tracer.lights.lamp(index);
            let (seen, density) = lamp.beyond(l, &self.last, self.rays.d, missed);
            let chance = tracer.lights.chance(l, index, &self.last, self.last_total);
            let share = tracer.sharing.found(l, self.last_pdf, density * chance);
            let radiance = lamp.seen(l, self.rays.d, missed) * share;
            let seen = missed & seen;
            let seen = seen & !self.find_caustics(l, tracer, index, radiance, seen);
            let counts = (self.bounces, self.rough_bounces);
            self.add(l, tracer, lamp.source(), counts, radiance, seen, observer);
        }
    }

    /// Leaves light that was met at the ends of chains to be shared with the looks for it; the lanes where that is so.
    #[inline(always)]
    fn find_caustics(&mut self, l: L, tracer: &Tracer, lamp: u32, radiance: V<L>, met: L::M) -> L::M {
        let Some(chains) = &mut self.chains else { return l.mask(0) };
        let mut bits = 0;
        for lane in chains.are_chains(l, met).lanes() {
            let radiance = self.throughput.times(radiance).get(lane);
            let bounces = [self.bounces.get(lane), self.rough_bounces.get(lane)];
            bits |= u32::from(chains.find(tracer, lane, Luck { lamp, radiance, bounces })) << lane;
        }
        l.mask(bits)
    }

    /// Accounts for glowing surfaces that rays have met, shared with the other way to find them.
    #[expect(clippy::too_many_arguments, reason = "all that is known of what was met")]
    #[inline(always)]
    fn find_surfaces<O: Observer>(
        &mut self,
        l: L,
        tracer: &Tracer,
        hits: &Hits<L>,
        points: &Points<L>,
        entering: L::M,
        radiance: V<L>,
        glowing: L::M,
        observer: &mut O,
    ) {
        let entering = entering.bits();
        for lane in glowing.lanes() {
            let place = hits.place.get(lane);
            if entering >> lane & 1 == 0 && tracer.surfaces.is_closed(slot(place)) {
                continue;
            }
            let found = self.last_pdf.get(lane);
            let share = if found == f32::INFINITY {
                let lamp = tracer.lights.of_slot(slot(place));
                let here = l.mask(1 << lane);
                if lamp.is_some_and(|lamp| self.find_caustics(l, tracer, lamp, radiance, here).any()) {
                    continue;
                }
                1.0
            } else {
                let receivers = self.last.lane(lane);
                let n = one(points.n, lane);
                let point = Points { p: one(points.p, lane), n, shading: n };
                let (total, wi) = (self.last_total.get(lane), one(self.rays.d, lane));
                let face = decode(place, hits.detail.get(lane));
                let other = tracer.lights.pdf_of_surface(slot(place), face, &receivers, total, wi, &point);
                tracer.sharing.found(One, found, other)
            };
            let source = Source::Primitive(tracer.surfaces.primitive(slot(place)));
            let counts = (self.bounces, self.rough_bounces);
            self.add(l, tracer, source, counts, radiance * l.f(share), l.mask(1 << lane), observer);
        }
    }

    /// Finds the relative index of boundaries of dielectrics, and takes the paths on that meet one that parts nothing.
    #[expect(clippy::too_many_arguments, reason = "all that is known of what was met")]
    #[inline(always)]
    fn meet_boundaries(
        &mut self,
        l: L,
        tracer: &Tracer,
        hits: &Hits<L>,
        points: &Points<L>,
        entering: L::M,
        boundaries: L::M,
        eta: &mut L::F,
    ) -> L::M {
        let entering = entering.bits();
        let (mut passing, mut lost) = (0, 0);
        for lane in boundaries.lanes() {
            let id = tracer.surfaces.primitive(slot(hits.place.get(lane)));
            let enters = entering >> lane & 1 == 1;
            match tracer.dielectrics.boundary(&self.media.inside[lane], id, enters) {
                Boundary::Interface(ratio) => eta.set(lane, ratio as f32),
                Boundary::Nothing => {
                    passing |= 1 << lane;
                    self.media.cross(tracer, lane, id, enters);
                    let passes = self.passes.get(lane) + 1;
                    self.passes.set(lane, passes);
                    lost |= u32::from(passes > MOST_PASSES) << lane;
                }
            }
        }
        let passing = l.mask(passing);
        self.rays.o = V::pick(passing, points.p, self.rays.o);
        self.rays.start = passing.pick_word(hits.place, self.rays.start);
        self.rays.detail = passing.pick_word(hits.detail, self.rays.detail);
        self.alive = self.alive & !l.mask(lost);
        passing
    }

    /// Samples one light each with two numbers, and adds what it gives by way of the vertices.
    #[expect(clippy::too_many_arguments, reason = "all of them is what direct light depends on")]
    #[inline(always)]
    fn gather<O: Observer>(
        &mut self,
        l: L,
        tracer: &Tracer,
        bsdfs: &Bsdfs<L>,
        vertices: &Vertices<L>,
        u: [L::F; 2],
        rough: L::M,
        observer: &mut O,
    ) {
        let zero = l.f(0.0);
        let lights = &tracer.lights;
        let receivers = &self.last;
        let choice =
            if lights.needs_choice() { self.sampler.pair(l, Pair::Choice, self.bounces) } else { [zero; 2] };
        let chosen = lights.choose(l, receivers, self.last_total, choice, rough);
        let light = lights.sample(l, tracer, receivers, &chosen, u, rough);
        let wi = vertices.local(light.wi);
        let agrees = vertices.agree(l, tracer, wi, light.wi);
        let (scattering, density) = bsdfs.eval(l, &tracer.materials.coats, vertices.wo, wi, rough);
        let pdf = chosen.probability * light.pdf;
        let share = light.delta.pick(l.f(1.0), tracer.sharing.gathered(l, pdf, density));
        let wanted = rough & light.some & agrees & zero.lt(scattering.max()) & zero.lt(share);
        if !wanted.any() {
            return;
        }
        let visible = self.visibility(l, tracer, vertices, &light, wi, wanted);
        let radiance = scattering.times(light.radiance).times(visible) * (share / pdf);
        if O::WATCHES {
            let one = l.u(1);
            let counts = (self.bounces + one, self.rough_bounces + one);
            for lane in wanted.lanes() {
                let source = lights.lamp(chosen.index.get(lane)).source();
                self.add(l, tracer, source, counts, radiance, l.mask(1 << lane), observer);
            }
        } else {
            self.radiance = V::pick(wanted, self.radiance + self.throughput.times(radiance), self.radiance);
        }
    }

    /// The share of the lights' radiance that reaches the vertices. Nothing passes a surface, but for boundaries that
    /// part nothing, and the medium absorbs.
    #[inline(always)]
    fn visibility(
        &self,
        l: L,
        tracer: &Tracer,
        vertices: &Vertices<L>,
        light: &LightSamples<L>,
        wi: V<L>,
        wanted: L::M,
    ) -> V<L> {
        let rays = Rays { o: vertices.p, d: light.wi, start: vertices.place, detail: vertices.detail };
        let hidden = tracer.surfaces.occluded(l, &rays, light.distance, light.target, wanted);
        let mut visible = V::all(hidden.pick(l.f(0.0), l.f(1.0)));
        if tracer.dielectrics.is_empty() {
            return visible;
        }
        let wet = l.mask(self.media.any);
        let through = wi.z.lt(l.f(0.0));
        let slow = if tracer.dielectrics.any_invisible() { wanted } else { wanted & (wet | through) };
        for lane in slow.lanes() {
            let mut inside = self.media.inside[lane].clone();
            if through.bits() >> lane & 1 == 1 {
                let id = tracer.surfaces.primitive(slot(vertices.place.get(lane)));
                tracer.dielectrics.cross(&mut inside, id, vertices.entering.bits() >> lane & 1 == 1);
            }
            let share = seen_through(
                tracer,
                rays.lane(lane),
                light.distance.get(lane),
                light.target.get(lane),
                &mut inside,
            );
            visible.set(lane, share);
        }
        visible
    }

    /// Adds radiance that arrives at the paths' ends, in the lanes of a mask.
    #[expect(clippy::too_many_arguments, reason = "observers are told where light comes from")]
    #[inline(always)]
    fn add<O: Observer>(
        &mut self,
        l: L,
        tracer: &Tracer,
        source: Source,
        (bounces, rough_bounces): (L::U, L::U),
        radiance: V<L>,
        mask: L::M,
        observer: &mut O,
    ) {
        let _ = l;
        let radiance = self.throughput.times(radiance);
        self.radiance = V::pick(mask, self.radiance + radiance, self.radiance);
        if O::WATCHES {
            for lane in mask.lanes() {
                observer.contributed(&Contribution {
                    source,
                    bounces: bounces.get(lane),
                    rough_bounces: rough_bounces.get(lane),
                    radiance: rgb(radiance, lane) * tracer.unit,
                });
            }
        }
    }

    /// Sends the paths on in directions drawn with two numbers each, the lobe with one more; a last one is for roulette.
    #[expect(clippy::too_many_arguments, reason = "all that scattering depends on")]
    #[inline(always)]
    fn scatter<O: Observer>(
        &mut self,
        l: L,
        tracer: &Tracer,
        bsdfs: &Bsdfs<L>,
        vertices: &Vertices<L>,
        (u, [lobe, chance]): ([L::F; 2], [L::F; 2]),
        active: L::M,
        rough: L::M,
        observer: &mut O,
    ) {
        let zero = l.f(0.0);
        let roulette = active & l.u(FIRST_ROULETTE - 2).below(self.bounces);
        let mut samples = bsdfs.sample(l, &tracer.materials.coats, vertices.wo, lobe, u, active);
        if O::WATCHES {
            for lane in samples.some.lanes() {
                observer.scattered(&Vertex {
                    bounce: self.bounces.get(lane),
                    place: place_at(tracer, &vertices.hits(l).lane(lane)),
                    p: tracer.space.world(vertices.p, lane),
                    n: vertices.outward(lane),
                    throughput: rgb(self.throughput, lane),
                    specular: samples.specular.bits() >> lane & 1 == 1,
                });
            }
        }
        let d = vertices.world(samples.wi);
        samples.some = samples.some & vertices.agree(l, tracer, samples.wi, d);
        // It is a unit vector but for rounding: one step of Newton's.
        let d = d * (l.f(1.5) - d.squared() * 0.5);
        if let Some(chains) = &mut self.chains {
            let here = Here {
                vertices,
                bsdfs,
                throughput: self.throughput,
                bounces: [self.bounces, self.rough_bounces],
                insides: &self.media.inside,
                wet: self.media.any,
            };
            chains.lengthen(l, &here, &samples, d, rough & samples.some & !bsdfs.transmit(l), active);
        }
        self.throughput = V::pick(samples.some, self.throughput.times(samples.weight), self.throughput);
        let goes_on = samples.some & zero.lt(self.throughput.max());
        self.alive = (self.alive & !active) | goes_on;
        let (none, one) = (l.u(0), l.u(1));
        self.bounces = self.bounces + active.pick_word(one, none);
        self.rough_bounces = self.rough_bounces + (active & !samples.specular).pick_word(one, none);
        let shared = rough & !samples.specular;
        let shared = if tracer.lights.is_empty() { l.mask(0) } else { shared };
        self.last_pdf = shared.pick(samples.pdf, self.last_pdf);

        let crossing = goes_on & samples.wi.z.lt(zero);
        if crossing.any() {
            for lane in crossing.lanes() {
                let id = tracer.surfaces.primitive(slot(vertices.place.get(lane)));
                self.media.cross(tracer, lane, id, vertices.entering.bits() >> lane & 1 == 1);
            }
            let thinned = self.thinning / (bsdfs.eta * bsdfs.eta);
            self.thinning = crossing.pick(thinned, self.thinning);
        }
        self.rays.o = V::pick(active, vertices.p, self.rays.o);
        self.rays.d = V::pick(active, d, self.rays.d);
        self.rays.start = active.pick_word(vertices.place, self.rays.start);
        self.rays.detail = active.pick_word(vertices.detail, self.rays.detail);

        // Let roulette end paths that carry little.
        let roulette = roulette & goes_on;
        if roulette.any() {
            let survival = (self.throughput.max() / self.thinning).lesser(l.f(1.0));
            let ends = roulette & survival.le(chance);
            self.alive = self.alive & !ends;
            let stays = roulette & !ends;
            self.throughput = V::pick(stays, self.throughput * (l.f(1.0) / survival), self.throughput);
        }
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

    /// Finds what fresh paths are inside of.
    #[inline(always)]
    fn enter_media(&mut self, l: L, tracer: &Tracer, fresh: L::M) {
        let camera = &tracer.scene.camera;
        let pinhole = camera.lens_radius == 0.0 && camera.projection == Projection::Perspective;
        let media = &mut self.media;
        if tracer.dielectrics.are_far_from_camera() || pinhole && media.start.is_empty() {
            // Only what the paths before were inside of has to be forgotten.
            for lane in (fresh & l.mask(media.any)).lanes() {
                media.inside[lane].clone_from(&media.start);
                media.moved(tracer, lane);
            }
            return;
        }
        for lane in fresh.lanes() {
            if pinhole {
                media.inside[lane].clone_from(&media.start);
            } else {
                let start = tracer.space.world(self.rays.o, lane);
                tracer.dielectrics.enter_at(tracer.surfaces.exact(), start, &mut media.inside[lane]);
            }
            media.moved(tracer, lane);
        }
    }
}

impl<L: Lanes> Media<L> {
    /// Takes a path through the surface of a solid.
    fn cross(&mut self, tracer: &Tracer, lane: usize, id: crate::scene::PrimitiveId, entering: bool) {
        tracer.dielectrics.cross(&mut self.inside[lane], id, entering);
        self.moved(tracer, lane);
    }

    /// Notes what holds of a path that has come into another set of solids.
    fn moved(&mut self, tracer: &Tracer, lane: usize) {
        let inside = &self.inside[lane];
        self.any = self.any & !(1 << lane) | u32::from(!inside.is_empty()) << lane;
        if tracer.dielectrics.any_absorbing() {
            let sigma = tracer.dielectrics.absorption(inside) * tracer.space.unit();
            self.absorption.set(lane, super::vector::single(sigma));
        }
    }
}

impl<L: Lanes> Vertices<L> {
    #[inline(always)]
    fn new(l: L, points: &Points<L>, hits: &Hits<L>, entering: L::M, d: V<L>) -> Vertices<L> {
        let z = V::pick(entering, points.shading, -points.shading);
        let rim = V::pick(entering, points.n, -points.n);
        let (x, y) = basis(l, z);
        let Hits { place, detail, .. } = *hits;
        let mut vertices = Vertices { place, detail, p: points.p, x, y, z, rim, wo: d, entering };
        vertices.wo = vertices.local(-d);
        vertices.wo.z = vertices.wo.z.greater(l.f(LEAST_COSINE));
        vertices
    }

    #[inline(always)]
    fn local(&self, w: V<L>) -> V<L> {
        V::new(w.dot(self.x), w.dot(self.y), w.dot(self.z))
    }

    /// Whether directions of the world are on the side of the surface that they are on of the shading normal.
    #[inline(always)]
    fn agree(&self, l: L, tracer: &Tracer, local: V<L>, w: V<L>) -> L::M {
        if !tracer.surfaces.any_smooth() {
            return l.mask(u32::MAX);
        }
        let zero = l.f(0.0);
        let (above, outside) = (zero.lt(local.z), zero.lt(self.rim.dot(w)));
        (above & outside) | (!above & !outside)
    }

    /// Where they lie.
    fn hits(&self, l: L) -> Hits<L> {
        Hits { t: l.f(0.0), place: self.place, detail: self.detail }
    }

    /// The outward normal of a surface in the world.
    fn outward(&self, lane: usize) -> DVec3 {
        let side = if self.entering.bits() >> lane & 1 == 1 { 1.0 } else { -1.0 };
        side * double(self.rim, lane)
    }

    #[inline(always)]
    fn world(&self, w: V<L>) -> V<L> {
        self.x * w.x + self.y * w.y + self.z * w.z
    }
}

/// The share of radiance that comes along a ray from a distance, through boundaries that part nothing.
fn seen_through(
    tracer: &Tracer,
    mut ray: Rays<One>,
    distance: f32,
    except: u32,
    inside: &mut Inside,
) -> [f32; 3] {
    let mut rest = distance;
    let mut visible = V::<One>::all(1.0);
    for _ in 0..MOST_PASSES {
        let hits = tracer.surfaces.closest(One, &ray, rest, One.u(except), true);
        let place = hits.place.get(0);
        let travelled = if place == NOWHERE { rest } else { hits.t };
        let sigma = tracer.dielectrics.absorption(inside) * tracer.space.unit();
        let sigma = V::splat(One, super::vector::single(sigma));
        visible = visible.times(transmission(One, sigma, travelled));
        if place == NOWHERE {
            return visible.get(0);
        }
        let id = tracer.surfaces.primitive(slot(place));
        let point = tracer.surfaces.points(One, &ray, &hits, true);
        let entering = point.n.dot(ray.d) < 0.0;
        let material = tracer.scene.material(&tracer.scene.primitives[id.0 as usize]);
        let passes = matches!(material, Material::Dielectric { .. })
            && tracer.dielectrics.boundary(inside, id, entering) == Boundary::Nothing;
        if !passes {
            break;
        }
        tracer.dielectrics.cross(inside, id, entering);
        ray = Rays { o: point.p, start: hits.place, detail: hits.detail, ..ray };
        rest -= hits.t;
    }
    [0.0; 3]
}

/// The share of light that is left after a distance in a medium (Beer and Lambert).
#[inline(always)]
pub(super) fn transmission<L: Lanes>(l: L, absorption: V<L>, distance: L::F) -> V<L> {
    V::new(left(l, absorption.x, distance), left(l, absorption.y, distance), left(l, absorption.z, distance))
}

#[inline(always)]
fn left<L: Lanes>(l: L, absorption: L::F, distance: L::F) -> L::F {
    // Neither a clear medium without end nor an opaque one without depth is 0 × ∞.
    let zero = l.f(0.0);
    let none = absorption.le(zero) | distance.le(zero);
    none.pick(l.f(1.0), exp_negative(l, none.pick(zero, -(absorption * distance))))
}

/// One lane of a vector.
#[inline(always)]
pub(super) fn one<L: Lanes>(v: V<L>, lane: usize) -> V<One> {
    V::splat(One, v.get(lane))
}

fn rgb<L: Lanes>(v: V<L>, lane: usize) -> Rgb {
    double(v, lane)
}

fn place_at(tracer: &Tracer, hit: &Hits<One>) -> Place {
    let place = hit.place.get(0);
    Place { primitive: tracer.surfaces.primitive(slot(place)), face: decode(place, hit.detail.get(0)) }
}

/// Which of the two ways to find a light counts. Both, shared; the others are for tests that compare them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(not(test), expect(dead_code, reason = "tests compare the ways"))]
pub(super) enum Sharing {
    Both,
    OnlyGathered,
    OnlyFound,
}

impl Sharing {
    /// What counts of light that was found by chance, of density `found`, where a light could have been sampled
    /// with density `gathered`.
    #[inline(always)]
    pub(super) fn found<L: Lanes>(self, l: L, found: L::F, gathered: L::F) -> L::F {
        match self {
            Sharing::Both => power_heuristic(l, found, gathered),
            Sharing::OnlyGathered => {
                let counts = l.f(f32::INFINITY).le(found) | gathered.le(l.f(0.0));
                counts.pick(l.f(1.0), l.f(0.0))
            }
            Sharing::OnlyFound => l.f(1.0),
        }
    }

    /// What counts of light that was sampled.
    #[inline(always)]
    pub(super) fn gathered<L: Lanes>(self, l: L, gathered: L::F, found: L::F) -> L::F {
        match self {
            Sharing::Both => power_heuristic(l, gathered, found),
            Sharing::OnlyGathered => l.f(1.0),
            Sharing::OnlyFound => l.f(0.0),
        }
    }
}

/// The share of a way to find light that has density `this`, beside one of density `other`.
#[inline(always)]
fn power_heuristic<L: Lanes>(l: L, this: L::F, other: L::F) -> L::F {
    // By the ratio, which neither overflows nor underflows to 0/0.
    let ratio = other / this;
    l.f(1.0) / (ratio * ratio + 1.0)
}
