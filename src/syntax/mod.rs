//! Text to tree.
//!
//! Parsing never fails: it returns a tree and what was wrong. Top-level items stand alone: `cut` finds
//! them in one pass, each is then parsed by the grammar in `grammar/rt.pest` and turned into [`ast`] by
//! `items`, `build`, `statement` and `value`, a large text's items in parallel. `shapes` knows an item that
//! differs from an earlier one in its literals only, `rows` keeps it as its literals, `remembered` knows one from before
//! an edit. What is said of slips is in `errors`. `format` goes the other way.

mod angled;
pub mod ast;
mod beside;
mod bodiless;
mod branches;
mod build;
mod cut;
mod docs;
mod elements;
mod errors;
mod format;
mod functions;

mod items;
mod kindless;
mod literal;
mod lookalikes;
mod marks;
mod mistyped;
mod names;
mod places;
mod remembered;
mod rows;
mod shapes;
mod slips;
mod statement;
mod value;

pub use format::{WIDTH, format};
pub(crate) use mistyped::is_near;
pub use remembered::Remembered;
pub use rows::{Rows, Shape};

use crate::diagnostic::Diagnostic;
use crate::span::{SourceId, Span};
use build::{Grammar, Rule};
use pest::Parser;
use rayon::prelude::*;

/// The words of the language, which cannot be names.
pub const RESERVED: &[&str] = &[
    "let", "material", "and", "or", "not", "true", "false", "param", "part", "import", "as", "for", "in",
    "if", "then", "else", "fn", "to", "assert",
];

/// The words that statements begin with in which a name follows.
pub const NAMING_WORDS: &[&str] = &["let", "material", "param", "part", "fn", "for"];

/// Whether a text is one word, as names are and the words of the language.
pub fn is_word(text: &str) -> bool {
    Grammar::parse(Rule::word, text).is_ok_and(|found| found.as_str() == text)
}

/// Whether a text is one word that may be a name.
pub(crate) fn is_name(text: &str) -> bool {
    is_word(text) && !RESERVED.contains(&text)
}

/// The first bracket of a text that has no other one in it, and whether it closes.
fn unpaired(text: impl Iterator<Item = u8>) -> Option<(usize, bool)> {
    let mut open = vec![];
    for (at, byte) in text.enumerate() {
        match byte {
            b'(' | b'[' | b'{' => open.push((at, byte)),
            b')' | b']' | b'}' => match open.pop() {
                Some((_, opener)) if matches!((opener, byte), (b'(', b')') | (b'[', b']') | (b'{', b'}')) => {
                }
                _ => return Some((at, true)),
            },
            _ => {}
        }
    }
    open.first().map(|&(at, _)| (at, false))
}

/// Whether each bracket of a text has its other one in it.
fn pairs(text: &str) -> bool {
    unpaired(text.bytes()).is_none()
}

/// The word that a text begins with, in which these signs count as letters.
fn leading<'t>(text: &'t str, signs: &str) -> &'t str {
    let ends = |c: char| !(c.is_alphanumeric() || c == '_' || signs.contains(c));
    &text[..text.find(ends).unwrap_or(text.len())]
}

/// The words that name types, as far as the form of a statement depends on them: `param int count` is the wrong way
/// round. What they mean is not known here.
pub const TYPE_WORDS: &[&str] = &[
    "number",
    "int",
    "bool",
    "text",
    "color",
    "texture",
    "material",
    "thing",
    "transform",
    "point",
    "vector",
    "length",
    "angle",
    "power",
    "radiance",
    "temperature",
    "area",
];

/// Those of them whose values can have a range, but for lengths, behind which `in` is an inch.
pub const RANGED_WORDS: &[&str] = &["number", "int", "angle", "power", "radiance", "temperature", "area"];

/// The fields of whatever is placed that no word of the language names: in a body that holds things, two words of which
/// the first is one of them are no thing. What they mean is not known here.
pub const PLACED_WORDS: &[&str] = &["at", "place", "grain"];

/// The kind of things whose bodies hold things, and fields too.
pub const GROUP_WORD: &str = "group";

/// The kinds of things that each only stand within another one, behind the kind of that. It has a field of the same name, so that
/// there two words of which the first is it are either. What they mean is not known here.
pub const PART_WORDS: &[[&str; 2]] = &[["camera", "lens"]];

/// White space within a line, as the grammar has it. With the line end it is what Rust calls ASCII white space.
const BLANKS: [char; 4] = [' ', '\t', '\r', '\u{c}'];

/// How much a text may ask for. Going over one is an error at the place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// The longest source, in bytes.
    pub source: usize,
    /// The deepest nesting of brackets, and the deepest tree of an expression; at most [`MAX_DEPTH`].
    pub depth: usize,
}

impl Default for Limits {
    fn default() -> Limits {
        Limits { source: 256 << 20, depth: 512 }
    }
}

/// The greatest depth that a limit can be set to: it takes stack.
pub const MAX_DEPTH: usize = 4096;

/// The longest source that places can count.
pub const MAX_SOURCE: usize = 4095 << 20;

/// From this length on a text's items are parsed in parallel.
const PARALLEL: usize = 1 << 20;

/// So many items are parsed together: each chunk meets its shapes anew.
const CHUNK: usize = 1 << 14;

/// Reads a source. The tree holds all that could be understood; every slip is among the diagnostics, which
/// are in the order of the text.
pub fn parse(source: SourceId, text: &str) -> (ast::File, Vec<Diagnostic>) {
    let (mut file, slips) = parse_rows(source, text, Limits::default());
    file.body.entries = rows::written_out(file.body.entries, text);
    (file, slips)
}

