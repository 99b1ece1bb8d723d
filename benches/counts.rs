//! How many instructions small fixed loads take: `cargo bench --bench counts`. Fails where one differs from the table of
//! `benches/counts.md` by more than the tolerance; `cargo bench --bench counts -- --bless` writes the table anew.
//!
//! Each load runs under callgrind in a process of its own, once and twice over; the difference is the load alone. Counts
//! are the same on a busy machine and on an idle one, so that they show what times do not. They depend on the compiler:
//! another version may ask for another table. Callgrind knows AVX2 at most, so tracing is counted on that and on SSE2.
//!
//! Needs `valgrind`. Where a count has grown, `callgrind_annotate target/counts/LOAD.out` says where.

use rt_lang::math::DVec3;
use rt_lang::output::{Depth, Facts, Format, Picture, encode};
use rt_lang::render::{Control, Film, Level, Tracer, Window};
use rt_lang::span::SourceId;
use rt_lang::syntax::parse;
use std::collections::BTreeMap;
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

mod scenes;

/// The share by which a count may differ from the table's.
const TOLERANCE: f64 = 0.02;

/// Something to count.
struct Load {
    name: &'static str,
    what: &'static str,
    /// Does it so many times.
    run: fn(u32),
}

const LOADS: &[Load] = &[
    Load { name: "parsing", what: "two thousand spheres, text to tree", run: parsing },
    Load { name: "compiling", what: "two thousand spheres of a loop, text to scene", run: compiling },
    Load { name: "building", what: "tables and hierarchy over ten thousand balls", run: building },
    Load {
        name: "intersection-sse2",
        what: "32×24 camera rays, a few surfaces",
        run: |n| paths(FEW, Level::Basic, n),
    },
    Load { name: "intersection-avx2", what: "the same", run: |n| paths(FEW, Level::Avx2, n) },
    Load {
        name: "traversal-sse2",
        what: "32×24 camera rays, ten thousand balls",
        run: |n| paths(MANY, Level::Basic, n),
    },
    Load { name: "traversal-avx2", what: "the same", run: |n| paths(MANY, Level::Avx2, n) },
    Load {
        name: "shading-sse2",
        what: "32×24 paths in a room of every material",
        run: |n| paths(PATHS, Level::Basic, n),
    },
    Load { name: "shading-avx2", what: "the same", run: |n| paths(PATHS, Level::Avx2, n) },
    Load { name: "png", what: "160×120 pixels, developed and encoded", run: |n| encoding(Format::Png, n) },
    Load { name: "exr", what: "160×120 pixels, encoded", run: |n| encoding(Format::Exr, n) },
];

/// What is traced: a text, and how many bounces.
type Traced = (fn() -> String, u32);

const FEW: Traced = (|| scenes::ROOM.into(), 0);
const MANY: Traced = (|| scenes::balls(10_000), 0);
const PATHS: Traced = (|| scenes::ROOM.into(), 8);

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|argument| argument != "--bench").collect();
    let told: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match told[..] {
        ["--load", name, times] => {
            // One thread does the work, so that none is counted that looks for some.
            let one = rayon::ThreadPoolBuilder::new().num_threads(1).build_global();
            one.expect("nobody has asked for threads yet");
            let load = LOADS.iter().find(|load| load.name == name).expect("one of the loads");
            (load.run)(times.parse().expect("a number of times"));
            ExitCode::SUCCESS
        }
        [] => counted(false),
        ["--bless"] => counted(true),
        _ => panic!("knows `--bless` alone, not {arguments:?}"),
    }
}

