//! Colours, and other ways to write them.

use super::super::work::{Answer, Asked};
use gen_lsp_types as lsp;
use rt_lang::ide::Colour;

/// The colours that are written in a document.
pub fn colours(asked: &mut Asked, params: lsp::DocumentColorParams) -> Answer<Vec<lsp::ColorInformation>> {
    let uri = &params.text_document.uri;
    let (document, meaning) = (asked.document(uri)?, asked.meaning(uri)?);
    let found = meaning.analysis.colours(&|| asked.spoilt(&document).is_some());
    let colour = |colour: Colour| {
        let [red, green, blue] = colour.value.map(|x| x.clamp(0.0, 1.0) as f32);
        lsp::ColorInformation {
            range: meaning.range(colour.span),
            color: lsp::Color { red, green, blue, alpha: 1.0 },
        }
    };
    asked.spoilt(&document).map_or_else(|| Ok(found.into_iter().map(colour).collect()), Err)
}

/// The ways to write a colour in place of another.
pub fn present(
    asked: &mut Asked,
    params: lsp::ColorPresentationParams,
) -> Answer<Vec<lsp::ColorPresentation>> {
    let meaning = asked.meaning(&params.text_document.uri)?;
    let bytes = meaning.bytes(params.range);
    let lsp::Color { red, green, blue, .. } = params.color;
    let way = |text: String| lsp::ColorPresentation {
        text_edit: Some(lsp::TextEdit { range: meaning.own_range(bytes.clone()), new_text: text.clone() }),
        label: text,
        additional_text_edits: None,
    };
    let ways = meaning.analysis.present(bytes.clone(), [red, green, blue].map(f64::from));
    Ok(ways.into_iter().map(way).collect())
}
