//! What documents are made of, and so which of them mean something else when a file changes.

use super::documents::Key;
use std::collections::{BTreeMap, BTreeSet};

/// The most files of which is kept when they changed.
const MOST_CHANGED: usize = 10_000;

/// What open documents read, as far as it is known, and when files changed.
#[derive(Debug, Default)]
pub struct Reads {
    by_document: BTreeMap<Key, BTreeSet<Key>>,
    /// When files changed last, as documents are stamped.
    changed: BTreeMap<Key, u64>,
    /// Documents that mean something else since another file changed: the client does not ask about them by itself.
    afar: BTreeSet<Key>,
}

impl Reads {
    /// The open documents that are made of some files, but not these.
    pub fn users(&self, keys: &[Key]) -> Vec<Key> {
        let uses = |(user, reads): &(&Key, &BTreeSet<Key>)| {
            !keys.contains(user) && keys.iter().any(|key| reads.contains(key))
        };
        self.by_document.iter().filter(uses).map(|(user, _)| user.clone()).collect()
    }

    /// Every file that some document reads.
    pub fn files(&self) -> BTreeSet<&Key> {
        self.by_document.values().flatten().collect()
    }

    /// Keeps when files changed. False where that were too many: then it is forgotten, and whatever is being looked at
    /// may be out of date.
    #[must_use]
    pub fn note(&mut self, keys: &[Key], stamp: u64) -> bool {
        self.changed.extend(keys.iter().map(|key| (key.clone(), stamp)));
        let fits = self.changed.len() <= MOST_CHANGED;
        if !fits {
            self.changed.clear();
        }
        fits
    }

    /// Some documents mean something else though they were not edited.
    pub fn spoil(&mut self, keys: &[Key]) {
        self.afar.extend(keys.iter().cloned());
    }

    /// Takes what a document reads, which was looked at when a stamp was given. Whether something of it has changed since,
    /// when nobody knew yet that it is read.
    pub fn take(&mut self, key: &Key, reads: BTreeSet<Key>, stamp: u64) -> bool {
        let late = reads.iter().any(|read| self.changed.get(read).is_some_and(|&changed| changed > stamp));
        self.by_document.insert(key.clone(), reads);
        late
    }

    /// What a document means is known again. Whether it was the last of those that were not edited themselves.
    pub fn settle(&mut self, key: &Key) -> bool {
        self.afar.remove(key) && self.afar.is_empty()
    }

    /// Forgets a document that was closed.
    pub fn forget(&mut self, key: &Key) {
        self.by_document.remove(key);
        self.afar.remove(key);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(name: &str) -> Key {
        Key::Other(name.into())
    }

    #[test]
    fn who_reads_a_file_is_out_of_date_with_it() {
        let mut reads = Reads::default();
        assert!(!reads.take(&key("a"), [key("a"), key("b")].into(), 1));
        assert_eq!(reads.users(&[key("b")]), [key("a")]);
        assert_eq!(reads.users(&[key("a"), key("b")]), []);
        // It changed while it was looked at.
        assert!(reads.note(&[key("b")], 3));
        assert!(reads.take(&key("a"), [key("b")].into(), 2));
        assert!(!reads.take(&key("a"), [key("b")].into(), 3));
        reads.forget(&key("a"));
        assert_eq!((reads.users(&[key("b")]), reads.files().len()), (vec![], 0));
    }

    #[test]
    fn the_last_of_those_that_were_not_edited_is_known() {
        let mut reads = Reads::default();
        reads.spoil(&[key("a"), key("b"), key("c")]);
        assert!(!reads.settle(&key("a")) && !reads.settle(&key("a")));
        reads.forget(&key("b"));
        assert!(reads.settle(&key("c")) && !reads.settle(&key("c")));
    }

    #[test]
    fn changes_without_end_are_not_kept() {
        let mut reads = Reads::default();
        let forgotten = (0..3 * MOST_CHANGED).filter(|n| !reads.note(&[key(&n.to_string())], 1)).count();
        assert!(forgotten == 2 && reads.changed.len() <= MOST_CHANGED);
    }
}
