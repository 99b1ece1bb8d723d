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
    if let Some(value) = &hover.value {
        let _ = write!(text, "\n= `{value}`\n");
    }
    if let Some(colour) = hover.colour {
        let hex = ide::hex(colour);
        let _ = match pictures {
            true => write!(text, "\n![{hex}]({}) `{hex}`\n", square(&hex)),
            false => write!(text, "\n■ `{hex}`\n"),
        };
    }
    if !hover.doc.is_empty() {
        let _ = write!(text, "\n{}\n", hover.doc);
    }
    text
}

fn plain(hover: &Hover) -> String {
    let value = hover.value.as_ref().map_or_else(String::new, |value| format!(" = {value}"));
    let doc = if hover.doc.is_empty() { String::new() } else { format!("\n{}", hover.doc) };
    format!("{}{value}{doc}", hover.code)
}

/// The address of a picture of a colour, which holds the picture.
fn square(hex: &str) -> String {
    let fill = hex.replace('#', "%23");
    format!(
        "data:image/svg+xml;utf8,%3Csvg%20xmlns=%22http://www.w3.org/2000/svg%22%20width=%2216%22%20height=%2216%22%3E\
         %3Crect%20width=%2216%22%20height=%2216%22%20fill=%22{fill}%22/%3E%3C/svg%3E"
    )
}
