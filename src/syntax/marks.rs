//! Marks before an entry: `@off`, `@solo`, `@allow(…)`.

use super::ast::{Broken, Entry, Prefix};
use super::build::{Builder, Deep, Node};
use super::errors::statements;
use super::{BLANKS, Rule, elements, is_name};
use crate::diagnostic::Diagnostic;
use crate::span::Span;

impl<'t> Builder<'t> {
    /// An entry with `@off` and the like before it.
    pub(super) fn marked(&self, pair: Node<'t>, top: bool) -> Deep<Entry> {
        let span = self.trimmed(&pair);
        let (mut prefixes, mut written, mut deepest) = (vec![], "", 0);
        for pair in pair.into_inner() {
            if pair.as_rule() == Rule::mark {
                written = pair.as_str().trim_ascii_end();
                let (prefix, depth) = self.prefix(pair);
                deepest = deepest.max(depth);
                prefixes.extend(prefix);
                continue;
            }
            if let Some(slip) = prefixes.last().and_then(|mark| self.bare_arguments(mark, &pair)) {
                self.report(slip);
                return (Entry::Broken(Broken { name: None, span }), 0);
            }
            let (mut entry, depth) = self.entry(pair, top);
            match &mut entry {
                Entry::Statement(statement) => {
                    statement.doc = self.doc(span, statement.span);
                    statement.prefixes = prefixes;
                }
                Entry::Field(field) => {
                    if let Some(prefix) = prefixes.first() {
                        let mark = format!("@{}", prefix.name.text);
                        self.report(statements::marks_field(&mark, &field.name.text, prefix.span));
                    }
                }
                Entry::Broken(broken) => broken.span = span.to(broken.span),
                // The grammar knows nothing of them.
                Entry::Rows(_) => {}
            }
            return self.checked(entry, depth.max(deepest), span);
        }
        if let Some(last) = prefixes.last() {
            self.report(statements::marks_nothing(last, written));
        }
        (Entry::Broken(Broken { name: None, span }), 0)
    }

    /// `@allow W0106 "why"`: what stands behind a mark without parentheses, if that is the slip.
    fn bare_arguments(&self, mark: &Prefix, pair: &Node) -> Option<Diagnostic> {
        let text = pair.as_str().trim_ascii_end();
        let (code, reason) = text.split_once(BLANKS)?;
        let reason = reason.trim_start_matches(BLANKS);
        let bare = &mark.name.text == "allow" && mark.arguments.is_none() && is_name(code);
        let place = self.trimmed(pair);
        (bare && reason.starts_with('"')).then(|| statements::bare_arguments(code, reason, mark.span, place))
    }

    fn prefix(&self, pair: Node<'t>) -> Deep<Option<Prefix>> {
        let span = self.trimmed(&pair);
        let mut inner = pair.into_inner();
        let sign = inner.next().expect("a mark begins with its sign");
        let Some(word) = sign.into_inner().next() else {
            self.report(statements::missing_mark(Span { end: span.start + 1, ..span }));
            return (None, 0);
        };
        let name = self.name(&word);
        let Some(details) = inner.next() else {
            return (Some(Prefix { name, arguments: None, span }), 0);
        };
        let (arguments, depth) = elements::arguments(self, details);
        (Some(Prefix { name, arguments: Some(arguments), span }), depth)
    }
}
