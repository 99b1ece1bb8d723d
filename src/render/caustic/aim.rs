//! Aiming chains at lamps by Newton's method, and drawing directions about those that hit.

use super::chain::{Beams, WaysOf, follow};
use super::goal::Target;
use crate::render::Tracer;
use crate::render::lanes::{Float, Lanes, Mask, One, Word, apart};
use crate::render::media::Inside;
use crate::render::shape::Rays;
use crate::render::vector::{V, basis};
use crate::render::warp;
use std::f32::consts::FRAC_1_PI;

/// What to aim at a lane, and from where.
#[derive(Clone, Copy)]
pub struct Aims<L: Lanes> {
    /// Where chains start; their direction does not matter.
    pub starts: Rays<L>,
    /// Directions to begin with, the better first.
    pub towards: [V<L>; 2],
    /// The way to the lamp.
    pub ways: WaysOf<L>,
    /// The middle of a lamp, or the direction of a distant one.
    pub to: V<L>,
    /// Whether it is distant.
    pub far: L::M,
    /// How near to it is near enough, how near bearable; squared.
    pub enough: [L::F; 2],
    /// How many chains to try at most.
    pub most: L::U,
}

/// Rays of chains, and by how much their ends miss the centres of lamps.
#[derive(Clone, Copy)]
pub struct Probes<L: Lanes> {
    /// Whether there is one: chains may be broken, or lead away from the lamp.
    pub some: L::M,
    /// The directions that they start in.
    pub w: V<L>,
    /// Across the ends of the rays: lengths for a near lamp, sines for a distant one.
    pub miss: [L::F; 2],
    /// How the miss changes with the direction's components along the vectors of [`basis`], by columns.
    pub change: [[L::F; 2]; 2],
}

/// Follows chains and measures their misses.
#[inline(always)]
pub fn probe<L: Lanes>(
    l: L,
    tracer: &Tracer,
    aims: &Aims<L>,
    (from, insides): (&[&Inside], &mut [Inside]),
    w: V<L>,
    wanted: L::M,
) -> Probes<L> {
    for lane in wanted.lanes() {
        insides[lane].clone_from(from[lane]);
    }
    let rays = Rays { d: w, ..aims.starts };
    let (beams, alive) = follow(l, tracer, rays, &aims.ways, insides, wanted);
    let (miss, change, ahead) = missed(l, &beams, aims.to, aims.far);
    let finite = squared::<L>(miss).lt(l.f(f32::MAX));
    Probes { some: alive & finite & l.f(0.0).lt(ahead), w, miss, change }
}

/// See [`Probes::miss`] and [`Probes::change`]; and how far ahead the lamp is.
type Missed<L> = ([<L as Lanes>::F; 2], [[<L as Lanes>::F; 2]; 2], <L as Lanes>::F);

/// By how much rays miss a lamp, how that changes, and how far ahead the lamp is.
#[inline(always)]
pub fn missed<L: Lanes>(l: L, beams: &Beams<L>, to: V<L>, far: L::M) -> Missed<L> {
    let (o, d) = (beams.rays.o, beams.rays.d);
    let distance = (to - o).dot(d);
    let (x, y) = basis(l, V::pick(far, to, d));
    let off = V::pick(far, d, o + d * distance - to);
    let mut moved = [[distance; 2]; 2];
    for (moved, (dp, dd)) in moved.iter_mut().zip(beams.dp.into_iter().zip(beams.dd)) {
        let change = V::pick(far, dd, dp + dd * distance);
        *moved = [x.dot(change), y.dot(change)];
    }
    ([x.dot(off), y.dot(off)], moved, far.pick(to.dot(d), distance))
}

#[inline(always)]
fn squared<L: Lanes>([x, y]: [L::F; 2]) -> L::F {
    x * x + y * y
}

/// a × b.
#[inline(always)]
fn cross<L: Lanes>(a: [L::F; 2], b: [L::F; 2]) -> L::F {
    a[0] * b[1] - a[1] * b[0]
}

#[inline(always)]
fn pick_pair<L: Lanes>(mask: L::M, yes: [L::F; 2], no: [L::F; 2]) -> [L::F; 2] {
    [mask.pick(yes[0], no[0]), mask.pick(yes[1], no[1])]
}

