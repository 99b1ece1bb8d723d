//! Answering what paths want to know about caustics, as many at a time as there are lanes.

use super::aim::{Aims, Lobe, Probes, aim, enough, missed, most};
use super::chain::{Beams, Met, WaysOf, follow, meet};
use super::goal::{Goal, Target};
use super::looks::{Look, Scattering, Wanted};
use super::search::{Random, draws_until, is_same};
use super::{Caustics, Hope};
use crate::render::Tracer;
use crate::render::bsdf::Bsdfs;
use crate::render::lanes::{Float, Lanes, MOST, Mask, One, Word, apart};
use crate::render::light::{BRIGHTEST, Source};
use crate::render::media::Inside;
use crate::render::shape::{NOWHERE, Rays, slot};
use crate::render::vector::{V, basis};

/// Memory that answers use one after the other.
#[derive(Default)]
pub struct Work {
    inside: Vec<Inside>,
    tasks: Vec<Task>,
    probes: Vec<Probes<One>>,
    chains: Vec<Aimed>,
    /// The light of each look.
    pub answers: Vec<[f32; 3]>,
}

/// A seed to aim for a look, with the probability to be chosen.
#[derive(Clone, Copy)]
struct Task {
    look: u32,
    seed: u32,
    share: f32,
    towards: [V<One>; 2],
}

/// A direction that was found for a look, with its density; to a point, the probability to have found it.
#[derive(Clone, Copy)]
struct Aimed {
    look: u32,
    w: V<One>,
    density: f32,
}

impl Work {
    /// Answers looks, each from a place that lies in these solids.
    pub fn answer<L: Lanes>(&mut self, l: L, tracer: &Tracer, list: &mut [Look], insides: &[Inside]) {
        apart(
            l,
            #[inline(always)]
            || self.answer_here(l, tracer, list, insides),
        );
    }

    #[inline(always)]
    fn answer_here<L: Lanes>(&mut self, l: L, tracer: &Tracer, list: &mut [Look], insides: &[Inside]) {
        let work = self;
        work.inside.resize_with(MOST, Inside::default);
        work.answers.clear();
        work.answers.resize(list.len(), [0.0; 3]);
        let caustics = &tracer.caustics;
        work.plan(caustics, tracer.scene.trace.bounces, list);
        work.probes.clear();
        let mut from = 0;
        while from < work.tasks.len() {
            let to = work.tasks.len().min(from + L::N);
            let Work { inside, tasks, probes, .. } = &mut *work;
            aim_all(l, tracer, (list, insides), &tasks[from..to], inside, probes);
            from = to;
        }
        work.judge(tracer, list, insides);
        let mut from = 0;
        while from < work.chains.len() {
            let to = work.chains.len().min(from + L::N);
            let Work { inside, chains, answers, .. } = &mut *work;
            gather(l, tracer, (list, insides), &chains[from..to], inside, answers);
            from = to;
        }
    }

    /// Lists what to aim: for each look all seeds of its place that lead to its lamp by its way.
    fn plan(&mut self, caustics: &Caustics, most_bounces: u32, list: &mut [Look]) {
        self.tasks.clear();
        for (index, look) in (0..).zip(list) {
            if let (Wanted::Unknown { key, .. }, Some(search)) = (look.wanted, &caustics.search) {
                let draw = search.draw(&mut Random::new(key));
                (look.ways, look.goal) = (draw.ways, draw.goal);
                look.bounces[0] += look.ways.count();
                if look.bounces[0] > most_bounces {
                    continue;
                }
                let p = V::splat(One, look.p);
                self.tasks.push(Task { look: index, seed: UNKNOWN, share: 0.0, towards: draw.towards(p) });
                if let Some(hope) = caustics.hope(p, V::splat(One, look.n)) {
                    (look.cell, look.total) = (hope.cell, hope.total);
                }
            }
            let Some(hope) = hope(caustics, look) else { continue };
            for (seed, known, share) in hope.by(look.ways, look.goal) {
                let towards = hope.seeds.towards(known, V::splat(One, look.p));
                self.tasks.push(Task { look: index, seed, share: share * look.effort, towards });
            }
        }
    }

