//! A picture in the making: which samples it has, which it gets next, and going on with it.
//!
//! In what order samples come makes no difference to their sums, so a picture that is put aside and gone on with has the bits
//! of one that was made at once.

use super::control::{Cancelled, Control};
use super::film::{Film, LIGHT_WORDS, LightSums, Window};
use super::halt::{BLOCK, Limit, Limits, noisy};
use super::sums::{self, Sums};
use super::{PASS, Prepass, Rendered, Shown, Tracer};
use std::ops::Range;
use std::time::{Duration, Instant};

/// How long a step may take: work that is not yet in the film is lost where it is cancelled.
const STEP: Duration = Duration::from_millis(500);
/// Passes over the picture for which there is to be time, where it is limited.
const LAST_PASSES: u64 = 8;
/// Paths of a first step, after which it is known how long they take.
const FIRST_PATHS: u64 = 1 << 19;

/// Samples that a picture has, and what it is on the way to.
#[derive(Clone, Debug, PartialEq)]
pub struct Making {
    film: Film,
    /// What the film's light was at two numbers of samples, for who asks: see [`Making::in_halves`].
    early: Option<[Vec<LightSums>; 2]>,
    /// The number of each pixel's first sample.
    start: u32,
    /// How what is shown was when it was last judged where samples go, if it was.
    judged: Option<Shown>,
    /// Those of the film's window, row by row.
    blocks: Vec<Block>,
}

/// Pixels that have the same samples.
#[derive(Clone, Debug, PartialEq)]
struct Block {
    window: Window,
    /// How many each has.
    samples: u32,
    /// How many each is to have.
    aim: u32,
}

/// Samples to take together.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    blocks: Vec<usize>,
    windows: Vec<Window>,
    /// Which, by their numbers.
    samples: Range<u32>,
}

impl Making {
    /// A picture without samples.
    pub fn new(window: Window, scale: f64) -> Making {
        Making::from_sample(window, scale, 0)
    }

    /// The same of a share of the samples, from this one on.
    pub fn from_sample(window: Window, scale: f64, start: u32) -> Making {
        let blocks = window.tiles(BLOCK).map(|window| Block { window, samples: 0, aim: 0 }).collect();
        Making { film: Film::new(window, scale), early: None, start, judged: None, blocks }
    }

    /// The same of a picture without samples, with the sums of the first ones kept apart too: two pictures of the same light
    /// tell noise from what is there. Each pixel's last power of two samples is kept, and the one before it, of which one is
    /// from a third to two thirds of all, whenever the picture stops. Every other sample would tell too much noise: neighbours
    /// in the sequence are each other's opposites. It takes two thirds as much memory again.
    pub fn in_halves(self) -> Making {
        let none = vec![LightSums::default(); self.film.pixels().len()];
        Making { early: Some([none.clone(), none]), ..self }
    }

    /// The same with what [`Making::early`] was, by what gives the words of each. None where its first samples cannot be so.
    pub fn with_early(self, words: impl Fn(usize, usize) -> Option<[u32; LIGHT_WORDS]>) -> Option<Making> {
        Some(Making { early: Some(sums::early(&self.film, words)?), ..self })
    }

    /// One that was put aside: its film, the number of its first sample, what each pixel was on the way to, row by row, and by
    /// what it was judged. None where pixels of a block differ, or have more than they were to have.
    pub fn resumed(film: Film, start: u32, aims: &[u32], judged: Option<Shown>) -> Option<Making> {
        let window = film.window();
        let block = |window_of: Window| {
            let mut pixels = (window_of.y..window_of.y + window_of.height)
                .flat_map(|y| (window_of.x..window_of.x + window_of.width).map(move |x| (x, y)))
                .map(|(x, y)| (film.samples(x, y), aims.get(window.index(x, y)).copied()));
            let (samples, aim) = pixels.next()?;
            let alike = pixels.all(|other| other == (samples, aim));
            let aim = aim.filter(|aim| alike && *aim >= samples)?;
            Some(Block { window: window_of, samples, aim })
        };
        let blocks = window.tiles(BLOCK).map(block).collect::<Option<Vec<Block>>>()?;
        Some(Making { film, early: None, start, judged, blocks })
    }

