//! What needs more than Rust: `cargo xtask e2e` runs the command on a real terminal, on a full disk, killed again and
//! again, on a farm, within little memory, against another renderer, in a browser and in editors, and as the README says.
//!
//! Nothing is skipped quietly. A tool that is missing fails the step that needs it, with its name.

mod compare;
mod denoise;
mod editors;
mod export;
mod lsp;
mod newer;
mod preview;
mod processors;
mod readme;
mod reference;
mod tools;

use std::collections::VecDeque;
use std::fs;
use std::io::{self, BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::sync::mpsc;
use std::thread;
use std::time::{Duration, Instant};

/// What a step ends with: nothing, or why it failed.
type Outcome = Result<(), String>;

/// Does one thing in its place.
type Step = fn(&Place) -> Outcome;

/// The steps of `e2e`, in order. All but those of [`NAMED`] are run where none is named.
const STEPS: &[(&str, Step)] = &[
    ("terminal", terminal),
    ("full-disk", full_disk),
    ("resume", resume),
    ("farm", farm),
    ("memory", memory),
    ("dependencies", dependencies),
    ("reference", reference::agreement),
    ("export", export::agreement),
    ("preview", preview::checks),
    ("mattes", mattes),
    ("editors", editors::checks),
    ("newer-editors", editors::newer),
    ("processors", processors::same_bits),
    ("arm", processors::same_bits_on_arm),
    ("readme", readme::commands),
];

/// One needs a part of Rust that no distribution has, the other a Debian that changes from day to day.
const NAMED: [&str; 2] = ["arm", "newer-editors"];

const USAGE: &str = "\
cargo xtask gallery

  makes the pictures of docs/gallery anew, in about ten minutes on two cores

cargo xtask compare [--rounds N] [--budget SECONDS] [SCENE…]

  renders scenes in turns with Mitsuba and POV-Ray, best on an idle machine, and prints what each took; the rounds of
  a scene end when there were enough or its seconds are spent, and references are kept in target/compare

cargo xtask denoise

  renders scenes at few and many samples, and prints how far they are from a converged picture with their noise and without
  (some ten minutes on two cores)

cargo xtask latency [ROUNDS]

  drives the page of `rtc watch` in Chromium, on an idle machine, and prints how long a save takes to be seen

cargo xtask many

  builds a thousand to ten million balls, on an idle machine, and prints what memory and time they take

cargo xtask grammar

  makes the parser of editors/tree-sitter-rt from its grammar.js (node)

cargo xtask lsp

  types into a document of 2 000 lines, on an idle machine, and prints how soon the language server answers

cargo xtask e2e [STEP…]

  terminal   progress on a pseudo-terminal, scenes that would steer it, and Ctrl-C
  full-disk  a disk that fills up while a picture is written
  resume     builds that are killed 200 times and go on, to the same bytes: pictures of so many samples and of so little noise, a
             share and a film; signals while they write, and a full disk (minutes)
  farm       five workers of a real Slurm, of which one is lost midway, by the lines of its README (slurmctld, slurmd and munge, of Debian; as root)
  memory     every limit, hostile sources and files, and a million balls, each within a cap on its address space (minutes)
  dependencies what others wrote: its licences and sources, bans, checksums, versions that were taken back, which crates.io is
             asked for, and advisories where RustSec's database is at hand
  reference  the room against a converged picture of another renderer (minutes)
  export     exported scenes against Mitsuba (from PyPI) and POV-Ray (povray, of Debian)
  preview    the page of `rtc watch` in a browser (chromium, of Debian; playwright-core, from npm, which needs node)
  mattes     Cryptomatte by an independent reader (from PyPI)
  editors    the packages for editors, in Neovim (from PyPI), Vim, Emacs (vim, emacs-nox and elpa-eglot, of Debian) and as
             what Visual Studio Code is given (node and npm); pictures of them, and a preview, in chromium, of Debian
  newer-editors the same in Emacs 30 with tree-sitter, and Helix (of Debian's next release, unpacked; only where it is named)
  processors the same bytes on other x86-64 processors, by emulation (qemu-user)
  arm        the same on an ARM with NEON (gcc-aarch64-linux-gnu, and rustup for its standard library; only where it is named)
  readme     every command of the README, in a fresh clone of HEAD

Without STEP all but arm are run. Needs python3, bash, git and, for full-disk, leave to mount a tmpfs. What else a step needs
it installs, from Debian, PyPI or npm, or says that it cannot.";

/// Where things are.
struct Place {
    /// The repository.
    root: PathBuf,
    /// The built command.
    rtc: PathBuf,
    /// A folder for the step, empty at its start.
    desk: PathBuf,
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let ended = match arguments.split_first() {
        Some((task, steps)) if task == "e2e" => e2e(steps),
        Some((task, [])) if task == "gallery" => gallery(),
        Some((task, [])) if task == "many" => many(),
        Some((task, [])) if task == "denoise" => denoise::table(),
        Some((task, [])) if task == "grammar" => editors::grammar(),
        Some((task, arguments)) if task == "compare" => compare::compare(arguments),
        Some((task, arguments)) if task == "lsp" => lsp::latency(arguments),
        Some((task, arguments)) if task == "latency" => preview::latency(arguments),
        _ => Err(USAGE.into()),
    };
    match ended {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            eprintln!("{why}");
            ExitCode::FAILURE
        }
    }
}

fn e2e(wanted: &[String]) -> Outcome {
    if let Some(unknown) = wanted.iter().find(|name| STEPS.iter().all(|(known, _)| known != name)) {
        return Err(format!("no step `{unknown}`\n\n{USAGE}"));
    }
    let root = root()?;
    run(Command::new("cargo").args(["build", "--quiet", "--bin", "rtc"]).current_dir(&root))?;
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), PathBuf::from);
    let mut failed = vec![];
    let is_wanted = |name: &str| match wanted {
        [] => !NAMED.contains(&name),
        wanted => wanted.iter().any(|w| w == name),
    };
    for (name, step) in STEPS.iter().filter(|(name, _)| is_wanted(name)) {
        println!("e2e {name}");
        let desk = target.join("e2e").join(name);
        let place = Place { root: root.clone(), rtc: root.join(&target).join("debug/rtc"), desk };
        let start = Instant::now();
        match fresh(&place.desk).and_then(|()| step(&place)) {
            Ok(()) => println!("e2e {name}: passed in {:.1} s", start.elapsed().as_secs_f64()),
            Err(why) => {
                println!("e2e {name}: FAILED: {}", why.lines().next().unwrap_or_default());
                failed.push(format!("{name}: {why}"));
            }
        }
    }
    if failed.is_empty() { Ok(()) } else { Err(format!("e2e failed:\n{}", failed.join("\n"))) }
}

