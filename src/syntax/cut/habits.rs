//! What other languages begin comments and directives with, and the decimal comma.

use super::super::{BLANKS, errors};
use super::{Cutter, Last, is_word};

/// The longest head of a statement, in bytes, that is looked at: the time stays in proportion to the text.
pub(super) const MAX_HEAD: usize = 200;

/// The words that POV-Ray has before the parts of a colour in angle brackets.
///
/// Source: POV-Ray 3.7 reference, "Color Expressions".
fn is_color_word(word: &str) -> bool {
    matches!(word, "rgb" | "rgbf" | "rgbt" | "rgbft" | "srgb" | "srgbf" | "srgbt" | "srgbft")
}

impl Cutter<'_> {
    /// Whether the last token is a word that has angle brackets behind it elsewhere: `rgb <1, 0, 0>`.
    pub(super) fn behind_color_word(&self) -> bool {
        let before = &self.bytes[..self.end];
        let length = before.iter().rev().take_while(|&&byte| is_word(byte)).count();
        is_color_word(&self.text[self.end - length..self.end])
    }

    /// Whether a comma at the top level stands within a number: `let a = 1,5m`.
    pub(super) fn is_decimal_comma(&self) -> bool {
        let digit = |at: usize| self.byte(at).is_ascii_digit();
        self.at > 0 && digit(self.at - 1) && digit(self.at + 1)
    }

    /// Whether a number follows a comma at the top level, which begins nothing there: `let p = 0, 1, 0`.
    pub(super) fn precedes_number(&self) -> bool {
        let rest = self.text[self.at + 1..].trim_start_matches(BLANKS);
        let rest = rest.strip_prefix('-').unwrap_or(rest);
        self.item.is_some() && rest.starts_with(|c: char| c.is_ascii_digit())
    }

    /// Whether a comma at the top level stands between the variables of a loop: `for i, j in list`.
    pub(super) fn is_among_variables(&self) -> bool {
        let Some(head) = self.item.and_then(|start| self.text[start..self.at].strip_prefix("for")) else {
            return false;
        };
        let mut words = head.split(',');
        let names = words.by_ref().all(|word| {
            let word = word.trim_ascii();
            !word.is_empty() && word.bytes().all(is_word)
        });
        head.starts_with(BLANKS) && head.len() < MAX_HEAD && names
    }

    /// Whether a comma at the top level stands between parameters without parentheses: `fn f a: int, b: length)`.
    pub(super) fn is_among_parameters(&self) -> bool {
        let head = self.item.and_then(|start| self.text[start..self.at].strip_prefix("fn "));
        head.is_some_and(|head| {
            head.len() < MAX_HEAD && head.contains(':') && !head.contains(['(', '=', '{'])
        })
    }

    /// `# a comment`, `-- a comment`, `#include`: what begins so is no value. A colour has its digits at once, and
    /// begins no entry.
    pub(super) fn begins_foreign_comment(&self) -> bool {
        let entry = matches!(self.innermost(), 0 | b'{') && self.last == Last::Open && self.splits;
        let next = self.byte(self.at + 1);
        match self.bytes[self.at] {
            b'#' => {
                // A comment of ours stands apart when it is laid out.
                let comments = ["//", "/*"].iter().any(|sign| self.text[self.at + 1..].starts_with(sign));
                let apart = comments || matches!(next, b' ' | b'\t' | b'\x0c' | b'#' | b'!');
                entry || apart && self.last == Last::Operand && self.splits
            }
            b'<' => entry && self.text[self.at..].starts_with("<!--"),
            _ => entry && next == b'-',
        }
    }

    /// Takes the rest of the line for what it is meant as.
    pub(super) fn foreign_comment(&mut self) -> Last {
        let start = self.at;
        let line = self.text[start..].split('\n').next().unwrap_or("").trim_ascii_end();
        let length = line.len();
        let word = self.word(start + 1);
        if line.starts_with('#') && word.bytes().next().is_some_and(is_word) {
            let place = self.span(start, start + 1 + word.len());
            self.out.sink.push(errors::directive(word, place));
        } else {
            let sign = match line.strip_prefix("<!") {
                Some(dashes) => "<!".len() + dashes.bytes().take_while(|&byte| byte == b'-').count(),
                None => line.bytes().take_while(|&byte| byte == line.as_bytes()[0]).count(),
            };
            self.foreign_comments.push(self.span(start, start + sign));
        }
        self.blot(start, start + length);
        self.take(length, Last::Operand)
    }

    /// `for i = 0; i < 3; i++ {`: takes the head of a loop that counts for what it is meant as.
    pub(super) fn counting_loop(&mut self) -> Option<Last> {
        let start = self.item.filter(|_| self.levels.is_empty() && self.splits)?;
        let before = &self.text[start..self.at];
        if before.len() > MAX_HEAD || !before.starts_with("for ") || !before.contains('=') {
            return None;
        }
        let near = self.text.floor_char_boundary((self.at + MAX_HEAD).min(self.text.len()));
        let (rest, _) = self.text[self.at..near].split('\n').next()?.split_once('{')?;
        let end = self.at + rest.trim_ascii_end().len();
        if end == self.at + 1 {
            return None;
        }
        let place = self.span(start + "for ".len(), end);
        self.out.sink.push(errors::statements::counting_loop(place));
        self.blot(start, end);
        Some(self.take(rest.len(), Last::Operand))
    }

    /// One message for all the comments that begin otherwise.
    pub(super) fn report_foreign_comments(&mut self) {
        let sign = self.foreign_comments.first().map_or("", |place| &self.text[place.range()]);
        if let Some(diagnostic) = errors::foreign_comments(sign, &self.foreign_comments) {
            self.out.sink.push(diagnostic);
        }
    }
}
