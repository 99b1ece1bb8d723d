//! Edits that make one text of another, and edits of several documents.

use super::analyst::{range, uri};
use super::document::{Encoding, Text};
use super::documents::Key;
use super::view::View;
use gen_lsp_types as lsp;
use rt_lang::ide;
use std::collections::BTreeMap;

/// The edits that make one text of another.
pub fn between(before: &Text, after: &str, encoding: Encoding) -> Vec<lsp::TextEdit> {
    let edits = ide::differences(before.whole(), after).into_iter();
    edits.map(|(bytes, new_text)| lsp::TextEdit { range: range(before, bytes, encoding), new_text }).collect()
}

/// Edits of several files, for a client that takes versions or one that does not.
pub fn workspace(edits: BTreeMap<Key, Vec<lsp::TextEdit>>, view: &View) -> lsp::WorkspaceEdit {
    let mut all = lsp::WorkspaceEdit::default();
    if view.session.client.document_changes {
        let change = |(key, edits): (Key, Vec<lsp::TextEdit>)| {
            let version = view.documents.get(&key).map(|document| document.version);
            let text_document_identifier = lsp::TextDocumentIdentifier { uri: uri(view, &key) };
            lsp::DocumentChange::TextDocumentEdit(lsp::TextDocumentEdit {
                text_document: lsp::OptionalVersionedTextDocumentIdentifier {
                    version,
                    text_document_identifier,
                },
                edits: edits.into_iter().map(lsp::Edit::TextEdit).collect(),
            })
        };
        all.document_changes = Some(edits.into_iter().map(change).collect());
    } else {
        all.changes = Some(edits.into_iter().map(|(key, edits)| (uri(view, &key), edits)).collect());
    }
    all
}
