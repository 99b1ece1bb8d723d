//! Specular chains: rays that are followed through mirrors and clear glass along given ways, with their derivatives.

use crate::render::Tracer;
use crate::render::bsdf::{Bsdfs, Kind, fresnel};
use crate::render::lanes::{Float, Lanes, Mask, Word, apart};
use crate::render::media::{Boundary, Inside};
use crate::render::path::{LEAST_COSINE, MOST_PASSES, transmission};
use crate::render::shape::{Hits, NOWHERE, Points, Rays, slot};
use crate::render::vector::{V, basis, single};

/// Surfaces that a chain may have.
pub const MOST_EVENTS: u32 = 16;

/// Which way a chain takes at each of its surfaces, in order: it is reflected or goes through.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Ways {
    /// A bit for each surface, the first lowest: whether it goes through.
    pub through: u32,
    /// The bit after the last.
    pub end: u32,
}

impl Ways {
    /// No surface.
    pub const NONE: Ways = Ways { through: 0, end: 1 };

    /// How many surfaces.
    pub fn count(self) -> u32 {
        self.end.trailing_zeros()
    }

    /// With one surface more at the end; none if there are too many.
    pub fn then(self, through: bool) -> Option<Ways> {
        let bit = if through { self.end } else { 0 };
        (self.count() < MOST_EVENTS).then_some(Ways { through: self.through | bit, end: self.end << 1 })
    }

    /// From the other end.
    pub fn reversed(self) -> Ways {
        let unused = u32::BITS - self.count();
        Ways { through: self.through.reverse_bits().checked_shr(unused).unwrap_or(0), ..self }
    }
}

/// Ways a lane: see [`Ways`].
#[derive(Clone, Copy)]
pub struct WaysOf<L: Lanes> {
    /// See [`Ways::through`].
    pub through: L::U,
    /// See [`Ways::end`]; 0 if there is no chain.
    pub end: L::U,
}

impl<L: Lanes> WaysOf<L> {
    /// The lanes with a surface of an index, and those of them that go through it.
    #[inline(always)]
    fn at(&self, l: L, index: u32) -> (L::M, L::M) {
        let bit = l.u(1 << index);
        (bit.below(self.end), !(self.through & bit).is(l.u(0)))
    }
}

/// A ray a lane with its derivatives along two parameters, which are at first the components of its direction along two
/// unit vectors at right angles to it (Homan Igehy, "Tracing ray differentials", 1999).
#[derive(Clone, Copy)]
pub struct Beams<L: Lanes> {
    /// The rays.
    pub rays: Rays<L>,
    /// Derivatives of their origins.
    pub dp: [V<L>; 2],
    /// Derivatives of their directions.
    pub dd: [V<L>; 2],
    /// What a unit of radiance along the ray is at the start of the chain.
    pub weight: V<L>,
    /// The probability that scattering by chance would have taken the same way.
    pub odds: L::F,
}

/// What rays have met.
#[derive(Clone, Copy)]
pub struct Met<L: Lanes> {
    /// The lanes that have met something.
    pub some: L::M,
    /// Where.
    pub hits: Hits<L>,
    /// The points.
    pub points: Points<L>,
    /// Whether they come from outside.
    pub entering: L::M,
    /// What it is made of.
    pub bsdfs: Bsdfs<L>,
}

/// Sends rays along their ways; the lanes that meet nothing but polished surfaces, and can go that way at each.
/// `insides` is what the rays start in, and becomes what they end in.
#[inline(always)]
pub fn follow<L: Lanes>(
    l: L,
    tracer: &Tracer,
    rays: Rays<L>,
    ways: &WaysOf<L>,
    insides: &mut [Inside],
    wanted: L::M,
) -> (Beams<L>, L::M) {
    let mut beams = Beams::new(l, rays);
    let mut alive = wanted;
    for index in 0..MOST_EVENTS {
        let (active, through) = ways.at(l, index);
        let active = active & alive;
        if !active.any() {
            break;
        }
        let met = meet(l, tracer, &mut beams, insides, l.f(f32::INFINITY), l.u(u32::MAX), active);
        let gone = beams.scatter(l, tracer, &met, through, insides);
        alive = (alive & !active) | gone;
    }
    (beams, alive)
}

