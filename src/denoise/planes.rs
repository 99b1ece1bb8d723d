//! Numbers of a picture, plane by plane, and tiles of them with a margin.

use fearless_simd::{Level, Simd, dispatch};
use rayon::prelude::*;

/// Pixels that are worked on together.
pub(super) const LANES: usize = 16;
/// A number of each of these.
pub(super) type Lane = [f32; LANES];
/// Columns of a tile, a multiple of [`LANES`].
const TILE_WIDTH: usize = 32;
/// Rows of a tile.
pub(super) const TILE_HEIGHT: usize = 16;

/// Does something with the widest vector instructions that the processor has: what is inlined into it is compiled for each
/// set of them. None of it is fused, so the bits are the same.
#[inline(always)]
pub(super) fn vectorized<R>(work: impl FnOnce() -> R) -> R {
    dispatch!(Level::new(), simd => simd.vectorize(work))
}

/// Several numbers of every pixel.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Planes {
    /// Columns and rows.
    pub(super) size: [usize; 2],
    /// Each row by row from the top left.
    pub(super) planes: Vec<Vec<f32>>,
}

impl Planes {
    /// Takes apart what every pixel has.
    pub(super) fn of<const N: usize>(size: [usize; 2], pixels: &[[f32; N]]) -> Planes {
        let plane = |index: usize| pixels.iter().map(|pixel| pixel[index]).collect();
        Planes { size, planes: (0..N).map(plane).collect() }
    }

    /// Every number times a factor; what is none is 0, and what is more than the most is that.
    pub(super) fn finite(mut self, factor: f32, most: f32) -> Planes {
        let finite = |v: f32| if v.is_nan() { 0.0 } else { (v * factor).clamp(-most, most) };
        self.planes.par_iter_mut().for_each(|plane| plane.iter_mut().for_each(|v| *v = finite(*v)));
        self
    }

    /// Every number made out of those at the same place of two others.
    pub(super) fn zip(&self, other: &Planes, made: impl Fn(f32, f32) -> f32 + Sync) -> Planes {
        let plane = |(a, b): (&Vec<f32>, &Vec<f32>)| a.iter().zip(b).map(|(a, b)| made(*a, *b)).collect();
        Planes { size: self.size, planes: self.planes.par_iter().zip(&other.planes).map(plane).collect() }
    }

    /// Every number made out of itself and the one that its pixel has in a list.
    pub(super) fn scaled(&self, by: &[f32], made: impl Fn(f32, f32) -> f32 + Sync) -> Planes {
        let plane = |plane: &Vec<f32>| plane.iter().zip(by).map(|(v, by)| made(*v, *by)).collect();
        Planes { size: self.size, planes: self.planes.par_iter().map(plane).collect() }
    }

    /// The mean over squares of so many pixels to every side, of those that there are.
    pub(super) fn blurred(&self, radius: usize) -> Planes {
        let planes = self.planes.par_iter().map(|plane| blurred(plane, self.size, radius));
        Planes { size: self.size, planes: planes.collect() }
    }

    /// The tiles of the picture, in rows.
    pub(super) fn rows_of_tiles(&self) -> Vec<Vec<Tile>> {
        let [width, height] = self.size;
        let starts = |length: usize, side: usize| (0..length).step_by(side);
        let tile = |x: usize, y: usize| Tile {
            x,
            y,
            width: TILE_WIDTH.min(width - x),
            height: TILE_HEIGHT.min(height - y),
        };
        starts(height, TILE_HEIGHT).map(|y| starts(width, TILE_WIDTH).map(|x| tile(x, y)).collect()).collect()
    }
}

fn blurred(plane: &[f32], [width, height]: [usize; 2], radius: usize) -> Vec<f32> {
    let around = |at: usize, length: usize| at.saturating_sub(radius)..(at + radius + 1).min(length);
    let along_row = |index: usize| {
        let (start, columns) = (index / width * width, around(index % width, width));
        let count = columns.len() as f32;
        columns.map(|x| plane[start + x]).sum::<f32>() / count
    };
    let rows: Vec<f32> = (0..width * height).map(along_row).collect();
    let along_column = |index: usize| {
        let near = around(index / width, height);
        let count = near.len() as f32;
        near.map(|y| rows[y * width + index % width]).sum::<f32>() / count
    };
    (0..width * height).map(along_column).collect()
}

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Tile {
    /// Left column.
    pub(super) x: usize,
    /// Top row.
    pub(super) y: usize,
    /// Columns.
    pub(super) width: usize,
    /// Rows.
    pub(super) height: usize,
}

impl Tile {
    /// Its columns up to whole [`LANES`].
    pub(super) fn padded(&self) -> usize {
        self.width.next_multiple_of(LANES)
    }
}

/// A tile with a margin, copied out of planes; beyond the picture its edge goes on.
#[derive(Default)]
pub(super) struct Cut {
    /// Numbers from one row to the next.
    pub(super) stride: usize,
    /// Row by row.
    pub(super) planes: Vec<Vec<f32>>,
}

impl Cut {
    /// Cuts a tile with so many pixels around it, and whole lanes to its right, with some to spare.
    pub(super) fn of(planes: &Planes, tile: &Tile, margin: usize) -> Cut {
        let [width, height] = planes.size;
        let stride = (tile.padded() + 2 * margin).next_multiple_of(LANES) + LANES;
        // Columns before the picture, within it, and behind it.
        let before = margin.saturating_sub(tile.x).min(stride);
        let first = tile.x.saturating_sub(margin);
        let within = (width - first).min(stride - before);
        let cut = |plane: &Vec<f32>| {
            let mut cut = Vec::with_capacity(stride * (tile.height + 2 * margin));
            for i in 0..tile.height + 2 * margin {
                let y = (tile.y + i).saturating_sub(margin).min(height - 1);
                let row = &plane[y * width..][..width];
                cut.extend(std::iter::repeat_n(row[0], before));
                cut.extend_from_slice(&row[first..first + within]);
                cut.extend(std::iter::repeat_n(row[width - 1], stride - before - within));
            }
            cut
        };
        Cut { stride, planes: planes.planes.iter().map(cut).collect() }
    }
}
