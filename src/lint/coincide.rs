//! Surfaces in the same place: W0606.
//!
//! Two ways to coincide are looked for. Curved surfaces coincide when they are one and the same, such as two equal
//! spheres; flat parts when they lie in one plane and overlap. Where two flat parts of opaque solids face away from
//! each other, as those of a box and the floor that it stands on, nobody can see it, and nothing is said.
//!
//! Candidates are those whose canonical form, rounded to nine digits, has the same hash: sorting finds them. So of
//! curved surfaces that share only a part, such as two cylinders of one side and other ends, nothing is known, and
//! nothing of meshes.

use super::faces::{Flat, flats};
use super::{Lint, MOST_PAIRS, MOST_PLACES, errors};
use crate::math::{DMat3, DVec3, ln};
use crate::scene::boxes::Boxes;
use crate::scene::shape::{Bounds, Form};
use crate::scene::{OriginId, Primitive, Shape};
use crate::span::Span;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::ops::ControlFlow;

/// Cells in a unit of the rounded canonical forms.
const CELLS: f64 = 1e9;
/// How far apart two planes may be and count as one, as a share of the coordinates there.
const FLATNESS: f64 = 1e-12;

pub(super) fn look(lint: &mut Lint) {
    let mut found = curved(&lint.scene.primitives);
    found.extend(flat(lint));
    found.sort_unstable();
    // Boxes may share several faces.
    found.dedup();
    // A pair of places in the source is named once, however many pairs of surfaces it makes.
    let mut pairs: BTreeMap<[Option<Span>; 2], ([OriginId; 2], usize)> = BTreeMap::new();
    for (later, earlier) in found {
        let origins = [later, earlier].map(|i| lint.scene.primitives[i as usize].origin);
        let places = origins.map(|origin| lint.at(origin).map(|at| at.span));
        if pairs.len() < MOST_PLACES || pairs.contains_key(&places) {
            pairs.entry(places).or_insert((origins, 0)).1 += 1;
        }
    }
    for ([later, earlier], count) in pairs.into_values() {
        let diagnostic = errors::coincide(lint, later, earlier, count);
        lint.report(diagnostic);
    }
}

/// Each curved surface that equals an earlier one, with that one.
fn curved(primitives: &[Primitive]) -> Vec<(u32, u32)> {
    let key = |(i, p): (usize, &Primitive)| Some((hash(&form(&p.shape)?), i as u32));
    let mut keys: Vec<(u64, u32)> = primitives.par_iter().enumerate().filter_map(key).collect();
    keys.par_sort_unstable();
    let mut found = vec![];
    for same in keys.chunk_by(|(a, _), (b, _)| a == b).filter(|same| same.len() > 1) {
        let first = same[0].1;
        let shape = |i: u32| &primitives[i as usize].shape;
        let equal = |i: u32| form(shape(i)) == form(shape(first)) && share_heights(shape(i), shape(first));
        found.extend(same[1..].iter().filter(|(_, i)| equal(*i)).map(|(_, i)| (*i, first)));
    }
    found
}

/// The canonical form of a curved surface, relative to its size and rounded, but for its ends.
type Canonical = [i64; 17];

fn form(shape: &Shape) -> Option<Canonical> {
    match shape {
        // The same however it is turned.
        Shape::Sphere { center, radius } => {
            let DVec3 { x, y, z } = *center / *radius;
            Some(rounded(0, &[ln(*radius), x, y, z]))
        }
        Shape::Plane { .. } | Shape::Disk(_) | Shape::Box(_) | Shape::Mesh(_) => None,
        Shape::Quadric(quadric) => {
            let kind = match quadric.form {
                Form::Ellipsoid => 1,
                Form::OneSheet => 2,
                Form::TwoSheet => 3,
                Form::Paraboloid => 4,
                Form::Cone => 5,
                Form::Cylinder => 6,
            };
            let map = quadric.world_from_object;
            Some(canonical(kind, map.translation, map.matrix3))
        }
    }
}

/// A turn about the y axis of object space leaves a surface as it is; it cancels in M·Mᵀ, and leaves y alone.
fn canonical(kind: i64, origin: DVec3, m: DMat3) -> Canonical {
    let size = m.x_axis.length().max(m.y_axis.length()).max(m.z_axis.length());
    let (m, origin) = (m * (1.0 / size), origin / size);
    let squared = m * m.transpose();
    let y = m.y_axis;
    let numbers = [
        ln(size),
        origin.x,
        origin.y,
        origin.z,
        squared.x_axis.x,
        squared.x_axis.y,
        squared.x_axis.z,
        squared.y_axis.y,
        squared.y_axis.z,
        squared.z_axis.z,
        y.x * y.x,
        y.x * y.y,
        y.x * y.z,
        y.y * y.y,
        y.y * y.z,
        y.z * y.z,
    ];
    rounded(kind, &numbers)
}

fn rounded(kind: i64, numbers: &[f64]) -> Canonical {
    let mut canonical = [kind; 17];
    canonical[1..].iter_mut().zip(numbers).for_each(|(cell, number)| *cell = (CELLS * number).round() as i64);
    canonical
}

