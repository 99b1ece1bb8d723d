//! Pictures as half floats, in tiles: what a page develops by itself.

use super::super::hub::{Frame, Mask};
use half::f16;
use half::slice::HalfFloatSliceExt;

/// Pixels across and down a tile.
const SIDE: u32 = 64;

/// Stops that the exposure may move before a picture is sent at another scale. Half floats hold 15 stops above their
/// scale and 14 below it at full precision.
const ROOM: f64 = 6.0;

/// Words at the head of a message.
const HEAD: usize = 12;
const TILE: u32 = 1;
const MASK: u32 = 2;

/// A picture as it was sent to one page.
pub struct Sent {
    frame: std::sync::Arc<Frame>,
    scale: i32,
}

impl Sent {
    /// A picture that is to be sent at an exposure, after another one.
    pub fn next(frame: std::sync::Arc<Frame>, stops: f64, before: Option<&Sent>) -> Sent {
        let kept = before.map(|sent| sent.scale).filter(|scale| (f64::from(*scale) - stops).abs() <= ROOM);
        // Far beyond any exposure of a picture that shows something.
        let scale = kept.unwrap_or_else(|| stops.round().clamp(-100.0, 100.0) as i32);
        Sent { frame, scale }
    }

    /// The picture.
    pub fn frame(&self) -> &Frame {
        &self.frame
    }

    /// The power of two that its values are multiplied by.
    pub fn scale(&self) -> i32 {
        self.scale
    }

    /// The tiles that another picture does not have, each as a message.
    pub fn tiles<'a>(&'a self, before: Option<&'a Sent>) -> impl Iterator<Item = Vec<u8>> + 'a {
        let alike = move |sent: &&Sent| {
            let shape = |sent: &Sent| (sent.frame.size, sent.frame.step, sent.scale);
            shape(sent) == shape(self)
        };
        let before = before.filter(alike).map(|sent| &*sent.frame);
        let [width, height] = self.frame.held();
        let corners = (0..height)
            .step_by(SIDE as usize)
            .flat_map(move |y| (0..width).step_by(SIDE as usize).map(move |x| [x, y]));
        let tiles = corners.map(move |[x, y]| Tile {
            x,
            y,
            width: SIDE.min(width - x),
            height: SIDE.min(height - y),
        });
        let is_new =
            move |tile: &Tile| before.is_none_or(|before| tile.rows(before).ne(tile.rows(&self.frame)));
        tiles.filter(is_new).map(|tile| self.encode(&tile))
    }

    fn encode(&self, tile: &Tile) -> Vec<u8> {
        let frame = &*self.frame;
        let transparent = tile.rows(frame).flatten().any(|pixel| pixel[4] < 1.0);
        let channels = if transparent { 5 } else { 4 };
        let mut message = head([
            TILE,
            0,
            // Only equality matters to a page.
            frame.generation as u32,
            frame.version as u32,
            tile.x,
            tile.y,
            tile.width,
            tile.height,
            frame.step,
            channels,
            self.scale.cast_unsigned(),
            0,
        ]);
        let factor = rt_lang::math::exp2(f64::from(self.scale)) as f32;
        let count = (tile.width * tile.height * channels) as usize;
        let mut values = Vec::with_capacity(count);
        for [r, g, b, error, covered] in tile.rows(frame).flatten() {
            // No error is known of a single sample: that stays infinite.
            let shown = [bounded(r * factor), bounded(g * factor), bounded(b * factor), error * factor];
            values.extend(shown);
            if transparent {
                values.push(*covered);
            }
        }
        // All at once, by the processor's own instructions where it has them.
        let mut halves = vec![f16::ZERO; count];
        halves.convert_from_f32_slice(&values);
        message.extend(halves.iter().flat_map(|half| half.to_le_bytes()));
        message
    }
}

struct Tile {
    x: u32,
    y: u32,
    width: u32,
    height: u32,
}

impl Tile {
    /// Its rows in a picture.
    fn rows<'f>(&self, frame: &'f Frame) -> impl Iterator<Item = &'f [[f32; 5]]> {
        let stride = frame.held()[0] as usize;
        let (x, y) = (self.x as usize, self.y as usize);
        let (width, height) = (self.width as usize, self.height as usize);
        (y..y + height).map(move |row| &frame.pixels[row * stride + x..][..width])
    }
}

/// What is beyond the range is the greatest there is, and what is not a number is nothing.
#[inline]
fn bounded(value: f32) -> f32 {
    if value.is_nan() { 0.0 } else { value.clamp(f16::MIN.to_f32(), f16::MAX.to_f32_const()) }
}

/// Pixels that are chosen, as the answer to a question.
pub fn mask(id: u32, mask: &Mask) -> Vec<u8> {
    let [width, height] = mask.size;
    let mut message = head([MASK, id, 0, 0, 0, 0, width, height, 1, 0, 0, 0]);
    message.extend(&mask.bits);
    message
}

