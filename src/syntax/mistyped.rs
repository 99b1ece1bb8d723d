//! Words of the language with a slip of typing: `le a = 3m`, `fo i in list { … }`. A word is only taken for one where what
//! stands behind it has the form of its statement, which nothing else has.

use super::ast::{Broken, Entry, Name, StatementKind, TypeName};
use super::build::{Builder, Node, is_reserved};
use super::{BLANKS, TYPE_WORDS, errors, is_name, leading};
use crate::span::Span;

/// The longest word that is compared: comparing takes time with the square of the length.
const MAX_COMPARED: usize = 16;

/// From so many letters on a word may have two slips of typing.
const LONG: usize = 6;

/// The words that statements begin with, those that are told apart by the least first.
const FIRST: &[&str] = &["let", "material", "param", "import", "fn", "for", "if", "assert", "else"];

/// Whether a word is another one with a slip of typing, or in other letters.
pub(crate) fn is_near(word: &str, keyword: &str) -> bool {
    let slips = if keyword.len() >= LONG { 2 } else { 1 };
    let long = (2..=MAX_COMPARED).contains(&word.len());
    long && word != keyword && strsim::osa_distance(&word.to_ascii_lowercase(), keyword) <= slips
}

impl Builder<'_> {
    /// An entry that begins with a mistyped word of the language, of which `end` is where that ends.
    pub(super) fn mistyped(&self, word: &Name, end: usize, span: Span) -> Option<Entry> {
        if is_reserved(&word.text) || errors::habit(&word.text, word.span).is_some() {
            return None;
        }
        let line = self.after(end).split('\n').next().unwrap_or("");
        let keyword = FIRST.iter().find(|keyword| is_near(&word.text, keyword) && has_form(keyword, line))?;
        self.report(errors::mistyped(keyword, word));
        let behind = line.trim_start_matches(BLANKS);
        let name = Some(leading(behind, "")).filter(|name| is_name(name));
        let declares = matches!(*keyword, "let" | "material" | "param" | "fn");
        let name = match *keyword {
            "import" => {
                behind.rsplit_once(" as ").map(|(_, name)| leading(name.trim_start_matches(BLANKS), ""))
            }
            _ => name.filter(|_| declares),
        };
        let name = name.filter(|name| is_name(name)).map(|name| {
            let start = name.as_ptr().addr() - self.after(0).as_ptr().addr();
            Name { text: name.into(), span: self.at(start, start + name.len()) }
        });
        Some(Entry::Broken(Broken { name, span }))
    }

    /// Whether what begins at a place is a condition, as the word before it tells.
    pub(super) fn asks(&self, place: Span) -> bool {
        let before = self.before(place.range().start - self.base());
        let before = before.trim_end_matches('(').trim_ascii_end();
        let word = before.rsplit(|c: char| !(c.is_alphanumeric() || c == '_')).next();
        matches!(word, Some("if" | "and" | "or" | "not" | "assert"))
    }

    /// `if c { … } else sphere { … }`, `fn f() length = 1m`: whether what is crowded belongs to the statement before it, of
    /// which it was said what is missing.
    pub(super) fn goes_on(&self, pair: &Node, before: Option<&Entry>) -> bool {
        let statement = match before {
            Some(Entry::Statement(statement)) => statement,
            // `sphere my ball { … }`: it reaches into what is crowded.
            Some(Entry::Broken(broken)) => return broken.span.end > self.span(pair).start,
            _ => return false,
        };
        match &statement.kind {
            StatementKind::If { otherwise: Some(body), .. } => body.span.range().is_empty(),
            StatementKind::Function { result: TypeName::Invalid(_), .. } => {
                let behind = self.after(pair.as_span().start()).trim_start_matches(BLANKS);
                TYPE_WORDS.contains(&leading(behind, ""))
            }
            _ => false,
        }
    }

    /// `if c { … } esle { … }`: whether what follows the choice begins with a mistyped `else`.
    pub(super) fn mistyped_else(&self, pair: &Node, before: Option<&Entry>) -> bool {
        let Some(Entry::Statement(choice)) = before else { return false };
        if !matches!(choice.kind, StatementKind::If { otherwise: None, .. }) {
            return false;
        }
        let start = pair.as_span().start();
        let rest = self.after(start).trim_start_matches(BLANKS);
        let word = leading(rest, "");
        let behind = rest[word.len()..].trim_start_matches(BLANKS);
        let goes_on = behind.starts_with('{') || leading(behind, "") == "if";
        if !goes_on || !is_near(word, "else") {
            return false;
        }
        let start = self.text_len() - rest.len();
        let word = Name { text: word.into(), span: self.at(start, start + word.len()) };
        self.report(errors::mistyped("else", &word));
        true
    }
}

/// Whether what stands behind the first word of a line is that of a statement.
fn has_form(keyword: &str, line: &str) -> bool {
    let line = line.trim_start_matches(BLANKS);
    let name = leading(line, "");
    let behind = line[name.len()..].trim_start_matches(BLANKS);
    match keyword {
        "let" | "material" => {
            let value = behind.strip_prefix('=').map(|value| value.trim_start_matches(BLANKS));
            is_name(name) && value.is_some_and(|value| !value.starts_with(['=', '{']))
        }
        "param" => is_name(name) && behind.starts_with(':') && behind.contains('='),
        "import" => line.starts_with('"') && !line.contains('{'),
        "fn" => is_name(name) && behind.starts_with('(') && behind.contains("->"),
        "for" => is_name(name) && leading(behind, "") == "in",
        "if" => {
            let head = line.split_once('{').map_or("", |(head, _)| head);
            !line.starts_with('<') && ["==", "!=", "<", ">"].iter().any(|sign| head.contains(sign))
        }
        // Its braces could be those of a thing.
        "else" => name == "if",
        _ => !(behind.is_empty() || behind.starts_with([':', '{', '=']) && !behind.starts_with("==")),
    }
}
