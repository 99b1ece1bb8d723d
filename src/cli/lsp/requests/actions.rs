//! Mends, and warnings that can be allowed.

use super::super::analyst::Meaning;
use super::super::diagnostics::convert;
use super::super::documents::Key;
use super::super::edits::{self, between};
use super::super::work::{Answer, Asked};
use gen_lsp_types as lsp;
use lsp::CodeActionKind as Kind;
use rt_lang::ide::Fix;
use rt_lang::mend::mend;
use std::collections::BTreeMap;

/// The most that is offered at once: nobody reads more, and there may be as many as characters.
const MOST: usize = 500;

/// What can be done about a part of a document.
pub fn actions(
    asked: &mut Asked,
    params: lsp::CodeActionParams,
) -> Answer<Option<Vec<lsp::CodeActionResponse>>> {
    let key = Key::of(&params.text_document.uri);
    let meaning = asked.meaning(&params.text_document.uri)?;
    let only = params.context.only.as_deref();
    let mut found = vec![];
    if wanted(only, &Kind::QuickFix) {
        let fixes = meaning.analysis.fixes(meaning.bytes(params.range));
        found.extend(fixes.into_iter().take(MOST).map(|fix| action(fix, &meaning, asked)));
    }
    if wanted(only, &Kind::SourceFixAll) {
        found.extend(fix_all(&key, &meaning, asked));
    }
    Ok(Some(found.into_iter().map(lsp::CodeActionResponse::CodeAction).collect()))
}

/// Whether a kind, or one that it belongs to, is among those that are asked for.
fn wanted(only: Option<&[Kind]>, kind: &Kind) -> bool {
    let word = |kind: &Kind| match serde_json::to_value(kind) {
        Ok(serde_json::Value::String(word)) => word,
        _ => String::new(),
    };
    let kind = word(kind);
    let holds = |around: String| {
        around.is_empty()
            || kind == around
            || kind.strip_prefix(&around).is_some_and(|rest| rest.starts_with('.'))
    };
    only.is_none_or(|only| only.iter().any(|around| holds(word(around))))
}

fn action(fix: Fix, meaning: &Meaning, asked: &Asked) -> lsp::CodeAction {
    let mut by_file: BTreeMap<Key, Vec<lsp::TextEdit>> = BTreeMap::new();
    for edit in fix.edits {
        if let Some((key, range)) = meaning.place(&edit.at) {
            by_file.entry(key).or_default().push(lsp::TextEdit { range, new_text: edit.text });
        }
    }
    let diagnostic = meaning.analysis.diagnostics.get(fix.diagnostic);
    lsp::CodeAction {
        title: fix.title,
        kind: Some(Kind::QuickFix),
        diagnostics: diagnostic.map(|diagnostic| vec![convert(diagnostic, meaning, asked.view)]),
        is_preferred: fix.mends.then_some(true),
        edit: Some(edits::workspace(by_file, asked.view)),
        ..lsp::CodeAction::default()
    }
}

/// Everything that can be mended at once.
fn fix_all(key: &Key, meaning: &Meaning, asked: &Asked) -> Option<lsp::CodeAction> {
    let analysis = &meaning.analysis;
    let mended = mend(&analysis.source().text, analysis.main, &analysis.diagnostics)?;
    let edits = between(meaning.text(analysis.main), &mended.text, asked.view.session.encoding);
    Some(lsp::CodeAction {
        title: "Mend all that can be mended without a thought".into(),
        kind: Some(Kind::SourceFixAll),
        edit: Some(edits::workspace(BTreeMap::from([(key.clone(), edits)]), asked.view)),
        ..lsp::CodeAction::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_kind_is_wanted_with_all_that_belongs_to_it() {
        assert!(wanted(None, &Kind::SourceFixAll));
        assert!(wanted(Some(&[Kind::Source]), &Kind::SourceFixAll));
        assert!(wanted(Some(&[Kind::Custom("".into())]), &Kind::QuickFix));
        assert!(!wanted(Some(&[Kind::QuickFix]), &Kind::SourceFixAll));
        assert!(!wanted(Some(&[Kind::Custom("source.fix".into())]), &Kind::SourceFixAll));
    }
}
