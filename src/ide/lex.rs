//! The words and marks of a text, whether it is sound or not.

use std::ops::Range;

/// What a piece of text is by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Lexeme {
    /// A name or a word of the language.
    Word,
    /// A number, with the unit that touches it.
    Number,
    /// A text, to the end of its line where it is not closed.
    Text,
    /// `#` and what touches it.
    Color,
    /// `//` to the end of its line, or `/* */`.
    Comment,
    /// `@` and the word that touches it.
    Prefix,
    /// A line end.
    Line,
    /// Any other character; operators of two characters are one.
    Mark,
}

/// The pieces of a text from a byte on, in order, with their bytes.
pub(super) fn lex(text: &str, from: usize) -> impl Iterator<Item = (Lexeme, Range<usize>)> {
    let mut at = from.min(text.len());
    std::iter::from_fn(move || {
        let blank = |byte: &u8| matches!(byte, b' ' | b'\t' | b'\r' | 0x0c);
        at += text.as_bytes()[at..].iter().take_while(|byte| blank(byte)).count();
        let start = at;
        let (lexeme, length) = first(text.get(at..)?)?;
        at += length;
        Some((lexeme, start..at))
    })
}

/// The first piece of a text, and its length.
fn first(text: &str) -> Option<(Lexeme, usize)> {
    let bytes = text.as_bytes();
    let next = bytes.get(1).copied().unwrap_or(0);
    Some(match bytes.first()? {
        b'\n' => (Lexeme::Line, 1),
        b'/' if next == b'/' => (Lexeme::Comment, line(text)),
        b'/' if next == b'*' => (Lexeme::Comment, block_comment(bytes)),
        b'"' => (Lexeme::Text, quoted(bytes)),
        b'#' => (Lexeme::Color, 1 + word(&text[1..])),
        b'@' => (Lexeme::Prefix, 1 + word(&text[1..])),
        b'0'..=b'9' => (Lexeme::Number, number(text)),
        byte if is_word(*byte) => (Lexeme::Word, word(text)),
        b'-' | b'=' | b'|' if next == b'>' => (Lexeme::Mark, 2),
        b'=' | b'!' | b'<' | b'>' if next == b'=' => (Lexeme::Mark, 2),
        _ => (Lexeme::Mark, text.chars().next().map_or(1, char::len_utf8)),
    })
}

/// Whether a byte belongs to a word.
pub(super) fn is_word(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || byte == b'_' || byte >= 0x80
}

fn word(text: &str) -> usize {
    text.bytes().take_while(|byte| is_word(*byte)).count()
}

fn line(text: &str) -> usize {
    text.find('\n').unwrap_or(text.len())
}

/// The length of a block comment. They nest as the parser has them: not at all.
fn block_comment(bytes: &[u8]) -> usize {
    let end = bytes[2..].windows(2).position(|pair| pair == b"*/");
    end.map_or(bytes.len(), |end| 2 + end + 2)
}

fn quoted(bytes: &[u8]) -> usize {
    let mut at = 1;
    while let Some(byte) = bytes.get(at) {
        match byte {
            b'"' => return at + 1,
            b'\n' => return at,
            b'\\' if bytes.get(at + 1).is_some_and(|next| *next != b'\n') => at += 2,
            _ => at += 1,
        }
    }
    bytes.len()
}

/// The length of a number with its unit.
fn number(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digit = |at: usize| bytes.get(at).is_some_and(u8::is_ascii_digit);
    let mut at = word(text);
    // `1e-3`: the sign of an exponent.
    let exponent = |at: &mut usize, from: usize| {
        let digits = &text[from..*at];
        let signed =
            digits.ends_with(['e', 'E']) && digits[..digits.len() - 1].bytes().all(|b| b.is_ascii_digit());
        if signed && matches!(bytes.get(*at), Some(b'-' | b'+')) && digit(*at + 1) {
            *at += 1 + word(&text[*at + 1..]);
        }
    };
    exponent(&mut at, 0);
    if bytes.get(at) == Some(&b'.') && digit(at + 1) {
        let from = at + 1;
        at = from + word(&text[from..]);
        exponent(&mut at, from);
    }
    if bytes.get(at) == Some(&b'%') {
        return at + 1;
    }
    // `10W/m2`
    while bytes.get(at) == Some(&b'/') {
        let unit = &text[at + 1..at + 1 + word(&text[at + 1..])];
        if split(&text[..at]).1.is_empty() || crate::units::parse_unit(unit).is_err() {
            break;
        }
        at += 1 + unit.len();
    }
    at
}

/// A number without its unit, and the unit.
pub(super) fn split(number: &str) -> (&str, &str) {
    let bytes = number.as_bytes();
    let mut at = 0;
    while let Some(byte) = bytes.get(at) {
        let next = bytes.get(at + 1);
        at += match byte {
            b'0'..=b'9' | b'_' | b'.' => 1,
            b'e' | b'E' if next.is_some_and(u8::is_ascii_digit) => 1,
            b'e' | b'E'
                if matches!(next, Some(b'-' | b'+')) && bytes.get(at + 2).is_some_and(u8::is_ascii_digit) =>
            {
                2
            }
            _ => break,
        };
    }
    number.split_at(at)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pieces(text: &str) -> Vec<(Lexeme, &str)> {
        lex(text, 0).map(|(lexeme, range)| (lexeme, &text[range])).collect()
    }

    #[test]
    fn numbers_take_their_units_along() {
        use Lexeme::*;
        for number in ["8mm", "25%", "10W/m2", "1e-3", "1.5e3m", "1_000", "0.5", "3200K"] {
            assert_eq!(pieces(number), [(Number, number)]);
        }
        assert_eq!(pieces("1/m"), [(Number, "1"), (Mark, "/"), (Word, "m")]);
        assert_eq!(pieces("2m/count"), [(Number, "2m"), (Mark, "/"), (Word, "count")]);
        assert_eq!(split("1.5e3mm"), ("1.5e3", "mm"));
        assert_eq!(split("8ft"), ("8", "ft"));
    }

    #[test]
    fn any_text_is_taken_apart() {
        use Lexeme::*;
        assert_eq!(
            pieces("@off a|>\"x\\\"\n/* é */#fff// end"),
            [
                (Prefix, "@off"),
                (Word, "a"),
                (Mark, "|>"),
                (Text, "\"x\\\""),
                (Line, "\n"),
                (Comment, "/* é */"),
                (Color, "#fff"),
                (Comment, "// end"),
            ]
        );
        assert_eq!(pieces("/*"), [(Comment, "/*")]);
        assert_eq!(pieces("\"\\"), [(Text, "\"\\")]);
    }
}