    /// Its sums.
    pub fn film(&self) -> &Film {
        &self.film
    }

    /// Whether the first samples are kept apart.
    pub fn is_in_halves(&self) -> bool {
        self.early.is_some()
    }

    /// The light of each pixel's first samples: of half the last power of two of them, and of that. None unless [`Making::in_halves`].
    pub fn early(&self) -> Option<&[Vec<LightSums>; 2]> {
        self.early.as_ref()
    }

    /// The light of each pixel's first samples, about half of them, and of the others; none unless [`Making::in_halves`].
    pub fn halves(&self) -> Option<[Vec<LightSums>; 2]> {
        sums::halved(&self.film, self.early()?)
    }

    /// Its sums, and nothing else.
    pub fn into_film(self) -> Film {
        self.film
    }

    /// The number of each pixel's first sample.
    pub fn start(&self) -> u32 {
        self.start
    }

    /// How the picture was to be shown when a noise target last decided where samples go; none where none did.
    pub fn judged(&self) -> Option<Shown> {
        self.judged
    }

    /// How many samples each pixel is to have, row by row.
    pub fn aims(&self) -> Vec<u32> {
        let window = self.film.window();
        let mut aims = vec![0; window.pixels()];
        for Block { window: block, aim, .. } in &self.blocks {
            for y in block.y..block.y + block.height {
                let start = window.index(block.x, y);
                aims[start..start + block.width as usize].fill(*aim);
            }
        }
        aims
    }

    /// The least and the most samples of a pixel.
    pub fn samples(&self) -> [u32; 2] {
        let samples = || self.blocks.iter().map(|block| block.samples);
        [samples().min().unwrap_or(0), samples().max().unwrap_or(0)]
    }

    /// Whether all pixels have as many samples, and are to have as many.
    pub fn is_even(&self) -> bool {
        self.blocks.windows(2).all(|pair| (pair[0].samples, pair[0].aim) == (pair[1].samples, pair[1].aim))
    }

    /// The mean number of samples of a pixel.
    pub fn mean_samples(&self) -> f64 {
        self.paths_done() as f64 / self.film.window().pixels().max(1) as f64
    }

    /// What it is when it stops here.
    pub fn rendered(self, limits: &Limits, limit: Limit, shown: Shown) -> Rendered {
        let [_, samples] = self.samples();
        let noise = self.film.noise(shown.stops, shown.tonemap);
        let target_met = limits.noise.is_none_or(|wanted| noise <= wanted);
        Rendered { samples, mean_samples: self.mean_samples(), noise, limit, target_met, film: self.film }
    }

    fn paths_done(&self) -> u64 {
        self.blocks.iter().map(|block| block.window.pixels() as u64 * u64::from(block.samples)).sum()
    }

    /// Paths to trace if no block gets more than so many samples.
    fn paths_to(&self, most: u32) -> u64 {
        let missing = |block: &Block| u64::from(block.aim.min(most).saturating_sub(block.samples));
        self.blocks.iter().map(|block| block.window.pixels() as u64 * missing(block)).sum()
    }

    /// The next samples to take, about so many paths and so many samples a pixel at most; none where every block has what it is to have.
    fn next(&self, paths: u64, pass: u32) -> Option<Step> {
        let open = || self.blocks.iter().enumerate().filter(|(_, block)| block.samples < block.aim);
        let from = open().map(|(_, block)| block.samples).min()?;
        let alike = || open().filter(|(_, block)| block.samples == from);
        // Blocks that are to have fewer than others are done first.
        let aim = alike().map(|(_, block)| block.aim).min()?;
        let to = aim.min(from + pass.clamp(1, PASS));
        let (mut count, mut blocks, mut windows) = (0, vec![], vec![]);
        for (index, block) in alike() {
            count += block.window.pixels() as u64 * u64::from(to - from);
            if count > paths && !blocks.is_empty() {
                break;
            }
            blocks.push(index);
            windows.push(block.window);
        }
        Some(Step { blocks, windows, samples: self.start + from..self.start + to })
    }