/// The pictures that the README shows, beside the figures of the report: scene and size.
const GALLERY: &[(&str, &str)] = &[
    ("three-balls", "480x360"),
    ("marbles", "480x270"),
    ("garden/garden", "480x270"),
    ("sphereflake", "360x270"),
    ("one-weekend", "480x270"),
    ("newton", "360x270"),
    ("hyperboloid-tower", "270x360"),
];

/// Makes the pictures that the README shows.
fn gallery() -> Outcome {
    let root = root()?;
    let examples = root.join("examples");
    let shown = GALLERY.iter().map(|(name, size)| (examples.join(name).with_extension("rt"), *size));
    let mut scenes: Vec<(PathBuf, &str)> = shown.collect();
    let report =
        fs::read_dir(examples.join("report")).map_err(|error| format!("examples/report: {error}"))?;
    let figures = report.flatten().map(|entry| entry.path());
    scenes.extend(
        figures.filter(|path| path.extension().is_some_and(|e| e == "rt")).map(|path| (path, "320x240")),
    );
    for (scene, size) in scenes {
        let name = scene.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let picture = root.join("docs/gallery").join(format!("{name}.png"));
        let mut build = Command::new("cargo");
        build.args([
            "run",
            "--quiet",
            "--release",
            "--bin",
            "rtc",
            "--",
            "build",
            "--samples",
            "256",
            "--size",
            size,
        ]);
        run(build.arg(&scene).arg("-o").arg(picture).current_dir(&root))?;
    }
    Ok(())
}

