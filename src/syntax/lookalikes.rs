//! Characters that look like those of the language: full-width signs, curly quotes, the spaces and dashes of
//! typesetting. A text that was copied from a page has them. They are reported together, and
//! each is read as what it looks like as far as that shows where things end.

use super::cut::{Cut, after_marks};
use super::errors::{self, Sink};
use crate::span::{SourceId, Span};
use crate::units;
use std::borrow::Cow;
use std::collections::BTreeMap;

/// So many places are mended at once.
const MAX_PLACES: usize = 10_000;

/// A text as it is read.
pub(super) struct Read<'t> {
    /// With each such character in place of what it looks like, as long as it was.
    pub(super) text: Cow<'t, str>,
    /// Where they stand, in order.
    places: Vec<Span>,
}

impl Read<'_> {
    /// Items with such characters are not parsed: they are cut where they were meant to end, and no more is said of
    /// them.
    pub(super) fn skip(&self, cut: &mut Cut) {
        let mut places = self.places.iter().peekable();
        for item in &mut cut.items {
            let end = (item.start + item.text.len()) as u32;
            while places.next_if(|place| place.end <= item.start as u32).is_some() {}
            item.skipped |= places.peek().is_some_and(|place| place.start < end);
        }
    }

    /// A place in whole characters of the text as it was written.
    pub(super) fn whole(&self, place: Span, written: &str) -> Span {
        if self.places.is_empty() {
            return place;
        }
        let start = written.floor_char_boundary(place.start as usize) as u32;
        Span { start, end: written.ceil_char_boundary(place.end as usize) as u32, ..place }
    }
}

/// Reads a text, and reports such characters.
pub(super) fn read<'t>(source: SourceId, text: &'t str, sink: &mut Sink) -> Read<'t> {
    if text.is_ascii() {
        return Read { text: Cow::Borrowed(text), places: vec![] };
    }
    let mut reader =
        Reader { source, text, found: BTreeMap::new(), places: vec![], quotes: vec![], bytes: None };
    reader.run();
    for (first, places) in reader.found.values() {
        if let Some(diagnostic) = errors::lookalike(*first, places) {
            sink.push(diagnostic);
        }
    }
    errors::quoted_values(&reader.quotes).into_iter().for_each(|diagnostic| sink.push(diagnostic));
    let text = match reader.bytes.map(String::from_utf8) {
        Some(Ok(text)) => Cow::Owned(text),
        _ => Cow::Borrowed(text),
    };
    Read { text, places: reader.places }
}

/// What a character looks like; nothing where it is invisible.
fn looks_like(character: char) -> Option<&'static str> {
    Some(match character {
        '：' => ":",
        '，' | '、' => ",",
        '；' => ";",
        '（' => "(",
        '）' => ")",
        '｛' => "{",
        '｝' => "}",
        '［' => "[",
        '］' => "]",
        '＝' => "=",
        '＋' => "+",
        '－' | '−' | '–' | '—' | '‐' | '‑' => "-",
        '＊' => "*",
        '／' => "/",
        '²' => "2",
        '³' => "3",
        '＃' => "#",
        '＠' => "@",
        '\u{a0}' | '\u{2000}'..='\u{200a}' | '\u{202f}' | '\u{205f}' | '\u{3000}' => " ",
        '\u{200b}'..='\u{200f}' | '\u{2060}' | '\u{feff}' | '\u{ad}' => "",
        _ => return None,
    })
}

fn is_quote(character: char) -> bool {
    matches!(character, '“' | '”' | '„' | '‟' | '＂')
}

/// Whether a text is a quantity or the code of a colour, which no name of a file is.
fn is_value(text: &str) -> bool {
    let number = text.trim_start_matches('-').trim_start_matches(|c: char| c.is_ascii_digit() || c == '.');
    let digits = text.trim_start_matches('-').starts_with(|c: char| c.is_ascii_digit());
    digits && units::is_unit(number)
        || text.strip_prefix('#').is_some_and(|code| code.bytes().all(|byte| byte.is_ascii_hexdigit()))
}

/// Where one stands, and what it looks like.
type Place = (Span, &'static str);

/// What is reported together.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Group {
    Sign,
    Space,
    Invisible,
}

struct Reader<'t> {
    source: SourceId,
    text: &'t str,
    /// Signs, spaces and what is invisible: the first of each, and where they stand for what.
    found: BTreeMap<Group, (char, Vec<Place>)>,
    /// Where all of them stand, those that touch as one.
    places: Vec<Span>,
    /// The quotes around values that have none.
    quotes: Vec<Span>,
    /// The text as it is read, once that differs.
    bytes: Option<Vec<u8>>,
}

