//! Glass: solids that partly overlap, W0605, and surfaces without an inside, W0607.

use super::{Lint, MOST_PAIRS, errors, faces};
use crate::diagnostic::Code;
use crate::math::DVec3;
use crate::scene::boxes::Boxes;
use crate::scene::nesting::lies_in;
use crate::scene::shape::Bounds;
use crate::scene::{Material, Primitive, Shape};
use std::ops::ControlFlow;

/// How far, as a share of a solid's size, a witness must lie in or out of the other, so that solids that touch do not
/// count as overlapping.
const DEPTH: f64 = 1e-6;

pub(super) fn look(lint: &mut Lint) {
    let glass: Vec<&Primitive> = lint
        .scene
        .primitives
        .iter()
        .filter(|primitive| matches!(lint.material(primitive), Material::Dielectric { .. }))
        .collect();
    open(lint, &glass);
    let solids: Vec<&Primitive> = glass.into_iter().filter(|primitive| primitive.shape.is_closed()).collect();
    overlaps(lint, &solids);
}

/// W0607: a dielectric surface that bounds no solid, such as a disk or an open tower. Exact.
fn open(lint: &mut Lint, glass: &[&Primitive]) {
    for primitive in glass.iter().filter(|primitive| !primitive.shape.is_closed()) {
        if lint.is_new(Code::W0607, primitive.origin) {
            let diagnostic = errors::no_inside(lint, primitive.origin);
            lint.report(diagnostic);
        }
    }
}

/// W0605: two dielectric solids overlap, and neither lies in the other. Of two spheres this is decided exactly. Of
/// others it is said when the surface of one has points well inside and well outside of the other, among those that
/// [`faces::points`] gives; an overlap that lies between these points is missed.
fn overlaps(lint: &mut Lint, solids: &[&Primitive]) {
    let everywhere = Bounds { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY };
    let bounds = |i: usize| solids[i].shape.bounds();
    let bounded = (0..solids.len()).filter_map(|i| Some((bounds(i)?, i as u32))).collect();
    let boxes = Boxes::new(bounded);
    let mut pairs = 0;
    let mut found = vec![];
    for (i, solid) in solids.iter().enumerate() {
        if pairs >= MOST_PAIRS {
            break;
        }
        boxes.meeting(bounds(i).unwrap_or(everywhere), |j| {
            let j = j as usize;
            // A pair with bounds is met from both sides, one of which is enough.
            if j == i || j > i && bounds(i).is_some() {
                return ControlFlow::Continue(());
            }
            pairs += 1;
            if partly_overlap(&solid.shape, &solids[j].shape) {
                found.push((i.max(j), i.min(j)));
                return ControlFlow::Break(());
            }
            if pairs < MOST_PAIRS { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        });
    }
    for (later, earlier) in found {
        let (later, earlier) = (solids[later].origin, solids[earlier].origin);
        if lint.is_new(Code::W0605, later) {
            let diagnostic = errors::overlap(lint, later, earlier);
            lint.report(diagnostic);
        }
    }
}

fn partly_overlap(a: &Shape, b: &Shape) -> bool {
    if lies_in(a, b) || lies_in(b, a) {
        return false;
    }
    if let (Shape::Sphere { center: p, radius: r }, Shape::Sphere { center: q, radius: s }) = (a, b) {
        return p.distance(*q) < (r + s) * (1.0 - DEPTH);
    }
    crosses(a, b) || crosses(b, a)
}

/// Whether the surface of `a` is seen to run both inside and outside of `b`.
fn crosses(a: &Shape, b: &Shape) -> bool {
    let Some(bounds) = a.bounds() else { return false };
    let step = DEPTH * bounds.size().length();
    let around = |p: DVec3| {
        [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z]
            .into_iter()
            .filter(|direction| b.contains(p + step * *direction))
            .count()
    };
    let mut inside = false;
    let mut outside = false;
    for p in faces::points(a) {
        match around(p) {
            0 => outside |= !b.contains(p),
            6 => inside |= b.contains(p),
            _ => {}
        }
        if inside && outside {
            return true;
        }
    }
    false
}
