//! Lines that can be hidden, and ranges that grow.

use super::super::work::{Answer, Asked};
use gen_lsp_types as lsp;
use rt_lang::ide::{Fold, FoldKind};
use rt_lang::span::Span;

/// The lines of a document that can be hidden.
pub fn folds(asked: &mut Asked, params: lsp::FoldingRangeParams) -> Answer<Option<Vec<lsp::FoldingRange>>> {
    let meaning = asked.meaning(&params.text_document.uri)?;
    let fold = |fold: Fold| {
        let range = meaning.range(fold.span);
        lsp::FoldingRange {
            start_line: range.start.line,
            start_character: Some(range.start.character),
            end_line: range.end.line,
            end_character: Some(range.end.character),
            kind: match fold.kind {
                FoldKind::Body => None,
                FoldKind::Comment => Some(lsp::FoldingRangeKind::Comment),
                FoldKind::Imports => Some(lsp::FoldingRangeKind::Imports),
            },
            collapsed_text: None,
        }
    };
    Ok(Some(meaning.analysis.folds().into_iter().map(fold).collect()))
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
