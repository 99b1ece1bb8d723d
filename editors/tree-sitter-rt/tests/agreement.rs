//! Both parsers say the same of every text of the repository: which have a slip, and what the others are made of.

use crate::{dump, files, parse, read, repository};
use rt_lang::diagnostic::{Code, Diagnostic};
use rt_lang::span::SourceId;
use rt_lang::syntax::ast::File;

/// What the compiler finds: the tree where the text has no slip.
enum Verdict {
    Fine(File),
    Slip,
    /// Over a limit, which editors do not have.
    Unread,
}

fn compiler(text: &str) -> Verdict {
    let (file, slips) = rt_lang::syntax::parse(SourceId(0), text);
    let is_limit = |slip: &Diagnostic| slip.code == Code::E0406;
    match slips.iter().all(is_limit) {
        true if slips.is_empty() => Verdict::Fine(file),
        true => Verdict::Unread,
        false => Verdict::Slip,
    }
}

/// How the parsers differ about a text, if they do.
fn difference(text: &str) -> Option<String> {
    let tree = parse(text);
    let root = tree.root_node();
    match (compiler(text), root.has_error()) {
        (Verdict::Fine(file), false) => {
            let (ours, theirs) = (dump::of_compiler(&file.body), dump::of_editor(text, root));
            let line = ours.lines().zip(theirs.lines()).position(|(a, b)| a != b);
            let line = line
                .or((ours.len() != theirs.len()).then(|| ours.lines().count().min(theirs.lines().count())));
            line.map(|line| {
                let of = |dump: &str| dump.lines().nth(line).unwrap_or("nothing").to_string();
                format!("the compiler has\n  {}\nthe editor's tree has\n  {}", of(&ours), of(&theirs))
            })
        }
        (Verdict::Fine(_), true) => Some(format!("an error in the editor's tree alone: {}", root.to_sexp())),
        (Verdict::Slip, false) => Some("a slip for the compiler alone".into()),
        (Verdict::Slip | Verdict::Unread, _) => None,
    }
}

/// The texts of a file's top-level entries, each with what follows it up to the next.
fn entries(text: &str) -> Vec<&str> {
    let (file, _) = rt_lang::syntax::parse(SourceId(0), text);
    let starts: Vec<usize> = file.body.entries.iter().map(|entry| entry.start() as usize).collect();
    let ends = starts.iter().skip(1).copied().chain([text.len()]);
    starts.iter().zip(ends).map(|(&start, end)| &text[start..end]).collect()
}

/// Slips that the compiler finds in a whole tree only: `assert(a, "b")` is an `assert` of a pair.
const FOUND_LATER: &[&str] = &["E0001-assert-as-a-call.rt"];

#[test]
fn every_text_of_the_repository_is_read_alike() {
    let texts = files(&repository(), "rt");
    assert!(texts.len() > 400, "{} texts were found", texts.len());
    let mut differ = vec![];
    let mut tell = |name: String, text: &str| {
        let shown: String = text.chars().take(300).collect();
        differ.extend(difference(text).map(|how| format!("{name}: {how}\n{shown}\n")));
    };
    for path in texts {
        let text = read(&path);
        if FOUND_LATER.iter().any(|name| path.ends_with(name)) {
            assert!(difference(&text).is_some(), "{} is read alike by now", path.display());
            continue;
        }
        tell(path.display().to_string(), &text);
        for (index, entry) in entries(&text).into_iter().enumerate() {
            tell(format!("{}, entry {}", path.display(), index + 1), entry);
        }
    }
    assert!(differ.is_empty(), "{} differ\n\n{}", differ.len(), differ.join("\n"));
}

#[test]
fn every_example_in_the_documents_is_read_alike() {
    for path in files(&repository().join("docs"), "md").into_iter().chain([repository().join("README.md")]) {
        for block in read(&path).split("```rt\n").skip(1) {
            let block = block.split("```").next().unwrap_or("");
            assert_eq!(difference(block), None, "{}:\n{block}", path.display());
        }
    }
}

/// The scanner lists the units, since what follows `/` depends on them.
#[test]
fn the_scanner_knows_every_unit() {
    for (unit, _) in rt_lang::units::UNITS.iter().filter(|(unit, _)| *unit != "%") {
        for text in
            [format!("let a = 1W/{unit}"), format!("let a = 1W/{unit}2"), format!("let a = 1W/{unit}s")]
        {
            assert_eq!(difference(&text), None, "{text}");
        }
    }
}

/// The words that are no names are the same.
#[test]
fn the_grammar_reserves_the_words_of_the_language() {
    for word in rt_lang::syntax::RESERVED.iter().copied().chain(["form", "lets", "elif", "while"]) {
        for text in [
            format!("let {word} = 5"),
            format!("let a = {word}"),
            format!("sphere {word} {{}}"),
            format!("{word} {{}}"),
            format!("sphere {{ {word}: 5 }}"),
            format!("let a = b.{word}"),
            format!("let a = f({word}: 5)"),
            format!("fn {word}({word}: int) -> int = 1"),
            format!("param a: {word} = 1"),
            format!("for {word} in a {{}}"),
            format!("import \"a.rt\" as {word}"),
            format!("part {word} {{}}"),
            format!("@{word} sphere {{}}"),
        ] {
            assert_eq!(difference(&text), None, "{text}");
        }
    }
}
