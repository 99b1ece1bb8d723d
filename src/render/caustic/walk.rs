//! What a path remembers of its way, so that it can tell a caustic when it meets one, and where it looks for light.

use super::Hope;
use super::chain::{MOST_EVENTS, Ways, WaysOf};
use super::looks::{Look, Looks, Scattering, Wanted};
use super::search;
use super::seeds::Cell;
use crate::render::Observer;
use crate::render::Tracer;
use crate::render::bsdf::{Bsdfs, Samples};
use crate::render::lanes::{Float, Lanes, MOST, Mask, Word};
use crate::render::media::Inside;
use crate::render::observer::{FirstWays, Way};
use crate::render::path::{Vertices, one};
use crate::render::queue::{Arrived, Jobs};
use crate::render::sampler::{Pair, Sampler};
use crate::render::vector::V;

/// For each lane the last surface that might have looked for a caustic, and the chain that its path has come by since.
pub struct Chains<L: Lanes> {
    p: V<L>,
    /// The normal on the side of the path.
    n: V<L>,
    place: L::U,
    detail: L::U,
    /// The direction that the chain starts in.
    w: V<L>,
    /// The density of that direction, and the probability of the way from there.
    odds: L::F,
    /// What the path carried there.
    carried: L::F,
    ways: WaysOf<L>,
    /// What the surface lies in; empty but for the lanes of `wet`.
    inside: Vec<Inside>,
    wet: u32,
    /// What paths wait to know.
    looks: Looks,
    /// Where what they wait for is added up.
    tickets: [u32; MOST],
}

/// Paths at surfaces that scatter.
pub struct Here<'a, L: Lanes> {
    /// The surfaces.
    pub vertices: &'a Vertices<L>,
    /// Their materials.
    pub bsdfs: &'a Bsdfs<L>,
    /// What the paths carry.
    pub throughput: V<L>,
    /// Scattering events before, all and rough ones.
    pub bounces: [L::U; 2],
    /// How they left their first surfaces.
    pub first: FirstWays,
    /// What they are inside of.
    pub insides: &'a [Inside],
    /// The lanes inside of anything.
    pub wet: u32,
}

impl<L: Lanes> Here<'_, L> {
    /// Scattering events with the one here.
    #[inline]
    fn next_bounces(&self, lane: usize) -> [u32; 2] {
        let [all, rough] = self.bounces;
        [all.get(lane) + 1, rough.get(lane) + 1]
    }

    /// How the path leaves the first surface that scatters it, if it is scattered here.
    #[inline]
    fn way(&self, lane: usize) -> Way {
        if self.bounces[0].get(lane) == 0 { Way::Rough } else { self.first.of(lane) }
    }

    #[inline]
    fn scattering(&self, lane: usize) -> Scattering {
        Scattering {
            throughput: self.throughput.get(lane),
            wo: self.vertices.wo.get(lane),
            rim: self.vertices.rim.get(lane),
            kind: self.bsdfs.kind.get(lane),
            color: self.bsdfs.color.get(lane),
            alpha: self.bsdfs.alpha.get(lane),
            coat: self.bsdfs.coat.get(lane),
        }
    }
}

/// Light that a path has met by chance at the end of its chain.
pub struct Luck {
    /// The lamp, by its place among the lights.
    pub lamp: u32,
    /// What it adds, were there no other way to find it.
    pub radiance: [f32; 3],
    /// Scattering events, all and rough ones.
    pub bounces: [u32; 2],
    /// How the path left its first surface.
    pub first: Way,
}

/// No ticket.
const NONE: u32 = u32::MAX;

impl<L: Lanes> Chains<L> {
    /// No chains.
    pub fn new(l: L) -> Chains<L> {
        let zero = V::all(l.f(0.0));
        Chains {
            p: zero,
            n: zero,
            place: l.u(0),
            detail: l.u(0),
            w: zero,
            odds: l.f(0.0),
            carried: l.f(0.0),
            ways: WaysOf { through: l.u(0), end: l.u(0) },
            inside: vec![Inside::default(); L::N],
            wet: 0,
            looks: Looks::default(),
            tickets: [NONE; MOST],
        }
    }

