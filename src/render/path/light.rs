//! The light that paths find where they come, and that they gather from the lamps.

use super::inside::seen_through;
use super::vertices::Vertices;
use super::{Paths, one, rgb};
use crate::render::Tracer;
use crate::render::bsdf::Bsdfs;
use crate::render::caustic::walk::Luck;
use crate::render::lanes::{Float, Lanes, Mask, One, Word};
use crate::render::light::{LightSamples, Source};
use crate::render::observer::{Contribution, Observer, Way};
use crate::render::sampler::Pair;
use crate::render::shape::{Hits, Points, Rays, decode, slot};
use crate::render::vector::V;

impl<L: Lanes> Paths<L> {
    /// Accounts for the sky and the suns, shared with the other way to find them.
    #[inline(always)]
    pub fn find_beyond<O: Observer>(&mut self, l: L, tracer: &Tracer, missed: L::M, observer: &mut O) {
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
    pub fn find_caustics(&mut self, l: L, tracer: &Tracer, lamp: u32, radiance: V<L>, met: L::M) -> L::M {
        let Some(chains) = &mut self.chains else { return l.mask(0) };
        let mut bits = 0;
        for lane in chains.are_chains(l, met).lanes() {
            let radiance = self.throughput.times(radiance).get(lane);
            let bounces = [self.bounces.get(lane), self.rough_bounces.get(lane)];
            let luck = Luck { lamp, radiance, bounces, first: self.first.of(lane) };
            bits |= u32::from(chains.find(tracer, lane, luck)) << lane;
        }
        l.mask(bits)
    }

    /// Accounts for glowing surfaces that rays have met, shared with the other way to find them.
    #[expect(clippy::too_many_arguments, reason = "all that is known of what was met")]
    #[inline(always)]
    pub fn find_surfaces<O: Observer>(
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

    /// Samples one light each with two numbers, and adds what it gives by way of the vertices.
    #[expect(clippy::too_many_arguments, reason = "all of them is what direct light depends on")]
    #[inline(always)]
    pub fn gather<O: Observer>(
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
                let bounces = bounces.get(lane);
                // Light that is gathered at the first surface comes before it is known how the path goes on from there.
                let way = if self.bounces.get(lane) == 0 { Way::Rough } else { self.first.of(lane) };
                observer.contributed(&Contribution {
                    source,
                    bounces,
                    rough_bounces: rough_bounces.get(lane),
                    first: (bounces > 0).then_some(way),
                    radiance: rgb(radiance, lane) * tracer.unit,
                });
            }
        }
    }
}