    fn taken(&mut self, step: &Step) {
        for &index in &step.blocks {
            self.blocks[index].samples = step.samples.end - self.start;
        }
    }

    /// Aims for the next number of samples at which pixels are judged, or says which limit is reached. Where blocks lack samples
    /// they were to have, they get these first.
    fn go_on(&mut self, limits: &Limits, shown: Shown) -> Option<Limit> {
        let [least, most] = self.samples();
        let Some(wanted) = limits.noise else {
            let goal = limits.rung(most);
            self.blocks.iter_mut().for_each(|block| block.aim = goal.max(block.samples));
            return (least >= goal).then_some(Limit::Samples);
        };
        if self.judged.is_none() && most >= limits.rung(0) {
            // Of a picture that was to have so many samples: how many these were says nothing of noise.
            self.blocks.iter_mut().for_each(|block| block.aim = most);
            if least < most {
                return None;
            }
            if most > limits.rung(0) {
                // They are judged as they are. If they do, no more is decided.
                if !noisy(&self.film, shown, wanted).contains(&true) {
                    return Some(Limit::Noise);
                }
                self.judged = Some(shown);
            }
        }
        let is_open = |block: &Block| block.samples < block.aim;
        let unjudged = most < limits.rung(0);
        let aim = self.blocks.iter().filter(|block| is_open(block)).map(|block| block.aim).max();
        // What was under way is ended: blocks that had stayed behind may have fewer samples yet than there were when it began.
        let goal = limits.rung(if unjudged { most } else { aim.map_or(most, |aim| aim.max(most)) });
        if unjudged || aim.is_some() {
            // Put aside on the way, so those go on that were going on.
            let goes_on = |block: &&mut Block| unjudged || is_open(block);
            self.blocks.iter_mut().filter(goes_on).for_each(|block| block.aim = goal.max(block.samples));
            return None;
        }
        if most > 0 && most < goal {
            // Cut short by time.
            self.blocks.iter_mut().filter(|block| block.samples == most).for_each(|block| block.aim = goal);
            return None;
        }
        self.judged = Some(shown);
        let noisy = noisy(&self.film, shown, wanted);
        if !noisy.contains(&true) {
            return Some(Limit::Noise);
        }
        if most >= limits.samples {
            return Some(Limit::Samples);
        }
        let goal = limits.rung(most + 1);
        for (block, noisy) in self.blocks.iter_mut().zip(noisy) {
            block.aim = if noisy { goal } else { block.samples };
        }
        None
    }

    /// How many samples every pixel gets, however little time there is: one in each half.
    fn least(&self) -> u32 {
        if self.is_in_halves() { 2 } else { 1 }
    }

    /// The same on the way: aims for no more samples than so many paths give, or than some pixels have already, for all that are
    /// going on are to get as many.
    fn slow_down(&mut self, paths: u64) {
        let open = || self.blocks.iter().filter(|block| block.samples < block.aim);
        let goal = open().map(|block| block.aim).max().unwrap_or(0);
        // Those of the rung that are done with it.
        let [_, most] = self.samples();
        let (mut low, mut high) = (most.max(self.least()).min(goal), goal);
        while low < high {
            let middle = low + (high - low).div_ceil(2);
            if self.paths_to(middle) <= paths { low = middle } else { high = middle - 1 }
        }
        self.blocks.iter_mut().for_each(|block| block.aim = block.aim.min(low.max(block.samples)));
    }

    /// Aims for no more samples than so many paths give, or says that not even one more fits. Where it is not known how many
    /// paths there is time for, for one more.
    fn cut_short(&mut self, paths: Option<u64>) -> Option<Limit> {
        let [_, most] = self.samples();
        let goal = self.blocks.iter().map(|block| block.aim).max().unwrap_or(0);
        // One sample is made to know how long it takes.
        let fits =
            |aim: u32| paths.map_or(aim == most + 1, |paths| aim <= most || self.paths_to(aim) <= paths);
        if goal > most && most >= self.least() && !fits(most + 1) {
            return Some(Limit::Time);
        }
        let (mut low, mut high) = (goal.min(most + 1), goal);
        while low < high {
            let middle = low + (high - low).div_ceil(2);
            if fits(middle) { low = middle } else { high = middle - 1 }
        }
        self.blocks.iter_mut().for_each(|block| block.aim = block.aim.min(low.max(block.samples)));
        None
    }
}

