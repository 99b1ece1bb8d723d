//! Which of many lights, chosen by what each may give: trees whose nodes bound the lights below them.
//!
//! At every node one of the two children is chosen in proportion to about the irradiance that its lights together give at
//! the receiver, were they all in its middle: nothing only where all of them are below the horizon (Alejandro Conty Estevez and Christopher Kulla, "Importance sampling of many lights with adaptive
//! tree splitting", 2018, without cones of orientation). So the cost grows with the logarithm of their number, and none
//! that may give light is left out.

use super::choice::{MOST_ESTIMATE, cosine_bound};
use super::{Lamp, Receivers};
use crate::render::lanes::{Float, Lanes, Mask, One};
use crate::render::vector::V;

/// Where a lamp is, in the tracer's coordinates.
#[derive(Clone, Copy)]
pub(super) struct Place {
    /// Which of the lamps.
    pub lamp: u32,
    pub strength: f32,
    pub center: [f32; 3],
    /// No part of it is farther from the centre.
    pub radius: f32,
}

/// The tree. The first node is the root, and a left child comes right after its parent.
pub(super) struct LightTree {
    nodes: Vec<Node>,
    /// Each lamp below, in order, with its way from the root: right turns as bits, the first lowest.
    trails: Vec<(u32, u32)>,
}

/// What was chosen.
pub(super) struct Drawn {
    /// The lamp.
    pub lamp: u32,
    /// Its probability among those of the tree.
    pub probability: f32,
}

struct Node {
    /// Sum of the strengths.
    strength: f32,
    /// A ball around all.
    center: [f32; 3],
    radius_squared: f32,
    below: Below,
}

enum Below {
    Lamp(u32),
    /// The left child is the next node, the right one this.
    Children(u32),
}

impl LightTree {
    /// The tree over some lamps; at least one.
    pub fn new(mut places: Vec<Place>) -> LightTree {
        let mut tree = LightTree { nodes: Vec::with_capacity(2 * places.len()), trails: Vec::new() };
        tree.build(&mut places, 0, 0);
        tree.trails.sort_unstable();
        tree
    }

    /// Its lamps.
    pub fn lamps(&self) -> impl Iterator<Item = u32> {
        self.trails.iter().map(|(lamp, _)| *lamp)
    }

    /// Halves by number along the longest extent, so that no way is longer than the logarithm of their number.
    fn build(&mut self, places: &mut [Place], depth: u32, trail: u32) {
        let (low, size) = extent(places);
        let [x, y, z] = size;
        let at = self.nodes.len();
        self.nodes.push(Node {
            strength: places.iter().map(|place| place.strength).sum::<f32>().min(MOST_ESTIMATE),
            center: [0, 1, 2].map(|axis| low[axis] + 0.5 * size[axis]),
            radius_squared: 0.25 * (x * x + y * y + z * z),
            below: Below::Lamp(places[0].lamp),
        });
        if let [place] = places {
            self.trails.push((place.lamp, trail));
            self.nodes[at].center = place.center;
            self.nodes[at].radius_squared = place.radius * place.radius;
            return;
        }
        let (left, right) = halved(places, size);
        self.build(left, depth + 1, trail);
        self.nodes[at].below = Below::Children(self.nodes.len() as u32);
        self.build(right, depth + 1, trail | 1 << depth);
    }

    /// About what all of its lamps give together.
    #[inline(always)]
    pub fn estimate<L: Lanes>(&self, l: L, receivers: &Receivers<L>) -> L::F {
        self.nodes[0].estimate(l, receivers)
    }

    /// Chooses one of its lamps by a number.
    pub fn choose(&self, lamps: &[Lamp], receivers: &Receivers<One>, u: f32) -> Drawn {
        let mut u = if u > 0.0 { f64::from(u).min(LAST) } else { 0.0 };
        let mut probability = 1.0;
        let mut at = 0;
        loop {
            match self.nodes[at].below {
                Below::Lamp(lamp) => return Drawn { lamp, probability },
                Below::Children(right) => {
                    let left = self.left_share(lamps, receivers, at, right);
                    let share = f64::from(left);
                    if u < share {
                        (at, u, probability) = (at + 1, u / share, probability * left);
                    } else {
                        let rest = 1.0 - share;
                        (at, u, probability) =
                            (right as usize, (u - share) / rest, probability * (1.0 - left));
                    }
                    u = u.clamp(0.0, LAST);
                }
            }
        }
    }

