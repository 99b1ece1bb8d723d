//! Seeds: for every place, the few chains that photons came by, in a tree of cells.

use super::chain::Ways;
use super::photons::Photon;
use crate::math::DVec3;
use crate::render::lanes::One;
use crate::render::vector::{V, single};
use crate::render::{Cancelled, Control};
use crate::scene::shape::Bounds;
use rayon::prelude::*;

/// A chain worth trying at the receivers of a cell: photons that came alike.
#[derive(Clone, Copy, Debug)]
pub struct Seed {
    /// The way to the lamp.
    pub ways: Ways,
    /// The lamp, by its place among the goals.
    pub goal: u32,
    /// Power of its photons, over the area of the cell: about the irradiance.
    pub irradiance: f32,
    /// About the direction that they came from.
    w: [f32; 3],
    /// Where its tracks lie.
    first: u32,
    count: u32,
}

impl Seed {
    /// What it is chosen by: nothing where it leads behind a surface of that normal.
    #[inline]
    pub fn weight(&self, n: V<One>) -> f32 {
        if V::splat(One, self.w).dot(n) > LEAST_RISE { self.irradiance } else { 0.0 }
    }
}

/// Least cosine to the normal of what light comes from, about; a cell's photons may have come to other surfaces.
const LEAST_RISE: f32 = -0.3;

/// Where a photon ended, and the last surface of its chain.
#[derive(Clone, Copy, Debug)]
struct Track {
    /// The end.
    p: [f32; 3],
    /// The last polished surface before.
    toward: [f32; 3],
}

/// A place where photons lie together; by default one without any.
#[derive(Clone, Copy, Debug, Default)]
pub struct Cell {
    /// Its seeds.
    first: u32,
    count: u32,
    /// How often to look for light there.
    pub effort: f32,
}

/// Cells, each with its seeds.
#[derive(Clone, Debug)]
pub struct Seeds {
    /// Corners of what all cells fill.
    low: [f32; 3],
    high: [f32; 3],
    nodes: Vec<Node>,
    cells: Vec<Cell>,
    seeds: Vec<Seed>,
    tracks: Vec<Track>,
    most_effort: f32,
}

/// A cell that is halved, or one of its index.
#[derive(Clone, Copy, Debug)]
enum Node {
    /// Below `at` along an axis the next node, else the one of that index.
    Inner { axis: u8, at: f32, above: u32 },
    /// A cell, by its index.
    Leaf(u32),
}

/// Photons that a cell may hold before it is halved.
const CELL: usize = 12;
const DEEPEST: u32 = 30;
/// Seeds of one cell, and tracks of one seed.
const MOST_SEEDS: usize = 12;
const MOST_TRACKS: usize = 12;
/// Photons that come from directions with at least this cosine are one seed.
const ALIKE: f32 = 0.95;
/// No irradiance is greater, so that sums are finite.
const MOST_IRRADIANCE: f32 = 1e30;
/// By how many of its lengths a cell reaches out for photons of its neighbours, so that no chain is forgotten at the
/// border.
const REACH: f64 = 0.5;

impl Seeds {
    /// Sorts photons into cells; none without photons. How often to look for light at a place is told from the
    /// seeds there.
    ///
    /// # Errors
    ///
    /// If the control cancels.
    pub fn new(
        mut photons: Vec<Photon>,
        effort: impl Fn([f32; 3], &[Seed]) -> f32,
        control: &Control,
    ) -> Result<Option<Seeds>, Cancelled> {
        let bounds = photons
            .iter()
            .map(|photon| place(photon.p))
            .fold(Bounds::EMPTY, |sum, p| sum.union(Bounds { min: p, max: p }));
        if photons.is_empty() || !bounds.min.is_finite() || !bounds.max.is_finite() {
            return Ok(None);
        }
        // A cube, so that cells are nearly cubes, a little larger than what the photons met.
        let half = DVec3::splat(0.55 * bounds.size().max_element() + f64::from(f32::MIN_POSITIVE));
        let cube = Bounds { min: bounds.center() - half, max: bounds.center() + half };
        let mut tree = Tree { nodes: Vec::new(), leaves: Vec::new() };
        tree.build(&mut photons, 0, cube, 0);
        let leaves = tree.leaves.par_iter();
        let found: Option<Vec<Found>> = leaves
            .map(|leaf| {
                control.rest();
                (!control.is_cancelled()).then(|| tree.seeds(&photons, leaf.cell))
            })
            .collect();
        let found = found.ok_or(Cancelled)?;
        let mut seeds = Seeds {
            low: single(cube.min),
            high: single(cube.max),
            nodes: tree.nodes,
            cells: Vec::new(),
            seeds: Vec::new(),
            tracks: Vec::new(),
            most_effort: 0.0,
        };
        for (leaf, found) in tree.leaves.iter().zip(found) {
            seeds.push(found, single(leaf.cell.center()), &effort);
        }
        Ok(Some(seeds))
    }

