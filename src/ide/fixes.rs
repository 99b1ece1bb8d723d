//! Mends that need no thought, and warnings that are expected.

use super::walk::{Piece, whole};
use super::{Analysis, Edit, Fix, Location};
use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::span::Span;
use std::ops::Range;

/// What can be mended in a part of the text, and the warnings there that can be allowed: first what is certain, then what is
/// to be chosen from.
pub(super) fn fixes(analysis: &Analysis, range: Range<usize>) -> Vec<Fix> {
    let touches = |span: Span| {
        span.source == analysis.main && span.range().start <= range.end && range.start <= span.range().end
    };
    let near = |diagnostic: &Diagnostic| {
        let mut edits = diagnostic.fix.iter().flat_map(|fix| fix.edits.iter().map(|(span, _)| *span));
        places(diagnostic).any(touches) || edits.any(touches)
    };
    let here = || analysis.diagnostics.iter().enumerate().filter(|(_, diagnostic)| near(diagnostic));
    let mends = here().filter_map(|(index, diagnostic)| mend(analysis, index, diagnostic));
    let offers = here().flat_map(|(index, diagnostic)| {
        diagnostic.offers.iter().filter_map(move |offer| {
            Some(Fix {
                title: title(analysis, &offer.title, &offer.fix),
                diagnostic: index,
                edits: edits(analysis, &offer.fix)?,
                mends: false,
            })
        })
    });
    let allowed = here().filter_map(|(index, diagnostic)| {
        let place = places(diagnostic).find(|place| touches(*place)).unwrap_or(diagnostic.primary.span);
        allow(analysis, index, diagnostic.code, place)
    });
    mends.chain(offers).chain(allowed).collect()
}

/// All places that a diagnostic is about: its own first.
fn places(diagnostic: &Diagnostic) -> impl Iterator<Item = Span> {
    let labels = diagnostic.labels.iter().map(|label| label.span);
    let uses = diagnostic.uses.iter().map(|used| used.span);
    std::iter::once(diagnostic.primary.span).chain(labels).chain(uses)
}

/// The edit that a diagnostic offers.
fn mend(analysis: &Analysis, index: usize, diagnostic: &Diagnostic) -> Option<Fix> {
    let fix = diagnostic.fix.as_ref().filter(|fix| !fix.edits.is_empty())?;
    let title = match &diagnostic.help {
        Some(help) => title(analysis, help, fix),
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

/// What a help line asks for, as the name of a command. Where one name is put in place of another, both are said.
fn title(analysis: &Analysis, help: &str, fix: &crate::diagnostic::Fix) -> String {
    let asks = help.starts_with("did you mean ") || help.starts_with("replace it with ");
    if let [(span, new)] = &*fix.edits
        && asks
    {
        return format!("Replace `{}` with `{new}`", analysis.sources.text(*span));
    }
    let mut letters = help.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

/// `@allow` before the innermost statement around one of the places that a warning is about, any of which will do. What is found
/// in the finished picture cannot be seen here.
fn allow(analysis: &Analysis, index: usize, code: Code, place: Span) -> Option<Fix> {
    // An `@allow` that allows nothing is no better with another one.
    if code.severity() != Severity::Warning || code == Code::W0105 {
        return None;
    }
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
