//! The hierarchy over many surfaces: boxes with eight children each, tested eight at a time.
//!
//! A ray goes through it alone, in all lanes of a group at once. Boxes are widened by what may be rounded, so that
//! which surface is met first does not depend on the shape of the hierarchy.

mod build;

use super::lanes::{Float, Lanes, Mask, One, Word};
use super::shape::ball::{self, Ball};
use super::shape::{Face, Hits, Rays, place};
use super::space::Space;
use super::surfaces::Surfaces;
use super::vector::V;
use crate::scene::shape::Bounds;

/// Children of a node, and surfaces of a leaf.
const WIDE: usize = 8;
/// A child that is a leaf has this bit.
const LEAF: u32 = 1 << 31;
/// Nodes that wait: seven at each level.
const STACK: usize = 7 * build::DEEPEST + 8;

/// The hierarchy. The first node is the root.
pub struct Tree {
    nodes: Vec<Node>,
    leaves: Vec<Leaf>,
}

/// Eight boxes, and what is in them.
#[derive(Clone)]
struct Node {
    /// Least x, y, z; greatest x, y, z. A box that is not there is met by no ray.
    bounds: [[f32; WIDE]; 6],
    /// Index of a node, or with [`LEAF`] of a leaf.
    children: [u32; WIDE],
}

/// Up to eight surfaces: balls, side by side.
#[derive(Clone)]
struct Leaf {
    center: [[f32; WIDE]; 3],
    /// No number where there is no ball.
    radius: [f32; WIDE],
    slots: [u32; WIDE],
    /// How many balls there are, and how many surfaces.
    balls: u8,
    all: u8,
}

/// About what the hierarchy takes for each surface while it is built: about a node's and a leaf's share, and its box
/// among the items.
pub(super) const BYTES_A_SURFACE: usize =
    (size_of::<Node>() / WIDE + size_of::<Leaf>()) / 6 + size_of::<Item>();

/// A surface while the hierarchy is built.
#[derive(Clone, Copy)]
pub struct Item {
    /// Its slot.
    pub slot: u32,
    min: [f32; 3],
    max: [f32; 3],
}

impl Item {
    /// A surface within bounds, if they are ones in the tracer's coordinates.
    pub fn new(slot: u32, bounds: Bounds, space: &Space) -> Option<Item> {
        let (min, max) = (space.point(bounds.min), space.point(bounds.max));
        // What coordinates and roots may be wrong by.
        let slack = 4.0 * f64::from(f32::EPSILON) * min.abs().max(max.abs()).max_element();
        let (min, max) = (super::vector::single(min - slack), super::vector::single(max + slack));
        let item = Item { slot, min, max };
        min.iter().chain(&max).all(|v| v.is_finite()).then_some(item)
    }

    fn center(&self, axis: usize) -> f32 {
        0.5 * (self.min[axis] + self.max[axis])
    }
}

impl Tree {
    /// Builds the hierarchy over surfaces, of which there is at least one. Balls have the first slots, beginning with
    /// `first`.
    pub fn new(items: Vec<Item>, balls: &[Ball], first: u32) -> Tree {
        build::build(items, balls, first)
    }

    /// What a ray meets first below the distance of a hit, which it replaces; but for the surface in a slot.
    #[inline(always)]
    pub fn closest<G: Lanes>(
        &self,
        g: G,
        surfaces: &Surfaces,
        ray: &Rays<One>,
        hit: &mut Hits<One>,
        except: u32,
    ) {
        let lanes = Across::new(g, ray);
        let mut stack = [(0.0, 0); STACK];
        let mut waiting = 1;
        while waiting > 0 {
            waiting -= 1;
            let (enter, at) = stack[waiting];
            if enter > hit.t {
                continue;
            }
            if at & LEAF != 0 {
                self.leaves[(at & !LEAF) as usize].closest(g, surfaces, ray, &lanes, hit, except);
                continue;
            }
            let node = &self.nodes[at as usize];
            let mut enters = [0.0; WIDE];
            let first = waiting;
            for child in node.meet(g, &lanes, hit.t, &mut enters) {
                // The farthest stays lowest.
                let entry = (enters[child], node.children[child]);
                let mut place = waiting;
                while place > first && stack[place - 1].0 < entry.0 {
                    stack[place] = stack[place - 1];
                    place -= 1;
                }
                stack[place] = entry;
                waiting += 1;
            }
        }
    }

    /// Whether a ray meets anything below a distance, but for the surface in a slot.
    #[inline(always)]
    pub fn occluded<G: Lanes>(
        &self,
        g: G,
        surfaces: &Surfaces,
        ray: &Rays<One>,
        limit: f32,
        except: u32,
    ) -> bool {
        let lanes = Across::new(g, ray);
        let mut stack = [0; STACK];
        let mut waiting = 1;
        while waiting > 0 {
            waiting -= 1;
            let at = stack[waiting];
            if at & LEAF != 0 {
                if self.leaves[(at & !LEAF) as usize].occludes(g, surfaces, ray, &lanes, limit, except) {
                    return true;
                }
                continue;
            }
            let node = &self.nodes[at as usize];
            let mut enters = [0.0; WIDE];
            for child in node.meet(g, &lanes, limit, &mut enters) {
                stack[waiting] = node.children[child];
                waiting += 1;
            }
        }
        false
    }
}

