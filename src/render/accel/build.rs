//! Building the hierarchy on all cores.
//!
//! Nodes are parted in two by the surface-area heuristic over binned centres (Ingo Wald, "On fast construction of
//! SAH-based bounding volume hierarchies", 2007), the largest part again, until there are eight. A leaf costs the same
//! for one ball as for eight; what is no ball is a child of its own.

use super::{ALONE, EMPTY, Item, LEAF, Leaf, Node, Tree, WIDE};
use crate::render::shape::{Face, place};
use rayon::prelude::*;

/// No node is deeper: below [`DEEPEST_AREA`] parts are halved by number, which takes ten levels for all slots that there
/// can be.
pub const DEEPEST: usize = DEEPEST_AREA + 11;
/// Below this depth areas do not count.
const DEEPEST_AREA: usize = 13;
const BINS: usize = 16;
/// So many surfaces are worth a thread.
const SHARED: usize = 4096;

/// A box: least and greatest coordinates.
#[derive(Clone, Copy)]
struct Extent {
    min: [f32; 3],
    max: [f32; 3],
}

/// What is known of items that lie together.
#[derive(Clone, Copy)]
struct Sum {
    /// Around all of them.
    all: Extent,
    /// Around their centres, in twice their coordinates.
    centers: Extent,
    balls: usize,
    /// What is no ball.
    alone: usize,
}

/// Items that lie together.
struct Group<'i> {
    items: &'i mut [Item],
    sum: Sum,
}

/// Nodes and leaves that refer to each other from 0 on.
#[derive(Default)]
struct Part {
    nodes: Vec<Node>,
    leaves: Vec<Leaf>,
}

/// What leaves are filled from: centre and radius of each ball.
#[derive(Clone, Copy)]
pub(super) struct Balls<'b> {
    pub rows: &'b [[f32; 4]],
    /// The slot of the first.
    pub first: u32,
}

pub(super) fn build(mut items: Vec<Item>, balls: Balls) -> Tree {
    let sum = items.iter().fold(Sum::NONE, |sum, item| sum.with(item));
    let root = Group { items: &mut items, sum };
    let part = tall(root, balls, 0);
    Tree { nodes: part.nodes, leaves: part.leaves }
}

/// A node over items, and all below it, by several threads if that is worth it.
fn tall(group: Group, balls: Balls, depth: usize) -> Part {
    if group.items.len() < SHARED {
        let mut part = Part::default();
        node(group, balls, depth, &mut part);
        return part;
    }
    let children = children(group, depth);
    let bounds = children.each_ref().map(|child| child.as_ref().map(|child| child.sum.all));
    let below = |child: Option<Group>| child.map(|child| tall(child, balls, depth + 1));
    let parts: Vec<Option<Part>> = children.into_par_iter().map(below).collect();
    join(bounds, parts)
}

/// Adds a node over items, and all below it.
fn node(group: Group, balls: Balls, depth: usize, part: &mut Part) {
    let children = children(group, depth);
    let at = part.nodes.len();
    part.nodes.push(Node::over(&children.each_ref().map(|child| child.as_ref().map(|child| child.sum.all))));
    for (number, child) in children.into_iter().enumerate() {
        let Some(child) = child else { continue };
        part.nodes[at].children[number] = if child.sum.children() > 1 {
            let below = part.nodes.len() as u32;
            node(child, balls, depth + 1, part);
            below
        } else if child.sum.alone == 1 {
            ALONE | child.items[0].slot
        } else {
            part.leaves.push(Leaf::of(child.items, balls));
            LEAF | (part.leaves.len() - 1) as u32
        };
    }
}

/// Puts parts below a new node.
fn join(bounds: [Option<Extent>; WIDE], parts: Vec<Option<Part>>) -> Part {
    let sizes = parts
        .iter()
        .flatten()
        .fold((1, 0), |(nodes, leaves), part| (nodes + part.nodes.len(), leaves + part.leaves.len()));
    let mut all = Part { nodes: Vec::with_capacity(sizes.0), leaves: Vec::with_capacity(sizes.1) };
    all.nodes.push(Node::over(&bounds));
    for (number, part) in parts.into_iter().enumerate() {
        let Some(part) = part else { continue };
        let (nodes, leaves) = (all.nodes.len() as u32, all.leaves.len() as u32);
        all.nodes[0].children[number] = nodes;
        all.nodes.extend(part.nodes.into_iter().map(|mut node| {
            for child in &mut node.children {
                *child += match *child & (LEAF | ALONE) {
                    LEAF => leaves,
                    ALONE => 0,
                    _ => nodes,
                };
            }
            node
        }));
        all.leaves.extend(part.leaves);
    }
    all
}

