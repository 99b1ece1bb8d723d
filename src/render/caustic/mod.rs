//! Caustics: light that comes by mirrors and clear glass to a surface that scatters.
//!
//! A path that is scattered at random finds such light only by luck. So it is looked for: photons from the lamps say
//! by which chains of polished surfaces light comes to a place ([`photons`], [`seeds`]); Newton's method, on the
//! derivatives of the very chain that a path would follow, turns a chain to the centre of its lamp ([`chain`],
//! [`aim`]); and about the direction that was found, one is drawn from the ellipse that the chain carries to the
//! lamp's disc ([`aim::Lobe`]). The light of that lamp counts if the ray meets it, shared with the finds of luck by the
//! power heuristic: both ways draw a direction at the same surface, so their densities compare as they are.
//! Whatever no seed leads to is left to luck, so nothing is lost and nothing is counted twice.
//!
//! To a lamp without size there is no luck, and its chain is solved exactly; all seeds of the place that lead to the same
//! chain are known, and with them the probability to have found it. What the seeds do not know is searched for ([`search`]).
//!
//! Paths note what they want to know ([`walk`]) and go on; when there are enough of these to fill all lanes they are
//! answered together ([`looks`], [`answer`]). Where a look is worth it is decided by roulette. All depends on the scene and the place
//! alone, so a pixel's value does not depend on others.
//!
//! Photons as seeds of chains are those of "Photon-driven manifold sampling", Proceedings of the ACM on Computer Graphics
//! and Interactive Techniques 7 (3), 2024; walks on chains go back to Wenzel Jakob and Steve Marschner, "Manifold
//! exploration", 2012.

pub mod aim;
mod answer;
pub mod chain;
pub mod goal;
mod looks;
mod photons;
mod search;
mod seeds;
pub mod walk;

use super::lanes::One;
use super::light::{Lights, Receivers};
use super::vector::V;
use super::{Cancelled, Control, Tracer};
use chain::Ways;
use goal::Goal;
use search::Search;
use seeds::{Cell, Seed, Seeds};
use std::f32::consts::PI;

/// Where the caustics of a scene come from.
#[derive(Default)]
pub struct Caustics {
    goals: Vec<Goal>,
    /// For each lamp which goal it is, if any.
    goal_of: Vec<Option<u32>>,
    seeds: Option<Seeds>,
    /// For lamps without size.
    search: Option<Search>,
}

/// Whether a scene may have any: it takes polished surfaces.
pub fn may_be(tracer: &Tracer) -> bool {
    tracer.scene.trace.indirect && !photons::casters(tracer).is_empty()
}

impl Caustics {
    /// Sends photons through a scene. Without polished surfaces or without lamps there is nothing to do, ever.
    ///
    /// # Errors
    ///
    /// If the control cancels.
    pub fn new(tracer: &Tracer, control: &Control) -> Result<Caustics, Cancelled> {
        let casters = photons::casters(tracer);
        if casters.is_empty() || !tracer.scene.trace.indirect {
            return Ok(Caustics::default());
        }
        let goals = tracer.lights.goals();
        let photons = photons::photons(tracer, &goals, &casters, control)?;
        let search = Search::new(&goals, &photons);
        let effort = |p, seeds: &[Seed]| effort(&tracer.lights, &goals, p, seeds);
        let Some(seeds) = Seeds::new(photons, effort, control)? else {
            return Ok(Caustics::default());
        };
        let mut goal_of = vec![None; tracer.lights.len()];
        for (index, goal) in (0..).zip(&goals) {
            goal_of[goal.lamp as usize] = Some(index);
        }
        Ok(Caustics { goals, goal_of, seeds: Some(seeds), search })
    }

    /// Forgets all seeds, so that what luck does not find has to be searched for.
    #[cfg(test)]
    pub fn forget_seeds(&mut self) {
        if let Some(seeds) = &mut self.seeds {
            seeds.forget();
        }
    }