/// Counts all loads, and compares them with the table or writes it.
#[expect(clippy::print_stdout, reason = "a table for a person is what this makes")]
fn counted(bless: bool) -> ExitCode {
    let committed = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/counts.md");
    let table = std::fs::read_to_string(&committed).unwrap_or_default();
    let before: BTreeMap<&str, u64> = table.lines().filter_map(row).collect();
    let mut text = String::from("| load | what it is | thousand instructions |\n|---|---|---|\n");
    let mut off = vec![];
    for Load { name, what, .. } in LOADS {
        let count = (collected(name, 2) - collected(name, 1)) / 1000;
        let row = format!("| {name} | {what} | {count} |\n");
        print!("{row}");
        text.push_str(&row);
        let was = before.get(*name).copied();
        let share = was.map_or(f64::INFINITY, |was| count as f64 / was as f64 - 1.0);
        if share.abs() > TOLERANCE {
            let was = was.map_or("no count".into(), |was| was.to_string());
            off.push(format!("{name} takes {count} in place of {was} ({:+.1} %)", 100.0 * share));
        }
    }
    if bless {
        std::fs::write(&committed, text).expect("the repository can be written to");
        return ExitCode::SUCCESS;
    }
    for line in &off {
        println!("{line}");
    }
    if off.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// The load and the count of a row of the table.
fn row(line: &str) -> Option<(&str, u64)> {
    let cells: Vec<&str> = line.split('|').map(str::trim).collect();
    Some((cells.get(1).copied()?, cells.get(3)?.parse().ok()?))
}

/// The instructions of a process that does a load so many times.
fn collected(load: &str, times: u32) -> u64 {
    let this = std::env::current_exe().expect("this program has a path");
    let target: PathBuf = this.ancestors().nth(3).expect("it lies in target/release/deps").join("counts");
    std::fs::create_dir_all(&target).expect("the target folder can be written to");
    let mut valgrind = Command::new("valgrind");
    valgrind.arg("--tool=callgrind");
    valgrind.arg(format!("--callgrind-out-file={}", target.join(load).with_extension("out").display()));
    valgrind.arg(this).args(["--load", load, &times.to_string()]);
    let ended = valgrind.output().expect("valgrind is installed");
    let told = String::from_utf8_lossy(&ended.stderr);
    let count = told.lines().find_map(|line| line.split_once("Collected :")?.1.trim().parse().ok());
    count.unwrap_or_else(|| panic!("valgrind says no count of {load}:\n{told}"))
}

fn parsing(times: u32) {
    let text = scenes::spheres(2000, |_| String::new());
    for _ in 0..times {
        black_box(parse(SourceId(0), black_box(&text)));
    }
}

fn compiling(times: u32) {
    for _ in 0..times {
        black_box(scenes::scene(&scenes::balls(2000)));
    }
}

fn building(times: u32) {
    let scene = scenes::scene(&scenes::balls(10_000));
    for _ in 0..times {
        black_box(Tracer::new(black_box(&scene)));
    }
}

/// One sample of each pixel.
fn paths((text, bounces): Traced, level: Level, times: u32) {
    let text = format!("{}\nrender {{ size: (32, 24), bounces: {bounces} }}\n", text());
    let scene = scenes::scene(&text);
    let tracer = Tracer::new(&scene).on(level);
    let (window, prepass) = (Window::whole(scene.trace.size), tracer.prepass());
    for sample in 0..times {
        let mut film = Film::new(window, prepass.scale);
        tracer.add_samples(&mut film, sample..sample + 1, &Control::new()).expect("nobody cancels");
        black_box(film);
    }
}

fn encoding(format: Format, times: u32) {
    let size = [160, 120];
    // As smooth and as noisy as pictures are.
    let radiance = |x: u32, y: u32| {
        let noise =
            f64::from(x.wrapping_mul(2_654_435_761).wrapping_add(y.wrapping_mul(40_503)) >> 24) / 2560.0;
        DVec3::new(f64::from(x) / 160.0 + noise, f64::from(y) / 120.0 + noise, 0.3 + noise)
    };
    let picture = Picture::gather(size, [0, 0], size, radiance);
    for _ in 0..times {
        let bytes = encode(black_box(&picture), &Facts::unknown(), format, Depth::Eight);
        black_box(bytes.expect("the formats hold any picture"));
    }
}
