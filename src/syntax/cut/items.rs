//! Where items begin and end, and their text as the grammar reads it.

use super::super::BLANKS;
use super::{BLOT, Before, Cutter, Item, Last, Level, MAX_RESCANS};
use crate::span::Span;
use std::borrow::Cow;

impl<'t> Cutter<'t> {
    pub(super) fn begin(&mut self, start: usize) {
        self.item = Some(start);
        let forgiven = self.base.forgiven;
        self.before = Before {
            told: self.out.sink.held(),
            comments: self.out.comments.len(),
            strays: self.out.strays.len(),
            foreign_comments: self.foreign_comments.len(),
            forgiven,
        };
        self.base = Level { forgiven, ..Level::new(0, start, self.indent) };
        self.end = start;
        self.skipped = false;
        self.asserts = false;
        self.depth = 0;
    }

    /// Ends the item, with whatever brackets are open; the grammar takes the end of the text for their closers.
    pub(super) fn close_all(&mut self, seen: Option<Span>) {
        self.report_unclosed(0, seen, true);
        self.levels.clear();
        (self.open, self.beyond) = ([0; 3], 0);
        self.layout = self.rescans >= MAX_RESCANS;
        self.finish();
    }

    /// Ends the item behind its last token.
    pub(super) fn finish(&mut self) {
        let Some(start) = self.item.take() else { return };
        let text = &self.text[start..self.end];
        let text = if self.edits.is_empty() { Cow::Borrowed(text) } else { Cow::Owned(self.edited(start)) };
        self.edits.clear();
        self.out.items.push(Item {
            start,
            text,
            skipped: self.skipped,
            continued: self.continues(),
            depth: self.depth,
        });
        self.last = Last::Open;
        self.comma_allowed = true;
        let forgiven = self.base.forgiven;
        self.base = Level { forgiven, ..Level::new(0, 0, 0) };
    }

    /// Whether the item ends with `;` and the line goes on.
    pub(super) fn continues(&self) -> bool {
        let rest = self.text[self.end..].trim_start_matches(BLANKS);
        self.bytes[self.end - 1] == b';'
            && !rest.is_empty()
            && !rest.starts_with(['\n', ','])
            && !rest.starts_with("//")
    }

    pub(super) fn edited(&self, start: usize) -> String {
        let mut bytes = self.bytes[start..self.end].to_vec();
        for (range, byte) in &self.edits {
            let end = range.end.min(self.end);
            if range.start < end {
                bytes[range.start - start..end - start].fill(*byte);
            }
        }
        String::from_utf8(bytes).expect("edits cover whole characters")
    }

    pub(super) fn blot(&mut self, start: usize, end: usize) {
        self.edits.push((start..end, BLOT));
    }

    /// Reads the item once more, now with an eye on the layout, since its brackets do not match.
    pub(super) fn rescan(&mut self) {
        let start = self.item.unwrap_or(self.at);
        self.rescans += 1;
        self.layout = true;
        self.out.sink.truncate(self.before.told);
        self.out.comments.truncate(self.before.comments);
        self.out.strays.truncate(self.before.strays);
        self.foreign_comments.truncate(self.before.foreign_comments);
        self.base.forgiven = self.before.forgiven;
        self.edits.clear();
        self.levels.clear();
        (self.open, self.beyond) = ([0; 3], 0);
        (self.at, self.item, self.last) = (start, None, Last::Open);
        self.indent = start - self.text[..start].rfind('\n').map_or(0, |newline| newline + 1);
    }
}
