//! Tree and comments to a document.
//!
//! Tokens come in the order of the source. Before each, the comments that stand before it there are printed, so
//! that none is lost, wherever it stands. Expressions are in `value`.

mod value;

use super::super::BLANKS;
use super::super::ast::{
    Argument, BinaryOp, Body, Comment, Construct, Entry, Expr, ExprKind, Name, Parameter, Path, Prefix,
    Statement, StatementKind, TypeName, UnaryOp,
};
use super::doc::{Doc, group, hung};
use crate::span::Span;
use std::ops::Range;

/// What stands between two line ends of a body.
pub(super) enum Unit<'t> {
    Entry(&'t Entry),
    /// Is printed as it stands.
    Verbatim(Range<usize>),
}

impl Unit<'_> {
    /// Where it begins, its prefixes included.
    pub(super) fn start(&self) -> usize {
        match self {
            Unit::Entry(Entry::Field(field)) => start(field.name.span),
            Unit::Entry(Entry::Broken(broken)) => start(broken.span),
            Unit::Entry(Entry::Rows(rows)) => start(rows.span()),
            Unit::Entry(Entry::Statement(statement)) => {
                start(statement.prefixes.first().map_or(statement.span, |prefix| prefix.span))
            }
            Unit::Verbatim(range) => range.start,
        }
    }

    fn end(&self) -> usize {
        match self {
            Unit::Entry(Entry::Field(field)) => end(field.value.span),
            Unit::Entry(Entry::Broken(broken)) => end(broken.span),
            Unit::Entry(Entry::Rows(rows)) => end(rows.span()),
            Unit::Entry(Entry::Statement(statement)) => end(statement.span),
            Unit::Verbatim(range) => range.end,
        }
    }
}

fn start(span: Span) -> usize {
    span.range().start
}

fn end(span: Span) -> usize {
    span.range().end
}

type Docs<'t> = Vec<Doc<'t>>;

pub(super) struct Printer<'t> {
    text: &'t str,
    comments: &'t [Comment],
    /// How many comments were printed.
    printed: usize,
}

/// What was printed last in a body.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Last {
    Opening,
    Comment,
    Unit,
}

