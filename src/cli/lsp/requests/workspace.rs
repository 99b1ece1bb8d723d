//! The scenes of a workspace that are not open, as far as somebody asks for them.

use super::super::analyst::Meaning;
use super::super::documents::{Key, MOST_TEXT};
use super::super::view::View;
use super::super::work::{Answer, Asked, Failure};
use gen_lsp_types as lsp;
use rt_lang::ide::{self, Analysis};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The most entries of folders that are looked at.
const MOST_ENTRIES: usize = 50_000;
/// The most scenes that are found.
const MOST_SCENES: usize = 2_000;
/// The deepest folder.
const DEPTH: usize = 12;

/// Scenes in a folder and below it, by path, and whether these are all. Hidden folders and those of other tools are left out,
/// but for those that lead to `home`, and links are not followed.
pub fn scenes(folder: &Path, home: &Path) -> (BTreeSet<PathBuf>, bool) {
    list(folder, Some(home))
}

/// Scenes in a folder, and below it where somebody says what is at home there.
fn list(folder: &Path, home: Option<&Path>) -> (BTreeSet<PathBuf>, bool) {
    let (mut found, mut all) = (BTreeSet::new(), true);
    let mut left = MOST_ENTRIES;
    let mut folders = vec![(folder.to_path_buf(), 0)];
    while let Some((folder, depth)) = folders.pop() {
        // One that vanishes holds nothing.
        for entry in fs::read_dir(&folder).into_iter().flatten().flatten() {
            if left == 0 || found.len() == MOST_SCENES {
                return (found, false);
            }
            left -= 1;
            let (name, path) = (entry.file_name(), entry.path());
            let name = name.to_string_lossy();
            let Ok(kind) = entry.file_type() else { continue };
            let foreign = name.starts_with('.') || ["target", "node_modules"].contains(&&*name);
            let enters = |home: &Path| !foreign || home.starts_with(&path);
            if kind.is_dir() && home.is_some_and(enters) {
                match depth < DEPTH {
                    true => folders.push((path, depth + 1)),
                    false => all = false,
                }
            } else if kind.is_file() && name.ends_with(".rt") {
                found.insert(path);
            }
        }
    }
    (found, all)
}

/// Scenes that may be made of a file, and whether these are all: each reads what lies below its own folder, or below a root
/// that was given.
fn around(home: &Path, base: &Path, whole: bool) -> (BTreeSet<PathBuf>, bool) {
    if whole {
        return scenes(base, home);
    }
    let folders = home.ancestors().skip(1).take_while(|folder| folder.starts_with(base));
    folders.map(|folder| list(folder, None)).fold(
        (BTreeSet::new(), true),
        |(mut found, all), (more, complete)| {
            found.extend(more);
            (found, all && complete)
        },
    )
}

/// The text of a scene; none where it has none, or too much.
pub fn text_of(path: &Path) -> Option<String> {
    let fits = fs::metadata(path).is_ok_and(|metadata| metadata.len() <= MOST_TEXT as u64);
    if fits { fs::read_to_string(path).ok() } else { None }
}

/// Who uses what is declared in a file.
pub struct Users {
    /// The document in which somebody asks.
    pub own: Arc<Meaning>,
    /// Other scenes that are made of that file.
    pub others: Vec<Arc<Meaning>>,
    /// Whether all scenes were looked at that may be.
    pub complete: bool,
}

impl Users {
    /// What they all mean. Paths in them mean the same files.
    pub fn analyses(&self) -> Vec<&Analysis> {
        std::iter::once(&self.own).chain(&self.others).map(|meaning| &meaning.analysis).collect()
    }

    /// Where bytes of a file are that one of them is made of.
    pub fn locate(&self, place: &ide::Location) -> Option<(Key, lsp::Range)> {
        std::iter::once(&self.own).chain(&self.others).find_map(|meaning| meaning.place(place))
    }
}

/// Who uses what is declared that stands at a byte of a document, or else the document itself.
pub fn users(asked: &mut Asked, meaning: &Arc<Meaning>, at: usize) -> Answer<Users> {
    let own = meaning.key(meaning.analysis.main);
    let mut users = Users { own: meaning.clone(), others: vec![], complete: true };
    // What is declared nowhere is looked for in the document alone.
    let Some((file, declared)) = own.path().zip(meaning.analysis.declaration(at)) else { return Ok(users) };
    let name = meaning.analysis.sources.text(declared).to_string();
    let home = meaning.key(declared.source);
    let mut readers = open_readers(asked, &own, &home)?;
    let view = together(asked.view, readers.iter().map(|(key, _)| key).chain([&own]));
    let (base, whole) = view.base(file);
    if view.folders.len() != asked.view.folders.len() {
        // Their paths were told from different folders.
        users.own = again(asked, &view, &own)?;
        for (key, reader) in &mut readers {
            *reader = again(asked, &view, key)?;
            users.complete &= key.path().is_some_and(|path| view.base(path).0 == base);
        }
    }
    users.others.extend(readers.into_iter().map(|(_, reader)| reader));
    let (saved, all) = around(home.path().unwrap_or(file), &base, whole);
    users.complete &= all;
    for key in saved.into_iter().map(Key::File).filter(|key| view.documents.get(key).is_none()) {
        if let Some(failure) = asked.view.documents.get(&own).and_then(|document| asked.spoilt(document)) {
            return Err(failure);
        }
        let found = find_saved(asked, &view, &key, &home, &name);
        users.others.extend(found.filter(|found| key == home || found.reads.contains(&home)));
    }
    Ok(users)
}

/// The other open documents that are made of a file, or are that file.
fn open_readers(asked: &mut Asked, own: &Key, home: &Key) -> Answer<Vec<(Key, Arc<Meaning>)>> {
    let open: Vec<Key> = asked.view.documents.iter().map(|(key, _)| key.clone()).collect();
    let mut readers = vec![];
    for key in open.into_iter().filter(|key| key != own) {
        let Some(found) = asked.meaning_of(&key).transpose()? else { continue };
        if key == *home || found.reads.contains(home) {
            readers.push((key, found));
        }
    }
    Ok(readers)
}

/// The same with one folder from which the paths of all of these are told: the outermost that one of them has. The others lie in
/// it, since all that read one file lie in or above its folder.
fn together<'k>(view: &Arc<View>, keys: impl Iterator<Item = &'k Key>) -> Arc<View> {
    let bases: BTreeSet<PathBuf> = keys.filter_map(Key::path).map(|path| view.base(path).0).collect();
    match bases.iter().min_by_key(|base| base.components().count()) {
        Some(outermost) if bases.len() > 1 => {
            let mut view = view.clone();
            Arc::make_mut(&mut view).folders.push(outermost.clone());
            view
        }
        _ => view.clone(),
    }
}

/// What an open document means where paths are told from another folder.
fn again(asked: &Asked, view: &Arc<View>, key: &Key) -> Answer<Arc<Meaning>> {
    Meaning::find(view, key, &|| asked.is_cancelled()).map(Arc::new).ok_or_else(Failure::cancelled)
}

/// What a scene means that is not open, if it may use a name of another file.
fn find_saved(asked: &Asked, view: &Arc<View>, key: &Key, home: &Key, name: &str) -> Option<Arc<Meaning>> {
    let text = text_of(key.path()?)?;
    let may = text.contains(name) && (key == home || text.contains("import"));
    let stop = || asked.is_cancelled();
    may.then(|| Meaning::find(view, key, &stop)).flatten().map(Arc::new)
}
