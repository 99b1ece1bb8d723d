//! The preview in a browser: Debian's Chromium on the page of the built command, driven by playwright-core from npm.

use super::{Outcome, Place, fresh, root, run, tools};
use std::path::{Path, PathBuf};
use std::process::Command;

/// What the page must do, and what it must refuse.
pub fn checks(place: &Place) -> Outcome {
    let tools = browser(&place.desk)?;
    script(&place.root, "main.mjs", &place.rtc, &tools, &place.desk, &[])
}

/// How long it takes from a save to the screen, with the release build.
pub fn latency(arguments: &[String]) -> Outcome {
    let root = root()?;
    run(Command::new("cargo").args(["build", "--quiet", "--release", "--bin", "rtc"]).current_dir(&root))?;
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), PathBuf::from);
    let desk = target.join("e2e/latency");
    fresh(&desk)?;
    let tools = browser(&desk)?;
    script(&root, "latency.mjs", &target.join("release/rtc"), &tools, &desk, arguments)
}

fn script(root: &Path, name: &str, rtc: &Path, tools: &Path, desk: &Path, arguments: &[String]) -> Outcome {
    let script = root.join("xtask/e2e/preview").join(name);
    run(Command::new("node").arg(script).arg(rtc).arg(tools).args(arguments).current_dir(desk))
}

/// Has a browser at hand, and what drives it beside a step's folder.
pub fn browser(desk: &Path) -> Result<PathBuf, String> {
    tools::chromium()?;
    let folder = desk.with_file_name("playwright");
    tools::playwright(&folder)?;
    Ok(folder)
}
