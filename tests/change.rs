//! What a change of a scene asks to be done again.

use rt_lang::change::{Change, Paths, between};
use rt_lang::color::Rgb;
use rt_lang::files::NoFiles;
use rt_lang::render::light::Source;
use rt_lang::render::{Control, Film, Tracer, Window};
use rt_lang::scene::Scene;
use rt_lang::source::{self, Sources};
use rt_lang::{Options, compile};

fn scene(text: &str) -> Scene {
    let mut sources = Sources::default();
    let id = sources.add(source::Source::new("a.rt", text));
    let compiled = compile(&NoFiles, &mut sources, id, &Options::default());
    compiled.scene.unwrap_or_else(|| panic!("{text}: {:?}", compiled.diagnostics))
}

fn mean_of(scene: &Scene) -> Vec<Rgb> {
    let tracer = Tracer::new(scene);
    let mut film = Film::new(Window::whole(scene.trace.size), tracer.prepass().scale);
    tracer.add_samples(&mut film, 0..256, &Control::new()).unwrap();
    let [width, height] = scene.trace.size;
    (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| film.mean(x, y)).collect()
}

#[test]
fn what_brighter_lamps_do_is_foretold_pixel_by_pixel() {
    let room = ROOM.replace("samples: 16", "size: (32, 24)");
    let lit = room.replace("60W", "15W").replace("power: 5W", "power: 25W").replace("#405060", "#402030");
    let (before, after) = (scene(&room), scene(&lit));
    let Paths::Lamps(by_light) = between(&before, &after).paths else { panic!("not by lamps") };
    let shares = Tracer::new(&before).shares(&Control::new()).unwrap().unwrap();
    let factors = shares.sources().iter().map(|source| match source {
        Source::Light(index) => by_light[*index as usize],
        Source::Primitive(id) => {
            let material = before.primitives[id.0 as usize].material;
            by_light[before.lights.len() + material.0 as usize]
        }
    });
    let factors: Vec<Rgb> = factors.collect();
    assert_eq!(factors.len(), 3, "a lamp, a sky and a glowing ball");
    let (old, new) = (mean_of(&before), mean_of(&after));
    let foretold = old.iter().enumerate().map(|(index, old)| {
        let [r, g, b] = shares.factor(index as u32 % 32, index as u32 / 32, &factors).map(f64::from);
        *old * Rgb::new(r, g, b)
    });
    let foretold: Vec<Rgb> = foretold.collect();
    let off = |guess: &[Rgb]| {
        let off = |(guess, new): (&Rgb, &Rgb)| (*guess - *new).abs().max_element() / new.max_element();
        guess.iter().zip(&new).map(off).sum::<f64>() / new.len() as f64
    };
    // Cells are four pixels wide, and known from a few samples: at edges they mix what is different.
    assert!(off(&foretold) < 0.12 && off(&old) > 0.5, "{} where it was {}", off(&foretold), off(&old));
    let sum = |pixels: &[Rgb]| pixels.iter().fold(Rgb::ZERO, |sum, pixel| sum + *pixel);
    let bias = (sum(&foretold) / sum(&new) - Rgb::ONE).abs().max_element();
    assert!(bias < 0.06, "{bias}");
}

const ROOM: &str = "
    camera { from: (0, 1, 4)m, look: (0, 0.5, 0)m }
    light { at: (2, 3, 2)m, power: 60W }
    sky { color: #405060 }
    plane { material: diffuse { color: #8a8f98 } }
    sphere { at: (0, 0.5, 0)m, radius: 50cm, material: diffuse { color: #d94f30 } }
    sphere { at: (1, 2, 0)m, radius: 5cm, material: emitter { power: 5W } }
    render { samples: 16 }";

#[track_caller]
fn changed(from: &str, to: &str) -> Change {
    assert!(ROOM.contains(from), "{from}");
    between(&scene(ROOM), &scene(&ROOM.replacen(from, to, 1)))
}

#[test]
fn what_draws_nothing_new_keeps_everything() {
    let nothing = Change { paths: Paths::Kept, developed: false, target: false };
    assert_eq!(changed("plane", "/* a floor */ plane"), nothing);
    assert_eq!(changed("50cm", "500mm"), nothing);
}

#[test]
fn developing_and_targets_keep_the_paths() {
    let developed = changed("look: (0, 0.5, 0)m", "look: (0, 0.5, 0)m, exposure: 1");
    assert_eq!(developed, Change { paths: Paths::Kept, developed: true, target: false });
    assert_eq!(
        changed("samples: 16", "samples: 64"),
        Change { paths: Paths::Kept, developed: false, target: true }
    );
}

#[test]
fn lamps_have_factors() {
    let Paths::Lamps(factors) = changed("60W", "90W").paths else { panic!("not by lamps") };
    assert!((factors[0] - Rgb::splat(1.5)).abs().max_element() < 1e-12, "{factors:?}");
    assert!(factors[1..].iter().all(|&factor| factor == Rgb::ONE), "{factors:?}");
    let Paths::Lamps(factors) = changed("power: 5W", "power: 0W").paths else { panic!("not by lamps") };
    assert_eq!(factors.iter().filter(|&&factor| factor == Rgb::ZERO).count(), 1, "{factors:?}");
    // Light where there was none has no factor.
    assert_eq!(between(&scene(&ROOM.replace("#405060", "#000000")), &scene(ROOM)).paths, Paths::New);
    // Nor has one that has moved, or one beside another change.
    assert_eq!(changed("at: (2, 3, 2)m, power: 60W", "at: (2, 3, 1)m, power: 60W").paths, Paths::New);
    assert_eq!(
        between(&scene(ROOM), &scene(&ROOM.replace("60W", "70W").replace("#d94f30", "#d94f31"))).paths,
        Paths::New
    );
}