/// How fast paths are traced.
struct Pace {
    start: Instant,
    paused: Duration,
    rate: Option<f64>,
}

impl Pace {
    fn start(control: &Control) -> Pace {
        Pace { start: Instant::now(), paused: control.paused_for(), rate: None }
    }

    fn elapsed(&self, control: &Control) -> Duration {
        self.start.elapsed().saturating_sub(control.paused_for().saturating_sub(self.paused))
    }

    /// So many paths took so long.
    fn took(&mut self, paths: u64, time: Duration) {
        let rate = paths as f64 / time.as_secs_f64().max(1e-6);
        self.rate = Some(self.rate.map_or(rate, |before| 0.5 * (before + rate)));
    }

    /// How many fit in a time; none where that is not known.
    fn fit(&self, time: Duration) -> Option<u64> {
        self.rate.map(|rate| (rate * time.as_secs_f64()) as u64)
    }
}

impl Tracer<'_> {
    /// Traces a window of the picture on the current rayon pool until a limit is reached.
    ///
    /// A noise target is judged on the window, so a crop may stop at another number of samples than the whole.
    ///
    /// # Errors
    ///
    /// If the control cancels.
    pub fn render(
        &self,
        window: Window,
        limits: impl Into<Limits>,
        prepass: &Prepass,
        shown: Shown,
        control: &Control,
    ) -> Result<Rendered, Cancelled> {
        let limits = limits.into();
        let mut making = Making::new(window, prepass.scale);
        let limit = self.go_on(&mut making, &limits, shown, control, &mut |_| {})?;
        Ok(making.rendered(&limits, limit, shown))
    }

    /// Goes on with a picture until a limit is reached, and tells `between` after every step of about half a second.
    ///
    /// # Errors
    ///
    /// If the control cancels; the picture then has the samples of all steps that were done.
    pub fn go_on(
        &self,
        making: &mut Making,
        limits: &Limits,
        shown: Shown,
        control: &Control,
        between: &mut dyn FnMut(&Making),
    ) -> Result<Limit, Cancelled> {
        let mut pace = Pace::start(control);
        let done = making.paths_done();
        control.plan(done);
        control.finish(done);
        loop {
            if let Some(limit) = making.go_on(limits, shown) {
                return Ok(limit);
            }
            if let Some(time) = limits.time {
                let left = time.saturating_sub(pace.elapsed(control));
                if let Some(limit) = making.cut_short(pace.fit(left)) {
                    return Ok(limit);
                }
            }
            control.plan(making.paths_to(u32::MAX));
            let left = |pace: &Pace| limits.time.map(|time| time.saturating_sub(pace.elapsed(control)));
            let pixels = making.film.window().pixels().max(1) as u64;
            loop {
                // What is begun with some pixels is to be ended with the others, so there are short passes where time is.
                let fits = left(&pace).and_then(|left| pace.fit(left));
                let pass =
                    fits.map_or(PASS, |paths| (paths / (LAST_PASSES * pixels)).min(u64::from(PASS)) as u32);
                let Some(step) = making.next(pace.fit(STEP).unwrap_or(FIRST_PATHS), pass) else { break };
                let start = pace.elapsed(control);
                let sums = Sums { film: &mut making.film, early: making.early.as_mut() };
                self.trace_step(sums, &step.windows, step.samples.clone(), control)?;
                making.taken(&step);
                let pixels: usize = step.windows.iter().map(Window::pixels).sum();
                let time = pace.elapsed(control).saturating_sub(start);
                pace.took(pixels as u64 * step.samples.len() as u64, time);
                between(making);
                if let Some(paths) = left(&pace).and_then(|left| pace.fit(left)) {
                    making.slow_down(paths);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests;
