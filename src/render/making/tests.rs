use super::super::film::Pixel;
use super::*;
use crate::color::Rgb;
use crate::scene::{Target, Tonemap};

const SHOWN: Shown = Shown { stops: 0.0, tonemap: Tonemap::None };

/// Takes all steps of at most so many paths, without tracing, and counts how often each pixel got each sample.
fn all_steps(making: &mut Making, paths: u64, counts: &mut [Vec<u32>]) {
    let window = making.film.window();
    while let Some(step) = making.next(paths, PASS) {
        for block in &step.windows {
            for (x, y) in (block.y..block.y + block.height)
                .flat_map(|y| (block.x..block.x + block.width).map(move |x| (x, y)))
            {
                let pixel = &mut counts[window.index(x, y)];
                step.samples.clone().for_each(|sample| pixel[sample as usize] += 1);
            }
        }
        making.taken(&step);
    }
}

#[test]
fn every_pixel_gets_every_sample_once() {
    for (start, samples, paths) in [(0, 1, 1), (0, 150, 100_000), (37, 64, 3_000), (5, 3, u64::MAX)] {
        let window = Window { x: 3, y: 5, width: 50, height: 37 };
        let mut making = Making::from_sample(window, 1.0, start);
        let limits = Limits::from(Target::Samples(samples));
        let mut counts = vec![vec![0; (start + samples) as usize]; window.pixels()];
        assert_eq!(making.go_on(&limits, SHOWN), None);
        all_steps(&mut making, paths, &mut counts);
        assert_eq!(making.go_on(&limits, SHOWN), Some(Limit::Samples));
        let (before, taken): (Vec<&[u32]>, Vec<&[u32]>) =
            counts.iter().map(|pixel| pixel.split_at(start as usize)).unzip();
        assert!(before.concat().iter().all(|count| *count == 0));
        assert!(taken.concat().iter().all(|count| *count == 1));
        assert_eq!((making.samples(), making.mean_samples()), ([samples; 2], f64::from(samples)));
    }
}

#[test]
fn time_cuts_a_rung_short_and_one_sample_is_always_made() {
    let window = Window::whole([40, 40]);
    let limits = Limits { time: Some(Duration::ZERO), ..Limits::from(Target::Samples(100)) };
    let mut making = Making::new(window, 1.0);
    assert_eq!(making.go_on(&limits, SHOWN), None);
    assert_eq!(making.cut_short(None), None);
    assert_eq!(making.paths_to(u32::MAX), 1600);
    let mut counts = vec![vec![0; 100]; window.pixels()];
    all_steps(&mut making, u64::MAX, &mut counts);
    assert_eq!(making.go_on(&limits, SHOWN), None);
    assert_eq!(making.clone().cut_short(Some(1599)), Some(Limit::Time));
    assert_eq!(making.cut_short(Some(1600 * 9 + 5)), None);
    all_steps(&mut making, u64::MAX, &mut counts);
    assert_eq!(making.samples(), [10; 2]);
}

#[test]
fn on_the_way_a_slow_machine_gets_fewer_samples_and_all_pixels_as_many() {
    // Of 9 blocks of 256 pixels.
    let window = Window::whole([48, 48]);
    let limits = Limits { time: Some(Duration::from_secs(1)), ..Limits::from(Target::Samples(100)) };
    let mut making = Making::new(window, 1.0);
    assert_eq!(making.go_on(&limits, SHOWN), None);
    let step = making.next(4 * 256 * 10, 10).expect("nothing is done yet");
    assert_eq!((step.windows.len(), step.samples.clone()), (4, 0..10));
    making.taken(&step);
    making.slow_down(u64::MAX);
    assert_eq!(making.paths_to(u32::MAX), 256 * (9 * 100 - 4 * 10));
    making.slow_down(256 * (9 * 30 - 4 * 10) + 1);
    assert_eq!(making.paths_to(u32::MAX), 256 * (9 * 30 - 4 * 10));
    // No time at all is left: the others get what these have.
    making.slow_down(0);
    assert_eq!(making.paths_to(u32::MAX), 256 * 5 * 10);
    let mut counts = vec![vec![0; 100]; window.pixels()];
    all_steps(&mut making, u64::MAX, &mut counts);
    assert_eq!(making.samples(), [10; 2]);
    assert_eq!(making.go_on(&limits, SHOWN), None);
    assert_eq!(making.cut_short(Some(0)), Some(Limit::Time));
}

