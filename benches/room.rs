//! The room of giant spheres on each set of vector instructions, beside the oracle of the tests, turn by turn in one run:
//! `cargo bench --bench room`. The table has the median of the rounds, in millions of camera paths a second.
//!
//! What other work on the machine takes, it takes from all of them: compare the ratios.

use rt_lang::render::{self, Level};
use rt_lang::scene::Scene;
use std::time::Instant;

#[path = "../tests/oracle/mod.rs"]
#[allow(unused, reason = "tests use more of it")]
mod oracle;
mod scenes;

const ROUNDS: usize = 5;
const SAMPLES: u32 = 16;
const SIZE: [u32; 2] = [320, 240];

const ROOM: &str = "
    let wall = sphere { radius: 940m }
    wall { at: (-1000, 0, 0)m, material: diffuse { color: rgb(0.75, 0.15, 0.15) } }
    wall { at: (1000, 0, 0)m, material: diffuse { color: rgb(0.15, 0.75, 0.15) } }
    wall { at: (0, 0, -1000)m, material: diffuse { color: rgb(0.15, 0.15, 0.75) } }
    wall { at: (0, 0, 1000)m, material: diffuse { color: rgb(0.75, 0.15, 0.75) } }
    wall { at: (0, -1000, 0)m, material: diffuse { color: rgb(0.5, 0.5, 0.5) } }
    wall { at: (0, 1000, 0)m, material: diffuse { color: rgb(0.5, 0.5, 0.5) } }
    let ball = sphere { radius: 10m }
    ball { at: (-20, -4, -8)m, material: diffuse { color: rgb(0.8, 0.8, 0.8) } }
    ball { at: (0, 4, -18)m, material: mirror { color: rgb(0.9, 0.9, 0.9) } }
    ball { at: (18, -6, 4)m, material: dielectric { ior: 1.5 } }
    sphere { at: (-10, 20, 40)m, radius: 5m, material: emitter { radiance: 150W/m2 } }
    camera { from: (0, 0, 55)m, look: (0, 0, 54)m, fov: 60deg }
    render { size: (320, 240), bounces: 7, filter: box }
";

fn main() {
    let scene = scenes::scene(ROOM);
    let levels: Vec<Level> = Level::ALL.into_iter().filter(|level| level.is_there()).collect();
    let mut times = vec![vec![]; levels.len() + 1];
    for _ in 0..ROUNDS {
        for (level, times) in levels.iter().zip(&mut times) {
            times.push(timed(|| lanes(&scene, *level)));
        }
        times[levels.len()].push(timed(|| reference(&scene)));
    }
    let paths = f64::from(SIZE[0] * SIZE[1] * SAMPLES);
    let rate = |times: &mut Vec<f64>| {
        times.sort_unstable_by(f64::total_cmp);
        paths / times[times.len() / 2] / 1e6
    };
    let rates: Vec<f64> = times.iter_mut().map(rate).collect();
    let oracle = rates[levels.len()];
    let mut table = format!("{} threads\n", rayon::current_num_threads());
    for (level, rate) in levels.iter().zip(&rates) {
        table += &format!("{:8} {rate:7.3} Ms/s, {:5.2} × the oracle\n", format!("{level:?}"), rate / oracle);
    }
    table += &format!("oracle   {oracle:7.3} Ms/s\n");
    #[expect(clippy::print_stdout, reason = "it is what the benchmark is for")]
    {
        print!("{table}");
    }
}

fn timed(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64()
}

fn lanes(scene: &Scene, level: Level) {
    let tracer = render::Tracer::new(scene).on(level);
    let mut film = render::Film::new(render::Window::whole(SIZE), 1.0);
    tracer.add_samples(&mut film, 0..SAMPLES, &render::Control::new()).expect("nobody cancels");
}

fn reference(scene: &Scene) {
    let tracer = oracle::Tracer::new(scene);
    let mut film = oracle::Film::new(oracle::Window::whole(SIZE), 1.0);
    tracer.add_samples(&mut film, 0..SAMPLES, &oracle::Control::new()).expect("nobody cancels");
}