    /// Forgets those of lanes that take up new paths.
    #[inline(always)]
    pub fn forget(&mut self, l: L, fresh: L::M) {
        self.ways.end = fresh.pick_word(l.u(0), self.ways.end);
        for lane in fresh.lanes() {
            self.tickets[lane] = NONE;
        }
    }

    /// Notes places to look for light from, now and then: by two numbers, [`Pair::Seed`].
    #[inline(always)]
    pub fn look(
        &mut self,
        l: L,
        tracer: &Tracer,
        here: &Here<L>,
        [chance, choice]: [L::F; 2],
        sampler: &Sampler<L>,
        wanted: L::M,
    ) {
        let Some(seeds) = &tracer.caustics.seeds else { return };
        let carried = here.throughput.luminance().lesser(l.f(1.0));
        if tracer.caustics.search.is_some() {
            let searched = wanted & (l.f(1.0) - carried * search::EFFORT).lt(chance);
            for lane in searched.lanes() {
                self.search(here, lane, chance.get(lane), choice.get(lane));
            }
        }
        let wanted = wanted & chance.lt(carried * seeds.most_effort());
        if !wanted.any() {
            return;
        }
        let u = sampler.pair(l, Pair::Chain, here.bounces[0]);
        for lane in wanted.lanes() {
            let vertices = here.vertices;
            let (p, n) = (one(vertices.p, lane), one(vertices.z, lane));
            let Some(cell) = seeds.around(p.get(0)) else { continue };
            let effort = carried.get(lane) * cell.effort;
            if chance.get(lane) >= effort {
                continue;
            }
            let Some(hope) = Hope::within(seeds, cell, n) else { continue };
            let Some((index, seed, rest)) = hope.choose(choice.get(lane)) else { continue };
            let [bounces, rough_bounces] = here.next_bounces(lane);
            let events = seed.ways.count();
            if bounces + events > tracer.scene.trace.bounces {
                continue;
            }
            let scattering = here.scattering(lane);
            let look = Look {
                ticket: self.ticket(lane),
                bounces: [bounces + events, rough_bounces],
                first: here.way(lane),
                p: p.get(0),
                n: n.get(0),
                place: vertices.place.get(lane),
                detail: vertices.detail.get(lane),
                effort,
                cell: hope.cell,
                total: hope.total,
                ways: seed.ways,
                goal: seed.goal,
                wanted: Wanted::Light { seed: index, rest, u: [u[0].get(lane), u[1].get(lane)], scattering },
            };
            self.looks.push(look, &here.insides[lane]);
        }
    }

    /// Notes a place to search for chains from that no seed knows.
    fn search(&mut self, here: &Here<L>, lane: usize, chance: f32, choice: f32) {
        let vertices = here.vertices;
        let (p, n) = (one(vertices.p, lane), one(vertices.z, lane));
        let look = Look {
            ticket: self.ticket(lane),
            bounces: here.next_bounces(lane),
            first: here.way(lane),
            p: p.get(0),
            n: n.get(0),
            place: vertices.place.get(lane),
            detail: vertices.detail.get(lane),
            effort: search::EFFORT * one(here.throughput, lane).luminance().min(1.0),
            cell: Cell::default(),
            total: 0.0,
            ways: Ways::NONE,
            goal: 0,
            wanted: Wanted::Unknown {
                key: u64::from(chance.to_bits()) << 32 | u64::from(choice.to_bits()),
                scattering: here.scattering(lane),
            },
        };
        self.looks.push(look, &here.insides[lane]);
    }

    /// The lanes of a mask that have come by a chain.
    #[inline(always)]
    pub fn are_chains(&self, l: L, mask: L::M) -> L::M {
        mask & l.u(1).below(self.ways.end)
    }

