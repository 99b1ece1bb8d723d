//! The hierarchy over many surfaces: boxes with eight children each, tested eight at a time.
//!
//! A ray goes through it alone, in all lanes of a group at once, see [`walk`]. Boxes are widened by what may be rounded,
//! so that which surface is met first does not depend on the shape of the hierarchy.

mod build;
mod walk;

use super::lanes::{Float, Lanes, Word};
use super::shape::ball;
use super::shape::{Hits, NOWHERE, Rays};
use super::space::Space;
use super::surfaces::Surfaces;
use super::vector::V;
use crate::scene::shape::Bounds;
use walk::Walks;

/// Children of a node, and surfaces of a leaf.
const WIDE: usize = 8;
/// A child that is a leaf of balls has this bit.
const LEAF: u32 = 1 << 31;
/// A child that is a surface of another kind has this bit.
const ALONE: u32 = 1 << 30;
/// The place of no ball, on which no ray starts.
const EMPTY: u32 = NOWHERE - 1;

/// The hierarchy. The first node is the root.
pub struct Tree {
    nodes: Vec<Node>,
    leaves: Vec<Leaf>,
}

/// Eight boxes, and what is in them. Which lies where tells how to go through them without looking at distances: bit 0,
/// 1 and 2 of a child's number say on which side of the middle it is, as well as may be, along x, y and z.
#[derive(Clone)]
#[repr(align(32))]
struct Node {
    /// For each axis the lower ends, and the upper ends. A box that is not there ends before it begins.
    bounds: [[[f32; WIDE]; 2]; 3],
    /// Index of a node, with [`LEAF`] of a leaf, or with [`ALONE`] the slot of a surface.
    children: [u32; WIDE],
}

/// Up to eight balls, side by side.
#[derive(Clone)]
#[repr(align(32))]
struct Leaf {
    center: [[f32; WIDE]; 3],
    /// No number where there is no ball.
    radius: [f32; WIDE],
    /// The place of each, [`EMPTY`] where there is none.
    places: [u32; WIDE],
}

/// About what the hierarchy takes for each surface while it is built: about a node's and a leaf's share, and its box
/// among the items.
pub(super) const BYTES_A_SURFACE: usize =
    (size_of::<Node>() / WIDE + size_of::<Leaf>()) / 6 + size_of::<Item>();

/// A surface while the hierarchy is built.
#[derive(Clone, Copy)]
pub struct Item {
    slot: u32,
    /// Whether it is no ball: it gets a box of its own, since it is dear to test.
    alone: bool,
    min: [f32; 3],
    max: [f32; 3],
}

impl Item {
    /// A surface within bounds, if they are ones in the tracer's coordinates.
    pub fn new(slot: u32, alone: bool, bounds: Bounds, space: &Space) -> Option<Item> {
        let (min, max) = (space.point(bounds.min), space.point(bounds.max));
        // What coordinates and roots may be wrong by.
        let slack = 4.0 * f64::from(f32::EPSILON) * min.abs().max(max.abs()).max_element();
        let (min, max) = (super::vector::single(min - slack), super::vector::single(max + slack));
        let item = Item { slot, alone, min, max };
        min.iter().chain(&max).all(|v| v.is_finite()).then_some(item)
    }
}

impl Tree {
    /// Builds the hierarchy over surfaces, of which there is at least one. Balls, of which centres and radii are given, have
    /// the first slots, beginning with `first`.
    pub fn new(items: Vec<Item>, balls: &[[f32; 4]], first: u32) -> Tree {
        build::build(items, build::Balls { rows: balls, first })
    }

    /// How much memory it takes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..]) + size_of_val(&self.leaves[..])
    }

    /// What the rays of a mask meet first below the distances of hits, which it replaces; but for the surface in a slot of
    /// each lane's own.
    #[inline(always)]
    pub fn closest<L: Lanes>(
        &self,
        l: L,
        surfaces: &Surfaces,
        rays: &Rays<L>,
        hits: Hits<L>,
        except: L::U,
        wanted: L::M,
    ) -> Hits<L> {
        let mut walks = Walks::new(rays, hits, except);
        walks.run::<L, false>(l, self, surfaces, wanted);
        walks.hits(l)
    }

    /// Whether the rays of a mask meet anything below a distance, but for the surface in a slot of each lane's own.
    #[inline(always)]
    pub fn occluded<L: Lanes>(
        &self,
        l: L,
        surfaces: &Surfaces,
        rays: &Rays<L>,
        limit: L::F,
        except: L::U,
        wanted: L::M,
    ) -> L::M {
        // What is as far as the limit does not count: no place comes before the first.
        let mut walks = Walks::new(rays, Hits { t: limit, place: l.u(0), detail: l.u(0) }, except);
        let found = walks.run::<L, true>(l, self, surfaces, wanted);
        l.mask(found)
    }
}

