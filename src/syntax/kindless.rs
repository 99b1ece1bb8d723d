//! Bodies that do not follow their kind at once: `sphere: { … }`, `sphere ball = { … }`, `material: { … }`.

use super::ast::{Broken, Entry, Expr, ExprKind, Name, StatementKind};
use super::build::{Builder, Deep, Node, Rule};
use super::errors;
use super::{BLANKS, is_name};
use crate::span::Span;

impl<'t> Builder<'t> {
    /// `sphere: { radius: 1m }`, `sphere = { radius: 1m }` at the top level. The value begins with the body.
    pub(super) fn signed_body(&self, kind: Name, sign: &str, value: Node<'t>, span: Span) -> Deep<Entry> {
        let opener = self.span(&value).before();
        let edit = Span { start: kind.span.end, ..opener };
        self.report(errors::sign_before_body(&kind.text, sign, edit));
        let mut parts = value.into_inner();
        let body =
            parts.next().and_then(|bare| bare.into_inner().next()).expect("the value begins with a body");
        if let Some(extra) = parts.next() {
            self.unexpected(&extra, errors::unexpected_extra);
        }
        match self.construct(vec![kind], body) {
            (Some(construct), depth) => {
                let thing = StatementKind::Thing { name: None, construct };
                self.checked(self.plain(thing, span), depth, span)
            }
            (None, depth) => (Entry::Broken(Broken { name: None, span }), depth),
        }
    }

    /// `sphere ball = { … }`: a thing whose body stands otherwise.
    pub(super) fn named_otherwise(&self, kind: &Name, value: &Node<'t>, span: Span) -> Option<Deep<Entry>> {
        let mut inner = value.clone().into_inner();
        let (first, sign) = (inner.next()?, inner.next());
        let written = first.as_str().trim_ascii_end();
        let place = self.trimmed(&first);
        let sign = sign.filter(|sign| sign.as_rule() == Rule::foreign_equals && is_name(written))?;
        let body = inner.next().filter(|body| body.as_rule() == Rule::bare_body)?.into_inner().next()?;
        let name = Name { text: written.into(), span: place };
        let edit = Span { start: place.end, end: self.span(&body).start, ..self.span(&sign) };
        self.report(errors::sign_before_body(&format!("{} {written}", kind.text), "=", edit));
        Some(match self.construct(vec![kind.clone()], body) {
            (Some(construct), depth) => {
                let thing = StatementKind::Thing { name: Some(name), construct };
                self.checked(self.plain(thing, span), depth, span)
            }
            (None, depth) => (Entry::Broken(Broken { name: Some(name), span }), depth),
        })
    }

    /// `sphere ball: { … }`: whether the sign is the slip.
    pub(super) fn named_with_colon(&self, kind: &Name, value: &Node<'t>, span: Span) -> Option<Entry> {
        let name = Name { text: value.as_str().trim_ascii_end().into(), span: self.trimmed(value) };
        let behind = self.after(name.span.range().end - self.base());
        let body = behind.trim_start_matches(BLANKS).strip_prefix(':')?.trim_start_matches(BLANKS);
        if !is_name(&name.text) || !body.starts_with('{') {
            return None;
        }
        let edit = Span {
            start: name.span.end,
            end: name.span.end + (behind.len() - body.len()) as u32,
            ..name.span
        };
        self.report(errors::sign_before_body(&format!("{} {}", kind.text, name.text), ":", edit));
        Some(Entry::Broken(Broken { name: Some(name), span }))
    }

    /// `material: { color: red }`, `lens: { focal: 50mm }`: a value that is a body without its kind.
    pub(super) fn kindless(&self, field: &str, value: Node<'t>) -> Deep<Expr> {
        let span = self.trimmed(&value);
        self.report(match errors::kindless_field(field, Span { end: span.start + 1, ..span }) {
            Some(slip) => slip,
            None => self.bare_body(span),
        });
        (Expr { kind: ExprKind::Invalid, span }, 1)
    }

    /// A body where a value belongs.
    pub(super) fn bare_body(&self, span: Span) -> crate::diagnostic::Diagnostic {
        let open = Span { end: span.start + 1, ..span };
        let inside = self.written(span).and_then(|text| text.strip_prefix('{')?.split_once('}'));
        match inside {
            // The brace may be one of a comment or a text.
            Some((inside, _))
                if errors::is_components(inside)
                    && !["/*", "//", "\""].iter().any(|sign| inside.contains(sign)) =>
            {
                let start = open.end + inside.len() as u32;
                errors::components_in_braces(inside.trim(), open, Span { start, end: start + 1, ..span })
            }
            _ => errors::unexpected_value("{", open),
        }
    }
}
