//! Random numbers, what is drawn from them, and sums.

use super::*;
use crate::oracle::film::scale_for;
use crate::oracle::sampler::Pair;

#[test]
fn every_pair_is_a_net() {
    for pair in [Pair::Film, Pair::Lens, Pair::Direction(0), Pair::Light(3), Pair::Choice(1000)] {
        for (from, x) in [(0, 0), (0, 17), (256, 5)] {
            let points: Vec<[f64; 2]> =
                (from..from + 256).map(|i| Sampler::new(3, x, 9, i).pair(pair)).collect();
            for bits in 0..=8u32 {
                // 2^bits columns of 2^(8 − bits) rows: one point in each cell.
                let mut seen = vec![false; 256];
                for [x, y] in &points {
                    let (columns, rows) = (1u32 << bits, 1u32 << (8 - bits));
                    let cell = (x * f64::from(columns)) as u32 * rows + (y * f64::from(rows)) as u32;
                    assert!(
                        !std::mem::replace(&mut seen[cell as usize], true),
                        "{pair:?}: two points in a cell"
                    );
                }
            }
        }
    }
}

#[test]
fn dimensions_do_not_correlate() {
    const N: u32 = 1024;
    let pairs =
        [Pair::Film, Pair::Lens, Pair::Direction(0), Pair::Lobe(0), Pair::Light(0), Pair::Direction(1)];
    let mut sums = [[0.0; 12]; 12];
    for pixel in 0..16 {
        for i in 0..N {
            let sampler = Sampler::new(11, pixel % 4, pixel / 4, i);
            let values: Vec<f64> = pairs.iter().flat_map(|pair| sampler.pair(*pair)).collect();
            for (a, row) in sums.iter_mut().enumerate() {
                for (b, sum) in row.iter_mut().enumerate() {
                    *sum += (values[a] - 0.5) * (values[b] - 0.5);
                }
            }
        }
    }
    for (a, row) in sums.iter().enumerate() {
        for (b, sum) in row.iter().enumerate().filter(|(b, _)| *b != a) {
            let correlation = 12.0 * sum / f64::from(16 * N);
            assert!(correlation.abs() < 5.0 / 128.0, "dimensions {a} and {b}: {correlation}");
        }
    }
}

#[test]
fn numbers_are_uniform_over_pixels_and_seeds() {
    let mut cells = vec![0u64; 64 * 64];
    for i in 0..400_000u32 {
        let [x, y] = Sampler::new(u64::from(i % 7), i % 640, i / 640, 5).pair(Pair::Direction(2));
        cells[(x * 64.0) as usize * 64 + (y * 64.0) as usize] += 1;
    }
    assert_distributed(&cells, &vec![400_000.0 / 4096.0; 4096]);
}

#[test]
fn warps_have_their_density() {
    assert_density(|u| Some(warp::cosine([u[0], u[1]])), |w| warp::cosine_pdf(w.z));
    assert_density(|u| Some(warp::sphere([u[0], u[1]])), |_| warp::SPHERE_PDF);
    // A cone whose edge lies on the edge of cells.
    let pdf = |w: DVec3| if w.z > 0.5 { warp::cone_pdf(0.5) } else { 0.0 };
    assert_density(|u| Some(warp::cone([u[0], u[1]], 0.5)), pdf);
}

#[test]
fn a_film_adds_in_any_order() {
    let window = Window { x: 3, y: 5, width: 7, height: 4 };
    let mut random = Random(5);
    let samples: Vec<(u32, u32, Rgb)> = (0..2000)
        .map(|_| {
            let at = (3 + (random.next() * 7.0) as u32, 5 + (random.next() * 4.0) as u32);
            (at.0, at.1, random.point(1.0).abs() * random.next() * 1e4)
        })
        .collect();
    let film = |samples: &mut dyn Iterator<Item = &(u32, u32, Rgb)>| {
        let mut film = Film::new(window, scale_for(1.0, 1.0));
        for (x, y, radiance) in samples {
            let mut pixel = Pixel::default();
            pixel.add(*radiance, film.scale());
            film.merge_pixels(Window { x: *x, y: *y, width: 1, height: 1 }, &[pixel]);
        }
        film
    };
    let forward = film(&mut samples.iter());
    assert_eq!(forward, film(&mut samples.iter().rev()));
    let mut parts = film(&mut samples[700..].iter());
    parts.merge(&film(&mut samples[..700].iter()));
    assert_eq!(forward, parts);
}

