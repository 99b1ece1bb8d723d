//! How noisy the two halves of a picture are.

use super::COLORS;
use super::planes::Planes;

/// Radiance beyond this many times the mean is cut.
const MOST: f32 = 1e8;
/// How many times brighter than all around it a pixel of one half may be, in both halves.
const FIREFLY: f32 = 2.0;
/// The share of what is shown somewhere that no difference is less than.
const LEAST: f32 = 1e-4;

/// What makes numbers of about 1 of a picture.
pub(super) fn unit(halves: &[Vec<[f32; 3]>; 2]) -> f32 {
    let finite = |v: &&f32| v.is_finite();
    let sum: f64 = halves.iter().flatten().flatten().filter(finite).map(|v| f64::from(v.abs())).sum();
    let mean = sum / (6 * halves[0].len()).max(1) as f64;
    // Beyond, it would not be a number.
    if mean > 1e-30 { (1.0 / mean) as f32 } else { 1.0 }
}

/// Both halves in this unit, without what is far too bright in one of them alone: noise that would be spread over its
/// surroundings. Its light is lost. Beside them what is left of each pixel, of 1.
pub(super) fn halves(halves: &[Vec<[f32; 3]>; 2], size: [usize; 2], unit: f32) -> ([Planes; 2], Vec<f32>) {
    let [a, b] = [0, 1].map(|half| Planes::of(size, &halves[half]).finite(unit, MOST));
    let [bright_a, bright_b] = [&a, &b].map(brightness);
    let (dim_a, dim_b) = (dimming(&bright_a, &bright_b, size), dimming(&bright_b, &bright_a, size));
    let least = dim_a.iter().zip(&dim_b).map(|(a, b)| a.min(*b)).collect();
    ([dimmed(a, &dim_a), dimmed(b, &dim_b)], least)
}

/// Red, green and blue together.
pub(super) fn brightness(planes: &Planes) -> Vec<f32> {
    let colors = planes.planes.iter().take(COLORS);
    (0..planes.planes[0].len()).map(|index| colors.clone().map(|plane| plane[index]).sum()).collect()
}

/// By what to multiply each pixel of a half: less than 1 where it is much brighter than its neighbours, and than these and
/// itself in the other half; so bright is no thing, which would show in both.
fn dimming(half: &[f32], other: &[f32], [width, height]: [usize; 2]) -> Vec<f32> {
    let around = |at: usize, length: usize| at.saturating_sub(1)..(at + 2).min(length);
    let factor = |index: usize| {
        let (x, y) = (index % width, index / width);
        let mut most = 0.0f32;
        for near in around(y, height).flat_map(|y| around(x, width).map(move |x| y * width + x)) {
            most = most.max(other[near]);
            if near != index {
                most = most.max(half[near]);
            }
        }
        if half[index] > FIREFLY * most { most / half[index] } else { 1.0 }
    };
    (0..half.len()).map(factor).collect()
}

fn dimmed(mut planes: Planes, factors: &[f32]) -> Planes {
    for plane in &mut planes.planes {
        plane.iter_mut().zip(factors).for_each(|(v, factor)| *v *= factor);
    }
    planes
}

/// The variance of the mean of both halves, channel by channel: that of the samples' luminance, at each place to the scale of
/// what the halves differ by around there. Samples that are strewn evenly have less noise than their own variance says, and what
/// halves differ by at one pixel says little (F. Rousselle, C. Knaus and M. Zwicker, "Adaptive rendering with non-local means
/// filtering", 2012, section 4.3). `share` is that of the first half, and `left` what is left of each pixel, of 1.
pub(super) fn variance(
    halves: &[Planes; 2],
    share: &[f32],
    luminance: &[f32],
    left: &[f32],
    unit: f32,
) -> Planes {
    const AROUND: usize = 3;
    let size = halves[0].size;
    let known = Planes { size, planes: vec![luminance.to_vec()] }.finite(unit * unit, MOST * MOST);
    let known = known.scaled(left, |v, left| v * left * left);
    let (smooth, around) = (known.blurred(1), known.blurred(AROUND));
    let apart = halves[0].zip(&halves[1], |a, b| (a - b) * (a - b));
    let mut apart = apart.scaled(share, |v, share| v * (share * (1.0 - share)));
    // Where alpha varies is not told by luminance.
    let alpha = Planes { size, planes: apart.planes.split_off(COLORS) }.blurred(1);
    let plane = |apart: &Vec<f32>| {
        let scaled = |((apart, smooth), around): ((&f32, &f32), &f32)| {
            if *around > 0.0 { (apart * (smooth / around)).max(0.0) } else { *apart }
        };
        apart.iter().zip(&smooth.planes[0]).zip(&around.planes[0]).map(scaled).collect()
    };
    let colors = apart.blurred(AROUND);
    Planes { size, planes: colors.planes.iter().map(plane).chain(alpha.planes).collect() }
}

/// A variance with as much more as makes no difference to what the picture shows there, so that nothing is compared more
/// strictly than that. It is told place by place: beside a lamp all else would be nothing.
pub(super) fn floored(variance: &Planes, picture: &Planes) -> Planes {
    let Planes { size, .. } = *picture;
    let bright = Planes { size, planes: vec![brightness(picture)] }.blurred(1);
    let least = |v: f32, typical: f32| v + (LEAST * typical) * (LEAST * typical);
    let mut floored =
        variance.scaled(&bright.planes[0], |v, bright| least(v, bright * (1.0 / COLORS as f32)));
    for (plane, variance) in floored.planes.iter_mut().zip(&variance.planes).skip(COLORS) {
        *plane = variance.iter().map(|v| least(*v, 1.0)).collect();
    }
    floored
}
