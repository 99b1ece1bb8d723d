//! A hundred balls to ten million: `cargo bench --bench many`. How fast rays that have nothing to do with each other find
//! what they meet, and what the hierarchy takes. The table is in markdown.
//!
//! Balls stand on a plain as in `xtask/compare/balls.rt`. Rays go as those of paths of five bounces do: from the camera, and
//! on from what they meet in directions of chance; in no order. Times are processor time where the system tells it, as Linux
//! does, and so nearly the same on a busy machine; of several rounds the best counts.

use rt_lang::math::DVec3;
use rt_lang::render::{Strays, Tracer};
use rt_lang::scene::{Primitive, Scene, Shape};
use std::sync::Arc;
use std::time::Instant;

mod scenes;

const ROUNDS: usize = 7;
const RAYS: usize = 400_000;
const BOUNCES: u32 = 5;

#[expect(clippy::print_stdout, reason = "a table for a person is what this makes")]
fn main() {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    println!(
        "| balls | M rays/s, 1 thread | {threads} threads | hidden or not, {threads} threads | built in s, 1 thread | bytes a ball |"
    );
    println!("|---|---|---|---|---|---|");
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("there is one more thread");
    for power in 2..=7 {
        let count = 10_u32.pow(power);
        let scene = balls(count);
        let tracer = Tracer::new(&scene);
        let strays = tracer.strays(RAYS, BOUNCES);
        let alone = rate(&tracer, &strays, None, 1);
        let all = rate(&tracer, &strays, None, threads);
        let hidden = rate(&tracer, &strays, Some(f32::INFINITY), threads);
        let (built, bytes) = one.install(|| timed(|| tracer.hierarchy()));
        let bytes = bytes.expect("more than are tested one by one") as f64 / f64::from(count);
        println!("| {count} | {alone:.2} | {all:.2} | {hidden:.2} | {built:.4} | {bytes:.1} |");
    }
}

/// Millions of rays a second, in all threads together.
fn rate(tracer: &Tracer, strays: &Strays, within: Option<f32>, threads: usize) -> f64 {
    let cast = || strays.len() as f64 / timed(|| tracer.cast(strays, within)).0 / 1e6;
    let round = |_| {
        std::thread::scope(|scope| {
            let threads: Vec<_> = (0..threads).map(|_| scope.spawn(cast)).collect();
            threads.into_iter().map(|thread| thread.join().expect("casting rays cannot fail")).sum()
        })
    };
    (0..ROUNDS).map(round).fold(0.0, f64::max)
}

/// Seconds that something takes, and what it gives.
fn timed<T>(f: impl FnOnce() -> T) -> (f64, T) {
    let (start, before) = (Instant::now(), processor_time());
    let result = f();
    let clock = start.elapsed().as_secs_f64();
    (before.zip(processor_time()).map_or(clock, |(before, after)| after - before), result)
}

/// Seconds of processor time that the thread has had, where the system tells it.
fn processor_time() -> Option<f64> {
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    Some(told.split(' ').next()?.parse::<f64>().ok()? * 1e-9)
}

/// So many on a plain, as the script has them; made here, since text would take longer than all the rest.
fn balls(count: u32) -> Scene {
    let side = f64::from(count).sqrt().ceil();
    let text = format!(
        "sphere {{ radius: 20cm }}
         plane {{ }}
         sky {{ }}
         camera {{ from: (0, 0.3 * {side:?}, 0.7 * {side:?})m, look: (0, 0, 0)m }}"
    );
    let mut scene = scenes::scene(&text);
    let (mut random, mut all) = (Random(1), vec![]);
    let ball = scene.primitives[0].clone();
    for i in 0..count {
        let x = f64::from(i) % side + 0.5 - side / 2.0 + 0.3 * random.next();
        let z = (f64::from(i) / side).floor() + 0.5 - side / 2.0 + 0.3 * random.next();
        let shape = Shape::Sphere { center: DVec3::new(x, 0.35, z), radius: 0.2 + 0.15 * random.next() };
        all.push(Primitive { shape, ..ball.clone() });
    }
    let primitives = Arc::make_mut(&mut scene.primitives);
    primitives.remove(0);
    primitives.append(&mut all);
    scene
}

/// Numbers in [0, 1) (Steele, Lea and Flood, "Fast splittable pseudorandom number generators", 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ z >> 31) >> 11) as f64 / (1_u64 << 53) as f64
    }
}
