//! When a picture has enough samples, and where it has too few.
//!
//! **Noise** is the standard error of the displayed pixel in its worst channel, as a share of white: see [`Film::shown_error`]. It
//! counts a pixel's samples as independent of each other. They are stratified, which makes the true error smaller for the most
//! part.
//!
//! **Where samples go.** With a noise target, pixels get [`Limits::least`] samples, and are then judged; those blocks of pixels
//! that are too noisy go on to twice as many, and so on. A block goes on or stays behind as a whole, and only where all its
//! pixels have the same samples, so what is traced is a function of the scene and the limits alone, not of threads or of
//! the clock.
//!
//! **Bias.** A mean whose number of samples depends on those very samples is not free of bias (Kirk and Arvo, "Unbiased
//! sampling techniques for image synthesis", 1991): a pixel that has missed what is bright and rare looks even, and stops early.
//! Two things keep it small. A picture is judged at few numbers of samples, each twice the last. And a block of 256 pixels
//! decides together: what one of them has missed, its neighbours have found. What is left is far below the noise that was
//! asked for; `tests/halt.rs` measures it.

use super::Shown;
use super::film::{Film, MOST_SAMPLES, Window, most_failing};
use crate::scene::Target;
use std::time::Duration;

/// Samples a pixel at which a noise target is first judged, unless said. From 16 samples too few know how noisy they are:
/// 93 of 100 pixels then lie within twice the error that they state, from these 97.
pub const FIRST_NOISE_SAMPLES: u32 = 64;
/// Samples a pixel at which a noise target is given up, unless said.
pub const MOST_NOISE_SAMPLES: u32 = 1 << 16;

/// Pixels along the side of the blocks that go on or stay behind as a whole.
pub const BLOCK: u32 = super::TILE;

/// When to stop: at the first of these that is reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// So many samples a pixel, from 1 to [`MOST_SAMPLES`].
    pub samples: u32,
    /// So little noise, as a share of white.
    pub noise: Option<f64>,
    /// Samples a pixel before noise is judged, at least 2.
    pub least: u32,
    /// So long a time of tracing.
    pub time: Option<Duration>,
}

/// Which limit was reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Limit {
    /// The samples a pixel.
    Samples,
    /// The noise.
    Noise,
    /// The time.
    Time,
}

impl Limit {
    /// What it is called.
    pub fn word(self) -> &'static str {
        match self {
            Limit::Samples => "samples",
            Limit::Noise => "noise",
            Limit::Time => "time",
        }
    }

    /// The one that is called so.
    pub fn from_word(word: &str) -> Option<Limit> {
        [Limit::Samples, Limit::Noise, Limit::Time].into_iter().find(|limit| limit.word() == word)
    }
}

impl From<Target> for Limits {
    fn from(target: Target) -> Limits {
        let least = FIRST_NOISE_SAMPLES;
        match target {
            Target::Samples(n) => {
                Limits { samples: n.clamp(1, MOST_SAMPLES), noise: None, least, time: None }
            }
            Target::Noise(noise) => {
                Limits { samples: MOST_NOISE_SAMPLES, noise: Some(noise), least, time: None }
            }
        }
    }
}

impl Limits {
    /// The first number of samples, this one or more, at which pixels are judged or done.
    pub fn rung(&self, samples: u32) -> u32 {
        if self.noise.is_none() {
            return self.samples;
        }
        let mut rung = u64::from(self.least.max(2));
        while rung < u64::from(samples) {
            rung *= 2;
        }
        rung.min(u64::from(self.samples)) as u32
    }
}

/// Which of the blocks of a film's window, row by row, are to go on to a noise target; none where it is met.
///
/// Where all but one pixel in a hundred keep it, the target is met. Half of that allowance goes to the blocks in which the
/// fewest pixels fail, so that no effort is spent on lone ones.
pub fn noisy(film: &Film, shown: Shown, wanted: f64) -> Vec<bool> {
    let window = film.window();
    let errors = film.shown_errors(shown.stops, shown.tonemap);
    let failing = |block: &Window| -> usize {
        let rows = block.y..block.y + block.height;
        let fail = |y: u32| {
            let start = window.index(block.x, y);
            errors[start..start + block.width as usize].iter().filter(|error| **error > wanted).count()
        };
        rows.map(fail).sum()
    };
    let failing: Vec<usize> = window.tiles(BLOCK).map(|block| failing(&block)).collect();
    let allowed = most_failing(errors.len());
    let mut noisy = vec![false; failing.len()];
    if failing.iter().sum::<usize>() <= allowed {
        return noisy;
    }
    let mut order: Vec<usize> = (0..failing.len()).collect();
    order.sort_by_key(|block| (failing[*block], *block));
    let mut left_behind = 0;
    for block in order {
        left_behind += failing[block];
        noisy[block] = left_behind > allowed / 2;
    }
    noisy
}

#[cfg(test)]
mod tests {
    use super::super::film::Pixel;
    use super::*;
    use crate::color::Rgb;
    use crate::scene::Tonemap;

    #[test]
    fn rungs_double_up_to_the_most_samples() {
        let limits = Limits { samples: 100, noise: Some(0.01), least: 16, time: None };
        let rungs: Vec<u32> = [0, 16, 17, 33, 65, 100].map(|n| limits.rung(n)).into();
        assert_eq!(rungs, [16, 16, 32, 64, 100, 100]);
        assert_eq!(Limits { noise: None, ..limits }.rung(3), 100);
        let most = Limits { samples: MOST_SAMPLES, least: MOST_SAMPLES, ..limits };
        assert_eq!(most.rung(MOST_SAMPLES), MOST_SAMPLES);
    }

    /// A film in which pixels vary where this says so.
    fn film(size: [u32; 2], varies: impl Fn(u32, u32) -> bool) -> Film {
        let pixel = |x, y| {
            let mut pixel = Pixel::default();
            for sample in 0..16 {
                let value = if varies(x, y) { f64::from(sample % 2) } else { 0.5 };
                pixel.add(Rgb::splat(value), 1024.0);
            }
            pixel
        };
        let pixels = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y)));
        let pixels = pixels.map(|(x, y)| pixel(x, y)).collect();
        Film::with_pixels(Window::whole(size), 1024.0, pixels).expect("as many as there are")
    }

    #[test]
    fn blocks_that_fail_go_on_and_lone_pixels_do_not_hold_the_rest() {
        let shown = Shown { stops: 0.0, tonemap: Tonemap::None };
        // 2400 pixels in 4 × 3 blocks, of which 24 may fail.
        let few = film([60, 40], |x, y| y == 0 && x < 24);
        assert_eq!(noisy(&few, shown, 0.01), [false; 12]);
        let many = film([60, 40], |x, y| (y < 16 && x < 16) || (y == 39 && x == 59));
        let mut expected = [false; 12];
        expected[0] = true;
        assert_eq!(noisy(&many, shown, 0.01), expected);
        let all = film([60, 40], |_, _| true);
        assert_eq!(noisy(&all, shown, 0.01), [true; 12]);
        assert_eq!(noisy(&all, shown, 1.0), [false; 12]);
        let none = Film::new(Window { x: 3, y: 3, width: 0, height: 5 }, 1.0);
        assert!(noisy(&none, shown, 0.01).is_empty());
    }
}
