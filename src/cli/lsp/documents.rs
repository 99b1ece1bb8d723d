//! The documents that the client has open.
//!
//! Whoever answers a question holds the documents as they were when it came. Each has a stamp that is new whenever it, or
//! something it reads, may mean something else: so an answer can be known to be out of date while it is worked out.

use super::document::{Encoding, Place, Text};
use super::uri;
use gen_lsp_types::{Position, Range, Uri};
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// The longest text of a document, in bytes: what it means takes some hundred times as many.
pub const MOST_TEXT: usize = 16 << 20;
/// The bytes of all their texts together.
pub const MOST_TEXTS: usize = 32 << 20;

/// What tells documents apart.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Key {
    /// A file, saved or to be saved, by its path.
    File(PathBuf),
    /// Something else, by its address.
    Other(String),
}

impl Key {
    /// Of an address.
    pub fn of(uri: &Uri) -> Key {
        uri::path_of(uri.as_ref()).map_or_else(|| Key::Other(uri.to_string()), Key::File)
    }

    /// The path, if it is a file.
    pub fn path(&self) -> Option<&Path> {
        match self {
            Key::File(path) => Some(path),
            Key::Other(_) => None,
        }
    }

    /// An address that leads to it.
    pub fn uri(&self) -> Uri {
        match self {
            Key::File(path) => uri::uri_of(path).into(),
            Key::Other(uri) => uri.clone().into(),
        }
    }
}

/// Whether the text of a document is known. Where it is not, the text is empty, and edits make nothing of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kept {
    /// It is.
    Whole,
    /// There is more of it than is kept.
    TooLong,
    /// There is more of all documents together than is kept.
    TooMuch,
    /// It was edited in a way that cannot be understood.
    Lost,
}

/// How a document was edited. The changes are read one by one: what cannot be read of one is not left out in silence.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Changed {
    /// Which.
    pub text_document: Named,
    #[serde(default)]
    content_changes: Value,
}

/// A document, and what the client calls what it is now, if that is a number.
#[derive(Debug, Deserialize)]
pub struct Named {
    /// Its address.
    pub uri: Uri,
    #[serde(default)]
    version: Value,
}

/// A change of a text, or of a part of it.
enum Change {
    Part(Part),
    Whole(String),
}

#[derive(Deserialize)]
struct Part {
    range: Range,
    text: String,
}

impl Change {
    /// As the client tells it; none where it makes no sense. One that has a range is never of the whole text, whatever the
    /// range is.
    fn read(mut change: Value) -> Option<Change> {
        if change.get("range").is_some_and(|range| !range.is_null()) {
            return serde_json::from_value(change).ok().map(Change::Part);
        }
        match change.get_mut("text").map(Value::take) {
            Some(Value::String(text)) => Some(Change::Whole(text)),
            _ => None,
        }
    }
}

/// A document at some moment.
#[derive(Clone, Debug)]
pub struct Document {
    /// Its address as the client writes it.
    pub uri: Uri,
    /// As the client counts.
    pub version: i32,
    /// What it holds.
    pub text: Text,
    /// Whether that is all.
    pub kept: Kept,
    /// New with every change of it or of what it reads.
    pub stamp: u64,
    /// The stamp with which it was edited last.
    pub edited: u64,
    newest: Arc<Newest>,
}

/// The stamps of a document now.
#[derive(Debug, Default)]
struct Newest {
    stamp: AtomicU64,
    edited: AtomicU64,
}

impl Document {
    /// Whether it has changed since.
    pub fn is_stale(&self) -> bool {
        self.newest.stamp.load(Ordering::Relaxed) != self.stamp
    }

    /// Whether the client has edited or closed it since.
    pub fn is_edited(&self) -> bool {
        self.newest.edited.load(Ordering::Relaxed) != self.edited
    }

    fn take(&mut self, text: String) {
        if text.len() > MOST_TEXT {
            return self.lose(Kept::TooLong);
        }
        (self.kept, self.text) = (Kept::Whole, Text::new(text));
    }

    fn lose(&mut self, kept: Kept) {
        (self.kept, self.text) = (kept, Text::new(String::new()));
    }

