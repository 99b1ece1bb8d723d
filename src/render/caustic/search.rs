//! Searching for chains to lamps without size that no seed of a place knows.
//!
//! Luck never finds such a lamp, so what the seeds miss would be missing from the picture. Now and then a chain is begun
//! at random: as a photon from anywhere in the scene, or any way in any direction. What that leads to counts
//! only if no seed of the place leads there too. The probability to find it is not known; but how many chains it takes
//! until one leads there again is, on average, one over that probability (Zeltner, Georgiev and Jakob, "Specular
//! manifold sampling for rendering high-frequency caustics and glints", 2020, §4.2).

use super::aim::{Aims, Probes, aim, enough, most};
use super::chain::{MOST_EVENTS, Ways, WaysOf};
use super::goal::{Goal, Target};
use super::photons::Photon;
use crate::render::Tracer;
use crate::render::lanes::{Lanes, One};
use crate::render::media::Inside;
use crate::render::sampler::mix_wide;
use crate::render::shape::Rays;
use crate::render::vector::V;
use crate::render::warp;

/// What chains may be begun like.
pub struct Search {
    /// Some photons of such lamps: the way back, the lamp, the last surface.
    photons: Vec<(Ways, u32, [f32; 3])>,
    /// The lamps.
    goals: Vec<u32>,
}

/// The beginning of a chain.
pub struct Draw {
    /// The way to the lamp.
    pub ways: Ways,
    /// The lamp, by its place among the goals.
    pub goal: u32,
    /// Where to aim first, if anywhere, and a direction to aim in else.
    toward: Option<[f32; 3]>,
    w: V<One>,
}

/// How often to search where a path carries all.
pub const EFFORT: f32 = 0.01;
/// Photons that are remembered.
const PHOTONS: usize = 1024;
/// How often the beginning is a photon's.
const AS_PHOTON: f32 = 0.75;
/// Chains after which a search is given up. What is found so rarely is a little too dark.
const MOST_DRAWS: u32 = 1 << 12;
/// Directions so near to each other, by the square of their distance, are the same.
const SAME: f32 = 1e-6;

impl Search {
    /// For the lamps of a scene that have no size; none if all have.
    pub fn new(goals: &[Goal], photons: &[Photon]) -> Option<Search> {
        let is_point = |goal: u32| goals[goal as usize].target.is_point();
        let all: Vec<_> = photons.iter().filter(|photon| is_point(photon.goal)).collect();
        let some = all.iter().step_by(all.len().div_ceil(PHOTONS).max(1));
        let photons = some.map(|photon| (photon.ways, photon.goal, photon.toward)).collect();
        let goals: Vec<u32> = (0..goals.len() as u32).filter(|&goal| is_point(goal)).collect();
        (!goals.is_empty()).then_some(Search { photons, goals })
    }

    /// Begins a chain.
    pub fn draw(&self, random: &mut Random) -> Draw {
        let w = warp::sphere(One, [random.next(), random.next()]);
        if !self.photons.is_empty() && random.next() < AS_PHOTON {
            let (ways, goal, toward) = self.photons[random.below(self.photons.len())];
            return Draw { ways, goal, toward: Some(toward), w };
        }
        let goal = self.goals[random.below(self.goals.len())];
        // Each further surface half as often, and each either way.
        let count = 1 + random.bits().trailing_zeros().min(MOST_EVENTS - 1);
        let end = 1 << count;
        Draw { ways: Ways { through: random.bits() & (end - 1), end }, goal, toward: None, w }
    }
}

impl Draw {
    /// Directions to begin with.
    pub fn towards(&self, p: V<One>) -> [V<One>; 2] {
        let first = self.toward.map_or(self.w, |toward| (V::splat(One, toward) - p).normalized(One));
        [first, self.w]
    }
}

/// Whether two chains of a way are the same, of which one starts in a direction.
pub fn is_same(probe: &Probes<One>, root: V<One>) -> bool {
    probe.some && (probe.root() - root).squared() < SAME
}

/// How many chains it takes until one leads where another has led that was begun so.
pub fn draws_until(
    tracer: &Tracer,
    search: &Search,
    (start, inside): (Rays<One>, &Inside),
    (ways, goal): (Ways, u32),
    root: V<One>,
    random: &mut Random,
) -> u32 {
    let target = &tracer.caustics.goals[goal as usize].target;
    let (to, far) = match *target {
        Target::Near { center, .. } => (center, false),
        Target::Far { direction, .. } => (direction, true),
    };
    let mut work = [Inside::default()];
    for count in 1..MOST_DRAWS {
        let draw = search.draw(random);
        if draw.ways != ways || draw.goal != goal {
            continue;
        }
        let aims = Aims {
            starts: start,
            towards: draw.towards(start.o),
            ways: WaysOf { through: One.u(ways.through), end: One.u(ways.end) },
            to: V::splat(One, to),
            far,
            enough: enough(target, start.o),
            most: One.u(most(target)),
        };
        if is_same(&aim(One, tracer, &aims, (&[inside], &mut work), true), root) {
            return count;
        }
    }
    MOST_DRAWS
}

/// Independent numbers from a key.
pub struct Random(u64);

impl Random {
    /// Those of a key.
    pub fn new(key: u64) -> Random {
        Random(mix_wide(key))
    }

    fn bits(&mut self) -> u32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        (mix_wide(self.0) >> 32) as u32
    }

    /// In (0, 1).
    fn next(&mut self) -> f32 {
        ((self.bits() >> 9) as f32 + 0.5) / (1u32 << 23) as f32
    }

    fn below(&mut self, count: usize) -> usize {
        ((u64::from(self.bits()) * count as u64) >> 32) as usize
    }
}