/// What tests of boxes and balls need of a ray.
#[derive(Clone, Copy)]
struct Line {
    o: [f32; 3],
    d: [f32; 3],
    /// One over the direction.
    inverse: [f32; 3],
    /// The place that it starts on.
    start: u32,
    /// Bit 0, 1 and 2: whether it goes down along x, y and z.
    down: u32,
}

impl Line {
    #[inline(always)]
    fn new(o: [f32; 3], d: [f32; 3], start: u32) -> Line {
        let [x, y, z] = d;
        let down = x.to_bits() >> 31 | y.to_bits() >> 31 << 1 | z.to_bits() >> 31 << 2;
        Line { o, d, inverse: [inverse(x), inverse(y), inverse(z)], start, down }
    }
}

/// One over a component of a direction; one of zero counts as one that is too small to matter, so that no product of the
/// slab test is 0 × ∞.
#[inline(always)]
fn inverse(d: f32) -> f32 {
    const LEAST: f32 = 1e-30;
    1.0 / if d.abs() < LEAST { LEAST.copysign(d) } else { d }
}

impl Node {
    /// Writes the boxes that a line meets at a distance between 0 and a limit, the farther ones first, and where it enters
    /// them; returns how many. A factor covers the rounding of the slabs (Thiago Ize, "Robust BVH ray traversal", JCGT
    /// 2013).
    #[inline(always)]
    fn open<G: Lanes>(
        &self,
        g: G,
        line: &Line,
        limit: f32,
        enters: &mut [f32; WIDE],
        nodes: &mut [u32; WIDE],
    ) -> usize {
        let mut count = 0;
        let inverse = V::<G>::splat(g, line.inverse);
        let o = V::<G>::splat(g, line.o);
        let end = |axis: usize| (line.down >> axis & 1) as usize;
        let (x, y, z) = (end(0), end(1), end(2));
        let mut part = 0;
        while part < WIDE {
            let from = (WIDE - G::N - part) ^ (line.down as usize & (WIDE - G::N));
            let bound = |axis: usize, end: usize| g.load(&self.bounds[axis][end & 1][from..]);
            let x0 = (bound(0, x) - o.x) * inverse.x;
            let y0 = (bound(1, y) - o.y) * inverse.y;
            let z0 = (bound(2, z) - o.z) * inverse.z;
            let x1 = (bound(0, x ^ 1) - o.x) * inverse.x;
            let y1 = (bound(1, y ^ 1) - o.y) * inverse.y;
            let z1 = (bound(2, z ^ 1) - o.z) * inverse.z;
            let enter = x0.most(y0).most(z0).most(g.f(0.0));
            let leave = x1.least(y1).least(z1) * (1.0 + 4.0 * f32::EPSILON);
            let leave = leave.least(g.f(limit));
            let children = g.load_words(&self.children[from..]);
            let (enters, nodes) = (&mut enters[count..], &mut nodes[count..]);
            count += g.sift([enter, leave], children, line.down, (enters, nodes));
            part += G::N;
        }
        count
    }
}

impl Leaf {
    /// Distances to the balls of a part of the leaf, not above 0 or no number where there is none.
    #[inline(always)]
    fn meet<G: Lanes>(&self, g: G, line: &Line, from: usize) -> G::F {
        let [x, y, z] = &self.center;
        let center = V::<G>::new(g.load(&x[from..]), g.load(&y[from..]), g.load(&z[from..]));
        let radius = g.load(&self.radius[from..]);
        let on_it = g.load_words(&self.places[from..]).is(g.u(line.start));
        let (o, d) = (V::splat(g, line.o), V::splat(g, line.d));
        let ratios = ball::meet(g, o - center, d, radius, on_it);
        ratios.over / ratios.under
    }
}
