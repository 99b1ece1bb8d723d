//! The README's commands, run as a reader would.

use super::{Outcome, Place, run};
use std::fs;
use std::process::Command;

/// Clones HEAD and runs every fenced block marked `sh` there, in order, in one shell that stops at the first
/// failure. Blocks with another mark (such as `text` for how to get the project) are only read.
pub fn commands(place: &Place) -> Outcome {
    let clone = place.desk.join("clone");
    run(Command::new("git").args(["clone", "--quiet"]).arg(&place.root).arg(&clone))?;
    let readme =
        fs::read_to_string(clone.join("README.md")).map_err(|error| format!("README.md: {error}"))?;
    let script = blocks(&readme, "sh").join("\n");
    if script.is_empty() {
        return Err("README.md has no block marked `sh`".into());
    }
    // Kept between runs, so that only what changed is compiled; the desk is emptied.
    let target = place.desk.with_file_name("readme-target");
    let mut shell = Command::new("bash");
    // The first command builds `rtc`; those behind it find it as if it were installed.
    let known = std::env::var_os("PATH").unwrap_or_default();
    let folders = std::iter::once(target.join("release")).chain(std::env::split_paths(&known));
    let path = std::env::join_paths(folders).map_err(|error| format!("PATH: {error}"))?;
    shell.args(["-euxo", "pipefail", "-c", &script]).current_dir(&clone);
    shell.env("CARGO_TARGET_DIR", target).env("PATH", path);
    run(&mut shell)
}

/// The contents of the fenced blocks with this mark.
fn blocks(markdown: &str, mark: &str) -> Vec<String> {
    let mut blocks = vec![];
    let mut lines = markdown.lines();
    while let Some(line) = lines.next() {
        let Some(found) = line.strip_prefix("```") else { continue };
        let block: Vec<&str> = lines.by_ref().take_while(|line| !line.starts_with("```")).collect();
        if found.trim() == mark {
            blocks.push(block.join("\n"));
        }
    }
    blocks
}

#[cfg(test)]
mod tests {
    use super::blocks;

    #[test]
    fn finds_the_blocks_of_a_mark() {
        let text = "a\n```sh\none\ntwo\n```\n```rt\nsphere {}\n```\n```sh\nthree\n```\n";
        assert_eq!(blocks(text, "sh"), ["one\ntwo", "three"]);
        assert_eq!(blocks(text, "text"), [""; 0]);
    }
}