    /// Notes light that a path has met by chance, if it might have been looked for; else says no.
    pub fn find(&mut self, tracer: &Tracer, lane: usize, luck: Luck) -> bool {
        let ways = Ways { through: self.ways.through.get(lane), end: self.ways.end.get(lane) };
        let Some(goal) = tracer.caustics.goal_of(luck.lamp) else { return false };
        let (p, n) = (one(self.p, lane), one(self.n, lane));
        let Some(hope) = tracer.caustics.hope(p, n) else { return false };
        if hope.cell.effort <= 0.0 || hope.by(ways, goal).next().is_none() {
            return false;
        }
        let look = Look {
            ticket: self.ticket(lane),
            bounces: luck.bounces,
            first: luck.first,
            p: p.get(0),
            n: n.get(0),
            place: self.place.get(lane),
            detail: self.detail.get(lane),
            effort: self.carried.get(lane) * hope.cell.effort,
            cell: hope.cell,
            total: hope.total,
            ways,
            goal,
            wanted: Wanted::Share { w: self.w.get(lane), odds: self.odds.get(lane), radiance: luck.radiance },
        };
        self.looks.push(look, &self.inside[lane]);
        true
    }

    /// Keeps account of the polished surfaces that paths come by; `starts` are those that may have looked for light.
    #[inline(always)]
    pub fn lengthen(
        &mut self,
        l: L,
        here: &Here<L>,
        samples: &Samples<L>,
        d: V<L>,
        starts: L::M,
        active: L::M,
    ) {
        let polished = active & here.bsdfs.are_specular(l);
        let through = polished & samples.wi.z.lt(l.f(0.0));
        let WaysOf { through: before, end } = self.ways;
        let longer = end + end;
        let longer = l.u(1 << MOST_EVENTS).below(longer).pick_word(l.u(0), longer);
        let starts = starts & !samples.specular;
        let restart = active & !polished;
        self.ways.through = restart.pick_word(l.u(0), through.pick_word(before | end, before));
        self.ways.end = polished.pick_word(longer, starts.pick_word(l.u(1), restart.pick_word(l.u(0), end)));
        self.odds = polished.pick(self.odds * samples.pdf, starts.pick(samples.pdf, self.odds));
        if !starts.any() {
            return;
        }
        let vertices = here.vertices;
        self.p = V::pick(starts, vertices.p, self.p);
        self.n = V::pick(starts, vertices.z, self.n);
        self.place = starts.pick_word(vertices.place, self.place);
        self.detail = starts.pick_word(vertices.detail, self.detail);
        self.w = V::pick(starts, d, self.w);
        self.carried = starts.pick(here.throughput.luminance().lesser(l.f(1.0)), self.carried);
        for lane in l.mask(starts.bits() & (here.wet | self.wet)).lanes() {
            self.inside[lane].clone_from(&here.insides[lane]);
        }
        self.wet = (self.wet & !starts.bits()) | (here.wet & starts.bits());
    }

    /// Takes what a path brought that has ended, which may have to wait.
    pub fn finish(&mut self, lane: usize, arrived: Arrived, jobs: &mut dyn Jobs) {
        match self.tickets[lane] {
            NONE => jobs.finish(&arrived),
            ticket => self.looks.arrive(ticket, arrived, jobs),
        }
    }

    /// Answers what was noted, if that is enough to fill all lanes or paths can wait no longer.
    #[inline(always)]
    pub fn answer<O: Observer>(
        &mut self,
        l: L,
        tracer: &Tracer,
        now: bool,
        jobs: &mut dyn Jobs,
        observer: &mut O,
    ) {
        if self.looks.len() >= FULL * L::N || now && self.looks.len() > 0 {
            self.looks.answer(l, tracer, jobs, observer);
        }
    }

    fn ticket(&mut self, lane: usize) -> u32 {
        if self.tickets[lane] == NONE {
            self.tickets[lane] = self.looks.ticket();
        }
        self.tickets[lane]
    }
}

/// Looks for each lane that are answered together.
const FULL: usize = 4;
