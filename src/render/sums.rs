//! Sums of samples, and what they were on the way.

use super::film::{Film, Pixel, Window};

/// Where samples are added up.
pub(super) struct Sums<'f> {
    /// All of them.
    pub(super) film: &'f mut Film,
    /// What they were at two numbers of samples, if that is wanted: see [`Making::in_halves`](super::making::Making::in_halves).
    pub(super) early: Option<&'f mut [Film; 2]>,
}

impl Sums<'_> {
    /// Where samples up to this number are to be told apart: at the last power of two, and at that before it.
    pub(super) fn cuts(&self, end: u32) -> Option<[u32; 2]> {
        let last = 1 << end.max(1).ilog2();
        self.early.is_some().then_some([last / 2, last])
    }

    /// Adds the pixels of a tile, of samples from this one on: of all of them, or one part after the other.
    pub(super) fn add(&mut self, tile: Window, pixels: &[Pixel], start: u32, cuts: Option<[u32; 2]>) {
        let mut parts = pixels.chunks(tile.pixels().max(1));
        let (Some(early), Some(cuts)) = (&mut self.early, cuts) else {
            return parts.for_each(|part| self.film.merge_pixels(tile, part));
        };
        let [first, second] = &mut **early;
        let mut next =
            |film: &mut Film| parts.next().into_iter().for_each(|part| film.merge_pixels(tile, part));
        next(self.film);
        if start < cuts[0] {
            first.replace(tile, self.film);
        } else if start < cuts[1] {
            // Half as many are those that the other one has.
            first.replace(tile, second);
        }
        next(self.film);
        if start < cuts[1] {
            second.replace(tile, self.film);
        }
        next(self.film);
    }
}