impl Node {
    /// One of boxes whose contents are not known yet.
    fn over(boxes: &[Option<Extent>; WIDE]) -> Node {
        let mut node = Node { bounds: [[[0.0; WIDE]; 2]; 3], children: [ALONE; WIDE] };
        for (number, extent) in boxes.iter().enumerate() {
            let extent = extent.unwrap_or(Extent::NONE);
            for axis in 0..3 {
                node.bounds[axis][0][number] = extent.min[axis];
                node.bounds[axis][1][number] = extent.max[axis];
            }
        }
        node
    }
}

impl Leaf {
    fn of(items: &mut [Item], balls: Balls) -> Leaf {
        items.sort_unstable_by_key(|item| item.slot);
        let mut leaf = Leaf { center: [[0.0; WIDE]; 3], radius: [f32::NAN; WIDE], places: [EMPTY; WIDE] };
        for (i, item) in items.iter().enumerate() {
            leaf.places[i] = place(item.slot, Face::Side);
            let [x, y, z, radius] = balls.rows[(item.slot - balls.first) as usize];
            leaf.radius[i] = radius;
            for (column, value) in leaf.center.iter_mut().zip([x, y, z]) {
                column[i] = value;
            }
        }
        leaf
    }
}

/// Parts items in up to eight groups, each with the number that says where it lies. First what is too much for one node,
/// the largest again and again; then what makes as many leaves as there is still room for, so that nodes are full.
fn children(group: Group, depth: usize) -> [Option<Group>; WIDE] {
    let middle = group.sum.all.double_center();
    let mut groups = vec![group];
    while let Some(next) = next_to_split(&groups, depth) {
        let (left, right) = split(groups.swap_remove(next), depth);
        groups.push(left);
        groups.push(right);
    }
    numbered(groups, middle)
}

/// Which of the groups under a node is best parted further.
fn next_to_split(groups: &[Group], depth: usize) -> Option<usize> {
    let children = |at: usize| groups[at].sum.children();
    let size = |at: usize| match depth < DEEPEST_AREA {
        true => groups[at].sum.all.half_area(),
        false => groups[at].items.len() as f32,
    };
    let large = (0..groups.len()).filter(|at| children(*at) > WIDE);
    let largest = large.max_by(|&a, &b| size(a).total_cmp(&size(b)));
    if groups.len() < WIDE && largest.is_some() {
        return largest;
    }
    let room = WIDE + 1 - groups.len();
    let fits = |at: &usize| children(*at) > 1 && (groups.len() == 1 || children(*at) <= room);
    (0..groups.len()).filter(fits).min_by_key(|at| children(*at))
}

/// Gives each group the number whose bits say best on which side of the middle it is: the one that is farthest out towards
/// a corner goes first.
fn numbered(groups: Vec<Group>, middle: [f32; 3]) -> [Option<Group>; WIDE] {
    let offset = |group: &Group| {
        let center = group.sum.all.double_center();
        [0, 1, 2].map(|axis| center[axis] - middle[axis])
    };
    let mut left: Vec<([f32; 3], Option<Group>)> =
        groups.into_iter().map(|group| (offset(&group), Some(group))).collect();
    let mut children = [const { None }; WIDE];
    for _ in 0..left.len() {
        let mut best = (f32::NEG_INFINITY, 0, 0);
        for (at, (offset, _)) in left.iter().enumerate().filter(|(_, (_, group))| group.is_some()) {
            for number in (0..WIDE).filter(|number| children[*number].is_none()) {
                let along = |axis: usize| if number >> axis & 1 == 1 { offset[axis] } else { -offset[axis] };
                let reach = along(0) + along(1) + along(2);
                if reach > best.0 {
                    best = (reach, at, number);
                }
            }
        }
        let (_, at, number) = best;
        children[number] = left[at].1.take();
    }
    children
}