/// Whether two surfaces of one canonical form overlap between their ends.
fn share_heights(a: &Shape, b: &Shape) -> bool {
    let ends = |shape: &Shape| match shape {
        Shape::Quadric(quadric) => [quadric.low, quadric.high],
        Shape::Sphere { .. } | Shape::Plane { .. } | Shape::Disk(_) | Shape::Box(_) | Shape::Mesh(_) => {
            [f64::NEG_INFINITY, f64::INFINITY]
        }
    };
    let ([a, b], [c, d]) = (ends(a), ends(b));
    a.max(c) < b.min(d)
}

/// A flat part, and what it belongs to.
struct Part {
    flat: Flat,
    primitive: u32,
    /// Whether it is seen from both sides.
    two_sided: bool,
}

/// Each primitive with a flat part that coincides with one of an earlier primitive, with that one.
fn flat(lint: &Lint) -> Vec<(u32, u32)> {
    let parts: Vec<Part> = lint
        .scene
        .primitives
        .iter()
        .zip(0u32..)
        .flat_map(|(primitive, index)| {
            let two_sided = !primitive.shape.is_closed() || !lint.is_opaque(primitive);
            flats(&primitive.shape).into_iter().map(move |flat| Part { flat, primitive: index, two_sided })
        })
        .collect();
    let scale = parts.iter().map(|part| part.flat.center.length()).fold(1e-300, f64::max);
    let mut keys: Vec<(u64, u32)> =
        parts.iter().zip(0u32..).map(|(part, i)| (hash(&part.plane(scale)), i)).collect();
    keys.sort_unstable();
    let mut pairs = 0;
    let mut found = vec![];
    for same in keys.chunk_by(|(a, _), (b, _)| a == b).filter(|same| same.len() > 1) {
        let members: Vec<&Part> = same.iter().map(|(_, i)| &parts[*i as usize]).collect();
        in_one_plane(&members, &mut pairs, &mut found);
    }
    found
}

/// Looks through parts whose planes are nearly one, in the order of their primitives.
fn in_one_plane(parts: &[&Part], pairs: &mut u32, found: &mut Vec<(u32, u32)>) {
    let bounded = parts.iter().zip(0u32..).filter_map(|(part, i)| Some((part.flat.bounds()?, i)));
    let boxes = Boxes::new(bounded.collect());
    let endless: Vec<u32> =
        (0..parts.len() as u32).filter(|i| parts[*i as usize].flat.bounds().is_none()).collect();
    let everywhere = Bounds { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY };
    for (i, part) in (0u32..).zip(parts) {
        if *pairs >= MOST_PAIRS {
            return;
        }
        let mut visit = |j: u32| {
            if j >= i && (j == i || part.flat.bounds().is_some() && parts[j as usize].flat.bounds().is_some())
            {
                return ControlFlow::Continue(());
            }
            *pairs += 1;
            let other = parts[j as usize];
            if part.clashes(other) {
                let (a, b) = (part.primitive, other.primitive);
                found.push((a.max(b), a.min(b)));
                return ControlFlow::Break(());
            }
            if *pairs < MOST_PAIRS { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        };
        match part.flat.bounds() {
            Some(bounds) => boxes.meeting(grown(bounds), visit),
            // Two endless ones meet everywhere: the first is enough.
            None => {
                if endless.first().is_none_or(|first| *first == i || visit(*first).is_continue()) {
                    boxes.meeting(everywhere, visit);
                }
            }
        }
    }
}

/// A box that meets others in spite of rounding.
fn grown(bounds: Bounds) -> Bounds {
    let by = FLATNESS * bounds.min.abs().max(bounds.max.abs()).max_element();
    Bounds { min: bounds.min - by, max: bounds.max + by }
}

impl Part {
    /// The plane it lies in, rounded: the normal with one of its two signs, and the distance from the origin.
    fn plane(&self, scale: f64) -> [i64; 4] {
        let Flat { center, normal, .. } = self.flat;
        let cell = |x: f64| (CELLS * x).round() as i64;
        let [x, y, z, d] = [normal.x, normal.y, normal.z, normal.dot(center) / scale].map(cell);
        let sign = [x, y, z].into_iter().find(|cell| *cell != 0).map_or(1, i64::signum);
        [x, y, z, d].map(|cell| sign * cell)
    }

    /// Whether it and another part of the same plane are seen in the same place.
    fn clashes(&self, other: &Part) -> bool {
        if self.primitive == other.primitive {
            return false;
        }
        let seen = self.two_sided || other.two_sided || self.flat.normal.dot(other.flat.normal) > 0.0;
        let (a, b) = (self.flat.center, other.flat.center);
        let distance = self.flat.normal.dot(a - b).abs();
        seen && distance <= FLATNESS * (a.length() + b.length()) && self.flat.overlaps(&other.flat)
    }
}

/// Mixes integers to 64 bits, each by the finaliser of SplitMix64 (Steele, Lea and Flood, "Fast splittable
/// pseudorandom number generators", 2014).
fn hash(cells: &[i64]) -> u64 {
    cells.iter().fold(0, |state: u64, cell| {
        let mut z = (state ^ *cell as u64).wrapping_add(0x9e37_79b9_7f4a_7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    })
}
