//! Which paths are traced, and where their light goes.

use super::apart::Sampled;
use super::control::Control;
use super::film::{Pixel, Window};
use super::queue::{Arrived, Job, Jobs};
use crate::color::Rgb;

/// The paths of a tile, pixel by pixel.
pub(super) struct Tile<'a> {
    window: Window,
    samples: std::ops::Range<u32>,
    /// The numbers at which samples are told apart.
    cuts: [u32; 2],
    /// Pixel and sample that come next.
    next: (u32, u32),
    scale: f64,
    unit: f64,
    /// Row by row, one part after the other.
    pub(super) pixels: Vec<Pixel>,
    control: &'a Control,
}

impl Tile<'_> {
    pub(super) fn new(
        window: Window,
        samples: std::ops::Range<u32>,
        cuts: Option<[u32; 2]>,
        (scale, unit): (f64, f64),
        control: &Control,
    ) -> Tile<'_> {
        let parts = if cuts.is_some() { 3 } else { 1 };
        let pixels = vec![Pixel::default(); window.pixels() * parts];
        let cuts = cuts.unwrap_or([u32::MAX; 2]);
        Tile { window, next: (0, samples.start), samples, cuts, scale, unit, pixels, control }
    }
}

impl Jobs for Tile<'_> {
    fn next(&mut self) -> Option<Job> {
        let (pixel, sample) = self.next;
        let pixels = self.window.width * self.window.height;
        if pixel >= pixels {
            return None;
        }
        self.next.1 += 1;
        if self.next.1 >= self.samples.end {
            self.next = (pixel + 1, self.samples.start);
            self.control.rest();
            self.control.finish(u64::from(self.samples.end - self.samples.start));
            if self.control.is_cancelled() {
                self.next.0 = u32::MAX;
            }
        }
        let (x, y) = (pixel % self.window.width, pixel / self.window.width);
        let part = self.cuts.iter().filter(|cut| sample >= **cut).count() as u32;
        let place = part * pixels + pixel;
        Some(Job { x: self.window.x + x, y: self.window.y + y, sample, pixel: place })
    }

    fn finish(&mut self, arrived: &Arrived) {
        let pixel = &mut self.pixels[arrived.pixel as usize];
        let weight = f64::from(arrived.weight);
        pixel.add(weight * self.unit * wide(arrived.radiance), self.scale);
        pixel.cover(arrived.open, weight);
    }
}

/// A row of a first look.
pub(super) struct Glimpse<'a> {
    y: u32,
    step: u32,
    width: u32,
    next: u32,
    /// From the left.
    pub(super) radiance: Vec<Option<Rgb>>,
    unit: f64,
    control: &'a Control,
}

impl Glimpse<'_> {
    /// The row of steps with this number, of a picture of this size.
    pub(super) fn new(
        row: u32,
        step: u32,
        [width, height]: [u32; 2],
        unit: f64,
        control: &Control,
    ) -> Glimpse<'_> {
        let radiance = vec![None; width.div_ceil(step) as usize];
        let y = (row * step + step / 2).min(height - 1);
        Glimpse { y, step, width, next: 0, radiance, unit, control }
    }
}

impl Jobs for Glimpse<'_> {
    fn next(&mut self) -> Option<Job> {
        let pixel = self.next;
        if pixel as usize >= self.radiance.len() || self.control.is_cancelled() {
            return None;
        }
        self.next += 1;
        let x = (pixel * self.step + self.step / 2).min(self.width - 1);
        Some(Job { x, y: self.y, sample: 0, pixel })
    }

    fn finish(&mut self, arrived: &Arrived) {
        let radiance = f64::from(arrived.weight) * self.unit * wide(arrived.radiance);
        self.radiance[arrived.pixel as usize] = (!arrived.open).then_some(radiance);
    }
}

/// One path.
pub(super) struct Single {
    job: Option<Job>,
    unit: f64,
    /// What it brought.
    pub(super) sampled: Sampled,
}

impl Single {
    pub(super) fn new(x: u32, y: u32, sample: u32, unit: f64) -> Single {
        Single { job: Some(Job { x, y, sample, pixel: 0 }), unit, sampled: Sampled::default() }
    }
}

impl Jobs for Single {
    fn next(&mut self) -> Option<Job> {
        self.job.take()
    }

    fn finish(&mut self, arrived: &Arrived) {
        let weight = f64::from(arrived.weight);
        let radiance = weight * self.unit * wide(arrived.radiance);
        self.sampled = Sampled { radiance, weight, open: arrived.open };
    }
}

pub(super) fn wide([r, g, b]: [f32; 3]) -> Rgb {
    Rgb::new(f64::from(r), f64::from(g), f64::from(b))
}
