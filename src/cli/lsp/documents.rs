//! The documents that the client has open.
//!
//! Whoever answers a question holds the documents as they were when it came. Each has a stamp that is new whenever it, or
//! something it reads, may mean something else: so an answer can be known to be out of date while it is worked out.

use super::document::{Encoding, Place, Text};
use super::uri;
use gen_lsp_types::{Position, Range, TextDocumentContentChangeEvent as Change, Uri};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// The longest text of a document, in bytes.
pub const MOST_TEXT: usize = 64 << 20;

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

/// A document at some moment.
#[derive(Clone, Debug)]
pub struct Document {
    /// Its address as the client writes it.
    pub uri: Uri,
    /// As the client counts.
    pub version: i32,
    /// What it holds.
    pub text: Text,
    /// Whether it holds more than is kept. Its text is empty then.
    pub is_too_long: bool,
    /// New with every change of it or of what it reads.
    pub stamp: u64,
    newest: Arc<AtomicU64>,
}

impl Document {
    /// Whether it has changed since.
    pub fn is_stale(&self) -> bool {
        self.newest.load(Ordering::Relaxed) != self.stamp
    }

    fn take(&mut self, text: String) {
        self.is_too_long = text.len() > MOST_TEXT;
        self.text = Text::new(if self.is_too_long { String::new() } else { text });
    }

    fn edit(&mut self, range: Range, with: &str, encoding: Encoding) {
        if self.is_too_long {
            return;
        }
        let byte = |position: Position| self.text.byte(place(position), encoding);
        let (start, end) = (byte(range.start), byte(range.end));
        // One that is the wrong way round is the same range.
        let range = start.min(end)..start.max(end);
        if self.text.whole().len() - range.len() + with.len() > MOST_TEXT {
            self.is_too_long = true;
            self.text = Text::new(String::new());
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
        let mut document = Document { uri, version, text: text_of, is_too_long: false, stamp: 0, newest };
        document.take(text);
        self.open.insert(key.clone(), Arc::new(document));
        self.touch(&key);
        key
    }

    /// Edits a document, one change after the other. Whether it is open.
    pub fn change(&mut self, key: &Key, version: i32, changes: Vec<Change>, encoding: Encoding) -> bool {
        let Some(document) = self.open.get_mut(key) else { return false };
        let document = Arc::make_mut(document);
        for change in changes {
            match change {
                Change::TextDocumentContentChangePartial(part) => {
                    document.edit(part.range, &part.text, encoding);
                }
                Change::TextDocumentContentChangeWholeDocument(whole) => document.take(whole.text),
            }
        }
        document.version = version;
        self.touch(key);
        true
    }

    /// What is known of a document is out of date. Whether it is open.
    pub fn touch(&mut self, key: &Key) -> bool {
        self.stamps += 1;
        let Some(document) = self.open.get_mut(key) else { return false };
        document.newest.store(self.stamps, Ordering::Relaxed);
        Arc::make_mut(document).stamp = self.stamps;
        true
    }

    /// Forgets a document.
    pub fn close(&mut self, key: &Key) {
        self.stamps += 1;
        if let Some(document) = self.open.remove(key) {
            document.newest.store(self.stamps, Ordering::Relaxed);
        }
    }
}
