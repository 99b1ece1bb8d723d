//! Which light a vertex gathers from: more likely one that gives much there.

use super::tree::{LightTree, Place, grouped};
use super::{Kind, Lamp, Lights, Receivers};
use crate::math::PI;
use crate::render::lanes::{Float, Lanes, Mask, One, Word};
use crate::render::vector::V;

/// What the uniform share in choosing a light is. It bounds the noise where the estimates are far off.
const UNIFORM: f32 = 0.1;
/// No estimate is greater, so that sums are finite even for a light in the very point.
pub(super) const MOST_ESTIMATE: f32 = 1e30;
/// Up to so many lamps are asked one by one: in all lanes at once that is faster than a tree.
const FEW: usize = 64;
/// So many groups of near lamps are asked one by one, where there are more: a vertex amidst a group cannot tell its parts
/// apart, so groups are better small.
const GROUPS: usize = 32;

/// No group.
const NO_GROUP: u32 = u32::MAX;

/// How lamps are chosen.
pub(super) struct Choice {
    /// Those that are asked one by one.
    asked: Vec<u32>,
    /// The others, which all have a place, in groups.
    groups: Vec<LightTree>,
    /// Of each lamp in a group, which.
    group_of: Vec<Option<u32>>,
}

impl Choice {
    pub(super) fn new(lamps: &[Lamp]) -> Choice {
        let places: Vec<Place> = (0..).zip(lamps).filter_map(|(index, lamp)| lamp.place(index)).collect();
        let all = 0..lamps.len() as u32;
        let mut group_of = vec![None; lamps.len()];
        if places.len() <= FEW {
            return Choice { asked: all.collect(), groups: Vec::new(), group_of };
        }
        let groups: Vec<LightTree> = grouped(places, GROUPS).into_iter().map(LightTree::new).collect();
        for (index, group) in (0..).zip(&groups) {
            for lamp in group.lamps() {
                group_of[lamp as usize] = Some(index);
            }
        }
        Choice { asked: all.filter(|lamp| group_of[*lamp as usize].is_none()).collect(), groups, group_of }
    }

    /// The group of a lamp, if it is in one.
    fn group(&self, lamp: u32) -> Option<&LightTree> {
        self.group_of[lamp as usize].map(|group| &self.groups[group as usize])
    }
}

/// Lights that were chosen.
#[derive(Clone, Copy)]
pub struct Chosen<L: Lanes> {
    /// Which.
    pub index: L::U,
    /// The probability of that.
    pub probability: L::F,
    /// A number that the choice does not depend on.
    pub rest: L::F,
}

impl Lights {
    /// Sum of the estimates of what each light gives, for [`Lights::choose`] and [`Lights::chance`].
    #[inline(always)]
    pub fn total<L: Lanes>(&self, l: L, receivers: &Receivers<L>) -> L::F {
        // Between one there is no choice, and nothing to estimate.
        if self.lamps.len() > 1 { self.irradiance(l, receivers) } else { l.f(0.0) }
    }

    /// About the irradiance at receivers, were nothing in between.
    #[inline(always)]
    pub fn irradiance<L: Lanes>(&self, l: L, receivers: &Receivers<L>) -> L::F {
        let mut total = l.f(0.0);
        for index in &self.choice.asked {
            total = total + self.lamp(*index).estimate(l, receivers);
        }
        for group in &self.choice.groups {
            total = total + group.estimate(l, receivers);
        }
        total
    }

    /// Chooses lights: one in ten blindly, by the second of two numbers, the others in proportion to what they may give,
    /// by the first. What does not choose is left for further use.
    #[inline(always)]
    pub fn choose<L: Lanes>(
        &self,
        l: L,
        receivers: &Receivers<L>,
        total: L::F,
        [u, v]: [L::F; 2],
        wanted: L::M,
    ) -> Chosen<L> {
        let (zero, one) = (l.f(0.0), l.f(1.0));
        if self.lamps.len() == 1 {
            return Chosen { index: l.u(0), probability: one, rest: v };
        }
        let number = self.lamps.len() as f32;
        let guided = zero.lt(total);
        let blind = !guided | u.lt(l.f(UNIFORM));
        let blindly = (v * number).lesser(l.f(number - 1.0)).whole();
        let mut index = blindly;
        let rest = blind.pick(guided.pick(u * (1.0 / UNIFORM), u), v);
        // Of those that are not blind, the part of the number that is left.
        let mut left = (u - UNIFORM) * (1.0 / (1.0 - UNIFORM));
        let mut share = zero;
        let mut open = !blind;
        for &at in &self.choice.asked {
            let here = self.lamp(at).estimate(l, receivers) / total;
            let takes = open & left.lt(here);
            index = takes.pick_word(l.u(at), index);
            share = (takes | (blind & blindly.is(l.u(at)))).pick(here, share);
            left = left - here;
            open = open & !takes;
        }
        let (mut group, mut within) = (l.u(NO_GROUP), zero);
        for (at, tree) in (0..).zip(&self.choice.groups) {
            let here = tree.estimate(l, receivers) / total;
            let last = at as usize + 1 == self.choice.groups.len();
            let takes = if last { open } else { open & left.lt(here) };
            group = takes.pick_word(l.u(at), group);
            within = takes.pick(left / here, within);
            share = takes.pick(here, share);
            left = left - here;
            open = open & !takes;
        }
        if !self.choice.groups.is_empty() {
            for lane in wanted.lanes() {
                let receiver = receivers.lane(lane);
                if let Some(tree) = self.choice.groups.get(group.get(lane) as usize) {
                    let drawn = tree.choose(&self.lamps, &receiver, within.get(lane));
                    index.set(lane, drawn.lamp);
                    share.set(lane, share.get(lane) * drawn.probability);
                } else if let Some(tree) = self.choice.group(index.get(lane)) {
                    let among = tree.chance(&self.lamps, &receiver, index.get(lane));
                    share.set(lane, tree.estimate(One, &receiver) / total.get(lane) * among);
                }
            }
        } else if let Some(&last) = self.choice.asked.last() {
            // What rounding has left over.
            index = open.pick_word(l.u(last), index);
            share = open.pick(self.lamp(last).estimate(l, receivers) / total, share);
        }
        let probability = guided.pick(share * (1.0 - UNIFORM) + UNIFORM / number, l.f(1.0 / number));
        Chosen { index, probability, rest }
    }