    /// Draws directions to follow about what was aimed, and answers what asks for no more than densities.
    fn judge(&mut self, tracer: &Tracer, list: &[Look], insides: &[Inside]) {
        let caustics = &tracer.caustics;
        self.chains.clear();
        let mut from = 0;
        while from < self.tasks.len() {
            let index = self.tasks[from].look;
            let look = &list[index as usize];
            let count = self.tasks[from..].iter().take_while(|task| task.look == index).count();
            let (tasks, probes) = (&self.tasks[from..from + count], &self.probes[from..from + count]);
            from += count;
            let size = caustics.goals[look.goal as usize].target.size();
            let density = |w: V<One>| {
                let each = tasks.iter().zip(probes);
                let lobes = each.filter_map(|(task, probe)| Some((task, Lobe::new(*probe, size)?)));
                lobes.map(|(task, lobe)| task.share * lobe.pdf(w)).sum::<f32>()
            };
            let (seed, rest, u) = match look.wanted {
                Wanted::Light { seed, rest, u, .. } => (seed, rest, u),
                Wanted::Unknown { key, .. } => {
                    let inside = &insides[index as usize];
                    if tasks[0].seed == UNKNOWN
                        && let Some((w, density)) = unknown(tracer, (look, inside), key, probes)
                    {
                        self.chains.push(Aimed { look: index, w, density });
                    }
                    continue;
                }
                Wanted::Share { w, odds, radiance } => {
                    let share = tracer.sharing.found(One, odds, density(V::splat(One, w)));
                    self.answers[index as usize] = radiance.map(|v| v * share);
                    continue;
                }
            };
            let own = tasks.iter().position(|task| task.seed == seed).map(|at| &probes[at]);
            let Some(own) = own.filter(|own| own.some) else { continue };
            let aimed = if size == 0.0 {
                let root = own.root();
                let found = tasks.iter().zip(probes).filter(|(_, probe)| is_same(probe, root));
                let probability = found.map(|(task, _)| task.share).sum();
                Aimed { look: index, w: own.w, density: probability }
            } else {
                let Some(lobe) = Lobe::new(*own, size) else { continue };
                let w = lobe.sample(rest, u);
                Aimed { look: index, w, density: density(w) }
            };
            if aimed.density > 0.0 && aimed.density < f32::INFINITY {
                self.chains.push(aimed);
            }
        }
    }
}

/// A seed that is none.
const UNKNOWN: u32 = u32::MAX;

/// The direction of a chain that was found at random, the first of some probes, and about the probability to find it, if
/// none of the others, which seeds led to, is the same.
fn unknown(
    tracer: &Tracer,
    (look, inside): (&Look, &Inside),
    key: u64,
    probes: &[Probes<One>],
) -> Option<(V<One>, f32)> {
    let search = tracer.caustics.search.as_ref()?;
    let (found, known) = probes.split_first().filter(|(found, _)| found.some)?;
    let root = found.root();
    if known.iter().any(|probe| is_same(probe, root)) {
        return None;
    }
    let (rays, _) = starts(One, &[look]);
    let draws =
        draws_until(tracer, search, (rays, inside), (look.ways, look.goal), root, &mut Random::new(!key));
    Some((found.w, look.effort / draws as f32))
}

fn hope<'c>(caustics: &'c Caustics, look: &Look) -> Option<Hope<'c>> {
    let seeds = caustics.seeds.as_ref()?;
    Some(Hope { seeds, cell: look.cell, n: V::splat(One, look.n), total: look.total })
}

/// Numbers of several looks as lanes.
macro_rules! column {
    ($l:expr, $load:ident, $zero:expr, $items:expr, |$item:ident| $value:expr) => {{
        let mut column = [$zero; MOST];
        for (value, $item) in column.iter_mut().zip($items.iter()) {
            *value = $value;
        }
        $l.$load(&column)
    }};
}

/// Vectors of several looks as lanes.
macro_rules! vectors {
    ($l:expr, $items:expr, |$item:ident| $value:expr) => {{
        let mut columns = [[0.0; MOST]; 3];
        for (lane, $item) in $items.iter().enumerate() {
            let [x, y, z] = $value;
            columns[0][lane] = x;
            columns[1][lane] = y;
            columns[2][lane] = z;
        }
        V::new($l.load(&columns[0]), $l.load(&columns[1]), $l.load(&columns[2]))
    }};
}

