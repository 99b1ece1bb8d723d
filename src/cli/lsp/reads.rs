//! What documents are made of, and so which of them mean something else when a file changes.

use super::documents::Key;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// The most files of which is kept when they changed.
const MOST_CHANGED: usize = 10_000;

/// What open documents read, as far as it is known, and when files changed. A file is read by each path by which it is reached,
/// and changes with every folder above it.
#[derive(Debug, Default)]
pub struct Reads {
    by_document: BTreeMap<Key, BTreeSet<Key>>,
    /// When paths changed last, as documents are stamped.
    changed: BTreeMap<PathBuf, u64>,
    /// Until when others may have changed of which that is not kept.
    forgotten: u64,
    /// Documents that mean something else since another file changed: the client does not ask about them by itself.
    afar: BTreeSet<Key>,
}

impl Reads {
    /// The open documents that are made of what has these paths, or lies below one.
    pub fn users(&self, paths: &BTreeSet<PathBuf>) -> Vec<Key> {
        let changed = |read: &Key| ways(read).any(|path| paths.contains(path));
        let uses = |(_, reads): &(&Key, &BTreeSet<Key>)| reads.iter().any(changed);
        self.by_document.iter().filter(uses).map(|(user, _)| user.clone()).collect()
    }

    /// Every path that some document reads.
    pub fn files(&self) -> BTreeSet<&Path> {
        self.by_document.values().flatten().filter_map(Key::path).collect()
    }

    /// Keeps when what has some paths changed, for what is being looked at: nobody knows yet what it reads.
    pub fn note(&mut self, paths: &BTreeSet<PathBuf>, stamp: u64) {
        self.changed.extend(paths.iter().map(|path| (path.clone(), stamp)));
        if self.changed.len() > MOST_CHANGED {
            self.changed.clear();
            self.forgotten = stamp;
        }
    }

    /// Some documents mean something else though they were not edited.
    pub fn spoil(&mut self, keys: &[Key]) {
        self.afar.extend(keys.iter().cloned());
    }

    /// Takes what a document reads, which was looked at when a stamp was given. Whether something of it has changed since,
    /// when nobody knew yet that it is read.
    pub fn take(&mut self, key: &Key, reads: BTreeSet<Key>, stamp: u64) -> bool {
        let changed = |path: &Path| self.changed.get(path).is_some_and(|&changed| changed > stamp);
        let late = self.forgotten > stamp || reads.iter().flat_map(ways).any(changed);
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

/// The path of a file, and those of the folders above it.
fn ways(file: &Key) -> impl Iterator<Item = &Path> {
    file.path().into_iter().flat_map(Path::ancestors)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(name: &str) -> Key {
        Key::File(name.into())
    }

    fn paths<const N: usize>(paths: [&str; N]) -> BTreeSet<PathBuf> {
        paths.map(PathBuf::from).into()
    }

    #[test]
    fn who_reads_a_file_is_out_of_date_with_it() {
        let mut reads = Reads::default();
        assert!(!reads.take(&key("/a"), [key("/a"), key("/b/b")].into(), 1));
        for changed in ["/b/b", "/b", "/"] {
            assert_eq!(reads.users(&paths([changed])), [key("/a")]);
        }
        assert_eq!(reads.users(&paths(["/b/b/b", "/b/c", "/b/b~"])), []);
        // It changed while it was looked at.
        reads.note(&paths(["/b"]), 3);
        assert!(reads.take(&key("/a"), [key("/b/b")].into(), 2));
        assert!(!reads.take(&key("/a"), [key("/b/b")].into(), 3));
        assert!(!reads.take(&key("/a"), [key("/c")].into(), 2));
        reads.forget(&key("/a"));
        assert_eq!((reads.users(&paths(["/b"])), reads.files().len()), (vec![], 0));
    }

    #[test]
    fn the_last_of_those_that_were_not_edited_is_known() {
        let mut reads = Reads::default();
        reads.spoil(&[key("/a"), key("/b"), key("/c")]);
        assert!(!reads.settle(&key("/a")) && !reads.settle(&key("/a")));
        reads.forget(&key("/b"));
        assert!(reads.settle(&key("/c")) && !reads.settle(&key("/c")));
    }

    #[test]
    fn changes_without_end_are_not_kept_one_by_one() {
        let mut reads = Reads::default();
        let late = |reads: &mut Reads, stamp| reads.take(&key("/a"), [key("/0")].into(), stamp);
        for n in 0..3 * MOST_CHANGED {
            reads.note(&[PathBuf::from(format!("/{n}"))].into(), 5);
            assert!(reads.changed.len() <= MOST_CHANGED && late(&mut reads, 4));
        }
        assert!(!late(&mut reads, 5));
    }
}
