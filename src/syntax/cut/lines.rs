//! Line ends: which of them separate.

use super::super::NAMING_WORDS;
use super::super::ast::Comment;
use super::super::errors;
use super::habits::MAX_HEAD;
use super::{Cutter, Gap, Last, Level, is_word};
use crate::span::Span;

impl<'t> Cutter<'t> {
    /// Skips white space and comments.
    pub(super) fn gap(&mut self) -> Gap {
        let mut gap =
            Gap { start: self.at, end: self.at, first_newline: None, comment: false, indent: self.indent };
        let mut line = None;
        while let Some(&byte) = self.bytes.get(self.at) {
            match byte {
                b' ' | b'\t' | b'\r' | b'\x0c' => self.at += 1,
                b'\n' => {
                    gap.first_newline.get_or_insert(self.at);
                    line = Some(self.at + 1);
                    self.at += 1;
                }
                b'/' if matches!(self.byte(self.at + 1), b'/' | b'*') => {
                    let start = self.at;
                    self.at = self.comment_end();
                    gap.comment = true;
                    if let Some(index) = self.bytes[start..self.at].iter().position(|&b| b == b'\n') {
                        gap.first_newline.get_or_insert(start + index);
                    }
                    let span = self.span(start, self.at);
                    self.out.comments.push(Comment { span });
                }
                b'<' if let Some(end) = self.markup() => {
                    gap.comment = true;
                    if let Some(index) = self.bytes[self.at..end].iter().position(|&b| b == b'\n') {
                        gap.first_newline.get_or_insert(self.at + index);
                    }
                    self.at = end;
                }
                _ => break,
            }
        }
        gap.end = self.at;
        if let Some(line) = line {
            self.indent = self.at - line;
        }
        gap
    }

    fn comment_end(&mut self) -> usize {
        let rest = &self.text[self.at..];
        if rest.starts_with("//") {
            let length = rest.find('\n').unwrap_or(rest.len());
            return self.at + if rest[..length].ends_with('\r') { length - 1 } else { length };
        }
        if let Some(length) = rest[2..].find("*/") {
            return self.at + 2 + length + 2;
        }
        let opener = self.span(self.at, self.at + 2);
        self.out.sink.push(errors::unclosed_comment(opener));
        self.ended_in_comment = true;
        self.bytes.len()
    }

    /// Decides what the gap before the next token is: blank, a separator, or the end of the item.
    pub(super) fn settle(&mut self, gap: &Gap) {
        if self.item.is_none() {
            return;
        }
        let Some(newline) = gap.first_newline else {
            if gap.comment {
                self.edits.push((gap.start..gap.end, b' '));
            }
            return;
        };
        if self.layout && !self.levels.is_empty() && self.indent == 0 && self.begins_item() {
            return self.close_all(Some(self.word_span()));
        }
        if self.shows_unclosed_choice() {
            self.edits.push((gap.start..gap.end, b' '));
            let seen = self.word_span();
            self.last = Last::Operand;
            return self.close_above(self.levels.len() - 1, Some(seen));
        }
        if self.shows_unclosed_body() {
            self.edits.push((gap.start..gap.end, b' '));
            let seen = self.word_span();
            self.last = Last::Operand;
            self.close_above(self.levels.len() - 1, Some(seen));
            self.edits.push((gap.end - 1..gap.end, b'\n'));
            return self.separate(gap, newline);
        }
        let end = self.end;
        let level = self.level();
        level.spread |= level.at + 1 == end;
        if self.shows_unclosed_parenthesis() {
            self.close_parentheses(gap);
            if self.levels.is_empty() {
                return self.close_all(None);
            }
            return self.separate(gap, newline);
        }
        if self.joins(gap) {
            self.edits.push((gap.start..gap.end, b' '));
        } else if self.levels.is_empty() && self.splits {
            self.finish();
        } else {
            if gap.comment {
                self.edits.push((gap.start..gap.end, b' '));
            }
            self.separate(gap, newline);
        }
    }

