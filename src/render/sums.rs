//! Sums of samples, and what they were on the way.

use super::film::{Film, LIGHT_WORDS, LightSums, Pixel, Window};

/// Where samples are added up.
pub(super) struct Sums<'f> {
    /// All of them.
    pub(super) film: &'f mut Film,
    /// What they were at two numbers of samples, if that is wanted: see [`Making::in_halves`](super::making::Making::in_halves).
    pub(super) early: Option<&'f mut [Vec<LightSums>; 2]>,
}

impl Sums<'_> {
    /// Where samples up to this number are to be told apart, if that is wanted.
    pub(super) fn cuts(&self, end: u32) -> Option<[u32; 2]> {
        self.early.is_some().then(|| cuts(end))
    }

    /// Adds the pixels of a tile, of samples from this one on: of all of them, or one part after the other.
    pub(super) fn add(&mut self, tile: Window, pixels: &[Pixel], start: u32, cuts: Option<[u32; 2]>) {
        let mut parts = pixels.chunks(tile.pixels().max(1));
        let Sums { film, early } = self;
        let (Some([first, second]), Some(cuts)) = (early.as_deref_mut(), cuts) else {
            return parts.for_each(|part| film.merge_pixels(tile, part));
        };
        let window = film.window();
        let rows = (tile.y..tile.y + tile.height).map(|y| window.index(tile.x, y));
        let rows = rows.map(|start| start..start + tile.width as usize);
        let keep = |lights: &mut [LightSums], film: &Film| {
            for index in rows.clone().flatten() {
                lights[index] = *film.pixels()[index].light();
            }
        };
        let mut next =
            |film: &mut Film| parts.next().into_iter().for_each(|part| film.merge_pixels(tile, part));
        next(film);
        if start < cuts[0] {
            keep(first, film);
        } else if start < cuts[1] {
            // Half as many are those that the other one has.
            rows.clone().for_each(|row| first[row.clone()].copy_from_slice(&second[row]));
        }
        next(film);
        if start < cuts[1] {
            keep(second, film);
        }
        next(film);
    }
}

/// Of so many samples, the numbers at which they are told apart: the last power of two, and that before it.
pub(super) fn cuts(samples: u32) -> [u32; 2] {
    let last = 1 << samples.max(1).ilog2();
    [last / 2, last]
}

/// The light of a film's first samples, by what gives its words: for each of both numbers of them, pixel by pixel. None where
/// such light cannot be that of these samples.
pub(super) fn early(
    film: &Film,
    words: impl Fn(usize, usize) -> Option<[u32; LIGHT_WORDS]>,
) -> Option<[Vec<LightSums>; 2]> {
    let of = |which: usize| -> Option<Vec<LightSums>> {
        let light = |(index, pixel): (usize, &Pixel)| {
            let samples = cuts(pixel.samples())[which].min(pixel.samples());
            let light = LightSums::from_words(words(which, index)?, samples)?;
            pixel.light().without(&light).map(|_| light)
        };
        film.pixels().iter().enumerate().map(light).collect()
    };
    Some([of(0)?, of(1)?])
}

/// The light of each pixel in two parts: that of its first samples, of both numbers of them the one that is nearer to half of all,
/// and that of the others. None where they are none of these samples.
pub(super) fn halved(film: &Film, [first, second]: &[Vec<LightSums>; 2]) -> Option<[Vec<LightSums>; 2]> {
    let halved = |((pixel, first), second): ((&Pixel, &LightSums), &LightSums)| {
        let from_half = |light: &LightSums| (2 * light.samples()).abs_diff(pixel.samples());
        let some = if from_half(first) <= from_half(second) { first } else { second };
        Some((*some, pixel.light().without(some)?))
    };
    let halved: Option<(Vec<LightSums>, Vec<LightSums>)> =
        film.pixels().iter().zip(first).zip(second).map(halved).collect();
    halved.map(|(some, others)| [some, others])
}
