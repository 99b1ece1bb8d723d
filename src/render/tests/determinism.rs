//! The same bits whatever runs it, and control over it.

use super::*;
use crate::render::film::{LightSums, Pixel};
use crate::render::halt::Limits;
use crate::render::making::Making;
use std::sync::Arc;

fn small_room() -> Scene {
    let mut scene = reference::room();
    scene.trace.size = [48, 36];
    scene.trace.filter = Filter::Mitchell;
    scene
}

const SHOWN: Shown = Shown { stops: 0.0, tonemap: Tonemap::Neutral };

fn render(scene: &Scene, window: Window, target: Target) -> Rendered {
    let tracer = Tracer::new(scene);
    tracer.render(window, target, &tracer.prepass(), SHOWN, &Control::new()).expect("nobody cancels")
}

fn pool(threads: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be had")
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let scene = small_room();
    let whole = Window::whole(scene.trace.size);
    let films: Vec<Rendered> =
        [1, 2, 3].map(|threads| pool(threads).install(|| render(&scene, whole, Target::Samples(5)))).into();
    assert_eq!(films[0].film, films[1].film);
    assert_eq!(films[0].film, films[2].film);
}

/// Scenes that between them take every branch there is.
fn scenes_of_all_kinds() -> Vec<Scene> {
    let mut crowd = scene(v(0.0, 3.0, 9.0), DVec3::ZERO).with(floor(), white()).with_sky(0.3);
    let mut random = Random(17);
    let color = || Rgb::new(0.9, 0.6, 0.2);
    for i in 0..200 {
        let at = v(random.within(-5.0, 5.0), 0.4, random.within(-5.0, 5.0));
        let skewed = DMat3::from_diagonal(v(0.3, 0.4, 0.2));
        let (shape, material) = match i % 8 {
            0 => (sphere(at, 0.3), glass(1.5)),
            1 => (sphere(at, 0.4), Material::Metal { color: color().into(), alpha: 0.2 }),
            2 => (sphere(at, 0.3), Material::Plastic { color: color().into(), ior: 1.5, alpha: 0.1 }),
            3 => (sphere(at, 0.3), Material::Dielectric { ior: 1.3, absorption: color(), alpha: 0.2 }),
            4 => (
                Shape::Quadric(quadric(Form::OneSheet, skewed, at, [-1.0, 1.0], true)),
                Material::Plastic { color: color().into(), ior: 1.5, alpha: 0.0 },
            ),
            5 => (Shape::Box(placed(skewed, at)), white()),
            6 => (Shape::Quadric(quadric(Form::Cone, skewed, at, [-1.0, 0.0], true)), glow(3.0)),
            _ => (sphere(at, 0.2), Material::Mirror { color: color().into() }),
        };
        crowd = crowd.with(shape, material);
    }
    crowd.camera.half_extent = DVec2::splat(0.6);
    crowd.camera.lens_radius = 0.05;
    crowd.camera.focus = 9.0;
    crowd.trace.filter = Filter::Gaussian;
    crowd.trace.size = [24, 24];
    let few = Scene { primitives: Arc::new(crowd.primitives[..30].to_vec()), ..crowd.clone() };
    let mut hall = lights::many_lamps();
    hall.trace.size = [24, 24];
    vec![small_room(), few, crowd, hall]
}

#[test]
fn any_number_of_lanes_gives_the_same_bits() {
    for scene in scenes_of_all_kinds() {
        let window = Window::whole(scene.trace.size);
        let look = Tracer::new(&scene).on(Level::One).prepass();
        let film = |level| {
            let tracer = Tracer::new(&scene).on(level);
            assert_eq!(tracer.prepass(), look, "{level:?}");
            tracer
                .render(window, Target::Samples(4), &look, SHOWN, &Control::new())
                .expect("nobody cancels")
                .film
        };
        let one = film(Level::One);
        assert!((0..24).any(|x| one.mean(x, 12) != Rgb::ZERO));
        for level in Level::ALL.into_iter().filter(|level| level.is_there()) {
            assert!(film(level) == one, "{level:?} gives other bits than one lane");
        }
    }
}

#[test]
fn a_crop_is_that_window_of_the_whole() {
    for filter in [Filter::Box, Filter::Tent, Filter::Gaussian, Filter::Mitchell] {
        let mut scene = small_room();
        scene.trace.filter = filter;
        check_crops(&scene);
    }
}

