//! The files that a scene names: imports, pictures, meshes, tables.
//!
//! The library reads none by itself. It resolves what is written to a path below the scene's root folder, and asks
//! whoever called it for the bytes; the caller may keep what was asked for, and so knows what a picture depends on.

use std::fmt;
use std::sync::Arc;

/// The world outside, as far as a scene may see it.
pub trait Files: Sync {
    /// The bytes of a file, at most `most` of them. The same path gives the same bytes throughout one compilation.
    fn read(&self, path: &FilePath, most: usize) -> Result<Arc<[u8]>, FileError>;

    /// What a person calls a file.
    fn name(&self, path: &FilePath) -> String {
        path.to_string()
    }
}

/// A path below the root folder: names joined by `/`, without `.`, `..` or a leading `/`.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct FilePath(String);

/// Why a file cannot be used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FileError {
    /// There is none.
    Missing,
    /// It is not below the root folder, or a link leads out of it.
    Outside,
    /// It is larger than this many bytes.
    TooLarge(usize),
    /// In words, such as `permission denied` or `is a folder`.
    Unreadable(String),
}

impl FilePath {
    /// A file directly in the root folder.
    pub fn root(name: &str) -> FilePath {
        FilePath(name.replace('/', "_"))
    }

    /// What `written` means in this file: a path relative to its folder. [`FileError::Outside`] where it leaves the
    /// root folder or is absolute.
    pub fn join(&self, written: &str) -> Result<FilePath, FileError> {
        let written = written.replace('\\', "/");
        let absolute = written.starts_with('/') || written.as_bytes().get(1) == Some(&b':');
        if absolute || written.contains('\0') {
            return Err(FileError::Outside);
        }
        let mut names: Vec<&str> = self.0.split('/').collect();
        names.pop();
        for name in written.split('/') {
            match name {
                "" | "." => {}
                ".." if names.pop().is_none() => return Err(FileError::Outside),
                ".." => {}
                name => names.push(name),
            }
        }
        match names.is_empty() {
            true => Err(FileError::Unreadable("is a folder".into())),
            false => Ok(FilePath(names.join("/"))),
        }
    }

    /// The path as text.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl fmt::Display for FilePath {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.0)
    }
}

/// No files at all: for scenes that stand alone.
pub struct NoFiles;

impl Files for NoFiles {
    fn read(&self, _: &FilePath, _: usize) -> Result<Arc<[u8]>, FileError> {
        Err(FileError::Missing)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_stay_below_the_root() {
        let scene = FilePath("rooms/hall/scene.rt".into());
        let join = |written| scene.join(written).map(|path| path.0);
        assert_eq!(join("a.rt"), Ok("rooms/hall/a.rt".into()));
        assert_eq!(join("./b/../a.rt"), Ok("rooms/hall/a.rt".into()));
        assert_eq!(join("../../a.rt"), Ok("a.rt".into()));
        assert_eq!(join("..\\a.rt"), Ok("rooms/a.rt".into()));
        for outside in ["../../../a.rt", "/etc/passwd", "C:\\a.rt", "a\0b"] {
            assert_eq!(join(outside), Err(FileError::Outside), "{outside}");
        }
        assert_eq!(FilePath::root("scene.rt").join("a.rt"), Ok(FilePath("a.rt".into())));
        assert!(join("../..").is_err());
    }
}
