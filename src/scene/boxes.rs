//! Which boxes meet: a hierarchy that halves the boxes along their longest extent.

use super::shape::Bounds;
use std::ops::{ControlFlow, Range};

/// Boxes in a leaf.
const LEAF: usize = 8;

/// Boxes, each with a number that its owner knows it by.
pub struct Boxes {
    items: Vec<(Bounds, u32)>,
    nodes: Vec<Node>,
}

struct Node {
    bounds: Bounds,
    /// Of the items below it.
    items: Range<usize>,
    /// The second of its children; the first is the next node. None in a leaf.
    second: Option<usize>,
}

impl Boxes {
    /// Builds the hierarchy.
    pub fn new(items: Vec<(Bounds, u32)>) -> Boxes {
        let mut boxes = Boxes { nodes: vec![], items };
        if !boxes.items.is_empty() {
            boxes.build(0..boxes.items.len());
        }
        boxes
    }

    /// Every box is halved by count, so the depth is the logarithm of their number.
    fn build(&mut self, range: Range<usize>) {
        let items = &mut self.items[range.clone()];
        let bounds = items.iter().fold(Bounds::EMPTY, |all, (bounds, _)| all.union(*bounds));
        let node = self.nodes.len();
        self.nodes.push(Node { bounds, items: range.clone(), second: None });
        if range.len() <= LEAF {
            return;
        }
        let size = bounds.size();
        let axis = if size.x >= size.y.max(size.z) { 0 } else { 1 + usize::from(size.z > size.y) };
        let middle = items.len() / 2;
        items.select_nth_unstable_by(middle, |(a, i), (b, j)| {
            let place = |bounds: &Bounds| bounds.min[axis] + bounds.max[axis];
            place(a).total_cmp(&place(b)).then(i.cmp(j))
        });
        self.build(range.start..range.start + middle);
        self.nodes[node].second = Some(self.nodes.len());
        self.build(range.start + middle..range.end);
    }

    /// Visits the number of each box that meets this one, until the visitor breaks.
    pub fn meeting(&self, wanted: Bounds, mut visit: impl FnMut(u32) -> ControlFlow<()>) {
        let mut waiting = if self.nodes.is_empty() { vec![] } else { vec![0] };
        while let Some(index) = waiting.pop() {
            let node = &self.nodes[index];
            if !meet(node.bounds, wanted) {
                continue;
            }
            if let Some(second) = node.second {
                waiting.extend([second, index + 1]);
                continue;
            }
            for (bounds, number) in &self.items[node.items.clone()] {
                if meet(*bounds, wanted) && visit(*number).is_break() {
                    return;
                }
            }
        }
    }
}

/// Whether two boxes have a point in common.
fn meet(a: Bounds, b: Bounds) -> bool {
    a.min.cmple(b.max).all() && b.min.cmple(a.max).all()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::DVec3;

    #[test]
    fn finds_the_pairs_that_brute_force_finds() {
        let boxes: Vec<(Bounds, u32)> = (0..300u32)
            .map(|i| {
                let part = |k: f64| (f64::from(i) * k) % 1.0;
                let center = 10.0 * DVec3::new(part(0.819_172_5), part(0.671_043_6), part(0.549_700_5));
                let half = DVec3::splat(0.1 + part(0.377));
                (Bounds { min: center - half, max: center + half }, i)
            })
            .collect();
        let hierarchy = Boxes::new(boxes.clone());
        let mut pairs = 0;
        for (bounds, _) in &boxes {
            let mut found = vec![];
            hierarchy.meeting(*bounds, |number| {
                found.push(number);
                ControlFlow::Continue(())
            });
            found.sort_unstable();
            let wanted: Vec<u32> =
                boxes.iter().filter(|(other, _)| meet(*other, *bounds)).map(|(_, i)| *i).collect();
            assert_eq!(found, wanted);
            pairs += found.len();
        }
        assert!(pairs > 400, "{pairs}");
        Boxes::new(vec![]).meeting(boxes[0].0, |_| unreachable!("there is no box"));
    }
}
