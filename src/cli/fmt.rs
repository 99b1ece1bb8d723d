//! `rtc fmt`: lays scenes out in the one way they are written.

use super::args::Fmt;
use super::input::{self, is_standard};
use super::interrupt::Interrupt;
use super::terminal::Terminal;
use super::{Exit, Problem, target};
use rt_lang::diagnostic::any_errors;
use rt_lang::{ide, syntax};
use similar::TextDiff;
use std::ops::RangeInclusive;
use std::path::Path;

/// Formats every file, also those behind one that fails. The worst of them gives the exit code.
pub fn run(arguments: &Fmt, terminal: Terminal, interrupt: &Interrupt) -> Result<Exit, Problem> {
    let mut worst = Exit::Done;
    for file in &arguments.files {
        let exit = one(file, arguments, terminal, interrupt).unwrap_or_else(|problem| {
            terminal.problem(&problem);
            Exit::Usage
        });
        worst = worst.max(exit);
    }
    Ok(worst)
}

fn one(file: &Path, arguments: &Fmt, terminal: Terminal, interrupt: &Interrupt) -> Result<Exit, Problem> {
    let input = input::read(file, syntax::Limits::default().source)?;
    if let Some(refused) = input.refused {
        terminal.diagnostics(&[refused], &input.sources);
        return Ok(Exit::Diagnostics);
    }
    let source = input.sources.get(input.id);
    let (formatted, slips) = syntax::format(input.id, &source.text);
    terminal.diagnostics(&slips, &input.sources);
    let formatted = match &arguments.lines {
        Some(lines) => within(&source.text, &formatted, lines),
        None => formatted,
    };
    let changes = formatted != source.text;
    if arguments.diff && changes {
        target::print_text(&difference(&source.name, &source.text, &formatted))?;
    } else if arguments.check && changes {
        target::print_text(&format!("{}\n", source.name))?;
    } else if !arguments.check && !arguments.diff {
        match is_standard(file) {
            true => target::print_text(&formatted)?,
            false if changes => target::replace(file, formatted.as_bytes(), interrupt)?,
            false => {}
        }
    }
    let fails = any_errors(&slips) || (arguments.check && changes);
    Ok(if fails { Exit::Diagnostics } else { Exit::Done })
}

/// The text with those of its lines laid out that are meant.
fn within(text: &str, formatted: &str, lines: &RangeInclusive<usize>) -> String {
    let upto = |count: usize| text.split_inclusive('\n').take(count).map(str::len).sum();
    let part = upto(lines.start() - 1)..upto(*lines.end());
    let mut out = String::with_capacity(formatted.len());
    let mut kept = 0;
    for (place, laid_out) in ide::differences_within(text, formatted, part) {
        out += &text[kept..place.start];
        out += &laid_out;
        kept = place.end;
    }
    out + &text[kept..]
}

/// What would change, as `diff -u` shows it.
fn difference(name: &str, before: &str, after: &str) -> String {
    TextDiff::from_lines(before, after).unified_diff().header(name, name).to_string()
}
