//! The command: the only place that knows files, terminals, signals and exit codes.
//!
//! | module | what it holds |
//! |---|---|
//! | [`args`] | the flags, their help, and how their values are read |
//! | [`input`] | scene files and standard input to sources |
//! | [`files`] | the disk as a scene may see it |
//! | [`scene`] | a scene with all that it reads, compiled |
//! | [`messages`] | what the compiler says, in the form that was asked for |
//! | [`target`] | where pictures and texts go, and that they arrive there whole or not at all |
//! | [`interrupt`] | Ctrl-C |
//! | [`terminal`] | the one writer to standard error |
//! | [`progress`] | how far a picture is |
//! | [`trace`] | a picture from beginning to end |
//! | [`denoise`] | its noise taken out |
//! | [`animate`] | films, frame by frame |
//! | [`keep`], [`shard`] | what of it is kept on the way, and which share of it is made |
//! | [`live`] | the picture that follows the text |
//! | [`lsp`] | the language server |
//! | [`build`], [`check`], [`develop`], [`expand`], [`explain`], [`export`], [`fmt`], [`info`], [`init`], [`manual`], [`merge`], [`why`] | the commands |

mod animate;
mod args;
mod build;
mod check;
mod claim;
mod denoise;
mod develop;
mod expand;
mod explain;
mod export;
mod files;
mod info;
mod init;
mod fmt;
mod input;
mod interrupt;
mod keep;
mod live;
mod lsp;
mod manual;
mod merge;
mod messages;
mod progress;
mod scene;
mod shard;
mod target;
mod terminal;
mod trace;
mod why;

use args::{Arguments, Command};
use clap::Parser;
use interrupt::Interrupt;
#[cfg(fuzzing)]
pub use lsp::script as session;
use std::process::ExitCode;
use terminal::Terminal;

/// How a command ends. The worst of several is the greatest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Exit {
    /// All is done.
    Done = 0,
    /// A scene has errors, or warnings that are denied.
    Diagnostics = 1,
    /// The command line is wrong, or a file cannot be read or written.
    Usage = 2,
    /// By Ctrl-C or a request to end.
    Interrupted = 130,
}

/// What is wrong with the command line or a file, in one sentence, and what to do.
#[derive(Debug)]
struct Problem {
    message: String,
    help: Option<String>,
    /// Whether another process is at it, so that it may do later.
    busy: bool,
}

impl Problem {
    fn new(message: impl Into<String>) -> Problem {
        Problem { message: message.into(), help: None, busy: false }
    }

    fn help(self, help: impl Into<String>) -> Problem {
        Problem { help: Some(help.into()), ..self }
    }
}

/// What went wrong with a file, as a person says it: without error numbers, and without the name of a temporary
/// file.
fn plain(error: &std::io::Error) -> String {
    let text = if error.raw_os_error().is_some() { error.to_string() } else { error.kind().to_string() };
    text.split(" (os error").next().unwrap_or_default().to_lowercase()
}

/// Runs the command that the arguments name.
pub fn main() -> ExitCode {
    std::panic::set_hook(Box::new(report_panic));
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        // Help and version too: they come as an error that prints to standard output and exits with 0.
        Err(error) => {
            let printed = if error.use_stderr() && steers() {
                Terminal::new().line(error.render().to_string().trim_end());
                Ok(())
            } else {
                error.print()
            };
            let code = if printed.is_ok() { error.exit_code() } else { Exit::Usage as i32 };
            return ExitCode::from(code as u8);
        }
    };
    let terminal = Terminal::new();
    let interrupt = Interrupt::install(terminal);
    let ended = match arguments.command {
        Command::Build(build) => build::run(&build, terminal, &interrupt),
        Command::Watch(watch) => live::run(&watch, terminal, &interrupt),
        Command::Check(check) => check::run(&check, terminal, &interrupt),
        Command::Develop(develop) => develop::run(&develop, terminal, &interrupt),
        Command::Explain(explain) => explain::run(&explain),
        Command::Expand(expand) => expand::run(&expand, terminal, &interrupt),
        Command::Export(export) => export::run(&export, terminal, &interrupt),
        Command::Info(info) => info::run(&info, terminal),
        Command::Init(init) => init::run(&init),
        Command::Completions(completions) => manual::completions(&completions),
        Command::Merge(merge) => merge::run(&merge, terminal, &interrupt),
        Command::Man(man) => manual::man(&man),
        Command::Lsp(lsp) => lsp::run(&lsp, &interrupt),
        Command::Fmt(fmt) => fmt::run(&fmt, terminal, &interrupt),
        Command::Why(why) => why::run(&why, terminal),
    };
    let exit = ended.unwrap_or_else(|problem| {
        terminal.problem(&problem);
        Exit::Usage
    });
    ExitCode::from(exit as u8)
}

/// Whether an argument, which a star may have made of the name of a file, could steer the terminal that it is quoted on.
fn steers() -> bool {
    std::env::args_os().any(|argument| argument.to_string_lossy().contains(char::is_control))
}

/// A panic is a bug here, whatever the input was; the exit code is then 101.
fn report_panic(panic: &std::panic::PanicHookInfo<'_>) {
    let message = panic.payload_as_str().unwrap_or("no message");
    let place = panic.location().map_or_else(String::new, |at| format!(" at {at}"));
    Terminal::new().line(&format!(
        "rtc {} failed{place}: {message}\nThis is a bug in rtc. Please report it with these lines and the scene.",
        env!("CARGO_PKG_VERSION")
    ));
}
