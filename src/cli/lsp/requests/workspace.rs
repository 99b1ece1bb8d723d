//! The scenes of a workspace that are not open, as far as somebody asks for them.

use super::super::analyst::Meaning;
use super::super::documents::{Key, MOST_TEXT};
use super::super::work::{Answer, Asked, Failure};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The most entries of folders that are looked at.
const MOST_ENTRIES: usize = 50_000;
/// The most scenes that are found.
const MOST_SCENES: usize = 2_000;
/// The deepest folder.
pub const DEPTH: usize = 12;

/// Scenes in a folder and so far below it, by path, and whether these are all. Hidden folders and those of other tools are
/// left out, and links are not followed.
pub fn scenes(folder: &Path, most_depth: usize) -> (BTreeSet<PathBuf>, bool) {
    let mut found = BTreeSet::new();
    let mut left = MOST_ENTRIES;
    let mut folders = vec![(folder.to_path_buf(), 0)];
    while let Some((folder, depth)) = folders.pop() {
        // One that vanishes holds nothing.
        for entry in fs::read_dir(&folder).into_iter().flatten().flatten() {
            if left == 0 || found.len() == MOST_SCENES {
                return (found, false);
            }
            left -= 1;
            let name = entry.file_name();
            let name = name.to_string_lossy();
            let Ok(kind) = entry.file_type() else { continue };
            let foreign = name.starts_with('.') || ["target", "node_modules"].contains(&&*name);
            if kind.is_dir() && !foreign && depth < most_depth {
                folders.push((entry.path(), depth + 1));
            } else if kind.is_file() && name.ends_with(".rt") {
                found.insert(entry.path());
            }
        }
    }
    (found, true)
}

/// Scenes that may be made of a file, and whether these are all: each reads what lies below its own folder, or below a root
/// that was given.
fn around(home: &Path, base: &Path, whole: bool) -> (BTreeSet<PathBuf>, bool) {
    if whole {
        return scenes(base, DEPTH);
    }
    let folders = home.ancestors().skip(1).take_while(|folder| folder.starts_with(base));
    folders.map(|folder| scenes(folder, 0)).fold(
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

/// What other scenes mean that are made of the file in which what stands at a byte is declared, or of the document itself;
/// and whether all scenes were looked at.
pub fn users(asked: &mut Asked, meaning: &Meaning, at: usize) -> Answer<(Vec<Arc<Meaning>>, bool)> {
    let own = meaning.key(meaning.analysis.main);
    let declared = meaning.analysis.definition(at).map(|found| found.name);
    let name = declared.map_or("", |name| meaning.analysis.sources.text(name)).to_string();
    let home = declared.map_or_else(|| own.clone(), |name| meaning.key(name.source));
    let Some(file) = own.path() else { return Ok((vec![], true)) };
    let (base, whole) = asked.view.base(file);
    let (saved, all) = around(home.path().unwrap_or(file), &base, whole);
    let saved = saved.into_iter().map(Key::File);
    let open = asked.view.documents.iter().map(|(key, _)| key.clone());
    let same_base = |key: &Key| key.path().is_some_and(|path| asked.view.base(path).0 == base);
    let candidates: BTreeSet<Key> = saved.chain(open).filter(|key| *key != own && same_base(key)).collect();
    let mut users = vec![];
    for key in candidates {
        if asked.is_cancelled() {
            return Err(Failure::cancelled());
        }
        let found = match asked.view.documents.get(&key) {
            Some(_) => asked.meaning_of(&key).transpose()?,
            None => find_saved(asked, &key, &home, &name),
        };
        users.extend(found.filter(|found| key == home || found.reads.contains(&home)));
    }
    Ok((users, all))
}

/// What a scene means that is not open, if it may use a name of another file.
fn find_saved(asked: &Asked, key: &Key, home: &Key, name: &str) -> Option<Arc<Meaning>> {
    let text = text_of(key.path()?)?;
    let may = text.contains(name) && (key == home || text.contains("import"));
    let stop = || asked.is_cancelled();
    may.then(|| Meaning::find(asked.view, key, &stop)).flatten().map(Arc::new)
}
