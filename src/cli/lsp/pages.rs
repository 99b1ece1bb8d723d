//! The pages on diagnostics, where an editor can open them: the project has no server, so they lie in a folder that is
//! there for as long as the language server runs.
//!
//! A server that was killed leaves its folder behind, and the next one removes it: in each is a file that is locked by the one
//! that uses it.

use super::uri::uri_of;
use crate::cli::interrupt::Interrupt;
use gen_lsp_types::Uri;
use rt_lang::diagnostic::Code;
use rt_lang::explain::page;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use tempfile::TempDir;

/// What the names of their folders begin with.
const PREFIX: &str = "rtc-codes-";
/// The file in each whose lock says that it is used.
const LOCK: &str = "lock";

/// Pages that were asked for.
#[derive(Debug, Default)]
pub struct Pages {
    folder: Mutex<Option<Folder>>,
    /// Who removes them where the process ends.
    interrupt: Interrupt,
}

/// Where they lie.
#[derive(Debug)]
struct Folder {
    /// Locked as long as this is here.
    _lock: File,
    place: TempDir,
}

impl Pages {
    /// None yet.
    pub fn new(interrupt: Interrupt) -> Pages {
        Pages { folder: Mutex::default(), interrupt }
    }

    /// The address of the page on a code; none where nothing can be written.
    pub fn address(&self, code: Code) -> Option<Uri> {
        let path = self.path(code)?;
        Some(uri_of(&path).into())
    }

    fn path(&self, code: Code) -> Option<PathBuf> {
        // A folder is there or not.
        let mut folder = self.folder.lock().unwrap_or_else(PoisonError::into_inner);
        // Somebody may have tidied up.
        if !folder.as_ref().is_some_and(|folder| folder.place.path().is_dir()) {
            remove_left(&std::env::temp_dir());
            *folder = Some(self.interrupt.create(make).ok()?);
        }
        let path = folder.as_ref()?.place.path().join(format!("{}.md", code.as_str()));
        if !path.exists() {
            // Nothing is put into a folder that is being removed.
            let write = || std::fs::write(&path, page(code)).map(|()| ((), path.clone()));
            self.interrupt.create(write).ok()?;
        }
        Some(path)
    }
}

fn make() -> io::Result<(Folder, PathBuf)> {
    let place = tempfile::Builder::new().prefix(PREFIX).tempdir()?;
    let lock = File::create_new(place.path().join(LOCK))?;
    // A disk that knows no locks keeps what is left.
    let _ = lock.try_lock();
    let path = place.path().to_path_buf();
    Ok((Folder { place, _lock: lock }, path))
}

/// Removes the folders of servers that are there no more. A server that has not locked its own yet makes another one.
fn remove_left(around: &Path) {
    let named = |entry: &std::fs::DirEntry| entry.file_name().to_string_lossy().starts_with(PREFIX);
    let folders = std::fs::read_dir(around).into_iter().flatten().flatten().filter(named);
    for folder in folders.map(|entry| entry.path()).filter(|folder| is_ours(folder)) {
        let lock = File::open(folder.join(LOCK));
        if lock.is_ok_and(|lock| lock.try_lock().is_ok()) {
            let _ = std::fs::remove_dir_all(&folder);
        }
    }
}

/// Whether this is a folder of this user's, and no link to one: in others whatever is opened may be made to be waited for.
fn is_ours(folder: &Path) -> bool {
    let Ok(found) = std::fs::symlink_metadata(folder) else { return false };
    #[cfg(unix)]
    if std::os::unix::fs::MetadataExt::uid(&found) != rustix::process::geteuid().as_raw() {
        return false;
    }
    found.is_dir()
}
