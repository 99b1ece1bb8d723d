//! Items of one shape are parsed once.
//!
//! The items of a long text mostly differ in their numbers and colours alone. The first of a shape is read by the
//! grammar, and remembered with what its places depend on; the next ones are rows of literals, where that says all
//! of them, or else copies of its tree with their own literals and places. The shape is the item's text with a mark
//! for each literal, so that a copy is exactly what the grammar would give.

use super::ast::Entry;
use super::rows::{Literal, Shape};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The longest item that is remembered, in bytes.
const MAX_LENGTH: usize = 4096;

/// The most shapes that are remembered.
const MAX_SHAPES: usize = 256;

/// The most digits of a number in an item with a shape: it is finite.
const MAX_DIGITS: usize = 300;

/// The most digits of a whole number in an item with a shape: it is exact.
const MAX_WHOLE_DIGITS: usize = 15;

/// The shapes that were seen.
#[derive(Default)]
pub(super) struct Shapes {
    known: BTreeMap<Vec<u8>, Arc<Shape>>,
    key: Vec<u8>,
    literals: Vec<Literal>,
}

impl Shapes {
    /// The shape of an item, if it is known, and the item's literals. Asked before [`Shapes::learn`] of the same item.
    pub(super) fn recall(&mut self, text: &str) -> Option<(&Arc<Shape>, &[Literal])> {
        if !self.scan(text) {
            return None;
        }
        self.known.get(&self.key).map(|shape| (shape, self.literals.as_slice()))
    }

    /// Remembers an item that was just asked for and read by the grammar without a slip.
    pub(super) fn learn(&mut self, entries: &[Entry], start: u32) {
        if self.key.is_empty() || self.known.len() >= MAX_SHAPES {
            return;
        }
        if let Some(shape) = Shape::new(entries, start, &self.literals) {
            self.known.insert(self.key.clone(), Arc::new(shape));
        }
    }

    /// Finds the shape of an item and its literals. An item with anything out of the ordinary has none.
    fn scan(&mut self, text: &str) -> bool {
        self.key.clear();
        self.literals.clear();
        let sound = text.len() <= MAX_LENGTH && self.scan_bytes(text.as_bytes());
        if !sound {
            self.key.clear();
        }
        sound
    }

    fn scan_bytes(&mut self, text: &[u8]) -> bool {
        let run = |from: usize, fits: fn(u8) -> bool| {
            from + text[from..].iter().take_while(|&&byte| fits(byte)).count()
        };
        let mut at = 0;
        while let Some(&byte) = text.get(at) {
            let start = at;
            match byte {
                b'0'..=b'9' => {
                    at = run(at, |byte| byte.is_ascii_digit());
                    let point =
                        text.get(at) == Some(&b'.') && text.get(at + 1).is_some_and(u8::is_ascii_digit);
                    if point {
                        at = run(at + 1, |byte| byte.is_ascii_digit());
                    }
                    self.key.push(if point { MARK_NUMBER } else { MARK_INT });
                    // A zero needs no unit.
                    if text[start..at].iter().all(|byte| matches!(byte, b'0' | b'.')) {
                        self.key.push(MARK_ZERO);
                    }
                    self.literals.push(Literal { start: start as u32, end: at as u32 });
                    let next = text.get(at).copied().unwrap_or(b' ');
                    // What may belong to the number, or be misread as if it did.
                    let most = if point { MAX_DIGITS } else { MAX_WHOLE_DIGITS };
                    if b"_.eExXbBoO".contains(&next) || at - start > most {
                        return false;
                    }
                    let unit = at;
                    at = run(at, is_word);
                    self.key.extend_from_slice(&text[unit..at]);
                }
                b'#' => {
                    at = run(at + 1, is_word);
                    let digits = &text[start + 1..at];
                    if !matches!(digits.len(), 3 | 6) || !digits.iter().all(u8::is_ascii_hexdigit) {
                        return false;
                    }
                    self.key.push(MARK_COLOR);
                    self.literals.push(Literal { start: start as u32, end: at as u32 });
                }
                b'"' => {
                    at += 1;
                    while text.get(at).is_some_and(|&byte| byte != b'"') {
                        at += if text[at] == b'\\' { 2 } else { 1 };
                    }
                    at = (at + 1).min(text.len());
                    self.key.extend_from_slice(&text[start..at]);
                }
                0..=8 => return false,
                _ if is_word(byte) => {
                    at = run(at, is_word);
                    self.key.extend_from_slice(&text[start..at]);
                }
                _ => {
                    self.key.push(byte);
                    at += 1;
                }
            }
        }
        true
    }
}

// Bytes that no key has besides.
const MARK_INT: u8 = 2;
const MARK_NUMBER: u8 = 3;
const MARK_COLOR: u8 = 4;
const MARK_ZERO: u8 = 5;

fn is_word(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || byte == b'_' || byte >= 0x80
}

#[cfg(test)]
mod tests {
    use super::super::build::Source;
    use super::super::cut::cut;
    use super::super::items::items;
    use crate::span::SourceId;
    use proptest::prelude::*;

    /// All items together give what each gives by itself.
    fn check(text: &str) {
        let cut = cut(SourceId(0), text, 512);
        let comments = &cut.comments;
        let source = Source { id: SourceId(0), text, comments, depth: 512, known: None };
        let (together, _) = items(source, &cut.items);
        let together = crate::syntax::rows::written_out(together, text);
        let alone: Vec<_> =
            cut.items.iter().flat_map(|item| items(source, std::slice::from_ref(item)).0).collect();
        assert_eq!(format!("{together:?}"), format!("{alone:?}"), "{text}");
    }

    #[test]
    fn cases_are_copied_exactly() {
        for folder in ["syntax", "diagnostics", "format"] {
            let folder = format!("{}/tests/cases/{folder}", env!("CARGO_MANIFEST_DIR"));
            for entry in std::fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                if path.extension().is_some_and(|extension| extension == "rt") {
                    let text = String::from_utf8_lossy(&std::fs::read(path).unwrap()).into_owned();
                    // Twice, with other numbers the second time.
                    let again = text.replace('1', "23").replace("5.", "0.");
                    check(&format!("{text}\n\n{again}"));
                }
            }
        }
    }

    fn item() -> impl Strategy<Value = String> {
        let number = prop::sample::select(vec![
            "0", "1", "12", "0.5", "007", "1e3", "1_0", "1.5.2", ".5", "0x1", "0b1", "5in", "1..2", "3.",
            "1e", "9m2",
        ]);
        let shape = prop::sample::select(vec![
            "sphere { at: (N, N, N)m, radius: Nmm }",
            "/// doc\n@off sphere a { radius: N }",
            "let a = N",
            "let a1 = f(N, N: N) + #fff[N] - \"1\\\"2\" N",
            "param a: int = N in N to N",
            "fn f(a: int) -> int = if N then N else N.x",
            "group { sphere { radius: N% }\n let b = NW/m2 // c\n }",
            "a { color: #FFN, b: #NNN }",
            "for i in [N, N] { x: -N * N in }",
        ]);
        (shape, prop::collection::vec(number, 8)).prop_map(|(shape, numbers)| {
            let mut text = String::new();
            for (index, piece) in shape.split('N').enumerate() {
                if index > 0 {
                    text += numbers[index % numbers.len()];
                }
                text += piece;
            }
            text
        })
    }

    proptest! {
        #[test]
        fn generated_items_are_copied_exactly(items in prop::collection::vec(item(), 1..30)) {
            check(&items.join("\n"));
        }
    }
}
