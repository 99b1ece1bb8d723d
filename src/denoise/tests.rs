use super::*;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

const SIZE: [u32; 2] = [40, 36];

/// Numbers in [0, 1) that look drawn at random, always the same.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1u64 << 24) as f32
    }

    /// With mean 0 and variance 1, nearly normal.
    fn normal(&mut self) -> f32 {
        (0..12).map(|_| self.next()).sum::<f32>() - 6.0
    }
}

/// A picture of colours and features by column and row, with noise of a standard deviation in proportion to the colour.
fn noisy(noise: f32, shows: impl Fn(f32, f32) -> ([f32; 3], [f32; FEATURES])) -> (Noisy, Vec<[f32; 3]>) {
    let mut numbers = Numbers(1);
    let [width, height] = SIZE;
    let (mut halves, mut guides) = ([vec![], vec![]], [vec![], vec![]]);
    let (mut variance, mut truth) = (vec![], vec![]);
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let (color, features) = shows(x as f32, y as f32);
        for half in 0..2 {
            // Each half is noisier than both together.
            let factor = 1.0 + noise * std::f32::consts::SQRT_2 * numbers.normal();
            halves[half].push(color.map(|v| v * factor));
            guides[half].push(features);
        }
        let luminance = 0.2126 * color[0] + 0.7152 * color[1] + 0.0722 * color[2];
        variance.push((noise * luminance) * (noise * luminance));
        truth.push(color);
    }
    let share = vec![0.5; truth.len()];
    (Noisy { size: SIZE, halves, alpha: None, share, variance, guides }, truth)
}

/// The colours without noise.
fn clean(noisy: &Noisy) -> Vec<[f32; 3]> {
    denoise(noisy, &|_| ()).pixels
}

/// The mean of the squared relative differences.
fn error(picture: &[[f32; 3]], truth: &[[f32; 3]]) -> f32 {
    let squared = |(a, b): (&f32, &f32)| (a - b) * (a - b) / (b * b + 1e-6);
    picture.iter().flatten().zip(truth.iter().flatten()).map(squared).sum::<f32>() / (3 * truth.len()) as f32
}

fn greatest_error(picture: &[[f32; 3]], truth: &[[f32; 3]]) -> f32 {
    let differences = picture.iter().flatten().zip(truth.iter().flatten()).map(|(a, b)| (a - b).abs() / b);
    differences.fold(0.0, f32::max)
}

fn mean(noisy: &Noisy) -> Vec<[f32; 3]> {
    let both = noisy.halves[0].iter().zip(&noisy.halves[1]);
    both.map(|(a, b)| [0, 1, 2].map(|c| 0.5 * (a[c] + b[c]))).collect()
}

#[test]
fn what_has_no_noise_stays_as_it_is() {
    let (even, truth) = noisy(0.0, |_, _| ([3.0, 0.5, 1e-3], [0.0; FEATURES]));
    assert!(greatest_error(&clean(&even), &truth) < 1e-5);
    // Also where no feature tells why colours differ.
    let (pattern, truth) =
        noisy(0.0, |x, y| ([0.2 + (x * 0.7).fract() + (y * 0.3).fract(); 3], [0.0; FEATURES]));
    assert!(greatest_error(&clean(&pattern), &truth) < 1e-3);
}

#[test]
fn noise_on_one_colour_goes_away() {
    for (noise, gain) in [(0.5, 50.0), (0.1, 50.0), (0.01, 50.0)] {
        let (noisy, truth) = noisy(noise, |_, _| ([1.0, 0.5, 0.25], [0.0; FEATURES]));
        let (before, after) = (error(&mean(&noisy), &truth), error(&clean(&noisy), &truth));
        assert!((before / (noise * noise) - 1.0).abs() < 0.2, "{before} of {noise}");
        assert!(after * gain < before, "{before} became {after}");
    }
}

#[test]
fn what_a_feature_parts_stays_apart() {
    let edge = |x: f32, _: f32| {
        let right = if x < 20.0 { 0.0 } else { 1.0 };
        let mut features = [0.0; FEATURES];
        features[3] = right;
        ([0.2 + right; 3], features)
    };
    let (noisy, truth) = noisy(0.4, edge);
    let picture = clean(&noisy);
    // Of the worst pixel, where the noise alone is above 1. A tenth of the other side in a dark pixel would be 0.5; so little as
    // 0.3 is also what is left of the noise where fewest pixels are alike.
    assert!(greatest_error(&picture, &truth) < 0.3, "{}", greatest_error(&picture, &truth));
    let (before, after) = (error(&mean(&noisy), &truth), error(&picture, &truth));
    assert!(after * 15.0 < before, "{before} became {after}");
    let [left, right] = [19, 20].map(|x| picture[18 * 40 + x][1]);
    assert!(right - left > 0.9, "{left} beside {right}");
}

