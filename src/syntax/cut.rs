//! Cuts a text into top-level items, each ready for the grammar.
//!
//! One pass over the bytes finds comments, matches brackets and decides which line ends separate. What the
//! grammar gets has exactly the length of the source, so places carry over: comments and line ends that do not
//! separate are blank, missing closers stand in the white space where they belong, and text that is past
//! mending is *blotted* with [`BLOT`], which the grammar reads as a value that was already reported.
//!
//! A line end does not separate inside parentheses, behind an operator, `=` or `:`, and before a line that
//! starts with a binary operator other than `-`, with `.member` or with `{`.

use super::MAX_DEPTH;
mod brackets;
#[cfg(test)]
mod tests;

use super::ast::Comment;
use super::errors::{self, Sink};
use crate::span::{SourceId, Span};
use std::borrow::Cow;
use std::ops::Range;

/// Stands in place of text that was reported.
pub(super) const BLOT: u8 = 1;

/// The most operators between two separators. A chain longer than [`MAX_DEPTH`] is refused later with its
/// exact place; this bounds the memory that finding it takes.
const MAX_OPERATORS: usize = 16 * MAX_DEPTH;

/// The most values between two parentheses.
const MAX_VALUES: usize = 1_000_000;

/// How often the text is read once more to its end because something is unclosed, before layout decides for
/// good. It keeps the time in proportion to the text.
const MAX_RESCANS: usize = 8;

/// A text in pieces.
pub(super) struct Cut<'t> {
    /// In the order of the text.
    pub(super) items: Vec<Item<'t>>,
    /// All of them, in order.
    pub(super) comments: Vec<Comment>,
    /// What was wrong between the items and with their brackets.
    pub(super) sink: Sink,
}

/// What stands between two separators outside all brackets.
pub(super) struct Item<'t> {
    /// Offset in the source.
    pub(super) start: usize,
    /// The item as the grammar reads it, as long as in the source.
    pub(super) text: Cow<'t, str>,
    /// Whether it goes over a limit, which was reported: not to be parsed.
    pub(super) skipped: bool,
    /// Whether it ends with `;` and the line goes on.
    pub(super) continued: bool,
    /// How deep its brackets are nested, at least.
    pub(super) depth: usize,
}

/// Cuts a text into items.
pub(super) fn cut(source: SourceId, text: &str) -> Cut<'_> {
    Cutter::new(source, text, true).run()
}

/// Takes a text as one item, whatever separates in it.
pub(super) fn whole(source: SourceId, text: &str) -> Cut<'_> {
    Cutter::new(source, text, false).run()
}

/// What the last token was, as far as line ends and brackets care.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Last {
    /// A line end behind it may separate.
    Operand,
    /// The line goes on behind it.
    Operator,
    /// `:` or `=`: the line goes on, unless another field begins.
    Definer,
    /// A separator or an opening bracket.
    Open,
}

/// The inside of a bracket, or of no bracket at all.
struct Level {
    bracket: u8,
    at: usize,
    /// Column at which the bracket's line begins.
    indent: usize,
    /// Operators since the last separator.
    operators: usize,
    /// Commas so far.
    commas: usize,
    /// How many `<` stand where a value should: the slip `<x, y, z>` is open.
    angled: usize,
    /// Whether it holds the arguments of a function.
    call: bool,
    /// Whether a line ends behind the bracket: what it holds stands below it.
    spread: bool,
    /// Closers to overlook, since their openers were reported as unclosed.
    forgiven: usize,
}

impl Level {
    fn new(bracket: u8, at: usize, indent: usize) -> Level {
        Level {
            bracket,
            at,
            indent,
            operators: 0,
            commas: 0,
            angled: 0,
            call: false,
            spread: false,
            forgiven: 0,
        }
    }
}

/// White space and comments between two tokens.
struct Gap {
    start: usize,
    end: usize,
    first_newline: Option<usize>,
    comment: bool,
}

struct Cutter<'t> {
    source: SourceId,
    text: &'t str,
    bytes: &'t [u8],
    /// Whether separators outside brackets end an item.
    splits: bool,
    out: Cut<'t>,
    at: usize,
    /// Column of the first token of this line.
    indent: usize,
    last: Last,
    /// Whether a comma at the top level would have something before it.
    comma_allowed: bool,
    /// Start of the item that is being read.
    item: Option<usize>,
    /// End of its last token.
    end: usize,
    /// What its text has in place of the source's.
    edits: Vec<(Range<usize>, u8)>,
    skipped: bool,
    depth: usize,
    base: Level,
    levels: Vec<Level>,
    /// How many of `levels` are `(`, `[`, `{`.
    open: [usize; 3],
    /// Brackets open beyond the limit.
    beyond: usize,
    /// Whether layout may end an item.
    layout: bool,
    rescans: usize,
    /// How many diagnostics and comments there were before the item.
    before_item: (usize, usize),
    ended_in_comment: bool,
}

