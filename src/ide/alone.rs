//! What is said of a text only as long as it is a scene of its own.

use super::{Analysis, SymbolKind, symbols};
use crate::diagnostic::{Code, Diagnostic};
use std::collections::BTreeSet;

/// Which diagnostics do not hold where another text imports this one, by their indices.
pub(super) fn alone(analysis: &Analysis) -> BTreeSet<usize> {
    // Whoever imports it may use them; what it imports itself it does for itself.
    let symbols = symbols::symbols(analysis).into_iter().filter(|symbol| symbol.kind != SymbolKind::Module);
    let declared: BTreeSet<usize> = symbols.map(|symbol| symbol.select.range().start).collect();
    let is_alone = |diagnostic: &Diagnostic| {
        let span = diagnostic.primary.span;
        match diagnostic.code {
            _ if span.source != analysis.main => false,
            // That of the file as a whole: others have a place.
            Code::E0302 => span.range() == (0..0),
            Code::W0106 => declared.contains(&span.range().start),
            _ => false,
        }
    };
    let all = analysis.diagnostics.iter().enumerate();
    all.filter(|(_, diagnostic)| is_alone(diagnostic)).map(|(index, _)| index).collect()
}
