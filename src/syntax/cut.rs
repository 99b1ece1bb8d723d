//! Cuts a text into top-level items, each ready for the grammar.
//!
//! One pass over the bytes finds comments, matches brackets and decides which line ends separate. What the
//! grammar gets has exactly the length of the source, so places carry over: comments and line ends that do not
//! separate are blank, missing closers stand in the white space where they belong, and text that is past
//! mending is *blotted* with [`BLOT`], which the grammar reads as a value that was already reported.
//!
//! A line end does not separate inside parentheses, behind an operator, `=`, `:` or a prefix such as `@off`, and
//! before a line that starts with `->` or a binary operator other than `-`, with a word that goes on with a statement such
//! as `else`, with `.member` or with `{`. Where a line is left unfinished and the next one, which is not indented deeper, begins
//! a statement, it does: the value is missing.

mod brackets;
mod habits;
mod items;
mod lines;
#[cfg(test)]
mod tests;

use super::ast::Comment;
use super::errors::{self, Sink};
use crate::span::{SourceId, Span};
use std::borrow::Cow;
use std::ops::Range;

/// Stands in place of text that was reported.
pub(super) const BLOT: u8 = 1;

/// The most operators between two separators. A chain longer than the limit of depth is refused later with its
/// exact place; this bounds the memory that finding it takes.
const MAX_OPERATORS: usize = 8192;

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
    /// Closers that close nothing, in order.
    pub(super) strays: Vec<Stray>,
    /// Where comments begin as in other languages.
    pub(super) foreign: Vec<Span>,
}

/// A closer without an opener, or a run of them.
pub(super) struct Stray {
    pub(super) span: Span,
    pub(super) closer: char,
    /// Whether it is overlooked, since it closes what was reported as unclosed.
    pub(super) forgiven: bool,
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

/// Cuts a text into items. Brackets are nested at most `most` deep.
pub(super) fn cut(source: SourceId, text: &str, most: usize) -> Cut<'_> {
    Cutter::new(source, text, true, most).run()
}

/// Takes a text as one item, whatever separates in it.
pub(super) fn whole(source: SourceId, text: &str, most: usize) -> Cut<'_> {
    Cutter::new(source, text, false, most).run()
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
    /// `@off`: the statement may stand on the next line.
    Prefix,
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
    /// How many `if` since the last separator: each may hold the next.
    ifs: usize,
    /// Whether it holds the arguments of a prefix.
    prefix: bool,
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
            ifs: 0,
            prefix: false,
            call: false,
            spread: false,
            forgiven: 0,
        }
    }
}

/// How much was found before an item, which may have to be read once more.
#[derive(Default)]
struct Before {
    told: errors::Held,
    comments: usize,
    strays: usize,
    foreign_comments: usize,
    /// Closers to overlook outside all brackets.
    forgiven: usize,
}

/// White space and comments between two tokens.
struct Gap {
    start: usize,
    end: usize,
    first_newline: Option<usize>,
    comment: bool,
    /// Column at which the line before it begins.
    indent: usize,
}

struct Cutter<'t> {
    source: SourceId,
    text: &'t str,
    bytes: &'t [u8],
    /// Whether separators outside brackets end an item.
    splits: bool,
    /// The deepest nesting of brackets.
    most: usize,
    out: Cut<'t>,
    at: usize,
    /// Column of the first token of this line.
    indent: usize,
    last: Last,
    /// Whether a comma at the top level would have something before it.
    comma_allowed: bool,
    /// Whether the item is an `assert` whose message may follow.
    asserts: bool,
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
    /// What was found before the item.
    before: Before,
    ended_in_comment: bool,
    /// Where comments begin as in other languages.
    foreign_comments: Vec<errors::ForeignComment>,
    /// Whether `-->` may follow.
    markup_ends: bool,
}

/// Where a text begins behind the marks that tell its encoding. Programs that put theirs before another's leave several,
/// and those that add lines leave white space between them.
pub(super) fn after_marks(text: &str) -> usize {
    let is_mark = |c: char| c == '\u{feff}';
    let begins = text.len() - text.trim_start_matches(|c: char| c.is_ascii_whitespace() || is_mark(c)).len();
    text[..begins].rfind(is_mark).map_or(0, |last| last + '\u{feff}'.len_utf8())
}

