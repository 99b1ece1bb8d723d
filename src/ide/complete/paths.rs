//! The paths of files.

use super::{List, Rank};
use crate::files::{FilePath, Files};
use crate::ide::{CompletionKind, Insert};
use crate::source::Source;

/// What `import` takes in.
const LANGUAGE: &[&str] = &["rt"];

/// What is laid on, shown as the sky or read as a mesh or table.
const CONTENT: &[&str] = &["png", "jpg", "jpeg", "webp", "hdr", "exr", "ply", "obj", "csv"];

impl List<'_> {
    /// What the folder holds that the path names so far.
    pub(super) fn paths(&mut self, files: &dyn Files, source: &Source, language: bool) {
        let written = &source.text[self.cursor.word.clone()];
        let (folder, _) = written.rsplit_once('/').map_or(("", written), |(folder, name)| (folder, name));
        let begun = if folder.is_empty() { String::new() } else { format!("{folder}/") };
        // A file there is as good as any to say which folder is meant.
        let Ok(within) = source.path.join(&format!("{begun}x")) else { return };
        let folder = within.as_str().rsplit_once('/').map_or("", |(folder, _)| folder);
        for name in files.list(folder) {
            let (kind, rank) = match name.strip_suffix('/') {
                Some(_) => (CompletionKind::Folder, Rank::Rather),
                None => {
                    let ending = name.rsplit_once('.').map_or("", |(_, ending)| ending).to_ascii_lowercase();
                    let fits = if language { LANGUAGE } else { CONTENT };
                    if !fits.contains(&ending.as_str()) || is_itself(source, folder, &name) {
                        continue;
                    }
                    (CompletionKind::File, Rank::Fits)
                }
            };
            let text = format!("{begun}{name}");
            self.push(&text, kind, rank).insert = Insert { text: text.clone(), holes: vec![] };
        }
    }
}

/// Whether a file is the one that names it.
fn is_itself(source: &Source, folder: &str, name: &str) -> bool {
    let path = if folder.is_empty() {
        FilePath::root(name)
    } else {
        FilePath::root("x").join(&format!("{folder}/{name}")).unwrap_or(FilePath::root(name))
    };
    path == source.path
}
