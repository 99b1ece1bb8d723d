//! Every slip, and what is said of it: `cases/diagnostics/*.rt`, with what a terminal shows beside them.
//!
//! A case is named after the code it is about, which is then the only one it gives. One of several files is a folder
//! with a `main.rt`. A first line `// set: name=value` is given as by `--set`, and `// sweep: name = a to b` as by `--sweep`, of
//! which the only frame is made.

use crate::folder::Folder;
use rt_lang::diagnostic::{Code, Diagnostic};
use rt_lang::files::FilePath;
use rt_lang::mend::mend;
use rt_lang::report::{self, Style};
use rt_lang::source::{Source, Sources};
use rt_lang::span::SourceId;
use rt_lang::{Options, compile};
use std::cell::RefCell;
use std::collections::BTreeSet;
use std::path::Path;

#[test]
fn slips_are_reported() {
    let mut settings = insta::Settings::clone_current();
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.set_snapshot_path("cases/diagnostics");
    let wrong = RefCell::new(vec![]);
    settings.bind(|| {
        let case = |path: &Path| {
            let named = if path.ends_with("main.rt") { path.parent().unwrap() } else { path };
            let name = named.file_name().unwrap().to_str().unwrap();
            let text = std::fs::read_to_string(path).unwrap();
            let mut sources = Sources::default();
            let given = |flag: &str| -> Vec<String> {
                let value = text.lines().next().and_then(|line| line.strip_prefix(flag));
                value.map(String::from).into_iter().collect()
            };
            let (set, sweep) = (given("// set: "), given("// sweep: "));
            let source = Source::new(path.file_name().unwrap().to_str().unwrap(), text);
            // Cases share files with others: the root is the folder of all of them.
            let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cases");
            let below = path.strip_prefix(root.canonicalize().unwrap()).or(path.strip_prefix(&root)).unwrap();
            let id = sources.add(source.at(FilePath::root("").join(below.to_str().unwrap()).unwrap()));
            let options = Options { set, sweep, ..Options::default() };
            let compiled = compile(&Folder(root), &mut sources, id, &options);
            let codes: BTreeSet<&str> = compiled.diagnostics.iter().map(|d| d.code.as_str()).collect();
            if let Some(code) =
                name.split('-').next().filter(|word| Code::ALL.iter().any(|c| c.as_str() == *word))
            {
                if codes != BTreeSet::from([code]) {
                    wrong.borrow_mut().push(format!("{name} gives {codes:?}"));
                }
            } else if name.starts_with("fine") && !codes.is_empty() {
                wrong.borrow_mut().push(format!("{name} gives {codes:?}"));
            }
            let style = Style { color: false, unicode: true, width: 100 };
            let mut shown = report::all(&compiled.diagnostics, &sources, style);
            // The command says what it chose only of a picture that it makes.
            for note in compiled.notes.iter().filter(|_| compiled.scene.is_some()) {
                shown.push_str(&format!("note: {note}\n"));
            }
            insta::assert_snapshot!("report", shown);
        };
        insta::glob!("cases/diagnostics/*.rt", case);
        insta::glob!("cases/diagnostics/*/main.rt", case);
    });
    assert!(wrong.borrow().is_empty(), "other codes than the name says:\n{}", wrong.borrow().join("\n"));
}

