//! Flags of the commands that make no picture, and those that they share with the ones that do.

use super::values::{Denied, denied};
use clap::builder::TypedValueParser;
use clap::{Args, ValueEnum};
use clap_complete::Shell;
use rt_lang::Options;
use rt_lang::eval::Limits;
use rt_lang::lower::Overrides;
use rt_lang::syntax::{self, MAX_DEPTH, MAX_SOURCE};
use std::path::PathBuf;

/// What a scene may read.
#[derive(Args, Clone, Debug)]
pub struct Reading {
    /// Lets the scene read files below this folder only. By default below its own; a scene from standard input reads
    /// below the current folder.
    #[arg(long, value_name = "DIR")]
    pub root: Option<PathBuf>,

    /// Sets a `param` of the scene: `--set n=12`, `--set 'at=(0, 1, 0)m'`. The value is checked as if it stood in the
    /// scene. May be given several times.
    #[arg(long, value_name = "NAME=EXPR")]
    pub set: Vec<String>,

    /// Refuses scenes of more than this many things.
    #[arg(long, value_name = "N", default_value_t = Limits::default().things, hide_short_help = true)]
    pub max_things: usize,

    /// Refuses parts, groups, imports and calls more levels deep than this.
    #[arg(long, value_name = "N", default_value_t = Limits::default().levels, hide_short_help = true)]
    pub max_levels: usize,

    /// Refuses lists of more items than this.
    #[arg(long, value_name = "N", default_value_t = Limits::default().items, hide_short_help = true)]
    pub max_items: usize,

    /// Refuses scenes that take more steps than this to evaluate.
    #[arg(long, value_name = "N", default_value_t = Limits::default().steps, hide_short_help = true)]
    pub max_steps: u64,

    /// Refuses scene files of more mebibytes than this.
    #[arg(long, value_name = "MIB", default_value_t = Limits::default().text.source >> 20, hide_short_help = true,
        value_parser = mebibytes())]
    pub max_source: usize,

    /// Refuses brackets within each other, and operations, deeper than this.
    #[arg(long, value_name = "N", default_value_t = Limits::default().text.depth, hide_short_help = true,
        value_parser = brackets())]
    pub max_brackets: usize,
}

impl Reading {
    /// What the compiler is told.
    pub fn options(&self, overrides: Overrides) -> Options {
        let Reading { max_things: things, max_levels: levels, max_items: items, max_steps: steps, .. } =
            *self;
        let limits = Limits { things, levels, items, steps, text: self.limits() };
        Options { overrides, set: self.set.clone(), limits, ..Options::default() }
    }

    /// What reading the files may take.
    pub fn limits(&self) -> syntax::Limits {
        syntax::Limits { source: self.max_source << 20, depth: self.max_brackets }
    }
}

/// Places in a source are counted in 32 bits.
fn mebibytes() -> impl TypedValueParser<Value = usize> {
    clap::value_parser!(u64).range(1..=(MAX_SOURCE >> 20) as u64).map(|n| n as usize)
}

fn brackets() -> impl TypedValueParser<Value = usize> {
    clap::value_parser!(u64).range(1..=MAX_DEPTH as u64).map(|n| n as usize)
}

/// Which camera takes the picture that a tool tells of or writes.
#[derive(Args, Clone, Debug, Default)]
pub struct Viewpoint {
    /// Takes the camera of this name, in place of the one that `render` names.
    #[arg(long, value_name = "NAME")]
    pub camera: Option<String>,
}

impl Viewpoint {
    /// What the compiler is told of it.
    pub fn overrides(&self) -> Overrides {
        Overrides { camera: self.camera.clone(), ..Overrides::default() }
    }
}

/// How messages are written, and which warnings are not let pass.
#[derive(Args, Clone, Debug, Default)]
pub struct Messages {
    /// Writes messages in this form: json, github and sarif on standard output, the others on standard error.
    #[arg(long, value_name = "FORM", value_enum, default_value_t = Show::Human, hide_possible_values = true)]
    pub message_format: Show,

    /// Takes warnings for errors: `warnings` is all of them, a code such as `W0106` one. May be given several times.
    #[arg(long, value_name = "WHAT", value_parser = denied)]
    pub deny: Vec<Denied>,
}

/// Value of `--message-format`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Show {
    /// With the place in the text, for people.
    #[default]
    Human,
    /// A line each: file, line, column, severity, code and message.
    Short,
    /// An object a line, described in docs/diagnostics-json.md.
    Json,
    /// Commands that GitHub shows beside the changed lines.
    Github,
    /// One SARIF 2.1.0 document.
    Sarif,
}

pub const CHECK_EXAMPLES: &str = "\
Examples:
  rtc check *.rt                                look through all of them
  rtc check --deny warnings garden.rt           fail on warnings too
  rtc check --fix garden.rt                     mend what is certain
  rtc check --message-format json garden.rt     for programs

Forms of messages:
  human     with the place in the text (the default)
  short     file:line:column: severity[code]: message
  json      an object a line; docs/diagnostics-json.md describes it
  github    commands that GitHub shows beside the changed lines
  sarif     one SARIF 2.1.0 document

