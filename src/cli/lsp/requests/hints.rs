//! Remarks between the characters of a text.

use super::super::work::{Answer, Asked};
use gen_lsp_types as lsp;
use rt_lang::ide::Hint;

/// The remarks of a part of a document.
pub fn hints(asked: &mut Asked, params: lsp::InlayHintParams) -> Answer<Option<Vec<lsp::InlayHint>>> {
    let uri = &params.text_document.uri;
    let (document, meaning) = (asked.document(uri)?, asked.meaning(uri)?);
    let hint = |hint: Hint| lsp::InlayHint {
        position: meaning.position(hint.at),
        label: lsp::Label::String(hint.text),
        kind: None,
        text_edits: None,
        tooltip: Some(hint.about).filter(|about| !about.is_empty()).map(lsp::Tooltip::String),
        padding_left: None,
        padding_right: None,
        data: None,
    };
    let stop = || asked.spoilt(&document).is_some();
    let found = meaning.analysis.hints(meaning.bytes(params.range), &stop);
    asked.spoilt(&document).map_or_else(|| Ok(Some(found.into_iter().map(hint).collect())), Err)
}
