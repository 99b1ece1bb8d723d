//! Text behind a whole entry, on its line: `radius: sqrt 4`, `at: 0 1 0`, `radius: 1 meter`.

use super::ast::{Entry, ExprKind, Keyword, Name, StatementKind};
use super::build::{Builder, Node, is_reserved};
use super::slips::{is_placement, value_of};
use super::{BLANKS, errors, is_name, leading};
use crate::diagnostic::Diagnostic;
use crate::span::Span;

impl Builder<'_> {
    /// Says what text is that stands behind an entry.
    pub(super) fn extra(&self, pair: &Node, before: Option<&Entry>) {
        if self.long_unit(pair) {
            return;
        }
        if let Some(slip) = before.and_then(|before| self.beside(pair, before)) {
            return self.report(slip);
        }
        self.unexpected(pair, |token, span| {
            let mut slip = errors::unexpected_extra(token, span);
            // `pow#(2)`: what touches begins no comment.
            slip.fix = slip.fix.filter(|_| token != "#" || self.is_blank(span.start.saturating_sub(1)));
            slip
        });
    }

    /// What two values beside each other, or a word in the middle of a statement, are meant as.
    fn beside(&self, pair: &Node, before: &Entry) -> Option<Diagnostic> {
        let text = pair.as_str().trim_ascii();
        let start = pair.as_span().end() - pair.as_str().trim_ascii_start().len();
        let token = errors::first_token(text);
        let place = self.at(start, start + token.len());
        if let Entry::Statement(statement) = before
            && matches!(statement.kind, StatementKind::Param { range: None, .. })
            && token == "from"
        {
            return Some(errors::statements::range_from(place));
        }
        let value = value_of(before)?;
        // `0 -1 0` is a difference, and a value behind it.
        let whole = Span { end: place.start + text.len() as u32, ..value.span };
        let words: Vec<&str> = self.written(whole)?.split_ascii_whitespace().collect();
        let is_number = |word: &&str| word.trim_start_matches('-').starts_with(|c: char| c.is_ascii_digit());
        let is_whole = |word: &&str| word.bytes().all(|byte| byte.is_ascii_digit());
        match &value.kind {
            // Two values may as well be a comma or a sign that is missing, unless they are those of a size.
            _ if words.len() == 3 && words.iter().all(is_number)
                || words.len() == 2 && words.iter().all(is_whole) =>
            {
                let tuple = format!("({})", words.join(", "));
                let slip = errors::bare_components(whole, words.len());
                Some(slip.offer(format!("write `{tuple}`"), vec![(whole, tuple)]))
            }
            ExprKind::Name(name) if !is_reserved(token) && !is_placement(token) => {
                let made = is_made(before);
                let begins_value = |c: char| c.is_alphanumeric() || c == '"';
                let given = token.starts_with(begins_value) || made && token.len() > 1;
                let short = |word: &&str| word.len() < 20 && !word.contains(['(', '[', '{', '"']);
                // `rgb 1, 0, 0`
                let more = self.after(pair.as_span().end()).strip_prefix(',').map(str::trim_ascii_start);
                let several =
                    more.is_some_and(|more| more.starts_with(|c: char| c.is_ascii_digit() || c == '-'));
                let shown = text.split_ascii_whitespace().next().filter(short).filter(|_| !several);
                let shown = shown.unwrap_or("…");
                given.then(|| errors::beside_name(name, token, shown, made, place))
            }
            _ => None,
        }
    }

    /// `material: shiny metal { … }`, `let ball = new sphere { … }`: whether the value is a word before the kind.
    pub(super) fn word_before_kind(&self, pair: &Node, before: Option<&Entry>) -> bool {
        let Some(value) = before.and_then(value_of) else { return false };
        let ExprKind::Name(word) = &value.kind else { return false };
        let rest = self.after(pair.as_span().start()).trim_start_matches(BLANKS);
        let kind = leading(rest, ".");
        if !rest[kind.len()..].trim_start_matches(BLANKS).starts_with('{') || !kind.split('.').all(is_name) {
            return false;
        }
        let start = self.text_len() - rest.len();
        self.report(errors::two_kinds(word, kind, value.span, self.at(start, start + kind.len())));
        true
    }

    /// `1 meter`: whether that is the slip.
    fn long_unit(&self, pair: &Node) -> bool {
        let text = pair.as_str().trim_ascii_start();
        let start = pair.as_span().end() - text.len();
        let before = self.before(start);
        let digits = before.trim_end_matches(|c: char| c.is_ascii_digit() || c == '.').len();
        let number = if before.ends_with(')') { "(…)" } else { &before[digits..] };
        let word = errors::first_token(text);
        let end = start + word.len();
        let found = errors::long_unit(number, word, self.at(start, end), self.at(before.len(), end));
        found.filter(|_| !number.is_empty()).map(|diagnostic| self.report(diagnostic)).is_some()
    }

    /// `at: (0, 1, 0)m power: 60W`, without a comma: what begins behind a whole entry, if it has a name, is given.
    pub(super) fn begins_otherwise(&self, pair: &Node) -> Option<Name> {
        let text = pair.as_str().trim_ascii_start();
        let word = Some(leading(text, "")).filter(|word| is_name(word))?;
        let start = pair.as_span().start() + pair.as_str().len() - text.len();
        Some(Name { text: word.into(), span: self.at(start, start + word.len()) })
    }
}

/// Whether the value of an entry is certainly made by a kind.
pub(super) fn is_made(entry: &Entry) -> bool {
    match entry {
        Entry::Field(field) => matches!(field.name.text.as_str(), "material" | "lens"),
        Entry::Statement(statement) => {
            matches!(statement.kind, StatementKind::Definition { keyword: Keyword::Material, .. })
        }
        _ => false,
    }
}
