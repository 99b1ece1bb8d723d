//! Laying out.

use super::super::documents::Kept;
use super::super::edits::between;
use super::super::work::{Answer, Asked, Failure};
use gen_lsp_types as lsp;
use rt_lang::span::SourceId;
use rt_lang::syntax;

/// The edits that lay out a document as `rtc fmt` does.
pub fn whole(asked: &mut Asked, params: lsp::DocumentFormattingParams) -> Answer<Option<Vec<lsp::TextEdit>>> {
    let document = asked.document(&params.text_document.uri)?;
    if document.kept != Kept::Whole {
        return Err(Failure::plain("the text of the document is not known: close it and open it again"));
    }
    let (formatted, _) = syntax::format(SourceId(0), document.text.whole());
    if let Some(failure) = asked.spoilt(&document) {
        return Err(failure);
    }
    Ok(Some(between(&document.text, &formatted, asked.view.session.encoding)))
}

/// The edits that lay out a part of it.
pub fn part(
    asked: &mut Asked,
    params: lsp::DocumentRangeFormattingParams,
) -> Answer<Option<Vec<lsp::TextEdit>>> {
    let meaning = asked.meaning(&params.text_document.uri)?;
    let edits = meaning.analysis.format(meaning.bytes(params.range));
    let edit = |edit: rt_lang::ide::Edit| lsp::TextEdit {
        range: meaning.own_range(edit.at.range),
        new_text: edit.text,
    };
    Ok(Some(edits.into_iter().map(edit).collect()))
}
