//! Brackets: which closes which, and what is taken to be meant where they do not match.

use super::super::errors;
use super::{Cutter, Gap, Last, Level, Stray};
use crate::span::Span;

impl Cutter<'_> {
    pub(super) fn open(&mut self) -> Last {
        let byte = self.bytes[self.at];
        if byte == b'{' && self.shows_unclosed_head() {
            let keep =
                self.levels.iter().rposition(|level| level.bracket == b'{').map_or(0, |index| index + 1);
            self.close_above(keep, Some(self.span(self.at, self.at + 1)));
        }
        if self.beyond > 0 || self.levels.len() == self.most {
            if !self.skipped {
                self.skipped = true;
                let place = self.span(self.at, self.at + 1);
                self.out.sink.push(errors::deep_brackets(place, self.most));
            }
            self.beyond += 1;
        } else {
            self.open[index(byte)] += 1;
            let prefix = self.last == Last::Prefix;
            let call = prefix || self.last == Last::Operand;
            self.levels.push(Level { call, prefix, ..Level::new(byte, self.at, self.indent) });
            self.depth = self.depth.max(self.levels.len());
        }
        self.take(1, Last::Open)
    }

    pub(super) fn close(&mut self, first_on_line: bool) -> Last {
        let closer = self.bytes[self.at];
        if self.beyond > 0 {
            self.beyond -= 1;
            return self.take(1, Last::Operand);
        }
        if self.layout && first_on_line && closer == b'}' {
            self.close_indented();
        }
        let opener = opener_of(closer);
        let prefix = self.levels.last().is_some_and(|level| level.prefix && level.bracket == opener);
        let place = self.span(self.at, self.at + 1);
        match self.levels.last() {
            Some(level) if level.bracket == opener => self.pop(1),
            Some(level) if level.forgiven > 0 => {
                self.level().forgiven -= 1;
                self.edits.push((self.at..self.at + 1, b' '));
            }
            Some(_) if self.open[index(opener)] > 0 => {
                let matching = self.levels.iter().rposition(|level| level.bracket == opener);
                self.close_above(matching.map_or(0, |index| index + 1), Some(place));
                self.pop(1);
            }
            // Where braces are known not to match, this one was meant.
            Some(level) if closer != b'}' && (level.bracket != b'{' || self.layout) => {
                let right = closer_of(level.bracket);
                let opened = self.span(level.at, level.at + 1);
                self.out.sink.push(errors::wrong_closer(
                    place,
                    opened,
                    char::from(closer),
                    char::from(right),
                ));
                self.edits.push((self.at..self.at + 1, right));
                self.pop(1);
            }
            _ => {
                let closer = char::from(closer);
                match self.splits {
                    true => self.out.strays.push(Stray { span: place, closer, forgiven: false }),
                    false => self.out.sink.push(errors::stray_closer(place, closer)),
                }
                self.edits.push((self.at..self.at + 1, b' '));
            }
        }
        self.take(1, if prefix { Last::Prefix } else { Last::Operand })
    }

    fn pop(&mut self, count: usize) {
        for level in self.levels.drain(self.levels.len() - count..) {
            self.open[index(level.bracket)] -= 1;
        }
    }

    /// Closes the brackets above the level `keep`, which `at` shows to be unclosed: in the white space before
    /// this token where there is enough of it, else by blotting them.
    pub(super) fn close_above(&mut self, keep: usize, seen: Option<Span>) {
        self.report_unclosed(keep, seen, true);
        let closers: Vec<u8> =
            self.levels[keep..].iter().rev().map(|level| closer_of(level.bracket)).collect();
        if self.at - self.end >= closers.len() {
            for (index, closer) in closers.iter().enumerate() {
                self.edits.push((self.end + index..self.end + index + 1, *closer));
            }
        } else {
            self.blot(self.levels[keep].at, self.end);
        }
        self.pop(closers.len());
    }

    /// A line that begins an entry shows that the parentheses before it should have been closed.
    pub(super) fn close_parentheses(&mut self, gap: &Gap) {
        let keep = self.levels.iter().rposition(|level| level.bracket == b'{').map_or(0, |index| index + 1);
        let count = self.levels.len() - keep;
        let seen = self.word_span();
        // Closers may follow, which are overlooked.
        self.report_unclosed(keep, Some(seen), false);
        self.edits.push((gap.start..gap.end, b' '));
        if keep == 0 && self.splits {
            // The end of the item closes them.
            self.base.forgiven += count;
            return self.pop(count);
        }
        if gap.end - gap.start > count {
            for index in 0..count {
                let closer = closer_of(self.levels[self.levels.len() - 1 - index].bracket);
                self.edits.push((gap.start + index..gap.start + index + 1, closer));
            }
        } else {
            self.blot(self.levels[keep].at, self.end);
        }
        self.edits.push((gap.end - 1..gap.end, b'\n'));
        self.pop(count);
        self.level().forgiven += count;
    }

    /// Where braces are known not to match, a `}` that begins its line belongs to the `{` whose line is
    /// indented as far.
    fn close_indented(&mut self) {
        let Some(top) = self.levels.iter().rposition(|level| level.bracket == b'{') else { return };
        if self.levels[top].indent <= self.indent {
            return;
        }
        let alike = |level: &Level| level.bracket == b'{' && level.indent == self.indent;
        if let Some(matching) = self.levels[..top].iter().rposition(alike) {
            let seen = self.span(self.at, self.at + 1);
            self.close_above(matching + 1, Some(seen));
        }
    }

    /// `closes` is whether it is mended by closers at the end of what is before.
    pub(super) fn report_unclosed(&mut self, keep: usize, seen: Option<Span>, closes: bool) {
        if self.skipped || self.ended_in_comment || keep == self.levels.len() {
            return;
        }
        let openers = self.levels[keep..].iter().rev().map(|level| self.span(level.at, level.at + 1));
        let closer = closer_of(self.innermost());
        // Where fields may have come into parentheses, these end before them.
        let level = &self.levels[self.levels.len() - 1];
        let closes = closes && (level.bracket == b'{' || !self.bytes[level.at..self.end].contains(&b':'));
        let closers = closes.then(|| (self.span(self.end, self.end), self.closers(keep)));
        let diagnostic = errors::unclosed(openers, char::from(closer), seen, closers);
        self.out.sink.push(diagnostic);
    }

    /// What closes the brackets above the level `keep`: braces as they would be written.
    fn closers(&self, keep: usize) -> String {
        let closer = |level: &Level| match level.bracket {
            b'{' if self.bytes[level.at..self.end].contains(&b'\n') => {
                format!("\n{}}}", " ".repeat(level.indent))
            }
            b'{' => " }".to_string(),
            other => char::from(closer_of(other)).to_string(),
        };
        self.levels[keep..].iter().rev().map(closer).collect()
    }

    pub(super) fn stray_closer(&mut self) {
        let start = self.at;
        let closer = self.bytes[start];
        // Only parentheses are left unclosed behind which an item ends.
        let forgiven = self.base.forgiven > 0 && closer != b'}';
        if forgiven {
            self.base.forgiven -= 1;
            self.at += 1;
        } else {
            // A run of them is one slip.
            while self.byte(self.at) == closer {
                self.at += 1;
            }
        }
        let span = self.span(start, self.at);
        self.out.strays.push(Stray { span, closer: char::from(closer), forgiven });
        if self.item.is_some() {
            self.edits.push((start..self.at, b' '));
        }
    }
}

fn index(bracket: u8) -> usize {
    match bracket {
        b'(' => 0,
        b'[' => 1,
        _ => 2,
    }
}

fn closer_of(opener: u8) -> u8 {
    match opener {
        b'(' => b')',
        b'[' => b']',
        _ => b'}',
    }
}

fn opener_of(closer: u8) -> u8 {
    match closer {
        b')' => b'(',
        b']' => b'[',
        _ => b'{',
    }
}
