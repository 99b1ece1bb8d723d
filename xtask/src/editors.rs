//! The packages for editors, in the editors themselves: Neovim, Vim, Emacs, and what Visual Studio Code is given.

use super::preview::browser;
use super::{Outcome, Place, fresh, root, run, tools};
use std::path::{Path, PathBuf};
use std::process::Command;

/// All of them, one behind the other.
pub fn checks(place: &Place) -> Outcome {
    generator(&place.root, &["--check"])?;
    println!("  grammar: the parser is that of grammar.js");
    neovim(place)?;
    vim(place)?;
    emacs(place)?;
    code(place)
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

/// An editor that sees only what it is given.
fn alone(program: &Path, place: &Place) -> Command {
    let mut command = Command::new(program);
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
    let mut checks = alone(program.as_ref(), place);
    checks.env("PLAYWRIGHT", browser).args(["--headless", "-u"]).arg(script(place, "neovim.lua"));
    run(&mut checks)?;
    let look = "set termguicolors number signcolumn=yes wrap | colorscheme habamax";
    let messages = "lua vim.diagnostic.config({ virtual_lines = true })";
    let init = script(place, "init.lua");
    screen(place, "neovim", &[&program, "-u", &init, "-c", look, "-c", messages])
}

fn vim(place: &Place) -> Outcome {
    tools::vim()?;
    let checks = script(place, "vim.vim");
    let bare = ["-N", "-u", "NONE", "-i", "NONE"];
    run(alone("vim".as_ref(), place).args(bare).args(["-e", "-s", "-S"]).arg(checks))?;
    let init = script(place, "init.vim");
    screen(place, "vim", &["vim", "-N", "-i", "NONE", "-u", &init, "-c", "silent make | copen | wincmd p"])
}

/// A picture of an editor in a terminal, left for whoever wants to look.
fn screen(place: &Place, name: &str, editor: &[&str]) -> Outcome {
    tools::chromium()?;
    let python = tools::terminal(&place.desk.with_file_name("pyte"))?;
    let file = |kind: &str| place.desk.join(name).with_extension(kind);
    let (page, picture) = (file("html"), file("png"));
    run(alone(&python, place).arg(script(place, "screen.py")).arg(&page).args(editor))?;
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

fn emacs(place: &Place) -> Outcome {
    tools::emacs()?;
    let byte_compiled = place.desk.join("compiled");
    fresh(&byte_compiled)?;
    let strict = "(setq byte-compile-error-on-warn t)";
    let mut compile = alone("emacs".as_ref(), place);
    compile.args(["--batch", "--eval", strict, "-L"]).arg(&byte_compiled).args(["-f", "batch-byte-compile"]);
    for file in ["rt-mode.el", "rt-eglot.el"] {
        let copy = byte_compiled.join(file);
        std::fs::copy(place.root.join("editors/emacs").join(file), &copy)
            .map_err(|error| error.to_string())?;
        compile.arg(copy);
    }
    run(&mut compile)?;
    run(alone("emacs".as_ref(), place).args(["--batch", "-l", &script(place, "emacs.el")]))?;
    screen(place, "emacs", &["emacs", "-nw", "-q", "-l", &script(place, "screen.el")])
}

/// Visual Studio Code itself cannot be had here: its package is checked, its colours are tested, and it is packed.
fn code(place: &Place) -> Outcome {
    let folder = place.root.join("editors/vscode");
    tools::packages(&folder)?;
    let npm =
        |arguments: &[&str]| run(Command::new("npm").arg("--silent").args(arguments).current_dir(&folder));
    npm(&["run", "test"])?;
    let package = place.desk.join("rt-lang.vsix");
    npm(&["run", "package", "--", "--out", &package.to_string_lossy()])?;
    println!("  vscode: {}", package.display());
    Ok(())
}
