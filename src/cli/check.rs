//! `rtc check`: looks for mistakes, and makes no picture; with `--fix`, mends those whose mend is certain.

use super::args::{Check, Reading};
use super::input::{Input, is_standard};
use super::interrupt::Interrupt;
use super::messages::{Messenger, on_standard_output};
use super::scene::{self, Loaded};
use super::target::{Aside, print_text};
use super::terminal::Terminal;
use super::{Exit, Problem};
use rt_lang::lower::Overrides;
use rt_lang::mend::Rounds;
use rt_lang::report;
use rt_lang::source::Source;
use std::path::Path;

/// Checks every file, also those behind one that fails.
pub fn run(arguments: &Check, terminal: Terminal, interrupt: &Interrupt) -> Result<Exit, Problem> {
    let Check { files, fix, reading, messages } = arguments;
    if *fix && files.iter().any(|file| is_standard(file)) {
        if files.len() > 1 {
            return Err(Problem::new("standard input can only be mended alone"));
        }
        if on_standard_output(messages) {
            let problem = Problem::new("the mended scene and the messages would both go to standard output");
            return Err(problem.help("use `--message-format short`, or mend a file"));
        }
    }
    let mut messenger = Messenger::new(messages, terminal, false);
    let mut worst = Exit::Done;
    for file in files {
        let loaded = match fix {
            true => fixed(file, reading, terminal, interrupt),
            false => scene::load(file, reading, &every_camera()),
        };
        worst = worst.max(match loaded {
            Ok(loaded) => messenger.say(&loaded.compiled.diagnostics, &loaded.sources)?,
            Err(problem) => {
                terminal.problem(&problem);
                Exit::Usage
            }
        });
    }
    messenger.finish()?;
    Ok(worst)
}

/// No camera takes a picture here.
fn every_camera() -> Overrides {
    Overrides { every_camera: true, ..Overrides::default() }
}

/// Mends a scene, and gives what is left to say of it.
fn fixed(
    path: &Path,
    reading: &Reading,
    terminal: Terminal,
    interrupt: &Interrupt,
) -> Result<Loaded, Problem> {
    let mut loaded = scene::load(path, reading, &every_camera())?;
    let before = loaded.sources.get(loaded.id).text.clone();
    let refused = loaded
        .compiled
        .diagnostics
        .iter()
        .any(|diagnostic| diagnostic.code == rt_lang::diagnostic::Code::E0009);
    let mut rounds = Rounds::default();
    let mut done = vec![];
    loop {
        let source = loaded.sources.get(loaded.id);
        let mended = rounds.next(&source.text, loaded.id, &loaded.compiled.diagnostics);
        let Some(mended) = mended else { break };
        let said = mended.applied.iter().map(|&index| &loaded.compiled.diagnostics[index]);
        done.extend(said.map(|diagnostic| report::short(diagnostic, &loaded.sources)));
        let input = Input::of(Source::new(source.name.clone(), mended.text));
        loaded = scene::take(path, input, reading, &every_camera())?;
    }
    let text = &loaded.sources.get(loaded.id).text;
    if is_standard(path) {
        if !refused {
            print_text(text)?;
        }
    } else if *text != before {
        let mut aside = Aside::beside(path, interrupt)?;
        aside.write(text.as_bytes())?;
        aside.finish()?;
    }
    done.iter().for_each(|line| terminal.line(&format!("mended {line}")));
    Ok(loaded)
}
