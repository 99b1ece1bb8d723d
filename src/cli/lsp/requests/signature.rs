//! What the call around the cursor takes.

use super::super::client::Client;
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
        signatures: found.into_iter().map(|found| signature(found, &session.client)).collect(),
        active_signature: Some(0),
        active_parameter: None,
    };
    Ok(Some(found).filter(|found| !found.is_empty()).map(help))
}

/// Where none of the parameters is being written, none is to be marked. `null` says so, to a client that knows it; an index
/// that is left out or not there is 0 by the protocol, so another client is told of none, which are shown in the label all
/// the same.
fn signature(signature: Signature, client: &Client) -> lsp::SignatureInformation {
    let Signature { label, doc, parameters, active } = signature;
    // Counted in UTF-16 whatever else is agreed on.
    let units = |byte: usize| label[..label.floor_char_boundary(byte)].encode_utf16().count() as u32;
    let parameter = |parameter: &ide::Parameter| lsp::ParameterInformation {
        label: lsp::ParameterInformationLabel::Tuple((
            units(parameter.range.start),
            units(parameter.range.end),
        )),
        documentation: documentation(&parameter.doc, client.markdown_calls),
    };
    let is_told = active.is_some() || client.marks_none;
    lsp::SignatureInformation {
        documentation: documentation(&doc, client.markdown_calls),
        parameters: is_told.then(|| parameters.iter().map(parameter).collect()),
        active_parameter: is_told
            .then(|| active.map_or(lsp::ActiveParameter::Null, |active| (active as u32).into())),
        label,
    }
}

fn documentation(text: &str, markdown: bool) -> Option<lsp::Documentation> {
    let kind = if markdown { lsp::MarkupKind::Markdown } else { lsp::MarkupKind::PlainText };
    let markup = lsp::MarkupContent { kind, value: text.into() };
    (!text.is_empty()).then_some(lsp::Documentation::MarkupContent(markup))
}
