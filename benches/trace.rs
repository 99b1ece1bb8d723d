//! How fast paths are traced, on each set of vector instructions that the processor has:
//! `cargo bench --bench trace`. One thread; an item is a camera path.
//!
//! | benchmark | what takes the time |
//! |---|---|
//! | `intersection` | camera rays against a few surfaces, one after the other |
//! | `traversal` | camera rays through the hierarchy over many |
//! | `stray` | the same for rays that have nothing to do with each other, without paths; an item is a ray |
//! | `shading` | whole paths in a room of every material |
//! | `incoherent` | whole paths among many balls under a sky |
//! | `building` | tables and hierarchy; an item is a ball |

use divan::Bencher;
use divan::counter::ItemsCount;
use rt_lang::render::{Control, Film, Level, Tracer, Window};
use rt_lang::scene::Scene;
use scenes::{ROOM, balls};

mod scenes;

fn main() {
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build_global();
    one.expect("nobody has asked for threads yet");
    divan::main();
}

fn scene(text: &str, bounces: u32) -> Scene {
    scenes::scene(&format!("{text}\nrender {{ size: (64, 48), samples: 4, bounces: {bounces} }}\n"))
}

fn levels() -> Vec<Level> {
    Level::ALL.into_iter().filter(|level| level.is_there()).collect()
}

/// Four samples of each pixel.
fn paths(bencher: Bencher, level: Level, scene: &Scene) {
    const SAMPLES: u32 = 4;
    let tracer = Tracer::new(scene).on(level);
    let (window, prepass) = (Window::whole(scene.trace.size), tracer.prepass());
    bencher.counter(ItemsCount::new(window.pixels() * SAMPLES as usize)).bench(|| {
        let mut film = Film::new(window, prepass.scale);
        tracer.add_samples(&mut film, 0..SAMPLES, &Control::new()).expect("nobody cancels");
        film
    });
}

#[divan::bench(args = levels())]
fn intersection(bencher: Bencher, level: Level) {
    paths(bencher, level, &scene(ROOM, 0));
}

#[divan::bench(args = levels())]
fn traversal(bencher: Bencher, level: Level) {
    paths(bencher, level, &scene(&balls(100_000), 0));
}

#[divan::bench(args = levels())]
fn stray(bencher: Bencher, level: Level) {
    let scene = scene(&balls(100_000), 5);
    let tracer = Tracer::new(&scene).on(level);
    let strays = tracer.strays(20_000, 5);
    bencher.counter(ItemsCount::new(strays.len())).bench(|| tracer.cast(&strays, None));
}

#[divan::bench(args = levels())]
fn shading(bencher: Bencher, level: Level) {
    paths(bencher, level, &scene(ROOM, 8));
}

#[divan::bench(args = levels())]
fn incoherent(bencher: Bencher, level: Level) {
    paths(bencher, level, &scene(&balls(100_000), 5));
}

#[divan::bench(args = [1_000, 100_000], sample_count = 10)]
fn building(bencher: Bencher, count: u32) {
    let scene = scene(&balls(count), 1);
    bencher.counter(ItemsCount::new(count)).bench(|| Tracer::new(&scene));
}