impl<'t> Cutter<'t> {
    fn new(source: SourceId, text: &'t str, splits: bool) -> Cutter<'t> {
        Cutter {
            source,
            text,
            bytes: text.as_bytes(),
            splits,
            out: Cut { items: vec![], comments: vec![], sink: Sink::new() },
            at: if text.starts_with('\u{feff}') { 3 } else { 0 },
            indent: 0,
            last: Last::Open,
            comma_allowed: false,
            item: None,
            end: 0,
            edits: vec![],
            skipped: false,
            depth: 0,
            base: Level::new(0, 0, 0),
            levels: vec![],
            open: [0; 3],
            beyond: 0,
            layout: false,
            rescans: 0,
            before_item: (0, 0),
            ended_in_comment: false,
        }
    }

    fn run(mut self) -> Cut<'t> {
        loop {
            let gap = self.gap();
            if self.at < self.bytes.len() {
                self.settle(&gap);
                self.token(gap.first_newline.is_some());
            } else if self.levels.is_empty() || self.layout || self.ended_in_comment {
                self.close_all(None);
                return self.out;
            } else {
                self.rescan();
            }
        }
    }

    fn span(&self, start: usize, end: usize) -> Span {
        Span::new(self.source, start, end)
    }

    fn byte(&self, at: usize) -> u8 {
        self.bytes.get(at).copied().unwrap_or(0)
    }

    fn level(&mut self) -> &mut Level {
        self.levels.last_mut().unwrap_or(&mut self.base)
    }

    fn innermost(&self) -> u8 {
        self.levels.last().map_or(0, |level| level.bracket)
    }

    // --- Between tokens -------------------------------------------------------------------------------------

