//! Mends that need no thought, and warnings that are expected.

use super::walk::{Piece, whole};
use super::{Analysis, Edit, Fix, Location};
use crate::diagnostic::{Diagnostic, Severity};
use crate::span::Span;
use std::ops::Range;

/// What can be mended in a part of the text, and the warnings there that can be allowed: first what is certain, then what is
/// to be chosen from.
pub(super) fn fixes(analysis: &Analysis, range: Range<usize>) -> Vec<Fix> {
    let touches = |span: Span| {
        span.source == analysis.main && span.range().start <= range.end && range.start <= span.range().end
    };
    let near = |diagnostic: &Diagnostic| {
        let edits = diagnostic.fix.iter().flat_map(|fix| fix.edits.iter().map(|(span, _)| *span));
        touches(diagnostic.primary.span) || edits.into_iter().any(touches)
    };
    let here = || analysis.diagnostics.iter().enumerate().filter(|(_, diagnostic)| near(diagnostic));
    let mends = here().filter_map(|(index, diagnostic)| mend(analysis, index, diagnostic));
    let offers = here().flat_map(|(index, diagnostic)| {
        diagnostic.offers.iter().filter_map(move |offer| {
            Some(Fix {
                title: sentence(&offer.title),
                diagnostic: index,
                edits: edits(analysis, &offer.fix)?,
                mends: false,
            })
        })
    });
    let allowed = here().filter_map(|(index, diagnostic)| allow(analysis, index, diagnostic));
    mends.chain(offers).chain(allowed).collect()
}

/// The edit that a diagnostic offers.
fn mend(analysis: &Analysis, index: usize, diagnostic: &Diagnostic) -> Option<Fix> {
    let fix = diagnostic.fix.as_ref().filter(|fix| !fix.edits.is_empty())?;
    let title = match &diagnostic.help {
        Some(help) => sentence(help),
        None => format!("Mend: {}", diagnostic.message),
    };
    Some(Fix { title, diagnostic: index, edits: edits(analysis, fix)?, mends: true })
}

/// Edits by the paths of their files.
fn edits(analysis: &Analysis, fix: &crate::diagnostic::Fix) -> Option<Vec<Edit>> {
    let edit =
        |(span, text): &(Span, String)| Some(Edit { at: analysis.location(*span)?, text: text.clone() });
    fix.edits.iter().map(edit).collect()
}

/// What a help line asks for, as the name of a command.
fn sentence(help: &str) -> String {
    let asked = help.strip_prefix("did you mean ").and_then(|rest| rest.strip_suffix('?'));
    let help = asked.map_or(help.to_string(), |name| format!("change to {name}"));
    let mut letters = help.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

/// `@allow` before the innermost statement around a warning. What is found in the finished picture cannot be seen here.
fn allow(analysis: &Analysis, index: usize, diagnostic: &Diagnostic) -> Option<Fix> {
    let code = diagnostic.code;
    // An `@allow` that allows nothing is no better with another one.
    if code.severity() != Severity::Warning || code == crate::diagnostic::Code::W0105 {
        return None;
    }
    let place = diagnostic.primary.span;
    let mut around: Option<Span> = None;
    analysis.walk(place.source, place.range(), &mut |piece| {
        if let Piece::Statement(statement) = piece
            && statement.span.contains(place)
        {
            around = Some(whole(statement));
        }
    });
    let at = analysis.location(around?.before())?;
    let text = format!("@allow({}, \"…\") ", code.name());
    let title = format!("Allow this here: `@allow({})`", code.name());
    Some(Fix { title, diagnostic: index, edits: vec![Edit { at, text }], mends: false })
}

impl Analysis {
    /// A place by the path of its file; none of what is no file, such as a setting.
    pub(super) fn location(&self, span: Span) -> Option<Location> {
        let source = self.files().find(|(id, _)| *id == span.source).map(|(_, source)| source)?;
        source.text.get(span.range())?;
        Some(Location { path: source.path.clone(), range: span.range() })
    }
}
