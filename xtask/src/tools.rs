//! Programs of others that steps need.

use super::{Outcome, run};
use std::process::Command;

/// Has a program at hand: it is there, or is installed from Debian where whoever runs this may do that.
pub fn program(name: &str, package: &str) -> Outcome {
    if found(name) {
        return Ok(());
    }
    let installed = debian(&["update", "-qq"]).and_then(|()| debian(&["install", "-y", "-qq", package]));
    match installed {
        Ok(()) if found(name) => Ok(()),
        Ok(()) => Err(format!("the package {package} is installed and has no `{name}`")),
        Err(why) => {
            Err(format!("`{name}` is needed, of Debian's package {package}, and is not there: {why}"))
        }
    }
}

/// Whether the shell knows a program.
fn found(name: &str) -> bool {
    Command::new("sh").args(["-c", "command -v \"$0\" > /dev/null", name]).status().is_ok_and(|s| s.success())
}

fn debian(arguments: &[&str]) -> Outcome {
    run(Command::new("apt-get").env("DEBIAN_FRONTEND", "noninteractive").args(arguments))
}