/// What rays meet first below a distance that parts something, but for the surface in a slot of each lane's own;
/// boundaries that part nothing are crossed. The rays are moved to the last of them, and their weight is dimmed by what
/// they travel through.
#[inline(always)]
pub fn meet<L: Lanes>(
    l: L,
    tracer: &Tracer,
    beams: &mut Beams<L>,
    insides: &mut [Inside],
    within: L::F,
    except: L::U,
    wanted: L::M,
) -> Met<L> {
    apart(
        l,
        #[inline(always)]
        || {
            let (mut met, mut passing) = meet_once(l, tracer, beams, insides, within, except, wanted);
            let mut rest = within;
            for _ in 0..MOST_PASSES {
                if !passing.any() {
                    break;
                }
                beams.advance(&met.hits, &met.points, passing);
                rest = rest - met.hits.t;
                let (next, again) = meet_once(l, tracer, beams, insides, rest, except, passing);
                met = Met::pick(passing, next, met);
                passing = again;
            }
            met.some = met.some & !passing;
            met
        },
    )
}

/// As [`meet`], up to the first boundary; and the lanes that have crossed one that parts nothing.
#[inline(always)]
fn meet_once<L: Lanes>(
    l: L,
    tracer: &Tracer,
    beams: &mut Beams<L>,
    insides: &mut [Inside],
    within: L::F,
    except: L::U,
    wanted: L::M,
) -> (Met<L>, L::M) {
    let hits = tracer.surfaces.closest(l, &beams.rays, within, except, wanted);
    let some = wanted & !hits.place.is(l.u(NOWHERE));
    if tracer.dielectrics.any_absorbing() {
        let mut absorption = V::all(l.f(0.0));
        for lane in wanted.lanes() {
            let sigma = tracer.dielectrics.absorption(&insides[lane]) * tracer.space.unit();
            absorption.set(lane, single(sigma));
        }
        let travelled = some.pick(hits.t, within);
        let left = transmission(l, absorption, travelled);
        beams.weight = V::pick(wanted, beams.weight.times(left), beams.weight);
    }
    let points = tracer.surfaces.points(l, &beams.rays, &hits, some);
    let entering = points.n.dot(beams.rays.d).lt(l.f(0.0));
    let mut bsdfs = tracer.bsdfs(l, &hits, &points, some);
    let mut passing = 0;
    for lane in (some & bsdfs.transmit(l)).lanes() {
        let id = tracer.surfaces.primitive(slot(hits.place.get(lane)));
        let enters = entering.bits() >> lane & 1 == 1;
        match tracer.dielectrics.boundary(&insides[lane], id, enters) {
            Boundary::Interface(ratio) => bsdfs.eta.set(lane, ratio as f32),
            Boundary::Nothing => {
                passing |= 1 << lane;
                tracer.dielectrics.cross(&mut insides[lane], id, enters);
            }
        }
    }
    (Met { some, hits, points, entering, bsdfs }, l.mask(passing))
}

impl<L: Lanes> Met<L> {
    #[inline(always)]
    fn pick(mask: L::M, yes: Met<L>, no: Met<L>) -> Met<L> {
        Met {
            some: (mask & yes.some) | (!mask & no.some),
            hits: Hits {
                t: mask.pick(yes.hits.t, no.hits.t),
                place: mask.pick_word(yes.hits.place, no.hits.place),
                detail: mask.pick_word(yes.hits.detail, no.hits.detail),
            },
            points: Points {
                p: V::pick(mask, yes.points.p, no.points.p),
                n: V::pick(mask, yes.points.n, no.points.n),
                shading: V::pick(mask, yes.points.shading, no.points.shading),
            },
            entering: (mask & yes.entering) | (!mask & no.entering),
            bsdfs: Bsdfs {
                kind: mask.pick_word(yes.bsdfs.kind, no.bsdfs.kind),
                color: V::pick(mask, yes.bsdfs.color, no.bsdfs.color),
                alpha: mask.pick(yes.bsdfs.alpha, no.bsdfs.alpha),
                eta: mask.pick(yes.bsdfs.eta, no.bsdfs.eta),
                coat: mask.pick_word(yes.bsdfs.coat, no.bsdfs.coat),
            },
        }
    }

    /// Reflectance of what is polished.
    #[inline(always)]
    pub fn fresnel(&self, l: L, d: V<L>) -> fresnel::Fresnel<L> {
        fresnel::dielectric(l, self.cosine(l, d), self.bsdfs.eta)
    }

    /// Cosine of incidence.
    #[inline(always)]
    fn cosine(&self, l: L, d: V<L>) -> L::F {
        self.points.shading.dot(d).magnitude().greater(l.f(LEAST_COSINE)).lesser(l.f(1.0))
    }
}

impl<L: Lanes> Beams<L> {
    /// Rays, with the derivatives by their direction.
    #[inline(always)]
    pub fn new(l: L, rays: Rays<L>) -> Beams<L> {
        let (x, y) = basis(l, rays.d);
        let zero = V::all(l.f(0.0));
        Beams { rays, dp: [zero; 2], dd: [x, y], weight: V::all(l.f(1.0)), odds: l.f(1.0) }
    }

