//! The few lines of a source that a diagnostic shows, each cut to what fits.

use super::{printable, printable_char};
use crate::source::Source;
use crate::span::Span;
use miette::{MietteError, MietteSpanContents, SourceCode, SourceSpan, SpanContents};
use std::ops::Range;

/// Columns that miette needs beside the text: line number, frame and a space.
const MARGIN: usize = 12;
/// The narrowest text that still says something.
const NARROWEST: usize = 40;

/// Pieces of lines, one behind the other in one text; miette sees offsets in that text.
pub(super) struct Excerpt {
    name: String,
    text: String,
    pieces: Vec<Piece>,
    ranges: Vec<Range<usize>>,
    /// Of each label, its column in the source, from 0.
    columns: Vec<usize>,
}

/// One line, or the part of a long line around a place. A label lies in one piece.
struct Piece {
    /// From 0.
    line: usize,
    /// Where it lies in the excerpt's text, the line end it was given included.
    range: Range<usize>,
}

/// A label's bytes in the source, within one line.
struct Place {
    index: usize,
    line: Range<usize>,
    bytes: Range<usize>,
}

impl Excerpt {
    /// Shows these spans of a source, each as far as its first line goes.
    pub(super) fn new(source: &Source, spans: &[Span], width: usize) -> Excerpt {
        let most = width.saturating_sub(MARGIN).max(NARROWEST);
        let mut places: Vec<Place> =
            spans.iter().enumerate().map(|(index, span)| place(source, index, *span)).collect();
        places.sort_by_key(|place| (place.bytes.start, place.bytes.end));
        let mut excerpt = Excerpt {
            name: printable(&source.name),
            text: String::new(),
            pieces: vec![],
            ranges: vec![0..0; spans.len()],
            columns: vec![0; spans.len()],
        };
        let mut rest = places.as_slice();
        while let Some(first) = rest.first() {
            let window = window(&source.text, first, most);
            // Further labels of the line are shown in the same piece where they fit whole.
            let inside = |place: &Place| place.line == first.line && place.bytes.end <= window.end;
            let count = 1 + rest[1..].iter().take_while(|place| inside(place)).count();
            let (together, others) = rest.split_at(count);
            excerpt.add(source, first.line.clone(), window, together);
            rest = others;
        }
        excerpt
    }

    /// Where the spans lie in the excerpt, in the order they were given.
    pub(super) fn ranges(&self) -> impl Iterator<Item = Range<usize>> {
        self.ranges.iter().cloned()
    }

    fn add(&mut self, source: &Source, line: Range<usize>, window: Range<usize>, places: &[Place]) {
        let start = self.text.len();
        if line.start < window.start {
            self.text.push('…');
        }
        for place in places {
            // Widened by what is marked; a label that does not fit is cut with its line.
            self.ranges[place.index] = Range { start: usize::MAX, end: 0 };
            self.columns[place.index] = source.line_column(place.bytes.start).1 - 1;
        }
        for (at, c) in source.text[window.clone()].char_indices() {
            self.mark(places, window.start + at);
            self.text.push(printable_char(c));
        }
        self.mark(places, window.end);
        if window.end < line.end {
            self.text.push('…');
        }
        // Without an end miette takes an empty line for no line.
        self.text.push('\n');
        let (line, _) = source.line_column(line.start);
        self.pieces.push(Piece { line: line - 1, range: start..self.text.len() });
    }

    /// The column in the source of the label at an offset of the excerpt.
    fn column(&self, offset: usize) -> usize {
        let label = self.ranges.iter().position(|range| range.start == offset);
        label.map_or(0, |index| self.columns[index])
    }

    /// Notes that the source's byte `at` comes next in the excerpt.
    fn mark(&mut self, places: &[Place], at: usize) {
        let here = self.text.len();
        for place in places {
            let range = &mut self.ranges[place.index];
            if at >= place.bytes.start {
                range.start = range.start.min(here);
            }
            if at <= place.bytes.end {
                range.end = here;
            }
        }
    }
}

/// A span's bytes, cut to the line it begins in.
fn place(source: &Source, index: usize, span: Span) -> Place {
    let text = &source.text;
    let start = text.floor_char_boundary(span.start as usize);
    let line = source.line_range(start);
    let start = start.min(line.end);
    let end = text.ceil_char_boundary(span.end as usize).clamp(start, line.end);
    Place { index, line, bytes: start..end }
}

/// The part of a line to show for a place: all of it if it is short, else about `most` characters.
fn window(text: &str, place: &Place, most: usize) -> Range<usize> {
    let line = &place.line;
    if text[line.clone()].char_indices().nth(most).is_none() {
        return line.clone();
    }
    let before = text[line.start..place.bytes.start].char_indices().rev().nth(most / 2);
    let start = before.map_or(line.start, |(at, _)| line.start + at);
    let end = text[start..line.end].char_indices().nth(most).map_or(line.end, |(at, _)| start + at);
    start..end
}

impl SourceCode for Excerpt {
    fn read_span<'a>(
        &'a self,
        span: &SourceSpan,
        _: usize,
        _: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        let holds = |at: usize| self.pieces.iter().position(|piece| piece.range.contains(&at));
        let first = holds(span.offset()).ok_or(MietteError::OutOfBounds)?;
        let last = holds(span.offset() + span.len()).ok_or(MietteError::OutOfBounds)?;
        let pieces = self.pieces.get(first..=last).ok_or(MietteError::OutOfBounds)?;
        // Only pieces of consecutive lines can be shown as one.
        if pieces.windows(2).any(|pair| pair[0].line + 1 != pair[1].line) {
            return Err(MietteError::OutOfBounds);
        }
        let range = pieces[0].range.start..pieces[pieces.len() - 1].range.end;
        let contents = MietteSpanContents::new_named(
            self.name.clone(),
            &self.text.as_bytes()[range.clone()],
            range.into(),
            pieces[0].line,
            self.column(span.offset()),
            pieces.len(),
        );
        Ok(Box::new(contents))
    }
}
