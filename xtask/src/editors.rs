//! The packages for editors, in the editors themselves: Neovim, Vim, Emacs, and what Visual Studio Code is given.

use super::newer::Newer;
use super::preview::browser;
use super::{Outcome, Place, fresh, root, run, tools};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;

/// All of them, one behind the other.
pub fn checks(place: &Place) -> Outcome {
    generator(&place.root, &["--check"])?;
    println!("  grammar: the parser is that of grammar.js");
    neovim(place)?;
    vim(place)?;
    tools::emacs()?;
    emacs(place, "emacs", &|program| program.iter().map(|word| word.to_string()).collect())?;
    code(place)
}

/// Emacs with tree-sitter, and Helix, from a Debian that this machine need not be.
pub fn newer(place: &Place) -> Outcome {
    let packages = ["emacs-nox", "hx", "gcc", "libc6-dev", "git", "dash", "coreutils", "ncurses-base"];
    let newer = place.desk.with_file_name("newer");
    let shared = [place.root.as_path(), &place.desk, folder(&place.rtc)];
    let newer = Newer::with(&newer, &packages, &shared)?;
    emacs(place, "emacs-nox", &|program| newer.line(program))?;
    helix(place, &newer)
}

/// Makes the parser of the grammar for editors anew.
pub fn grammar() -> Outcome {
    generator(&root()?, &[])
}

/// Runs what makes the parser, which is a workspace by itself.
fn generator(root: &Path, arguments: &[&str]) -> Outcome {
    tools::node()?;
    let manifest = root.join("editors/tree-sitter-rt/generator/Cargo.toml");
    let mut cargo = Command::new("cargo");
    cargo.args(["run", "--quiet", "--locked", "--manifest-path"]).arg(manifest);
    cargo.args(["--target-dir"]).arg(target(root).join("generator")).arg("--").args(arguments);
    run(&mut cargo)
}

fn target(root: &Path) -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), |target| root.join(target))
}

fn script(place: &Place, name: &str) -> String {
    place.root.join("xtask/e2e/editors").join(name).display().to_string()
}

fn folder(file: &Path) -> &Path {
    file.parent().unwrap_or(file)
}

/// An editor, or what has one run, that sees only what it is given.
fn alone<W: AsRef<OsStr>>(line: &[W], place: &Place) -> Command {
    let mut command = Command::new(&line[0]);
    command.args(&line[1..]);
    command.current_dir(&place.desk).env("RTC", &place.rtc).env("ROOT", &place.root).env("HOME", &place.desk);
    for (variable, folder) in [
        ("XDG_CONFIG_HOME", "config"),
        ("XDG_DATA_HOME", "data"),
        ("XDG_STATE_HOME", "state"),
        ("XDG_CACHE_HOME", "cache"),
    ] {
        command.env(variable, place.desk.join(folder));
    }
    command
}

fn neovim(place: &Place) -> Outcome {
    let program = tools::neovim(&place.desk.with_file_name("neovim"))?.display().to_string();
    // For who is at the page of its preview.
    let browser = browser(&place.desk)?;
    let mut checks = alone(&[&program], place);
    checks.env("PLAYWRIGHT", browser).args(["--headless", "-u"]).arg(script(place, "neovim.lua"));
    run(&mut checks)?;
    let look = "set termguicolors number signcolumn=yes wrap | colorscheme habamax";
    let messages = "lua vim.diagnostic.config({ virtual_lines = true })";
    let init = script(place, "init.lua");
    screen(place, "neovim", &[program.as_str(), "-u", &init, "-c", look, "-c", messages])
}

fn vim(place: &Place) -> Outcome {
    tools::vim()?;
    let checks = script(place, "vim.vim");
    let bare = ["-N", "-u", "NONE", "-i", "NONE"];
    run(alone(&["vim"], place).args(bare).args(["-e", "-s", "-S"]).arg(checks))?;
    let init = script(place, "init.vim");
    screen(place, "vim", &["vim", "-N", "-i", "NONE", "-u", &init, "-c", "silent make | copen | wincmd p"])
}

