//! Building the hierarchy on all cores.
//!
//! Nodes are parted in two by the surface-area heuristic over binned centres (Ingo Wald, "On fast construction of
//! SAH-based bounding volume hierarchies", 2007), the largest part again, until there are eight. A leaf costs the same
//! for one surface as for eight.

use super::{Ball, Item, LEAF, Leaf, Node, Tree, WIDE};

/// No node is deeper: below half of it parts are halved by number.
pub const DEEPEST: usize = 48;
const BINS: usize = 16;
/// So many surfaces are worth a thread.
const SHARED: usize = 4096;

/// Nodes and leaves that refer to each other from 0 on.
#[derive(Default)]
struct Part {
    nodes: Vec<Node>,
    leaves: Vec<Leaf>,
}

pub(super) fn build(mut items: Vec<Item>, balls: &[Ball], first: u32) -> Tree {
    let part = node(&mut items, balls, first, 0);
    Tree { nodes: part.nodes, leaves: part.leaves }
}

/// A node over items, and all below it.
fn node(items: &mut [Item], balls: &[Ball], first: u32, depth: usize) -> Part {
    let many = items.len() >= SHARED;
    let groups = split_in_eight(items, depth);
    let below = |group: &mut [Item]| {
        if group.len() <= WIDE { leaf(group, balls, first) } else { node(group, balls, first, depth + 1) }
    };
    let bounds: Vec<([f32; 3], [f32; 3])> = groups.iter().map(|group| bounds(group)).collect();
    let parts: Vec<Part> = if many {
        use rayon::prelude::*;
        groups.into_par_iter().map(below).collect()
    } else {
        groups.into_iter().map(below).collect()
    };
    join(&bounds, parts)
}

/// Puts parts below a new node.
fn join(bounds: &[([f32; 3], [f32; 3])], parts: Vec<Part>) -> Part {
    let nothing = [
        f32::INFINITY,
        f32::INFINITY,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::NEG_INFINITY,
        f32::NEG_INFINITY,
    ];
    let mut root = Node { bounds: nothing.map(|v| [v; WIDE]), children: [LEAF; WIDE] };
    let mut all = Part::default();
    all.nodes.push(root.clone());
    for (child, (part, (min, max))) in parts.into_iter().zip(bounds).enumerate() {
        for axis in 0..3 {
            root.bounds[axis][child] = min[axis];
            root.bounds[3 + axis][child] = max[axis];
        }
        let (nodes, leaves) = (all.nodes.len() as u32, all.leaves.len() as u32);
        root.children[child] = if part.nodes.is_empty() { LEAF | leaves } else { nodes };
        all.nodes.extend(part.nodes.into_iter().map(|mut node| {
            for child in &mut node.children {
                *child += if *child & LEAF == 0 { nodes } else { leaves };
            }
            node
        }));
        all.leaves.extend(part.leaves);
    }
    all.nodes[0] = root;
    all
}

fn leaf(items: &mut [Item], balls: &[Ball], first: u32) -> Part {
    items.sort_unstable_by_key(|item| item.slot);
    let mut leaf = Leaf {
        center: [[0.0; WIDE]; 3],
        radius: [f32::NAN; WIDE],
        slots: [u32::MAX; WIDE],
        balls: 0,
        all: items.len() as u8,
    };
    for (i, item) in items.iter().enumerate() {
        leaf.slots[i] = item.slot;
        if let Some(ball) = balls.get((item.slot - first) as usize) {
            leaf.balls += 1;
            leaf.radius[i] = ball.radius;
            for axis in 0..3 {
                leaf.center[axis][i] = ball.center[axis];
            }
        }
    }
    Part { nodes: Vec::new(), leaves: vec![leaf] }
}