impl<L: Lanes> Probes<L> {
    /// Area of the miss for each of solid angle at the start.
    #[inline(always)]
    pub fn spread(&self) -> L::F {
        cross::<L>(self.change[0], self.change[1]).magnitude()
    }

    /// Where the linear approximation has a miss, as components of the direction.
    #[inline(always)]
    fn components_of(&self, miss: [L::F; 2]) -> [L::F; 2] {
        let m = [miss[0] - self.miss[0], miss[1] - self.miss[1]];
        let [x, y] = self.change;
        let area = cross::<L>(x, y);
        [cross::<L>(m, y) / area, cross::<L>(x, m) / area]
    }

    /// The directions with these components.
    #[inline(always)]
    fn direction(&self, l: L, [a, b]: [L::F; 2]) -> V<L> {
        let (x, y) = basis(l, self.w);
        (self.w + x * a + y * b).normalized(l)
    }

    #[inline(always)]
    fn pick(mask: L::M, yes: Probes<L>, no: Probes<L>) -> Probes<L> {
        let change = [
            pick_pair::<L>(mask, yes.change[0], no.change[0]),
            pick_pair::<L>(mask, yes.change[1], no.change[1]),
        ];
        Probes {
            some: (mask & yes.some) | (!mask & no.some),
            w: V::pick(mask, yes.w, no.w),
            miss: pick_pair::<L>(mask, yes.miss, no.miss),
            change,
        }
    }
}

/// Longest step in the direction's components.
const LONGEST_STEP: f32 = 0.3;

/// Newton's method with halved steps: probes whose miss is enough, or failing that the best of all that is bearable.
/// What is found in a lane depends on nothing but the arguments of that lane.
#[inline(always)]
pub fn aim<L: Lanes>(
    l: L,
    tracer: &Tracer,
    aims: &Aims<L>,
    (from, insides): (&[&Inside], &mut [Inside]),
    wanted: L::M,
) -> Probes<L> {
    apart(
        l,
        #[inline(always)]
        || aim_here(l, tracer, aims, (from, insides), wanted),
    )
}

#[inline(always)]
fn aim_here<L: Lanes>(
    l: L,
    tracer: &Tracer,
    aims: &Aims<L>,
    (from, insides): (&[&Inside], &mut [Inside]),
    wanted: L::M,
) -> Probes<L> {
    let zero = l.f(0.0);
    let [first, second] = aims.towards;
    let mut best = probe(l, tracer, aims, (from, insides), first, wanted);
    let failed = wanted & !best.some;
    if failed.any() {
        let other = probe(l, tracer, aims, (from, insides), second, failed);
        best = Probes::pick(failed, other, best);
    }
    let mut share = l.f(1.0);
    let mut active = best.some;
    for index in 1..PROBES_EXACT {
        active = active & l.u(index).below(aims.most) & aims.enough[0].lt(squared::<L>(best.miss));
        if !active.any() {
            break;
        }
        let step = best.components_of([zero; 2]);
        let length = squared::<L>(step).root();
        // No number where the chain focuses perfectly.
        active = active & length.le(l.f(f32::MAX));
        let scale = share * l.f(LONGEST_STEP).lt(length).pick(l.f(LONGEST_STEP) / length, l.f(1.0));
        let next = best.direction(l, [step[0] * scale, step[1] * scale]);
        let found = probe(l, tracer, aims, (from, insides), next, active);
        let better = active & found.some & squared::<L>(found.miss).lt(squared::<L>(best.miss));
        best = Probes::pick(better, found, best);
        share = better.pick(l.f(1.0), share * 0.5);
    }
    best.some = best.some & squared::<L>(best.miss).le(aims.enough[1]);
    best
}

impl<L: Lanes> Probes<L> {
    /// One of them.
    #[inline]
    pub fn lane(&self, lane: usize) -> Probes<One> {
        let pair = |[a, b]: [L::F; 2]| [a.get(lane), b.get(lane)];
        Probes {
            some: self.some.bits() >> lane & 1 == 1,
            w: V::splat(One, self.w.get(lane)),
            miss: pair(self.miss),
            change: [pair(self.change[0]), pair(self.change[1])],
        }
    }
}