fn check_crops(scene: &Scene) {
    let whole = render(scene, Window::whole(scene.trace.size), Target::Samples(3)).film;
    let window = Window { x: 7, y: 11, width: 30, height: 19 };
    let crop = render(scene, window, Target::Samples(3)).film;
    for y in 11..30 {
        for x in 7..37 {
            assert_eq!(crop.mean(x, y), whole.mean(x, y));
            assert_eq!(crop.error(x, y), whole.error(x, y));
        }
    }
    let mut halves = Film::new(Window::whole([48, 36]), whole.scale());
    halves.merge(&render(scene, Window { x: 0, y: 0, width: 48, height: 13 }, Target::Samples(3)).film);
    halves.merge(&render(scene, Window { x: 0, y: 13, width: 48, height: 23 }, Target::Samples(3)).film);
    assert_eq!(halves, whole);
}

#[test]
fn halves_of_the_samples_add_up_to_the_whole() {
    let scene = small_room();
    let tracer = Tracer::new(&scene);
    let window = Window { x: 5, y: 3, width: 37, height: 20 };
    let samples = |samples: u32, first: u32| (Target::Samples(samples), first);
    for (target, first) in
        [samples(2, 1), samples(7, 4), samples(9, 4), samples(64, 32), samples(96, 32), samples(100, 64)]
            .into_iter()
            .chain([(Target::Noise(0.2), 32)])
    {
        let limits = Limits::from(target);
        let made = |mut making: Making| {
            tracer.go_on(&mut making, &limits, SHOWN, &Control::new(), &mut |_| {}).expect("nobody cancels");
            making
        };
        let (whole, halved) =
            (made(Making::new(window, 65_536.0)), made(Making::new(window, 65_536.0).in_halves()));
        assert_eq!((whole.film(), whole.halves()), (halved.film(), None));
        let [some, others] = halved.halves().expect("they are kept");
        let add = |range| {
            let mut film = Film::new(window, 65_536.0);
            tracer.add_samples(&mut film, range, &Control::new()).expect("nobody cancels");
            let lights: Vec<LightSums> = film.pixels().iter().map(|pixel| *pixel.light()).collect();
            lights
        };
        let [_, samples] = halved.samples();
        assert_eq!(some, add(0..first), "the first {first}");
        if limits.noise.is_none() {
            assert_eq!(others, add(first..samples), "the others of {samples}");
        }
        let left =
            |(all, some): (&Pixel, &LightSums)| all.light().without(some).expect("they are among them");
        assert_eq!(others, whole.film().pixels().iter().zip(&some).map(left).collect::<Vec<LightSums>>());
    }
}

#[test]
fn shares_of_the_samples_add_up_to_the_whole() {
    let scene = small_room();
    let tracer = Tracer::new(&scene);
    let window = Window::whole(scene.trace.size);
    let share = |range| {
        let mut film = Film::new(window, 65_536.0);
        tracer.add_samples(&mut film, range, &Control::new()).expect("nobody cancels");
        film
    };
    let mut sum = share(3..4);
    sum.merge(&share(0..3));
    assert_eq!(sum, share(0..4));
}

#[test]
fn noise_is_met_or_told() {
    let mut scene = reference::room();
    scene.trace.size = [16, 12];
    let window = Window::whole(scene.trace.size);
    let rough = render(&scene, window, Target::Noise(0.2));
    assert!(
        rough.target_met && rough.noise <= 0.2 && rough.samples >= halt::FIRST_NOISE_SAMPLES,
        "{}",
        rough.noise
    );
    let finer = render(&scene, window, Target::Noise(0.5 * rough.noise));
    assert!(finer.samples > rough.samples && finer.noise <= 0.5 * rough.noise);
    assert_eq!(finer.film.samples(3, 3), finer.samples);
}

