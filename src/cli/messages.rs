//! What the compiler says, in the form that was asked for.

use super::args::{Denied, Messages, Show};
use super::terminal::Terminal;
use super::{Exit, Problem, target};
use rt_lang::diagnostic::{Diagnostic, Severity};
use rt_lang::report::{self, Sarif};
use rt_lang::source::Sources;

/// Says it, and tells how the command ends by it.
pub struct Messenger<'a> {
    wanted: &'a Messages,
    terminal: Terminal,
    /// Whether warnings that are let pass are left out.
    quiet: bool,
    /// Of the whole run.
    sarif: Sarif,
}

impl<'a> Messenger<'a> {
    /// For one run of a command.
    pub fn new(wanted: &'a Messages, terminal: Terminal, quiet: bool) -> Messenger<'a> {
        Messenger { wanted, terminal, quiet, sarif: Sarif::default() }
    }

    /// Says what there is to say of a scene.
    pub fn say(&mut self, diagnostics: &[Diagnostic], sources: &Sources) -> Result<Exit, Problem> {
        let denied: Vec<&Diagnostic> =
            diagnostics.iter().filter(|diagnostic| self.denies(diagnostic)).collect();
        let worth = |diagnostic: &&Diagnostic| {
            !self.quiet || diagnostic.severity() == Severity::Error || self.denies(diagnostic)
        };
        let said: Vec<Diagnostic> = diagnostics.iter().filter(worth).cloned().collect();
        let lines = |line: fn(&Diagnostic, &Sources) -> String| -> String {
            said.iter().map(|diagnostic| line(diagnostic, sources) + "\n").collect()
        };
        match self.wanted.message_format {
            Show::Human => self.terminal.diagnostics(&said, sources),
            Show::Short => self.terminal.text(&lines(report::short)),
            Show::Json => target::print_text(&lines(report::json))?,
            Show::Github => target::print_text(&lines(report::github))?,
            Show::Sarif => said.iter().for_each(|diagnostic| self.sarif.add(diagnostic, sources)),
        }
        if let (Some(first), Show::Human | Show::Short) = (denied.first(), self.wanted.message_format) {
            let which = match denied.as_slice() {
                [_] => format!("the warning {} is", first.code.as_str()),
                more => format!("{} warnings are", more.len()),
            };
            self.terminal.line(&format!("{which} denied by `--deny`"));
        }
        let errors = said.iter().any(|diagnostic| diagnostic.severity() == Severity::Error);
        Ok(if errors || !denied.is_empty() { Exit::Diagnostics } else { Exit::Done })
    }

    /// Ends the run.
    pub fn finish(self) -> Result<(), Problem> {
        match self.wanted.message_format {
            Show::Sarif => target::print_text(&(self.sarif.finish() + "\n")),
            _ => Ok(()),
        }
    }

    fn denies(&self, diagnostic: &Diagnostic) -> bool {
        let meant = |denied: &Denied| match denied {
            Denied::Warnings => diagnostic.severity() == Severity::Warning,
            Denied::Code(code) => *code == diagnostic.code,
        };
        self.wanted.deny.iter().any(meant)
    }
}

/// Whether messages go to standard output.
pub fn on_standard_output(wanted: &Messages) -> bool {
    matches!(wanted.message_format, Show::Json | Show::Github | Show::Sarif)
}
