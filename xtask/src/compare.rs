//! Our pictures beside those of other renderers: speed, error, memory.

use super::{Outcome, root, run, tools};
use std::path::PathBuf;
use std::process::Command;

/// Rounds, unless `--rounds` says so.
const ROUNDS: u32 = 5;

/// Seconds for the rounds of a scene, unless `--budget` says so.
const BUDGET: u32 = 90;

/// Renders scenes in turns with the peers, and prints the tables.
pub fn compare(arguments: &[String]) -> Outcome {
    let (mut rounds, mut budget, mut scenes) = (ROUNDS, BUDGET, arguments);
    while let [flag, value, rest @ ..] = scenes {
        let number = match flag.as_str() {
            "--rounds" => &mut rounds,
            "--budget" => &mut budget,
            _ => break,
        };
        let whole = value.parse().ok().filter(|whole| *whole > 0);
        *number = whole.ok_or_else(|| format!("{flag} wants a whole number above 0"))?;
        scenes = rest;
    }
    let root = root()?;
    tools::povray()?;
    tools::llvm()?;
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), PathBuf::from);
    let python = tools::mitsuba(&target.join("e2e/mitsuba"))?;
    let desk = target.join("compare");
    std::fs::create_dir_all(&desk).map_err(|error| format!("{}: {error}", desk.display()))?;
    run(Command::new("cargo").args(["build", "--release", "--quiet", "--bin", "rtc"]).current_dir(&root))?;
    let mut script = Command::new(&python);
    script.arg(root.join("xtask/compare/compare.py")).arg(target.join("release/rtc")).arg(&python);
    script.arg(&desk).arg(rounds.to_string()).arg(budget.to_string()).args(scenes);
    run(script.env("DRJIT_LIBLLVM_PATH", tools::LLVM).env("PYTHONDONTWRITEBYTECODE", "1"))
}
