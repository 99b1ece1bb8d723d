//! Scripts of edits: what a client does to a text, as bytes that a fuzzer makes up. The text that the language server holds
//! is at every step that of a client who goes by the letter of the protocol.

use crate::document::{Encoding, Place, Text};
use std::ops::Range;

/// How characters may be counted.
pub const ENCODINGS: [Encoding; 3] = [Encoding::Utf8, Encoding::Utf16, Encoding::Utf32];

/// What is put in: characters of one to four bytes, all line ends and halves of them, and pieces of the language.
const PIECES: [&str; 20] = [
    "",
    "a",
    "ß",
    "€",
    "😀",
    "\n",
    "\r\n",
    "\r",
    "\u{2028}",
    "// 𝄞 \n",
    "/*",
    "*/",
    "{",
    "}",
    "(",
    ")m",
    "sphere s { radius: 8deg }\n",
    "let ä = 1m\r\n",
    "material m = diffuse { color: #d94f30 }",
    "\"",
];

/// The byte of a place, found by going through the text from its beginning.
pub fn byte(text: &str, place: Place, encoding: Encoding) -> usize {
    let Some(line) = lines(text).nth(place.line as usize) else { return text.len() };
    let units = |prefix: &str| match encoding {
        Encoding::Utf8 => prefix.len(),
        Encoding::Utf16 => prefix.encode_utf16().count(),
        Encoding::Utf32 => prefix.chars().count(),
    };
    let within = &text[line.clone()];
    let ends = within.char_indices().map(|(at, c)| at + c.len_utf8());
    let fits = ends.take_while(|&end| units(&within[..end]) <= place.character as usize);
    line.start + fits.last().unwrap_or(0)
}

/// The lines of a text, without what ends them.
fn lines(text: &str) -> impl Iterator<Item = Range<usize>> {
    let mut rest = Some(0);
    std::iter::from_fn(move || {
        let start = rest?;
        let Some(length) = text[start..].find(['\n', '\r']) else {
            rest = None;
            return Some(start..text.len());
        };
        let end = start + length;
        rest = Some(end + if text[end..].starts_with("\r\n") { 2 } else { 1 });
        Some(start..end)
    })
}

/// Edits a text as the bytes say, which tell places and pieces in turns, and gives it back.
pub fn run(script: &[u8]) -> String {
    let mut bytes = script.iter().copied();
    let encoding = ENCODINGS[usize::from(bytes.next().unwrap_or(0)) % ENCODINGS.len()];
    let mut text = Text::new(String::new());
    let mut plain = String::new();
    while let Some(piece) = bytes.next() {
        let mut number = || u32::from(bytes.next().unwrap_or(0)) % 24;
        let places = [0, 1].map(|_| Place { line: number(), character: number() });
        let [a, b] = places.map(|place| byte(&plain, place, encoding));
        assert_eq!([a, b], places.map(|place| text.byte(place, encoding)), "{places:?} of {plain:?}");
        assert_eq!(text.byte(text.place(a, encoding), encoding), a, "{a} of {plain:?}");
        // Half of all edits only put something in.
        let range = if piece & 128 == 0 { a..a } else { a.min(b)..a.max(b) };
        let piece = PIECES[usize::from(piece & 127) % PIECES.len()];
        text.replace(range.clone(), piece);
        plain.replace_range(range, piece);
        assert_eq!(text, Text::new(plain.clone()));
    }
    plain
}