#[test]
fn what_is_linear_in_a_feature_is_kept_exactly() {
    let slope = |x: f32, y: f32| {
        let mut features = [0.0; FEATURES];
        (features[0], features[4]) = (x / 40.0, (y * 0.37).fract());
        ([1.0 + features[0] + features[4], 2.0 - features[0], 1.0 + 0.5 * features[4]], features)
    };
    let (even, truth) = noisy(0.0, slope);
    assert!(greatest_error(&clean(&even), &truth) < 1e-3);
    // A texture that is far finer than what is compared comes out of the noise.
    let (noisy, truth) = noisy(0.2, slope);
    let (before, after) = (error(&mean(&noisy), &truth), error(&clean(&noisy), &truth));
    assert!(after * 15.0 < before, "{before} became {after}");
}

#[test]
fn a_firefly_is_not_spread() {
    let (mut noisy, truth) = noisy(0.1, |_, _| ([1.0; 3], [0.0; FEATURES]));
    noisy.halves[0][18 * 40 + 20] = [1000.0; 3];
    noisy.variance[18 * 40 + 20] = 250_000.0;
    assert!(greatest_error(&clean(&noisy), &truth) < 0.2);
    // What is in both halves is there.
    noisy.halves[1][18 * 40 + 20] = [1000.0; 3];
    noisy.variance[18 * 40 + 20] = 1.0;
    assert!(clean(&noisy)[18 * 40 + 20][0] > 900.0);
}

#[test]
fn around_a_firefly_noise_is_known_as_elsewhere() {
    let (mut noisy, _) = noisy(0.1, |_, _| ([1.0; 3], [0.0; FEATURES]));
    for v in [100.0f32, 1e4] {
        noisy.halves[0][18 * 40 + 20] = [v; 3];
        noisy.variance[18 * 40 + 20] = 0.25 * v * v;
        let size = SIZE.map(|side| side as usize);
        let (halves, left) = noise::halves(&noisy.halves, size, 1.0);
        let variance = noise::variance(&halves, &noisy.share, &noisy.variance, &left, 1.0);
        let far = variance.planes[1][6 * 40 + 6];
        for (x, y) in (15..26).flat_map(|x| (13..24).map(move |y| (x, y))) {
            let near = variance.planes[1][y * 40 + x];
            assert!(near > 0.3 * far, "at ({x}, {y}) {near} and far away {far}");
        }
    }
}

#[test]
fn a_lamp_in_view_changes_nothing_else() {
    let edge = |x: f32, _: f32| ([if x < 20.0 { 1.0 } else { 1.3 }; 3], [0.0; FEATURES]);
    let (mut noisy, truth) = noisy(0.05, edge);
    let without = clean(&noisy);
    assert!(error(&without, &truth) < 0.3 * error(&mean(&noisy), &truth));
    let is_lamp = |index: usize| (2..6).contains(&(index % 40)) && (3..7).contains(&(index / 40));
    for index in (0..truth.len()).filter(|index| is_lamp(*index)) {
        noisy.halves.iter_mut().for_each(|half| half[index] = [1e6; 3]);
        noisy.variance[index] = 0.0;
    }
    let picture = clean(&noisy);
    for (index, (with, without)) in picture.iter().zip(&without).enumerate() {
        if is_lamp(index) {
            assert!(with[0] > 0.99e6, "{index}: {with:?}");
        } else if !(index % 40 < 20 && index / 40 < 20) {
            assert!((with[0] - without[0]).abs() < 0.01, "{index}: {with:?} was {without:?}");
        } else {
            assert!((with[0] - 1.0).abs() < 0.2, "{index}: {with:?} was {without:?}");
        }
    }
}

#[test]
fn what_covers_a_pixel_in_part_keeps_its_colour() {
    // A ball of one colour without noise, but for what of each pixel at its edge it covers.
    let mut numbers = Numbers(3);
    let (mut noisy, _) = noisy(0.0, |_, _| ([0.0; 3], [0.0; FEATURES]));
    let mut alpha = [vec![], vec![]];
    for index in 0..40 * 36 {
        let (x, y) = ((index % 40) as f32 - 19.5, (index / 40) as f32 - 17.5);
        let covered = (12.5 - (x * x + y * y).sqrt()).clamp(0.0, 1.0);
        for (half, alpha) in alpha.iter_mut().enumerate() {
            let share = (0..4).filter(|_| numbers.next() < covered).count() as f32 / 4.0;
            noisy.halves[half][index] = [0.8 * share, 0.4 * share, 0.2 * share];
            noisy.guides[half][index][2] = share;
            alpha.push(share);
        }
        noisy.variance[index] = covered * (1.0 - covered) / 8.0;
    }
    noisy.alpha = Some(alpha);
    let Clean { pixels, alpha } = denoise(&noisy, &|_| ());
    let alpha = alpha.expect("it had one");
    for (pixel, alpha) in pixels.iter().zip(&alpha).filter(|(_, alpha)| **alpha > 0.05) {
        for (v, color) in pixel.iter().zip([0.8, 0.4, 0.2]) {
            assert!((v / alpha / color - 1.0).abs() < 0.02, "{pixel:?} of {alpha}");
        }
    }
    assert!((alpha[18 * 40 + 20] - 1.0).abs() < 1e-3 && alpha[0] < 1e-3);
}

