//! Text to tree: the cases of `cases/syntax`, and what must hold for any text.

use crate::dump;
use crate::fuzz::texts;
use crate::work::work;
use proptest::prelude::*;
use rt_lang::diagnostic::{Code, Diagnostic};
use rt_lang::span::SourceId;
use rt_lang::syntax::ast::{Body, Entry, ExprKind, File, StatementKind, TypeName};
use rt_lang::syntax::{parse, parse_expression};
use std::time::Duration;

const SOURCE: SourceId = SourceId(0);

fn read(text: &str) -> (File, Vec<Diagnostic>) {
    parse(SOURCE, text)
}

fn codes(text: &str) -> Vec<Code> {
    read(text).1.iter().map(|diagnostic| diagnostic.code).collect()
}

/// Every case, with its path.
pub fn case_files() -> Vec<(std::path::PathBuf, String)> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/cases/syntax");
    let mut paths: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "rt"));
    paths.sort();
    let read = |path: std::path::PathBuf| std::fs::read_to_string(&path).map(|text| (path, text)).unwrap();
    paths.into_iter().map(read).collect()
}

#[test]
fn cases() {
    insta::with_settings!({
        snapshot_path => "cases/syntax",
        prepend_module_to_snapshot => false,
        omit_expression => true,
    }, {
        insta::glob!("cases/syntax/*.rt", |path| {
            let text = std::fs::read_to_string(path).unwrap();
            let (file, diagnostics) = read(&text);
            assert!(is_ordered(&file.body), "{}", path.display());
            // The deep and the long ones would fill pages.
            let long = text.lines().any(|line| line.len() > 1000);
            let mut shown = String::new();
            if !diagnostics.is_empty() {
                let source = if long { "(a long text)" } else { &text };
                shown += &format!("{source}\n---\n{}\n---\n", dump::diagnostics(&text, &diagnostics));
            }
            let tree = dump::tree(&text, &file);
            shown += if long { "(a long tree)" } else { &tree };
            insta::assert_snapshot!(shown);
        });
    });
}

#[test]
fn seven_slips_are_seven_errors() {
    let (_, text) = case_files().into_iter().find(|(path, _)| path.ends_with("seven.rt")).unwrap();
    assert_eq!(codes(&text).len(), 7);
}

/// Applying every fix leaves nothing to fix.
#[test]
fn fixes_mend() {
    for (path, text) in case_files() {
        let (_, diagnostics) = read(&text);
        let mut edits: Vec<_> =
            diagnostics.iter().flat_map(|d| &d.fix).flat_map(|fix| fix.edits.clone()).collect();
        edits.sort();
        let mut mended = text.clone();
        for (span, replacement) in edits.iter().rev() {
            mended.replace_range(span.range(), replacement);
        }
        let left: Vec<_> = read(&mended).1.into_iter().filter(|d| d.fix.is_some()).collect();
        assert!(left.is_empty(), "{}: {left:?}\n{mended}", path.display());
    }
}

#[test]
fn expressions_stand_alone() {
    let kind = |text| {
        let (expr, diagnostics) = parse_expression(SOURCE, text);
        assert!(diagnostics.is_empty(), "{text}: {diagnostics:?}");
        dump::expression(text, &expr)
    };
    assert_eq!(kind("0.53deg"), "quantity 0.53 deg  «0.53deg»\n");
    assert_eq!(kind(" (0, 1, 0) // up\n").lines().next(), Some("tuple  «(0, 1, 0)»"));
    assert!(kind("a\n  |> b").starts_with("Pipe"));
    for text in ["", "  ", "1 2", "1, 2", "1 }", "(1", "1\n2", "#12345", "a: 5", "let a = 5", "\"", "// 1"] {
        let (_, diagnostics) = parse_expression(SOURCE, text);
        assert_eq!(diagnostics.len(), 1, "{text}: {diagnostics:?}");
    }
}

