//! Where paths go on to.

use super::vertices::Vertices;
use super::{Paths, place_at, rgb};
use crate::render::Tracer;
use crate::render::bsdf::Bsdfs;
use crate::render::caustic::walk::Here;
use crate::render::lanes::{Float, Lanes, Mask, Word};
use crate::render::observer::{Observer, Vertex};
use crate::render::sampler::{Pair, Sampler};
use crate::render::shape::slot;
use crate::render::vector::V;

/// Vertices before roulette may end a path. It was measured to cost more than it saves at depth 8.
const FIRST_ROULETTE: u32 = 16;

/// What is drawn at every vertex.
pub struct Numbers<L: Lanes> {
    pub direction: [L::F; 2],
    pub lobe: [L::F; 2],
    pub light: [L::F; 2],
    pub seed: [L::F; 2],
}

impl<L: Lanes> Numbers<L> {
    #[inline(always)]
    pub fn draw(l: L, sampler: &Sampler<L>, vertex: L::U, looks: bool) -> Numbers<L> {
        if looks {
            let pairs = [Pair::Direction, Pair::Lobe, Pair::Light, Pair::Seed];
            let [direction, lobe, light, seed] = sampler.pairs(l, pairs, vertex);
            return Numbers { direction, lobe, light, seed };
        }
        let [direction, lobe, light] = sampler.pairs(l, [Pair::Direction, Pair::Lobe, Pair::Light], vertex);
        Numbers { direction, lobe, light, seed: [l.f(0.0); 2] }
    }
}

impl<L: Lanes> Paths<L> {
    /// Sends the paths on in directions drawn with two numbers each, the lobe with one more; a last one is for roulette.
    #[expect(clippy::too_many_arguments, reason = "all that scattering depends on")]
    #[inline(always)]
    pub fn scatter<O: Observer>(
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
            let first = active & self.bounces.is(l.u(0));
            self.first.note(first.bits(), samples.specular.bits(), samples.wi.z.lt(zero).bits());
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
                first: self.first,
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
}
