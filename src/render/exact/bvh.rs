//! A hierarchy of boxes over things that are told apart by an index.
//!
//! Built by the surface-area heuristic over binned centres (Ingo Wald, "On fast construction of SAH-based
//! bounding volume hierarchies", 2007).

use crate::math::DVec3;
use crate::scene::shape::Bounds;

/// The hierarchy.
#[derive(Default)]
pub struct Hierarchy {
    /// The first is the root; a left child comes right after its parent.
    nodes: Vec<Node>,
    /// Indices of things, such that each leaf's lie together.
    order: Vec<u32>,
}

struct Node {
    bounds: Bounds,
    /// Of a leaf the first place in `order`, else the right child.
    next: u32,
    /// Surfaces of a leaf; 0 marks an inner node.
    count: u32,
    /// Of an inner node: the axis along which the left child lies before the right one.
    axis: u8,
}

/// Things that a leaf may hold even if splitting it looks cheaper, and must not exceed if that looks dearer.
const LEAF: std::ops::RangeInclusive<usize> = 2..=16;
const BINS: usize = 16;
/// What stepping down one node costs in intersections.
const STEP_COST: f64 = 2.0;
/// Below this depth nodes are halved by number, which bounds the depth by 32 more.
const DEEPEST_SAH: usize = 32;
const STACK: usize = 72;

/// About what the hierarchy takes for each thing while it is built: about a node, its place in the order, and its box
/// among the items.
pub(in crate::render) const BYTES_A_THING: usize = size_of::<Node>() + size_of::<u32>() + size_of::<Item>();

impl Hierarchy {
    /// Builds it over things with finite boxes.
    pub fn new(things: Vec<(u32, Bounds)>) -> Hierarchy {
        let mut items: Vec<Item> =
            things.into_iter().map(|(id, bounds)| Item { id, bounds: padded(bounds) }).collect();
        let mut hierarchy = Hierarchy::default();
        if !items.is_empty() {
            hierarchy.build(&mut items, 0);
        }
        hierarchy
    }

    /// Shows everything that a ray may meet below a distance to `meet`, which returns how far still to look, or none
    /// to stop. The direction need not be of length 1; distances are in its lengths.
    #[inline]
    pub fn walk(
        &self,
        origin: DVec3,
        direction: DVec3,
        mut limit: f64,
        mut meet: impl FnMut(u32) -> Option<f64>,
    ) {
        if self.nodes.is_empty() {
            return;
        }
        let inverse = inverse(direction);
        let mut stack = [0u32; STACK];
        let mut waiting = 0;
        let mut at = 0;
        loop {
            let node = &self.nodes[at as usize];
            if meets(&node.bounds, origin, inverse, limit) {
                if node.count == 0 {
                    let (left, right) = (at + 1, node.next);
                    let forward = direction[usize::from(node.axis)] >= 0.0;
                    let (near, far) = if forward { (left, right) } else { (right, left) };
                    stack[waiting] = far;
                    waiting += 1;
                    at = near;
                    continue;
                }
                for &id in &self.order[node.next as usize..(node.next + node.count) as usize] {
                    let Some(nearer) = meet(id) else { return };
                    limit = nearer;
                }
            }
            if waiting == 0 {
                return;
            }
            waiting -= 1;
            at = stack[waiting];
        }
    }

    fn build(&mut self, items: &mut [Item], depth: usize) {
        let bounds = items.iter().fold(Bounds::EMPTY, |sum, item| sum.union(item.bounds));
        let at = self.nodes.len();
        self.nodes.push(Node { bounds, next: 0, count: 0, axis: 0 });
        let Some((middle, axis)) = split(items, bounds, depth) else {
            self.nodes[at].next = self.order.len() as u32;
            self.nodes[at].count = items.len() as u32;
            self.order.extend(items.iter().map(|item| item.id));
            return;
        };
        let (left, right) = items.split_at_mut(middle);
        self.nodes[at].axis = axis as u8;
        self.build(left, depth + 1);
        self.nodes[at].next = self.nodes.len() as u32;
        self.build(right, depth + 1);
    }
}

/// A thing while the hierarchy is built.
#[derive(Clone, Copy)]
struct Item {
    id: u32,
    bounds: Bounds,
}

/// Widens a box by what the arithmetic of the bounds may have rounded.
fn padded(bounds: Bounds) -> Bounds {
    let slack = 8.0 * f64::EPSILON * bounds.min.abs().max(bounds.max.abs());
    Bounds { min: bounds.min - slack, max: bounds.max + slack }
}

