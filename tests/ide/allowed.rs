//! A warning that an editor allows is gone.

use crate::folder::Folder;
use rt_lang::diagnostic::{Code, Severity};
use rt_lang::files::FilePath;
use rt_lang::ide::Analysis;
use rt_lang::source::Source;
use std::path::Path;

/// Every warning in the text itself can be allowed, but for one of an `@allow`; then it is gone, and nothing else is said.
#[test]
fn each_warning_can_be_allowed() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cases");
    let (mut wrong, mut allowed) = (vec![], 0);
    for folder in ["diagnostics", "syntax", "ide"] {
        for entry in root.join(folder).read_dir().unwrap() {
            let path = entry.unwrap().path();
            let path = if path.is_dir() { path.join("main.rt") } else { path };
            if path.extension().is_none_or(|extension| extension != "rt") {
                continue;
            }
            let below = path.strip_prefix(&root).unwrap().to_str().unwrap();
            let text = std::fs::read_to_string(&path).unwrap();
            let text = if folder == "ide" { super::marks(&text).0 } else { text };
            let before = analysed_at(&root, below, &text);
            let fixes = before.fixes(0..text.len());
            for (index, warning) in before.diagnostics.iter().enumerate() {
                let place = warning.primary.span;
                let is_free = warning.severity() == Severity::Warning && warning.code != Code::W0105;
                if !is_free || place.source != before.main {
                    continue;
                }
                let allows = format!("@allow({}", warning.code.as_str());
                let named = format!("@allow({}", warning.code.name());
                let mut offered = fixes.iter().filter(|fix| {
                    let text = &fix.edits[0].text;
                    fix.diagnostic == index && (text.starts_with(&allows) || text.starts_with(&named))
                });
                let Some(fix) = offered.next() else {
                    wrong.push(format!("{below}: {} is not offered to be allowed", warning.message));
                    continue;
                };
                let mut changed = text.clone();
                for edit in fix.edits.iter().rev() {
                    changed.replace_range(edit.at.range.clone(), &edit.text);
                }
                let after = analysed_at(&root, below, &changed);
                let (before, after) = (codes(&before), codes(&after));
                let mut fewer = before.clone();
                fewer.retain({
                    let mut gone = false;
                    move |code| gone || *code != warning.code || !std::mem::replace(&mut gone, true)
                });
                // Others of the code may be allowed by it as well.
                let is_gone = after.len() < before.len() && after.iter().all(|code| fewer.contains(code));
                if !is_gone {
                    wrong.push(format!("{below}: {before:?} became {after:?} in\n{changed}"));
                }
                allowed += 1;
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(allowed > 30, "{allowed} were allowed");
}

fn codes(analysis: &Analysis) -> Vec<Code> {
    analysis.diagnostics.iter().map(|said| said.code).collect()
}

/// A text among the cases, which share files.
fn analysed_at(root: &Path, below: &str, text: &str) -> Analysis {
    let source = Source::new(below, text).at(FilePath::root("").join(below).unwrap());
    rt_lang::analyse(&Folder(root.into()), source, &super::options(), &|| false).unwrap()
}
