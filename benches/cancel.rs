//! How long it takes to stop what is traced: from the request to the moment at which all threads are idle.
//!
//! `cargo bench --bench cancel [ROUNDS]`. Prints the median and the 95th percentile.

use rt_lang::render::{Control, Film, Tracer, Window};
use std::sync::Arc;
use std::time::{Duration, Instant};

mod scenes;

/// Rounds, unless another number is given.
const ROUNDS: u32 = 60;

#[expect(clippy::print_stdout, reason = "a table for a person is what this makes")]
fn main() {
    let rounds = std::env::args().skip(1).find_map(|argument| argument.parse().ok()).unwrap_or(ROUNDS);
    println!("ms                        p50     p95");
    for (name, text) in [("a room", scenes::ROOM.to_string()), ("many balls", scenes::balls(100_000))] {
        let scene = scenes::scene(&text);
        let tracer = Tracer::new(&scene);
        let scale = tracer.prepass().scale;
        let window = Window::whole(scene.trace.size);
        let paths = |control: &Control| {
            let stopped = tracer.add_samples(&mut Film::new(window, scale), 0..1 << 16, control);
            assert!(stopped.is_err(), "there is work for hours");
        };
        println!("{}", times(&format!("{name}, paths"), rounds, paths));
    }
    let scene = scenes::scene(scenes::ROOM);
    let photons = |control: &Control| while Tracer::at_once(&scene, None).find_caustics(control).is_ok() {};
    println!("{}", times("a room, photons", rounds, photons));
}

/// Stops some work again and again, at different moments.
fn times(name: &str, rounds: u32, work: impl Fn(&Control)) -> String {
    let mut times: Vec<Duration> = (0..rounds)
        .map(|round| {
            let control = Arc::new(Control::new());
            let other = control.clone();
            // From 20 to 140 ms, by the golden section.
            let wait = 20.0 + 120.0 * (f64::from(round) * 0.618_034).fract();
            let stopper = std::thread::spawn(move || {
                std::thread::sleep(Duration::from_secs_f64(1e-3 * wait));
                let asked = Instant::now();
                other.cancel();
                asked
            });
            work(&control);
            let done = Instant::now();
            done - stopper.join().expect("it only waits")
        })
        .collect();
    times.sort_unstable();
    let at = |share: f64| 1e3 * times[((times.len() - 1) as f64 * share) as usize].as_secs_f64();
    format!("{name:20} {:8.2}{:8.2}", at(0.5), at(0.95))
}
