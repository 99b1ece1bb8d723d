//! Things without a body, as far as they were typed: `sphere ball`, `file.post`.

use super::ast::{Broken, Entry, Name};
use super::build::{Builder, Node, is_reserved};
use super::errors::{self, statements};
use super::{BLANKS, PLACED_WORDS, is_name, leading};
use crate::span::Span;

impl Builder<'_> {
    /// `sphere ball`: two words in a body that holds things, which are one without its own. A group has fields too, and
    /// what only stands in its body is written in both ways; in other things the words are a field.
    pub(super) fn thing_or_field(&self, word: &Name, value: &Node, span: Span, top: bool) -> Option<Entry> {
        let second = value.as_str().trim_ascii_end();
        let is_field = is_reserved(&word.text) || PLACED_WORDS.contains(&word.text.as_str());
        let part = self.holds_part.get().filter(|[_, part]| word.text == *part);
        if top || !is_name(second) || is_field || !(self.holds_things() || part.is_some()) {
            return None;
        }
        let name = Name { text: second.into(), span: self.trimmed(value) };
        self.report(match self.declares.get() {
            true => errors::missing_body(&format!("{} {second}", word.text), name.span),
            false => statements::thing_or_field(word, &name, part),
        });
        Some(Entry::Broken(Broken { name: Some(name), span }))
    }

    /// `file.post`, `file.post left`, `file.`: a thing of a part of a file, as far as it was written. Gives its name.
    pub(super) fn bodiless_path(&self, first: &Name, end: usize, top: bool) -> Option<Option<Name>> {
        if !(top || self.holds_things()) {
            return None;
        }
        let rest = self.after(end);
        let path = leading(rest, ".");
        let whole = path.strip_suffix('.').unwrap_or(path);
        if !whole.split('.').skip(1).all(is_name) {
            return None;
        }
        if whole.len() < path.len() {
            let place = self.at(end + path.len(), end + path.len());
            let help = format!("write `{}{path}name {{ … }}`", first.text);
            self.report(errors::missing_member(place).help(help));
            return Some(None);
        }
        let behind = rest[path.len()..].trim_start_matches(BLANKS);
        let start = end + rest.len() - behind.len();
        if let Some((diagnostic, name)) = self.no_name(path.rsplit('.').next().unwrap_or(path), start) {
            self.report(diagnostic);
            return Some(name);
        }
        let second = Some(leading(behind, "")).filter(|second| is_name(second)).unwrap_or("");
        let whole = first.span.to(self.at(end, end + path.len()));
        let path = format!("{}{path}", first.text);
        let name = Name { text: second.into(), span: self.at(start, start + second.len()) };
        let more = behind[second.len()..].trim_start_matches(BLANKS);
        // `ball.radius = 2m`, `post.height: 1m`
        if second.is_empty() && more.starts_with(['=', '+', '-', '*', '/', ':']) {
            return None;
        }
        // `file.post height: 1m }`
        if more.starts_with(':') {
            self.report(errors::no_brace(&path, whole, name.span));
            return Some(None);
        }
        self.report(match second {
            // `file.f(3)`, `file.post left > 2`
            _ if !more.is_empty() && !more.starts_with(['\n', '}', ',', ';']) => {
                let start = end + rest.len() - more.len();
                let token = errors::first_token(more);
                errors::unexpected_extra(token, self.at(start, start + token.len()))
            }
            "" => errors::missing_body(&path, whole),
            _ => errors::missing_body(&format!("{path} {second}"), name.span),
        });
        Some(Some(name).filter(|_| !second.is_empty()))
    }
}
