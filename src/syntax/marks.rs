//! Marks before an entry: `@off`, `@solo`, `@allow(…)`.

use super::ast::{Broken, Entry, Prefix};
use super::build::{Builder, Deep, Node};
use super::errors::statements;
use super::{Rule, elements};
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
                Entry::Broken(broken) => broken.span = span,
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

    fn prefix(&self, pair: Node<'t>) -> Deep<Option<Prefix>> {
        let span = self.trimmed(&pair);
        let mut inner = pair.into_inner();
        let Some(word) = inner.next().filter(|word| word.as_rule() == Rule::word) else {
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
