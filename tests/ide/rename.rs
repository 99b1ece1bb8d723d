//! A renaming changes names and nothing else: the scene stays the same.

use crate::folder::Folder;
use rt_lang::files::{FileError, FilePath, Files};
use rt_lang::ide::{self, Edit};
use rt_lang::source::{Source, Sources};
use rt_lang::{Options, analyse, compile};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A folder in which some files are edited.
struct Edited<'f> {
    folder: &'f Folder,
    texts: BTreeMap<FilePath, String>,
}

impl Files for Edited<'_> {
    fn read(&self, path: &FilePath, most: usize) -> Result<Arc<[u8]>, FileError> {
        match self.texts.get(path) {
            Some(text) => Ok(text.as_bytes().into()),
            None => self.folder.read(path, most),
        }
    }
}

/// Makes edits, which are in order and do not overlap.
fn apply(folder: &Folder, main: &Source, edits: &[Edit]) -> BTreeMap<FilePath, String> {
    let mut texts = BTreeMap::from([(main.path.clone(), main.text.clone())]);
    for edit in edits.iter().rev() {
        let text = texts.entry(edit.at.path.clone()).or_insert_with(|| {
            String::from_utf8(folder.read(&edit.at.path, usize::MAX).unwrap().to_vec()).unwrap()
        });
        text.replace_range(edit.at.range.clone(), &edit.text);
    }
    texts
}

/// The hash of the scene, and the codes of what is said of it.
fn meaning(files: &dyn Files, path: &FilePath, text: &str) -> (Option<blake3::Hash>, Vec<&'static str>) {
    let mut sources = Sources::default();
    let id = sources.add(Source::new("main.rt", text).at(path.clone()));
    let compiled = compile(files, &mut sources, id, &Options::default());
    let codes = compiled.diagnostics.iter().map(|diagnostic| diagnostic.code.as_str()).collect();
    (compiled.scene.map(|scene| scene.hash()), codes)
}

/// The scenes whose names are all changed, one after the other.
fn scenes() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folders = ["examples", "examples/report", "examples/garden", "tests/cases/ide", "tests/cases/expand"];
    let mut found: Vec<PathBuf> = folders
        .iter()
        .flat_map(|folder| std::fs::read_dir(root.join(folder)).unwrap())
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "rt"))
        .collect();
    found.sort();
    found
}

#[test]
fn a_renamed_scene_is_the_same() {
    let (mut renamed, mut refused) = (0, 0);
    for path in scenes() {
        let folder = Folder::of(&path);
        let text = std::fs::read_to_string(&path).unwrap();
        let (text, _) = super::marks(&text);
        let name = FilePath::root(path.file_name().unwrap().to_str().unwrap());
        let source = Source::new("main.rt", text.as_str()).at(name.clone());
        let (hash, codes) = meaning(&folder, &name, &text);
        if hash.is_none() {
            continue;
        }
        let analysis = analyse(&folder, source.clone(), &Options::default(), &|| false).unwrap();
        let named = |at: usize| match analysis.renamable(at) {
            Some(Ok(span)) => Some(analysis.sources.text(span).to_string()),
            _ => None,
        };
        let tokens = analysis.tokens(0..text.len());
        let names: BTreeSet<String> =
            tokens.iter().filter_map(|token| named(token.span.range().start)).collect();
        let mut seen = BTreeSet::new();
        for token in tokens {
            let at = token.span.range().start;
            let Some(name_here) = named(at) else { continue };
            let edits = ide::rename(&[], &analysis, at, "another_name").unwrap();
            if !seen.insert(edits.clone()) {
                continue;
            }
            // A name that is in use is refused, or means nothing else there.
            let taken = names.range(format!("{name_here}\0")..).next().or(names.first()).unwrap();
            let taken = match *taken == name_here {
                true => None,
                false => Some(ide::rename(&[], &analysis, at, taken)),
            };
            refused += usize::from(matches!(taken, Some(Err(_))));
            for edits in std::iter::once(edits).chain(taken.and_then(Result::ok)) {
                let texts = apply(&folder, &source, &edits);
                let edited = Edited { folder: &folder, texts };
                let again = meaning(&edited, &name, &edited.texts[&name]);
                assert_eq!(again, (hash, codes.clone()), "{}: {:?}", path.display(), edits);
                renamed += 1;
            }
        }
    }
    assert!(renamed > 60 && refused > 20, "{renamed} names were changed, {refused} refused");
}
