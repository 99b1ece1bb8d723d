//! What the call around the cursor takes.

use super::super::documents::{Key, place};
use super::super::work::{Answer, Asked, Failure};
use super::super::world::World;
use gen_lsp_types as lsp;
use rt_lang::ide::{self, Signature};

/// The ways to call what is being called at a place.
pub fn signatures(asked: &mut Asked, params: lsp::SignatureHelpParams) -> Answer<Option<lsp::SignatureHelp>> {
    let lsp::TextDocumentPositionParams { text_document, position } = params.text_document_position_params;
    let document = asked.document(&text_document.uri)?;
    let session = &asked.view.session;
    let at = document.text.byte(place(position), session.encoding);
    let world = World::around(asked.view, &Key::of(&text_document.uri));
    let source = world.source().map_err(|_| Failure::plain("the document cannot be read"))?;
    let stop = || asked.spoilt(&document).is_some();
    let found = ide::signatures(&world, &source, at, &session.options().limits, &stop);
    if let Some(failure) = asked.spoilt(&document) {
        return Err(failure);
    }
    let help = |found: Vec<Signature>| lsp::SignatureHelp {
        signatures: found.into_iter().map(|found| signature(found, session.client.markdown_calls)).collect(),
        active_signature: Some(0),
        active_parameter: None,
    };
    Ok(Some(found).filter(|found| !found.is_empty()).map(help))
}

fn signature(signature: Signature, markdown: bool) -> lsp::SignatureInformation {
    let Signature { label, doc, parameters, active } = signature;
    // Counted in UTF-16 whatever else is agreed on.
    let units = |byte: usize| label[..label.floor_char_boundary(byte)].encode_utf16().count() as u32;
    let parameter = |parameter: &ide::Parameter| lsp::ParameterInformation {
        label: lsp::ParameterInformationLabel::Tuple((
            units(parameter.range.start),
            units(parameter.range.end),
        )),
        documentation: documentation(&parameter.doc, markdown),
    };
    lsp::SignatureInformation {
        documentation: documentation(&doc, markdown),
        parameters: Some(parameters.iter().map(parameter).collect()),
        // One that is not there marks none.
        active_parameter: Some(lsp::ActiveParameter::Int(active.unwrap_or(parameters.len()) as u32)),
        label,
    }
}

fn documentation(text: &str, markdown: bool) -> Option<lsp::Documentation> {
    let kind = if markdown { lsp::MarkupKind::Markdown } else { lsp::MarkupKind::PlainText };
    let markup = lsp::MarkupContent { kind, value: text.into() };
    (!text.is_empty()).then_some(lsp::Documentation::MarkupContent(markup))
}