/// What several tasks or chains, which are no more than there are lanes, are about.
macro_rules! about {
    ($items:expr, $all:expr, |$item:ident| $index:expr) => {{
        let mut about = [&$all[0]; MOST];
        for (this, $item) in about.iter_mut().zip($items.iter()) {
            *this = &$all[$index as usize];
        }
        about
    }};
}

/// The starts of chains, without direction, and their ways.
#[inline(always)]
fn starts<L: Lanes>(l: L, looks: &[&Look]) -> (Rays<L>, WaysOf<L>) {
    let o = vectors!(l, looks, |look| look.p);
    let start = column!(l, load_words, NOWHERE, looks, |look| look.place);
    let detail = column!(l, load_words, 0, looks, |look| look.detail);
    let through = column!(l, load_words, 0, looks, |look| look.ways.through);
    let end = column!(l, load_words, 0, looks, |look| look.ways.end);
    (Rays { o, d: V::all(l.f(0.0)), start, detail }, WaysOf { through, end })
}

/// The middles or directions of lamps, and which of them are distant.
#[inline(always)]
fn targets<L: Lanes>(l: L, goals: &[&Goal]) -> (V<L>, L::M) {
    let mut far = 0;
    for (lane, goal) in goals.iter().enumerate() {
        far |= u32::from(matches!(goal.target, Target::Far { .. })) << lane;
    }
    let to = vectors!(l, goals, |goal| match goal.target {
        Target::Near { center, .. } => center,
        Target::Far { direction, .. } => direction,
    });
    (to, l.mask(far))
}

/// Aims at most as many seeds as there are lanes.
#[inline(always)]
fn aim_all<L: Lanes>(
    l: L,
    tracer: &Tracer,
    (list, insides): (&[Look], &[Inside]),
    tasks: &[Task],
    work: &mut [Inside],
    probes: &mut Vec<Probes<One>>,
) {
    let looks = &about!(tasks, list, |task| task.look)[..tasks.len()];
    let goals = &about!(looks, tracer.caustics.goals, |look| look.goal)[..tasks.len()];
    let (starts, ways) = starts(l, looks);
    let (to, far) = targets(l, goals);
    let mut near_enough = [[0.0; MOST]; 2];
    for (lane, (look, goal)) in looks.iter().zip(goals).enumerate() {
        [near_enough[0][lane], near_enough[1][lane]] = enough(&goal.target, V::splat(One, look.p));
    }
    let aims = Aims {
        starts,
        towards: [
            vectors!(l, tasks, |task| task.towards[0].get(0)),
            vectors!(l, tasks, |task| task.towards[1].get(0)),
        ],
        ways,
        to,
        far,
        enough: [l.load(&near_enough[0]), l.load(&near_enough[1])],
        most: column!(l, load_words, 0, goals, |goal| most(&goal.target)),
    };
    let from = about!(tasks, insides, |task| task.look);
    let wanted = l.mask(u32::MAX >> (u32::BITS - tasks.len() as u32));
    let found = aim(l, tracer, &aims, (&from, work), wanted);
    for lane in 0..tasks.len() {
        probes.push(found.lane(lane));
    }
}

