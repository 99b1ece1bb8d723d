//! Applying the edits that diagnostics offer.

use crate::diagnostic::{Diagnostic, Fix};
use crate::span::{SourceId, Span};
use std::collections::{BTreeMap, BTreeSet};

/// A text after some slips were mended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mended {
    /// What the text is now.
    pub text: String,
    /// The diagnostics whose edits were made, as indices into those given.
    pub applied: Vec<usize>,
}

/// Makes every edit that diagnostics offer for a source, but for those that touch an earlier one: these are for the
/// next round, when the text has been looked at anew. None where there is nothing to do.
pub fn mend(text: &str, source: SourceId, diagnostics: &[Diagnostic]) -> Option<Mended> {
    // By where they begin; no two touch.
    let mut edits: BTreeMap<u32, (Span, &str)> = BTreeMap::new();
    let mut applied = vec![];
    for (index, diagnostic) in diagnostics.iter().enumerate() {
        let Some(fix) = &diagnostic.fix else { continue };
        let free = |span: Span| {
            edits.range(..=span.end).next_back().is_none_or(|(_, (other, _))| !touch(*other, span))
        };
        if !fix.edits.is_empty() && fits(fix, text, source) && fix.edits.iter().all(|(span, _)| free(*span)) {
            edits.extend(fix.edits.iter().map(|(span, text)| (span.start, (*span, text.as_str()))));
            applied.push(index);
        }
    }
    let mut mended = String::with_capacity(text.len());
    let mut copied = 0;
    for (span, replacement) in edits.into_values() {
        mended.push_str(&text[copied..span.start as usize]);
        mended.push_str(replacement);
        copied = span.end as usize;
    }
    mended.push_str(&text[copied..]);
    (!applied.is_empty()).then_some(Mended { text: mended, applied })
}

/// The most rounds of mending. Most files need one or two.
const MOST_ROUNDS: usize = 100;

/// Mending again and again, each time what was found in the text that the last round left.
#[derive(Debug, Default)]
pub struct Rounds {
    /// The texts that there were: a mend that leads back would go on for ever.
    seen: BTreeSet<String>,
}

impl Rounds {
    /// Makes the edits of the next round, as [`mend`] does. None where nothing is left to be mended, or it leads nowhere.
    pub fn next(&mut self, text: &str, source: SourceId, diagnostics: &[Diagnostic]) -> Option<Mended> {
        self.seen.insert(text.to_string());
        let mended = mend(text, source, diagnostics)?;
        (self.seen.len() <= MOST_ROUNDS && !self.seen.contains(&mended.text)).then_some(mended)
    }
}

/// Whether all edits lie within a source, and not on each other.
fn fits(fix: &Fix, text: &str, source: SourceId) -> bool {
    let inside =
        |span: Span| span.source == source && span.start <= span.end && text.get(span.range()).is_some();
    let spans: Vec<Span> = fix.edits.iter().map(|(span, _)| *span).collect();
    let apart = |(at, span): (usize, &Span)| !spans[..at].iter().any(|other| touch(*other, *span));
    spans.iter().all(|span| inside(*span)) && spans.iter().enumerate().all(apart)
}

/// Whether two edits share a byte or a border: what is put at a border would have no order.
fn touch(a: Span, b: Span) -> bool {
    a.source == b.source && a.start <= b.end && b.start <= a.end
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnostic::Code;

    const SOURCE: SourceId = SourceId(0);

    fn at(start: usize, end: usize, replacement: &str) -> Diagnostic {
        let span = Span::new(SOURCE, start, end);
        Diagnostic::new(Code::E0003, "m", span).fix(span, replacement)
    }

    #[test]
    fn edits_are_made_in_the_order_of_the_text() {
        let all = [at(6, 7, ","), at(1, 2, ":"), at(3, 3, "!")];
        let mended = mend("a=bc d;", SOURCE, &all).unwrap();
        assert_eq!((mended.text.as_str(), mended.applied.as_slice()), ("a:b!c d,", &[0, 1, 2][..]));
    }

    #[test]
    fn edits_that_touch_wait() {
        let mended =
            mend("abcdef", SOURCE, &[at(1, 3, "X"), at(2, 4, "Y"), at(3, 3, "Z"), at(5, 6, "W")]).unwrap();
        assert_eq!((mended.text.as_str(), mended.applied.as_slice()), ("aXdeW", &[0, 3][..]));
    }

    #[test]
    fn rounds_end_where_they_lead_back() {
        let mut rounds = Rounds::default();
        let there = rounds.next("a", SOURCE, &[at(0, 1, "b")]).unwrap();
        assert_eq!(there.text, "b");
        assert_eq!(rounds.next("b", SOURCE, &[at(0, 1, "a")]), None);
        assert_eq!(rounds.next("b", SOURCE, &[]), None);
    }

    #[test]
    fn edits_elsewhere_are_left_alone() {
        let outside = at(4, 9, "X");
        let mut other = at(0, 1, "X");
        other.fix.as_mut().unwrap().edits[0].0.source = SourceId(1);
        let within = at(1, 2, "X");
        assert_eq!(mend("é", SOURCE, &[outside, other, within]), None);
        assert_eq!(mend("", SOURCE, &[]), None);
    }
}