    /// The probability with which one of its lamps is chosen among them; 0 for another lamp.
    pub fn chance(&self, lamps: &[Lamp], receivers: &Receivers<One>, lamp: u32) -> f32 {
        let Ok(at) = self.trails.binary_search_by_key(&lamp, |(lamp, _)| *lamp) else { return 0.0 };
        let mut trail = self.trails[at].1;
        let mut probability = 1.0;
        let mut at = 0;
        while let Below::Children(right) = self.nodes[at].below {
            let left = self.left_share(lamps, receivers, at, right);
            (at, probability) = if trail & 1 == 0 {
                (at + 1, probability * left)
            } else {
                (right as usize, probability * (1.0 - left))
            };
            trail >>= 1;
        }
        probability
    }

    /// The probability of the left child.
    fn left_share(&self, lamps: &[Lamp], receivers: &Receivers<One>, at: usize, right: u32) -> f32 {
        let gives = |node: &Node| match node.below {
            Below::Lamp(lamp) => lamps[lamp as usize].estimate(One, receivers),
            Below::Children(_) => node.estimate(One, receivers),
        };
        let (left, right) = (gives(&self.nodes[at + 1]), gives(&self.nodes[right as usize]));
        let sum = left + right;
        if sum > 0.0 { left / sum } else { 0.5 }
    }
}

/// Parts lamps into at most so many groups that lie together, none of them empty.
pub(super) fn grouped(places: Vec<Place>, most: usize) -> Vec<Vec<Place>> {
    // What a group does wrong to a vertex amidst it grows with its extent and its strength.
    let with_harm = |group: Vec<Place>| {
        let (_, [x, y, z]) = extent(&group);
        let strength: f32 = group.iter().map(|place| place.strength).sum();
        let harm = if group.len() > 1 { strength * (x * x + y * y + z * z) } else { -1.0 };
        (harm, group)
    };
    let mut groups = vec![with_harm(places)];
    while groups.len() < most {
        let worst = (0..groups.len()).max_by(|&a, &b| groups[a].0.total_cmp(&groups[b].0));
        let Some(worst) = worst.filter(|&worst| groups[worst].1.len() > 1) else { break };
        let (_, mut group) = groups.swap_remove(worst);
        let (_, size) = extent(&group);
        let middle = halved(&mut group, size).0.len();
        let other = group.split_off(middle);
        groups.extend([with_harm(group), with_harm(other)]);
    }
    groups.into_iter().map(|(_, group)| group).collect()
}

/// The least corner of the box around lamps, and its size.
fn extent(places: &[Place]) -> ([f32; 3], [f32; 3]) {
    let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for place in places {
        for axis in 0..3 {
            low[axis] = low[axis].min(place.center[axis] - place.radius);
            high[axis] = high[axis].max(place.center[axis] + place.radius);
        }
    }
    (low, [high[0] - low[0], high[1] - low[1], high[2] - low[2]])
}

/// Halves lamps by number along their longest extent.
fn halved(places: &mut [Place], size: [f32; 3]) -> (&mut [Place], &mut [Place]) {
    let axis = (0..3).max_by(|&a, &b| size[a].total_cmp(&size[b])).unwrap_or(0);
    let middle = places.len() / 2;
    places.select_nth_unstable_by(middle, |a, b| {
        a.center[axis].total_cmp(&b.center[axis]).then(a.lamp.cmp(&b.lamp))
    });
    places.split_at_mut(middle)
}

/// The greatest number below 1.
const LAST: f64 = 1.0 - f64::EPSILON;

impl Node {
    /// The irradiance if all its light came from the middle, or in the ball around it from the edge; 0 only where all of
    /// the ball is below the receiver's horizon.
    #[inline(always)]
    fn estimate<L: Lanes>(&self, l: L, receivers: &Receivers<L>) -> L::F {
        let to = V::splat(l, self.center) - receivers.p;
        let squared = to.squared();
        let near = squared.greater(l.f(self.radius_squared)).greater(l.f(f32::MIN_POSITIVE));
        let w = to * (l.f(1.0) / near.root());
        let bound = cosine_bound(l, receivers, w, l.f(self.radius_squared) / near);
        let inside = squared.le(l.f(self.radius_squared));
        (inside.pick(l.f(1.0), bound) * self.strength / near).lesser(l.f(MOST_ESTIMATE))
    }
}
