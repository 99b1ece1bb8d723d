//! The tracer against the oracle, on the examples: the same light within the noise that both know of.

use crate::folder::Folder;
use crate::oracle;
use rt_lang::color::luminance;
use rt_lang::lower::Overrides;
use rt_lang::render;
use rt_lang::scene::{Scene, Target};
use rt_lang::source::{Source, Sources};
use rt_lang::{Options, compile};
use std::path::Path;

const SIZE: [u32; 2] = [48, 36];
const SAMPLES: u32 = 64;
/// Side of the squares of pixels whose means are compared.
const BLOCK: u32 = 6;

#[test]
fn examples_show_the_same_light() {
    insta::glob!("../examples", "**/*.rt", check);
}

fn check(path: &Path) {
    let scene = scene(path);
    let (ours, theirs) = (ours(&scene), theirs(&scene));
    let mut far = 0;
    let (mut sums, mut variance) = ([0.0; 2], 0.0);
    for (ours, theirs) in ours.iter().zip(&theirs) {
        let error = (ours.1 * ours.1 + theirs.1 * theirs.1).sqrt();
        let slack = 0.01 * theirs.0;
        far += u32::from((ours.0 - theirs.0).abs() > 4.0 * error + slack);
        sums = [sums[0] + ours.0, sums[1] + theirs.0];
        variance += error * error;
    }
    let allowed = 5.0 * f64::sqrt(variance) + 2e-3 * sums[1];
    assert!(
        (sums[0] - sums[1]).abs() <= allowed,
        "{}: {sums:?} differ by more than {allowed}",
        path.display()
    );
    // Errors are estimates too, and rare bright samples are found by the one and not by the other.
    let blocks = ours.len() as u32;
    assert!(far <= blocks / 12, "{}: {far} of {blocks} blocks differ", path.display());
}

fn scene(path: &Path) -> Scene {
    let mut sources = Sources::default();
    let text = std::fs::read_to_string(path).unwrap();
    let id = sources.add(Source::new(path.display().to_string(), text));
    let overrides = Overrides { size: Some(SIZE), ..Overrides::default() };
    let options = Options { overrides, ..Options::default() };
    let compiled = compile(&Folder::of(path), &mut sources, id, &options);
    compiled.scene.unwrap_or_else(|| panic!("{}: {:#?}", path.display(), compiled.diagnostics))
}

fn ours(scene: &Scene) -> Vec<(f64, f64)> {
    // The oracle leaves caustics to luck, which never finds those of lights without size.
    let tracer = render::Tracer::new(scene).by_luck();
    let shown = render::Shown { stops: 0.0, tonemap: scene.develop.tonemap };
    let (window, target) = (render::Window::whole(SIZE), Target::Samples(SAMPLES));
    let film = tracer.render(window, target, &tracer.prepass(), shown, &render::Control::new()).unwrap().film;
    blocks(|x, y| (luminance(film.mean(x, y)), film.error(x, y)))
}

fn theirs(scene: &Scene) -> Vec<(f64, f64)> {
    let tracer = oracle::Tracer::new(scene);
    let shown = oracle::Shown { stops: 0.0, tonemap: scene.develop.tonemap };
    let (window, target) = (oracle::Window::whole(SIZE), Target::Samples(SAMPLES));
    let film = tracer.render(window, target, &tracer.prepass(), shown, &oracle::Control::new()).unwrap().film;
    blocks(|x, y| (luminance(film.mean(x, y)), film.error(x, y)))
}

/// Mean luminance of each block, and its standard error.
fn blocks(pixel: impl Fn(u32, u32) -> (f64, f64)) -> Vec<(f64, f64)> {
    let mut blocks = Vec::new();
    for y in (0..SIZE[1]).step_by(BLOCK as usize) {
        for x in (0..SIZE[0]).step_by(BLOCK as usize) {
            let (mut mean, mut variance) = (0.0, 0.0);
            for i in 0..BLOCK * BLOCK {
                let (value, error) = pixel(x + i % BLOCK, y + i / BLOCK);
                mean += value;
                variance += error * error;
            }
            let n = f64::from(BLOCK * BLOCK);
            blocks.push((mean / n, variance.sqrt() / n));
        }
    }
    blocks
}
