//! The files that a document may read: open documents first, then what is saved.
//!
//! Paths are told from the folder of the workspace, so that one path means one file to all its scenes; what a scene may
//! read lies below its own folder, as on the command line, unless a root was given.

use super::documents::{Document, Kept, Key, MOST_TEXT};
use super::view::View;
use crate::cli::files::Disk;
use rt_lang::files::{FileError, FilePath, Files, Memory};
use rt_lang::source::Source;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// What there is to be read around one document.
pub struct World {
    names: Names,
    /// None where nothing is saved: the document has no folder, or it has vanished.
    disk: Option<Disk>,
    open: BTreeMap<FilePath, Arc<Document>>,
    /// The document itself.
    own: FilePath,
    /// What the paths begin with that it may read.
    within: String,
    asked: Mutex<BTreeSet<Key>>,
    memory: Arc<Memory>,
}

/// What the paths of an analysis mean.
#[derive(Clone, Debug)]
pub struct Names {
    base: PathBuf,
    /// Those that were open.
    open: BTreeMap<FilePath, Key>,
}

impl Names {
    /// The file of a path.
    pub fn key(&self, path: &FilePath) -> Key {
        self.open.get(path).cloned().unwrap_or_else(|| Key::File(self.base.join(path.as_str())))
    }
}

impl World {
    /// Around a document, or a file that may be opened.
    pub fn around(view: &View, key: &Key) -> World {
        let Some(file) = key.path() else { return World::alone(view, key) };
        let (base, whole) = view.base(file);
        let disk = Disk::below(&base).ok();
        let plainly = |file: &Path| FilePath::root("").join(file.strip_prefix(&base).ok()?.to_str()?).ok();
        // A folder that has vanished cannot be looked at, and still has a name.
        let place =
            |file: &Path| disk.as_ref().and_then(|disk| disk.path_of(file).ok()).or_else(|| plainly(file));
        let open = |(key, document): (&Key, &Arc<Document>)| {
            Some((place(key.path()?)?, (key.clone(), document.clone())))
        };
        let mut open: BTreeMap<_, _> = view.documents.iter().filter_map(open).collect();
        let name = || file.file_name().map_or("scene.rt".into(), |name| name.to_string_lossy());
        let own = place(file).unwrap_or_else(|| FilePath::root(&name()));
        // Whatever its path is: what is open is no other file, nor another name of it that is open too.
        open.extend(view.documents.get(key).map(|document| (own.clone(), (key.clone(), document.clone()))));
        let folder = own.as_str().rfind('/').map_or("", |at| &own.as_str()[..=at]);
        World {
            within: if whole { String::new() } else { folder.into() },
            names: Names {
                base,
                open: open.iter().map(|(path, (key, _))| (path.clone(), key.clone())).collect(),
            },
            disk,
            open: open.into_iter().map(|(path, (_, document))| (path, document)).collect(),
            own,
            asked: Mutex::default(),
            memory: view.session.memory.clone(),
        }
    }

    /// Around a document that is no file: there is nothing but it.
    fn alone(view: &View, key: &Key) -> World {
        let uri = key.uri();
        let own = FilePath::root(uri.as_ref().rsplit([':', '/']).next().unwrap_or("scene.rt"));
        let document = view.documents.get(key);
        World {
            names: Names { base: PathBuf::new(), open: BTreeMap::from([(own.clone(), key.clone())]) },
            disk: None,
            open: document.map(|document| (own.clone(), document.clone())).into_iter().collect(),
            own,
            within: String::new(),
            asked: Mutex::default(),
            memory: view.session.memory.clone(),
        }
    }

    /// The document's own text. What it holds is not UTF-8 where it cannot be read.
    pub fn source(&self) -> Result<Source, FileError> {
        let text = match self.open.get(&self.own) {
            Some(document) => document.text.whole().to_string(),
            None => {
                let bytes = self.read(&self.own, MOST_TEXT)?;
                String::from_utf8(bytes.to_vec()).map_err(|_| FileError::Unreadable("is no text".into()))?
            }
        };
        Ok(Source::new(self.name(&self.own), text).at(self.own.clone()))
    }

    /// What the paths mean.
    pub fn names(&self) -> &Names {
        &self.names
    }

    /// Every file that was asked for.
    pub fn asked(&self) -> BTreeSet<Key> {
        self.asked.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

impl Files for World {
    fn read(&self, path: &FilePath, most: usize) -> Result<Arc<[u8]>, FileError> {
        if !path.as_str().starts_with(&self.within) {
            return Err(FileError::Outside);
        }
        self.asked.lock().unwrap_or_else(PoisonError::into_inner).insert(self.names.key(path));
        match (self.open.get(path), &self.disk) {
            (Some(document), _) => match document.kept {
                Kept::TooLong => Err(FileError::TooLarge(MOST_TEXT)),
                Kept::Lost => Err(FileError::Unreadable("is open in an editor, and not known".into())),
                Kept::Whole if document.text.whole().len() > most => Err(FileError::TooLarge(most)),
                Kept::Whole => Ok(document.text.whole().as_bytes().into()),
            },
            (None, Some(disk)) => disk.read(path, most),
            // Nothing is beside a text that is no file.
            (None, None) if self.names.base.as_os_str().is_empty() => {
                Err(FileError::Unreadable("this text has no folder yet; save it first".into()))
            }
            (None, None) => Err(FileError::Missing),
        }
    }

    fn list(&self, folder: &str) -> Vec<String> {
        // A folder that leads to one that may be read is named, and nothing else in it.
        let may = |name: &String| {
            let path = if folder.is_empty() { name.clone() } else { format!("{folder}/{name}") };
            path.starts_with(&self.within) || (name.ends_with('/') && self.within.starts_with(&path))
        };
        let listed = self.disk.as_ref().map(|disk| disk.list(folder)).unwrap_or_default();
        listed.into_iter().filter(may).collect()
    }

    fn memory(&self) -> Option<&Memory> {
        Some(&self.memory)
    }

    fn name(&self, path: &FilePath) -> String {
        match self.names.key(path) {
            Key::File(path) => path.display().to_string(),
            Key::Other(uri) => uri,
        }
    }
}
