//! The files of a folder, for scenes of the tests.

use rt_lang::files::{FileError, FilePath, Files};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What lies in a folder and those below it.
pub struct Folder(pub PathBuf);

impl Folder {
    /// The folder that a file lies in.
    pub fn of(file: &Path) -> Folder {
        Folder(file.parent().unwrap().to_path_buf())
    }
}

impl Files for Folder {
    fn read(&self, path: &FilePath, most: usize) -> Result<Arc<[u8]>, FileError> {
        let bytes = std::fs::read(self.0.join(path.as_str())).map_err(|_| FileError::Missing)?;
        if bytes.len() > most { Err(FileError::TooLarge(most)) } else { Ok(bytes.into()) }
    }

    fn list(&self, folder: &str) -> Vec<String> {
        let entries = std::fs::read_dir(self.0.join(folder)).into_iter().flatten();
        let name = |entry: std::fs::DirEntry| {
            let name = entry.file_name().into_string().unwrap();
            if entry.path().is_dir() { format!("{name}/") } else { name }
        };
        let mut names: Vec<String> = entries.map(|entry| name(entry.unwrap())).collect();
        names.sort();
        names
    }
}
