//! Items that were read before: when a text is read again after an edit, the others are as they were.

use super::ast::Entry;
use super::build::Source;
use super::cut::Item;
use super::places::{self, Visit};
use crate::span::{SourceId, Span};
use smol_str::SmolStr;
use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The most that all items cost together. Their trees take many times as much.
const MAX_COST: usize = 2 << 20;

/// What an item costs besides its text, in bytes.
const COST: usize = 32;

/// Trees of items without a slip, by their text. They are kept by whoever reads the same texts again and again.
#[derive(Debug, Default)]
pub struct Remembered(Mutex<Items>);

#[derive(Debug, Default)]
struct Items {
    known: BTreeMap<Key, Kept>,
    /// What they cost together.
    cost: usize,
    /// How many texts were read.
    round: u64,
    /// When room was last made.
    swept: u64,
}

/// All that the tree of an item depends on, but for its place and the words above it.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Key {
    /// As the grammar reads it.
    text: Box<str>,
    /// As it is written, with its comments, where that is something else.
    written: Option<Box<str>>,
    /// The deepest tree of an expression.
    depth: usize,
}

#[derive(Debug)]
struct Kept {
    entries: Vec<Entry>,
    source: SourceId,
    /// Where the item began.
    start: u32,
    /// When it was last read.
    round: u64,
}

impl Remembered {
    /// Begins to read a text.
    pub(super) fn begin(&self) {
        self.items().round += 1;
    }

    /// The entries of an item that was read before, but for the words above it.
    pub(super) fn recall(&self, source: &Source, item: &Item) -> Option<Vec<Entry>> {
        let key = Key::of(source, item)?;
        let mut items = self.items();
        let round = items.round;
        let kept = items.known.get_mut(&key)?;
        kept.round = round;
        let mut entries = kept.entries.clone();
        let by = (item.start as u32).wrapping_sub(kept.start);
        let stays = by == 0 && kept.source == source.id;
        drop(items);
        if !stays {
            let mut moved = Moved { to: source.id, by };
            entries.iter_mut().for_each(|entry| places::entry(entry, &mut moved));
        }
        Some(entries)
    }

    /// Keeps the entries of an item that has no slip, if there is room.
    pub(super) fn learn(&self, source: &Source, item: &Item, entries: &[Entry]) {
        let Some(key) = Key::of(source, item) else { return };
        let (mut items, cost) = (self.items(), key.cost());
        if items.cost + cost > MAX_COST {
            items.sweep();
        }
        let (start, round) = (item.start as u32, items.round);
        if items.cost + cost <= MAX_COST {
            let kept = Kept { entries: entries.to_vec(), source: source.id, start, round };
            if items.known.insert(key, kept).is_none() {
                items.cost += cost;
            }
        }
    }

    fn items(&self) -> MutexGuard<'_, Items> {
        // What is kept is whole at any time.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Items {
    /// Forgets what neither this text nor the one before has; once a text, as it takes time.
    fn sweep(&mut self) {
        if self.swept < self.round {
            self.swept = self.round;
            self.known.retain(|_, kept| kept.round + 1 >= self.round);
            self.cost = self.known.keys().map(Key::cost).sum();
        }
    }
}

impl Key {
    /// None for an item that is out of the ordinary.
    fn of(source: &Source, item: &Item) -> Option<Key> {
        if item.skipped || item.continued {
            return None;
        }
        let written = source.text.get(item.start..item.start + item.text.len())?;
        let written = (written != item.text).then(|| written.into());
        Some(Key { text: item.text.as_ref().into(), written, depth: source.depth })
    }

    fn cost(&self) -> usize {
        COST + self.text.len() + self.written.as_ref().map_or(0, |written| written.len())
    }
}

/// Moves every place.
struct Moved {
    to: SourceId,
    by: u32,
}

impl Visit for Moved {
    fn span(&mut self, span: &mut Span) {
        span.source = self.to;
        span.start = span.start.wrapping_add(self.by);
        span.end = span.end.wrapping_add(self.by);
    }

    fn number(&mut self, _: &mut f64, _: Span) {}

    fn color(&mut self, _: &mut SmolStr, _: Span) {}
}

#[cfg(test)]
mod tests {
    use super::super::{Limits, parse_again, parse_rows};
    use super::*;
    use proptest::prelude::*;