/// The grammar lists the units, since what follows `/` or a space depends on them.
#[test]
fn the_grammar_knows_every_unit() {
    for (unit, _) in rt_lang::units::UNITS.iter().filter(|(unit, _)| *unit != "%") {
        let text = format!("1W/{unit}");
        let (expr, _) = parse_expression(SOURCE, &text);
        assert!(matches!(expr.kind, ExprKind::Quantity { unit, .. } if unit.text == text[1..]), "{unit}");
        let (_, diagnostics) = parse_expression(SOURCE, &format!("8 {unit}"));
        assert_eq!(diagnostics[0].code, Code::E0004, "{unit}");
    }
}

// --- Hostile texts -----------------------------------------------------------------------------------------

/// Runs on a stack as small as a worker thread's, and says how much work it was.
fn on_small_stack(text: String) -> (Duration, Vec<Diagnostic>) {
    let run = move || {
        let (time, (_, diagnostics)) = work(|| read(&text));
        (time, diagnostics)
    };
    std::thread::Builder::new().stack_size(2 << 20).spawn(run).unwrap().join().unwrap()
}

#[test]
fn deep_nesting_with_a_slip_at_the_bottom_is_read_at_once() {
    let nested =
        |open: &str, slip: &str, close: &str| format!("{}{slip}{}", open.repeat(500), close.repeat(500));
    for text in [
        format!("let a = {}", nested("(", "1 $", ")")),
        format!("let a = {}", nested("f(", "1 $", ")")),
        format!("let a = {}", nested("f(x: 1, y: ", "1 $", ")")),
        format!("let a = {}", nested("(0, ", "1.2.3", ")")),
        nested("group {", "radius = 5cm", "}"),
        nested("group g {\n", "radius: 5 cm\n", "}\n"),
        format!("sphere {{ material: {} }}", nested("a { b: ", "1 $", "}")),
        format!("let a = {}", nested("{ x ", "$", "}")),
        format!("let a = {}", nested("[", "$", "]")),
    ] {
        let (time, diagnostics) = on_small_stack(text.clone());
        assert_eq!(diagnostics.len(), 1, "{text}\n{diagnostics:?}");
        assert!(time < Duration::from_secs(2), "{time:?} for {text}");
    }
    // Angle brackets are no brackets; they nest all the same.
    let (time, diagnostics) = on_small_stack(format!("let a = {}", nested("<0, ", "1", ", 2>")));
    assert!(time < Duration::from_secs(2) && !diagnostics.is_empty());
}

#[test]
fn limits_are_said_once() {
    for text in [
        "(".repeat(100_000),
        format!("let a = {}1{}", "(".repeat(100_000), ")".repeat(100_000)),
        format!("{}{}", "group {".repeat(100_000), "}".repeat(100_000)),
        format!("let a = {}1", "-".repeat(100_000)),
        format!("let a = {}1", "not ".repeat(5_000)),
        format!("let a = 1{}", " + 1".repeat(100_000)),
        format!("let a = 1{}", " + 1".repeat(5_000)),
        format!("let a = b{}", ".c".repeat(5_000)),
        format!("let a = {}", "<".repeat(100_000)),
        format!("let a = {}", "if ".repeat(100_000)),
        format!("let a = {}1", "if a then b else ".repeat(100_000)),
        format!("if a {{}} {}", "else if a {} ".repeat(100_000)),
        format!("let a = b{}", "[0]".repeat(5_000)),
    ] {
        let (_, diagnostics) = on_small_stack(text.clone());
        let start: String = text.chars().take(40).collect();
        assert_eq!(diagnostics.len(), 1, "{start}: {diagnostics:?}");
        assert_eq!(diagnostics[0].code, Code::E0406, "{start}");
    }
}

#[test]
fn what_follows_a_skipped_item_is_read() {
    let text = format!("let a = {}\nsphere {{ radius = 1m }}\n", "(".repeat(100_000));
    assert_eq!(codes(&text), [Code::E0406, Code::E0003]);
}