/// Parts items in up to eight groups, the costliest again and again.
fn split_in_eight(items: &mut [Item], depth: usize) -> Vec<&mut [Item]> {
    let mut groups = vec![items];
    while groups.len() < WIDE {
        let cost = |group: &[Item]| if group.len() > WIDE { half_area(bounds(group)) } else { -1.0 };
        let costs: Vec<f32> = groups.iter().map(|group| cost(group)).collect();
        let Some(worst) = (0..groups.len()).max_by(|&a, &b| costs[a].total_cmp(&costs[b])) else { break };
        if costs[worst] < 0.0 {
            break;
        }
        let group = groups.swap_remove(worst);
        let middle = split(group, depth);
        let (left, right) = group.split_at_mut(middle);
        groups.push(left);
        groups.push(right);
    }
    groups
}

fn bounds(items: &[Item]) -> ([f32; 3], [f32; 3]) {
    let mut sum = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for item in items {
        for axis in 0..3 {
            sum.0[axis] = sum.0[axis].min(item.min[axis]);
            sum.1[axis] = sum.1[axis].max(item.max[axis]);
        }
    }
    sum
}

fn half_area((min, max): ([f32; 3], [f32; 3])) -> f32 {
    let [x, y, z] = [0, 1, 2].map(|axis| (max[axis] - min[axis]).max(0.0));
    x * y + y * z + z * x
}

/// Parts items in two by their centres along the longest axis; returns where.
fn split(items: &mut [Item], depth: usize) -> usize {
    let mut low = [f32::INFINITY; 3];
    let mut high = [f32::NEG_INFINITY; 3];
    for item in items.iter() {
        for axis in 0..3 {
            low[axis] = low[axis].min(item.center(axis));
            high[axis] = high[axis].max(item.center(axis));
        }
    }
    let size = [0, 1, 2].map(|axis| high[axis] - low[axis]);
    let axis = (0..3).max_by(|&a, &b| size[a].total_cmp(&size[b])).unwrap_or(0);
    if depth >= DEEPEST / 2 || size[axis] <= 0.0 || !size[axis].is_finite() {
        return halve(items, axis);
    }
    let scale = BINS as f32 / size[axis];
    let bin = |item: &Item| (((item.center(axis) - low[axis]) * scale) as usize).min(BINS - 1);
    let border = best_border(items, bin);
    let middle = partition(items, |item| bin(item) < border);
    if middle == 0 || middle == items.len() { halve(items, axis) } else { middle }
}

/// The border between bins with the least sum of area times leaves.
fn best_border(items: &[Item], bin: impl Fn(&Item) -> usize) -> usize {
    let empty = (([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]), 0usize);
    let mut bins = [empty; BINS];
    for item in items {
        let entry = &mut bins[bin(item)];
        *entry = add(*entry, ((item.min, item.max), 1));
    }
    let cost =
        |(bounds, count): (([f32; 3], [f32; 3]), usize)| half_area(bounds) * count.div_ceil(WIDE) as f32;
    let mut above = [0.0; BINS];
    let mut sum = empty;
    for i in (1..BINS).rev() {
        sum = add(sum, bins[i]);
        above[i] = if sum.1 == 0 { 0.0 } else { cost(sum) };
    }
    let mut best = (f32::INFINITY, 1);
    let mut sum = empty;
    for i in 1..BINS {
        sum = add(sum, bins[i - 1]);
        let below = if sum.1 == 0 { 0.0 } else { cost(sum) };
        if below + above[i] < best.0 {
            best = (below + above[i], i);
        }
    }
    best.1
}

type Box3 = ([f32; 3], [f32; 3]);

fn add((a, m): (Box3, usize), (b, n): (Box3, usize)) -> (Box3, usize) {
    let min = [0, 1, 2].map(|axis| a.0[axis].min(b.0[axis]));
    let max = [0, 1, 2].map(|axis| a.1[axis].max(b.1[axis]));
    ((min, max), m + n)
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
        a.center(axis).total_cmp(&b.center(axis)).then(a.slot.cmp(&b.slot))
    });
    middle
}
