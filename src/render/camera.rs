//! From pixels to rays.

use super::lanes::{Float, Lanes, Word};
use super::sampler::{Pair, Sampler};
use super::space::Space;
use super::vector::{V, single};
use super::warp;
use crate::math::exp;
use crate::scene::{Camera, Filter, Projection, Scene};

/// Makes the rays of camera paths.
pub struct Eye {
    right: [f32; 3],
    up: [f32; 3],
    forward: [f32; 3],
    /// Centre of the picture in pixels, and half its extents a pixel.
    center: [f32; 2],
    step: [f32; 2],
    orthographic: bool,
    lens_radius: f32,
    focus: f32,
    filter: Filter,
    kernel: Kernel,
}

/// Rays of camera paths.
#[derive(Clone, Copy)]
pub struct EyeRays<L: Lanes> {
    /// Where it starts.
    pub o: V<L>,
    /// Unit vector.
    pub d: V<L>,
    /// The weight that its radiance has in the pixel.
    pub weight: L::F,
}

impl Eye {
    /// The eye behind a scene's camera, with the filter that it names.
    pub fn new(scene: &Scene, space: &Space) -> Eye {
        Eye::with(&scene.camera, scene.trace.size, scene.trace.filter, space)
    }

    /// The eye behind a camera, for a picture with this many columns and rows.
    pub fn with(camera: &Camera, size: [u32; 2], filter: Filter, space: &Space) -> Eye {
        let Camera { right, up, forward, lens_radius, focus, .. } = *camera;
        let orthographic = camera.projection == Projection::Orthographic;
        let half_extent = if orthographic { camera.half_extent / space.unit() } else { camera.half_extent };
        let [width, height] = size.map(f64::from);
        Eye {
            right: single(right),
            up: single(up),
            forward: single(forward),
            center: [0.5 * width as f32, 0.5 * height as f32],
            step: [(2.0 * half_extent.x / width) as f32, (2.0 * half_extent.y / height) as f32],
            orthographic,
            lens_radius: space.length(lens_radius) as f32,
            focus: space.length(focus) as f32,
            filter,
            kernel: Kernel::new(filter),
        }
    }

    /// The rays of samples of pixels of the picture. A sample belongs to one pixel: its place is drawn from the
    /// filter around that pixel's centre, so a pixel does not depend on its neighbours.
    #[inline(always)]
    pub fn rays<L: Lanes>(&self, l: L, x: L::U, y: L::U, sampler: &Sampler<L>) -> EyeRays<L> {
        let [u, v] = sampler.pair(l, Pair::Film, l.u(0));
        let (offset, weight) = self.kernel.sample(l, self.filter, [u, v]);
        // From the centre: no digits are lost on the pixel's number.
        let x = (x.count() - self.center[0] + 0.5 + offset[0]) * self.step[0];
        let y = (y.count() - self.center[1] + 0.5 + offset[1]) * self.step[1];
        self.through(l, [x, y], weight, sampler)
    }

    #[inline(always)]
    fn through<L: Lanes>(&self, l: L, [x, y]: [L::F; 2], weight: L::F, sampler: &Sampler<L>) -> EyeRays<L> {
        let (right, up) = (V::splat(l, self.right), V::splat(l, self.up));
        let across = right * x - up * y;
        if self.orthographic {
            return EyeRays { o: across, d: V::splat(l, self.forward), weight };
        }
        let pinhole = V::splat(l, self.forward) + across;
        if self.lens_radius == 0.0 {
            return EyeRays { o: V::all(l.f(0.0)), d: pinhole.normalized(l), weight };
        }
        // Every ray through the lens goes on to where the one through its centre meets the plane of focus.
        let [u, v] = warp::disc(l, sampler.pair(l, Pair::Lens, l.u(0)));
        let shift = right * (u * self.lens_radius) + up * (v * self.lens_radius);
        // Scaled such that neither a near nor a far focus leaves the range of numbers.
        let (near, far) = (self.focus.min(1.0), self.focus.max(1.0));
        let direction = pinhole * l.f(near) - shift * l.f(1.0 / far);
        EyeRays { o: shift, d: direction.normalized(l), weight }
    }
}

/// A reconstruction filter, the same in both directions, to draw places from: a staircase of cells that hold the
/// exact mass of the filter.
struct Kernel {
    radius: f32,
    /// Mass of |filter| up to the end of each cell; the last is 1.
    cumulative: Vec<f32>,
    /// Signs of the cells, times what |filter| holds more than the filter.
    weights: Vec<f32>,
    /// Of numbers from i/`CELLS` the first cell that one may fall into.
    guide: Vec<u16>,
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
        let mut cumulative: Vec<f32> = masses
            .iter()
            .map(|mass| {
                sum += mass.abs() / magnitude;
                sum as f32
            })
            .collect();
        cumulative[CELLS - 1] = 1.0;
        let weights = masses.iter().map(|mass| (magnitude / total).copysign(*mass) as f32).collect();
        let first = |i: usize| cumulative.partition_point(|&end| end <= i as f32 / CELLS as f32) as u16;
        let guide = (0..CELLS).map(first).collect();
        Kernel { radius: radius as f32, cumulative, weights, guide }
    }

    /// Places relative to the pixels' centres, in pixels, and their weights.
    #[inline(always)]
    fn sample<L: Lanes>(&self, l: L, filter: Filter, [u, v]: [L::F; 2]) -> ([L::F; 2], L::F) {
        if filter == Filter::Box {
            return ([u - 0.5, v - 0.5], l.f(1.0));
        }
        let (mut x, mut y, mut weight) = (u, v, l.f(1.0));
        for lane in 0..L::N {
            let (px, wx) = self.sample_axis(u.get(lane));
            let (py, wy) = self.sample_axis(v.get(lane));
            x.set(lane, px);
            y.set(lane, py);
            weight.set(lane, wx * wy);
        }
        ([x, y], weight)
    }

    #[inline(always)]
    fn sample_axis(&self, u: f32) -> (f32, f32) {
        let mut cell = usize::from(self.guide[(u * CELLS as f32) as usize]);
        while self.cumulative[cell] <= u {
            cell += 1;
        }
        let start = if cell == 0 { 0.0 } else { self.cumulative[cell - 1] };
        let within = (u - start) / (self.cumulative[cell] - start);
        (self.radius * ((cell as f32 + within) * (2.0 / CELLS as f32) - 1.0), self.weights[cell])
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
