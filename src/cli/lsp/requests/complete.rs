//! What can stand where somebody types.

use super::super::analyst::range;
use super::super::client::Client;
use super::super::documents::{Kept, Key, place};
use super::super::work::{Answer, Asked};
use super::super::world::World;
use crate::cli::lsp::work::Failure;
use gen_lsp_types as lsp;
use rt_lang::ide::{self, Completion, CompletionKind, Insert};

/// What can stand at a place.
pub fn complete(asked: &mut Asked, params: lsp::CompletionParams) -> Answer<Option<lsp::CompletionResponse>> {
    let lsp::TextDocumentPositionParams { text_document, position } = params.text_document_position_params;
    let document = asked.document(&text_document.uri)?;
    if document.kept != Kept::Whole {
        // There is no place to put anything.
        return Ok(None);
    }
    let session = &asked.view.session;
    let at = document.text.byte(place(position), session.encoding);
    let world = World::around(asked.view, &Key::of(&text_document.uri));
    let source = world.source().map_err(|_| Failure::plain("the document cannot be read"))?;
    let stop = || asked.spoilt(&document).is_some();
    let found = ide::complete(&world, &source, at, &session.options().limits, &stop);
    if let Some(failure) = asked.spoilt(&document) {
        return Err(failure);
    }
    let item = |(index, completion): (usize, Completion)| {
        let range = range(&document.text, completion.replace.clone(), session.encoding);
        item(completion, index, range, &session.client)
    };
    let items = found.into_iter().enumerate().map(item).collect();
    Ok(Some(lsp::CompletionResponse::CompletionItemList(items)))
}

fn item(completion: Completion, index: usize, range: lsp::Range, client: &Client) -> lsp::CompletionItem {
    let Completion { label, kind, insert, detail, doc, .. } = completion;
    let snippet = client.snippets && !insert.holes.is_empty();
    let new_text = if snippet { snippet_of(&insert) } else { bare(&insert).into() };
    let words = match client.markdown_docs {
        true => lsp::MarkupKind::Markdown,
        false => lsp::MarkupKind::PlainText,
    };
    let markup = |value| lsp::Documentation::MarkupContent(lsp::MarkupContent { kind: words.clone(), value });
    lsp::CompletionItem {
        kind: Some(kind_of(kind)),
        detail: Some(detail).filter(|detail| !detail.is_empty()),
        documentation: Some(doc).filter(|doc| !doc.is_empty()).map(markup),
        // The order of the language, whatever the client would make of it.
        sort_text: Some(format!("{index:05}")),
        filter_text: Some(label.clone()),
        insert_text_format: Some(match snippet {
            true => lsp::InsertTextFormat::Snippet,
            false => lsp::InsertTextFormat::PlainText,
        }),
        text_edit: Some(lsp::CompletionItemTextEdit::TextEdit(lsp::TextEdit { range, new_text })),
        label,
        ..lsp::CompletionItem::default()
    }
}

/// A text up to what is to be filled in, or to the body that holds it: what stands there as an example would otherwise be
/// meant.
fn bare(insert: &Insert) -> &str {
    let Some(hole) = insert.holes.first() else { return &insert.text };
    let start = &insert.text[..hole.start];
    start.find(" {").map_or(start, |body| &start[..body])
}

/// A text with its places to be filled in, as clients write it.
fn snippet_of(insert: &Insert) -> String {
    let escaped = |text: &str| {
        let escape = |c: char| matches!(c, '$' | '}' | '\\').then_some('\\').into_iter().chain([c]);
        text.chars().flat_map(escape).collect::<String>()
    };
    let mut snippet = String::new();
    let mut copied = 0;
    for (index, hole) in insert.holes.iter().enumerate() {
        snippet.push_str(&escaped(&insert.text[copied..hole.start]));
        snippet.push_str(&format!("${{{}:{}}}", index + 1, escaped(&insert.text[hole.clone()])));
        copied = hole.end;
    }
    snippet.push_str(&escaped(&insert.text[copied..]));
    snippet
}

fn kind_of(kind: CompletionKind) -> lsp::CompletionItemKind {
    use lsp::CompletionItemKind as To;
    match kind {
        CompletionKind::Keyword => To::Keyword,
        CompletionKind::Kind => To::Class,
        CompletionKind::Prototype => To::Struct,
        CompletionKind::Field => To::Field,
        CompletionKind::Value | CompletionKind::Thing => To::Variable,
        CompletionKind::Material => To::Constant,
        CompletionKind::Colour => To::Color,
        CompletionKind::Function => To::Function,
        CompletionKind::Word => To::EnumMember,
        CompletionKind::Unit => To::Unit,
        CompletionKind::Type => To::TypeParameter,
        CompletionKind::Module => To::Module,
        CompletionKind::File => To::File,
        CompletionKind::Folder => To::Folder,
        CompletionKind::Code => To::Value,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holes_are_numbered_and_signs_of_snippets_are_escaped() {
        let text = "sphere { radius: 1m } $\\".to_string();
        let holes = std::iter::once(17..19).collect();
        let insert = Insert { holes, text };
        assert_eq!(snippet_of(&insert), "sphere { radius: ${1:1m} \\} \\$\\\\");
        assert_eq!(bare(&insert), "sphere");
        let call = Insert { text: "cos(angle)".into(), holes: std::iter::once(4..9).collect() };
        assert_eq!(bare(&call), "cos(");
    }
}
