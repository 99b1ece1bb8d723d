//! What edits, and changes of files and folders, lead to.

use super::Server;
use crate::cli::lsp::documents::Key;
use crate::cli::lsp::uri::path_of;
use crate::cli::lsp::work::Failure;
use gen_lsp_types as lsp;
use std::path::PathBuf;
use std::sync::Arc;

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
        self.note(&keys, self.view.documents.stamp());
        let users = self.spoil(self.reads.users(&keys));
        let open = keys.into_iter().filter(|key| self.view.documents.get(key).is_some());
        let looked: Vec<Key> = open.chain(users).collect();
        self.desk.look(looked, &self.view);
        self.previews.follow(&self.view);
    }

    /// Saved files have changed: only those mean something else that read them there.
    pub(super) fn saved_at(&mut self, keys: Vec<Key>) {
        let open = |key: &Key| self.view.documents.get(key).is_some();
        let keys: Vec<Key> = keys.into_iter().filter(|key| !open(key)).collect();
        self.note(&keys, self.view.documents.stamp() + 1);
        self.touch(self.reads.users(&keys));
    }

    /// Keeps when files changed, or looks at everything again.
    fn note(&mut self, keys: &[Key], stamp: u64) {
        if !self.reads.note(keys, stamp) {
            self.touch_all();
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
