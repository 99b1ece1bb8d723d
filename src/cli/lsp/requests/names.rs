//! Names: where they are declared, who uses them, and giving them others.

use super::super::analyst::{Meaning, uri};
use super::super::documents::{Kept, Key};
use super::super::edits;
use super::super::work::{Answer, Asked, Failure};
use super::workspace::users;
use gen_lsp_types as lsp;
use rt_lang::ide;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Where what is named at a place is declared.
pub fn definition(
    asked: &mut Asked,
    params: lsp::DefinitionParams,
) -> Answer<Option<lsp::DefinitionResponse>> {
    let (meaning, at) = place(asked, params.text_document_position_params)?;
    let Some(found) = meaning.analysis.definition(at) else { return Ok(None) };
    let target = meaning.location(found.name, asked.view);
    if !asked.view.session.client.links {
        return Ok(Some(lsp::DefinitionResponse::Definition(lsp::Definition::Location(target))));
    }
    let link = lsp::LocationLink {
        origin_selection_range: Some(meaning.range(found.from)),
        target_uri: target.uri,
        target_range: meaning.range(found.whole),
        target_selection_range: target.range,
    };
    Ok(Some(lsp::DefinitionResponse::DefinitionLinkList(vec![link])))
}

/// Every use of what is named at a place.
pub fn references(asked: &mut Asked, params: lsp::ReferenceParams) -> Answer<Option<Vec<lsp::Location>>> {
    let (meaning, at) = place(asked, params.text_document_position_params)?;
    let users = users(asked, &meaning, at)?;
    let found =
        ide::references(&users.analyses(), &users.own.analysis, at, params.context.include_declaration);
    let located: BTreeSet<(Key, [u32; 4])> =
        found.iter().filter_map(|place| users.locate(place)).map(sortable).collect();
    let location = |(key, [a, b, c, d]): (Key, [u32; 4])| lsp::Location {
        uri: uri(asked.view, &key),
        range: lsp::Range {
            start: lsp::Position { line: a, character: b },
            end: lsp::Position { line: c, character: d },
        },
    };
    Ok(Some(located.into_iter().map(location).collect()))
}

/// The uses of it in the document.
pub fn highlight(
    asked: &mut Asked,
    params: lsp::DocumentHighlightParams,
) -> Answer<Option<Vec<lsp::DocumentHighlight>>> {
    let (meaning, at) = place(asked, params.text_document_position_params)?;
    let found = ide::references(&[&meaning.analysis], &meaning.analysis, at, true);
    let own = &meaning.analysis.source().path;
    let here = found.into_iter().filter(|place| place.path == *own);
    let highlight = |place: ide::Location| lsp::DocumentHighlight {
        range: meaning.own_range(place.range),
        kind: Some(lsp::DocumentHighlightKind::Text),
    };
    Ok(Some(here.map(highlight).collect()))
}

/// What would be renamed.
pub fn prepare(
    asked: &mut Asked,
    params: lsp::PrepareRenameParams,
) -> Answer<Option<lsp::PrepareRenameResult>> {
    let (meaning, at) = place(asked, params.text_document_position_params)?;
    let Some(name) = meaning.analysis.renamable(at) else { return Ok(None) };
    let span = name.map_err(Failure::plain)?;
    let placeholder = meaning.analysis.sources.text(span).to_string();
    Ok(Some(lsp::PrepareRenameResult::PrepareRenamePlaceholder(lsp::PrepareRenamePlaceholder {
        range: meaning.range(span),
        placeholder,
    })))
}

/// The edits that give it another name.
pub fn rename(asked: &mut Asked, params: lsp::RenameParams) -> Answer<Option<lsp::WorkspaceEdit>> {
    let (meaning, at) = place(asked, params.text_document_position_params)?;
    let users = users(asked, &meaning, at)?;
    if !users.complete {
        return Err(Failure::plain("the workspace has too many files to find all uses"));
    }
    if asked.view.documents.iter().any(|(_, document)| document.kept != Kept::Whole) {
        return Err(Failure::plain(
            "a document is open whose text is not known, with uses that nobody finds",
        ));
    }
    let edits = ide::rename(&users.analyses(), &users.own.analysis, at, &params.new_name);
    let edits = edits.map_err(Failure::plain)?;
    let mut by_file: BTreeMap<Key, Vec<lsp::TextEdit>> = BTreeMap::new();
    for edit in edits {
        let place = users.locate(&edit.at);
        let (key, range) = place.ok_or_else(|| Failure::plain("a file that uses it cannot be read"))?;
        by_file.entry(key).or_default().push(lsp::TextEdit { range, new_text: edit.text });
    }
    Ok(Some(edits::workspace(by_file, asked.view)))
}

fn place(asked: &mut Asked, params: lsp::TextDocumentPositionParams) -> Answer<(Arc<Meaning>, usize)> {
    let meaning = asked.meaning(&params.text_document.uri)?;
    let at = meaning.byte(params.position);
    Ok((meaning, at))
}

fn sortable((key, range): (Key, lsp::Range)) -> (Key, [u32; 4]) {
    (key, [range.start.line, range.start.character, range.end.line, range.end.character])
}
