//! Lines that can be hidden, and ranges that grow.

use super::super::work::{Answer, Asked};
use gen_lsp_types as lsp;
use rt_lang::ide::{Fold, FoldKind};
use rt_lang::span::Span;

/// The lines of a document that can be hidden.
pub fn folds(asked: &mut Asked, params: lsp::FoldingRangeParams) -> Answer<Option<Vec<lsp::FoldingRange>>> {
    let meaning = asked.meaning(&params.text_document.uri)?;
    let by_line = asked.view.session.client.folds_lines;
    let fold = |fold: Fold| {
        let lsp::Range { start, mut end } = meaning.range(fold.span);
        // Who hides whole lines is not to hide what goes on behind it, such as an `else`.
        if by_line && goes_on(meaning.text(fold.span.source).whole(), fold.span.range().end) {
            end.line -= 1;
        }
        (start.line < end.line).then_some(lsp::FoldingRange {
            start_line: start.line,
            start_character: Some(start.character).filter(|_| !by_line),
            end_line: end.line,
            end_character: Some(end.character).filter(|_| !by_line),
            kind: match fold.kind {
                FoldKind::Body => None,
                FoldKind::Comment => Some(lsp::FoldingRangeKind::Comment),
                FoldKind::Imports => Some(lsp::FoldingRangeKind::Imports),
            },
            collapsed_text: None,
        })
    };
    Ok(Some(meaning.analysis.folds().into_iter().filter_map(fold).collect()))
}

/// Whether something is written on a line behind a byte.
fn goes_on(text: &str, byte: usize) -> bool {
    text[byte..].lines().next().is_some_and(|rest| !rest.trim().is_empty())
}

/// The ranges around each of some places.
pub fn selections(
    asked: &mut Asked,
    params: lsp::SelectionRangeParams,
) -> Answer<Option<Vec<lsp::SelectionRange>>> {
    let meaning = asked.meaning(&params.text_document.uri)?;
    let nested = |position: lsp::Position| {
        let around = |parent: Option<Box<lsp::SelectionRange>>, span: &Span| {
            Some(Box::new(lsp::SelectionRange { range: meaning.range(*span), parent }))
        };
        let spans = meaning.analysis.selection(meaning.byte(position));
        // An answer is wanted for every place.
        let none =
            || lsp::SelectionRange { range: lsp::Range { start: position, end: position }, parent: None };
        spans.iter().rev().fold(None, around).map_or_else(none, |range| *range)
    };
    Ok(Some(params.positions.into_iter().map(nested).collect()))
}
