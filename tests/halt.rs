//! What is said of noise is true: pictures of many seeds, made to a noise target, beside one that has converged.

use rt_lang::color::{Rgb, luminance};
use rt_lang::develop::display;
use rt_lang::files::NoFiles;
use rt_lang::render::halt::{Limit, Limits};
use rt_lang::render::{Control, Film, Shown, Tracer, Window};
use rt_lang::scene::{Scene, Target};
use rt_lang::source::{Source, Sources};
use rt_lang::{Options, compile};

const SEEDS: u64 = 200;
const NOISE: f64 = 0.016;
const SIZE: [u32; 2] = [48, 32];

/// Calm on one side, and a soft shadow of a small lamp on the other.
const SCENE: &str = "
plane { material: diffuse { color: #c0a080 } }
sphere { at: (1, 0.5, 0)m, radius: 50cm, material: diffuse { color: #8090c0 } }
light { at: (2.5, 2, 1.5)m, radius: 50cm, power: 100W }
sky { color: #8090a0, radiance: 0.3W/m2 }
camera { from: (0, 1.5, 5)m, look: (0, 0.4, 0)m, exposure: 0, fov: 50deg }
render { size: (48, 32), bounces: 2 }
";

fn scene() -> Scene {
    let mut sources = Sources::default();
    let id = sources.add(Source::new("halt.rt", SCENE));
    compile(&NoFiles, &mut sources, id, &Options::default()).scene.expect("the scene is right")
}

const SHOWN: Shown = Shown { stops: 0.0, tonemap: rt_lang::schema::Tonemap::Neutral };

/// As it is shown, in the three channels.
fn shown(radiance: Rgb) -> Rgb {
    display(radiance, SHOWN.stops, SHOWN.tonemap)
}

/// The standard error of a pixel as it is shown: see [`Film::noise`].
fn stated(film: &Film, x: u32, y: u32) -> Rgb {
    let (mean, error) = (film.mean(x, y), film.error(x, y));
    0.5 * (shown(mean + error) - shown(mean - error))
}

#[test]
fn the_true_error_lies_within_the_stated_one_as_often_as_it_says() {
    let (window, control) = (Window::whole(SIZE), Control::new());
    let mut scene = scene();
    scene.trace.seed = 1 << 40;
    let tracer = Tracer::new(&scene);
    let prepass = tracer.prepass();
    let truth = tracer.render(window, Target::Samples(1 << 13), &prepass, SHOWN, &control).unwrap().film;
    let limits = Limits::from(Target::Noise(NOISE));
    let (mut within, mut off, mut error) = ([0u32; 2], 0.0, 0.0);
    let (mut kept, mut fewest, mut most) = (0u32, u32::MAX, 0);
    for seed in 0..SEEDS {
        scene.trace.seed = seed;
        let tracer = Tracer::new(&scene);
        let rendered = tracer.render(window, limits, &prepass, SHOWN, &control).unwrap();
        assert_eq!(rendered.limit, Limit::Noise);
        assert!(rendered.noise <= NOISE);
        let film = rendered.film;
        for (x, y) in (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y))) {
            let true_error = (shown(film.mean(x, y)) - shown(truth.mean(x, y))).abs().max_element();
            let stated = stated(&film, x, y).max_element();
            within[0] += u32::from(true_error <= stated);
            within[1] += u32::from(true_error <= 2.0 * stated);
            kept += u32::from(true_error <= 2.0 * NOISE);
            off += luminance(film.mean(x, y) - truth.mean(x, y));
            error += film.error(x, y);
            (fewest, most) = (fewest.min(film.samples(x, y)), most.max(film.samples(x, y)));
        }
    }
    let count = f64::from(SEEDS as u32 * SIZE[0] * SIZE[1]);
    let [one, two] = within.map(|within| f64::from(within) / count);
    let kept = f64::from(kept) / count;
    // Of a normal distribution 68.3 % lie within one standard error, and 95.4 % within two.
    assert!(one >= 0.683 && two >= 0.954, "only {one} and {two} lie within");
    assert!(kept >= 0.954, "{kept}");
    // What is off on average is far below the noise that is stated.
    assert!((off / error).abs() < 0.05, "{}", off / error);
    assert!(fewest == 64 && most >= 128, "{fewest} to {most} samples");
}
