//! Where the cursor stands in a text that is being typed: by its words and marks alone, since the rest may make no sense.

mod mended;

use super::lex::{Lexeme, lex, split};
use crate::schema::{FieldType, KINDS};
use crate::syntax::NAMING_WORDS;
use std::ops::Range;

/// Where the cursor stands.
pub(super) struct Cursor<'t> {
    text: &'t str,
    /// The word at the cursor, which is being typed; empty where none is.
    pub(super) word: Range<usize>,
    /// What may stand there.
    pub(super) spot: Spot,
    /// Where the brackets are that are open there, outermost first.
    pub(super) open: Vec<usize>,
    /// The words and marks of the entry before the word.
    pub(super) entry: Vec<Range<usize>>,
    /// What stands before the entry, such as `@off`.
    prefixes: Vec<Range<usize>>,
    /// The word or mark before the innermost bracket.
    pub(super) opened_by: Option<Range<usize>>,
}

/// What may stand where the cursor is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Spot {
    /// Nothing that is known: a new name, a comment.
    Nothing,
    /// A field or a statement.
    Entry,
    /// A value: of this field, where it is that of one.
    Value(Option<String>),
    /// A unit behind a number or a parenthesis.
    Unit(Option<String>),
    /// A name inside of what ends before this point.
    Member(usize),
    /// A type.
    Type,
    /// A word behind `@`.
    Prefix,
    /// The code of a warning in `@allow(…)`.
    Warning,
    /// The path of a file, which begins behind its quote; whether it is one of the language.
    Path(bool),
    /// One of these words or marks of the language.
    Keyword(Vec<&'static str>),
    /// What goes on behind a value: one of these words, or an operator. Of which field the value is, if of one.
    Behind(Vec<&'static str>, Option<String>),
    /// The text that says why something must hold.
    Reason,
    /// What is done where a condition does not hold.
    Branch,
}

/// A piece of the text with its place.
type Piece = (Lexeme, Range<usize>);

impl<'t> Cursor<'t> {
    /// Finds out where a byte of a text lies.
    pub(super) fn new(text: &'t str, at: usize) -> Cursor<'t> {
        let at = text.floor_char_boundary(at);
        let mut before: Vec<Piece> = vec![];
        let mut here = None;
        for (lexeme, range) in lex(text, 0) {
            if range.start > at || range.start == at && !matches!(lexeme, Lexeme::Word | Lexeme::Prefix) {
                break;
            }
            if range.end >= at && !matches!(lexeme, Lexeme::Mark | Lexeme::Line) {
                here = Some((lexeme, range));
                break;
            }
            before.push((lexeme, range));
        }
        before.retain(|(lexeme, _)| *lexeme != Lexeme::Comment);
        let none = Cursor {
            text,
            word: at..at,
            spot: Spot::Nothing,
            open: vec![],
            entry: vec![],
            prefixes: vec![],
            opened_by: None,
        };
        let word = match here {
            None => at..at,
            Some((Lexeme::Word | Lexeme::Prefix, range)) => range,
            Some((Lexeme::Number, range)) => {
                let middle = range.start + split(&text[range.clone()]).0.len();
                if at < middle {
                    return none;
                }
                before.push((Lexeme::Number, range.start..middle));
                middle..range.end
            }
            Some((Lexeme::Text, range)) => {
                let closed = range.len() > 1 && text[range.clone()].ends_with('"');
                if closed && at == range.end {
                    return none;
                }
                let end = if closed { range.end - 1 } else { at };
                return none.within(&before, range.start + 1..end);
            }
            Some(_) => return none,
        };
        let mut cursor = Cursor { word, ..none };
        cursor.place(&before);
        cursor.spot = cursor.find(&before);
        cursor
    }

    /// A cursor in a text: it may be a path.
    fn within(self, before: &[Piece], inside: Range<usize>) -> Cursor<'t> {
        let word = |back: usize| {
            let index = before.len().checked_sub(back)?;
            Some(&self.text[before.get(index)?.1.clone()])
        };
        let takes_text = |name: &str| {
            KINDS
                .iter()
                .flat_map(|kind| kind.fields)
                .any(|field| field.name == name && field.ty == FieldType::Text)
        };
        let spot = match (word(2), word(1)) {
            (_, Some("import")) => Spot::Path(true),
            (Some(field), Some(":")) if takes_text(field) || field == "file" => Spot::Path(false),
            (Some("image" | "table"), Some("(")) => Spot::Path(false),
            _ => Spot::Nothing,
        };
        Cursor { word: inside, spot, ..self }
    }

    /// Finds the open brackets, and the entry.
    fn place(&mut self, before: &[Piece]) {
        let mut open: Vec<usize> = vec![];
        let mut begins = 0;
        for (index, (lexeme, range)) in before.iter().enumerate() {
            let at_margin = range.start == 0 || self.text.as_bytes()[range.start - 1] == b'\n';
            if at_margin && matches!(lexeme, Lexeme::Word | Lexeme::Prefix) {
                // What begins at the margin is no value.
                let body = open.iter().rposition(|at| self.is(&before[*at], "{"));
                let kept = body.map_or(0, |body| body + 1);
                if kept < open.len() {
                    open.truncate(kept);
                    begins = index;
                }
            }
            if *lexeme != Lexeme::Mark {
                continue;
            }
            match self.text.as_bytes()[range.start] {
                b'(' | b'[' | b'{' => open.push(index),
                closer @ (b')' | b']' | b'}') => {
                    let matching = open.iter().rposition(|at| {
                        matches!(
                            (self.text.as_bytes()[before[*at].1.start], closer),
                            (b'(', b')') | (b'[', b']') | (b'{', b'}')
                        )
                    });
                    open.truncate(matching.unwrap_or(open.len()));
                }
                _ => {}
            }
        }
        self.open = open.iter().map(|index| before[*index].1.start).collect();
        self.opened_by = open.last().and_then(|index| Some(before.get(index.checked_sub(1)?)?.1.clone()));
        // An entry lies in a body: brackets of values are part of it.
        let body = open.iter().rposition(|index| self.is(&before[*index], "{"));
        let first = body.map_or(0, |body| open[body] + 1).max(begins);
        let entry: Vec<Range<usize>> =
            self.entry_of(&before[first..]).iter().map(|(_, range)| range.clone()).collect();
        self.entry = self.without_prefixes(&entry).to_vec();
        self.prefixes = entry[..entry.len() - self.entry.len()].to_vec();
    }

    /// The last entry of those of a body.
    fn entry_of<'p>(&self, pieces: &'p [Piece]) -> Vec<&'p Piece> {
        let mut entry: Vec<&Piece> = vec![];
        let mut depth = 0usize;
        for (index, piece) in pieces.iter().enumerate() {
            match (piece.0, self.text.as_bytes()[piece.1.start]) {
                (Lexeme::Mark, b'(' | b'[' | b'{') => depth += 1,
                (Lexeme::Mark, b')' | b']' | b'}') => depth = depth.saturating_sub(1),
                _ => {}
            }
            let unfinished = || !self.begins_entry(&pieces[index + 1..]);
            let goes_on = entry.last().is_some_and(|last| self.goes_on(last)) && unfinished();
            // Behind a comma an assertion says why.
            let parts = self.is(piece, ",") && !entry.first().is_some_and(|first| self.is(first, "assert"));
            if depth == 0 && (parts || self.is(piece, ";") || piece.0 == Lexeme::Line && !goes_on) {
                entry.clear();
            } else if piece.0 != Lexeme::Line {
                entry.push(piece);
            }
        }
        entry
    }

    /// Whether a line begins a field or a statement: what stands before it is unfinished.
    fn begins_entry(&self, line: &[Piece]) -> bool {
        let word = |piece: &Piece| {
            let word = &self.text[piece.1.clone()];
            NAMING_WORDS.contains(&word) || matches!(word, "import" | "assert")
        };
        match line {
            [(Lexeme::Word, _), colon, ..] if self.is(colon, ":") => true,
            [first @ (Lexeme::Word, _), (Lexeme::Word | Lexeme::Text, _), ..] => word(first),
            _ => false,
        }
    }

    /// Whether the line goes on behind a piece.
    fn goes_on(&self, piece: &Piece) -> bool {
        match piece.0 {
            Lexeme::Mark => !matches!(self.text.as_bytes()[piece.1.start], b')' | b']' | b'}'),
            Lexeme::Word => {
                matches!(&self.text[piece.1.clone()], "and" | "or" | "not" | "to" | "then" | "else" | "in")
            }
            Lexeme::Prefix => true,
            _ => false,
        }
    }

    fn is(&self, piece: &Piece, mark: &str) -> bool {
        &self.text[piece.1.clone()] == mark
    }

    /// A piece of the entry, counted from its beginning.
    pub(super) fn piece(&self, index: usize) -> &'t str {
        self.entry.get(index).map_or("", |range| &self.text[range.clone()])
    }

    /// Whether this stands before the entry.
    pub(super) fn has_prefix(&self, prefix: &str) -> bool {
        self.prefixes.iter().any(|range| self.text[range.clone()] == *prefix)
    }

    /// Where the name stands that the entry declares, if it does.
    pub(super) fn declares(&self) -> Option<usize> {
        let declares = ["let", "material", "param", "fn", "for"].contains(&self.piece(0));
        self.entry.get(1).filter(|_| declares).map(|name| name.start)
    }

    /// What may stand at the word.
    fn find(&self, before: &[Piece]) -> Spot {
        if self.text[self.word.clone()].starts_with('@') {
            return Spot::Prefix;
        }
        let last = before.iter().rfind(|(lexeme, _)| *lexeme != Lexeme::Line);
        let last_text = last.map_or("", |(_, range)| &self.text[range.clone()]);
        let touches = last.is_some_and(|(_, range)| range.end == self.word.start);
        let field = (self.piece(1) == ":").then(|| self.piece(0).to_string());
        let is_number = last.is_some_and(|(lexeme, _)| *lexeme == Lexeme::Number);
        if touches && (is_number || last_text == ")") {
            return Spot::Unit(field);
        }
        if last_text == "." {
            return Spot::Member(last.map_or(0, |(_, range)| range.start));
        }
        let in_parentheses =
            self.open.last().is_some_and(|open| matches!(self.text.as_bytes()[*open], b'(' | b'['));
        if in_parentheses {
            return self.find_inside(last_text, field);
        }
        let operand = last.is_some_and(|(lexeme, _)| {
            matches!(lexeme, Lexeme::Word | Lexeme::Number | Lexeme::Color | Lexeme::Text)
        }) || matches!(last_text, ")" | "]" | "}");
        let begun: Vec<&str> = (0..self.entry.len()).map(|index| self.piece(index)).collect();
        let is_word = |word: &str| {
            matches!(word, "and" | "or" | "not" | "to" | "then" | "else" | "in" | "if" | "assert")
        };
        let after_operand = operand && !is_word(last_text);
        match begun.as_slice() {
            [] => Spot::Entry,
            ["param", _, ":"] => Spot::Type,
            ["param", _, ":", ty @ ..] if ty.contains(&"=") && after_operand => {
                let of_range = ["in", "to"].into_iter().find(|word| !ty.contains(word));
                Spot::Behind(of_range.into_iter().chain(self.lacking()).collect(), None)
            }
            ["param", _, ":", ty @ ..] if ty.contains(&"=") => Spot::Value(None),
            ["param", _, ":", "["] => Spot::Type,
            ["param", _, ":", ..] if operand => Spot::Keyword(vec!["="]),
            ["fn", .., "->"] => Spot::Type,
            ["fn", _, "(", head @ ..] if operand && !head.contains(&"=") => {
                Spot::Keyword(vec![if head.contains(&"->") { "=" } else { "->" }])
            }
            ["import"] => Spot::Nothing,
            ["import", _] => Spot::Keyword(vec!["as"]),
            ["for", _] => Spot::Keyword(vec!["in"]),
            ["for", _, "in", .., "}"] => Spot::Nothing,
            ["if", .., "}", "else"] => Spot::Branch,
            ["if", .., "}"] if self.is_alternative() => Spot::Nothing,
            ["if", .., "}"] => Spot::Keyword(vec!["else"]),
            ["assert", .., ","] => Spot::Reason,
            ["assert", .., ",", text] if text.starts_with('"') => Spot::Nothing,
            ["for", _, "in", ..] | ["if" | "assert", ..] if after_operand => {
                Spot::Behind(self.lacking(), None)
            }
            ["for", _, "in", ..] | ["if" | "assert", ..] => Spot::Value(None),
            ["let" | "material" | "fn", _, ..] if begun.contains(&"=") && !after_operand => {
                Spot::Value(self.wanted(&begun))
            }
            [_, ":", ..] if !after_operand => Spot::Value(field),
            [_, ":", ..] | ["let" | "material" | "fn", ..] if begun.len() > 2 && after_operand => {
                Spot::Behind(self.lacking(), field)
            }
            _ => Spot::Nothing,
        }
    }

    /// Where the cursor stands right between the parentheses that the value begins with: whether a unit stands
    /// behind them, which is that of all that they hold.
    pub(super) fn in_tuple(&self) -> Option<bool> {
        let open = *self.open.last()?;
        let pieces = || (0..self.entry.len()).map(|index| self.piece(index));
        let begins = match self.piece(1) {
            ":" => 1,
            _ => pieces().position(|piece| piece == "=")?,
        };
        if self.entry.get(begins + 1)?.start != open || self.piece(begins + 1) != "(" {
            return None;
        }
        let mut depth = 0usize;
        let mut pieces = lex(self.text, open);
        let closer = pieces.find(|(lexeme, range)| {
            match (lexeme, self.text.as_bytes()[range.start]) {
                (Lexeme::Mark, b'(' | b'[' | b'{') => depth += 1,
                (Lexeme::Mark, b')' | b']' | b'}') => depth = depth.saturating_sub(1),
                _ => {}
            }
            depth == 0
        });
        let end = closer.map_or(self.text.len(), |(_, range)| range.end);
        Some(pieces.next().is_some_and(|(lexeme, range)| lexeme == Lexeme::Word && range.start == end))
    }

    /// Whether a list of the entry is open at the word.
    pub(super) fn in_list(&self) -> bool {
        let begins = self.entry.first().map_or(0, |first| first.start);
        self.open.iter().any(|open| *open >= begins && self.text.as_bytes()[*open] == b'[')
    }

    /// Whether the word stands in the head of a function.
    pub(super) fn declares_function(&self) -> bool {
        self.piece(0) == "fn" && !(2..self.entry.len()).any(|index| self.piece(index) == "=")
    }

    /// Whether a statement begins with the word and the names before it, of which each lies inside of the last.
    pub(super) fn begins_statement(&self) -> bool {
        let piece = |range: &Range<usize>| &self.text[range.clone()];
        self.entry
            .chunks(2)
            .all(|pair| matches!(pair, [name, dot] if is_name(piece(name)) && piece(dot) == "."))
    }

    /// A value that a definition wants, by the field that wants the same.
    fn wanted(&self, begun: &[&str]) -> Option<String> {
        (begun.first() == Some(&"material")).then(|| "material".to_string())
    }

    /// Without what stands before a statement.
    fn without_prefixes<'p>(&self, entry: &'p [Range<usize>]) -> &'p [Range<usize>] {
        let mut rest = entry;
        while let [first, behind @ ..] = rest
            && self.text[first.clone()].starts_with('@')
        {
            let is = |range: &Range<usize>, mark: &str| &self.text[range.clone()] == mark;
            let closer = behind.iter().position(|range| is(range, ")")).map_or(0, |closer| closer + 1);
            rest =
                if behind.first().is_some_and(|range| is(range, "(")) { &behind[closer..] } else { behind };
        }
        rest
    }

    /// What may stand between parentheses or in a list.
    fn find_inside(&self, last: &str, field: Option<String>) -> Spot {
        let opened_by = self.opened_by.clone().map_or("", |range| &self.text[range]);
        if opened_by == "@allow" {
            return if last == "(" { Spot::Warning } else { Spot::Nothing };
        }
        if self.declares_function() {
            return if last == ":" || last == "[" { Spot::Type } else { Spot::Nothing };
        }
        let begins = matches!(
            last,
            "(" | "[" | "," | ":" | "+" | "-" | "*" | "/" | "<" | ">" | "==" | "!=" | "<=" | ">=" | "|>"
        ) || matches!(last, "and" | "or" | "not" | "to" | "then" | "else" | "if" | "in");
        match begins {
            // Inside a call another type is wanted than outside.
            true if is_name(opened_by) => Spot::Value(None),
            true => Spot::Value(field),
            false if is_name(opened_by) => Spot::Behind(self.lacking(), None),
            false => Spot::Behind(self.lacking(), field),
        }
    }

    /// The words of a choice that the innermost brackets lack.
    fn lacking(&self) -> Vec<&'static str> {
        let inner = self.open.last().filter(|open| self.text.as_bytes()[**open] != b'{');
        let inner = inner.map_or(0, |open| open + 1);
        let begun = || self.entry.iter().filter(|piece| piece.start >= inner);
        let count = |word: &str| begun().filter(|piece| self.text[(*piece).clone()] == *word).count();
        // That of a statement has braces.
        let chooses = self.piece(0) == "if" && inner == 0;
        let (ifs, thens) = (count("if") - usize::from(chooses), count("then"));
        let lacks = [("then", thens < ifs), ("else", count("else") < thens)];
        lacks.into_iter().filter(|(_, lacks)| *lacks).map(|(word, _)| word).collect()
    }

    /// The word or mark before the word at the cursor.
    pub(super) fn last(&self) -> &'t str {
        self.piece(self.entry.len().wrapping_sub(1))
    }

    /// Whether the word stands right behind `3W/`, where it may be the rest of a unit.
    pub(super) fn divides_power(&self) -> bool {
        let mut back = self.entry.iter().rev();
        let (Some(slash), Some(number)) = (back.next(), back.next()) else { return false };
        let number = (&self.text[number.clone()], number.end);
        let touches = &self.text[slash.clone()] == "/" && slash.end == self.word.start;
        touches && number.1 == slash.start && split(number.0).1 == "W"
    }

    /// Whether the word is the index of what stands before the innermost bracket.
    pub(super) fn is_index(&self) -> bool {
        let Some((open, by)) = self.open.last().zip(self.opened_by.clone()) else { return false };
        let by = (by.end, &self.text[by]);
        self.text.as_bytes()[*open] == b'[' && by.0 == *open && (is_name(by.1) || matches!(by.1, ")" | "]"))
    }

    /// Whether the braces that end the entry are those of `else`.
    fn is_alternative(&self) -> bool {
        let mut depth = 0usize;
        let begins = (0..self.entry.len()).rev().find(|index| {
            match self.piece(*index) {
                "}" => depth += 1,
                "{" => depth -= 1,
                _ => {}
            }
            depth == 0
        });
        begins.and_then(|index| index.checked_sub(1)).is_some_and(|before| self.piece(before) == "else")
    }
}

/// Whether this is the name of something that can be called.
fn is_name(word: &str) -> bool {
    word.starts_with(|c: char| c.is_alphabetic() || c == '_')
        && !matches!(word, "and" | "or" | "not" | "to" | "then" | "else" | "if" | "in")
}

#[cfg(test)]
mod tests;
