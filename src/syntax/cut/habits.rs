//! What other languages begin comments and directives with, and the decimal comma.

use super::super::{BLANKS, NAMING_WORDS, errors, unpaired};
use super::{Cutter, Last, Level, is_word};
use errors::ForeignComment;

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
        let behind = self.last == Last::Operand && self.splits;
        let next = self.byte(self.at + 1);
        match self.bytes[self.at] {
            b'#' => {
                // A comment of ours stands apart when it is laid out.
                let comments = ["//", "/*"].iter().any(|sign| self.text[self.at + 1..].starts_with(sign));
                entry || behind && (comments || matches!(next, b' ' | b'\t' | b'\x0c' | b'#' | b'!'))
            }
            b';' => matches!(self.innermost(), 0 | b'{') && self.splits && self.are_words(self.at + 1),
            _ => next == b'-' && (entry || behind && self.are_words(self.at + 2)),
        }
    }

    /// Whether several words follow on the line, and nothing else, which are no entry and go on with no value.
    fn are_words(&self, at: usize) -> bool {
        if !matches!(self.byte(at), b' ' | b'\t') {
            return false;
        }
        let near = self.text.floor_char_boundary((at + MAX_HEAD).min(self.text.len()));
        let line = self.text[at..near].split(['\n', '}', ')', ']']).next().unwrap_or("");
        let mut words = line.split_ascii_whitespace();
        let begins = |word| NAMING_WORDS.contains(&word) || matches!(word, "import" | "if" | "assert");
        let joins = |word| matches!(word, "and" | "or" | "to" | "then" | "else" | "if" | "in");
        let first = words.next().is_some_and(|word| super::super::is_word(word) && !begins(word));
        let second = words.next().is_some_and(|word| super::super::is_word(word) && !joins(word));
        first && second && words.all(super::super::is_word)
    }

    /// Takes the rest of the line for what it is meant as, up to what closes a bracket that was opened on the line.
    pub(super) fn foreign_comment(&mut self) -> Last {
        let start = self.at;
        let line = || self.text[start..].split('\n').next().unwrap_or("").trim_ascii_end().len();
        let (first, word) = (self.bytes[start], self.word(start + 1));
        if first == b'#' && word.bytes().next().is_some_and(is_word) {
            let (place, length) = (self.span(start, start + 1 + word.len()), line());
            self.out.sink.push(errors::directive(word, place));
            self.blot(start, start + length);
            return self.take(length, Last::Operand);
        }
        let rest = &self.bytes[start..];
        let sign = rest.iter().take_while(|&&byte| byte == first).count();
        // No more of the line is looked at than is taken.
        let lone = unpaired(rest.iter().copied().take_while(|&byte| byte != b'\n'));
        let here = |level: &Level| !self.text[level.at..start].contains('\n');
        let place = self.span(start, start + sign);
        let (length, edits) = match lone {
            Some((at, true)) if self.beyond == 0 && self.levels.last().is_some_and(here) => {
                let length = self.text[start..start + at].trim_ascii_end().len();
                let end = self.span(start + length, start + length);
                let whole = self.text[start..start + length].contains("*/");
                (length, if whole { vec![] } else { vec![(place, "/*"), (end, " */")] })
            }
            _ => (line(), vec![(place, "//")]),
        };
        let certain = lone.is_none() && (first == b'#' || self.last == Last::Open);
        self.foreign_comments.push(ForeignComment { place, edits, certain });
        self.blot(start, start + length);
        self.take(length, Last::Operand)
    }

    /// `<!-- a comment -->`: where it ends, if one begins here. Without its end it goes to that of its line.
    pub(super) fn markup(&mut self) -> Option<usize> {
        let (start, rest) = (self.at, &self.text[self.at..]);
        let inside = rest.strip_prefix("<!--")?;
        let place = self.span(start, start + "<!--".len());
        let close = self.markup_ends.then(|| inside.find("-->")).flatten();
        // Where none is behind one, none is behind the next.
        self.markup_ends = close.is_some();
        let close = close.map(|length| start + "<!--".len() + length);
        // What closes a comment of ours would end it too early.
        let edits = match close.filter(|&close| !self.text[start..close].contains("*/")) {
            Some(close) => vec![(place, "/*"), (self.span(close, close + "-->".len()), "*/")],
            None => vec![],
        };
        self.foreign_comments.push(ForeignComment { place, certain: !edits.is_empty(), edits });
        let line = || start + rest.find('\n').unwrap_or(rest.len());
        Some(close.map_or_else(line, |close| close + "-->".len()))
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

    /// One message for all the comments that begin otherwise and are mended, and one for each that may be more.
    pub(super) fn report_foreign_comments(&mut self) {
        let all = std::mem::take(&mut self.foreign_comments);
        self.out.foreign = all.iter().map(|found| found.place).collect();
        let (certain, others): (Vec<_>, Vec<_>) = all.into_iter().partition(|found| found.certain);
        for found in std::iter::once(&certain[..]).chain(others.chunks(1)) {
            let sign = found.first().map_or("", |first| &self.text[first.place.range()]);
            if let Some(diagnostic) = errors::foreign_comments(sign, found) {
                self.out.sink.push(diagnostic);
            }
        }
    }
}