impl Probes<One> {
    /// The direction that the linear approximation says has no miss at all.
    pub fn root(&self) -> V<One> {
        self.direction(One, self.components_of([0.0; 2]))
    }
}

/// Directions about those that lead to a lamp with a size, drawn by where the linear approximation meets its disc.
///
/// Most are within the disc, a little enlarged; some fall off with the fourth power of the distance, for what is not
/// linear.
#[derive(Clone, Copy)]
pub struct Lobe {
    probe: Probes<One>,
    size: f32,
}

/// Share of a lobe that lies far out.
const TAIL: f32 = 0.25;
/// Radius of the disc in sizes of the lamp.
const ENLARGED: f32 = 1.1;
/// Density in solid angle, about: beyond these limits the chain focuses too well, or too badly, to have a lobe.
const DENSITIES: std::ops::Range<f32> = 1e-6..1e24;

impl Lobe {
    /// The lobe about a probe, for a lamp of that size.
    #[inline]
    pub fn new(probe: Probes<One>, size: f32) -> Option<Lobe> {
        let density = probe.spread() / (size * size);
        (probe.some && DENSITIES.contains(&density)).then_some(Lobe { probe, size })
    }

    /// Draws a direction.
    #[inline]
    pub fn sample(&self, choice: f32, u: [f32; 2]) -> V<One> {
        let [x, y] = warp::disc(One, u);
        let scale = if choice < TAIL {
            // Of a squared radius uniform in (0, 1), u / (1 − u) has the density 1 / (1 + r²)².
            self.size / (1.0 - squared::<One>([x, y])).max(f32::MIN_POSITIVE).sqrt()
        } else {
            self.size * ENLARGED
        };
        self.probe.direction(One, self.probe.components_of([x * scale, y * scale]))
    }

    /// Density of [`Lobe::sample`] in solid angle.
    #[inline]
    pub fn pdf(&self, w: V<One>) -> f32 {
        let along = w.dot(self.probe.w);
        if along <= 0.0 {
            return 0.0;
        }
        let (x, y) = basis(One, self.probe.w);
        let (i, j) = (w.dot(x) / along, w.dot(y) / along);
        let ([a, b], [m, n]) = (self.probe.change, self.probe.miss);
        let squared =
            squared::<One>([(m + i * a[0] + j * b[0]) / self.size, (n + i * a[1] + j * b[1]) / self.size]);
        let disc = if squared <= ENLARGED * ENLARGED { FRAC_1_PI / (ENLARGED * ENLARGED) } else { 0.0 };
        let tail = FRAC_1_PI / ((1.0 + squared) * (1.0 + squared));
        let density = TAIL * tail + (1.0 - TAIL) * disc;
        density * self.probe.spread() / (self.size * self.size) / (along * along * along)
    }
}

/// How near to the centre of a lamp a chain has to lead, in sizes of the lamp.
const CLOSE: f32 = 0.5;
const BEARABLE: f32 = 2.0;
/// The same for a point, as a share of its distance.
const EXACT: f32 = 2e-6;
const BEARABLY_EXACT: f32 = 1e-4;

/// Chains that are tried to a lamp with a size, and to a point, which are more.
const PROBES: u32 = 10;
const PROBES_EXACT: u32 = 20;

/// How many chains to try at most: see [`Aims::most`].
pub fn most(target: &Target) -> u32 {
    if target.is_point() { PROBES_EXACT } else { PROBES }
}

/// How near is near enough and bearable, squared: see [`Aims::enough`].
pub fn enough(target: &Target, from: V<One>) -> [f32; 2] {
    let [enough, bearable] = match *target {
        Target::Near { center, radius: 0.0 } => {
            let distance = (V::splat(One, center) - from).squared().sqrt();
            [EXACT * distance, BEARABLY_EXACT * distance]
        }
        Target::Far { sine: 0.0, .. } => [EXACT, BEARABLY_EXACT],
        _ => [CLOSE, BEARABLE].map(|share| share * target.size()),
    };
    [enough * enough, bearable * bearable]
}