fn head(words: [u32; HEAD]) -> Vec<u8> {
    words.iter().flat_map(|word| word.to_le_bytes()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::live::hub::Shown;
    use rt_lang::output::Facts;
    use rt_lang::scene::Tonemap;
    use std::sync::Arc;

    fn frame(size: [u32; 2], pixel: impl Fn(u32, u32) -> [f32; 5]) -> Arc<Frame> {
        let pixels = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y))).map(|(x, y)| pixel(x, y));
        Arc::new(Frame {
            generation: 3,
            version: 9,
            size,
            step: 1,
            samples: [1, 1],
            pixels: pixels.collect(),
            remixed: false,
            shown: Shown { stops: 0.0, tonemap: Tonemap::Neutral },
            facts: Facts::unknown(),
            transparent: false,
        })
    }

    fn words(message: &[u8]) -> Vec<u32> {
        message[..4 * HEAD].chunks_exact(4).map(|word| u32::from_le_bytes(word.try_into().unwrap())).collect()
    }

    fn values(message: &[u8]) -> Vec<f32> {
        let halves = message[4 * HEAD..].chunks_exact(2);
        halves.map(|half| f16::from_le_bytes(half.try_into().unwrap()).to_f32()).collect()
    }

    #[test]
    fn tiles_cover_the_picture_once() {
        let sent = Sent::next(frame([130, 70], |x, y| [x as f32, y as f32, 0.0, 0.5, 1.0]), 0.0, None);
        let mut seen = vec![0; 130 * 70];
        for tile in sent.tiles(None) {
            let head = words(&tile);
            assert_eq!(head[..4], [TILE, 0, 3, 9]);
            assert_eq!(head[8..], [1, 4, 0, 0]);
            let [x, y, width, height] = head[4..8] else { panic!() };
            assert_eq!(tile.len(), 4 * HEAD + (width * height * 8) as usize);
            for (i, pixel) in values(&tile).chunks_exact(4).enumerate() {
                let (x, y) = (x + i as u32 % width, y + i as u32 / width);
                assert_eq!(pixel, [x as f32, y as f32, 0.0, 0.5]);
                seen[(y * 130 + x) as usize] += 1;
            }
        }
        assert!(seen.iter().all(|&count| count == 1));
    }

    #[test]
    fn only_what_has_changed_is_sent_again() {
        let first = Sent::next(frame([200, 100], |_, _| [1.0, 1.0, 1.0, f32::INFINITY, 1.0]), 0.0, None);
        let changed = |x, y| [if (x, y) == (70, 10) { 2.0 } else { 1.0 }, 1.0, 1.0, f32::INFINITY, 1.0];
        let second = Sent::next(frame([200, 100], changed), 0.5, Some(&first));
        let tiles: Vec<Vec<u8>> = second.tiles(Some(&first)).collect();
        assert_eq!(tiles.len(), 1);
        assert_eq!(words(&tiles[0])[4..8], [64, 0, 64, 64]);
        assert_eq!(second.tiles(None).count(), 8);
        // At another scale all are other numbers.
        let third = Sent::next(frame([200, 100], changed), 20.0, Some(&second));
        assert_eq!(third.tiles(Some(&second)).count(), 8);
    }

    #[test]
    fn dark_and_bright_scenes_keep_their_precision() {
        for (radiance, stops) in [(1.234e-9f32, 30.0), (4.321e9, -31.0), (0.5, 0.0)] {
            let sent = Sent::next(frame([1, 1], |_, _| [radiance, 0.0, 0.0, 0.0, 1.0]), stops, None);
            let tile = sent.tiles(None).next().unwrap();
            let scale = words(&tile)[10].cast_signed();
            let seen = f64::from(values(&tile)[0]) / rt_lang::math::exp2(f64::from(scale));
            assert!((seen / f64::from(radiance) - 1.0).abs() < 1e-3, "{radiance}: {seen}");
        }
    }

    #[test]
    fn strange_numbers_are_sent_as_something() {
        let strange = [f32::NAN, f32::INFINITY, -f32::MAX, f32::INFINITY, 1.0];
        let sent = Sent::next(frame([1, 1], |_, _| strange), f64::NAN, None);
        let tile = sent.tiles(None).next().unwrap();
        assert_eq!(values(&tile), [0.0, 65504.0, -65504.0, f32::INFINITY]);
    }

    #[test]
    fn what_is_transparent_says_so() {
        let sent = Sent::next(frame([2, 1], |x, _| [0.0, 0.0, 0.0, 0.0, 0.5 + 0.5 * x as f32]), 0.0, None);
        let tile = sent.tiles(None).next().unwrap();
        assert_eq!(words(&tile)[9], 5);
        assert_eq!(values(&tile)[4..], [0.5, 0.0, 0.0, 0.0, 0.0, 1.0]);
    }

    #[test]
    fn a_mask_names_its_question() {
        let message = mask(7, &Mask { size: [9, 1], bits: vec![0x80, 0x80] });
        assert_eq!(words(&message), [MASK, 7, 0, 0, 0, 0, 9, 1, 1, 0, 0, 0]);
        assert_eq!(message[4 * HEAD..], [0x80, 0x80]);
    }
}
