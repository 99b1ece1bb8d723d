//! Text to tree.
//!
//! Parsing never fails: it returns a tree and what was wrong. Top-level items stand alone: `cut` finds
//! them in one pass, each is then parsed by the grammar in `grammar/rt.pest` and turned into [`ast`] by
//! `build`, `statement` and `value`, a large text's items in parallel. `shapes` knows an item that
//! differs from an earlier one in its literals only, `rows` keeps it as its literals. What is said of slips is in `errors`.
//! `format` goes the other way.

pub mod ast;
mod build;
mod cut;
mod docs;
mod errors;
mod format;
mod places;
mod rows;
mod shapes;
mod slips;
mod statement;
mod value;

pub use format::{WIDTH, format};
pub use rows::{Rows, Shape};

use crate::diagnostic::Diagnostic;
use crate::span::{SourceId, Span};
use rayon::prelude::*;

/// The words of the language, which cannot be names.
pub const RESERVED: &[&str] = &[
    "let", "material", "and", "or", "not", "true", "false", "param", "part", "import", "as", "for", "in",
    "if", "then", "else", "fn", "to", "assert",
];

/// The deepest nesting of brackets, and the deepest tree of an expression.
pub const MAX_DEPTH: usize = 512;

/// The longest source in bytes.
pub const MAX_SOURCE: usize = 256 << 20;

/// From this length on a text's items are parsed in parallel.
const PARALLEL: usize = 1 << 20;

/// So many items are parsed together: each chunk meets its shapes anew.
const CHUNK: usize = 1 << 14;

/// Reads a source. The tree holds all that could be understood; every slip is among the diagnostics, which
/// are in the order of the text.
pub fn parse(source: SourceId, text: &str) -> (ast::File, Vec<Diagnostic>) {
    let (mut file, slips) = parse_rows(source, text);
    file.body.entries = rows::written_out(file.body.entries, text);
    (file, slips)
}

/// The same, with things that differ from an earlier one in their literals only as [`Rows`].
pub fn parse_rows(source: SourceId, text: &str) -> (ast::File, Vec<Diagnostic>) {
    let span = Span::new(source, 0, text.len().min(MAX_SOURCE));
    if text.len() > MAX_SOURCE {
        let body = ast::Body { entries: vec![], span };
        let file = ast::File { source, body, comments: vec![] };
        return (file, vec![errors::long_source(span.after(), MAX_SOURCE >> 20)]);
    }
    let cut = cut::cut(source, text);
    let mut sink = cut.sink;
    let found = build::Source { id: source, text, comments: &cut.comments };
    let mut entries = Vec::with_capacity(cut.items.len());
    let mut collect = |(built, slips)| {
        entries.extend::<Vec<ast::Entry>>(built);
        sink.append(slips);
    };
    if text.len() < PARALLEL {
        collect(build::items(found, &cut.items));
    } else {
        let built: Vec<_> = cut.items.par_chunks(CHUNK).map(|chunk| build::items(found, chunk)).collect();
        built.into_iter().for_each(collect);
    }
    let file = ast::File { source, body: ast::Body { entries, span }, comments: cut.comments };
    (file, sink.into_sorted())
}

/// Reads a text that is one expression, such as a default value or a setting from the command line.
pub fn parse_expression(source: SourceId, text: &str) -> (ast::Expr, Vec<Diagnostic>) {
    let text = &text[..text.floor_char_boundary(MAX_SOURCE)];
    let cut = cut::whole(source, text);
    let mut sink = cut.sink;
    let found = build::Source { id: source, text, comments: &cut.comments };
    let (expr, slips) = build::value(found, cut.items.first());
    sink.append(slips);
    (expr, sink.into_sorted())
}
