//! The files that a text names.

use super::super::analyst::uri;
use super::super::work::{Answer, Asked};
use gen_lsp_types as lsp;
use rt_lang::ide::Link;

/// The files that a document names.
pub fn links(asked: &mut Asked, params: lsp::DocumentLinkParams) -> Answer<Option<Vec<lsp::DocumentLink>>> {
    let meaning = asked.meaning(&params.text_document.uri)?;
    let link = |link: Link| lsp::DocumentLink {
        range: meaning.range(link.span),
        target: Some(uri(asked.view, &meaning.key_at(&link.path))),
        ..lsp::DocumentLink::default()
    };
    Ok(Some(meaning.analysis.links().into_iter().map(link).collect()))
}