Exit codes: 0 nothing is wrong, 1 errors or denied warnings, 2 a file cannot be read or written.";

/// Flags of `rtc check`.
#[derive(Args)]
pub struct Check {
    /// Scenes to look at; `-` is standard input.
    #[arg(value_name = "FILE", required = true)]
    pub files: Vec<PathBuf>,

    /// Makes every mend that is certain, writes the file anew and tells what was done; what is left is reported. Only
    /// the files that are named are mended, not those they import. A scene from standard input goes to standard output.
    #[arg(long)]
    pub fix: bool,

    #[command(flatten)]
    #[allow(missing_docs)]
    pub reading: Reading,

    #[command(flatten)]
    #[allow(missing_docs)]
    pub messages: Messages,
}

pub const EXPLAIN_EXAMPLES: &str = "\
Examples:
  rtc explain E0203       the page on a code; case does not matter
  rtc explain --list      all codes with their titles";

/// Flags of `rtc explain`.
#[derive(Args)]
pub struct Explain {
    /// The code of a message, such as E0203.
    #[arg(value_name = "CODE", required_unless_present = "list", conflicts_with = "list")]
    pub code: Option<String>,

    /// Lists all codes with what they are about.
    #[arg(long)]
    pub list: bool,
}

/// Flags of `rtc expand`.
#[derive(Args)]
pub struct Expand {
    /// The scene; `-` is standard input.
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,

    /// Writes the flat scene here, in place of standard output.
    #[arg(short, long = "output", value_name = "OUT.rt")]
    pub output: Option<PathBuf>,

    #[command(flatten)]
    #[allow(missing_docs)]
    pub viewpoint: Viewpoint,

    #[command(flatten)]
    #[allow(missing_docs)]
    pub reading: Reading,
}

/// Flags of `rtc export`.
#[derive(Args)]
pub struct Export {
    /// The scene; `-` is standard input.
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,

    /// Writes it here, for the renderer of the extension: xml (Mitsuba 3), pbrt (pbrt-v4) or pov (POV-Ray).
    #[arg(short, long = "output", value_name = "OUT", required = true)]
    pub output: PathBuf,

    /// Says nearly what the renderer cannot say exactly, and lists it. Without, it is an error.
    #[arg(long)]
    pub approximate: bool,

    /// Makes triangles, N around, of curved surfaces that the renderer does not know.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(3..=4096))]
    pub tessellate: Option<u32>,

    #[command(flatten)]
    #[allow(missing_docs)]
    pub viewpoint: Viewpoint,

    #[command(flatten)]
    #[allow(missing_docs)]
    pub reading: Reading,
}

/// Flags of `rtc info`.
#[derive(Args)]
pub struct Info {
    /// The scene; `-` is standard input.
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,

    /// Prints one JSON object.
    #[arg(long)]
    pub json: bool,

    #[command(flatten)]
    #[allow(missing_docs)]
    pub viewpoint: Viewpoint,

    #[command(flatten)]
    #[allow(missing_docs)]
    pub reading: Reading,
}

/// Flags of `rtc init`.
#[derive(Args)]
pub struct Init {
    /// The folder, made where there is none. No file in it is replaced.
    #[arg(value_name = "DIR", default_value = ".")]
    pub folder: PathBuf,
}

pub const COMPLETIONS_EXAMPLES: &str = "\
Examples:
  rtc completions bash > ~/.local/share/bash-completion/completions/rtc
  rtc completions zsh > ~/.zfunc/_rtc
  rtc completions fish > ~/.config/fish/completions/rtc.fish";

/// Flags of `rtc completions`.
#[derive(Args)]
pub struct Completions {
    /// The shell.
    #[arg(value_name = "SHELL", value_enum)]
    pub shell: Shell,
}

pub const MAN_EXAMPLES: &str = "\
Examples:
  rtc man | man -l -                            read it
  rtc man --dir ~/.local/share/man/man1         install it, with a page a command";

/// Flags of `rtc man`.
#[derive(Args)]
pub struct Man {
    /// Writes a page a command into this folder.
    #[arg(long, value_name = "DIR")]
    pub dir: Option<PathBuf>,
}

pub const LSP_EXAMPLES: &str = "\
Editors start it by themselves once they are told of it; docs/editors.md says how. In Neovim 0.11:

  vim.filetype.add({ extension = { rt = 'rt' } })
  vim.lsp.config.rtc = { cmd = { 'rtc', 'lsp' }, filetypes = { 'rt' }, root_markers = { '.git' } }
  vim.lsp.enable('rtc')

Commands of the server:
  rtc.startPreview  shows the picture of what stands in the editor, saved or not, in a browser
  rtc.render        makes the picture beside the scene

Exit codes:
  0    the editor ended it
  1    the editor went away
  2    the command line is wrong";

/// Flags of `rtc lsp`.
#[derive(Args)]
pub struct Lsp {
    /// Lets scenes read files below this folder. By default each below its own, as on the command line.
    #[arg(long, value_name = "DIR")]
    pub root: Option<PathBuf>,

    /// Speaks over standard input and output, as it always does: some editors say so.
    #[arg(long, hide_short_help = true)]
    pub stdio: bool,
}
