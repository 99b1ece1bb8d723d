//! What edits, and changes of files and folders, lead to.

use super::Server;
use crate::cli::live::watcher::{Watcher, names};
use crate::cli::lsp::documents::Key;
use crate::cli::lsp::events::Changes;
use crate::cli::lsp::uri::path_of;
use crate::cli::lsp::view::View;
use crate::cli::lsp::work::Failure;
use gen_lsp_types as lsp;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Weak};
use std::time::SystemTime;

/// What a file looks like from outside: when it was written, and its length.
type Look = (SystemTime, u64);

/// What files look like that are there.
pub type Looks = BTreeMap<PathBuf, Option<Look>>;

/// The texts that documents have had, as long as somebody holds them.
#[derive(Debug, Default)]
pub struct Held(Vec<(Weak<String>, usize)>);

impl Held {
    /// A document has a text.
    fn add(&mut self, text: &Arc<String>) {
        self.0.push((Arc::downgrade(text), text.len()));
    }

    /// How many bytes there are of all.
    pub fn bytes(&mut self) -> usize {
        self.0.retain(|(text, _)| text.strong_count() > 0);
        self.0.iter().map(|(_, bytes)| bytes).sum()
    }
}

impl Server {
    pub(super) fn change_folders(&mut self, event: &lsp::WorkspaceFoldersChangeEvent) {
        let paths = |folders: &[lsp::WorkspaceFolder]| -> Vec<PathBuf> {
            folders.iter().filter_map(|folder| path_of(folder.uri.as_ref())).collect()
        };
        let (added, removed) = (paths(&event.added), paths(&event.removed));
        let folders = &mut Arc::make_mut(&mut self.view).folders;
        folders.retain(|folder| !removed.contains(folder) && !added.contains(folder));
        folders.extend(added);
        self.touch_all();
    }

    pub(super) fn close(&mut self, key: &Key) {
        Arc::make_mut(&mut self.view).documents.close(key);
        self.reads.forget(key);
        for id in self.previews.close(key) {
            self.give_up(id, Failure::plain("the document was closed before its preview was there"));
        }
        for told in self.board.close(key, &self.view) {
            self.publish(told);
        }
        // Those that import it read what is saved from now on.
        self.changed_at(vec![key.clone()]);
    }

    /// Open documents have other texts: they and those that are made of them mean something else.
    pub(super) fn changed_at(&mut self, keys: Vec<Key>) {
        let paths = keys.iter().filter_map(Key::path).flat_map(names).collect();
        self.reads.note(&paths, self.view.documents.stamp());
        let mut users = self.reads.users(&paths);
        users.retain(|user| !keys.contains(user));
        let users = self.spoil(users);
        let open = keys.into_iter().filter(|key| self.view.documents.get(key).is_some());
        let open: Vec<Key> = open.collect();
        self.held.bytes();
        for document in open.iter().filter_map(|key| self.view.documents.get(key)) {
            self.held.add(document.text.whole());
        }
        let looked: Vec<Key> = open.into_iter().chain(users).collect();
        self.desk.look(looked, &self.view);
        self.previews.follow(&self.view);
    }

    /// Saved files, or folders with all that is in them, have changed: only those mean something else that read them there.
    pub(super) fn saved_at(&mut self, paths: impl IntoIterator<Item = PathBuf>) {
        let open = |path: &PathBuf| self.view.documents.get(&Key::File(path.clone())).is_some();
        let reached = paths.into_iter().filter(|path| !open(path)).flat_map(|path| names(&path));
        let paths = reached.filter(|path| !open(path)).collect();
        self.reads.note(&paths, self.view.documents.stamp() + 1);
        self.touch(self.reads.users(&paths));
    }

    /// Something has changed on the disk.
    pub(super) fn hear_events(&mut self) {
        let Changes { mut paths, others } = self.events.take();
        if others {
            paths.extend(self.look_for_changes());
        }
        self.saved_at(paths);
    }

    /// The files that are read and look different than when they were looked at last.
    fn look_for_changes(&mut self) -> Vec<PathBuf> {
        let look = |path: &Path| {
            let metadata = std::fs::metadata(path).ok()?;
            Some((metadata.modified().ok()?, metadata.len()))
        };
        let now: Looks = self.reads.files().into_iter().map(|path| (path.into(), look(path))).collect();
        let before = std::mem::replace(&mut self.looks, now);
        let is_new = |(path, look): &(&PathBuf, &Option<Look>)| before.get(*path) != Some(*look);
        self.looks.iter().filter(is_new).map(|(path, _)| path.clone()).collect()
    }

    /// Watches the files that are read where they are saved, and of which the client does not tell: it watches its folders, if
    /// it can.
    pub(super) fn follow(&mut self) {
        let View { session, documents, folders } = &*self.view;
        let mut told: Vec<PathBuf> = vec![];
        if session.client.watches {
            let real = folders.iter().filter_map(|folder| folder.canonicalize().ok());
            told.extend(real.chain(folders.iter().cloned()));
        }
        let is_open = |path: &Path| documents.get(&Key::File(path.into())).is_some();
        let files = self.reads.files().into_iter();
        let files =
            files.filter(|path| !is_open(path) && !told.iter().any(|folder| path.starts_with(folder)));
        let files: Vec<PathBuf> = files.map(PathBuf::from).collect();
        if self.watcher.is_none() && !files.is_empty() {
            let events = self.events.clone();
            self.watcher = Watcher::new(None, move |paths| events.add(paths)).ok();
        }
        if let Some(watcher) = &mut self.watcher {
            watcher.follow(files);
        }
    }

    fn touch_all(&mut self) {
        self.touch(self.view.documents.iter().map(|(key, _)| key.clone()).collect());
    }

    /// Open documents mean something else.
    pub(super) fn touch(&mut self, keys: Vec<Key>) {
        if keys.is_empty() {
            return;
        }
        let open = self.spoil(keys);
        self.desk.look(open, &self.view);
    }

    /// What is known of documents is out of date, though the client has not edited them. Those that are open.
    fn spoil(&mut self, keys: Vec<Key>) -> Vec<Key> {
        let documents = &mut Arc::make_mut(&mut self.view).documents;
        let open: Vec<Key> = keys.into_iter().filter(|key| documents.touch(key)).collect();
        self.reads.spoil(&open);
        open
    }
}