    /// The probability with which a lamp is chosen.
    #[inline(always)]
    pub fn chance<L: Lanes>(&self, l: L, index: u32, receivers: &Receivers<L>, total: L::F) -> L::F {
        let uniform = 1.0 / self.lamps.len() as f32;
        if self.lamps.len() == 1 {
            return l.f(1.0);
        }
        let estimate = match self.choice.group(index) {
            Some(tree) => {
                let mut among = l.f(0.0);
                for lane in 0..L::N {
                    among.set(lane, tree.chance(&self.lamps, &receivers.lane(lane), index));
                }
                tree.estimate(l, receivers) * among
            }
            None => self.lamp(index).estimate(l, receivers),
        };
        let share = estimate / total * (1.0 - UNIFORM) + uniform * UNIFORM;
        l.f(0.0).lt(total).pick(share, l.f(uniform))
    }
}

impl Lamp {
    /// Where it is, if it is somewhere.
    fn place(&self, lamp: u32) -> Option<Place> {
        let (center, radius, strength) = match &self.kind {
            Kind::Point { position } | Kind::Spot { position, .. } => (*position, 0.0, self.strength),
            Kind::Sphere { center, radius, .. } => {
                (*center, *radius, self.strength * radius * radius * PI as f32)
            }
            Kind::Surface(surface) => {
                (surface.center, surface.extent_squared.sqrt(), self.strength * surface.area)
            }
            Kind::Sun { .. } | Kind::Sky | Kind::Panorama(_) => return None,
        };
        Some(Place { lamp, strength, center, radius })
    }

    /// About the irradiance at a receiver, were nothing in between. Only ratios matter, and they need not be
    /// right, but it is the same each time it is asked.
    #[inline(always)]
    pub(super) fn estimate<L: Lanes>(&self, l: L, receivers: &Receivers<L>) -> L::F {
        let strength = l.f(self.strength);
        let estimate = match &self.kind {
            Kind::Point { position } => {
                let to = V::splat(l, *position) - receivers.p;
                let squared = to.squared().greater(l.f(f32::MIN_POSITIVE));
                let w = to * (l.f(1.0) / squared.root());
                strength / squared * cosine_bound(l, receivers, w, l.f(0.0))
            }
            Kind::Sun { direction, sine_squared } => {
                let solid_angle = if *sine_squared > 0.0 { PI as f32 * sine_squared } else { 1.0 };
                strength
                    * solid_angle
                    * cosine_bound(l, receivers, V::splat(l, *direction), l.f(*sine_squared))
            }
            Kind::Spot { position, cone } => {
                let to = V::splat(l, *position) - receivers.p;
                let squared = to.squared().greater(l.f(f32::MIN_POSITIVE));
                let w = to * (l.f(1.0) / squared.root());
                strength * cone.share(l, -w) / squared * cosine_bound(l, receivers, w, l.f(0.0))
            }
            Kind::Sky | Kind::Panorama(_) => strength * PI as f32,
            Kind::Sphere { center, radius, .. } => {
                let to = V::splat(l, *center) - receivers.p;
                let squared = to.squared();
                let sine_squared = l.f(radius * radius) / squared;
                let w = to * (l.f(1.0) / squared.root());
                let bound = cosine_bound(l, receivers, w, sine_squared);
                sine_squared.lt(l.f(1.0)).pick(strength * sine_squared * bound * PI as f32, l.f(0.0))
            }
            Kind::Surface(surface) => {
                let squared = (V::splat(l, surface.center) - receivers.p).squared();
                strength * surface.area / squared.greater(l.f(surface.extent_squared))
            }
        };
        estimate.lesser(l.f(MOST_ESTIMATE))
    }
}

/// The greatest cosine to the normal of any direction in the cone about `w` of this half angle; 1 without normal.
#[inline(always)]
pub(super) fn cosine_bound<L: Lanes>(l: L, receivers: &Receivers<L>, w: V<L>, sine_squared: L::F) -> L::F {
    let one = l.f(1.0);
    let zero = l.f(0.0);
    let c = receivers.n.dot(w);
    let cosine = (one - sine_squared).greater(zero).root();
    let outside = (c * cosine + (one - c * c).greater(zero).root() * sine_squared.root()).greater(zero);
    (receivers.open | cosine.le(c)).pick(one, outside)
}