#[test]
fn cancelling_stops_soon() {
    let scene = reference::room().bounces(1000);
    let tracer = Tracer::new(&scene);
    let prepass = Prepass { exposure_stops: 0.0, scale: 65_536.0, cut: 0.0 };
    let control = Control::new();
    let window = Window::whole(scene.trace.size);
    std::thread::scope(|scope| {
        let job = scope.spawn(|| tracer.render(window, Target::Samples(100_000), &prepass, SHOWN, &control));
        while control.progress().done == 0 {
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
        let asked = std::time::Instant::now();
        control.cancel();
        assert!(matches!(job.join(), Ok(Err(Cancelled))));
        // Far above what it takes, for a machine that does other things too.
        assert!(asked.elapsed().as_millis() < 500, "{:?}", asked.elapsed());
    });
    let Progress { done, total } = control.progress();
    assert!(done > 0 && done < total);
}

#[test]
fn a_first_look_is_sensible_whatever_there_is_to_see() {
    let look = |scene: &Scene| Tracer::new(scene).prepass();
    let black = look(&scene(DVec3::ZERO, DVec3::Z));
    assert_eq!(black.exposure_stops, 0.0);
    assert!(black.scale.is_normal());
    for radiance in [1e-300, 1e-9, 1.0, 1e20, 1e300] {
        let found = look(&scene(DVec3::ZERO, DVec3::Z).with_sky(radiance));
        assert!(found.exposure_stops.is_finite() && found.scale.is_normal(), "{radiance}: {found:?}");
    }
    let mut room = small_room();
    let first = look(&room);
    room.trace.size = [320, 240];
    room.trace.seed = 99;
    room.trace.filter = Filter::Box;
    assert_eq!(look(&room), first);
}

#[test]
fn one_bright_spot_does_not_rule_the_exposure() {
    for spot in [1e2, 1e9, 1e30] {
        let mut cells = vec![1.0; 1023];
        cells.push(spot);
        let typical = prepass::log_mean(&cells);
        assert!((1.0..1.1).contains(&typical), "{spot}: {typical}");
    }
    assert_eq!(prepass::log_mean(&[0.0; 4]), 0.0);
    assert!((prepass::log_mean(&[0.0, 0.0, 3.0]) - 3.0).abs() < 1e-12);
}

#[test]
fn hostile_scenes_are_traced_to_an_end() {
    let sun = Light::Sun { direction: DVec3::Y, irradiance: Rgb::splat(1e30), radius: 0.0046 };
    let far = |mut scene: Scene, focus: f64| {
        scene.camera.lens_radius = 0.1;
        scene.camera.focus = focus;
        scene
    };
    let at = v(0.0, 0.0, 3.0);
    let base = || scene(at, DVec3::ZERO).with_sky(1.0);
    let scenes = [
        base().with(sphere(DVec3::ZERO, 1e-30), white()),
        base().with(sphere(DVec3::ZERO, 1e-30), glow(1e60)).with(floor(), white()),
        base().with(sphere(v(0.0, -1e30, 0.0), 1e30), white()),
        base().with(sphere(DVec3::ZERO, 1e30), glass(1.5)),
        base().with(sphere(DVec3::ZERO, 1e200), white()),
        base().with(sphere(DVec3::ZERO, 3.0), glass(1.5)),
        base().with(sphere(DVec3::ZERO, 3.0), Material::Metal { color: Rgb::ONE.into(), alpha: 0.3 }),
        base().with(Shape::Plane { point: at, normal: DVec3::Z }, glass(10.0)),
        base().with(sphere(DVec3::ZERO, 1.0), glass(10.0)).with(sphere(DVec3::ZERO, 0.5), glass(0.1)),
        base().with(floor(), white()).with_light(sun),
        far(base().with(floor(), white()), 1e200),
        far(base().with(floor(), white()), 1e-200),
    ];
    for mut scene in scenes {
        scene.camera.half_extent = DVec2::splat(0.5);
        let film = render(&scene, Window::whole(scene.trace.size), Target::Samples(16)).film;
        for (x, y) in (0..64).map(|i| (i % 8, i / 8)) {
            let mean = film.mean(x, y);
            assert!(mean.is_finite() && mean.cmpge(Rgb::ZERO).all(), "{:?}: {mean}", scene.primitives);
        }
        let look = Tracer::new(&scene).prepass();
        assert!(look.exposure_stops.is_finite() && look.scale.is_normal(), "{look:?}");
    }
    // Rays that focus at the end of the world are parallel, and are no less rays.
    let mut sharp = far(base().with(sphere(v(0.0, 0.0, -5.0), 1.0), white()).bounces(0), 1e200);
    sharp.camera.lens_radius = 1e-6;
    assert_shows(&sharp, 64, 0.0, 0.0);
}