/// Follows at most as many chains as there are lanes to their lamps, and notes what they bring.
#[inline(always)]
fn gather<L: Lanes>(
    l: L,
    tracer: &Tracer,
    (list, insides): (&[Look], &[Inside]),
    chains: &[Aimed],
    work: &mut [Inside],
    answers: &mut [[f32; 3]],
) {
    let looks = &about!(chains, list, |chain| chain.look)[..chains.len()];
    let goals = &about!(looks, tracer.caustics.goals, |look| look.goal)[..chains.len()];
    let (starts, ways) = starts(l, looks);
    let w = vectors!(l, chains, |chain| chain.w.get(0));
    let wanted = l.mask(u32::MAX >> (u32::BITS - chains.len() as u32));
    let (scattered, by_chance) = scattered(l, tracer, looks, w, wanted);
    let wanted = wanted & l.f(0.0).lt(scattered.max());
    for (inside, chain) in work.iter_mut().zip(chains) {
        inside.clone_from(&insides[chain.look as usize]);
    }
    let (mut beams, alive) = follow(l, tracer, Rays { d: w, ..starts }, &ways, work, wanted);
    if !alive.any() {
        return;
    }
    let (to, far) = targets(l, goals);
    let (_, [x, y], ahead) = missed(l, &beams, to, far);
    let spread = (x[0] * y[1] - x[1] * y[0]).magnitude();
    let mut points = 0;
    for (lane, goal) in goals.iter().enumerate() {
        points |= u32::from(goal.target.is_point()) << lane;
    }
    let points = l.mask(points);
    let infinity = l.f(f32::INFINITY);
    let within = (points & !far).pick(ahead, infinity);
    let met = meet(l, tracer, &mut beams, work, within, l.u(u32::MAX), alive);
    let density = column!(l, load, 0.0, chains, |chain| chain.density);
    let share = tracer.sharing.gathered(l, density, by_chance * beams.odds);
    let factor = points.pick(l.f(1.0) / (density * spread), share / density);
    let carried = scattered.times(beams.weight) * factor;
    for (lane, (chain, goal)) in chains.iter().zip(goals).enumerate() {
        if alive.bits() >> lane & 1 == 0 {
            continue;
        }
        let Some(radiance) = shown(tracer, goal, &beams, &met, lane) else { continue };
        let (carried, shown) = (V::splat(One, carried.get(lane)), V::splat(One, radiance));
        let [r, g, b] = carried.times(shown).get(0);
        if r.is_finite() && g.is_finite() && b.is_finite() {
            answers[chain.look as usize] = [r.min(BRIGHTEST), g.min(BRIGHTEST), b.min(BRIGHTEST)];
        }
    }
}

/// Throughput times BSDF times cosine, and the density with which chance draws the direction.
#[inline(always)]
fn scattered<L: Lanes>(l: L, tracer: &Tracer, looks: &[&Look], w: V<L>, wanted: L::M) -> (V<L>, L::F) {
    let mut by = [Scattering::default(); MOST];
    for (scattering, look) in by.iter_mut().zip(looks) {
        if let Wanted::Light { scattering: here, .. } | Wanted::Unknown { scattering: here, .. } = look.wanted
        {
            *scattering = here;
        }
    }
    let by = &by[..looks.len()];
    let z = vectors!(l, looks, |look| look.n);
    let (x, y) = basis(l, z);
    let wi = V::new(w.dot(x), w.dot(y), w.dot(z));
    let bsdfs = Bsdfs {
        kind: column!(l, load_words, 0, by, |at| at.kind),
        color: vectors!(l, by, |at| at.color),
        alpha: column!(l, load, 1.0, by, |at| at.alpha),
        eta: l.f(1.0),
        coat: column!(l, load_words, 0, by, |at| at.coat),
    };
    let wo = vectors!(l, by, |at| at.wo);
    let rim = vectors!(l, by, |at| at.rim);
    let throughput = vectors!(l, by, |at| at.throughput);
    let (value, pdf) = bsdfs.eval(l, &tracer.materials.coats, wo, wi, wanted);
    let zero = l.f(0.0);
    let above = zero.lt(wi.z) & zero.lt(rim.dot(w));
    (V::pick(above, throughput.times(value), V::all(zero)), pdf)
}

/// What a ray shows of a lamp that its chain was to lead to: the radiance; of a point its intensity, of a distant one
/// without a disc its irradiance.
fn shown<L: Lanes>(
    tracer: &Tracer,
    goal: &Goal,
    beams: &Beams<L>,
    met: &Met<L>,
    lane: usize,
) -> Option<[f32; 3]> {
    let meets = met.some.bits() >> lane & 1 == 1;
    let lamp = tracer.lights.lamp(goal.lamp);
    let d = V::splat(One, beams.rays.d.get(lane));
    match goal.source {
        Source::Light(_) => (!meets).then(|| lamp.along(d)).flatten(),
        Source::Primitive(id) => {
            let at = tracer.surfaces.slot(id);
            let seen = met.entering.bits() >> lane & 1 == 1 || !tracer.surfaces.is_closed(at);
            (meets && seen && slot(met.hits.place.get(lane)) == at).then(|| met.bsdfs.color.get(lane))
        }
    }
}