    /// Sends the rays on at polished surfaces, those of a mask through; the lanes that can go that way.
    #[inline(always)]
    pub fn scatter(
        &mut self,
        l: L,
        tracer: &Tracer,
        met: &Met<L>,
        through: L::M,
        insides: &mut [Inside],
    ) -> L::M {
        apart(
            l,
            #[inline(always)]
            || self.scatter_here(l, tracer, met, through, insides),
        )
    }

    #[inline(always)]
    fn scatter_here(
        &mut self,
        l: L,
        tracer: &Tracer,
        met: &Met<L>,
        through: L::M,
        insides: &mut [Inside],
    ) -> L::M {
        let (zero, one) = (l.f(0.0), l.f(1.0));
        let glass = met.some & met.bsdfs.are(l, Kind::PolishedDielectric);
        let metal = met.some & met.bsdfs.are(l, Kind::PolishedMetal);
        let mirror = metal | (met.some & met.bsdfs.are(l, Kind::Mirror));
        let d = self.rays.d;
        let cosine = met.cosine(l, d);
        let fresnel = met.fresnel(l, d);
        let passes = glass & through & zero.lt(fresnel.cosine);
        let reflects = (glass | mirror) & !through;
        let gone = passes | reflects;
        if !gone.any() {
            return gone;
        }
        self.advance(&met.hits, &met.points, gone);

        // The normal on the side of the ray, and how it changes.
        let side = met.entering.pick(one, -one);
        let n = met.points.shading * side;
        let bend = tracer.surfaces.bend(l, &met.hits, &met.points, self.dp, gone);
        let dn = [bend[0] * side, bend[1] * side];

        // Snell's law in vectors: d/η + (cosine/η − refracted) n; and the mirror's: d + 2 cosine n.
        let inverse = passes.pick(one / met.bsdfs.eta, one);
        let refracted = passes.pick(fresnel.cosine, -cosine);
        let factor = inverse * cosine - refracted;
        for (dd, dn) in self.dd.iter_mut().zip(dn) {
            let dcosine = -(dd.dot(n) + d.dot(dn));
            let bent = inverse * inverse * cosine * dcosine / refracted;
            let change = *dd * inverse + n * (inverse * dcosine - bent) + dn * factor;
            *dd = V::pick(gone, change, *dd);
        }
        let w = (d * inverse + n * factor).normalized(l);
        self.rays.d = V::pick(gone, w, d);
        let gone = gone & self.agrees(l, tracer, met, through);

        // What is left of light, and of luck.
        let share = passes.pick(one - fresnel.reflectance, fresnel.reflectance);
        let color = V::pick(metal, fresnel::schlick(l, met.bsdfs.color, cosine), met.bsdfs.color);
        let weight = V::pick(mirror, color, V::all(share * inverse * inverse));
        self.weight = V::pick(gone, self.weight.times(weight), self.weight);
        self.odds = (gone & !mirror).pick(self.odds * share, self.odds);

        for lane in (gone & passes).lanes() {
            let id = tracer.surfaces.primitive(slot(met.hits.place.get(lane)));
            tracer.dielectrics.cross(&mut insides[lane], id, met.entering.bits() >> lane & 1 == 1);
        }
        gone
    }

    /// Whether the new directions are on the side of the surface that they are on of the normal it is shaded with.
    #[inline(always)]
    fn agrees(&self, l: L, tracer: &Tracer, met: &Met<L>, through: L::M) -> L::M {
        if !tracer.surfaces.any_smooth() {
            return l.mask(u32::MAX);
        }
        let side = met.entering.pick(l.f(1.0), l.f(-1.0));
        let outside = l.f(0.0).lt(met.points.n.dot(self.rays.d) * side);
        (outside & !through) | (!outside & through)
    }

    /// Moves the origins to points that were met.
    #[inline(always)]
    fn advance(&mut self, hits: &Hits<L>, points: &Points<L>, mask: L::M) {
        let d = self.rays.d;
        let facing = d.dot(points.n);
        for i in 0..2 {
            let moved = self.dp[i] + self.dd[i] * hits.t;
            let along = moved.dot(points.n) / facing;
            self.dp[i] = V::pick(mask, moved - d * along, self.dp[i]);
        }
        self.rays.o = V::pick(mask, points.p, self.rays.o);
        self.rays.start = mask.pick_word(hits.place, self.rays.start);
        self.rays.detail = mask.pick_word(hits.detail, self.rays.detail);
    }
}
