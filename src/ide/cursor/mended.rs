//! A text that is being typed, made one that can be read.

use super::{Cursor, Spot};
use crate::ide::lex::{Lexeme, lex};

impl Cursor<'_> {
    /// The text as it would be if something sound stood in place of the word, with the brackets around it closed. All before
    /// the word stays where it is.
    pub(in super::super) fn mended(&self) -> String {
        let (from, filler) = match self.spot {
            Spot::Value(_) => (self.word.start, "0"),
            Spot::Type => (self.word.start, "number"),
            Spot::Member(dot) => (dot, ""),
            _ => (self.word.start, ""),
        };
        let mut text = String::with_capacity(self.text.len() + self.open.len() + 2);
        text.push_str(&self.text[..from]);
        text.push_str(filler);
        match self.resumes() {
            None => text.push_str(&self.text[self.word.end..]),
            Some(resumes) => {
                for open in self.open.iter().rev() {
                    text.push(match self.text.as_bytes()[*open] {
                        b'(' => ')',
                        b'[' => ']',
                        _ => '}',
                    });
                }
                text.push('\n');
                text.push_str(&self.text[resumes..]);
            }
        }
        text
    }

    /// Where the text goes on that does not belong to what is open at the cursor; none where all of that is closed.
    fn resumes(&self) -> Option<usize> {
        let mut margin = None;
        let column = |at: usize| at - self.text[..at].rfind('\n').map_or(0, |line| line + 1);
        let mut open = self.open.clone();
        let mut line_begins = false;
        for (lexeme, range) in lex(self.text, self.word.end) {
            if open.is_empty() {
                return None;
            }
            // What begins at the margin is not inside of anything, if what is around it is not closed either.
            if line_begins && lexeme == Lexeme::Word && column(range.start) == 0 {
                margin = margin.or(Some(range.start));
            }
            line_begins = lexeme == Lexeme::Line;
            match (lexeme, self.text.as_bytes()[range.start]) {
                (Lexeme::Mark, b'(' | b'[' | b'{') => open.push(range.start),
                (Lexeme::Mark, b')' | b']' | b'}') => drop(open.pop()),
                _ => {}
            }
        }
        (!open.is_empty()).then_some(margin.unwrap_or(self.text.len()))
    }
}
