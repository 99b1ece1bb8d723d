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

/// The one edit that makes one text of another, and touches no more of it than it must.
pub fn least(before: &Text, after: &str, encoding: Encoding) -> lsp::TextEdit {
    let text = before.whole();
    let same = |(a, b): &(u8, u8)| a == b;
    // A line end of two signs is not torn.
    let tears =
        |at: usize| text.as_bytes()[..at].ends_with(b"\r") && text.as_bytes()[at..].starts_with(b"\n");
    let head = text.bytes().zip(after.bytes()).take_while(same).count();
    let head = text.floor_char_boundary(head);
    let head = head - usize::from(tears(head));
    let tail = text[head..].bytes().rev().zip(after[head..].bytes().rev()).take_while(same).count();
    let end = text.ceil_char_boundary(text.len() - tail);
    let end = end + usize::from(tears(end));
    let new_text = after[head..after.len() - (text.len() - end)].to_string();
    lsp::TextEdit { range: range(before, head..end, encoding), new_text }
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
    use crate::cli::lsp::documents::place;

    #[test]
    fn one_edit_is_enough_and_tears_nothing() {
        for (before, after, with) in [
            ("a = 3\nb", "a = 12\nb", "12"),
            ("", "ä", "ä"),
            ("aa", "a", ""),
            ("a", "aa", "a"),
            ("é = 1", "è = 1", "è"),
            // The first bytes, or the last, of two characters are the same.
            ("😀!", "😁!", "😁"),
            ("\u{120}", "\u{220}", "\u{220}"),
            ("a\r\nb", "a\rb", "\r"),
            ("a\r\nb", "a\nb", "\n"),
            ("a\r\nb", "ab", ""),
            ("same", "same", ""),
        ] {
            for encoding in [Encoding::Utf8, Encoding::Utf16, Encoding::Utf32] {
                let mut text = Text::new(before.into());
                let lsp::TextEdit { range, new_text } = least(&text, after, encoding);
                let [start, end] = [range.start, range.end].map(|at| text.byte(place(at), encoding));
                text.replace(start..end, &new_text);
                assert_eq!((text.whole().as_str(), new_text.as_str()), (after, with), "{before:?}");
            }
        }
    }
}