/// Parts items in two by their centres along the longest axis.
fn split(group: Group, depth: usize) -> (Group, Group) {
    let Group { items, sum } = group;
    let low = sum.centers.min;
    let size = [0, 1, 2].map(|axis| sum.centers.max[axis] - low[axis]);
    let axis = (0..3).max_by(|&a, &b| size[a].total_cmp(&size[b])).unwrap_or(0);
    if depth >= DEEPEST_AREA || size[axis] <= 0.0 || !size[axis].is_finite() {
        return halve(items, axis);
    }
    // What is just at the end must not fall out of the last bin.
    let scale = BINS as f32 / size[axis];
    let bin = |item: &Item| (((item.double_center(axis) - low[axis]) * scale) as usize).min(BINS - 1);
    let mut bins = [Sum::NONE; BINS];
    for item in items.iter() {
        let bin = &mut bins[bin(item)];
        *bin = bin.with(item);
    }
    let Some((border, sums)) = best_border(&bins) else { return halve(items, axis) };
    let middle = partition(items, |item| bin(item) < border);
    let (left, right) = items.split_at_mut(middle);
    (Group { items: left, sum: sums[0] }, Group { items: right, sum: sums[1] })
}

/// The border between bins with the least sum of area times leaves, and what is below and above it; none if all is on one
/// side.
fn best_border(bins: &[Sum; BINS]) -> Option<(usize, [Sum; 2])> {
    let cost = |sum: &Sum| sum.all.half_area() * sum.children() as f32;
    let mut above = [Sum::NONE; BINS];
    let mut sum = Sum::NONE;
    for i in (1..BINS).rev() {
        sum = sum.and(&bins[i]);
        above[i] = sum;
    }
    let mut best = None;
    let mut least = f32::INFINITY;
    let mut below = Sum::NONE;
    for i in 1..BINS {
        below = below.and(&bins[i - 1]);
        if below.children() == 0 || above[i].children() == 0 {
            continue;
        }
        let cost = cost(&below) + cost(&above[i]);
        if cost < least {
            (least, best) = (cost, Some((i, [below, above[i]])));
        }
    }
    best
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

fn halve(items: &mut [Item], axis: usize) -> (Group<'_>, Group<'_>) {
    let middle = items.len() / 2;
    items.select_nth_unstable_by(middle, |a, b| {
        a.double_center(axis).total_cmp(&b.double_center(axis)).then(a.slot.cmp(&b.slot))
    });
    let (left, right) = items.split_at_mut(middle);
    let sum = |items: &[Item]| items.iter().fold(Sum::NONE, |sum, item| sum.with(item));
    let sums = [sum(left), sum(right)];
    (Group { items: left, sum: sums[0] }, Group { items: right, sum: sums[1] })
}

impl Item {
    #[inline(always)]
    fn double_center(&self, axis: usize) -> f32 {
        self.min[axis] + self.max[axis]
    }
}

impl Sum {
    const NONE: Sum = Sum { all: Extent::NONE, centers: Extent::NONE, balls: 0, alone: 0 };

    /// About how many children of a node they make.
    fn children(&self) -> usize {
        self.balls.div_ceil(WIDE) + self.alone
    }

    #[inline(always)]
    fn with(&self, item: &Item) -> Sum {
        let center = [item.double_center(0), item.double_center(1), item.double_center(2)];
        Sum {
            all: self.all.and(&Extent { min: item.min, max: item.max }),
            centers: self.centers.and(&Extent { min: center, max: center }),
            balls: self.balls + usize::from(!item.alone),
            alone: self.alone + usize::from(item.alone),
        }
    }

    #[inline(always)]
    fn and(&self, other: &Sum) -> Sum {
        Sum {
            all: self.all.and(&other.all),
            centers: self.centers.and(&other.centers),
            balls: self.balls + other.balls,
            alone: self.alone + other.alone,
        }
    }
}

impl Extent {
    /// Around nothing.
    const NONE: Extent = Extent { min: [f32::INFINITY; 3], max: [f32::NEG_INFINITY; 3] };

    #[inline(always)]
    fn and(&self, other: &Extent) -> Extent {
        // Plain comparisons are one instruction each; `f32::min` would also look for NaN.
        let lesser = |a: f32, b: f32| if a < b { a } else { b };
        let greater = |a: f32, b: f32| if a > b { a } else { b };
        let [a, b] = [self, other];
        Extent {
            min: [lesser(a.min[0], b.min[0]), lesser(a.min[1], b.min[1]), lesser(a.min[2], b.min[2])],
            max: [greater(a.max[0], b.max[0]), greater(a.max[1], b.max[1]), greater(a.max[2], b.max[2])],
        }
    }

    fn half_area(&self) -> f32 {
        let [x, y, z] = [0, 1, 2].map(|axis| (self.max[axis] - self.min[axis]).max(0.0));
        x * y + y * z + z * x
    }

    fn double_center(&self) -> [f32; 3] {
        [0, 1, 2].map(|axis| self.min[axis] + self.max[axis])
    }
}