/// A picture of an editor in a terminal, left for whoever wants to look.
fn screen<W: AsRef<OsStr>>(place: &Place, name: &str, editor: &[W]) -> Outcome {
    tools::chromium()?;
    let python = tools::terminal(&place.desk.with_file_name("pyte"))?;
    let file = |kind: &str| place.desk.join(name).with_extension(kind);
    let (page, picture) = (file("html"), file("png"));
    run(alone(&[&python], place).arg(script(place, "screen.py")).arg(&page).args(editor))?;
    let mut browser = Command::new("chromium");
    browser.args([
        "--headless",
        "--no-sandbox",
        "--disable-gpu",
        "--hide-scrollbars",
        "--window-size=960,620",
    ]);
    browser.arg(format!("--screenshot={}", picture.display())).arg(format!("file://{}", page.display()));
    let output = browser.output().map_err(|error| format!("chromium does not start: {error}"))?;
    match output.status.success() && picture.exists() {
        true => {
            println!("  screen: {}", picture.display());
            Ok(())
        }
        false => Err(String::from_utf8_lossy(&output.stderr).into_owned()),
    }
}

/// An Emacs that is run by a command line made of its own.
fn emacs(place: &Place, program: &str, line: &dyn Fn(&[&str]) -> Vec<String>) -> Outcome {
    let byte_compiled = place.desk.join("compiled");
    fresh(&byte_compiled)?;
    let strict = "(setq byte-compile-error-on-warn t)";
    let mut compile = alone(&line(&[program, "--batch", "--eval", strict, "-L"]), place);
    compile.arg(&byte_compiled).args(["-f", "batch-byte-compile"]);
    for file in ["rt-mode.el", "rt-eglot.el"] {
        let copy = byte_compiled.join(file);
        std::fs::copy(place.root.join("editors/emacs").join(file), &copy)
            .map_err(|error| error.to_string())?;
        compile.arg(copy);
    }
    run(&mut compile)?;
    run(&mut alone(&line(&[program, "--batch", "-l", &script(place, "emacs.el")]), place))?;
    screen(place, program, &line(&[program, "-nw", "-q", "-l", &script(place, "screen.el")]))
}

/// Helix, set up by the lines that editors/README.md has for it.
fn helix(place: &Place, newer: &Newer) -> Outcome {
    let readme = std::fs::read_to_string(place.root.join("editors/README.md")).map_err(|e| e.to_string())?;
    let told = readme.split("\n## Helix\n").nth(1).and_then(|part| part.split("```sh\n").nth(1));
    let told =
        told.and_then(|part| part.split("```").next()).ok_or("editors/README.md has no lines for Helix")?;
    let lines = told.replace("/path/to/editors", &place.root.join("editors").to_string_lossy());
    // It looks where the page says, and finds `rtc` on the path.
    let path = format!("PATH={}:/usr/bin:/bin", folder(&place.rtc).display());
    let inside = |program: &[&str]| newer.line(&[&["env", "-u", "XDG_CONFIG_HOME", &path], program].concat());
    let output =
        alone(&inside(&["sh", "-euc", &lines]), place).output().map_err(|error| error.to_string())?;
    let health = String::from_utf8_lossy(&output.stdout).into_owned();
    let works = |what: &str| health.lines().any(|line| line.contains(what) && line.contains('✓'));
    let wanted = ["rtc", "Tree-sitter parser", "Highlight", "Textobject", "Indent"];
    if let Some(lacking) = wanted.iter().find(|what| !works(what)) {
        return Err(format!("no {lacking}\n{health}\n{}", String::from_utf8_lossy(&output.stderr)));
    }
    println!("  helix: it has what it needs");
    screen(place, "helix", &inside(&["hx"]))
}

/// Visual Studio Code itself cannot be had here: its package is checked, its colours are tested, and it is packed.
fn code(place: &Place) -> Outcome {
    let folder = place.root.join("editors/vscode");
    tools::packages(&folder)?;
    let npm = |arguments: &[&str]| {
        run(Command::new("npm").arg("--silent").args(arguments).current_dir(&folder).env("RTC", &place.rtc))
    };
    npm(&["run", "test"])?;
    let package = place.desk.join("rt-lang.vsix");
    npm(&["run", "package", "--", "--out", &package.to_string_lossy()])?;
    println!("  vscode: {}", package.display());
    Ok(())
}
