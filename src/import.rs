//! The files a scene is made of: the one that was named and all it imports, each read and parsed once.

use crate::diagnostic::{Code, Diagnostic};
use crate::files::{FileError, FilePath, Files};
use crate::source::{Source, Sources};
use crate::span::{SourceId, Span};
use crate::syntax::ast::{self, Entry, Name, StatementKind};
use crate::syntax::{self, Remembered};
use std::collections::BTreeMap;

/// So many times the longest source is the most that all imported files have together.
const MAX_IMPORTED: usize = 4;

/// The files of a scene, each behind those it imports: the last is the one that was named.
#[derive(Debug, Default)]
pub struct Imported {
    /// The files.
    pub files: Vec<ImportedFile>,
    /// Slips in their texts, and what is wrong with their imports.
    pub diagnostics: Vec<Diagnostic>,
}

/// One file.
#[derive(Debug)]
pub struct ImportedFile {
    /// Its text.
    pub source: SourceId,
    /// The tree of it.
    pub tree: ast::File,
    /// What its import statements mean: the statement, and an index into [`Imported::files`]. What could not be
    /// read is not there.
    pub imports: BTreeMap<Span, usize>,
}

/// Parses a source, and reads and parses what it imports, at most so many levels deep.
pub fn import(
    files: &dyn Files,
    sources: &mut Sources,
    main: SourceId,
    levels: usize,
    limits: syntax::Limits,
) -> Imported {
    let path = sources.get(main).path.clone();
    let mut importer = Importer {
        files,
        sources,
        levels,
        limits,
        known: BTreeMap::new(),
        open: vec![],
        bytes: 0,
        out: Imported::default(),
    };
    importer.file(main, path);
    importer.out
}

struct Importer<'a> {
    files: &'a dyn Files,
    sources: &'a mut Sources,
    /// The most files that may be open at once.
    levels: usize,
    limits: syntax::Limits,
    /// Files that were looked at; none where one cannot be used.
    known: BTreeMap<FilePath, Option<usize>>,
    /// The files that are being read, outermost first.
    open: Vec<FilePath>,
    bytes: usize,
    out: Imported,
}

impl Importer<'_> {
    fn file(&mut self, source: SourceId, path: FilePath) -> usize {
        let known = self.files.memory().map(|memory| memory.of::<Remembered>());
        let text = &self.sources.get(source).text;
        let (tree, found) = syntax::parse_again(source, text, self.limits, known.as_deref());
        self.out.diagnostics.extend(found);
        self.open.push(path.clone());
        let mut imports = BTreeMap::new();
        for entry in &tree.body.entries {
            if let Entry::Statement(statement) = entry
                && let StatementKind::Import { path: written, .. } = &statement.kind
                && let Some(file) = self.find(&path, written)
            {
                imports.insert(statement.span, file);
            }
        }
        self.open.pop();
        self.out.files.push(ImportedFile { source, tree, imports });
        self.out.files.len() - 1
    }

    /// The file that an import statement names.
    fn find(&mut self, from: &FilePath, written: &Name) -> Option<usize> {
        let path = match from.join(&written.text) {
            Ok(path) => path,
            Err(error) => return self.report(error.diagnostic(&written.text, written.span)),
        };
        if let Some(first) = self.open.iter().position(|open| *open == path) {
            return self.report(errors::cycle(written, &self.open[first..]));
        }
        if let Some(known) = self.known.get(&path) {
            return *known;
        }
        if self.open.len() >= self.levels {
            return self.report(errors::levels(written, self.levels));
        }
        let file = self.read(&path, written);
        self.known.insert(path, file);
        file
    }

    fn read(&mut self, path: &FilePath, written: &Name) -> Option<usize> {
        let most = self.limits.source;
        let bytes = match self.files.read(path, most) {
            Ok(bytes) => bytes,
            Err(error) => return self.report(error.diagnostic(&written.text, written.span)),
        };
        self.bytes += bytes.len();
        if bytes.len() > most || self.bytes > MAX_IMPORTED.saturating_mul(most) {
            return self.report(FileError::TooLarge(most).diagnostic(&written.text, written.span));
        }
        let Ok(text) = std::str::from_utf8(&bytes) else { return self.report(errors::not_text(written)) };
        let source = self.sources.add(Source::new(self.files.name(path), text).at(path.clone()));
        Some(self.file(source, path.clone()))
    }

    fn report(&mut self, diagnostic: Diagnostic) -> Option<usize> {
        self.out.diagnostics.push(diagnostic);
        None
    }
}

mod errors {
    use super::*;

    pub(super) fn not_text(written: &Name) -> Diagnostic {
        Diagnostic::new(Code::E0501, format!("`{}` is not UTF-8 text", written.text), written.span)
            .at("not a scene")
            .help(match written.text.ends_with(".rt") {
                true => "save the file as UTF-8",
                false => "`import` takes in a scene, `file.rt`; a picture is laid on by `image(…)`, and a mesh is a `mesh`",
            })
    }

    pub(super) fn cycle(written: &Name, open: &[FilePath]) -> Diagnostic {
        let mut path: Vec<String> = open.iter().map(|path| format!("`{path}`")).collect();
        path.extend(open.first().map(|path| format!("`{path}`")));
        let message = match open.len() {
            1 => "the file imports itself".to_string(),
            _ => "these files import each other".to_string(),
        };
        Diagnostic::new(Code::E0502, message, written.span)
            .at("closes the cycle")
            .help(format!("break the cycle {}", path.join(" → ")))
    }

    pub(super) fn levels(written: &Name, most: usize) -> Diagnostic {
        Diagnostic::new(Code::E0406, format!("more than {most} levels of imports"), written.span)
            .at("one level too many")
    }
}
