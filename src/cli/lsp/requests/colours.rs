//! Colours, and other ways to write them.

use super::super::analyst::range;
use super::super::documents::place;
use super::super::work::{Answer, Asked};
use gen_lsp_types as lsp;
use rt_lang::ide::{self, Colour};

/// The colours that are written in a document.
pub fn colours(asked: &mut Asked, params: lsp::DocumentColorParams) -> Answer<Vec<lsp::ColorInformation>> {
    let meaning = asked.meaning(&params.text_document.uri)?;
    let colour = |colour: Colour| {
        let [red, green, blue] = colour.value.map(|x| x.clamp(0.0, 1.0) as f32);
        lsp::ColorInformation {
            range: meaning.range(colour.span),
            color: lsp::Color { red, green, blue, alpha: 1.0 },
        }
    };
    Ok(meaning.analysis.colours().into_iter().map(colour).collect())
}

/// The ways to write a colour in place of another.
pub fn present(
    asked: &mut Asked,
    params: lsp::ColorPresentationParams,
) -> Answer<Vec<lsp::ColorPresentation>> {
    let document = asked.document(&params.text_document.uri)?;
    let encoding = asked.view.session.encoding;
    let byte = |position| document.text.byte(place(position), encoding);
    let (start, end) = (byte(params.range.start), byte(params.range.end));
    let bytes = start..end.max(start);
    let lsp::Color { red, green, blue, .. } = params.color;
    let written = &document.text.whole()[bytes.clone()];
    let way = |text: String| lsp::ColorPresentation {
        text_edit: Some(lsp::TextEdit {
            range: range(&document.text, bytes.clone(), encoding),
            new_text: text.clone(),
        }),
        label: text,
        additional_text_edits: None,
    };
    let ways = ide::present(written, [red, green, blue].map(f64::from));
    Ok(ways.into_iter().map(way).collect())
}
