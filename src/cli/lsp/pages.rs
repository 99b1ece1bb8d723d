//! The pages on diagnostics, where an editor can open them: the project has no server, so they lie in a folder that is
//! there for as long as the language server runs.

use super::uri::uri_of;
use crate::cli::interrupt::Interrupt;
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
    /// Who removes them where the process ends.
    interrupt: Interrupt,
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
        if !folder.as_ref().is_some_and(|folder| folder.path().is_dir()) {
            let made = self.interrupt.create(|| {
                let made = tempfile::Builder::new().prefix("rtc-codes-").tempdir()?;
                let path = made.path().to_path_buf();
                Ok((made, path))
            });
            *folder = Some(made.ok()?);
        }
        let path = folder.as_ref()?.path().join(format!("{}.md", code.as_str()));
        if !path.exists() {
            std::fs::write(&path, page(code)).ok()?;
        }
        Some(path)
    }
}
