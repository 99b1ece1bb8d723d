//! Finds what a ray meets first: a hierarchy of boxes over what has bounds, a list of what has none.
//!
//! Built by the surface-area heuristic over binned centres (Ingo Wald, "On fast construction of SAH-based
//! bounding volume hierarchies", 2007). Two surfaces at equal distance are told apart by their index, so the
//! answer does not depend on the shape of the hierarchy.

use super::shape::{Place, Ray, intersect};
use crate::math::DVec3;
use crate::scene::shape::Bounds;
use crate::scene::{Primitive, PrimitiveId};

/// The hierarchy, over borrowed surfaces.
pub struct Accel<'s> {
    primitives: &'s [Primitive],
    /// The first is the root; a left child comes right after its parent.
    nodes: Vec<Node>,
    /// Indices of surfaces, such that each leaf's lie together.
    order: Vec<u32>,
    /// Those asked for every ray: without end, or so large that a box around them would be met by most rays.
    always: Vec<u32>,
}

/// Where a ray meets something.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    /// Distance along the ray, above 0.
    pub t: f64,
    /// What it meets.
    pub place: Place,
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

/// Surfaces that a leaf may hold even if splitting it looks cheaper, and must not exceed if that looks dearer.
const LEAF: std::ops::RangeInclusive<usize> = 2..=16;
/// So few surfaces are asked one by one.
const FEW: usize = 8;
/// A box that has this share of the area of the box around everything is met by about that share of rays.
const LARGE: f64 = 0.2;
const BINS: usize = 16;
/// What stepping down one node costs in intersections.
const STEP_COST: f64 = 2.0;
/// Below this depth nodes are halved by number, which bounds the depth by 32 more.
const DEEPEST_SAH: usize = 32;
const STACK: usize = 72;

/// About what the hierarchy takes for each surface while it is built: about a node, its place in the order, and its
/// box among the items.
pub(super) const BYTES_A_SURFACE: usize = size_of::<Node>() + size_of::<u32>() + size_of::<Item>();

impl<'s> Accel<'s> {
    /// Builds the hierarchy.
    pub fn new(primitives: &'s [Primitive]) -> Accel<'s> {
        let mut items = Vec::new();
        let mut always = Vec::new();
        for (id, primitive) in (0..).zip(primitives) {
            match primitive.shape.bounds() {
                Some(bounds) if bounds.min.is_finite() && bounds.max.is_finite() => {
                    items.push(Item { id, bounds: padded(bounds) });
                }
                _ => always.push(id),
            }
        }
        let whole = items.iter().fold(Bounds::EMPTY, |sum, item| sum.union(item.bounds));
        let few = items.len() <= FEW;
        items.retain(|item: &Item| {
            let large = few || item.bounds.half_area() >= LARGE * whole.half_area();
            if large {
                always.push(item.id);
            }
            !large
        });
        always.sort_unstable();
        let mut accel = Accel { primitives, nodes: Vec::new(), order: Vec::new(), always };
        if !items.is_empty() {
            accel.build(&mut items, 0);
        }
        accel
    }

    /// What the ray meets first.
    pub fn closest(&self, ray: &Ray) -> Option<Hit> {
        self.closest_but(ray, f64::INFINITY, None)
    }

    /// What the ray meets first below a distance, were it not for one surface.
    pub fn closest_but(&self, ray: &Ray, distance: f64, except: Option<PrimitiveId>) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        let mut limit = distance;
        self.visit(ray, distance, except, |hit| {
            let nearer = match best {
                None => hit.t < limit,
                Some(last) => hit.t < last.t || hit.t == last.t && hit.place.primitive < last.place.primitive,
            };
            if nearer {
                limit = hit.t;
                best = Some(hit);
            }
            Some(limit)
        });
        best
    }

    /// Whether the ray meets anything below a distance, but for one surface.
    pub fn occluded(&self, ray: &Ray, distance: f64, except: Option<PrimitiveId>) -> bool {
        let mut found = false;
        self.visit(ray, distance, except, |hit| {
            found = hit.t < distance;
            (!found).then_some(distance)
        });
        found
    }

    /// Shows every surface that the ray may meet to `meet`, which returns how far still to look, or none to stop.
    fn visit(
        &self,
        ray: &Ray,
        mut limit: f64,
        except: Option<PrimitiveId>,
        mut meet: impl FnMut(Hit) -> Option<f64>,
    ) {
        let mut test = |id: u32| -> Option<Option<f64>> {
            let primitive = PrimitiveId(id);
            if except == Some(primitive) {
                return None;
            }
            let start = ray.start.filter(|start| start.primitive == primitive).map(|start| start.face);
            let (t, face) = intersect(&self.primitives[id as usize].shape, ray, start)?;
            Some(meet(Hit { t, place: Place { primitive, face } }))
        };
        for &id in &self.always {
            if let Some(answer) = test(id) {
                let Some(nearer) = answer else { return };
                limit = nearer;
            }
        }
        if self.nodes.is_empty() {
            return;
        }
        let inverse = inverse(ray.direction);
        let mut stack = [0u32; STACK];
        let mut waiting = 0;
        let mut at = 0;
        loop {
            let node = &self.nodes[at as usize];
            if meets(&node.bounds, ray.origin, inverse, limit) {
                if node.count == 0 {
                    let (left, right) = (at + 1, node.next);
                    let forward = ray.direction[usize::from(node.axis)] >= 0.0;
                    let (near, far) = if forward { (left, right) } else { (right, left) };
                    stack[waiting] = far;
                    waiting += 1;
                    at = near;
                    continue;
                }
                for &id in &self.order[node.next as usize..(node.next + node.count) as usize] {
                    if let Some(answer) = test(id) {
                        let Some(nearer) = answer else { return };
                        limit = nearer;
                    }
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

/// A surface while the hierarchy is built.
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
