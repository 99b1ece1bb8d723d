//! A sky that is a picture of all directions, and how to draw directions where it is bright.
//!
//! Each pixel is drawn with the probability of its share of the light: first a row, then a pixel in it, each by
//! inverting a running sum (Pharr, Jakob and Humphreys, *Physically Based Rendering*, 4th ed. 2023, §A.5.2 and
//! §12.5.2). Within a pixel directions are uniform in solid angle, which is exact at the poles too.

use crate::oracle::texture::bilinear;
use rt_lang::asset::Image;
use rt_lang::color::{Rgb, luminance};
use rt_lang::math::{DMat3, DVec2, DVec3, PI, atan2, cos, sin};
use rt_lang::scene::{Panorama, Scene};
use std::sync::Arc;

/// A sky's picture, with its running sums.
pub(super) struct Sky {
    image: Arc<Image>,
    image_from_world: DMat3,
    /// Heights y of the edges of rows on the unit sphere, from the top: one more than there are rows.
    edges: Vec<f64>,
    /// Probability of each row and all above it.
    rows: Vec<f64>,
    /// In each row, the probability of each pixel and all to its left. All 0 in a row without light.
    pixels: Vec<f64>,
    /// The mean over all directions.
    mean: Rgb,
}

impl Sky {
    pub(super) fn new(scene: &Scene, panorama: &Panorama) -> Sky {
        let image = scene.images[panorama.image.0 as usize].clone();
        let (width, height) = (image.width(), image.height());
        let edges: Vec<f64> = (0..=height).map(|row| cos(PI * f64::from(row) / f64::from(height))).collect();
        let mut sky = Sky {
            image,
            image_from_world: panorama.image_from_world,
            edges,
            rows: Vec::with_capacity(height as usize),
            pixels: Vec::with_capacity(width as usize * height as usize),
            mean: Rgb::ZERO,
        };
        let mut total = 0.0;
        for y in 0..height {
            let start = sky.pixels.len();
            let mut sum = 0.0;
            let mut color = Rgb::ZERO;
            for x in 0..width {
                let pixel = sky.pixel_mean(x, y);
                sum += luminance(pixel);
                color += pixel;
                sky.pixels.push(sum);
            }
            normalise(&mut sky.pixels[start..], sum);
            let share = 0.5 * sky.tall(y as usize) / f64::from(width);
            total += sum * share;
            sky.mean += color * share;
            sky.rows.push(total);
        }
        normalise(&mut sky.rows, total);
        sky
    }

    /// The mean of what lies between the pixels, over one of them: the corners of the picture's bilinear surface
    /// count an eighth to each side. So it is 0 only where nothing of it is seen.
    fn pixel_mean(&self, x: u32, y: u32) -> Rgb {
        let (width, height) = (self.image.width(), self.image.height());
        let (left, right) = ((x + width - 1) % width, (x + 1) % width);
        let (above, below) = (y.saturating_sub(1), (y + 1).min(height - 1));
        let line = |y: u32| {
            let pixel = |x: u32| self.image.pixel(x, y);
            0.125 * (pixel(left) + pixel(right)) + 0.75 * pixel(x)
        };
        0.125 * (line(above) + line(below)) + 0.75 * line(y)
    }

    /// The mean over all directions, to choose between lights by.
    pub(super) fn mean(&self) -> Rgb {
        self.mean
    }

    /// The greatest channel.
    pub(super) fn peak(&self) -> f64 {
        self.image.peak()
    }

    /// What is seen in a direction.
    pub(super) fn seen(&self, w: DVec3) -> Rgb {
        let local = self.image_from_world * w;
        let latitude = atan2(local.y, (local.x * local.x + local.z * local.z).sqrt());
        bilinear(&self.image, DVec2::new(across(local), 0.5 + latitude / PI), false)
    }

    /// A direction, with its density in solid angle.
    pub(super) fn sample(&self, u: [f64; 2]) -> (DVec3, f64) {
        let width = self.image.width() as usize;
        let (row, down) = pick(&self.rows, u[0]);
        let (column, right) = pick(&self.pixels[row * width..(row + 1) * width], u[1]);
        let y = self.edges[row] + down * (self.edges[row + 1] - self.edges[row]);
        let radius = (1.0 - y * y).max(0.0).sqrt();
        let angle = 2.0 * PI * ((column as f64 + right) / width as f64 - 0.5);
        let local = DVec3::new(radius * sin(angle), y, -radius * cos(angle));
        (self.image_from_world.transpose() * local, self.density(row, column))
    }

    /// Density of [`Sky::sample`] in solid angle.
    pub(super) fn pdf(&self, w: DVec3) -> f64 {
        let local = self.image_from_world * w;
        let (width, height) = (self.image.width() as usize, self.rows.len());
        let row = self.edges[1..height].partition_point(|edge| *edge > local.y);
        let column = ((across(local) * width as f64) as usize).min(width - 1);
        self.density(row, column)
    }

    fn density(&self, row: usize, column: usize) -> f64 {
        let width = self.image.width() as usize;
        let chance = share(&self.rows, row) * share(&self.pixels[row * width..(row + 1) * width], column);
        chance * width as f64 / (2.0 * PI * self.tall(row))
    }

    /// By how much a row is tall on the unit sphere; its solid angle is 2π times that.
    fn tall(&self, row: usize) -> f64 {
        self.edges[row] - self.edges[row + 1]
    }
}

/// How far right a direction of the picture's space lies in it, in [0, 1].
fn across(local: DVec3) -> f64 {
    0.5 + atan2(local.x, -local.z) / (2.0 * PI)
}

fn normalise(sums: &mut [f64], total: f64) {
    if total > 0.0 {
        sums.iter_mut().for_each(|sum| *sum /= total);
    }
}

/// What an entry adds to a running sum.
fn share(sums: &[f64], index: usize) -> f64 {
    sums[index] - if index == 0 { 0.0 } else { sums[index - 1] }
}

/// The entry of a running sum that a uniform number falls on, and where within it, in [0, 1].
fn pick(sums: &[f64], u: f64) -> (usize, f64) {
    let index = sums.partition_point(|sum| *sum <= u).min(sums.len() - 1);
    let before = if index == 0 { 0.0 } else { sums[index - 1] };
    (index, ((u - before) / share(sums, index)).clamp(0.0, 1.0))
}
