//! What is different between two texts, and edits of several documents.

use super::analyst::{range, uri};
use super::document::{Encoding, Text};
use super::documents::Key;
use super::view::View;
use gen_lsp_types as lsp;
use similar::{Algorithm, DiffOp, capture_diff_slices_deadline};
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

/// How long is looked for what two texts have in common; a coarser edit is as good.
const PATIENCE: Duration = Duration::from_millis(200);

/// The edits of whole lines that make one text of another: where nothing changes, cursors and folds stay.
pub fn between(before: &Text, after: &str, encoding: Encoding) -> Vec<lsp::TextEdit> {
    let old: Vec<&str> = before.whole().split_inclusive('\n').collect();
    let new: Vec<&str> = after.split_inclusive('\n').collect();
    let deadline = Some(Instant::now() + PATIENCE);
    let starts = |lines: &[&str]| {
        let ends = lines.iter().scan(0, |at, line| {
            *at += line.len();
            Some(*at)
        });
        std::iter::once(0).chain(ends).collect::<Vec<usize>>()
    };
    let (old_starts, new_starts) = (starts(&old), starts(&new));
    let edit = |op: DiffOp| {
        let (lines, others) = (op.old_range(), op.new_range());
        let bytes = old_starts[lines.start]..old_starts[lines.end];
        let text = &after[new_starts[others.start]..new_starts[others.end]];
        lsp::TextEdit { range: range(before, bytes, encoding), new_text: text.into() }
    };
    let ops = capture_diff_slices_deadline(Algorithm::Myers, &old, &new, deadline);
    ops.into_iter().filter(|op| !matches!(op, DiffOp::Equal { .. })).map(edit).collect()
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

#[cfg(test)]
mod tests {
    use super::*;

    fn applied(before: &str, edits: &[lsp::TextEdit]) -> String {
        let mut text = Text::new(before.into());
        for edit in edits.iter().rev() {
            let byte = |at| text.byte(super::super::documents::place(at), Encoding::Utf16);
            let range = byte(edit.range.start)..byte(edit.range.end);
            text.replace(range, &edit.new_text);
        }
        text.whole().to_string()
    }

    #[test]
    fn edits_make_one_text_of_another() {
        let texts = ["", "a\n", "a\nb\nc\n", "a\r\nb\rc\n", "b\nc", "a\n😀\nc\nd\n", "\n\n", "x"];
        for (before, after) in texts.iter().flat_map(|a| texts.iter().map(move |b| (a, b))) {
            let edits = between(&Text::new((*before).into()), after, Encoding::Utf16);
            assert_eq!(applied(before, &edits), **after, "{before:?} {after:?}");
            assert!(before != after || edits.is_empty());
        }
        let edits = between(&Text::new("a\nb\nc\n".into()), "a\nx\nc\n", Encoding::Utf16);
        assert_eq!((edits.len(), edits[0].new_text.as_str()), (1, "x\n"));
    }
}