    /// Empties all cells.
    #[cfg(test)]
    pub fn forget(&mut self) {
        self.cells.fill(Cell::default());
    }

    /// Adds what was found for the next cell.
    fn push(&mut self, found: Found, middle: [f32; 3], effort: impl Fn([f32; 3], &[Seed]) -> f32) {
        let (first, tracks) = (self.seeds.len() as u32, self.tracks.len() as u32);
        let count = found.seeds.len() as u32;
        self.seeds.extend(found.seeds.into_iter().map(|seed| Seed { first: seed.first + tracks, ..seed }));
        self.tracks.extend(found.tracks);
        let effort = effort(middle, &self.seeds[first as usize..]);
        self.cells.push(Cell { first, count, effort });
        self.most_effort = self.most_effort.max(effort);
    }

    /// The greatest effort of any cell.
    #[inline]
    pub fn most_effort(&self) -> f32 {
        self.most_effort
    }

    /// The cell around a point.
    #[inline]
    pub fn around(&self, p: [f32; 3]) -> Option<Cell> {
        for ((low, high), p) in self.low.into_iter().zip(self.high).zip(p) {
            if !(low <= p && p <= high) {
                return None;
            }
        }
        let mut index = 0;
        loop {
            match self.nodes[index] {
                Node::Inner { axis, at, above } => {
                    index = if p[usize::from(axis)] < at { index + 1 } else { above as usize };
                }
                Node::Leaf(cell) => return Some(self.cells[cell as usize]),
            }
        }
    }

    /// The seeds of a cell.
    #[inline]
    pub fn of(&self, cell: Cell) -> &[Seed] {
        &self.seeds[cell.first as usize..(cell.first + cell.count) as usize]
    }

    /// Where to begin to aim a seed from a point: at the last surface of the nearest photon's chain, or in the
    /// direction that it came from.
    #[inline]
    pub fn towards(&self, seed: &Seed, p: V<One>) -> [V<One>; 2] {
        let tracks = &self.tracks[seed.first as usize..(seed.first + seed.count) as usize];
        let mut best = (f32::INFINITY, tracks[0]);
        for track in tracks {
            let distance = (V::splat(One, track.p) - p).squared();
            if distance < best.0 {
                best = (distance, *track);
            }
        }
        let toward = V::splat(One, best.1.toward);
        [(toward - p).normalized(One), (toward - V::splat(One, best.1.p)).normalized(One)]
    }
}

fn place([x, y, z]: [f32; 3]) -> DVec3 {
    DVec3::new(f64::from(x), f64::from(y), f64::from(z))
}

/// Cells whose photons lie together.
struct Tree {
    nodes: Vec<Node>,
    leaves: Vec<Leaf>,
}

/// So many photons from the first, and the cell that they lie in.
struct Leaf {
    first: u32,
    count: u32,
    cell: Bounds,
}

/// The few chains that stand for those of a cell's photons. Tracks count from the first of them.
struct Found {
    seeds: Vec<Seed>,
    tracks: Vec<Track>,
}