impl<'t> Cutter<'t> {
    fn new(source: SourceId, text: &'t str, splits: bool, most: usize) -> Cutter<'t> {
        Cutter {
            source,
            text,
            bytes: text.as_bytes(),
            splits,
            most,
            out: Cut {
                items: vec![],
                comments: vec![],
                sink: Sink::default(),
                strays: vec![],
                foreign: vec![],
            },
            at: after_marks(text),
            indent: 0,
            last: Last::Open,
            comma_allowed: false,
            asserts: false,
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
            before: Before::default(),
            ended_in_comment: false,
            foreign_comments: vec![],
            markup_ends: true,
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
                self.report_foreign_comments();
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

    // --- Tokens ---------------------------------------------------------------------------------------------

    fn token(&mut self, first_on_line: bool) {
        let start = self.at;
        let byte = self.bytes[start];
        if self.levels.is_empty() && self.splits {
            match byte {
                b',' if self.base.angled == 0
                    && !self.is_decimal_comma()
                    && !self.precedes_number()
                    && !self.message_follows()
                    && !self.is_among_variables()
                    && !self.is_among_parameters() =>
                {
                    return self.comma();
                }
                b')' | b']' | b'}' => return self.stray_closer(),
                _ => {}
            }
        }
        if self.item.is_none() {
            self.begin(start);
        }
        self.last = match byte {
            b'#' | b'-' | b';' if self.begins_foreign_comment() => self.foreign_comment(),
            b';' if let Some(last) = self.counting_loop() => last,
            b'(' | b'[' | b'{' => self.open(),
            b')' | b']' | b'}' => self.close(first_on_line),
            b'"' => self.string(),
            b'0'..=b'9' => self.number(),
            b'@' => self.prefix(),
            b'#' => self.take(1 + self.word(start + 1).len(), Last::Operand),
            b',' | b';' => self.separator(),
            b'<' | b'>' => self.angle(byte),
            b'+' | b'-' | b'*' | b'/' | b'=' | b'!' | b'|' | b'.' | b':' => self.operator(byte),
            BLOT => self.control(),
            _ if is_word(byte) => self.name(),
            _ => self.take(1, Last::Operand),
        };
        self.end = self.at;
        if byte == b';' && self.at == start + 1 && self.levels.is_empty() && self.splits {
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
            "and" | "or" | "not" | "to" | "in" | "then" | "else" => self.count_operator(),
            "if" => self.count_if(),
            "assert" if self.levels.is_empty() && matches!(self.last, Last::Open | Last::Prefix) => {
                self.asserts = true;
                Last::Operand
            }
            _ => Last::Operand,
        };
        self.take(word.len(), last)
    }

    /// `@off`, where a statement may begin.
    fn prefix(&mut self) -> Last {
        let last = if matches!(self.last, Last::Open | Last::Prefix) { Last::Prefix } else { Last::Operand };
        self.take(1 + self.word(self.at + 1).len(), last)
    }

    /// Whether this comma stands between the condition of an `assert` and its message.
    fn message_follows(&mut self) -> bool {
        let mistyped = |start: usize| super::is_near(self.word(start), "assert");
        let asserts = self.asserts || self.levels.is_empty() && self.item.is_some_and(mistyped);
        self.asserts = false;
        asserts && self.next_token(self.at + 1).starts_with(['"', '('])
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

    /// Each `if` may hold the next one without a bracket between them.
    fn count_if(&mut self) -> Last {
        self.level().ifs += 1;
        self.nest();
        Last::Operand
    }

    /// Counts one more thing that is nested without a bracket.
    fn nest(&mut self) {
        self.depth += 1;
        let within = |level: &Level| level.ifs + level.angled;
        let nested: usize = self.levels.iter().chain([&self.base]).map(within).sum();
        if nested > self.most && !self.skipped {
            self.skipped = true;
            let place = self.span(self.at, self.at + 1);
            self.out.sink.push(errors::deep_brackets(place, self.most));
        }
    }

    /// `<` and `>` compare, save around a triple, where they stand for parentheses.
    fn angle(&mut self, byte: u8) -> Last {
        let operand = self.last == Last::Operand && !self.behind_color_word();
        let level = self.level();
        if byte == b'<' && !operand {
            level.angled += 1;
            self.nest();
        } else if byte == b'>' && level.angled > 0 {
            level.angled -= 1;
            return self.take(1, Last::Operand);
        }
        self.operator(byte)
    }

    fn separator(&mut self) -> Last {
        let level = self.level();
        (level.operators, level.ifs) = (0, 0);
        level.commas += 1;
        if level.commas > MAX_VALUES && level.bracket != b'{' && !self.skipped {
            self.skipped = true;
            let place = self.span(self.at, self.at + 1);
            self.out.sink.push(errors::many_values(place, MAX_VALUES));
        }
        // The message of an `assert` may stand on the next line.
        let message = self.bytes[self.at] == b',' && self.levels.is_empty() && self.splits;
        self.take(1, if message { Last::Operator } else { Last::Open })
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
}

fn is_word(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || byte == b'_' || byte >= 0x80
}