/// Texts in which every place is the beginning of something that does not end.
#[test]
fn time_is_in_proportion_to_the_text() {
    let seeds = [
        "(",
        "{",
        "[",
        "if ",
        "if a {",
        "if a then ",
        "if a then b else ",
        "for i in ",
        "for i in x {\n",
        "param a: [",
        "fn f(",
        "part p {\n",
        "@off\n",
        "@a(",
        "/// a\n",
        "assert a, ",
        "a[",
        "import ",
        "else ",
        "<",
        "\"",
        "/*",
        "/",
        "//\n",
        "}",
        ")",
        "sphere {\n",
        "group { (\n",
        "a {",
        "let a = (\n",
        ";",
        ",",
        "a ",
        "a: ",
        "a = ",
        "5 ",
        "-",
        "1 + ",
        "$",
        "#",
        ".",
        "1.",
        "f(x",
        "f(x: ",
        "(a, ",
        "{ ( }",
        "[ ) ",
        "let ",
        "\n",
        " ",
        "\u{1}",
        "é",
        "\"\\",
        "sphere { at: (0, 1\n radius: 5 }\n",
        "sphere { radius: \"a }\n",
    ];
    for seed in seeds {
        let time = |length: usize| on_small_stack(seed.repeat(length / seed.len())).0;
        let measured = || (time(100_000), time(400_000));
        let proportional =
            |(short, long): &(Duration, Duration)| *long < *short * 12 + Duration::from_millis(100);
        // Other programs push it out of the caches; what is out of proportion is so every time.
        let mut runs = std::iter::repeat_with(measured).take(3);
        assert!(runs.any(|run| proportional(&run)), "{seed:?} takes more than its share of time");
    }
}

// --- Any text ----------------------------------------------------------------------------------------------

/// Every place lies in the text, between characters.
fn check_places(text: &str) {
    let (file, diagnostics) = read(text);
    dump::tree(text, &file);
    dump::diagnostics(text, &diagnostics);
    for diagnostic in &diagnostics {
        assert!(!diagnostic.message.is_empty() && !diagnostic.message.ends_with('.'));
        assert!(!diagnostic.primary.text.is_empty(), "{diagnostic:?}");
    }
    assert!(is_ordered(&file.body));
    if diagnostics.is_empty() {
        assert!(!any_broken(&file.body), "silently broken: {text}");
    }
    let (expr, diagnostics) = parse_expression(SOURCE, text);
    dump::expression(text, &expr);
    dump::diagnostics(text, &diagnostics);
    assert!(!diagnostics.is_empty() || !matches!(expr.kind, ExprKind::Invalid));
}

fn start_of(entry: &Entry) -> u32 {
    match entry {
        Entry::Field(field) => field.name.span.start,
        Entry::Broken(broken) => broken.span.start,
        Entry::Statement(statement) => statement.span.start,
        Entry::Rows(rows) => rows.span().start,
    }
}

fn is_ordered(body: &Body) -> bool {
    body.entries.is_sorted_by_key(start_of)
}

fn any_broken(body: &Body) -> bool {
    body.entries.iter().any(|entry| match entry {
        Entry::Broken(_) => true,
        Entry::Rows(_) => false,
        Entry::Field(field) => matches!(field.value.kind, ExprKind::Invalid),
        Entry::Statement(statement) => match &statement.kind {
            StatementKind::Thing { construct, .. } => any_broken(&construct.body),
            StatementKind::Definition { value, .. } | StatementKind::Function { value, .. } => {
                matches!(value.kind, ExprKind::Invalid)
            }
            StatementKind::Param { default, ty, .. } => {
                matches!(default.kind, ExprKind::Invalid) || matches!(ty, TypeName::Invalid(_))
            }
            StatementKind::Part { body, .. } => any_broken(body),
            StatementKind::For { list, body, .. } => {
                matches!(list.kind, ExprKind::Invalid) || any_broken(body)
            }
            StatementKind::If { condition, then, otherwise } => {
                matches!(condition.kind, ExprKind::Invalid)
                    || any_broken(then)
                    || otherwise.as_ref().is_some_and(any_broken)
            }
            StatementKind::Assert { condition, .. } => matches!(condition.kind, ExprKind::Invalid),
            StatementKind::Import { .. } => false,
        },
    })
}