impl Tree {
    fn build(&mut self, photons: &mut [Photon], offset: u32, cell: Bounds, depth: u32) {
        if photons.len() <= CELL || depth >= DEEPEST {
            self.nodes.push(Node::Leaf(self.leaves.len() as u32));
            self.leaves.push(Leaf { first: offset, count: photons.len() as u32, cell });
            return;
        }
        let size = cell.size();
        let axis = if size.x >= size.y && size.x >= size.z {
            0
        } else if size.y >= size.z {
            1
        } else {
            2
        };
        let at = cell.center()[axis] as f32;
        let mut count = 0;
        for i in 0..photons.len() {
            if photons[i].p[axis] < at {
                photons.swap(i, count);
                count += 1;
            }
        }
        let here = self.nodes.len();
        self.nodes.push(Node::Inner { axis: axis as u8, at, above: 0 });
        let [below_cell, above_cell] = halves(cell, axis, f64::from(at));
        let (below, rest) = photons.split_at_mut(count);
        self.build(below, offset, below_cell, depth + 1);
        let above = self.nodes.len() as u32;
        self.nodes[here] = Node::Inner { axis: axis as u8, at, above };
        self.build(rest, offset + count as u32, above_cell, depth + 1);
    }

    /// The few chains that stand for those of the photons in and near a cell.
    fn seeds(&self, photons: &[Photon], cell: Bounds) -> Found {
        let reach = REACH * cell.size().max_element();
        let wide = Bounds { min: cell.min - reach, max: cell.max + reach };
        let mut near = Vec::new();
        self.within(photons, 0, &wide, &mut near);
        let size = wide.size();
        let area = (size.x * size.y).max(size.y * size.z).max(size.z * size.x) as f32;
        let mut found: Vec<(Seed, Vec<Track>)> = Vec::new();
        for photon in near {
            let (p, toward) = (V::splat(One, photon.p), V::splat(One, photon.toward));
            let w = (toward - p).normalized(One);
            let track = Track { p: photon.p, toward: photon.toward };
            let irradiance = (photon.power / area).min(MOST_IRRADIANCE);
            let alike = found.iter_mut().find(|(seed, _)| {
                let alike = V::splat(One, seed.w).dot(w) > ALIKE;
                alike && seed.ways == photon.ways && seed.goal == photon.goal
            });
            if let Some((seed, tracks)) = alike {
                seed.irradiance += irradiance;
                tracks.push(track);
            } else {
                let Photon { ways, goal, .. } = photon;
                found.push((Seed { ways, goal, irradiance, w: w.get(0), first: 0, count: 0 }, vec![track]));
            }
        }
        found.sort_by(|(a, _), (b, _)| b.irradiance.total_cmp(&a.irradiance));
        few(found, cell.center())
    }

    fn within(&self, photons: &[Photon], index: u32, wide: &Bounds, found: &mut Vec<Photon>) {
        match self.nodes[index as usize] {
            Node::Inner { axis, at, above } => {
                let axis = usize::from(axis);
                if wide.min[axis] < f64::from(at) {
                    self.within(photons, index + 1, wide, found);
                }
                if wide.max[axis] >= f64::from(at) {
                    self.within(photons, above, wide, found);
                }
            }
            Node::Leaf(leaf) => {
                let Leaf { first, count, .. } = self.leaves[leaf as usize];
                let these = &photons[first as usize..(first + count) as usize];
                let inside = |p: DVec3| p.cmpge(wide.min).all() && p.cmple(wide.max).all();
                found.extend(these.iter().filter(|photon| inside(place(photon.p))));
            }
        }
    }
}

/// The greatest of some seeds, with the tracks of each next to the middle.
fn few(all: Vec<(Seed, Vec<Track>)>, middle: DVec3) -> Found {
    let mut found = Found { seeds: Vec::new(), tracks: Vec::new() };
    let off = |track: &Track| place(track.p).distance_squared(middle);
    for (seed, mut tracks) in all.into_iter().take(MOST_SEEDS) {
        tracks.sort_by(|a, b| off(a).total_cmp(&off(b)));
        tracks.truncate(MOST_TRACKS);
        let (first, count) = (found.tracks.len() as u32, tracks.len() as u32);
        found.tracks.extend(tracks);
        found.seeds.push(Seed { first, count, ..seed });
    }
    found
}

fn halves(cell: Bounds, axis: usize, at: f64) -> [Bounds; 2] {
    let (mut below, mut above) = (cell, cell);
    below.max[axis] = at;
    above.min[axis] = at;
    [below, above]
}
