//! What the server knew when it was asked something.

use super::client::Client;
use super::document::Encoding;
use super::documents::Documents;
use super::pages::Pages;
use rt_lang::Options;
use rt_lang::files::Memory;
use rt_lang::lower::Overrides;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What stays the same from the beginning to the end.
#[derive(Debug)]
pub struct Session {
    /// What the client can do.
    pub client: Client,
    /// How it counts characters.
    pub encoding: Encoding,
    /// The folder below which every scene may read, where one was given.
    pub root: Option<PathBuf>,
    /// The pages on diagnostics.
    pub pages: Pages,
    /// Of texts that are read again after each edit.
    pub memory: Arc<Memory>,
}

impl Session {
    /// What the compiler is told: no camera takes a picture here, so each is looked through.
    pub fn options(&self) -> Options {
        let overrides = Overrides { every_camera: true, ..Overrides::default() };
        Options { overrides, ..Options::default() }
    }
}

/// What it knew at a moment.
#[derive(Clone, Debug)]
pub struct View {
    /// What stays the same.
    pub session: Arc<Session>,
    /// What is open.
    pub documents: Documents,
    /// The folders of the workspace.
    pub folders: Vec<PathBuf>,
}

impl View {
    /// The folder from which the path of a file is told, and whether what is in it may be read by each scene in it. Otherwise a
    /// scene reads below its own folder, as on the command line.
    pub fn base(&self, file: &Path) -> (PathBuf, bool) {
        if let Some(root) = self.session.root.as_ref().filter(|root| file.starts_with(root)) {
            return (root.clone(), true);
        }
        let around = self.folders.iter().filter(|folder| file.starts_with(folder));
        let outermost = around.min_by_key(|folder| folder.as_os_str().len());
        let own = || file.parent().unwrap_or(Path::new("/")).to_path_buf();
        (outermost.cloned().unwrap_or_else(own), false)
    }
}
