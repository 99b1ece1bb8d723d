//! Where the text of a scene is kept, for who changes it: a file, or whoever holds what is not saved.

use crate::cli::interrupt::Interrupt;
use crate::cli::plain;
use crate::cli::target::Aside;
use std::path::{Path, PathBuf};

/// Why a text is left alone that is not the one that was looked at.
pub const CHANGING: &str =
    "there are errors, in the scene or in what is set, or it is being written: mend that first";

/// Hears whether a text was put where it was to go, or why not.
pub type Done = Box<dyn FnOnce(Result<(), String>) + Send>;

/// Keeps the text of a scene.
pub trait Store: Send {
    /// The text as it is now, or why it cannot be had.
    fn read(&self) -> Result<String, String>;

    /// Puts another text in the place of what was read, unless that is something else by now. `done` may hear of it later, from
    /// another thread, and before the text can be read.
    fn replace(&self, before: &str, after: &str, done: Done);
}

/// A text in a file.
pub struct Saved {
    path: PathBuf,
    interrupt: Interrupt,
}

impl Saved {
    /// The text of this file.
    pub fn at(path: &Path, interrupt: &Interrupt) -> Saved {
        Saved { path: path.into(), interrupt: interrupt.clone() }
    }

    fn put(&self, before: &str, after: &str) -> Result<(), String> {
        let mut aside =
            Aside::beside(&self.path, &self.interrupt).map_err(|problem| problem.message.clone())?;
        aside.write(after.as_bytes()).map_err(|problem| problem.message.clone())?;
        // Somebody may have saved it meanwhile.
        if self.read()? != before {
            return Err(CHANGING.into());
        }
        aside.finish().map_err(|problem| problem.message.clone())
    }
}

impl Store for Saved {
    fn read(&self) -> Result<String, String> {
        let cannot = |error: &_| format!("cannot read `{}`: {}", self.path.display(), plain(error));
        std::fs::read_to_string(&self.path).map_err(|error| cannot(&error))
    }

    fn replace(&self, before: &str, after: &str, done: Done) {
        done(self.put(before, after));
    }
}
