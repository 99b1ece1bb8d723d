//! From pixels to rays.

use super::sampler::{Pair, Sampler};
use super::shape::Ray;
use super::warp;
use crate::math::{DVec2, exp};
use crate::scene::{Camera, Filter, Projection, Scene};

/// Makes the rays of camera paths.
pub struct Eye<'s> {
    camera: &'s Camera,
    kernel: Kernel,
}

impl<'s> Eye<'s> {
    /// The eye behind a scene's camera, with the filter that it names.
    pub fn new(scene: &'s Scene) -> Eye<'s> {
        Eye { camera: &scene.camera, kernel: Kernel::new(scene.trace.filter) }
    }

    /// The ray of one sample of a pixel of a picture with this many columns and rows, and the weight that its
    /// radiance has in the pixel. A sample belongs to one pixel: its place is drawn from the filter around that
    /// pixel's centre, so a pixel does not depend on its neighbours.
    pub fn ray(&self, x: u32, y: u32, size: [u32; 2], sampler: &Sampler) -> (Ray, f64) {
        let (offset, weight) = self.kernel.sample(sampler.pair(Pair::Film));
        let place = DVec2::new(f64::from(x), f64::from(y)) + 0.5 + offset;
        let size = DVec2::new(f64::from(size[0]), f64::from(size[1]));
        let share = 2.0 * place / size - 1.0;
        (self.through(share, sampler), weight)
    }

    /// The ray through a place of the picture, given from −1 to 1 rightwards and downwards.
    pub fn through(&self, share: DVec2, sampler: &Sampler) -> Ray {
        let camera = self.camera;
        let extent = share * camera.half_extent;
        let across = extent.x * camera.right - extent.y * camera.up;
        if camera.projection == Projection::Orthographic {
            return Ray { origin: camera.position + across, direction: camera.forward, start: None };
        }
        let pinhole = camera.forward + across;
        if camera.lens_radius == 0.0 {
            return Ray { origin: camera.position, direction: pinhole.normalize(), start: None };
        }
        // Every ray through the lens goes on to where the one through its centre meets the plane of focus.
        let lens = camera.lens_radius * warp::disc(sampler.pair(Pair::Lens));
        let shift = lens.x * camera.right + lens.y * camera.up;
        // Scaled such that neither a near nor a far focus leaves the range of numbers.
        let (near, far) = (camera.focus.min(1.0), camera.focus.max(1.0));
        let direction = (near * pinhole - shift / far).normalize();
        Ray { origin: camera.position + shift, direction, start: None }
    }
}

/// A reconstruction filter, the same in both directions, to draw places from: a staircase of cells that hold the
/// exact mass of the filter.
struct Kernel {
    radius: f64,
    /// Mass of |filter| up to the end of each cell; the last is 1.
    cumulative: Vec<f64>,
    /// Signs of the cells, times what |filter| holds more than the filter.
    weights: Vec<f64>,
}

/// Cells in a kernel. Even, so that the centre is a border.
const CELLS: usize = 512;

impl Kernel {
    fn new(filter: Filter) -> Kernel {
        let radius = radius(filter);
        let cell = |i: usize| radius * (2.0 * i as f64 / CELLS as f64 - 1.0);
        let masses: Vec<f64> = (0..CELLS).map(|i| integral(filter, cell(i), cell(i + 1))).collect();
        let total: f64 = masses.iter().sum();
        let magnitude: f64 = masses.iter().map(|mass| mass.abs()).sum();
        let mut sum = 0.0;
        let mut cumulative: Vec<f64> = masses
            .iter()
            .map(|mass| {
                sum += mass.abs() / magnitude;
                sum
            })
            .collect();
        cumulative[CELLS - 1] = 1.0;
        let weights = masses.iter().map(|mass| (magnitude / total).copysign(*mass)).collect();
        Kernel { radius, cumulative, weights }
    }

    /// A place relative to the pixel's centre, in pixels, and its weight.
    fn sample(&self, u: [f64; 2]) -> (DVec2, f64) {
        let [(x, wx), (y, wy)] = u.map(|u| self.sample_axis(u));
        (DVec2::new(x, y), wx * wy)
    }

    fn sample_axis(&self, u: f64) -> (f64, f64) {
        let cell = self.cumulative.partition_point(|&end| end <= u).min(CELLS - 1);
        let start = if cell == 0 { 0.0 } else { self.cumulative[cell - 1] };
        let within = (u - start) / (self.cumulative[cell] - start);
        (self.radius * (2.0 * (cell as f64 + within) / CELLS as f64 - 1.0), self.weights[cell])
    }
}

/// Distance from the centre beyond which a filter is zero, in pixels.
fn radius(filter: Filter) -> f64 {
    match filter {
        Filter::Box => 0.5,
        Filter::Tent => 1.0,
        Filter::Gaussian => 1.5,
        Filter::Mitchell => 2.0,
    }
}

/// The filter along one axis, by the distance from the centre in pixels; not normalised.
fn value(filter: Filter, x: f64) -> f64 {
    let x = x.abs();
    match filter {
        Filter::Box => 1.0,
        Filter::Tent => 1.0 - x,
        // Standard deviation 1/2.
        Filter::Gaussian => exp(-2.0 * x * x),
        // B = C = 1/3 (Mitchell and Netravali, "Reconstruction filters in computer graphics", 1988, eq. 8).
        Filter::Mitchell if x < 1.0 => (7.0 * x - 12.0) * x * x + 16.0 / 3.0,
        Filter::Mitchell => ((12.0 - 7.0 / 3.0 * x) * x - 20.0) * x + 32.0 / 3.0,
    }
}

/// Of the filter over a cell, by Simpson's rule: exact for all but the bell.
fn integral(filter: Filter, from: f64, to: f64) -> f64 {
    let middle = 0.5 * (from + to);
    (to - from) / 6.0 * (value(filter, from) + 4.0 * value(filter, middle) + value(filter, to))
}
