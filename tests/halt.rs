//! What is said of noise is true: pictures of many seeds, made to a noise target, beside one that has converged.

use rt_lang::color::{Rgb, luminance};
use rt_lang::develop::display;
use rt_lang::files::NoFiles;
use rt_lang::render::halt::{Limit, Limits};
use rt_lang::render::{Control, Shown, Tracer, Window};
use rt_lang::scene::{Scene, Target};
use rt_lang::source::{Source, Sources};
use rt_lang::{Options, compile};

const SEEDS: u64 = 200;
const SIZE: [u32; 2] = [48, 32];

/// Calm on one side, and a soft shadow of a small lamp on the other, in pale colours.
const PALE: &str = "
plane { material: diffuse { color: #c0a080 } }
sphere { at: (1, 0.5, 0)m, radius: 50cm, material: diffuse { color: #8090c0 } }
light { at: (2.5, 2, 1.5)m, radius: 50cm, power: 100W }
sky { color: #8090a0, radiance: 0.3W/m2 }
";

/// Shadows of a red lamp and of a blue one: little of blue is luminance, and where both shine they vary each by itself.
const COLORED: &str = "
plane { material: diffuse { color: #e0e0e0 } }
sphere { at: (1, 0.5, 0)m, radius: 50cm, material: diffuse { color: #e0e0e0 } }
light { at: (2.5, 2, 1.5)m, radius: 50cm, power: 100W, color: #ff0000 }
light { at: (-1.5, 2, 1.5)m, radius: 50cm, power: 150W, color: #0000ff }
";

fn scene(things: &str) -> Scene {
    let rest = "
        camera { from: (0, 1.5, 5)m, look: (0, 0.4, 0)m, exposure: 0, fov: 50deg }
        render { size: (48, 32), bounces: 2 }";
    let mut sources = Sources::default();
    let id = sources.add(Source::new("halt.rt", format!("{things}{rest}")));
    compile(&NoFiles, &mut sources, id, &Options::default()).scene.expect("the scene is right")
}

const SHOWN: Shown = Shown { stops: 0.0, tonemap: rt_lang::schema::Tonemap::Neutral };

/// As it is shown, in the three channels.
fn shown(radiance: Rgb) -> Rgb {
    display(radiance, SHOWN.stops, SHOWN.tonemap)
}

/// What many pictures of a scene tell, as shares of their pixels' channels that vary.
#[derive(Debug, Default)]
struct Told {
    channels: f64,
    /// Within the standard error that is stated, and twice that.
    within: [f64; 2],
    /// Of the pixels: within twice the noise that was wanted.
    kept: f64,
    /// What is off on average, in stated standard errors of one picture.
    off: f64,
    /// The fewest and the most samples of a pixel.
    samples: [u32; 2],
}

fn told(things: &str, wanted: f64) -> Told {
    let (window, control) = (Window::whole(SIZE), Control::new());
    let mut scene = scene(things);
    scene.trace.seed = 1 << 40;
    let tracer = Tracer::new(&scene);
    let prepass = tracer.prepass();
    let truth = tracer.render(window, Target::Samples(1 << 13), &prepass, SHOWN, &control).unwrap().film;
    let limits = Limits::from(Target::Noise(wanted));
    let mut told = Told { samples: [u32::MAX, 0], ..Told::default() };
    let (mut off, mut error) = (0.0, 0.0);
    for seed in 0..SEEDS {
        scene.trace.seed = seed;
        let tracer = Tracer::new(&scene);
        let rendered = tracer.render(window, limits, &prepass, SHOWN, &control).unwrap();
        assert_eq!(rendered.limit, Limit::Noise);
        assert!(rendered.noise <= wanted);
        let film = rendered.film;
        for (x, y) in (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y))) {
            let true_error = (shown(film.mean(x, y)) - shown(truth.mean(x, y))).abs();
            let stated = film.shown_error(x, y, SHOWN.stops, SHOWN.tonemap);
            for channel in (0..3).filter(|channel| true_error[*channel].max(stated[*channel]) > 1e-6) {
                told.channels += 1.0;
                for (within, errors) in told.within.iter_mut().zip([1.0, 2.0]) {
                    *within += f64::from(u8::from(true_error[channel] <= errors * stated[channel]));
                }
            }
            told.kept += f64::from(u8::from(true_error.max_element() <= 2.0 * wanted));
            off += luminance(film.mean(x, y) - truth.mean(x, y));
            error += film.error(x, y);
            let [fewest, most] = &mut told.samples;
            (*fewest, *most) = ((*fewest).min(film.samples(x, y)), (*most).max(film.samples(x, y)));
        }
    }
    told.within = told.within.map(|within| within / told.channels);
    told.kept /= f64::from(SEEDS as u32 * SIZE[0] * SIZE[1]);
    told.off = off / error;
    told
}

#[test]
fn the_true_error_lies_within_the_stated_one_as_often_as_it_says() {
    for (name, things, wanted) in [("pale", PALE, 0.016), ("colored", COLORED, 0.03)] {
        let told = told(things, wanted);
        // Of a normal distribution 68.3 % lie within one standard error, and 95.4 % within two.
        assert!(told.within[0] >= 0.683 && told.within[1] >= 0.954, "{name}: {told:?}");
        assert!(told.kept >= 0.954, "{name}: {told:?}");
        // What is off on average is far below the noise that is stated.
        assert!(told.off.abs() < 0.05, "{name}: {told:?}");
        let [fewest, most] = told.samples;
        assert!(fewest >= 64 && most >= 2 * fewest, "{name}: {told:?}");
    }
}