    /// A text gives what it gives by itself, whatever was read before: trees, places and complaints.
    fn check(known: &Remembered, source: SourceId, text: &str, limits: Limits) {
        let (alone, slips) = parse_rows(source, text, limits);
        let (again, said) = parse_again(source, text, limits, Some(known));
        assert_eq!(format!("{again:?}"), format!("{alone:?}"), "{text}");
        assert_eq!(said, slips, "{text}");
        let items = known.items();
        assert!(items.cost <= MAX_COST);
        assert_eq!(items.cost, items.known.keys().map(Key::cost).sum::<usize>());
        // What is shown of a place does not tell its source.
        let (mut entries, mut elsewhere) = (again.body.entries, Elsewhere(source, false));
        entries.iter_mut().for_each(|entry| places::entry(entry, &mut elsewhere));
        assert!(!elsewhere.1, "{text}");
    }

    /// Whether a place lies in another source than it should.
    struct Elsewhere(SourceId, bool);

    impl Visit for Elsewhere {
        fn span(&mut self, span: &mut Span) {
            self.1 |= span.source != self.0;
        }

        fn number(&mut self, _: &mut f64, _: Span) {}

        fn color(&mut self, _: &mut SmolStr, _: Span) {}
    }

    fn cases() -> Vec<String> {
        let mut found = vec![];
        for folder in ["tests/cases/syntax", "tests/cases/diagnostics", "tests/cases/format", "examples"] {
            let folder = format!("{}/{folder}", env!("CARGO_MANIFEST_DIR"));
            for entry in std::fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                if path.extension().is_some_and(|extension| extension == "rt") {
                    found.push(String::from_utf8_lossy(&std::fs::read(path).unwrap()).into_owned());
                }
            }
        }
        found.sort();
        found
    }

    /// Read again, moved and among others, every case gives what it gives by itself.
    #[test]
    fn what_is_remembered_is_what_is_read() {
        let known = Remembered::default();
        for (index, text) in cases().into_iter().enumerate() {
            let source = SourceId(index as u32 % 3);
            let texts = [text.clone(), format!("/// moved\n{text}"), format!("let é = 1\n\n{text}\n// end")];
            for text in texts {
                check(&known, source, &text, Limits::default());
            }
        }
    }

    #[test]
    fn a_limit_holds_for_what_was_read_under_another() {
        let known = Remembered::default();
        let text = "let a = ((((1 + 2) + 3) + 4) + 5)\n";
        for depth in [512, 3, 512, 2] {
            check(&known, SourceId(0), text, Limits { depth, ..Limits::default() });
        }
    }

    #[test]
    fn room_is_made_for_a_text_that_is_read_now() {
        let known = Remembered::default();
        let long = |word: &str, count: usize| {
            (0..count).map(|index| format!("let {word}{index} = [{word} + {index}, 2] // why\n")).collect()
        };
        for word in ["a", "b", "c", "d"] {
            let text: String = long(word, 12_000);
            check(&known, SourceId(0), &text, Limits::default());
        }
        let text: String = long("e", 100);
        check(&known, SourceId(0), &text, Limits::default());
        assert!(known.items().known.keys().any(|key| key.text.starts_with("let e")));
    }

    /// What an edit may put in, between bars: what opens, closes, separates, comments, says, marks.
    const PIECES: &str = "|\n| |{|}|(|)|[|,|;|:|=|\"|1|m|#fff|é|–|\u{1}| in |/// doc\n|// c\n|/*|*/|@off |\
        let a = 1\n|sphere { radius: 1m }\n|else { }";

    proptest! {
        /// Edit after edit, the text that is read with all that was read before gives what it gives by itself.
        #[test]
        fn edits_change_nothing(
            case in 0usize..10_000,
            edits in prop::collection::vec((0usize..100_000, 0usize..12, 0usize..100), 1..24),
        ) {
            let (cases, pieces) = (cases(), PIECES.split('|').collect::<Vec<_>>());
            let mut text = cases[case % cases.len()].clone();
            let known = Remembered::default();
            check(&known, SourceId(0), &text, Limits::default());
            for (at, length, piece) in edits {
                let start = text.floor_char_boundary(at % (text.len() + 1));
                let end = text.ceil_char_boundary(start + length);
                text.replace_range(start..end, pieces[piece % pieces.len()]);
                check(&known, SourceId(0), &text, Limits::default());
            }
        }
    }
}