#[test]
fn halves_of_different_size_count_by_their_samples() {
    // One part has a third of the samples, so it is noisier.
    let (even, truth) = noisy(0.3, |_, _| ([1.0; 3], [0.0; FEATURES]));
    let mut uneven = even.clone();
    let toward = |half: &mut Vec<[f32; 3]>, factor: f32| {
        half.iter_mut().flatten().for_each(|v| *v = 1.0 + (*v - 1.0) * factor);
    };
    toward(&mut uneven.halves[0], (0.5f32 / (1.0 / 3.0)).sqrt());
    toward(&mut uneven.halves[1], (0.5f32 / (2.0 / 3.0)).sqrt());
    uneven.share = vec![1.0 / 3.0; truth.len()];
    let (of_even, of_uneven) = (error(&clean(&even), &truth), error(&clean(&uneven), &truth));
    assert!(of_uneven < 2.0 * of_even, "{of_uneven} and {of_even}");
}

#[test]
fn the_unit_makes_no_difference() {
    let (noisy, _) = noisy(0.3, |x, _| ([1.0 + (x / 7.0).floor(), 1.0, 0.5], [0.0; FEATURES]));
    let picture = clean(&noisy);
    for unit in [1e-9f32, 1e9] {
        let halves =
            noisy.halves.clone().map(|half| half.into_iter().map(|pixel| pixel.map(|v| v * unit)).collect());
        let variance = noisy.variance.iter().map(|v| v * unit * unit).collect();
        let other = clean(&Noisy { halves, variance, ..noisy.clone() });
        let back: Vec<[f32; 3]> = other.iter().map(|pixel| pixel.map(|v| v / unit)).collect();
        assert!(greatest_error(&back, &picture) < 1e-3, "{unit}");
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let (noisy, _) =
        noisy(0.3, |x, y| ([1.0 + (x / 7.0).floor(), 1.0 + (y / 5.0).floor(), 0.5], [x / 40.0; FEATURES]));
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| denoise(&noisy, &|_| ()))
    };
    assert!(on(1) == on(3));
}

#[test]
fn anything_may_come_in() {
    let odd = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0, -1.0, 1e30, 1e-40, f32::MAX, f32::MIN];
    for size in [[0, 0], [0, 5], [1, 1], [2, 1], [1, 40], [33, 3]] {
        let pixels = (size[0] * size[1]) as usize;
        for seed in 0..6 {
            let mut numbers = Numbers(seed);
            let mut any = move || match (numbers.next() * 16.0) as usize {
                index if index < odd.len() => odd[index],
                _ => numbers.next(),
            };
            let mut color = || (0..pixels).map(|_| std::array::from_fn(|_| any())).collect::<Vec<[f32; 3]>>();
            let halves = [color(), color()];
            let mut guide =
                || (0..pixels).map(|_| std::array::from_fn(|_| any())).collect::<Vec<[f32; FEATURES]>>();
            let guides = [guide(), guide()];
            let variance = (0..pixels).map(|_| any()).collect();
            let mut list = || (0..pixels).map(|_| any()).collect::<Vec<f32>>();
            let (share, alpha) = (list(), (seed % 2 == 0).then(|| [list(), list()]));
            let done = AtomicU64::new(0);
            let tell = |work| {
                done.fetch_add(work, Relaxed);
            };
            let clean = denoise(&Noisy { size, halves, alpha, share, variance, guides }, &tell);
            assert_eq!(done.into_inner(), whole_work(size), "all work is told, and no more");
            assert_eq!(clean.pixels.len(), pixels);
            assert_eq!(clean.alpha.as_ref().map(Vec::len), (seed % 2 == 0).then_some(pixels));
            assert!(clean.pixels.iter().flatten().all(|v| v.is_finite() && *v >= 0.0), "{size:?}");
            assert!(clean.alpha.iter().flatten().all(|v| (0.0..=1.0).contains(v)), "{size:?}");
        }
    }
    let black = Noisy {
        size: [3, 3],
        halves: [vec![[0.0; 3]; 9], vec![[0.0; 3]; 9]],
        alpha: None,
        share: vec![0.5; 9],
        variance: vec![0.0; 9],
        guides: [vec![[0.0; FEATURES]; 9], vec![[0.0; FEATURES]; 9]],
    };
    assert_eq!(clean(&black), vec![[0.0; 3]; 9]);
}
