//! What is said of what stands under the pointer.

use crate::cli::lsp::work::{Answer, Asked};
use gen_lsp_types as lsp;
use rt_lang::ide::{self, Hover};
use std::fmt::Write;

/// What is said of a place.
pub fn hover(asked: &mut Asked, params: lsp::HoverParams) -> Answer<Option<lsp::Hover>> {
    let lsp::TextDocumentPositionParams { text_document, position } = params.text_document_position_params;
    let meaning = asked.meaning(&text_document.uri)?;
    let client = &asked.view.session.client;
    let hover = meaning.analysis.hover(meaning.byte(position));
    Ok(hover.map(|hover| {
        let (kind, value) = match client.markdown {
            true => (lsp::MarkupKind::Markdown, markdown(&hover, client.pictures)),
            false => (lsp::MarkupKind::PlainText, plain(&hover)),
        };
        lsp::Hover {
            contents: lsp::Contents::MarkupContent(lsp::MarkupContent { kind, value }),
            range: Some(meaning.range(hover.span)),
        }
    }))
}

fn markdown(hover: &Hover, pictures: bool) -> String {
    let mut text = format!("```rt\n{}\n```\n", hover.code);
    let picture = hover.colour.filter(|_| pictures).map(|colour| {
        let hex = ide::hex(colour);
        format!("![{hex}]({}) ", square(&hex))
    });
    let said = said(hover, "`");
    if picture.is_some() || !said.is_empty() {
        let _ = write!(text, "\n{}{said}\n", picture.unwrap_or_default());
    }
    if !hover.doc.is_empty() {
        let _ = write!(text, "\n{}\n", hover.doc);
    }
    text
}

fn plain(hover: &Hover) -> String {
    let said = said(hover, "");
    let said = if said.is_empty() { said } else { format!(" {said}") };
    let doc = if hover.doc.is_empty() { String::new() } else { format!("\n{}", hover.doc) };
    format!("{}{said}{doc}", hover.code)
}

/// The value, and the colour as it looks, each between quotes; what stands in the code already is not said again.
fn said(hover: &Hover, quote: &str) -> String {
    let value = hover.value.as_ref().map(|value| format!("= {quote}{value}{quote}"));
    let colour = hover.colour.map(ide::hex).filter(|hex| hover.value.as_ref() != Some(hex));
    let colour = colour.filter(|hex| !hover.code.to_ascii_lowercase().contains(hex.as_str()));
    let colour = colour.map(|hex| format!("shown as {quote}{hex}{quote}"));
    value.into_iter().chain(colour).collect::<Vec<_>>().join(", ")
}

/// The address of a picture of a colour, which holds the picture. Its grey edge shows where it lies on its own colour.
fn square(hex: &str) -> String {
    let fill = hex.replace('#', "%23");
    format!(
        "data:image/svg+xml;utf8,%3Csvg%20xmlns=%22http://www.w3.org/2000/svg%22%20width=%2216%22%20height=%2216%22%3E\
         %3Crect%20x=%22.5%22%20y=%22.5%22%20width=%2215%22%20height=%2215%22%20fill=%22{fill}%22%20stroke=%22%23808080%22/%3E\
         %3C/svg%3E"
    )
}