    /// Skips white space and comments.
    fn gap(&mut self) -> Gap {
        let mut gap = Gap { start: self.at, end: self.at, first_newline: None, comment: false };
        let mut line = None;
        while let Some(&byte) = self.bytes.get(self.at) {
            match byte {
                b' ' | b'\t' | b'\r' => self.at += 1,
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
    fn settle(&mut self, gap: &Gap) {
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
        if self.joins() {
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
        (level.operators, level.angled) = (0, 0);
        self.last = Last::Open;
    }

    /// Whether the line goes on over the line end before the next token.
    fn joins(&self) -> bool {
        if matches!(self.innermost(), b'(' | b'[') || self.beyond > 0 {
            return true;
        }
        match self.last {
            Last::Operator | Last::Definer => !self.begins_field() && !self.begins_definition(),
            Last::Operand | Last::Open => match (self.byte(self.at), self.byte(self.at + 1)) {
                (b'+' | b'*' | b'/' | b'<' | b'>' | b'{', _) => true,
                (b'|', b'>') | (b'=' | b'!', b'=') => true,
                (b'.', next) => next.is_ascii_alphabetic() || next == b'_',
                (b'a' | b'o', _) => matches!(self.word(self.at), "and" | "or"),
                _ => false,
            },
        }
    }

    // --- What a line begins with ----------------------------------------------------------------------------

    fn word(&self, at: usize) -> &'t str {
        let length = self.bytes[at..].iter().take_while(|&&byte| is_word(byte)).count();
        &self.text[at..at + length]
    }

    fn word_span(&self) -> Span {
        self.span(self.at, self.at + self.word(self.at).len())
    }

    /// The word at `at`, and where the token behind it begins on the same line.
    fn word_and_next(&self, at: usize) -> Option<(&'t str, usize)> {
        let word = self.word(at);
        let begins = word.bytes().next().is_some_and(|byte| !byte.is_ascii_digit());
        let rest = &self.bytes[at + word.len()..];
        let blank = rest.iter().take_while(|byte| matches!(byte, b' ' | b'\t')).count();
        begins.then_some((word, at + word.len() + blank))
    }

    /// `name:`
    fn begins_field(&self) -> bool {
        self.word_and_next(self.at).is_some_and(|(_, next)| self.byte(next) == b':')
    }

    /// `let name` or `material name`
    fn begins_definition(&self) -> bool {
        let named = |next| self.word_and_next(next).is_some_and(|(name, _)| !matches!(name, "and" | "or"));
        self.word_and_next(self.at)
            .is_some_and(|(word, next)| matches!(word, "let" | "material") && named(next))
    }

    /// `kind {`, `kind name {`, `name =` or `let name`
    fn begins_item(&self) -> bool {
        let Some((word, next)) = self.word_and_next(self.at) else { return false };
        let opens = |at| matches!(self.byte(at), b'{' | b'=') && self.byte(at + 1) != b'=';
        match self.word_and_next(next) {
            Some((_, after)) => self.begins_definition() || opens(after),
            None => opens(next) && !matches!(word, "and" | "or"),
        }
    }

    /// Whether the line begins what can stand in a body and not in the parentheses around it.
    fn shows_unclosed_parenthesis(&self) -> bool {
        let Some(level) = self.levels.last().filter(|level| level.bracket != b'{') else { return false };
        match self.last {
            Last::Operand => self.begins_item() || (self.begins_field() && !level.spread),
            Last::Open => self.end > level.at + 1 && self.begins_field() && !level.call,
            Last::Operator | Last::Definer => false,
        }
    }

    // --- Tokens ---------------------------------------------------------------------------------------------

    fn token(&mut self, first_on_line: bool) {
        let start = self.at;
        let byte = self.bytes[start];
        if self.levels.is_empty() && self.splits {
            match byte {
                b',' if self.base.angled == 0 => return self.comma(),
                b')' | b']' | b'}' => return self.stray_closer(),
                _ => {}
            }
        }
        if self.item.is_none() {
            self.begin(start);
        }
        self.last = match byte {
            b'(' | b'[' | b'{' => self.open(),
            b')' | b']' | b'}' => self.close(first_on_line),
            b'"' => self.string(),
            b'0'..=b'9' => self.number(),
            b'#' => self.take(1 + self.word(start + 1).len(), Last::Operand),
            b',' | b';' => self.separator(),
            b'<' | b'>' => self.angle(byte),
            b'+' | b'-' | b'*' | b'/' | b'=' | b'!' | b'|' | b'.' | b':' => self.operator(byte),
            BLOT => self.control(),
            _ if is_word(byte) => self.name(),
            _ => self.take(1, Last::Operand),
        };
        self.end = self.at;
        if byte == b';' && self.levels.is_empty() && self.splits {
            self.finish();
            self.comma_allowed = false;
        }
    }

    fn take(&mut self, length: usize, last: Last) -> Last {
        self.at += length;
        last
    }

    fn name(&mut self) -> Last {
        let word = self.word(self.at);
        let last = match word {
            "and" | "or" | "not" => self.count_operator(),
            _ => Last::Operand,
        };
        self.take(word.len(), last)
    }

    fn number(&mut self) -> Last {
        loop {
            self.at += self.word(self.at).len();
            if self.byte(self.at) != b'.' || !self.byte(self.at + 1).is_ascii_digit() {
                return Last::Operand;
            }
            self.at += 1;
        }
    }

    fn operator(&mut self, byte: u8) -> Last {
        let last = self.count_operator();
        // The two bytes of one operator count as one.
        let length = if matches!(self.byte(self.at + 1), b'=' | b'>') && byte != b'.' { 2 } else { 1 };
        self.take(length, if length == 1 && matches!(byte, b':' | b'=') { Last::Definer } else { last })
    }

    fn count_operator(&mut self) -> Last {
        let level = self.level();
        level.operators += 1;
        if level.operators > MAX_OPERATORS && !self.skipped {
            self.skipped = true;
            let place = self.span(self.at, self.at + 1);
            self.out.sink.push(errors::long_expression(place));
        }
        Last::Operator
    }

    /// `<` and `>` compare, save around a triple, where they stand for parentheses.
    fn angle(&mut self, byte: u8) -> Last {
        let operand = self.last == Last::Operand;
        let level = self.level();
        if byte == b'<' && !operand {
            level.angled += 1;
            let too_deep = level.angled > MAX_DEPTH;
            self.depth += 1;
            if too_deep && !self.skipped {
                self.skipped = true;
                let place = self.span(self.at, self.at + 1);
                self.out.sink.push(errors::deep_brackets(place));
            }
        } else if byte == b'>' && level.angled > 0 {
            level.angled -= 1;
            return self.take(1, Last::Operand);
        }
        self.operator(byte)
    }

    fn separator(&mut self) -> Last {
        let level = self.level();
        level.operators = 0;
        level.commas += 1;
        if level.commas > MAX_VALUES && level.bracket != b'{' && !self.skipped {
            self.skipped = true;
            let place = self.span(self.at, self.at + 1);
            self.out.sink.push(errors::many_values(place, MAX_VALUES));
        }
        self.take(1, Last::Open)
    }

    /// A comma outside all brackets ends an item.
    fn comma(&mut self) {
        if self.item.is_none() && !self.comma_allowed {
            let place = self.span(self.at, self.at + 1);
            self.out.sink.push(errors::stray_separator(place, ","));
        }
        self.finish();
        self.at += 1;
        self.comma_allowed = false;
    }

    /// A string ends on its line. Where it does not, the closing brackets and commas at the line's end are
    /// taken to be meant as such.
    fn string(&mut self) -> Last {
        let start = self.at;
        let mut at = start + 1;
        loop {
            match self.byte(at) {
                b'"' => return self.take(at + 1 - start, Last::Operand),
                b'\\' if at + 1 < self.bytes.len() && self.bytes[at + 1] != b'\n' => at += 1,
                b'\n' => break,
                _ if at >= self.bytes.len() => break,
                _ => {}
            }
            at += 1;
        }
        let closers = |c: char| c.is_ascii_whitespace() || matches!(c, ')' | ']' | '}' | ',');
        let length = self.text[start..at].trim_end_matches(closers).len().max(1);
        self.out.sink.push(errors::unclosed_string(self.span(start, start + 1)));
        self.blot(start, start + length);
        self.take(length, Last::Operand)
    }

    /// The byte that blots are made of is reported wherever it stands in the source.
    fn control(&mut self) -> Last {
        let run = self.bytes[self.at..].iter().take_while(|&&byte| byte == BLOT).count();
        self.out.sink.push(errors::control(self.span(self.at, self.at + run)));
        self.take(run, Last::Operand)
    }

    // --- Items ----------------------------------------------------------------------------------------------

    fn begin(&mut self, start: usize) {
        self.item = Some(start);
        self.before_item = (self.out.sink.len(), self.out.comments.len());
        let forgiven = self.base.forgiven;
        self.base = Level { forgiven, ..Level::new(0, start, self.indent) };
        self.end = start;
        self.skipped = false;
        self.depth = 0;
    }

    /// Ends the item, with whatever brackets are open; the grammar takes the end of the text for their closers.
    fn close_all(&mut self, seen: Option<Span>) {
        self.report_unclosed(0, seen);
        self.levels.clear();
        (self.open, self.beyond) = ([0; 3], 0);
        self.layout = self.rescans >= MAX_RESCANS;
        self.finish();
    }

    /// Ends the item behind its last token.
    fn finish(&mut self) {
        let Some(start) = self.item.take() else { return };
        let text = &self.text[start..self.end];
        let text = if self.edits.is_empty() { Cow::Borrowed(text) } else { Cow::Owned(self.edited(start)) };
        self.edits.clear();
        self.out.items.push(Item {
            start,
            text,
            skipped: self.skipped,
            continued: self.continues(),
            depth: self.depth,
        });
        self.last = Last::Open;
        self.comma_allowed = true;
        let forgiven = self.base.forgiven;
        self.base = Level { forgiven, ..Level::new(0, 0, 0) };
    }

    /// Whether the item ends with `;` and the line goes on.
    fn continues(&self) -> bool {
        let rest = self.text[self.end..].trim_start_matches([' ', '\t', '\r']);
        self.bytes[self.end - 1] == b';'
            && !rest.is_empty()
            && !rest.starts_with(['\n', ','])
            && !rest.starts_with("//")
    }

    fn edited(&self, start: usize) -> String {
        let mut bytes = self.bytes[start..self.end].to_vec();
        for (range, byte) in &self.edits {
            let end = range.end.min(self.end);
            if range.start < end {
                bytes[range.start - start..end - start].fill(*byte);
            }
        }
        String::from_utf8(bytes).expect("edits cover whole characters")
    }

    fn blot(&mut self, start: usize, end: usize) {
        self.edits.push((start..end, BLOT));
    }

    /// Reads the item once more, now with an eye on the layout, since its brackets do not match.
    fn rescan(&mut self) {
        let start = self.item.unwrap_or(self.at);
        self.rescans += 1;
        self.layout = true;
        self.out.sink.truncate(self.before_item.0);
        self.out.comments.truncate(self.before_item.1);
        self.edits.clear();
        self.levels.clear();
        (self.open, self.beyond) = ([0; 3], 0);
        (self.at, self.item, self.last) = (start, None, Last::Open);
        self.indent = start - self.text[..start].rfind('\n').map_or(0, |newline| newline + 1);
    }
}

fn is_word(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || byte == b'_' || byte >= 0x80
}
