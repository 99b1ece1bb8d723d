//! Where pieces of an item stand in its file, and what is written around them.

use super::{Builder, Node};
use crate::span::Span;
use crate::syntax::BLANKS;

impl<'t> Builder<'t> {
    pub(in crate::syntax) fn whole(&self) -> Span {
        // An item that was not parsed may end within a character that was read as another.
        let text = self.source.text;
        let (start, end) = (self.base, self.base + self.text.len());
        Span::new(self.source.id, text.floor_char_boundary(start), text.ceil_char_boundary(end))
    }

    /// The span of a range of the item.
    pub(in crate::syntax) fn at(&self, start: usize, end: usize) -> Span {
        Span::new(self.source.id, self.base + start, self.base + end)
    }

    pub(in crate::syntax) fn span(&self, pair: &Node) -> Span {
        let span = pair.as_span();
        self.at(span.start(), span.end())
    }

    /// The span without the white space at its end, which a rule takes that ends with something optional.
    pub(in crate::syntax) fn trimmed(&self, pair: &Node) -> Span {
        let span = pair.as_span();
        self.at(span.start(), self.before(span.end()).len().max(span.start()))
    }

    /// The place just behind what stands before a pair.
    pub(in crate::syntax) fn behind(&self, pair: &Node) -> Span {
        let before = self.before(pair.as_span().start()).len();
        self.at(before, before)
    }

    /// The text before an offset, without white space at its end.
    pub(in crate::syntax) fn before(&self, offset: usize) -> &'t str {
        self.text[..offset].trim_ascii_end()
    }

    /// The text before an offset.
    pub(in crate::syntax) fn all_before(&self, offset: usize) -> &'t str {
        &self.text[..offset]
    }

    /// Where the item begins in its file.
    pub(in crate::syntax) fn base(&self) -> usize {
        self.base
    }

    /// Whether white space stands at a place of the source, whatever the item has there.
    pub(in crate::syntax) fn is_blank(&self, place: u32) -> bool {
        self.source.text.as_bytes().get(place as usize).is_some_and(u8::is_ascii_whitespace)
    }

    /// Whether nothing but blanks stands behind a place of the source on its line.
    pub(in crate::syntax) fn ends_line(&self, place: u32) -> bool {
        let rest = self.source.text.get(place as usize..).unwrap_or("");
        rest.trim_start_matches(BLANKS).starts_with('\n') || rest.trim_start_matches(BLANKS).is_empty()
    }

    /// The text behind an offset.
    pub(in crate::syntax) fn after(&self, offset: usize) -> &'t str {
        &self.text[offset..]
    }

    /// What stands there as it was written, before characters were read as others; none within a character.
    pub(in crate::syntax) fn written(&self, place: Span) -> Option<&'t str> {
        self.source.text.get(place.range())
    }

    /// How long the item is, in bytes.
    pub(in crate::syntax) fn text_len(&self) -> usize {
        self.text.len()
    }

    /// Whether the item ends with `;` and the line goes on.
    pub(in crate::syntax) fn continued(&self) -> bool {
        self.continued
    }
}
