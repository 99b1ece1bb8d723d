//! The one writer to standard error. What cannot be written there is lost, and that is no reason to stop.

use super::Problem;
use anstream::{AutoStream, ColorChoice};
use rt_lang::diagnostic::Diagnostic;
use rt_lang::report::{self, Style, printable_lines};
use rt_lang::source::Sources;
use std::io::{IsTerminal, Write, stderr};

/// Columns where there is no terminal to ask.
const WIDTH: usize = 100;

/// What standard error is, and how text on it looks.
#[derive(Clone, Copy, Debug)]
pub struct Terminal {
    /// Whether a person may be watching.
    pub interactive: bool,
    style: Style,
    /// Whether nothing is written.
    silent: bool,
}

impl Terminal {
    /// Looks at standard error and the environment: `NO_COLOR`, `CLICOLOR`, `CLICOLOR_FORCE`, `TERM` and the
    /// locale.
    pub fn new() -> Terminal {
        let interactive = stderr().is_terminal();
        let color = AutoStream::choice(&stderr()) != ColorChoice::Never;
        let width = terminal_size::terminal_size_of(stderr()).map_or(WIDTH, |(width, _)| width.0.into());
        let unicode = !interactive || locale_is_unicode();
        Terminal { interactive, style: Style { color, unicode, width }, silent: false }
    }

    /// One on which nobody reads.
    pub fn silent() -> Terminal {
        let style = Style { color: false, unicode: true, width: WIDTH };
        Terminal { interactive: false, style, silent: true }
    }

    /// How text on it looks.
    pub fn style(self) -> Style {
        self.style
    }

    /// Writes a line, or several. What it names may come from a file, and cannot steer the terminal.
    pub fn line(self, text: &str) {
        self.text(&format!("{}\n", printable_lines(text)));
    }

    /// Says what is wrong with the command or a file.
    pub fn problem(self, problem: &Problem) {
        self.labelled("error:", "\u{1b}[1;31m", problem);
    }

    /// Says what is wrong and does not keep what was asked for from being done.
    pub fn warning(self, problem: &Problem) {
        self.labelled("warning:", "\u{1b}[1;33m", problem);
    }

    fn labelled(self, label: &str, color: &str, problem: &Problem) {
        let (on, off) = if self.style.color { (color, "\u{1b}[0m") } else { ("", "") };
        self.text(&format!("{on}{label}{off} {}\n", printable_lines(&problem.message)));
        if let Some(help) = &problem.help {
            self.line(&format!("  help: {help}"));
        }
    }

    /// Shows what the compiler has to say.
    pub fn diagnostics(self, diagnostics: &[Diagnostic], sources: &Sources) {
        self.text(&report::all(diagnostics, sources, self.style));
    }

    /// Writes a report, which has its line ends and, maybe, colours.
    pub fn text(self, text: &str) {
        if self.silent {
            return;
        }
        let mut stderr = stderr().lock();
        let _ = stderr.write_all(text.as_bytes()).and_then(|()| stderr.flush());
    }
}

/// Whether the locale's characters are UTF-8; where none is set, they are taken to be.
fn locale_is_unicode() -> bool {
    let set = ["LC_ALL", "LC_CTYPE", "LANG"].into_iter().filter_map(std::env::var_os);
    let locale = set.into_iter().find(|value| !value.is_empty());
    locale.is_none_or(|locale| {
        let locale = locale.to_string_lossy().to_ascii_lowercase();
        locale.contains("utf-8") || locale.contains("utf8")
    })
}
