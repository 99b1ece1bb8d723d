//! Entries with a slip in their form: what is said of them, and what is still understood.

use super::ast::{Broken, Entry, Field};
use super::build::{Builder, Deep, Node, Rule, is_reserved};
use super::errors::{self, statements};
use super::value;
use crate::span::Span;
use pest::iterators::Pairs;

impl<'t> Builder<'t> {
    /// `radius = 5cm`
    pub(super) fn equals(
        &self,
        word: &Node,
        mut inner: Pairs<'t, Rule>,
        span: Span,
        top: bool,
    ) -> Deep<Entry> {
        let name = self.name(word);
        let sign = inner.next().expect("this slip is about `=`");
        let (value, depth) = self.expression(inner);
        if word.as_str() == "let" || (top && word.as_str() == "material") {
            self.report(errors::missing_name(word.as_str(), name.span));
            return (Entry::Broken(Broken { name: None, span }), 0);
        }
        if is_reserved(&name.text) && &name.text != "material" {
            self.report(statements::begins_nothing(&name.text, name.span));
        } else if top {
            self.report(errors::missing_let(&name.text, name.span));
        } else {
            let edit = self.at(word.as_span().end(), sign.as_span().end());
            self.report(errors::equals_in_field(&name.text, self.span(&sign), edit));
            return (Entry::Field(Field { name, value }), depth);
        }
        (Entry::Broken(Broken { name: Some(name), span }), 0)
    }

    /// `let a 5`
    pub(super) fn undefined(&self, keyword: &Node, mut inner: Pairs<'t, Rule>, span: Span) -> Deep<Entry> {
        let name = self.name(&inner.next().expect("this slip has a name"));
        let place = self.span(keyword).to(name.span);
        self.report(errors::missing_equals(keyword.as_str(), &name.text, place));
        (Entry::Broken(Broken { name: Some(name), span }), 0)
    }

    /// `radius 50cm`
    pub(super) fn uncoloned(
        &self,
        word: &Node,
        mut inner: Pairs<'t, Rule>,
        span: Span,
        top: bool,
    ) -> Deep<Entry> {
        let name = self.name(word);
        let value = inner.next().expect("this slip has a value");
        let value_span = self.at(value.as_span().start(), self.before(value.as_span().end()).len());
        let field = &name.text == "material" && !top;
        if is_reserved(&name.text) && !field {
            self.report(statements::begins_nothing(&name.text, name.span));
        } else if !top {
            self.report(errors::missing_colon(&name.text, name.span, value_span));
            let (value, depth) = value::expression(self, value);
            return (Entry::Field(Field { name, value }), depth);
        } else if value.as_str().trim_end().bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_') {
            self.report(errors::missing_body(self.before(value.as_span().end()), value_span));
        } else {
            self.report(errors::no_brace(&name.text, name.span, value_span));
        }
        (Entry::Broken(Broken { name: Some(name), span }), 0)
    }

    /// `radius`
    pub(super) fn lone(&self, word: &Node, span: Span, top: bool) -> Entry {
        let name = self.name(word);
        self.report(match name.text.as_str() {
            keyword @ ("let" | "material") if top || keyword == "let" => {
                errors::missing_name(keyword, name.span)
            }
            word if is_reserved(word) && word != "material" => statements::begins_nothing(word, name.span),
            word if top => errors::missing_body(word, name.span),
            word => errors::lone_name(word, name.span),
        });
        Entry::Broken(Broken { name: Some(name), span })
    }

    /// `;` where a comma or nothing should stand.
    pub(super) fn semicolon(&self, pair: &Node) {
        let rest = self.after(pair.as_span().end()).trim_start_matches([' ', '\t', '\r']);
        let ends = if rest.is_empty() { !self.continued() } else { rest.starts_with(['\n', '}', ',', ')']) };
        let replacement = if ends { "" } else { "," };
        self.report(errors::semicolon(self.span(pair), replacement));
    }

    pub(super) fn crowded(&self, pair: &Node) {
        let start = pair.as_span().start();
        let rest = self.after(start);
        let skipped = rest.len() - rest.trim_start_matches([' ', '\t', '\r']).len();
        let word = errors::first_token(&rest[skipped..]);
        let start = start + skipped;
        self.report(errors::crowded(word, self.at(start, start + word.len())));
    }

    pub(super) fn stray(&self, pair: &Node) {
        let span = self.span(pair);
        match pair.as_str() {
            ";" => self.report(errors::semicolon(span, "")),
            sign => self.report(errors::stray_separator(span, sign)),
        }
    }
}
