//! `rtc check`: looks for mistakes, and makes no picture.

use super::Exit;
use super::args::Check;
use super::input;
use super::terminal::Terminal;
use rt_lang::diagnostic::any_errors;
use rt_lang::files::NoFiles;
use rt_lang::{Options, compile};
use std::path::Path;

/// Checks every file, also those behind one that fails.
pub fn run(arguments: &Check, terminal: Terminal) -> Exit {
    let exits = arguments.files.iter().map(|file| check(file, terminal));
    exits.max().unwrap_or(Exit::Done)
}

fn check(file: &Path, terminal: Terminal) -> Exit {
    let mut input = match input::read(file) {
        Ok(input) => input,
        Err(problem) => {
            terminal.problem(&problem);
            return Exit::Usage;
        }
    };
    let diagnostics = match input.refused {
        Some(refused) => vec![refused],
        None => compile(&NoFiles, &mut input.sources, input.id, &Options::default()).diagnostics,
    };
    terminal.diagnostics(&diagnostics, &input.sources);
    if any_errors(&diagnostics) { Exit::Diagnostics } else { Exit::Done }
}
