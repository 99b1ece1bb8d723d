//! How much of a picture's light is of which lamp, coarsely: enough to show at once what brighter or darker lamps will do.

use super::light::Source;
use super::{Cancelled, Control, Tracer};
use crate::color::Rgb;
use crate::scene::{Material, Primitive};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Pixels along the side of a cell.
const CELL: u32 = 4;
/// Samples of each pixel.
const SAMPLES: u32 = 4;
/// With more lamps than this, lamps are rarely changed one by one.
const MOST_LAMPS: usize = 64;
/// More memory than this is not taken.
const MOST_BYTES: usize = 64 << 20;

/// The light of each lamp in each cell of a picture.
#[derive(Clone, Debug)]
pub struct Shares {
    columns: u32,
    rows: u32,
    sources: Vec<Source>,
    /// Cell by cell, in each lamp by lamp.
    sums: Vec<[f32; 3]>,
}

impl Tracer<'_> {
    /// Learns the shares of the lamps from a few samples of each pixel. None where there are too many lamps, or it would take
    /// too much memory.
    ///
    /// # Errors
    ///
    /// If the control cancels.
    pub fn shares(&self, control: &Control) -> Result<Option<Shares>, Cancelled> {
        let [width, height] = self.scene.trace.size;
        let (columns, rows) = (width.div_ceil(CELL), height.div_ceil(CELL));
        let glows =
            |primitive: &Primitive| matches!(self.scene.material(primitive), Material::Emitter { .. });
        let glowing = self.scene.primitives.iter().filter(|primitive| glows(primitive));
        let lamps = self.scene.lights.len() + glowing.take(MOST_LAMPS + 1).count();
        let bytes = columns as usize * rows as usize * lamps * size_of::<[f32; 3]>();
        if lamps > MOST_LAMPS || bytes > MOST_BYTES {
            return Ok(None);
        }
        let cell = |index: u32| {
            let (left, top) = (index % columns * CELL, index / columns * CELL);
            let mut sums: BTreeMap<Source, Rgb> = BTreeMap::new();
            let pixels = (top..(top + CELL).min(height))
                .flat_map(|y| (left..(left + CELL).min(width)).map(move |x| [x, y]));
            for pixel in pixels.take_while(|_| !control.is_cancelled()) {
                for sample in 0..SAMPLES {
                    for contribution in self.watched(pixel, sample).contributions {
                        *sums.entry(contribution.source).or_default() += contribution.radiance;
                    }
                }
            }
            sums
        };
        let cells: Vec<BTreeMap<Source, Rgb>> = (0..columns * rows).into_par_iter().map(cell).collect();
        if control.is_cancelled() {
            return Err(Cancelled);
        }
        let mut sources: Vec<Source> = cells.iter().flat_map(|cell| cell.keys().copied()).collect();
        sources.sort_unstable();
        sources.dedup();
        let lamp = |cell: &BTreeMap<Source, Rgb>, source| {
            cell.get(source).map_or([0.0; 3], |sum| sum.to_array().map(|v| v as f32))
        };
        let sums = cells.iter().flat_map(|cell| sources.iter().map(move |source| lamp(cell, source)));
        Ok(Some(Shares { columns, rows, sums: sums.collect(), sources }))
    }
}

impl Shares {
    /// Of which lamps there is light.
    pub fn sources(&self) -> &[Source] {
        &self.sources
    }

    /// By what a pixel's radiance is to be multiplied, by channel, when each of the [`Shares::sources`] counts by a factor.
    pub fn factor(&self, x: u32, y: u32, factors: &[Rgb]) -> [f32; 3] {
        // Between the middles of four cells.
        let along = |pixel: u32, cells: u32| {
            let at = ((pixel as f32 + 0.5) / CELL as f32 - 0.5).clamp(0.0, (cells - 1) as f32);
            let first = at as u32;
            (first, (first + 1).min(cells - 1), at - first as f32)
        };
        let (left, right, u) = along(x, self.columns);
        let (top, bottom, v) = along(y, self.rows);
        let corners = [
            (left, top, (1.0 - u) * (1.0 - v)),
            (right, top, u * (1.0 - v)),
            (left, bottom, (1.0 - u) * v),
            (right, bottom, u * v),
        ];
        let (mut before, mut after) = ([0.0f32; 3], [0.0f32; 3]);
        for (column, row, weight) in corners {
            let start = (row * self.columns + column) as usize * self.sources.len();
            for (sum, factor) in self.sums[start..start + self.sources.len()].iter().zip(factors) {
                for (channel, factor) in factor.to_array().into_iter().enumerate() {
                    before[channel] += weight * sum[channel];
                    after[channel] += weight * sum[channel] * factor as f32;
                }
            }
        }
        std::array::from_fn(|channel| match before[channel] {
            sum if sum > 0.0 => after[channel] / sum,
            _ => 1.0,
        })
    }
}
