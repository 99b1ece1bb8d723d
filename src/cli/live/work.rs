//! Which samples are traced next.
//!
//! Every pixel gets one sample, then two, four and so on to the target, block by block: those of the window that is
//! wanted first go ahead to the target, the others follow. In what order samples come makes no difference to their sums.

use rt_lang::render::{PASS, Window};
use std::ops::Range;
use std::time::Duration;

/// Pixels along the side of a block.
const BLOCK: u32 = 64;
/// How long a step may take: what is new is shown that often.
const STEP: Duration = Duration::from_millis(150);
/// Samples that the first step takes to learn how long they take.
const FIRST: f64 = 250_000.0;

/// The blocks of a picture, with the samples that each has.
#[derive(Clone, Debug)]
pub struct Work {
    blocks: Vec<(Window, u32)>,
    /// Those that have enough samples, if not all are to have the same.
    behind: Vec<bool>,
    /// Samples a second, once that is known.
    rate: Option<f64>,
}

/// Samples to take together.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    chosen: Vec<usize>,
    /// Where.
    pub windows: Vec<Window>,
    /// Which.
    pub samples: Range<u32>,
}

impl Work {
    /// All that is to be done of a picture.
    pub fn new(size: [u32; 2]) -> Work {
        let blocks: Vec<_> = Window::whole(size).tiles(BLOCK).map(|window| (window, 0)).collect();
        Work { behind: vec![false; blocks.len()], blocks, rate: None }
    }

    /// Only some of the picture goes on, once every pixel that was to go on has its samples: these windows, which tile it,
    /// and whether they do.
    pub fn refine(&mut self, windows: impl Iterator<Item = Window>, goes_on: &[bool]) {
        if self.blocks.len() != goes_on.len() {
            let [samples, _] = self.samples();
            self.blocks = windows.map(|window| (window, samples)).collect();
        }
        self.behind = goes_on.iter().map(|goes_on| !goes_on).collect();
    }

    /// All of the picture goes on.
    pub fn refine_all(&mut self) {
        self.behind.fill(false);
    }

    /// The least and the most samples of a pixel.
    pub fn samples(&self) -> [u32; 2] {
        let samples = || self.blocks.iter().map(|(_, samples)| *samples);
        [samples().min().unwrap_or(0), samples().max().unwrap_or(0)]
    }

    /// The next step on the way to a target; none where every pixel has reached it.
    pub fn next(&self, target: u32, first: Option<Window>) -> Option<Step> {
        let wanted = |window: &Window| first.is_some_and(|first| overlap(&first, window));
        let open = |ahead: bool| {
            let blocks = self.blocks.iter().enumerate().filter(|(index, _)| !self.behind[*index]);
            blocks.filter(move |(_, (window, samples))| *samples < target && wanted(window) == ahead)
        };
        let ahead = open(true).next().is_some();
        let from = open(ahead).map(|(_, (_, samples))| *samples).min()?;
        let goal = level_above(from).min(target);
        let samples = from..goal.min(from + PASS);
        let most = (self.rate.map_or(FIRST, |rate| rate * STEP.as_secs_f64())) as u64;
        let mut count = 0;
        let (mut chosen, mut windows) = (vec![], vec![]);
        for (index, (window, _)) in open(ahead).filter(|(_, (_, samples))| *samples == from) {
            count += window.pixels() as u64 * u64::from(samples.end - samples.start);
            if count > most && !chosen.is_empty() {
                break;
            }
            chosen.push(index);
            windows.push(*window);
        }
        Some(Step { chosen, windows, samples })
    }

    /// A step was taken, and took so long.
    pub fn done(&mut self, step: &Step, time: Duration) {
        for &index in &step.chosen {
            self.blocks[index].1 = step.samples.end;
        }
        let pixels: usize = step.windows.iter().map(Window::pixels).sum();
        let rate = (pixels * step.samples.len()) as f64 / time.as_secs_f64().max(1e-6);
        self.rate = Some(self.rate.map_or(rate, |before| 0.5 * (before + rate)));
    }

    /// The samples that all pixels have that have a part of a level: 0, 1, 2, 4, … up to the target.
    pub fn level(&self, target: u32) -> u32 {
        let least = self.going_on().map(|(_, samples)| *samples).min().unwrap_or(target);
        if least >= target || least == 0 { least.min(target) } else { 1 << least.ilog2() }
    }

    fn going_on(&self) -> impl Iterator<Item = &(Window, u32)> {
        self.blocks.iter().zip(&self.behind).filter(|(_, behind)| !**behind).map(|(block, _)| block)
    }