    fn separate(&mut self, gap: &Gap, newline: usize) {
        if gap.comment {
            self.edits.push((newline..newline + 1, b'\n'));
        }
        let level = self.level();
        (level.operators, level.angled, level.ifs) = (0, 0, 0);
        self.last = Last::Open;
    }

    /// Whether the line goes on over the line end before the next token.
    fn joins(&self, gap: &Gap) -> bool {
        if matches!(self.innermost(), b'(' | b'[') || self.beyond > 0 {
            return true;
        }
        match self.last {
            Last::Prefix => true,
            Last::Operator | Last::Definer => {
                !self.begins_field() && !self.begins_statement() && !self.begins_beside(gap)
            }
            Last::Operand | Last::Open => match (self.byte(self.at), self.byte(self.at + 1)) {
                (b'+' | b'*' | b'/' | b'<' | b'>' | b'{', _) => true,
                (b'|' | b'-', b'>') | (b'=' | b'!', b'=') => true,
                (b'.', next) => next.is_ascii_alphabetic() || next == b'_',
                (b'a' | b'o' | b't' | b'e' | b'i', _) => self.goes_on(),
                _ => false,
            },
        }
    }

    /// The text from the first token at or behind `at` on.
    pub(super) fn next_token(&self, at: usize) -> &'t str {
        let mut rest = self.text[at..].trim_ascii_start();
        loop {
            let comment = match rest {
                line if line.starts_with("//") => line.find('\n'),
                block if block.starts_with("/*") => block[2..].find("*/").map(|length| length + 4),
                _ => return rest,
            };
            rest = rest[comment.unwrap_or(rest.len())..].trim_ascii_start();
        }
    }

    // --- What a line begins with ----------------------------------------------------------------------------

    pub(super) fn word(&self, at: usize) -> &'t str {
        let length = self.bytes[at..].iter().take_while(|&&byte| is_word(byte)).count();
        &self.text[at..at + length]
    }

    pub(super) fn word_span(&self) -> Span {
        self.span(self.at, self.at + self.word(self.at).len())
    }

    /// The word at `at`, and where the token behind it begins on the same line.
    fn word_and_next(&self, at: usize) -> Option<(&'t str, usize)> {
        let word = self.word(at);
        let begins = word.bytes().next().is_some_and(|byte| !byte.is_ascii_digit());
        let rest = &self.bytes[at + word.len()..];
        let blank = rest.iter().take_while(|byte| matches!(byte, b' ' | b'\t' | b'\x0c')).count();
        begins.then_some((word, at + word.len() + blank))
    }

    /// `name:`
    fn begins_field(&self) -> bool {
        self.word_and_next(self.at).is_some_and(|(_, next)| self.byte(next) == b':')
    }

    /// A word in the middle of a statement: an operator, or one such as `else`.
    fn goes_on(&self) -> bool {
        let word = self.word(self.at);
        let inside =
            matches!(word, "and" | "or" | "to" | "in" | "as" | "then" | "else" | "elif" | "elseif" | "elsif");
        inside && (word == "else" || !matches!(self.byte(self.at + word.len()), b':' | b'='))
    }

    /// `let name`, `param name` and the like, `import "…"` or a prefix
    fn begins_statement(&self) -> bool {
        if self.byte(self.at) == b'@' {
            return true;
        }
        let Some((word, next)) = self.word_and_next(self.at) else { return false };
        match word {
            word if NAMING_WORDS.contains(&word) => {
                self.word_and_next(next).is_some_and(|(name, _)| !matches!(name, "and" | "or" | "to"))
            }
            "import" => self.byte(next) == b'"',
            "assert" => true,
            _ => false,
        }
    }

    /// Whether the line begins a statement, and no value of what the line before leaves unfinished: it is not indented deeper.
    fn begins_beside(&self, gap: &Gap) -> bool {
        let is_beside = self.indent <= gap.indent;
        if self.word(self.at) == "if" {
            let line = self.text[self.at..].split('\n').next().unwrap_or("");
            let is_statement = line.contains('{') && !line.contains("then");
            return is_beside && is_statement && !self.text[..self.end].ends_with("else");
        }
        is_beside && self.begins_item()
    }

    /// `kind {`, `kind name {`, `file.kind {`, `name =`, `let name` and the like
    fn begins_item(&self) -> bool {
        let Some((word, mut next)) = self.word_and_next(self.at) else { return false };
        if self.goes_on() {
            return false;
        }
        while self.byte(next) == b'.'
            && let Some((_, behind)) = self.word_and_next(next + 1)
        {
            next = behind;
        }
        let opens = |at| matches!(self.byte(at), b'{' | b'=') && self.byte(at + 1) != b'=';
        match self.word_and_next(next) {
            Some((_, after)) => self.begins_statement() || opens(after),
            None => self.begins_statement() || (opens(next) && !matches!(word, "and" | "or" | "else")),
        }
    }

    /// Whether the line goes on with the other choice of an `if` whose body is still open.
    fn shows_unclosed_choice(&self) -> bool {
        let open = self.levels.last().filter(|level| level.bracket == b'{' && level.indent == self.indent);
        let chooses = self.layout && matches!(self.word(self.at), "else" | "elif" | "elseif" | "elsif");
        let Some(level) = open.filter(|_| chooses) else { return false };
        let line = self.text[..level.at].rsplit('\n').next().unwrap_or("").trim_ascii_start();
        line.starts_with("if ") || line.starts_with("else ") || line.starts_with("} else ")
    }

    /// Where braces are known not to match, whether the line begins a thing beside the one whose body is still open, and
    /// not in it: it is indented as far.
    fn shows_unclosed_body(&self) -> bool {
        let beside = |level: &&Level| level.bracket == b'{' && level.indent == self.indent && self.indent > 0;
        let around = self.levels.len().checked_sub(2).map(|index| &self.levels[index]);
        self.layout
            && self.levels.last().as_ref().is_some_and(beside)
            && around.is_some_and(|around| around.bracket == b'{' && around.indent < self.indent)
            && self.begins_item()
    }

    /// `for i in range(3 {`: whether a brace inside parentheses in the head of a statement follows what is no kind.
    pub(super) fn shows_unclosed_head(&self) -> bool {
        let Some(level) = self.levels.last().filter(|level| level.bracket != b'{') else { return false };
        if self.beyond > 0 || self.last != Last::Operand {
            return false;
        }
        let near = self.text.floor_char_boundary(level.at.saturating_sub(MAX_HEAD));
        let line = self.text[near..level.at].rsplit('\n').next().unwrap_or("").trim_ascii_start();
        let line = line.strip_prefix("} else ").unwrap_or(line);
        let before = &self.bytes[..self.end];
        let word = before.iter().rev().take_while(|&&byte| is_word(byte)).count();
        let ends_value = match before[self.end - word..].first() {
            // `(0, 1, 0)m {`
            Some(first) => {
                first.is_ascii_digit() || matches!(self.bytes[..self.end - word].last(), Some(b')'))
            }
            None => before.ends_with(b")") || before.ends_with(b"]"),
        };
        ends_value && (line.starts_with("for ") || line.starts_with("if "))
    }

    /// Whether the line begins what can stand in a body and not in the parentheses around it.
    fn shows_unclosed_parenthesis(&self) -> bool {
        let Some(level) = self.levels.last().filter(|level| level.bracket != b'{') else { return false };
        match self.last {
            Last::Operand => self.begins_item() || (self.begins_field() && !level.spread),
            Last::Open => {
                let defines = self.begins_statement() && !matches!(self.word(self.at), "for" | "");
                self.end > level.at + 1 && (self.begins_field() && !level.call || defines)
            }
            Last::Operator | Last::Definer | Last::Prefix => false,
        }
    }
}
