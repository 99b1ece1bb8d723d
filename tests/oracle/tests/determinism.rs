//! The same bits whatever runs it, and control over it.

use super::*;

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
        rough.target_met && rough.noise <= 0.2 && rough.samples >= FIRST_NOISE_SAMPLES,
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
        // The picture would take hours. How soon it ends is measured by `cargo bench --bench cancel`.
        assert!(asked.elapsed().as_secs() < 60, "{:?}", asked.elapsed());
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