/// The same, with things that differ from an earlier one in their literals only as [`Rows`].
pub fn parse_rows(source: SourceId, text: &str, limits: Limits) -> (ast::File, Vec<Diagnostic>) {
    parse_again(source, text, limits, None)
}

/// The same of a text of which parts may have been read before.
pub fn parse_again(
    source: SourceId,
    text: &str,
    limits: Limits,
    known: Option<&Remembered>,
) -> (ast::File, Vec<Diagnostic>) {
    let span = Span::new(source, 0, text.len().min(limits.source));
    if text.len() > limits.source {
        let body = ast::Body { entries: vec![], span };
        let file = ast::File { source, body, comments: vec![] };
        return (file, vec![errors::long_source(span.after(), limits.source)]);
    }
    let mut sink = errors::Sink::default();
    let read = lookalikes::read(source, text, &mut sink);
    let mut cut = cut::cut(source, &read.text, limits.depth);
    read.skip(&mut cut);
    sink.append(cut.sink);
    // What is long is read in parallel, and seldom edited.
    let known = known.filter(|_| text.len() < PARALLEL);
    known.into_iter().for_each(Remembered::begin);
    let found = build::Source { id: source, text, comments: &cut.comments, depth: limits.depth, known };
    let mut entries = Vec::with_capacity(cut.items.len());
    let mut collect = |(built, slips)| {
        entries.extend::<Vec<ast::Entry>>(built);
        sink.append(slips);
    };
    if text.len() < PARALLEL {
        collect(items::items(found, &cut.items));
    } else {
        let built: Vec<_> = cut.items.par_chunks(CHUNK).map(|chunk| items::items(found, chunk)).collect();
        built.into_iter().for_each(collect);
    }
    headless(&mut entries, text, &mut sink);
    strays(&cut.strays, &mut sink);
    let file = ast::File { source, body: ast::Body { entries, span }, comments: cut.comments };
    (file, sink.into_sorted(|place| read.whole(place, text)))
}

/// Reports definitions by the bare name of a kind with indented fields on the lines behind it: `{` is missing, and the
/// fields belong to nothing.
fn headless(entries: &mut Vec<ast::Entry>, text: &str, sink: &mut errors::Sink) {
    let mut lost = false;
    let mut at = 0usize;
    for index in 0..entries.len() {
        let (before, from) = entries.split_at_mut(index);
        if let ast::Entry::Field(field) = &from[0] {
            let indented = text[..field.name.span.range().start].ends_with(BLANKS);
            let kept = at.checked_sub(1).filter(|_| indented);
            lost = match kept.and_then(|last| slips::bare_name(&mut before[last])) {
                Some((name, value)) => {
                    sink.push(errors::no_brace(&name, value.span, field.name.span));
                    value.kind = ast::ExprKind::Invalid;
                    true
                }
                None => lost,
            };
        } else {
            lost = false;
        }
        if !lost {
            entries.swap(at, index);
            at += 1;
        }
    }
    entries.truncate(at);
}

/// Reports closers without an opener. Behind a thing whose `{` is missing, that is the slip.
fn strays(strays: &[cut::Stray], sink: &mut errors::Sink) {
    let mut braces = sink.missing_braces();
    for stray in strays.iter().filter(|stray| !stray.forgiven) {
        let explained = match stray.closer {
            // It closes values whose opening parenthesis was missed.
            ')' => sink.tells_of_parentheses(stray.span),
            // It closes the body whose brace was missed, the last one before it.
            '}' => match braces.iter().rposition(|(_, place)| place.start < stray.span.start) {
                Some(last) => {
                    let (index, _) = braces.remove(last);
                    sink.label(index, stray.span, "closes what was not opened");
                    true
                }
                None => false,
            },
            _ => false,
        };
        if !explained {
            sink.push(errors::stray_closer(stray.span, stray.closer));
        }
    }
}

/// What a word before a kind stands for that other languages have there: a mark, or nothing, as in `new sphere { … }`.
pub(crate) fn mark_of(word: &str) -> Option<&'static str> {
    match word {
        "new" | "make" | "create" | "add" | "draw" => Some(""),
        "off" | "hide" | "hidden" | "disable" | "disabled" | "skip" => Some("@off "),
        "solo" | "only" => Some("@solo "),
        _ => None,
    }
}

/// Says of such a word what is written in its place before a thing of a kind, which begins at `thing`, and mends it.
pub(crate) fn with_mark(slip: Diagnostic, word: &ast::Name, kind: &str, thing: Span) -> Option<Diagnostic> {
    let mark = mark_of(&word.text)?;
    let slip = slip.at("no word stands before a kind").help(match mark {
        "" => format!("leave it out: a thing begins with its kind: `{kind} {{ … }}`"),
        _ => format!("a mark begins with `@`: `{mark}{kind} {{ … }}`"),
    });
    Some(slip.fix(Span { end: thing.start, ..word.span }, mark))
}

/// Reads a text that is one expression, such as a default value or a setting from the command line.
pub fn parse_expression(source: SourceId, text: &str) -> (ast::Expr, Vec<Diagnostic>) {
    let Limits { source: longest, depth } = Limits::default();
    let mut sink = errors::Sink::default();
    let text = &text[..text.floor_char_boundary(longest)];
    let read = lookalikes::read(source, text, &mut sink);
    let mut cut = cut::whole(source, &read.text, depth);
    read.skip(&mut cut);
    sink.append(cut.sink);
    let found = build::Source { id: source, text, comments: &cut.comments, depth, known: None };
    let (expr, slips) = items::value(found, cut.items.first());
    sink.append(slips);
    (expr, sink.into_sorted(|place| read.whole(place, text)))
}
