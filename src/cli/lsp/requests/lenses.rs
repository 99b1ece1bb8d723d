//! What can be done with the picture of a document, above the lines it belongs to.

use super::super::commands::{PREVIEW, RENDER};
use super::super::work::{Answer, Asked};
use gen_lsp_types as lsp;
use rt_lang::ide::{Lens, LensAction};
use serde_json::json;

/// What can be done where.
pub fn lenses(asked: &mut Asked, params: lsp::CodeLensParams) -> Answer<Option<Vec<lsp::CodeLens>>> {
    let uri = params.text_document.uri;
    let meaning = asked.meaning(&uri)?;
    let lens = |lens: Lens| {
        let (name, command) = match lens.action {
            LensAction::Preview => ("preview", PREVIEW),
            LensAction::Render => ("render", RENDER),
        };
        let title = match &lens.camera {
            Some(camera) => format!("{name} {camera}"),
            None => name.into(),
        };
        let arguments = Some(vec![json!({ "uri": uri, "camera": lens.camera })]);
        let command = lsp::Command { title, command: command.into(), arguments, ..lsp::Command::default() };
        lsp::CodeLens { range: meaning.range(lens.span.before()), command: Some(command), data: None }
    };
    Ok(Some(meaning.analysis.lenses().into_iter().map(lens).collect()))
}