    fn change(&mut self, change: Value, encoding: Encoding) {
        match Change::read(change) {
            Some(Change::Whole(text)) => self.take(text),
            // Of a text that is not known no part is.
            Some(Change::Part(_)) if self.kept != Kept::Whole => {}
            Some(Change::Part(Part { range, text })) => self.edit(range, &text, encoding),
            None => self.lose(Kept::Lost),
        }
    }

    fn edit(&mut self, range: Range, with: &str, encoding: Encoding) {
        let [from, to] = [range.start, range.end].map(place);
        // Whoever tells of such a place counts otherwise, or has another text.
        if to < from || [from, to].iter().any(|place| self.text.is_torn(*place, encoding)) {
            return self.lose(Kept::Lost);
        }
        let range = self.text.byte(from, encoding)..self.text.byte(to, encoding);
        if self.text.whole().len() - range.len() + with.len() > MOST_TEXT {
            self.lose(Kept::TooLong);
        } else {
            self.text.replace(range, with);
        }
    }
}

/// A place as the protocol has it.
pub fn place(position: Position) -> Place {
    Place { line: position.line, character: position.character }
}

/// All open documents; a copy of it is what they were at a moment.
#[derive(Clone, Debug, Default)]
pub struct Documents {
    open: BTreeMap<Key, Arc<Document>>,
    stamps: u64,
}

impl Documents {
    /// An open document.
    pub fn get(&self, key: &Key) -> Option<&Arc<Document>> {
        self.open.get(key)
    }

    /// All of them.
    pub fn iter(&self) -> impl Iterator<Item = (&Key, &Arc<Document>)> {
        self.open.iter()
    }

    /// The stamp that was given last.
    pub fn stamp(&self) -> u64 {
        self.stamps
    }

    /// Takes a document in; one that is open already is replaced.
    pub fn open(&mut self, uri: Uri, version: i32, text: String) -> Key {
        let key = Key::of(&uri);
        self.close(&key);
        let text_of = Text::new(String::new());
        let newest = Arc::default();
        let kept = Kept::Whole;
        let mut document =
            Document { uri, version, text: text_of, kept, stamp: 0, edited: self.stamps + 1, newest };
        document.take(text);
        self.open.insert(key.clone(), Arc::new(document));
        self.bound(&key);
        self.touch(&key);
        key
    }

    /// Edits a document, one change after the other. Whether it is open.
    pub fn change(&mut self, key: &Key, changed: Changed, encoding: Encoding) -> bool {
        let Some(document) = self.open.get_mut(key) else { return false };
        let document = Arc::make_mut(document);
        match changed.content_changes {
            Value::Array(changes) => changes.into_iter().for_each(|change| document.change(change, encoding)),
            _ => document.lose(Kept::Lost),
        }
        let version = changed.text_document.version.as_i64().and_then(|version| version.try_into().ok());
        document.version = version.unwrap_or(document.version);
        document.edited = self.stamps + 1;
        self.bound(key);
        self.touch(key);
        true
    }

    /// Gives up the text of a document with which there is more than is kept.
    fn bound(&mut self, key: &Key) {
        let all: usize = self.open.values().map(|document| document.text.whole().len()).sum();
        if let Some(document) = self.open.get_mut(key).filter(|_| all > MOST_TEXTS) {
            Arc::make_mut(document).lose(Kept::TooMuch);
        }
    }

    /// What is known of a document is out of date. Whether it is open.
    pub fn touch(&mut self, key: &Key) -> bool {
        self.stamps += 1;
        let Some(document) = self.open.get_mut(key) else { return false };
        document.newest.edited.store(document.edited, Ordering::Relaxed);
        document.newest.stamp.store(self.stamps, Ordering::Relaxed);
        Arc::make_mut(document).stamp = self.stamps;
        true
    }