/// Measures scenes of ever more balls.
fn many() -> Outcome {
    let root = root()?;
    run(Command::new("cargo").args(["build", "--quiet", "--release", "--bin", "rtc"]).current_dir(&root))?;
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), PathBuf::from);
    let rtc = root.join(target).join("release/rtc");
    run(Command::new("python3").arg(root.join("xtask/compare/many.py")).arg(rtc).arg(&root))
}

/// The folder of the repository.
fn root() -> Result<PathBuf, String> {
    Ok(Path::new(env!("CARGO_MANIFEST_DIR")).parent().ok_or("xtask has no parent folder")?.to_path_buf())
}

/// Empties a folder, or makes it.
fn fresh(folder: &Path) -> Outcome {
    if folder.exists() {
        fs::remove_dir_all(folder).map_err(|error| format!("cannot empty {}: {error}", folder.display()))?;
    }
    fs::create_dir_all(folder).map_err(|error| format!("cannot make {}: {error}", folder.display()))
}

/// How many lines of a program that failed are said again at the end, where they are looked for.
const LAST_LINES: usize = 24;

/// Runs a program to its end; its output is shown as it comes.
fn run(command: &mut Command) -> Outcome {
    let program = command.get_program().to_string_lossy().into_owned();
    let broken = |error: io::Error| format!("{program} is needed and does not start: {error}");
    let (output, input) = io::pipe().map_err(broken)?;
    command.stdout(input.try_clone().map_err(broken)?).stderr(input).env("PYTHONUNBUFFERED", "1");
    let mut child = command.spawn().map_err(broken)?;
    // The command would hold the pipe open.
    command.stdout(Stdio::inherit()).stderr(Stdio::inherit());
    let (send, lines) = mpsc::channel();
    thread::spawn(move || {
        for line in BufReader::new(output).split(b'\n').map_while(Result::ok) {
            let line = String::from_utf8_lossy(&line).into_owned();
            println!("{line}");
            if send.send(line).is_err() {
                return;
            }
        }
    });
    let status = child.wait().map_err(broken)?;
    // What it has left behind may hold the pipe open for ever, and says nothing that is waited for, however much that is.
    let deadline = Instant::now() + Duration::from_secs(1);
    let next = || lines.recv_timeout(deadline.checked_duration_since(Instant::now())?).ok();
    let mut last = VecDeque::new();
    while let Some(line) = next() {
        last.push_back(line);
        if last.len() > LAST_LINES {
            last.pop_front();
        }
    }
    match status.success() {
        true => Ok(()),
        false => {
            let said: String = last.iter().map(|line| format!("\n  {line}")).collect();
            Err(format!("{program} ended with {status}; it said last:{said}"))
        }
    }
}

/// Runs one of the scripts in `xtask/e2e` in the step's folder.
fn script(place: &Place, interpreter: &str, name: &str) -> Outcome {
    let script = place.root.join("xtask/e2e").join(name);
    run(Command::new(interpreter).arg(script).arg(&place.rtc).arg(&place.root).current_dir(&place.desk))
}

fn terminal(place: &Place) -> Outcome {
    script(place, "python3", "terminal.py")
}

fn full_disk(place: &Place) -> Outcome {
    script(place, "bash", "full-disk.sh")
}

fn resume(place: &Place) -> Outcome {
    script(place, "python3", "resume.py")
}

fn farm(place: &Place) -> Outcome {
    tools::slurm()?;
    script(place, "bash", "farm.sh")
}

fn memory(place: &Place) -> Outcome {
    script(place, "bash", "memory.sh")
}

fn mattes(place: &Place) -> Outcome {
    let python = tools::cryptomatte(&place.desk.with_file_name("cryptomatte"))?;
    script(place, &python.to_string_lossy(), "mattes.py")
}

fn dependencies(place: &Place) -> Outcome {
    script(place, "python3", "dependencies.py")
}
