//! The files that a document may read: open documents first, then what is saved.
//!
//! Paths are told from the folder of the workspace, so that one path means one file to all its scenes; what a scene may
//! read lies below its own folder, as on the command line, unless a root was given.

use super::documents::{Document, Kept, Key, MOST_TEXT};
use super::view::View;
use crate::cli::files::{Disk, real_path};
use crate::cli::live::watcher::names;
use rt_lang::files::{FileError, FilePath, Files, Memory};
use rt_lang::source::Source;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// What there is to be read around one document.
pub struct World {
    /// The folder from which paths are told.
    base: PathBuf,
    /// None where nothing is saved: the document has no folder, or it has vanished.
    disk: Option<Disk>,
    open: BTreeMap<FilePath, Open>,
    /// The same by where their files are, without links.
    real: BTreeMap<PathBuf, Open>,
    /// The document itself.
    own: FilePath,
    /// What the paths begin with that it may read.
    within: String,
    /// The files that were asked for.
    asked: Mutex<BTreeMap<FilePath, Key>>,
    memory: Arc<Memory>,
}

/// A document that is open.
type Open = (Key, Arc<Document>);

/// What the paths of an analysis mean.
#[derive(Clone, Debug)]
pub struct Names {
    base: PathBuf,
    /// Those that were open, or asked for.
    known: BTreeMap<FilePath, Key>,
}

impl Names {
    /// The file of a path.
    pub fn key(&self, path: &FilePath) -> Key {
        self.known.get(path).cloned().unwrap_or_else(|| Key::File(self.base.join(path.as_str())))
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
        let mut open: BTreeMap<FilePath, Open> = BTreeMap::new();
        // Each by its path without links, then by the path that the client has: what is called so is no other.
        for place in [&place as &dyn Fn(&Path) -> Option<FilePath>, &plainly] {
            let placed = |(key, document): (&Key, &Arc<Document>)| {
                Some((place(key.path()?)?, (key.clone(), document.clone())))
            };
            open.extend(view.documents.iter().filter_map(placed));
        }
        let root = base.canonicalize().unwrap_or_else(|_| base.clone());
        let real = view.documents.iter().filter_map(|(key, document)| {
            let real = real_path(key.path()?).filter(|real| real.starts_with(&root))?;
            Some((real, (key.clone(), document.clone())))
        });
        let real = real.collect();
        let name = || file.file_name().map_or("scene.rt".into(), |name| name.to_string_lossy());
        let own = place(file).unwrap_or_else(|| FilePath::root(&name()));
        // Whatever its path is: what is open is no other file, nor another name of it that is open too.
        open.extend(view.documents.get(key).map(|document| (own.clone(), (key.clone(), document.clone()))));
        let folder = own.as_str().rfind('/').map_or("", |at| &own.as_str()[..=at]);
        World {
            within: if whole { String::new() } else { folder.into() },
            base,
            disk,
            open,
            real,
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
            base: PathBuf::new(),
            disk: None,
            open: document
                .map(|document| (own.clone(), (key.clone(), document.clone())))
                .into_iter()
                .collect(),
            real: BTreeMap::new(),
            own,
            within: String::new(),
            asked: Mutex::default(),
            memory: view.session.memory.clone(),
        }
    }

    /// The document's own text. What it holds is not UTF-8 where it cannot be read.
    pub fn source(&self) -> Result<Source, FileError> {
        let text = match self.open.get(&self.own) {
            Some((_, document)) => document.text.whole().to_string(),
            None => {
                let bytes = self.read(&self.own, MOST_TEXT)?;
                String::from_utf8(bytes.to_vec()).map_err(|_| FileError::Unreadable("is no text".into()))?
            }
        };
        Ok(Source::new(self.name(&self.own), text).at(self.own.clone()))
    }

    /// What the paths mean.
    pub fn names(&self) -> Names {
        let open = self.open.iter().map(|(path, (key, _))| (path.clone(), key.clone()));
        let known = open.chain(self.lock().clone()).collect();
        Names { base: self.base.clone(), known }
    }

    /// Every file that was asked for, by all paths by which it is reached.
    pub fn asked(&self) -> BTreeSet<Key> {
        let asked = self.lock();
        let reached = asked.iter().flat_map(|(path, key)| {
            let paths = names(&self.base.join(path.as_str())).into_iter();
            paths.map(Key::File).chain([key.clone()])
        });
        reached.collect()
    }

    /// The document that is open at a path, also where a link leads to it.
    fn open_at(&self, path: &FilePath) -> Option<&Open> {
        let linked = || self.real.get(&real_path(&self.base.join(path.as_str()))?);
        self.open.get(path).or_else(linked)
    }

    fn key(&self, path: &FilePath) -> Key {
        let saved = || Key::File(self.base.join(path.as_str()));
        self.open_at(path).map_or_else(saved, |(key, _)| key.clone())
    }

    fn lock(&self) -> MutexGuard<'_, BTreeMap<FilePath, Key>> {
        // An entry is whole or not there.
        self.asked.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Files for World {
    fn read(&self, path: &FilePath, most: usize) -> Result<Arc<[u8]>, FileError> {
        if !path.as_str().starts_with(&self.within) {
            return Err(FileError::Outside);
        }
        let key = self.key(path);
        self.lock().insert(path.clone(), key);
        match (self.open_at(path), &self.disk) {
            (Some((_, document)), _) => match document.kept {
                Kept::TooLong | Kept::TooMuch => Err(FileError::TooLarge(MOST_TEXT)),
                Kept::Lost => Err(FileError::Unreadable("is open in an editor, and not known".into())),
                Kept::Whole if document.text.whole().len() > most => Err(FileError::TooLarge(most)),
                Kept::Whole => Ok(document.text.whole().as_bytes().into()),
            },
            (None, Some(disk)) => disk.read(path, most),
            // Nothing is beside a text that is no file.
            (None, None) if self.base.as_os_str().is_empty() => {
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
        let saved = self.disk.as_ref().map(|disk| disk.list(folder)).unwrap_or_default();
        // What is open may not be saved yet; it is named by its file, and by the folder it will be in.
        let open = self.open.keys().filter_map(|path| {
            let inner = match folder {
                "" => path.as_str(),
                folder => path.as_str().strip_prefix(folder)?.strip_prefix('/')?,
            };
            Some(inner.split_inclusive('/').next()?.to_string())
        });
        let listed: BTreeSet<String> = saved.into_iter().chain(open).filter(may).collect();
        listed.into_iter().collect()
    }

    fn memory(&self) -> Option<&Memory> {
        Some(&self.memory)
    }

    fn name(&self, path: &FilePath) -> String {
        match self.key(path) {
            Key::File(path) => path.display().to_string(),
            Key::Other(uri) => uri,
        }
    }
}