/// A ray in every lane of a group.
struct Across<G: Lanes> {
    o: V<G>,
    d: V<G>,
    /// One over the direction.
    inverse: V<G>,
    start: G::U,
}

impl<G: Lanes> Across<G> {
    #[inline(always)]
    fn new(g: G, ray: &Rays<One>) -> Across<G> {
        let d = ray.d.get(0);
        let [x, y, z] = d;
        Across {
            o: V::splat(g, ray.o.get(0)),
            d: V::splat(g, d),
            inverse: V::splat(g, [inverse(x), inverse(y), inverse(z)]),
            start: g.u(ray.start.get(0)),
        }
    }
}

/// One over a component of a direction; one of zero counts as one that is too small to matter, so that no product of the
/// slab test is 0 × ∞.
fn inverse(d: f32) -> f32 {
    const LEAST: f32 = 1e-30;
    1.0 / if d.abs() < LEAST { LEAST.copysign(d) } else { d }
}

impl Node {
    /// The boxes that a ray meets at a distance between 0 and a limit, and where it enters them. The last factor covers
    /// the rounding of the slabs (Thiago Ize, "Robust BVH ray traversal", JCGT 2013).
    #[inline(always)]
    fn meet<G: Lanes>(
        &self,
        g: G,
        ray: &Across<G>,
        limit: f32,
        enters: &mut [f32; WIDE],
    ) -> super::lanes::Set {
        let mut met = 0;
        let mut from = 0;
        while from < WIDE {
            let [x0, y0, z0, x1, y1, z1] = &self.bounds;
            let (x0, x1) = (g.load(&x0[from..]) - ray.o.x, g.load(&x1[from..]) - ray.o.x);
            let (y0, y1) = (g.load(&y0[from..]) - ray.o.y, g.load(&y1[from..]) - ray.o.y);
            let (z0, z1) = (g.load(&z0[from..]) - ray.o.z, g.load(&z1[from..]) - ray.o.z);
            let (x0, x1) = (x0 * ray.inverse.x, x1 * ray.inverse.x);
            let (y0, y1) = (y0 * ray.inverse.y, y1 * ray.inverse.y);
            let (z0, z1) = (z0 * ray.inverse.z, z1 * ray.inverse.z);
            let enter = x0.lesser(x1).greater(y0.lesser(y1)).greater(z0.lesser(z1));
            let leave = x0.greater(x1).lesser(y0.greater(y1)).lesser(z0.greater(z1));
            let leave = leave * (1.0 + 4.0 * f32::EPSILON);
            let here = enter.le(g.f(limit)) & enter.le(leave) & g.f(0.0).le(leave);
            enter.store(&mut enters[from..]);
            met |= here.bits() << from;
            from += G::N;
        }
        super::lanes::Set(met)
    }
}

impl Leaf {
    /// Distances to the balls of a part of the leaf, not above 0 or no number where there is none.
    #[inline(always)]
    fn meet<G: Lanes>(&self, g: G, ray: &Across<G>, from: usize) -> G::F {
        let [x, y, z] = &self.center;
        let center = V::<G>::new(g.load(&x[from..]), g.load(&y[from..]), g.load(&z[from..]));
        let places = g.load_words(&self.slots[from..]) << super::shape::FACE_BITS;
        let radius = g.load(&self.radius[from..]);
        let on_it = places.is(ray.start) & radius.le(radius);
        let ratios = ball::meet(g, ray.o - center, ray.d, radius, on_it);
        ratios.over / ratios.under
    }

    #[inline(always)]
    fn closest<G: Lanes>(
        &self,
        g: G,
        surfaces: &Surfaces,
        ray: &Rays<One>,
        lanes: &Across<G>,
        hit: &mut Hits<One>,
        except: u32,
    ) {
        let mut from = 0;
        while from < WIDE {
            let t = self.meet(g, lanes, from);
            let ahead = g.f(0.0).lt(t) & t.le(g.f(hit.t)) & t.lt(g.f(f32::INFINITY));
            for lane in ahead.lanes() {
                let place = One.u(place(self.slots[from + lane], Face::Side));
                hit.take(Hits { t: t.get(lane), place, detail: One.u(0) }, except);
            }
            from += G::N;
        }
        for &slot in self.others() {
            hit.take(surfaces.meet_other(slot, ray), except);
        }
    }

    #[inline(always)]
    fn occludes<G: Lanes>(
        &self,
        g: G,
        surfaces: &Surfaces,
        ray: &Rays<One>,
        lanes: &Across<G>,
        limit: f32,
        except: u32,
    ) -> bool {
        let mut from = 0;
        while from < WIDE {
            let t = self.meet(g, lanes, from);
            let ahead = g.f(0.0).lt(t) & t.lt(g.f(limit));
            let counts = ahead & !g.load_words(&self.slots[from..]).is(g.u(except));
            if counts.any() {
                return true;
            }
            from += G::N;
        }
        let others = self.others().iter();
        others.filter(|slot| **slot != except).any(|&slot| surfaces.meet_other(slot, ray).t < limit)
    }

    /// The slots of what is no ball; they come last.
    #[inline(always)]
    fn others(&self) -> &[u32] {
        &self.slots[usize::from(self.balls)..usize::from(self.all)]
    }
}
