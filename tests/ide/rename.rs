//! A renaming changes names and nothing else: the scene stays the same.

use crate::folder::Folder;
use rt_lang::files::{FileError, FilePath, Files};
use rt_lang::ide::{self, Edit, TokenKind};
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

/// What is given the name of something else is refused, or means what it meant.
#[test]
fn a_name_that_is_taken_is_refused() {
    let (mut refused, mut renamed) = (0, 0);
    for path in scenes() {
        let folder = Folder::of(&path);
        let (text, _) = super::marks(&std::fs::read_to_string(&path).unwrap());
        let name = FilePath::root(path.file_name().unwrap().to_str().unwrap());
        let source = Source::new("main.rt", text.as_str()).at(name.clone());
        let before = meaning(&folder, &name, &text);
        if before.0.is_none() {
            continue;
        }
        let analysis = analyse(&folder, source.clone(), &Options::default(), &|| false).unwrap();
        let all = analysis.tokens(0..text.len(), &|| false);
        let declared: Vec<_> = all.iter().filter(|token| token.declaration).collect();
        let named = |index: usize| &text[declared[index % declared.len()].span.range()];
        for (index, token) in declared.iter().enumerate() {
            let at = token.span.range().start;
            for other in
                [named(index + 1), named(index + 7)].into_iter().filter(|other| *other != named(index))
            {
                match ide::rename(&[], &analysis, at, other) {
                    Err(_) => refused += 1,
                    Ok(edits) => {
                        let edited = Edited { folder: &folder, texts: apply(&folder, &source, &edits) };
                        let after = meaning(&edited, &name, &edited.texts[&name]);
                        assert_eq!(after, before, "{}: {edits:?}", path.display());
                        renamed += 1;
                    }
                }
            }
        }
    }
    assert!(refused > 100 && renamed > 5, "{refused} were refused, {renamed} made");
}

#[test]
fn a_renamed_scene_is_the_same() {
    let mut renamed = 0;
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
        let mut seen = BTreeSet::new();
        for token in analysis.tokens(0..text.len(), &|| false) {
            let at = token.span.range().start;
            let Some(Ok(_)) = analysis.renamable(at) else { continue };
            let edits = ide::rename(&[], &analysis, at, "another_name").unwrap();
            if !seen.insert(edits.clone()) {
                continue;
            }
            let texts = apply(&folder, &source, &edits);
            let edited = Edited { folder: &folder, texts };
            let again = meaning(&edited, &name, &edited.texts[&name]);
            assert_eq!(again, (hash, codes.clone()), "{}: {:?}", path.display(), edits);
            renamed += 1;
        }
    }
    assert!(renamed > 60, "{renamed} names were changed");
}

/// What is not understood uses names all the same: of a file that is not there, of a kind that nobody knows.
#[test]
fn a_scene_that_is_mended_later_is_the_same() {
    let (mut refused, mut renamed) = (0, 0);
    for path in scenes() {
        let folder = Folder::of(&path);
        let (text, _) = super::marks(&std::fs::read_to_string(&path).unwrap());
        let name = FilePath::root(path.file_name().unwrap().to_str().unwrap());
        let before = meaning(&folder, &name, &text);
        if before.0.is_none() {
            continue;
        }
        let source = |text: &str| Source::new("main.rt", text).at(name.clone());
        let analysis = analyse(&folder, source(&text), &Options::default(), &|| false).unwrap();
        let kinds = analysis.tokens(0..text.len(), &|| false).into_iter();
        let kinds = kinds.filter(|token| token.kind == TokenKind::Kind).map(|token| token.span.range());
        let files = text.match_indices("import \"").map(|(at, found)| at + found.len()..at + found.len());
        for (index, slip) in kinds.chain(files).enumerate() {
            let mut broken = text.clone();
            broken.replace_range(slip.clone(), "never_heard_of");
            let source = source(&broken);
            let analysis = analyse(&folder, source.clone(), &Options::default(), &|| false).unwrap();
            let names = analysis.tokens(0..broken.len(), &|| false).into_iter();
            let names: Vec<usize> =
                names.filter(|token| token.declaration).map(|token| token.span.range().start).collect();
            let Some(at) = names.get(index % names.len().max(1)) else { continue };
            match ide::rename(&[], &analysis, *at, "another_name") {
                Err(_) => refused += 1,
                Ok(edits) => {
                    let mut texts = apply(&folder, &source, &edits);
                    let mended = texts[&name].replace("never_heard_of", &text[slip.clone()]);
                    texts.insert(name.clone(), mended);
                    let edited = Edited { folder: &folder, texts };
                    let after = meaning(&edited, &name, &edited.texts[&name]);
                    assert_eq!(after, before, "{} {slip:?}: {edits:?}", path.display());
                    renamed += 1;
                }
            }
        }
    }
    assert!(renamed > 10 * refused, "{refused} were refused, {renamed} made");
}
