//! The files that a scene names: imports, pictures, meshes, tables.
//!
//! The library reads none by itself. It resolves what is written to a path below the scene's root folder, and asks
//! whoever called it for the bytes; the caller may keep what was asked for, and so knows what a picture depends on.

use crate::diagnostic::{Code, Diagnostic};
use crate::span::Span;
use std::any::{Any, TypeId};
use std::collections::BTreeMap;
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

/// The world outside, as far as a scene may see it.
pub trait Files: Sync {
    /// The bytes of a file, at most `most` of them. The same path gives the same bytes throughout one compilation.
    fn read(&self, path: &FilePath, most: usize) -> Result<Arc<[u8]>, FileError>;

    /// The names of what a folder below the root holds, for who writes a path; those of folders end with `/`. The folder is
    /// written as a [`FilePath`], and the root folder as nothing. Nothing where it cannot be read.
    fn list(&self, folder: &str) -> Vec<String> {
        let _ = folder;
        vec![]
    }

    /// Where what took time to find out of texts may be kept for the next time; nowhere, unless texts are read again and again.
    fn memory(&self) -> Option<&Memory> {
        None
    }

    /// What a person calls a file.
    fn name(&self, path: &FilePath) -> String {
        path.to_string()
    }
}

/// What is kept from one compilation for the next ones, by whoever finds it out: no answer depends on it, only how soon it comes.
#[derive(Debug, Default)]
pub struct Memory(Mutex<BTreeMap<TypeId, Arc<dyn Any + Send + Sync>>>);

impl Memory {
    /// What is kept of one sort; at first its default.
    pub fn of<T: Any + Default + Send + Sync>(&self) -> Arc<T> {
        // What is kept is whole at any time.
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let kept = kept.entry(TypeId::of::<T>()).or_insert_with(|| Arc::new(T::default()));
        kept.clone().downcast().unwrap_or_default()
    }
}

/// A path below the root folder: names joined by `/`, without `.`, `..` or a leading `/`.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct FilePath(String);

/// Where the pictures and meshes of a scene were read, by the hash of what they hold. It stands beside the scene:
/// from where the same content was read does not change the picture.
#[derive(Clone, Debug, Default)]
pub struct Contents(BTreeMap<[u8; 32], FilePath>);

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

impl FileError {
    /// What is said of it. `written` is the path as it stands at `span` in a source.
    pub fn diagnostic(&self, written: &str, span: Span) -> Diagnostic {
        if written.trim_ascii().is_empty() {
            return Diagnostic::new(Code::E0501, "the path is empty", span)
                .at("names no file")
                .help("write the path of a file, as it counts from the folder of this one");
        }
        let (code, message, label) = match self {
            FileError::Missing => (Code::E0501, format!("there is no file `{written}`"), "not found"),
            FileError::Outside => {
                (Code::E0501, format!("`{written}` is not below the scene's root folder"), "outside")
            }
            FileError::TooLarge(most) => {
                (Code::E0406, format!("`{written}` is larger than {} MiB", most >> 20), "too large")
            }
            FileError::Unreadable(reason) => {
                (Code::E0501, format!("`{written}` cannot be read: {reason}"), "not readable")
            }
        };
        let diagnostic = Diagnostic::new(code, message, span).at(label);
        match self {
            FileError::Missing => diagnostic.help("a path counts from the folder of the file that names it"),
            FileError::Outside => {
                diagnostic.help("`--root FOLDER` says below which folder files may be read")
            }
            FileError::TooLarge(_) | FileError::Unreadable(_) => diagnostic,
        }
    }
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

    /// What to write in another file for this one, so that [`FilePath::join`] finds it from there.
    pub fn written_in(&self, other: &FilePath) -> String {
        let ours: Vec<&str> = self.0.split('/').collect();
        let mut around: Vec<&str> = other.0.split('/').collect();
        around.pop();
        // The last name is the file's own, also where a folder is called the same.
        let folders = &ours[..ours.len() - 1];
        let shared = folders.iter().zip(&around).take_while(|(a, b)| a == b).count();
        // What could be taken for the name of a drive is not.
        let here =
            if shared == around.len() && ours[shared].as_bytes().get(1) == Some(&b':') { "./" } else { "" };
        here.to_string() + &"../".repeat(around.len() - shared) + &ours[shared..].join("/")
    }

    /// The path as text.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl Contents {
    /// Says where something was read. Of several files that hold the same, the first is kept.
    pub fn add(&mut self, hash: blake3::Hash, path: &FilePath) {
        self.0.entry(*hash.as_bytes()).or_insert_with(|| path.clone());
    }

    /// Where it was read.
    pub fn path(&self, hash: blake3::Hash) -> Option<&FilePath> {
        self.0.get(hash.as_bytes())
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

    #[test]
    fn what_is_written_for_a_path_leads_to_it() {
        let path = |text: &str| FilePath(text.into());
        for other in ["scene.rt", "rooms/scene.rt", "rooms/hall/scene.rt", "rooms/hall/a.png/scene.rt"] {
            for wanted in ["a.png", "rooms/a.png", "rooms/hall/a.png", "b/c/d.png", "b:/d.png"] {
                let written = path(wanted).written_in(&path(other));
                assert_eq!(path(other).join(&written), Ok(path(wanted)), "{other}: {written}");
            }
        }
        assert_eq!(path("rooms/a.png").written_in(&path("rooms/hall/scene.rt")), "../a.png");
    }
}
