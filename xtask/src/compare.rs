//! Our pictures beside those of other renderers: speed, error, memory.

use super::{Outcome, root, run, tools};
use std::path::PathBuf;
use std::process::Command;

/// Rounds, unless `--rounds` says so.
const ROUNDS: u32 = 5;

/// Renders scenes in turns with the peers, and prints the tables.
pub fn compare(arguments: &[String]) -> Outcome {
    let (rounds, scenes) = match arguments {
        [flag, rounds, scenes @ ..] if flag == "--rounds" => (rounds.parse().ok(), scenes),
        scenes => (Some(ROUNDS), scenes),
    };
    let Some(rounds) = rounds.filter(|rounds| *rounds > 0) else {
        return Err("--rounds wants a whole number above 0".into());
    };
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
    script.arg(&root).arg(&desk).arg(rounds.to_string()).args(scenes);
    run(script.env("DRJIT_LIBLLVM_PATH", tools::LLVM))
}
