//! The pages on diagnostics, where an editor can open them: the project has no server, so they lie in a folder that is
//! there for as long as the language server runs.

use super::uri::uri_of;
use gen_lsp_types::Uri;
use rt_lang::diagnostic::Code;
use rt_lang::explain::page;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};
use tempfile::TempDir;

/// Pages that were asked for.
#[derive(Debug, Default)]
pub struct Pages {
    folder: Mutex<Option<TempDir>>,
}

impl Pages {
    /// The address of the page on a code; none where nothing can be written.
    pub fn address(&self, code: Code) -> Option<Uri> {
        let path = self.path(code)?;
        Some(uri_of(&path).into())
    }

    /// Removes them. One that is asked for later is there again.
    pub fn tidy(&self) {
        *self.folder.lock().unwrap_or_else(PoisonError::into_inner) = None;
    }

    fn path(&self, code: Code) -> Option<PathBuf> {
        // A folder is there or not.
        let mut folder = self.folder.lock().unwrap_or_else(PoisonError::into_inner);
        // Somebody may have tidied up.
        if !folder.as_ref().is_some_and(|folder| folder.path().is_dir()) {
            *folder = Some(tempfile::Builder::new().prefix("rtc-codes-").tempdir().ok()?);
        }
        let path = folder.as_ref()?.path().join(format!("{}.md", code.as_str()));
        if !path.exists() {
            std::fs::write(&path, page(code)).ok()?;
        }
        Some(path)
    }
}