/// One over each component of a direction; a component of zero counts as one that is too small to matter, so that
/// no product of the slab test is 0 × ∞.
fn inverse(direction: DVec3) -> DVec3 {
    const LEAST: f64 = 1e-200;
    let invert = |d: f64| 1.0 / if d.abs() < LEAST { LEAST } else { d };
    DVec3::new(invert(direction.x), invert(direction.y), invert(direction.z))
}

/// Whether a ray meets a box at a distance between 0 and `limit`. The last factor covers the rounding of the slabs
/// (Thiago Ize, "Robust BVH ray traversal", JCGT 2013).
fn meets(bounds: &Bounds, origin: DVec3, inverse: DVec3, limit: f64) -> bool {
    // Plain comparisons are one instruction each; `f64::min` would also look for NaN.
    let lesser = |a: f64, b: f64| if a < b { a } else { b };
    let greater = |a: f64, b: f64| if a > b { a } else { b };
    let low = (bounds.min - origin) * inverse;
    let high = (bounds.max - origin) * inverse;
    let enter = greater(greater(lesser(low.x, high.x), lesser(low.y, high.y)), lesser(low.z, high.z));
    let leave = lesser(lesser(greater(low.x, high.x), greater(low.y, high.y)), greater(low.z, high.z));
    let leave = leave * (1.0 + 4.0 * f64::EPSILON);
    enter <= limit && enter <= leave && leave >= 0.0
}

/// Parts items in two by their centres along the longest axis; returns where and the axis, or none if a leaf is
/// better.
fn split(items: &mut [Item], bounds: Bounds, depth: usize) -> Option<(usize, usize)> {
    if items.len() < *LEAF.start() {
        return None;
    }
    let centers = items.iter().fold(Bounds::EMPTY, |sum, item| {
        let center = item.bounds.center();
        sum.union(Bounds { min: center, max: center })
    });
    let size = centers.size();
    let axis = if size.x >= size.y && size.x >= size.z {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    };
    if depth >= DEEPEST_SAH || size[axis] <= 0.0 {
        return (items.len() > *LEAF.end()).then(|| (halve(items, axis), axis));
    }
    let bin = |item: &Item| {
        let share = (item.bounds.center()[axis] - centers.min[axis]) / size[axis];
        ((share * BINS as f64) as usize).min(BINS - 1)
    };
    let (cost, border) = best_border(items, bin);
    let whole = bounds.half_area();
    let keep = items.len() as f64 * whole;
    if cost + STEP_COST * whole >= keep && items.len() <= *LEAF.end() {
        return None;
    }
    let middle = partition(items, |item| bin(item) < border);
    let middle = if middle == 0 || middle == items.len() { halve(items, axis) } else { middle };
    Some((middle, axis))
}

/// The border between bins with the least sum of area times number.
fn best_border(items: &[Item], bin: impl Fn(&Item) -> usize) -> (f64, usize) {
    let mut bins = [(Bounds::EMPTY, 0usize); BINS];
    for item in items {
        let entry = &mut bins[bin(item)];
        *entry = (entry.0.union(item.bounds), entry.1 + 1);
    }
    let cost = |bins: &[(Bounds, usize)]| {
        let (bounds, count) =
            bins.iter().fold((Bounds::EMPTY, 0), |sum, bin| (sum.0.union(bin.0), sum.1 + bin.1));
        if count == 0 { 0.0 } else { bounds.half_area() * count as f64 }
    };
    (1..BINS)
        .map(|border| (cost(&bins[..border]) + cost(&bins[border..]), border))
        .fold((f64::INFINITY, 1), |best, next| if next.0 < best.0 { next } else { best })
}

/// Moves the items that satisfy a condition to the front, in a fixed manner; returns how many.
fn partition(items: &mut [Item], front: impl Fn(&Item) -> bool) -> usize {
    let mut count = 0;
    for i in 0..items.len() {
        if front(&items[i]) {
            items.swap(i, count);
            count += 1;
        }
    }
    count
}

fn halve(items: &mut [Item], axis: usize) -> usize {
    let middle = items.len() / 2;
    items.select_nth_unstable_by(middle, |a, b| {
        a.bounds.center()[axis].total_cmp(&b.bounds.center()[axis]).then(a.id.cmp(&b.id))
    });
    middle
}
