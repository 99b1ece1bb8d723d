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
use rt_lang::files::{FileError, FilePath, Files};
use rt_lang::render::{Control, Film, Level, Tracer, Window};
use rt_lang::scene::Scene;
use rt_lang::source::{Source, Sources};
use rt_lang::{Options, compile};
use std::sync::Arc;

fn main() {
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build_global();
    one.expect("nobody has asked for threads yet");
    divan::main();
}

/// A room with a lamp, and in it balls of all materials.
const ROOM: &str = "
    box { size: (4, 3, 4)m, at: (0, 1.5, 0)m, material: diffuse { color: #b0a090 } }
    sphere { at: (0, 2.4, 0)m, radius: 20cm, material: emitter { power: 60W } }
    sphere { at: (-1, 0.4, -0.5)m, radius: 40cm, material: mirror { } }
    sphere { at: (0, 0.4, -1)m, radius: 40cm, material: dielectric { ior: 1.5 } }
    sphere { at: (1, 0.4, -0.5)m, radius: 40cm, material: metal { color: #c9a227, roughness: 30% } }
    sphere { at: (0.5, 0.3, 0.4)m, radius: 30cm, material: plastic { color: #d94f30, roughness: 20% } }
    sphere { at: (-0.5, 0.2, 0.5)m, radius: 20cm, material: diffuse { color: #3060a0 } }
    camera { from: (0, 1.5, 1.9)m, look: (0, 0.8, -0.5)m, fov: 70deg }
";

/// Balls on a plain under a sky.
fn balls(count: u32) -> String {
    let side = f64::from(count).sqrt() * 0.03;
    format!(
        "plane {{ }}
         sky {{ color: #c0d0ff }}
         let side = {side:?}m
         for i in range({count}) {{
           sphere {{ at: (side * (rand(i, 0) - 0.5), 2cm, side * (rand(i, 1) - 0.5)), radius: 12mm }}
         }}
         camera {{ from: (0, side / 4, side), look: (0, 0, 0)m }}"
    )
}

/// There is no other file to read.
struct Alone;

impl Files for Alone {
    fn read(&self, _: &FilePath, _: usize) -> Result<Arc<[u8]>, FileError> {
        Ok(Arc::new([]))
    }
}

fn scene(text: &str, bounces: u32) -> Scene {
    let mut sources = Sources::default();
    let text = format!("{text}\nrender {{ size: (64, 48), samples: 4, bounces: {bounces} }}\n");
    let main = sources.add(Source::new("bench.rt", text));
    let compiled = compile(&Alone, &mut sources, main, &Options::default());
    compiled.scene.unwrap_or_else(|| panic!("{:#?}", compiled.diagnostics))
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