#[test]
fn what_was_put_aside_goes_on_where_it_was() {
    let window = Window::whole([40, 20]);
    let limits = Limits::from(Target::Samples(100));
    let mut making = Making::new(window, 1.0);
    assert_eq!(making.go_on(&limits, SHOWN), None);
    let again = Making::resumed(making.film.clone(), 0, &making.aims(), None);
    assert_eq!(again.as_ref(), Some(&making));
    assert_eq!(Making::resumed(making.film.clone(), 0, &[5; 3], None), None);
    let mut uneven = making.aims();
    uneven[1] = 7;
    assert_eq!(Making::resumed(making.film.clone(), 0, &uneven, None), None);
}

#[test]
fn a_rung_that_was_put_aside_is_ended_before_anything_is_judged() {
    // Three blocks: one that had stayed behind at 16 samples, and one that stays.
    let (window, counts) = (Window::whole([48, 16]), [80u32, 256, 16]);
    let pixel = |index: usize| {
        let mut pixel = Pixel::default();
        (0..counts[index % 48 / 16]).for_each(|n| pixel.add(Rgb::splat(f64::from(n % 2)), 1024.0));
        pixel
    };
    let film = Film::with_pixels(window, 1024.0, (0..window.pixels()).map(pixel).collect());
    let aims: Vec<u32> = (0..window.pixels()).map(|index| [512, 512, 16][index % 48 / 16]).collect();
    let mut making = Making::resumed(film.unwrap(), 0, &aims, Some(SHOWN)).unwrap();
    let limits = Limits { noise: Some(1e-4), least: 16, ..Limits::from(Target::Samples(1 << 16)) };
    assert_eq!((making.go_on(&limits, SHOWN), making.aims()), (None, aims));
    // No further than there are to be.
    assert_eq!(making.go_on(&Limits { samples: 300, ..limits }, SHOWN), None);
    assert_eq!(making.blocks.iter().map(|block| block.aim).collect::<Vec<_>>(), [300, 300, 16]);
}

#[test]
fn samples_that_were_to_be_so_many_are_judged_as_they_are() {
    // 90 samples in one block and 100 in the other, as without a noise target, of which every pixel is half black.
    let (window, counts) = (Window::whole([32, 16]), [90u32, 100]);
    let pixel = |index: usize| {
        let mut pixel = Pixel::default();
        (0..counts[index % 32 / 16]).for_each(|n| pixel.add(Rgb::splat(f64::from(n % 2)), 1024.0));
        pixel
    };
    let film = Film::with_pixels(window, 1024.0, (0..window.pixels()).map(pixel).collect()).unwrap();
    let aims: Vec<u32> = vec![1000; window.pixels()];
    let making = Making::resumed(film, 0, &aims, None).unwrap();
    let limits = |noise| Limits { noise: Some(noise), least: 16, ..Limits::from(Target::Samples(1 << 16)) };
    let even = |making: &mut Making, limits: &Limits| {
        assert_eq!((making.go_on(limits, SHOWN), making.judged()), (None, None));
        assert_eq!(making.paths_to(u32::MAX), 256 * 10);
        all_steps(making, u64::MAX, &mut vec![vec![0; 100]; window.pixels()]);
    };
    // That is enough for the one target, and nothing is said of where samples go.
    let mut done = making.clone();
    even(&mut done, &limits(0.5));
    assert_eq!((done.go_on(&limits(0.5), SHOWN), done.judged()), (Some(Limit::Noise), None));
    assert_eq!(done.samples(), [100; 2]);
    // However many there were to be, also where all have as many, and where pixels are judged anyway.
    for least in [16, 100] {
        let limits = Limits { least, ..limits(0.5) };
        let mut kept = Making::resumed(done.film.clone(), 0, &aims, None).unwrap();
        kept.blocks.iter_mut().for_each(|block| block.samples = 100);
        assert_eq!(kept.go_on(&limits, SHOWN), Some(Limit::Noise));
    }
    // It goes on to the other as any picture, also if it is put aside on the way.
    let mut open = making;
    even(&mut open, &limits(1e-4));
    assert_eq!((open.go_on(&limits(1e-4), SHOWN), open.judged()), (None, Some(SHOWN)));
    assert_eq!(open.aims(), vec![128; window.pixels()]);
    let step = open.next(1, 8).expect("it goes on");
    open.taken(&step);
    assert_eq!((open.samples(), open.go_on(&limits(1e-4), SHOWN)), ([100, 108], None));
    assert_eq!(open.aims(), vec![128; window.pixels()]);
}
