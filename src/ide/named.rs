//! What the names of a text mean, wherever they stand.

use super::Analysis;
use super::walk::{entries_in, rows_in};
use crate::check::Meaning;
use crate::span::{SourceId, Span};
use crate::syntax::ast::Entry;
use std::ops::Range;

impl Analysis {
    /// The name at a byte of the text that was analysed, and what it means.
    pub(super) fn named(&self, at: usize) -> Option<(Span, Meaning)> {
        let here = |span: &Span| span.range().start <= at && at <= span.range().end;
        let near = self.uses(self.main, at..at);
        let declared = self.study.notes.declared.iter().map(|(span, _)| (*span, Meaning::Declared(*span)));
        let declared = declared.filter(|(span, _)| span.source == self.main && !span.range().is_empty());
        // Where two names touch, the one that begins is meant.
        near.into_iter().chain(declared).filter(|(span, _)| here(span)).max_by_key(|(span, _)| span.start)
    }

    /// What the name at a place means, if it is used there.
    pub(super) fn meaning(&self, place: Span) -> Option<Meaning> {
        let noted = self.study.notes.meaning(place);
        let in_rows = || self.uses(place.source, place.range()).into_iter().find(|(span, _)| *span == place);
        noted.or_else(|| in_rows().map(|(_, meaning)| meaning))
    }

    /// The names that are used in a part of a text, in order.
    pub(super) fn uses(&self, source: SourceId, range: Range<usize>) -> Vec<(Span, Meaning)> {
        let mut found = self.noted(source, &range).to_vec();
        let Some(file) = self.study.files.iter().find(|file| file.source == source) else { return found };
        for entry in entries_in(&file.tree.body, &range) {
            let Entry::Rows(rows) = entry else { continue };
            for row in rows_in(rows, &range) {
                let shape = rows.shapes()[rows.shape(row)].statement().span;
                if rows.place(row, shape) != shape {
                    let noted = self.noted(source, &shape.range()).iter();
                    found.extend(noted.map(|(span, meaning)| (rows.place(row, *span), *meaning)));
                }
            }
        }
        let touches = |span: Span| span.range().start <= range.end && range.start <= span.range().end;
        found.retain(|(span, _)| touches(*span));
        found.sort_by_key(|(span, _)| *span);
        found.dedup_by_key(|(span, _)| *span);
        found
    }

    /// Those that checking noted: of rows, the first of each shape.
    fn noted(&self, source: SourceId, range: &Range<usize>) -> &[(Span, Meaning)] {
        let uses = &self.study.notes.uses;
        let first = uses.partition_point(|(span, _)| (span.source, span.range().end) < (source, range.start));
        let last = uses.partition_point(|(span, _)| (span.source, span.range().start) <= (source, range.end));
        uses.get(first..last).unwrap_or(&[])
    }
}