    /// How long it will take to a target, if that can be told.
    pub fn left(&self, target: u32) -> Option<Duration> {
        let missing = |(window, samples): &(Window, u32)| {
            window.pixels() as f64 * f64::from(target.saturating_sub(*samples))
        };
        let missing: f64 = self.going_on().map(missing).sum();
        self.rate.map(|rate| Duration::from_secs_f64((missing / rate.max(1.0)).min(1e9)))
    }
}

/// The power of two above a number of samples.
fn level_above(samples: u32) -> u32 {
    if samples == 0 { 1 } else { 2 << samples.ilog2() }
}

fn overlap(a: &Window, b: &Window) -> bool {
    let meet = |a: u32, a_length: u32, b: u32, b_length: u32| a < b + b_length && b < a + a_length;
    meet(a.x, a.width, b.x, b.width) && meet(a.y, a.height, b.y, b.height)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Takes all steps, and counts how often each pixel got each sample.
    fn all_steps(size: [u32; 2], target: u32, first: Option<Window>) -> (Vec<Step>, Vec<Vec<u32>>) {
        let mut work = Work::new(size);
        let mut counts = vec![vec![0; target as usize]; (size[0] * size[1]) as usize];
        let mut steps = vec![];
        while let Some(step) = work.next(target, first) {
            for window in &step.windows {
                for (x, y) in (0..window.height).flat_map(|y| (0..window.width).map(move |x| (x, y))) {
                    let pixel = &mut counts[((window.y + y) * size[0] + window.x + x) as usize];
                    step.samples.clone().for_each(|sample| pixel[sample as usize] += 1);
                }
            }
            work.done(&step, Duration::from_millis(10));
            steps.push(step);
        }
        assert_eq!(work.samples(), [target; 2]);
        assert_eq!(work.left(target), Some(Duration::ZERO));
        (steps, counts)
    }

    #[test]
    fn every_pixel_gets_every_sample_once() {
        for (size, target) in [([200, 100], 1), ([64, 64], 5), ([1, 1], 300), ([130, 65], 64)] {
            for first in [None, Some(Window { x: 0, y: 0, width: 1, height: 1 })] {
                let (_, counts) = all_steps(size, target, first);
                assert!(counts.iter().flatten().all(|&count| count == 1), "{size:?} {target}");
            }
        }
    }

    #[test]
    fn samples_double() {
        let (steps, _) = all_steps([64, 64], 100, None);
        let samples: Vec<_> = steps.iter().map(|step| step.samples.clone()).collect();
        assert_eq!(samples, [0..1, 1..2, 2..4, 4..8, 8..16, 16..32, 32..64, 64..100]);
    }

    #[test]
    fn what_has_enough_samples_stays_behind() {
        let mut work = Work::new([64, 64]);
        while let Some(step) = work.next(16, None) {
            work.done(&step, Duration::from_millis(10));
        }
        let tiles = || Window::whole([64, 64]).tiles(32);
        work.refine(tiles(), &[false, true, false, false]);
        let step = work.next(32, None).unwrap();
        assert_eq!(step.windows, [Window { x: 32, y: 0, width: 32, height: 32 }]);
        work.done(&step, Duration::from_millis(10));
        assert_eq!((work.samples(), work.level(32), work.next(32, None)), ([16, 32], 32, None));
        // What was left behind catches up.
        work.refine(tiles(), &[true, false, false, false]);
        assert_eq!(work.next(64, None).unwrap().samples, 16..32);
        work.refine_all();
        assert_eq!(work.next(64, None).unwrap().windows.len(), 3);
    }

    #[test]
    fn a_window_goes_ahead() {
        let window = Window { x: 100, y: 10, width: 10, height: 10 };
        let (steps, _) = all_steps([200, 100], 16, Some(window));
        let last_of_window = steps.iter().rposition(|step| step.windows.iter().any(|w| overlap(w, &window)));
        let first_of_rest = steps.iter().position(|step| !step.windows.iter().any(|w| overlap(w, &window)));
        assert!(last_of_window < first_of_rest);
    }

    #[test]
    fn levels_are_those_that_every_pixel_has() {
        let mut work = Work::new([200, 64]);
        assert_eq!(work.level(100), 0);
        let step = work.next(100, None).unwrap();
        work.done(&step, Duration::from_secs(1));
        assert_eq!((work.level(100), work.level(1)), (1, 1));
    }
}