    /// Whether there are none.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.seeds.is_none()
    }

    /// What leads to light at a place, on the side of a normal; none if nothing does.
    #[inline]
    fn hope(&self, p: V<One>, n: V<One>) -> Option<Hope<'_>> {
        let seeds = self.seeds.as_ref()?;
        Hope::within(seeds, seeds.around(p.get(0))?, n)
    }

    /// The goal that a lamp is, if rays find it by chance too.
    #[inline]
    fn goal_of(&self, lamp: u32) -> Option<u32> {
        let goal = *self.goal_of.get(lamp as usize)?;
        goal.filter(|&goal| !self.goals[goal as usize].target.is_point())
    }
}

/// The seeds of a place that may lead to light.
#[derive(Clone, Copy)]
struct Hope<'c> {
    seeds: &'c Seeds,
    cell: Cell,
    n: V<One>,
    /// Sum of their weights.
    total: f32,
}

impl<'c> Hope<'c> {
    /// The seeds of a cell that may lead to light on the side of a normal, if there are any.
    #[inline]
    fn within(seeds: &'c Seeds, cell: Cell, n: V<One>) -> Option<Hope<'c>> {
        let mut total = 0.0;
        for seed in seeds.of(cell) {
            total += seed.weight(n);
        }
        (total > 0.0).then_some(Hope { seeds, cell, n, total })
    }

    /// The seeds that lead to a lamp by a certain way, by their place in the cell, each with the probability to be chosen.
    #[inline]
    fn by(self, ways: Ways, goal: u32) -> impl Iterator<Item = (u32, &'c Seed, f32)> {
        let seeds = (0..).zip(self.seeds.of(self.cell));
        let led = seeds.filter(move |(_, seed)| seed.ways == ways && seed.goal == goal);
        led.map(move |(index, seed)| (index, seed, seed.weight(self.n) / self.total))
            .filter(|(.., share)| *share > 0.0)
    }

    /// Chooses a seed, by its place in the cell; the number is made uniform again for further use.
    #[inline]
    fn choose(self, u: f32) -> Option<(u32, &'c Seed, f32)> {
        let mut left = u * self.total;
        let mut chosen = None;
        for (index, seed) in (0..).zip(self.seeds.of(self.cell)) {
            let weight = seed.weight(self.n);
            if weight > 0.0 {
                chosen = Some((index, seed, (left / weight).clamp(0.0, 1.0 - f32::EPSILON)));
                if left < weight {
                    break;
                }
                left -= weight;
            }
        }
        chosen
    }
}

/// How often light is looked for where all comes by chains that luck hardly finds.
const EFFORT: f32 = 0.5;
/// The least of it, for photons say only about what is to be hoped for; more where luck never finds any. The rest of the
/// probability is for [`search::EFFORT`].
const LEAST_EFFORT: f32 = 0.005;
const LEAST_WITHOUT_LUCK: f32 = 0.05;
/// About how many steps of a path a look takes.
const COST: f32 = 10.0;

/// How often to look for light at a place, as a probability: by the irradiance that is hoped for, beside what comes without
/// caustics.
///
/// With m hoped for and σ the noise of all else, looks with probability q beside luck with probability p have the variance
/// σ² + m²/(q + p), and cost 1 + `COST` q. The product is least for q = m/σ √((1 − `COST` p)/`COST`) − p; luck is the
/// hemisphere's share that shows the lamps by way of the chains, weighted by the cosine. σ is taken for 0.63 of all light
/// that comes, hoped for or direct, which makes the factor `EFFORT`.
fn effort(lights: &Lights, goals: &[Goal], p: [f32; 3], seeds: &[Seed]) -> f32 {
    let (mut hoped, mut luck) = (0.0, 0.0);
    for seed in seeds {
        hoped += seed.irradiance;
        luck += goals[seed.goal as usize].radiance.map_or(0.0, |radiance| seed.irradiance / (PI * radiance));
    }
    if hoped <= 0.0 {
        return 0.0;
    }
    let p = V::splat(One, p);
    let direct = lights.irradiance(One, &Receivers { p, n: V::splat(One, [0.0, 0.0, 1.0]), open: true });
    let worth = (1.0 - COST * luck).max(0.0).sqrt();
    let best = EFFORT * hoped / (hoped + direct) * worth - luck;
    let least = if luck > 0.0 { LEAST_EFFORT } else { LEAST_WITHOUT_LUCK };
    best.max(least * worth)
}