    /// Forgets a document.
    pub fn close(&mut self, key: &Key) {
        self.stamps += 1;
        if let Some(document) = self.open.remove(key) {
            document.newest.edited.store(self.stamps, Ordering::Relaxed);
            document.newest.stamp.store(self.stamps, Ordering::Relaxed);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    /// A document of which a text is left by some changes, and whether that is known.
    fn changed(text: &str, changes: &[Value]) -> (String, Kept) {
        let mut documents = Documents::default();
        let uri = "untitled:a";
        let key = documents.open(uri.to_string().into(), 1, text.into());
        let changed = json!({ "textDocument": { "uri": uri, "version": 2 }, "contentChanges": changes });
        assert!(documents.change(&key, serde_json::from_value(changed).unwrap(), Encoding::Utf16));
        let document = documents.get(&key).unwrap();
        (document.text.whole().to_string(), document.kept)
    }

    fn put(line: i64, text: &str) -> Value {
        let at = json!({ "line": line, "character": 0 });
        json!({ "range": { "start": at, "end": at }, "text": text })
    }

    #[test]
    fn a_change_with_a_range_that_makes_no_sense_is_not_the_whole_text() {
        for line in [-1, 1 << 32, i64::MIN] {
            assert_eq!(changed("ab", &[put(line, "x")]), (String::new(), Kept::Lost), "{line}");
        }
        for odd in [json!({}), json!(null), json!({ "text": 3 }), json!({ "range": [], "text": "x" })] {
            assert_eq!(changed("ab", &[odd.clone(), put(0, "x")]), (String::new(), Kept::Lost), "{odd}");
            // The whole text is known, whatever was before.
            assert_eq!(changed("ab", &[odd, json!({ "text": "c" })]), ("c".into(), Kept::Whole));
        }
        assert_eq!(changed("ab", &[put(0, "x"), put(7, "y")]), ("xaby".into(), Kept::Whole));
        // The second place is before the first, or within a character; what is too far is as far as there is something.
        let cut = |from: [u32; 2], to: [u32; 2]| {
            let [from, to] =
                [from, to].map(|[line, character]| json!({ "line": line, "character": character }));
            changed("a😀\nb", &[json!({ "range": { "start": from, "end": to }, "text": "" })])
        };
        for (from, to) in
            [([1, 0], [0, 1]), ([0, 1], [0, 0]), ([0, 9], [0, 8]), ([0, 2], [0, 3]), ([0, 0], [0, 2])]
        {
            assert_eq!(cut(from, to), (String::new(), Kept::Lost), "{from:?} {to:?}");
        }
        for (from, to, left) in
            [([0, 1], [0, 9], "a\nb"), ([0, 3], [9, 9], "a😀"), ([7, 0], [7, 2], "a😀\nb")]
        {
            assert_eq!(cut(from, to), (left.into(), Kept::Whole), "{from:?} {to:?}");
        }
    }

    #[test]
    fn a_text_that_was_too_long_is_not_known_until_it_is_told() {
        let long = "x".repeat(MOST_TEXT);
        let cut = json!({ "range": { "start": { "line": 0, "character": 1 }, "end": { "line": 9, "character": 0 } }, "text": "" });
        assert_eq!(changed(&long, &[put(0, "y"), cut.clone()]), (String::new(), Kept::TooLong));
        assert_eq!(changed(&long, &[cut, put(0, "y")]), ("yx".into(), Kept::Whole));
        assert_eq!(changed(&long, &[put(0, "y"), json!({ "text": "c" })]), ("c".into(), Kept::Whole));
    }

    #[test]
    fn all_documents_together_are_bounded() {
        let mut documents = Documents::default();
        let kept: Vec<Kept> = (0..5)
            .map(|n| {
                let key = documents.open(format!("untitled:{n}").into(), 1, "x".repeat(MOST_TEXTS / 3));
                documents.get(&key).unwrap().kept
            })
            .collect();
        let (whole, much) = (Kept::Whole, Kept::TooMuch);
        assert_eq!(kept, [whole, whole, whole, much, much]);
        let bytes: usize = documents.iter().map(|(_, document)| document.text.whole().len()).sum();
        assert!(bytes <= MOST_TEXTS);
        documents.close(&Key::Other("untitled:0".into()));
        let key = documents.open("untitled:4".to_string().into(), 2, "x".repeat(MOST_TEXTS / 3));
        assert_eq!(documents.get(&key).unwrap().kept, whole);
    }
}
