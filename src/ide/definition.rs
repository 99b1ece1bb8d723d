//! Where names are declared.

use super::hover::statement_of;
use super::{Analysis, Definition};
use crate::check::{Meaning, Type};
use crate::files::FilePath;
use crate::span::Span;

/// Where what is named at a byte is declared. From the name of an imported file, and from its path, it leads into that file.
pub(super) fn definition(analysis: &Analysis, at: usize) -> Option<Definition> {
    if let Some((from, path)) = analysis.path_at(at) {
        return file(analysis, from, &path);
    }
    let (from, name) = declaration(analysis, at)?;
    if from == name
        && let Some(Type::File(_)) = analysis.study.notes.declared(name)
        && let Some(path) = analysis.import_path(name)
    {
        return file(analysis, from, &path);
    }
    let whole = statement_of(analysis, name).unwrap_or(name);
    Some(Definition { from, name, whole })
}

/// What is named at a byte, and the name that declares it.
pub(super) fn declaration(analysis: &Analysis, at: usize) -> Option<(Span, Span)> {
    match analysis.named(at)? {
        (from, Meaning::Declared(name)) => Some((from, name)),
        _ => None,
    }
}

/// The beginning of a file of the language.
fn file(analysis: &Analysis, from: Span, path: &FilePath) -> Option<Definition> {
    let (id, source) = analysis.source_at(path)?;
    let whole = Span::new(id, 0, source.text.len());
    Some(Definition { from, name: whole.before(), whole })
}