/// Every edit that a message offers mends it: made, and made again on what that leaves, no message with an edit and
/// none of the codes that had one is left.
#[test]
fn what_is_offered_as_a_mend_mends() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cases");
    let mut wrong = vec![];
    let mut mended = 0;
    for folder in ["diagnostics", "syntax"] {
        for entry in std::fs::read_dir(root.join(folder)).unwrap() {
            let path = entry.unwrap().path();
            let path = if path.is_dir() { path.join("main.rt") } else { path };
            if path.extension().is_none_or(|extension| extension != "rt") {
                continue;
            }
            let below = path.strip_prefix(&root).unwrap().to_str().unwrap();
            let mut text = std::fs::read_to_string(&path).unwrap();
            let mut slips: BTreeSet<&str> = BTreeSet::new();
            for _ in 0..10 {
                let diagnostics = given(below, &text);
                let offered = diagnostics.iter().filter(|diagnostic| diagnostic.fix.is_some());
                // A code that also stands where nothing is offered is judged there.
                let bare = |code| diagnostics.iter().any(|d| d.code == code && d.fix.is_none());
                slips.extend(offered.filter(|d| !bare(d.code)).map(|d| d.code.as_str()));
                let Some(next) = mend(&text, SourceId(0), &diagnostics) else { break };
                text = next.text;
                mended += 1;
            }
            let left = given(below, &text);
            let codes: BTreeSet<&str> = left.iter().map(|d| d.code.as_str()).collect();
            if left.iter().any(|d| d.fix.is_some()) || slips.iter().any(|code| codes.contains(code)) {
                wrong.push(format!("{}: {slips:?} became {codes:?} in\n{text}", path.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(mended > 10, "{mended} cases were mended");
}

/// Every mend by itself, as an editor makes it, whether it is certain or one to choose, ends its message, and nothing becomes
/// unreadable by it.
#[test]
fn each_mend_by_itself_mends() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cases");
    let (mut wrong, mut mended) = (vec![], 0);
    for entry in
        ["diagnostics", "syntax", "ide"].iter().flat_map(|folder| root.join(folder).read_dir().unwrap())
    {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "rt") {
            continue;
        }
        let below = path.strip_prefix(&root).unwrap().to_str().unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        // Those of an editor's questions have marks.
        let marked = path.parent().unwrap().ends_with("ide");
        let text: String = text.split('$').step_by(if marked { 2 } else { 1 }).collect();
        let before = given(below, &text);
        for diagnostic in &before {
            let offers = diagnostic.offers.iter().map(|offer| (&offer.fix, &offer.title));
            let help = diagnostic.help.as_ref().unwrap_or(&diagnostic.message);
            let certain = diagnostic.fix.iter().map(|fix| (fix, help));
            for (fix, title) in certain.chain(offers) {
                let chosen = Diagnostic { fix: Some(fix.clone()), ..diagnostic.clone() };
                let Some(next) = mend(&text, SourceId(0), &[chosen]) else { continue };
                let after = given(below, &next.text);
                let count = |all: &[Diagnostic], code: Code| all.iter().filter(|d| d.code == code).count();
                let syntax = Code::ALL.iter().filter(|code| code.as_str().starts_with("E00"));
                let mut new = syntax.filter(|code| count(&after, **code) > count(&before, **code));
                // Behind a sign that cannot be read more may be wrong, which then shows.
                let hides = title.contains("only looks like") && before.len() > 1;
                let same = count(&after, diagnostic.code) >= count(&before, diagnostic.code);
                if !hides && (same || new.next().is_some()) {
                    wrong.push(format!("{below}: `{title}` gives\n{}", next.text));
                }
                mended += 1;
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(mended > 10, "{mended} mends were chosen");
}

/// What is said of a text that stands in place of a case. `below` is its path among the cases, which share files.
fn given(below: &str, text: &str) -> Vec<Diagnostic> {
    let mut sources = Sources::default();
    let path = FilePath::root("").join(below).unwrap();
    let id = sources.add(Source::new(below, text).at(path));
    let root = Folder(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/cases").into());
    compile(&root, &mut sources, id, &Options::default()).diagnostics
}

/// Each code the compiler can give has a case, here or among those of the syntax. E0009 is found before there is
/// a text, and W07xx are judged once a picture is there: the examples of `rtc explain` hold them.
#[test]
fn every_code_has_a_case() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cases");
    let shown: String = ["diagnostics", "syntax"]
        .iter()
        .flat_map(|folder| std::fs::read_dir(root.join(folder)).unwrap())
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "snap"))
        .map(|path| std::fs::read_to_string(path).unwrap())
        .collect();
    for code in Code::ALL {
        let elsewhere = matches!(code, Code::E0009) || code.as_str().starts_with("W07");
        assert!(elsewhere || shown.contains(code.as_str()), "no case for {}", code.as_str());
    }
}