#[test]
fn a_pixel_knows_its_mean_and_error_and_does_not_overflow() {
    let mut film = Film::new(Window::whole([1, 1]), scale_for(0.5, 1.0));
    assert_eq!(film.error(0, 0), f64::INFINITY);
    let mut pixel = Pixel::default();
    for i in 0..1000 {
        pixel.add(Rgb::splat(f64::from(i % 2)), film.scale());
    }
    film.merge_pixels(Window::whole([1, 1]), &[pixel]);
    assert_eq!(film.mean(0, 0), Rgb::splat(0.5));
    assert!((film.error(0, 0) - 0.5 / f64::sqrt(999.0)).abs() < 1e-9);

    let mut huge = Pixel::default();
    for _ in 0..MOST_SAMPLES {
        huge.add(Rgb::splat(1e300), 1.0);
    }
    let mut film = Film::new(Window::whole([1, 1]), 1.0);
    film.merge_pixels(Window::whole([1, 1]), &[huge]);
    assert_eq!(film.mean(0, 0), Rgb::splat(4_398_046_511_104.0));
}

#[test]
fn the_error_of_a_nearly_even_pixel_is_seen() {
    // At the coarsest scale there is, 2¹⁴ units for the typical radiance, with a spread of half a percent.
    let scale = scale_for(1.0, 1e12);
    let mut random = Random(12);
    let mut pixel = Pixel::default();
    const N: u32 = 4096;
    for _ in 0..N {
        pixel.add(Rgb::splat(1.0 + 0.005 * random.within(-1.0, 1.0)), scale);
    }
    let mut film = Film::new(Window::whole([1, 1]), scale);
    film.merge_pixels(Window::whole([1, 1]), &[pixel]);
    let expected = 0.005 / f64::sqrt(3.0 * f64::from(N));
    let error = film.error(0, 0);
    assert!((error / expected - 1.0).abs() < 0.05, "{error}, not {expected}");
}

/// Where errors are small, all ways to tell how they are shown are the same.
#[test]
fn the_tracer_tells_the_same_errors() {
    use rt_lang::render::film as tracers;
    let mut random = Random(3);
    let scale = scale_for(0.3, 1.0);
    for tonemap in [Tonemap::Neutral, Tonemap::None, Tonemap::Agx] {
        for _ in 0..200 {
            let colors = [(); 3].map(|()| random.point(1.0).abs() * 0.3);
            let (mut own, mut theirs) = (Pixel::default(), tracers::Pixel::default());
            for _ in 0..100 {
                let light: Rgb = colors.iter().map(|color| *color * (1.0 + 0.001 * random.next())).sum();
                own.add(light, scale);
                theirs.add(light, scale);
            }
            let mut film = Film::new(Window::whole([1, 1]), scale);
            film.merge_pixels(Window::whole([1, 1]), &[own]);
            let window = tracers::Window::whole([1, 1]);
            let other = tracers::Film::with_pixels(window, scale, vec![theirs]).unwrap();
            let errors = [film.shown_error(0, 0, 0.5, tonemap), other.shown_error(0, 0, 0.5, tonemap)];
            assert!(
                (errors[0] - errors[1]).abs().max_element() < 0.01 * errors[0].max_element(),
                "{errors:?}"
            );
            assert!((film.error(0, 0) / other.error(0, 0) - 1.0).abs() < 1e-3);
        }
    }
}

#[test]
fn a_window_without_pixels_holds_nothing() {
    for (width, height) in [(0, 5), (5, 0), (0, 0)] {
        let none = Film::new(Window { x: 1, y: 1, width, height }, 1.0);
        let mut film = Film::new(Window::whole([8, 8]), 1.0);
        film.merge(&none);
        assert_eq!(film, Film::new(Window::whole([8, 8]), 1.0));
        assert_eq!(none.noise(0.0, Tonemap::Neutral), 0.0);
    }
}

#[test]
fn scales_are_finite_powers_of_two() {
    for (typical, peak) in
        [(0.0, 0.0), (1.0, 1.0), (1e-300, 1e300), (1e300, 1e300), (0.0, 1e-320), (1e-320, 0.0)]
    {
        let scale = scale_for(typical, peak);
        assert!(scale.is_normal() && (1.0 / scale).is_normal(), "{typical} {peak}: {scale}");
        assert_eq!(scale.to_bits() & ((1 << 52) - 1), 0, "{scale} is no power of two");
    }
}
