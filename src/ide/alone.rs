//! What is said of a text only as long as it is a scene of its own.

use super::Analysis;
use crate::check::{Home, Type};
use crate::diagnostic::{Code, Diagnostic};
use crate::span::Span;
use std::collections::BTreeSet;

/// Which diagnostics do not hold where another text imports the one of which they are said, by their indices.
pub(super) fn alone(analysis: &Analysis) -> BTreeSet<usize> {
    // Whoever imports a file may use what it declares; what it imports itself it does for itself.
    let files = analysis.study.notes.scopes.iter().filter(|scope| scope.place == Home::File);
    let names = files.flat_map(|file| &file.names).filter(|(.., ty)| !matches!(ty, Type::File(_)));
    let declared: BTreeSet<Span> = names.map(|(_, place, _)| *place).collect();
    let is_alone = |diagnostic: &Diagnostic| {
        let span = diagnostic.primary.span;
        match diagnostic.code {
            // That of the file as a whole: others have a place.
            Code::E0302 => span.source == analysis.main && span.range() == (0..0),
            Code::W0106 => declared.contains(&span),
            _ => false,
        }
    };
    let all = analysis.diagnostics.iter().enumerate();
    all.filter(|(_, diagnostic)| is_alone(diagnostic)).map(|(index, _)| index).collect()
}
