//! What stands as the name of a thing and cannot be one.

use super::ast::{Broken, Entry, Name};
use super::build::{Builder, Node};
use super::errors;
use super::{BLANKS, NAMING_WORDS, PLACED_WORDS, is_name, leading};
use crate::diagnostic::Diagnostic;
use crate::span::Span;

impl Builder<'_> {
    /// `sphere "ball" { … }`, `sphere 2nd { … }`, `sphere my-ball { … }`: what stands as the name of a thing and cannot
    /// be one, and the name that is in it.
    pub(super) fn no_name(&self, kind: &str, start: usize) -> Option<(Diagnostic, Option<Name>)> {
        let text = self.after(start);
        if let Some(quoted) = text.strip_prefix('"') {
            let mut escaped = false;
            let end = quoted.find(|c| {
                let ends = c == '\n' || c == '"' && !escaped;
                escaped = c == '\\' && !escaped;
                ends
            })?;
            let (inside, behind) = quoted.split_at(end);
            let thing = behind.strip_prefix('"')?.trim_start_matches(BLANKS).starts_with('{');
            let name = Name { text: inside.into(), span: self.at(start + 1, start + 1 + end) };
            let name = Some(name).filter(|_| is_name(inside));
            let whole = self.at(start, start + end + 2);
            return thing.then(|| (errors::quoted_name(inside, whole), name));
        }
        let is_sign = |c: char| !c.is_ascii() && !c.is_alphanumeric() && !c.is_whitespace();
        let is_part = |c: char| c.is_alphanumeric() || matches!(c, '_' | '-') || is_sign(c);
        let end = text.find(|c| !is_part(c)).unwrap_or(text.len());
        let name = &text[..end];
        let thing = text[end..].trim_start_matches(BLANKS).starts_with('{');
        if thing && name.contains(is_sign) {
            return Some((errors::signs_in_name(name, self.at(start, start + end)), None));
        }
        let apart = name.starts_with(|c: char| c.is_ascii_digit()) || name.contains('-');
        let sound = apart && !name.starts_with('-') && !name.ends_with('-');
        (thing && sound).then(|| (errors::no_name(kind, name, self.at(start, start + end)), None))
    }

    /// `part 2legs { … }`, `let 2r = 1m`: whether what stands behind the word of a statement is a name with a digit first.
    pub(super) fn digit_first(&self, keyword: &str, end: usize) -> bool {
        let text = self.after(end).trim_start_matches(BLANKS);
        let name = leading(text, "");
        let start = self.text_len() - text.len();
        let found = NAMING_WORDS.contains(&keyword) && name.starts_with(|c: char| c.is_ascii_digit());
        if found {
            let word = if keyword == "let" { "value" } else { keyword };
            self.report(errors::no_name(word, name, self.at(start, start + name.len())));
        }
        found
    }

    /// `export let r = 1m`: a word of another language before a statement.
    pub(super) fn before_statement(&self, word: &Name, value: &Node, span: Span) -> Option<Entry> {
        let start = value.as_span().start();
        let text = self.after(start);
        let keyword = leading(text, "");
        let behind = text[keyword.len()..].trim_start_matches(BLANKS);
        let name =
            Some(leading(behind, "")).filter(|name| NAMING_WORDS.contains(&keyword) && is_name(name))?;
        let known =
            matches!(word.text.as_str(), "export" | "pub" | "public" | "private" | "static" | "local");
        let place = self.at(start, start + keyword.len());
        known.then(|| self.report(errors::word_before_statement(word, keyword, place)))?;
        let start = self.text_len() - behind.len();
        let name = Name { text: name.into(), span: self.at(start, start + name.len()) };
        Some(Entry::Broken(Broken { name: Some(name), span }))
    }

    /// `"radius": 1m`: the name of a field, as JSON has it.
    pub(super) fn quoted_field(&self, pair: &Node) -> Option<Name> {
        let (name, behind) = pair.as_str().strip_prefix('"')?.split_once('"')?;
        if !is_name(name) || !behind.trim_start_matches(BLANKS).starts_with(':') {
            return None;
        }
        let start = pair.as_span().start();
        self.report(errors::quoted_field(name, self.at(start, start + name.len() + 2)));
        Some(Name { text: name.into(), span: self.at(start + 1, start + 1 + name.len()) })
    }

    /// `sphere my ball { … }`: a name of several words, in a body that holds things.
    pub(super) fn name_of_words(&self, kind: &Name, start: usize, top: bool) -> Option<Entry> {
        let holds_things = top || self.holds_things();
        let text = self.after(start);
        let (name, _) = text.split_once('{').filter(|_| holds_things)?;
        let name = name.trim_end_matches(BLANKS);
        let words: Vec<&str> = name.split(BLANKS).filter(|word| !word.is_empty()).collect();
        let named = words.len() > 1 && words.iter().all(|word| is_name(word));
        if !named || !is_name(&kind.text) || PLACED_WORDS.contains(&kind.text.as_str()) {
            return None;
        }
        let place = self.at(start, start + name.len());
        // `new sphere ball { … }`
        let before = errors::word_before_thing(kind, name, place).filter(|_| words.len() == 2);
        self.report(before.unwrap_or_else(|| errors::name_of_words(name, &words.join("_"), place)));
        // It reaches to the body, which is that of no other thing.
        Some(Entry::Broken(Broken { name: None, span: kind.span.to(place) }))
    }
}