/// Pieces of the language, put together at random.
pub fn pieces() -> impl Strategy<Value = String> {
    let piece = prop::sample::select(vec![
        "sphere", "group", "let", "material", "and", "not", "radius", "a", "in", "to", "{", "}", "(", ")",
        "[", "]", "<", ">", ":", "=", ";", ",", "\n", " ", "+", "-", "*", "/", "|>", ".", "..", "==", "1",
        "1.5", ".5", "1e", "8mm", " mm", "%", "m2", "#fff", "#12345", "\"", "\"a\"", "\\", "//", "/*", "*/",
        "é", "\u{1}", "\u{feff}", "\r\n", "true", "param", "part", "import", "as", "for", "if", "then",
        "else", "elif", "fn", "->", "assert", "@", "@off", "@allow(", "///",
    ]);
    prop::collection::vec(piece, 0..60).prop_map(|pieces| pieces.concat())
}

/// A case with some of its bytes cut out, doubled or replaced.
pub fn mutated() -> impl Strategy<Value = String> {
    let texts: Vec<String> =
        case_files().into_iter().map(|(_, text)| text).filter(|text| text.len() < 2000).collect();
    let cut = (any::<prop::sample::Index>(), 0..8_usize, pieces());
    (prop::sample::select(texts), prop::collection::vec(cut, 1..4)).prop_map(|(text, cuts)| {
        let mut characters: Vec<char> = text.chars().collect();
        for (at, length, instead) in cuts {
            let at = at.index(characters.len() + 1);
            let end = (at + length).min(characters.len());
            let instead = instead.chars().take(length / 2);
            characters.splice(at..end, instead);
        }
        characters.into_iter().collect()
    })
}

/// Stretches of several cases one behind the other, with brackets and what is no text strewn in.
pub fn spliced() -> impl Strategy<Value = String> {
    let cases = texts("tests/cases/diagnostics");
    let stretch = (prop::sample::select(cases), any::<prop::sample::Index>(), 0..100_usize);
    let sign = prop::sample::select(vec![
        "(", ")", "[", "]", "{", "}", "<", "\n}", "}\n", ")\n", ":{", "\n", "\"", "/*", ";", "#", "@",
        "\u{1}", "\0", "\u{7f}", "\u{b}", "\r", "（", "）", "“", "\u{a0}", "\u{2028}",
    ]);
    let strewn = prop::collection::vec((any::<prop::sample::Index>(), sign), 0..8);
    (prop::collection::vec(stretch, 1..4), strewn).prop_map(|(stretches, strewn)| {
        let mut text: Vec<char> = vec![];
        for (case, at, length) in stretches {
            text.extend(case.chars().skip(at.index(case.len() + 1)).take(length));
        }
        for (at, sign) in strewn {
            let at = at.index(text.len() + 1);
            text.splice(at..at, sign.chars());
        }
        text.into_iter().collect()
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_bytes_are_read(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        check_places(&String::from_utf8_lossy(&bytes));
    }

    #[test]
    fn any_text_is_read(text in "\\PC{0,100}") {
        check_places(&text);
    }

    #[test]
    fn any_pieces_are_read(text in pieces()) {
        check_places(&text);
    }

    #[test]
    fn mutated_cases_are_read(text in mutated()) {
        check_places(&text);
    }

    #[test]
    fn spliced_cases_are_read(text in spliced()) {
        check_places(&text);
    }
}
