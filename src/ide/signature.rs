//! What the call around the cursor takes.

use super::cursor::Cursor;
use super::hover::function_doc;
use super::lex::{Lexeme, lex};
use super::typing::{Typing, typing};
use super::walk::Declared;
use super::{Parameter, Signature, Stop, say};
use crate::check::{Declared as Wanted, Function, Kind, Meaning, Way, texture_parameters};
use crate::eval::Limits;
use crate::files::Files;
use crate::source::Source;
use crate::span::Span;
use crate::syntax::ast::StatementKind;
use smol_str::SmolStr;

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
    if cursor.declares_function() {
        // Nothing is called by its own head.
        return vec![];
    }
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
        false => made(typing, &inside).into_iter().collect(),
    })
}

/// What stands between the bracket and the cursor.
#[derive(Default)]
pub(super) struct Inside {
    /// How many commas.
    pub(super) commas: usize,
    /// The name before the last `:`, behind the last separator.
    pub(super) name: Option<String>,
    /// The names before a `:` of what stands before that.
    pub(super) named: Vec<String>,
    /// Whether nothing stands behind the last separator.
    pub(super) begins: bool,
}

impl Inside {
    pub(super) fn of(text: &str, open: usize, at: usize) -> Inside {
        let mut inside = Inside { begins: true, ..Inside::default() };
        let (mut depth, mut last) = (0usize, None);
        for (lexeme, range) in lex(&text[..at.max(open)], open + 1) {
            let piece = &text[range];
            inside.begins &= matches!(lexeme, Lexeme::Line | Lexeme::Comment);
            match (lexeme, piece) {
                (Lexeme::Mark, "(" | "[" | "{") => depth += 1,
                (Lexeme::Mark, ")" | "]" | "}") => depth = depth.saturating_sub(1),
                (Lexeme::Mark, ",") | (Lexeme::Line, _) if depth == 0 => {
                    inside.commas += usize::from(piece == ",");
                    inside.named.extend(inside.name.take());
                    inside.begins = true;
                }
                (Lexeme::Mark, ":") if depth == 0 => inside.name = last.take(),
                (Lexeme::Word, word) if depth == 0 => last = Some(word.to_string()),
                _ => {}
            }
        }
        inside
    }

    /// Which of some names the cursor is at.
    fn active(&self, names: &[impl AsRef<str>], variadic: bool) -> Option<usize> {
        if let Some(name) = &self.name {
            return names.iter().position(|known| known.as_ref() == name);
        }
        let last = names.len().checked_sub(1)?;
        if variadic { Some(self.commas.min(last)) } else { Some(self.commas).filter(|index| *index <= last) }
    }
}

/// Each way to call a built-in function.
fn built_in(function: Function, inside: &Inside) -> Vec<Signature> {
    let fields = texture_parameters(function).unwrap_or(&[]);
    let way = |way: &Way| {
        let names: Vec<&str> = way.takes.iter().map(|(name, _)| *name).collect();
        let doc = |name: &str| {
            let field = fields.iter().find(|field| name.split(':').next() == Some(field.name));
            field.map(say::field).unwrap_or_default()
        };
        let active = inside.active(&names, names.last() == Some(&"…"));
        let doc_of_all = if fields.is_empty() { function_doc(function) } else { function.doc().into() };
        signature(&say::way(function, way), doc_of_all, &say::taken(function, way), doc, active)
    };
    let mut found: Vec<Signature> = function.ways().iter().map(way).collect();
    // Those come first that still take what is being written.
    found.sort_by_key(|signature| signature.active.is_none());
    found
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

/// The part or the built-in kind whose body the cursor is in.
fn made(typing: &Typing, inside: &Inside) -> Option<Signature> {
    let head = typing.cursor.opened_by.clone().map_or("", |by| &typing.analysis.source().text[by]);
    let (title, doc, fields) = match typing.body()?.kind {
        Kind::Part(id) => {
            let part = typing.program.part(id);
            let doc = |doc: &Option<SmolStr>| doc.as_ref().map(|doc| doc.to_string()).unwrap_or_default();
            let params = part.params.iter();
            let fields: Vec<_> =
                params.map(|param| (param.name.clone(), param.declared.written(), doc(&param.doc))).collect();
            (if part.name.is_empty() { head } else { part.name.as_str() }, doc(&part.doc), fields)
        }
        Kind::BuiltIn(kind) => {
            let written = |ty| Some(Wanted::Field(ty).written()).filter(|ty| ty != "?").unwrap_or_default();
            let own = kind.get().fields.iter();
            let fields = own.map(|field| (field.name.into(), written(field.ty), say::field(field))).collect();
            (kind.get().name, say::paragraph(kind.get().doc), fields)
        }
        Kind::Thing | Kind::Material => return None,
    };
    let shown = |(name, ty, _): &(SmolStr, String, String)| match ty.is_empty() {
        true => name.to_string(),
        false => format!("{name}: {ty}"),
    };
    let shown: Vec<String> = fields.iter().map(shown).collect();
    let label = format!("{title} {{ {} }}", shown.join(", "));
    let doc_of = |piece: &str| {
        let field = fields.iter().zip(&shown).find(|(_, shown)| *shown == piece);
        field.map(|((.., doc), _)| doc.clone()).unwrap_or_default()
    };
    let active = inside.name.as_ref().and_then(|name| fields.iter().position(|(known, ..)| known == name));
    Some(signature(&label, doc, &shown, doc_of, active))
}
