//! What texts declare.

use super::super::analyst::{Meaning, range, uri};
use super::super::document::Text;
use super::super::documents::Key;
use super::super::view::View;
use super::super::work::{Answer, Asked, Failure};
use super::workspace::{scenes, text_of};
use gen_lsp_types as lsp;
use rt_lang::ide::{Symbol, SymbolKind, outline};
use rt_lang::source::Source;
use std::collections::BTreeSet;

/// The most symbols of a workspace that are told.
const MOST: usize = 1_000;

/// What a document declares.
pub fn document(
    asked: &mut Asked,
    params: lsp::DocumentSymbolParams,
) -> Answer<Option<lsp::DocumentSymbolResponse>> {
    let uri = params.text_document.uri;
    let meaning = asked.meaning(&uri)?;
    let symbols = meaning.analysis.symbols();
    Ok(Some(match asked.view.session.client.symbol_tree {
        true => {
            let tree = symbols.into_iter().map(|symbol| branch(symbol, &meaning)).collect();
            lsp::DocumentSymbolResponse::DocumentSymbolList(tree)
        }
        false => {
            let mut flat = vec![];
            flatten(&symbols, None, &mut |symbol, container| {
                let location = lsp::Location { uri: uri.clone(), range: meaning.range(symbol.span) };
                flat.push(lsp::SymbolInformation::new(None, location, base(symbol, container)));
            });
            lsp::DocumentSymbolResponse::SymbolInformationList(flat)
        }
    }))
}

fn branch(symbol: Symbol, meaning: &Meaning) -> lsp::DocumentSymbol {
    let children: Vec<_> = symbol.children.into_iter().map(|child| branch(child, meaning)).collect();
    lsp::DocumentSymbol::new(
        // A client refuses one without a name.
        if symbol.name.is_empty() { "?".into() } else { symbol.name },
        Some(symbol.detail).filter(|detail| !detail.is_empty()),
        kind_of(symbol.kind),
        symbol.off.then(|| vec![lsp::SymbolTag::Deprecated]),
        None,
        meaning.range(symbol.span),
        meaning.range(symbol.select),
        Some(children).filter(|children| !children.is_empty()),
    )
}

/// What the scenes of the workspace declare whose names are like what is asked for.
pub fn workspace(
    asked: &mut Asked,
    params: lsp::WorkspaceSymbolParams,
) -> Answer<Option<lsp::WorkspaceSymbolResponse>> {
    let mut found = vec![];
    let encoding = asked.view.session.encoding;
    for key in all_scenes(asked.view) {
        if asked.is_cancelled() {
            return Err(Failure::cancelled());
        }
        let open = asked.view.documents.get(&key).map(|document| document.text.clone());
        let saved = || key.path().and_then(text_of).map(Text::new);
        let Some(text) = open.or_else(saved) else { continue };
        // By its form alone: what hundreds of scenes mean takes long to find out.
        let symbols = outline(&Source::new("", text.whole().as_str()));
        flatten(&symbols, None, &mut |symbol, container| {
            if found.len() < MOST && is_like(&symbol.name, &params.query) {
                let range = range(&text, symbol.select.range(), encoding);
                let location = lsp::Location { uri: uri(asked.view, &key), range };
                found.push(lsp::WorkspaceSymbol {
                    location: lsp::WorkspaceSymbolLocation::Location(location),
                    data: None,
                    base_symbol_information: base(symbol, container),
                });
            }
        });
        if found.len() == MOST {
            break;
        }
    }
    Ok(Some(lsp::WorkspaceSymbolResponse::WorkspaceSymbolList(found)))
}

/// The open scenes, and those of the folders of the workspace.
fn all_scenes(view: &View) -> BTreeSet<Key> {
    let saved = view.folders.iter().flat_map(|folder| scenes(folder, folder).0).map(Key::File);
    view.documents.iter().map(|(key, _)| key.clone()).chain(saved).collect()
}

fn base(symbol: &Symbol, container: Option<&str>) -> lsp::BaseSymbolInformation {
    lsp::BaseSymbolInformation {
        name: symbol.name.clone(),
        kind: kind_of(symbol.kind),
        tags: symbol.off.then(|| vec![lsp::SymbolTag::Deprecated]),
        container_name: container.map(String::from),
    }
}

/// Each symbol with the name of the one around it.
fn flatten(symbols: &[Symbol], container: Option<&str>, take: &mut impl FnMut(&Symbol, Option<&str>)) {
    for symbol in symbols {
        take(symbol, container);
        flatten(&symbol.children, Some(&symbol.name), take);
    }
}

/// Whether a name holds the letters of a query in their order, however they are written.
fn is_like(name: &str, query: &str) -> bool {
    let mut letters = name.chars().flat_map(char::to_lowercase);
    query.chars().flat_map(char::to_lowercase).all(|wanted| letters.any(|letter| letter == wanted))
}

fn kind_of(kind: SymbolKind) -> lsp::SymbolKind {
    match kind {
        SymbolKind::Shape => lsp::SymbolKind::Object,
        SymbolKind::Group => lsp::SymbolKind::Namespace,
        SymbolKind::Light => lsp::SymbolKind::Event,
        SymbolKind::Block => lsp::SymbolKind::Interface,
        SymbolKind::Material => lsp::SymbolKind::Constant,
        SymbolKind::Prototype => lsp::SymbolKind::Struct,
        SymbolKind::Value => lsp::SymbolKind::Variable,
        SymbolKind::Param => lsp::SymbolKind::Property,
        SymbolKind::Part => lsp::SymbolKind::Class,
        SymbolKind::Module => lsp::SymbolKind::Module,
        SymbolKind::Function => lsp::SymbolKind::Function,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_are_found_in_order() {
        assert!(is_like("woodenStool", "ws") && is_like("Ärmel", "äm") && is_like("a", ""));
        assert!(!is_like("stool", "sw") && !is_like("a", "aa"));
    }
}