impl<'t> Printer<'t> {
    pub(super) fn new(text: &'t str, comments: &'t [Comment]) -> Printer<'t> {
        Printer { text, comments, printed: 0 }
    }

    /// A whole file.
    pub(super) fn file(&mut self, units: &[Unit<'t>]) -> Docs<'t> {
        let mut out = vec![];
        self.units(units, 0, self.text.len(), &mut out);
        out
    }

    fn source(&self, span: Span) -> &'t str {
        &self.text[span.range()]
    }

    // --- Comments -------------------------------------------------------------------------------------------

    /// The next comment, if it begins before an offset.
    fn next_before(&self, offset: usize) -> Option<(&'t str, Range<usize>)> {
        let range = self.comments.get(self.printed)?.span.range();
        (range.start < offset).then(|| (&self.text[range.clone()], range))
    }

    fn newlines(&self, range: Range<usize>) -> usize {
        self.text.get(range).unwrap_or("").bytes().filter(|&byte| byte == b'\n').count()
    }

    /// Whether nothing but comments, or what closes a bracket, follows on the line.
    fn ends_line(&self, mut offset: usize) -> bool {
        loop {
            let rest = self.text[offset..].trim_start_matches(BLANKS);
            let Some(length) = rest.strip_prefix("/*").and_then(|rest| rest.find("*/")) else {
                return rest.is_empty() || rest.starts_with(['\n', '}']) || rest.starts_with("//");
            };
            offset = self.text.len() - rest.len() + length + 4;
        }
    }

    /// The comments before a token inside an entry, which [hang](Doc::Hang).
    fn lead(&mut self, offset: usize, out: &mut Docs<'t>) {
        while let Some((comment, range)) = self.next_before(offset) {
            self.printed += 1;
            let before = self.text[..range.start].trim_end_matches(BLANKS);
            if before.ends_with('\n') {
                out.push(Doc::Hang);
            }
            out.push(Doc::Comment(comment));
            let ends = comment.starts_with("//") || self.newlines(range.end..offset.max(range.end)) > 0;
            out.push(if ends { Doc::Hang } else { Doc::Text(" ") });
        }
    }

    /// The comments that end the line on which something ends, but no token from `limit` on is passed.
    fn trail(&mut self, mut at: usize, limit: usize, out: &mut Docs<'t>) {
        while let Some((comment, range)) = self.next_before(limit) {
            let before = self.text.get(at..range.start).unwrap_or("");
            let belongs = self.ends_line(range.end) || !before.contains(',');
            if before.contains('\n') || !belongs {
                return;
            }
            self.printed += 1;
            out.push(Doc::Comment(comment));
            at = range.end;
        }
    }

    // --- Bodies ---------------------------------------------------------------------------------------------

    /// The entries between two offsets, each behind a line end.
    fn units(&mut self, units: &[Unit<'t>], opening: usize, closing: usize, out: &mut Docs<'t>) {
        let (mut last, mut at) = (Last::Opening, opening);
        for (index, unit) in units.iter().enumerate() {
            self.own_lines(unit.start(), &mut last, &mut at, out);
            match last == Last::Comment && self.newlines(at..unit.start()) == 0 {
                true => out.push(Doc::Text(" ")),
                false => self.end_line(last, at..unit.start(), out),
            }
            self.unit(unit, out);
            // A comment that no token took along.
            self.lead(unit.end(), out);
            let limit = units.get(index + 1).map_or(closing, Unit::start);
            let printed = self.printed;
            self.trail(unit.end(), limit, out);
            if index + 1 < units.len() {
                out.push(Doc::Comma);
            }
            last = Last::Unit;
            at = match self.comments[..self.printed].last() {
                Some(comment) if self.printed > printed => end(comment.span),
                _ => unit.end(),
            };
        }
        self.own_lines(closing, &mut last, &mut at, out);
    }

    /// The comments before an entry or a closing brace.
    fn own_lines(&mut self, offset: usize, last: &mut Last, at: &mut usize, out: &mut Docs<'t>) {
        while let Some((comment, range)) = self.next_before(offset) {
            self.printed += 1;
            let same_line = self.newlines(*at..range.start) == 0;
            let opening = *last == Last::Opening && *at > 0 && self.ends_line(range.end);
            if !(same_line && (opening || *last == Last::Comment)) {
                self.end_line(*last, *at..range.start, out);
            }
            out.push(Doc::Comment(comment));
            (*last, *at) = (Last::Comment, range.end);
        }
    }

    /// The line end before an entry or a comment, with the blank line that stands there.
    fn end_line(&self, last: Last, gap: Range<usize>, out: &mut Docs<'t>) {
        if last != Last::Opening && self.newlines(gap) > 1 {
            out.push(Doc::Blank);
        }
        out.push(Doc::Line);
    }

    fn unit(&mut self, unit: &Unit<'t>, out: &mut Docs<'t>) {
        match unit {
            Unit::Entry(Entry::Field(field)) => {
                out.push(Doc::Text(self.source(field.name.span)));
                out.push(Doc::Text(": "));
                self.expr(&field.value, out);
            }
            Unit::Entry(Entry::Statement(statement)) => {
                self.prefixes(statement, out);
                let mut inner = vec![];
                self.statement(statement, &mut inner);
                out.extend(hung(inner));
            }
            Unit::Entry(Entry::Broken(broken)) => self.verbatim(broken.span.range(), out),
            Unit::Entry(Entry::Rows(rows)) => self.verbatim(rows.span().range(), out),
            Unit::Verbatim(range) => self.verbatim(range.clone(), out),
        }
    }

    fn verbatim(&mut self, range: Range<usize>, out: &mut Docs<'t>) {
        while self.next_before(range.end).is_some() {
            self.printed += 1;
        }
        out.push(Doc::Text(&self.text[range]));
    }

    /// `{ … }`
    fn body(&mut self, body: &'t Body, out: &mut Docs<'t>) {
        let Range { start, end } = body.span.range();
        self.lead(start, out);
        if body.entries.is_empty() && self.next_before(end).is_none() {
            out.push(Doc::Text("{}"));
            return;
        }
        let units: Vec<Unit> = body.entries.iter().map(Unit::Entry).collect();
        let comment = self.next_before(end).map_or(end, |(_, comment)| comment.start);
        let first = units.first().map_or(end - 1, Unit::start).min(comment);
        let spread = self.newlines(start + 1..first) > 0;
        let mut inner = vec![];
        if spread {
            inner.push(Doc::Hard);
        }
        self.units(&units, start + 1, end - 1, &mut inner);
        out.push(group(vec![Doc::Text("{"), Doc::Nest(inner), Doc::Line, Doc::Text("}")]));
    }

    fn construct(&mut self, construct: &'t Construct, out: &mut Docs<'t>) {
        self.path(&construct.kind, out);
        out.push(Doc::Text(" "));
        self.body(&construct.body, out);
    }

    fn path(&mut self, path: &'t Path, out: &mut Docs<'t>) {
        self.name(&path.first, out);
        for name in &path.rest {
            self.lead(start(name.span), out);
            out.push(Doc::Text("."));
            out.push(Doc::Text(self.source(name.span)));
        }
    }

    fn name(&mut self, name: &'t Name, out: &mut Docs<'t>) {
        self.lead(start(name.span), out);
        out.push(Doc::Text(self.source(name.span)));
    }

    // --- Statements -----------------------------------------------------------------------------------------

    fn prefixes(&mut self, statement: &'t Statement, out: &mut Docs<'t>) {
        for (index, prefix) in statement.prefixes.iter().enumerate() {
            self.prefix(prefix, out);
            let next = statement.prefixes.get(index + 1).map_or(statement.span, |next| next.span);
            self.trail(end(prefix.span), start(next), out);
            let ends = self.newlines(end(prefix.span)..start(next)) > 0;
            out.push(if ends { Doc::Hard } else { Doc::Text(" ") });
            // Statements stand below their prefixes, and not behind.
            let mut between = vec![];
            self.lead(start(next), &mut between);
            out.extend(between.into_iter().map(|doc| if doc.hangs() { Doc::Hard } else { doc }));
        }
    }

    fn statement(&mut self, statement: &'t Statement, out: &mut Docs<'t>) {
        match &statement.kind {
            StatementKind::Thing { name, construct } => {
                self.path(&construct.kind, out);
                out.push(Doc::Text(" "));
                if let Some(name) = name {
                    self.name(name, out);
                    out.push(Doc::Text(" "));
                }
                self.body(&construct.body, out);
            }
            StatementKind::Definition { name, value, .. } => {
                out.push(Doc::Text(self.word(statement.span)));
                out.push(Doc::Text(" "));
                self.name(name, out);
                out.push(Doc::Text(" = "));
                self.expr(value, out);
            }
            StatementKind::Param { name, ty, default, range } => {
                out.push(Doc::Text("param "));
                self.name(name, out);
                out.push(Doc::Text(": "));
                self.ty(ty, out);
                out.push(Doc::Text(" = "));
                let mut inner = vec![];
                self.expr(default, &mut inner);
                if let Some(range) = range {
                    self.trail(end(default.span), start(range.span), &mut inner);
                    let mut behind = vec![Doc::Line, Doc::Text("in ")];
                    self.expr(range, &mut behind);
                    inner.push(Doc::Nest(behind));
                }
                out.push(group(inner));
            }
            StatementKind::Part { name, body } => {
                out.push(Doc::Text("part "));
                self.name(name, out);
                out.push(Doc::Text(" "));
                self.body(body, out);
            }
            StatementKind::Import { path, name } => {
                out.push(Doc::Text("import "));
                self.name(path, out);
                // The line may end before `as`, and not behind it.
                out.push(Doc::Text(" "));
                self.lead(start(name.span), out);
                out.push(Doc::Text("as "));
                self.name(name, out);
            }
            StatementKind::Function { name, parameters, result, value } => {
                out.push(Doc::Text("fn "));
                self.name(name, out);
                // Its parameters have no closing place in the tree: what stands before the result is theirs.
                let close = parameters.last().map_or(end(name.span), |last| end(span_of(&last.ty)));
                let part = |parameter: &Parameter| start(parameter.name.span)..end(span_of(&parameter.ty));
                self.enclosed(["(", ")"], close, parameters, part, false, out, |this, parameter, out| {
                    this.name(&parameter.name, out);
                    out.push(Doc::Text(": "));
                    this.ty(&parameter.ty, out);
                });
                out.push(Doc::Text(" -> "));
                self.ty(result, out);
                out.push(Doc::Text(" = "));
                self.expr(value, out);
            }
            StatementKind::For { variable, list, body } => {
                out.push(Doc::Text("for "));
                self.name(variable, out);
                out.push(Doc::Text(" in "));
                self.expr(list, out);
                out.push(Doc::Text(" "));
                self.body(body, out);
            }
            StatementKind::If { condition, then, otherwise } => {
                self.choice(condition, then, otherwise.as_ref(), out);
            }
            StatementKind::Assert { condition, message } => {
                out.push(Doc::Text("assert "));
                let mut inner = vec![];
                self.expr(condition, &mut inner);
                if let Some(message) = message {
                    inner.push(Doc::Text(","));
                    self.trail(end(condition.span), start(message.span), &mut inner);
                    let mut behind = vec![Doc::Line];
                    self.lead(start(message.span), &mut behind);
                    self.expr(message, &mut behind);
                    inner.push(Doc::Nest(behind));
                }
                out.push(group(inner));
            }
        }
    }

    fn word(&self, span: Span) -> &'t str {
        let text = self.source(span);
        &text[..text.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(text.len())]
    }

    fn prefix(&mut self, prefix: &'t Prefix, out: &mut Docs<'t>) {
        out.push(Doc::Text("@"));
        self.name(&prefix.name, out);
        if let Some(arguments) = &prefix.arguments {
            self.arguments(arguments, end(prefix.span) - 1, out);
        }
    }

    fn choice(
        &mut self,
        condition: &'t Expr,
        then: &'t Body,
        otherwise: Option<&'t Body>,
        out: &mut Docs<'t>,
    ) {
        out.push(Doc::Text("if "));
        self.expr(condition, out);
        out.push(Doc::Text(" "));
        self.body(then, out);
        let Some(otherwise) = otherwise else { return };
        self.before_else(end(then.span), out);
        out.push(Doc::Text("else "));
        // A chain: a body that is just another `if`, without braces.
        if let [Entry::Statement(statement)] = otherwise.entries.as_slice()
            && let StatementKind::If { condition, then, otherwise: next } = &statement.kind
            && statement.span == otherwise.span
        {
            self.lead(start(statement.span), out);
            return self.choice(condition, then, next.as_ref(), out);
        }
        self.body(otherwise, out);
    }

    /// What stands between a body and its `else`: a space, or the comments there. Behind one that takes its line,
    /// `else` begins a line of its own.
    fn before_else(&mut self, mut at: usize, out: &mut Docs<'t>) {
        let mut rest = self.text[at..].trim_ascii_start();
        while let Some(comment) = rest.strip_prefix('/') {
            let length = match comment.starts_with('/') {
                true => comment.find('\n'),
                false => comment.find("*/").map(|end| end + 2),
            };
            rest = length.map_or("", |length| &comment[length..]).trim_ascii_start();
        }
        let word = self.text.len() - rest.len();
        let mut own_line = false;
        while let Some((comment, range)) = self.next_before(word) {
            self.printed += 1;
            let below = self.newlines(at..range.start) > 0;
            out.push(if below { Doc::Hard } else { Doc::Text(" ") });
            out.push(Doc::Comment(comment));
            at = range.end;
            own_line = comment.starts_with("//");
        }
        out.push(if own_line { Doc::Hard } else { Doc::Text(" ") });
    }

    fn ty(&mut self, ty: &'t TypeName, out: &mut Docs<'t>) {
        match ty {
            TypeName::Named(name) => self.name(name, out),
            TypeName::List(inner, span) => {
                self.lead(start(*span), out);
                out.push(Doc::Text("["));
                self.ty(inner, out);
                self.lead(end(*span), out);
                out.push(Doc::Text("]"));
            }
            TypeName::Invalid(span) => out.push(Doc::Text(self.source(*span))),
        }
    }
}

fn span_of(ty: &TypeName) -> Span {
    match ty {
        TypeName::Named(name) => name.span,
        TypeName::List(_, span) | TypeName::Invalid(span) => *span,
    }
}
