//! What the call around the cursor takes.

use super::cursor::Cursor;
use super::hover::function_doc;
use super::lex::{Lexeme, lex};
use super::typing::{Typing, typing};
use super::walk::Declared;
use super::{Parameter, Signature, Stop, say};
use crate::check::{Function, Kind, Meaning, describe_wanted, texture_parameters};
use crate::eval::Limits;
use crate::files::Files;
use crate::source::Source;
use crate::span::Span;
use crate::syntax::ast::StatementKind;

/// The ways to call or make what is being called or made around a byte of a text, which may be unfinished there.
pub fn signatures(
    files: &dyn Files,
    source: &Source,
    at: usize,
    limits: &Limits,
    stop: Stop,
) -> Vec<Signature> {
    if source.text.len() > limits.text.source {
        return vec![];
    }
    let cursor = Cursor::new(&source.text, at);
    let Some((open, by)) = cursor.open.last().zip(cursor.opened_by.clone()) else { return vec![] };
    let inside = Inside::of(&source.text, *open, cursor.word.start);
    let bytes = source.text.as_bytes();
    let called = bytes[*open] == b'(' && by.end == *open;
    let name = &source.text[by.clone()];
    if let Some(function) = Function::ALL.iter().find(|function| called && function.name() == name) {
        return built_in(*function, &inside);
    }
    if !called && bytes[*open] != b'{' {
        return vec![];
    }
    typing(files, source, &cursor, limits, stop, |typing| match called {
        true => declared(typing, by, &inside).into_iter().collect(),
        false => part(typing, &inside).into_iter().collect(),
    })
}

/// What stands between the bracket and the cursor.
struct Inside {
    /// How many commas.
    commas: usize,
    /// The name before the last `:`, behind the last separator.
    name: Option<String>,
}

impl Inside {
    fn of(text: &str, open: usize, at: usize) -> Inside {
        let mut inside = Inside { commas: 0, name: None };
        let (mut depth, mut last) = (0usize, None);
        for (lexeme, range) in lex(&text[..at.max(open)], open + 1) {
            let piece = &text[range];
            match (lexeme, piece) {
                (Lexeme::Mark, "(" | "[" | "{") => depth += 1,
                (Lexeme::Mark, ")" | "]" | "}") => depth = depth.saturating_sub(1),
                (Lexeme::Mark, ",") | (Lexeme::Line, _) if depth == 0 => {
                    inside.commas += usize::from(piece == ",");
                    inside.name = None;
                }
                (Lexeme::Mark, ":") if depth == 0 => inside.name = last.take(),
                (Lexeme::Word, word) if depth == 0 => last = Some(word.to_string()),
                _ => {}
            }
        }
        inside
    }

    /// Which of some names the cursor is at.
    fn active(&self, names: &[String], variadic: bool) -> Option<usize> {
        if let Some(name) = &self.name {
            return names.iter().position(|known| known == name);
        }
        let last = names.len().checked_sub(1)?;
        if variadic { Some(self.commas.min(last)) } else { Some(self.commas).filter(|index| *index <= last) }
    }
}

/// Each way to call a built-in function.
fn built_in(function: Function, inside: &Inside) -> Vec<Signature> {
    let ways = function.signature().replace("), ", ") or ");
    let fields = texture_parameters(function).unwrap_or(&[]);
    let way = |label: &str| {
        let names = taken(label);
        let variadic = names.last().is_some_and(|last| last == "…");
        let shown: Vec<String> =
            names.iter().map(|name| name.split(':').next().unwrap_or(name).to_string()).collect();
        let doc = |name: &str| {
            let field = fields.iter().find(|field| field.name == name);
            field
                .map(|field| format!("{}. {}", describe_wanted(field.ty), say::paragraph(field.doc)))
                .unwrap_or_default()
        };
        let active = inside.active(&shown, variadic);
        let doc_of_all = if fields.is_empty() { function_doc(function) } else { function.doc().into() };
        signature(label, doc_of_all, &names, doc, active)
    };
    let mut found: Vec<Signature> = ways.split(" or ").map(way).collect();
    // Those come first that still take what is being written.
    found.sort_by_key(|signature| signature.active.is_none());
    found
}

/// What stands between the parentheses of a label.
fn taken(label: &str) -> Vec<String> {
    let inner = label.split_once('(').map_or("", |(_, rest)| rest.split(')').next().unwrap_or(""));
    inner.split(", ").filter(|name| !name.is_empty()).map(str::to_string).collect()
}

/// A signature whose label holds its parameters, in order.
fn signature(
    label: &str,
    doc: String,
    names: &[String],
    doc_of: impl Fn(&str) -> String,
    active: Option<usize>,
) -> Signature {
    let mut from = label.find(['(', '{']).map_or(0, |open| open + 1);
    let mut parameters = vec![];
    for name in names {
        let Some(at) = label[from..].find(name.as_str()) else { continue };
        let range = from + at..from + at + name.len();
        from = range.end;
        parameters.push(Parameter { range, doc: doc_of(name) });
    }
    Signature { label: label.into(), doc, parameters, active }
}

/// A function that a file declares.
fn declared(typing: &Typing, name: std::ops::Range<usize>, inside: &Inside) -> Option<Signature> {
    let span = Span::new(typing.analysis.main, name.start, name.end);
    let place = match typing.analysis.meaning(span) {
        Some(Meaning::Declared(place)) => place,
        _ => {
            typing.visible().into_iter().find(|(known, ..)| **known == typing.analysis.sources.text(span))?.1
        }
    };
    let sources = &typing.analysis.sources;
    let found = typing.analysis.declared(place, |declared| {
        let Declared::Statement(statement) = declared else { return None };
        let StatementKind::Function { name, parameters, value, .. } = &statement.kind else { return None };
        let head = sources.text(Span { start: name.span.start, end: value.span.start, ..name.span });
        let label = say::paragraph(head.trim_end().trim_end_matches('='));
        let names: Vec<String> = parameters.iter().map(|parameter| parameter.name.text.to_string()).collect();
        let doc = statement.doc.as_ref().map(|doc| doc.to_string()).unwrap_or_default();
        let active = inside.active(&names, false);
        Some(signature(label.trim_end(), doc, &names, |_| String::new(), active))
    });
    found.flatten()
}

/// The part whose body the cursor is in.
fn part(typing: &Typing, inside: &Inside) -> Option<Signature> {
    let Kind::Part(id) = typing.body()?.kind else { return None };
    let part = typing.program.part(id);
    let head = typing.cursor.opened_by.clone().map_or("", |by| &typing.analysis.source().text[by]);
    let title = if part.name.is_empty() { head } else { part.name.as_str() };
    let params: Vec<String> =
        part.params.iter().map(|param| format!("{}: {}", param.name, param.declared.written())).collect();
    let label = format!("{title} {{ {} }}", params.join(", "));
    let doc_of = |shown: &str| {
        let param = part.params.iter().find(|param| shown.starts_with(&format!("{}:", param.name)));
        param.and_then(|param| param.doc.as_ref()).map(|doc| doc.to_string()).unwrap_or_default()
    };
    let active =
        inside.name.as_ref().and_then(|name| part.params.iter().position(|param| param.name == *name));
    let doc = part.doc.as_ref().map(|doc| doc.to_string()).unwrap_or_default();
    Some(signature(&label, doc, &params, doc_of, active))
}