impl Reader<'_> {
    fn run(&mut self) {
        let mut at = after_marks(self.text);
        while let Some(character) = self.text[at..].chars().next() {
            let rest = &self.text[at..];
            let next = at + character.len_utf8();
            at = match character {
                '"' => at + text_end(rest),
                '/' if rest.starts_with("//") => at + rest.find('\n').unwrap_or(rest.len()),
                '/' if rest.starts_with("/*") => at + rest[2..].find("*/").map_or(rest.len(), |end| end + 4),
                _ if is_quote(character) => self.quoted(at, character),
                _ => {
                    if let Some(means) =
                        looks_like(character).filter(|means| *means != "-" || self.subtracts(at))
                    {
                        let means = if means == " " && self.parts_unit(at, next) { "" } else { means };
                        self.replace(at, character, means, false);
                    }
                    next
                }
            };
        }
    }

    /// Whether what stands before a dash can have something subtracted from it, or takes a value behind it: behind a
    /// body it begins words that are no part of the scene.
    fn subtracts(&self, at: usize) -> bool {
        let before = self.text[..at].trim_end_matches([' ', '\t']);
        !(before.is_empty() || before.ends_with(['}', '\n']))
    }

    /// A text in curly quotes. Without its end on the line, they are left as they are.
    fn quoted(&mut self, at: usize, opener: char) -> usize {
        let inside = at + opener.len_utf8();
        let end = self.text[inside..].find(|c| c == '"' || c == '\n' || is_quote(c));
        let closer = end.and_then(|end| self.text[inside + end..].chars().next().map(|c| (inside + end, c)));
        match closer {
            Some((end, closer)) if closer != '\n' && closer != '"' && is_value(&self.text[inside..end]) => {
                self.blank(at, opener);
                self.blank(end, closer);
                end + closer.len_utf8()
            }
            Some((end, closer)) if closer != '\n' => {
                self.replace(at, opener, "\"", true);
                if closer != '"' {
                    self.replace(end, closer, "\"", false);
                }
                end + closer.len_utf8()
            }
            _ => inside,
        }
    }

    /// Whether a space stands between a number and its unit, which touch.
    fn parts_unit(&self, at: usize, next: usize) -> bool {
        let number = self.text[..at].ends_with(|c: char| c.is_ascii_digit() || c == ')');
        let rest = &self.text[next..];
        let word = &rest[..rest.find(|c: char| !c.is_ascii_alphanumeric()).unwrap_or(rest.len())];
        number && (rest.starts_with('%') || units::is_unit(word) && word != "in")
    }

    /// Takes a quote away that stands beside a value.
    fn blank(&mut self, at: usize, character: char) {
        let length = character.len_utf8();
        let place = Span::new(self.source, at, at + length);
        if self.quotes.len() < MAX_PLACES {
            self.quotes.push(place);
        }
        self.places.push(place);
        let bytes = self.bytes.get_or_insert_with(|| self.text.as_bytes().to_vec());
        bytes[at..at + length].fill(b' ');
    }

    /// Puts what a character looks like in its place, at its end or at its beginning, beside blanks.
    fn replace(&mut self, at: usize, character: char, means: &'static str, at_end: bool) {
        let length = character.len_utf8();
        let group = match means {
            "" => Group::Invisible,
            " " => Group::Space,
            _ => Group::Sign,
        };
        let (_, places) = self.found.entry(group).or_insert((character, vec![]));
        if places.len() < MAX_PLACES {
            places.push((Span::new(self.source, at, at + length), means));
        }
        let place = Span::new(self.source, at, at + length);
        match self.places.last_mut().filter(|last| last.end >= place.start) {
            Some(last) => *last = last.to(place),
            None => self.places.push(place),
        }
        let bytes = self.bytes.get_or_insert_with(|| self.text.as_bytes().to_vec());
        bytes[at..at + length].fill(b' ');
        if let Some(sign) = means.bytes().next() {
            bytes[if at_end { at + length - 1 } else { at }] = sign;
        }
    }
}

/// How long a text is, from its `"` to its other one or to the end of its line.
fn text_end(text: &str) -> usize {
    let bytes = text.as_bytes();
    let mut at = 1;
    loop {
        match bytes.get(at) {
            None => return bytes.len(),
            Some(b'"') => return at + 1,
            Some(b'\n') => return at,
            Some(b'\\') if bytes.get(at + 1).is_some_and(|next| *next != b'\n') => at += 1,
            Some(_) => {}
        }
        at += 1;
        // An escaped character may be several bytes long.
        while at < bytes.len() && !text.is_char_boundary(at) {
            at += 1;
        }
    }
}
