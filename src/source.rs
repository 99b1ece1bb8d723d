//! Source texts, and where lines begin in them.

use crate::files::FilePath;
use crate::span::{SourceId, Span};
use serde::Serialize;

/// One source text with the name a person knows it by.
#[derive(Clone, Debug)]
pub struct Source {
    /// Path as given, or `<stdin>`.
    pub name: String,
    /// The whole text.
    pub text: String,
    /// Where it lies below the root folder; what it names is found from there.
    pub path: FilePath,
    line_starts: Vec<u32>,
}

impl Source {
    /// Takes a text in, and finds its lines. It lies in the root folder; [`Source::at`] puts it elsewhere.
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Source {
        let text = text.into();
        let ends = text.bytes().enumerate().filter(|&(_, byte)| byte == b'\n');
        let line_starts = std::iter::once(0).chain(ends.map(|(at, _)| at as u32 + 1)).collect();
        let name = name.into();
        let path = FilePath::root(name.rsplit(['/', '\\']).next().unwrap_or("scene.rt"));
        Source { name, text, path, line_starts }
    }

    /// Says where it lies below the root folder.
    pub fn at(self, path: FilePath) -> Source {
        Source { path, ..self }
    }

    /// Line and column of a byte, both from 1; the column counts characters.
    pub fn line_column(&self, byte: usize) -> (usize, usize) {
        let line = self.line_starts.partition_point(|&start| start as usize <= byte) - 1;
        let start = self.line_starts[line] as usize;
        let column = self.text.get(start..byte).map_or(byte - start, |before| before.chars().count());
        (line + 1, column + 1)
    }

    /// The byte at a line and column, both from 1; a column past the end of its line is the end. None where there is no such
    /// line.
    pub fn byte(&self, line: usize, column: usize) -> Option<usize> {
        let start = *self.line_starts.get(line.checked_sub(1)?)? as usize;
        let range = self.line_range(start);
        let within = self.text[range.clone()].char_indices().nth(column.saturating_sub(1));
        Some(within.map_or(range.end, |(byte, _)| start + byte))
    }

    /// The bytes of the line that holds a byte, without the line's end.
    pub fn line_range(&self, byte: usize) -> std::ops::Range<usize> {
        let line = self.line_starts.partition_point(|&start| start as usize <= byte) - 1;
        let start = self.line_starts[line] as usize;
        let end = self.line_starts.get(line + 1).map_or(self.text.len(), |&next| next as usize - 1);
        let text = &self.text[start..end];
        start..start + text.strip_suffix('\r').unwrap_or(text).len()
    }
}

/// A range of a file, as programs are told of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Place<'s> {
    /// The name of the source.
    pub file: &'s str,
    /// Where it begins.
    pub start: Point,
    /// Behind its last character.
    pub end: Point,
}

/// A place between two characters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Point {
    /// Bytes before it.
    pub byte: u32,
    /// From 1.
    pub line: usize,
    /// In characters, from 1.
    pub column: usize,
}

/// The source texts of one compilation.
#[derive(Clone, Debug, Default)]
pub struct Sources {
    all: Vec<Source>,
}

impl Sources {
    /// Adds a source and gives its id.
    pub fn add(&mut self, source: Source) -> SourceId {
        self.all.push(source);
        SourceId(self.all.len() as u32 - 1)
    }

    /// Says where a source lies below the root folder.
    pub fn place(&mut self, id: SourceId, path: FilePath) {
        self.all[id.0 as usize].path = path;
    }

    /// The source with this id, which came from [`Sources::add`] of this table.
    pub fn get(&self, id: SourceId) -> &Source {
        &self.all[id.0 as usize]
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.all.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Each with its id.
    pub fn iter(&self) -> impl Iterator<Item = (SourceId, &Source)> {
        (0..).map(SourceId).zip(&self.all)
    }

    /// Where a span lies, as programs are told of it.
    pub fn place_of(&self, span: Span) -> Place<'_> {
        let source = self.get(span.source);
        let point = |byte: u32| {
            // A place may name more than there is, where only the beginning of a file was kept.
            let byte = byte.min(source.text.len() as u32);
            let (line, column) = source.line_column(source.text.floor_char_boundary(byte as usize));
            Point { byte, line, column }
        };
        Place { file: &source.name, start: point(span.start), end: point(span.end) }
    }

    /// The first line of the text of a span, without blanks around it.
    pub fn first_line(&self, span: Span) -> &str {
        let text = self.text(span);
        text[..text.find(['\n', '\r']).unwrap_or(text.len())].trim()
    }

    /// The head of a statement: its first line up to the `{`.
    pub fn head(&self, span: Span) -> &str {
        let line = self.first_line(span);
        line[..line.find('{').unwrap_or(line.len())].trim()
    }

    /// The text of a span.
    pub fn text(&self, span: Span) -> &str {
        self.all.get(span.source.0 as usize).and_then(|source| source.text.get(span.range())).unwrap_or("")
    }
}
