//! The text of a document as the client edits it, and places in it as the client counts them.
//!
//! A line ends with `\n`, `\r\n` or `\r`, as the protocol has it. A place that is not there is the nearest one before
//! it, so that no edit is outside the text. `fuzz/script.rs` holds it against a text that is edited by the letter of the
//! protocol.

use std::ops::Range;
use std::sync::Arc;

/// How characters of a line are counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// In bytes.
    Utf8,
    /// In units of 16 bits: a character beyond the basic plane counts twice.
    Utf16,
    /// In characters.
    Utf32,
}

/// A place: line and units before it, both from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Place {
    /// Lines before it.
    pub line: u32,
    /// Units before it on its line.
    pub character: u32,
}

/// A text with its lines.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Text {
    text: Arc<String>,
    /// Where each line begins; the first at 0.
    starts: Vec<usize>,
}

impl Text {
    /// Takes a text in.
    pub fn new(text: String) -> Text {
        let starts = std::iter::once(0).chain(line_starts(&text, 0..text.len())).collect();
        Text { text: Arc::new(text), starts }
    }

    /// The whole text.
    pub fn whole(&self) -> &Arc<String> {
        &self.text
    }

    /// The byte at a place: between characters, and before the end of its line.
    pub fn byte(&self, place: Place, encoding: Encoding) -> usize {
        let Some(&start) = self.starts.get(place.line as usize) else { return self.text.len() };
        let line = &self.text[start..self.line_end(place.line as usize)];
        let units = place.character as usize;
        start
            + match encoding {
                Encoding::Utf8 => line.floor_char_boundary(units.min(line.len())),
                _ if line.is_ascii() => units.min(line.len()),
                Encoding::Utf16 => bytes_of(line, units, char::len_utf16),
                Encoding::Utf32 => bytes_of(line, units, |_| 1),
            }
    }

    /// Whether a place lies within a character.
    pub fn is_torn(&self, place: Place, encoding: Encoding) -> bool {
        let nearest = self.place(self.byte(place, encoding), encoding);
        // One behind the end of its line, or of the text, is that end.
        let is_behind =
            self.byte(Place { character: u32::MAX, ..place }, encoding) == self.byte(place, encoding);
        nearest != place && !is_behind
    }

    /// The place of a byte; of one within a character or a line's end, the place before.
    pub fn place(&self, byte: usize, encoding: Encoding) -> Place {
        let byte = self.text.floor_char_boundary(byte.min(self.text.len()));
        let line = self.starts.partition_point(|&start| start <= byte) - 1;
        let start = self.starts[line];
        let before = &self.text[start..byte.min(self.line_end(line))];
        let character = match encoding {
            Encoding::Utf8 => before.len(),
            _ if before.is_ascii() => before.len(),
            Encoding::Utf16 => before.chars().map(char::len_utf16).sum(),
            Encoding::Utf32 => before.chars().count(),
        };
        Place { line: line as u32, character: character as u32 }
    }

    /// Puts a text in place of a range of bytes, which lie between characters.
    pub fn replace(&mut self, range: Range<usize>, with: &str) {
        let Range { start, end } = range;
        // The line that is edited, or the one before where its end may become another: a `\r` may get its `\n`.
        let mut first = self.starts.partition_point(|&line| line <= start) - 1;
        if first > 0 && self.starts[first] == start {
            first -= 1;
        }
        // Lines that begin behind the edit begin there still.
        let kept = self.starts.partition_point(|&line| line <= end);
        Arc::make_mut(&mut self.text).replace_range(start..end, with);
        let moved = |line: usize| line + with.len() - (end - start);
        let behind: Vec<usize> = self.starts[kept..].iter().map(|&line| moved(line)).collect();
        let scanned = self.starts[first]..behind.first().copied().unwrap_or(self.text.len());
        let until = scanned.end;
        self.starts.truncate(first + 1);
        let found = line_starts(&self.text, scanned);
        // The first line behind is kept already.
        self.starts.extend(found.filter(|&line| behind.is_empty() || line < until));
        self.starts.extend(behind);
    }

    /// Where a line ends, before what ends it.
    fn line_end(&self, line: usize) -> usize {
        let Some(&next) = self.starts.get(line + 1) else { return self.text.len() };
        let text = &self.text.as_bytes()[self.starts[line]..next];
        let end = text.strip_suffix(b"\n").unwrap_or(text);
        let end = end.strip_suffix(b"\r").unwrap_or(end);
        self.starts[line] + end.len()
    }
}

/// Where lines begin behind the line ends of a range.
fn line_starts(text: &str, range: Range<usize>) -> impl Iterator<Item = usize> {
    let bytes = text.as_bytes();
    range
        .filter(move |&at| match bytes[at] {
            b'\n' => true,
            b'\r' => bytes.get(at + 1) != Some(&b'\n'),
            _ => false,
        })
        .map(|at| at + 1)
}

/// The bytes of the characters that so many units hold whole.
fn bytes_of(line: &str, units: usize, length: impl Fn(char) -> usize) -> usize {
    let mut left = units;
    let fits = |c: &char| {
        let fits = length(*c) <= left;
        left = left.saturating_sub(length(*c));
        fits
    };
    line.chars().take_while(fits).map(char::len_utf8).sum()
}
