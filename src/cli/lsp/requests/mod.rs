//! The questions of the protocol, each to a question of the language.

mod actions;
mod colours;
mod complete;
mod folds;
mod format;
mod hints;
mod hover;
mod lenses;
mod links;
mod names;
mod signature;
mod symbols;
pub mod tokens;
mod workspace;

use super::work::{Answer, Asked, Failure};
use gen_lsp_types as lsp;
use lsp::LspRequestMethod as Method;
use lsp_server::ErrorCode;
use serde_json::Value;

/// Who answers a question.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lane {
    /// It can be told from the text.
    Text,
    /// It takes to know what the text means.
    Meaning,
}

/// Answers a question.
pub type Run = fn(&mut Asked, Value) -> Answer<Value>;

/// Who answers a request, and how; none for one that is not known.
pub fn find(method: &str) -> Option<(Lane, Run)> {
    use Lane::{Meaning, Text};
    Some(match Method::from(method) {
        Method::TextDocumentCompletion => {
            (Text, |asked, params| run::<lsp::CompletionRequest>(asked, params, complete::complete))
        }
        Method::TextDocumentSignatureHelp => {
            (Text, |asked, params| run::<lsp::SignatureHelpRequest>(asked, params, signature::signatures))
        }
        Method::TextDocumentFormatting => {
            (Text, |asked, params| run::<lsp::DocumentFormattingRequest>(asked, params, format::whole))
        }
        Method::TextDocumentRangeFormatting => {
            (Meaning, |asked, params| run::<lsp::DocumentRangeFormattingRequest>(asked, params, format::part))
        }
        Method::TextDocumentHover => {
            (Meaning, |asked, params| run::<lsp::HoverRequest>(asked, params, hover::hover))
        }
        Method::TextDocumentDefinition => {
            (Meaning, |asked, params| run::<lsp::DefinitionRequest>(asked, params, names::definition))
        }
        Method::TextDocumentReferences => {
            (Meaning, |asked, params| run::<lsp::ReferencesRequest>(asked, params, names::references))
        }
        Method::TextDocumentDocumentHighlight => {
            (Meaning, |asked, params| run::<lsp::DocumentHighlightRequest>(asked, params, names::highlight))
        }
        Method::TextDocumentPrepareRename => {
            (Meaning, |asked, params| run::<lsp::PrepareRenameRequest>(asked, params, names::prepare))
        }
        Method::TextDocumentRename => {
            (Meaning, |asked, params| run::<lsp::RenameRequest>(asked, params, names::rename))
        }
        Method::TextDocumentDocumentSymbol => {
            (Meaning, |asked, params| run::<lsp::DocumentSymbolRequest>(asked, params, symbols::document))
        }
        Method::WorkspaceSymbol => {
            (Text, |asked, params| run::<lsp::WorkspaceSymbolRequest>(asked, params, symbols::workspace))
        }
        Method::TextDocumentFoldingRange => {
            (Meaning, |asked, params| run::<lsp::FoldingRangeRequest>(asked, params, folds::folds))
        }
        Method::TextDocumentSelectionRange => {
            (Meaning, |asked, params| run::<lsp::SelectionRangeRequest>(asked, params, folds::selections))
        }
        Method::TextDocumentSemanticTokensFull => {
            (Meaning, |asked, params| run::<lsp::SemanticTokensRequest>(asked, params, tokens::full))
        }
        Method::TextDocumentSemanticTokensRange => {
            (Meaning, |asked, params| run::<lsp::SemanticTokensRangeRequest>(asked, params, tokens::part))
        }
        Method::TextDocumentDocumentColor => {
            (Meaning, |asked, params| run::<lsp::DocumentColorRequest>(asked, params, colours::colours))
        }
        Method::TextDocumentColorPresentation => {
            (Meaning, |asked, params| run::<lsp::ColorPresentationRequest>(asked, params, colours::present))
        }
        Method::TextDocumentInlayHint => {
            (Meaning, |asked, params| run::<lsp::InlayHintRequest>(asked, params, hints::hints))
        }
        Method::TextDocumentDocumentLink => {
            (Meaning, |asked, params| run::<lsp::DocumentLinkRequest>(asked, params, links::links))
        }
        Method::TextDocumentCodeAction => {
            (Meaning, |asked, params| run::<lsp::CodeActionRequest>(asked, params, actions::actions))
        }
        Method::TextDocumentCodeLens => {
            (Meaning, |asked, params| run::<lsp::CodeLensRequest>(asked, params, lenses::lenses))
        }
        _ => return None,
    })
}

/// Reads the parameters, answers, and writes the answer.
fn run<R: lsp::Request>(
    asked: &mut Asked,
    params: Value,
    answer: impl Fn(&mut Asked, R::Params) -> Answer<R::Result>,
) -> Answer<Value> {
    let answer = answer(asked, read(params)?)?;
    serde_json::to_value(answer).map_err(|error| Failure::new(ErrorCode::InternalError, error.to_string()))
}

/// Reads parameters.
pub fn read<T: serde::de::DeserializeOwned>(params: Value) -> Answer<T> {
    serde_json::from_value(params).map_err(|error| Failure::new(ErrorCode::InvalidParams, error.to_string()))
}
