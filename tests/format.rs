//! The formatter: the cases of `cases/format`, and what must hold for any text.

use crate::invariants;
use crate::parse::{case_files, mutated, pieces, spliced};
use proptest::prelude::*;
use rt_lang::span::SourceId;
use rt_lang::syntax::format;
use std::path::{Path, PathBuf};

const SOURCE: SourceId = SourceId(0);

#[test]
fn cases() {
    insta::with_settings!({
        snapshot_path => "cases/format",
        prepend_module_to_snapshot => false,
        omit_expression => true,
    }, {
        insta::glob!("cases/format/*.rt", |path| {
            let text = std::fs::read_to_string(path).unwrap();
            check(&text);
            insta::assert_snapshot!("format", format(SOURCE, &text).0);
        });
    });
}

/// Every `.rt` file of the project.
fn all_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            all_files(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rt") {
            found.push(path);
        }
    }
}

#[test]
fn files_keep_their_meaning() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut paths = vec![];
    all_files(&root.join("tests"), &mut paths);
    all_files(&root.join("examples"), &mut paths);
    assert!(paths.len() > 50);
    for path in paths {
        check(&String::from_utf8_lossy(&std::fs::read(&path).unwrap()));
    }
}

#[test]
fn examples_are_laid_out() {
    let mut paths = vec![];
    all_files(&Path::new(env!("CARGO_MANIFEST_DIR")).join("examples"), &mut paths);
    for path in paths {
        let text = std::fs::read_to_string(&path).unwrap();
        assert_eq!(
            format(SOURCE, &text).0,
            text,
            "{}: `rtc fmt examples/**/*.rt` lays it out",
            path.display()
        );
    }
}

/// Where comments may stand in a file that is fine, it stays fine.
#[test]
fn comments_between_tokens_stay_fine() {
    let entries = [
        "assert 1 < 2 , \"x\"",
        "param a : int = 1 in 1 to 2",
        "fn f ( a : int ) -> int = a",
        "for i in range ( 3 ) { sphere { radius : 1m } }",
        "@off sphere ball { material : metal { color : a * 2 } }",
        "let a = if b then mirror { } else if c then metal { } else diffuse { }",
        "if a { plane { } } else if b { } else { }",
        "part post { param h : [ length ] = [ 1m ] \n box { } }",
        "let a = b . c - f ( x : 2 ) * ( 1 , 2 , - 3 )",
        "import \"lantern.rt\" as lantern",
    ];
    // On its line, at the end of one, and on its own, with what follows indented, as behind a line end in an entry.
    let comments = ["/* why */", "// why\n   ", "\n    // why\n   ", "/* why */ // and more\n   "];
    let mut fine = 0;
    for (entry, comment) in entries.into_iter().flat_map(|entry| comments.map(|comment| (entry, comment))) {
        for (at, _) in entry.match_indices(' ') {
            let (before, behind) = entry.split_at(at);
            let text = format!("{before} {comment} {behind}\n");
            check(&text);
            let is_fine = format(SOURCE, &text).1.is_empty();
            assert!(is_fine || comment.contains('\n'), "{text}");
            fine += usize::from(is_fine && comment.contains('\n'));
        }
    }
    assert!(fine > 200, "{fine}");
}

fn check(text: &str) {
    invariants::fmt(text);
}

#[test]
fn a_broken_item_stays_as_it_is() {
    let broken = "sphere {radius = 5cm,\n   at:0}";
    let text = format!("plane  {{  }}\n\n\n\n{broken}  // c\nplane {{material:a}}\n");
    let (formatted, slips) = format(SOURCE, &text);
    assert_eq!(slips.len(), 1);
    assert_eq!(formatted, format!("plane {{}}\n\n{broken} // c\nplane {{ material: a }}\n"));
}

/// A file from another system is laid out as it would be here, and stays a file of that system.
#[test]
fn line_ends_and_marks_of_encodings_stay() {
    let texts =
        case_files().into_iter().map(|(_, text)| text).chain([include_str!("cases/format/layout.rt").into()]);
    for text in texts.filter(|text| text.contains('\n') && !text.contains('\r')) {
        let formatted = format(SOURCE, &text).0;
        for mark in ["", "\u{feff}"] {
            let elsewhere = |text: &str| format!("{mark}{}", text.replace('\n', "\r\n"));
            assert_eq!(format(SOURCE, &elsewhere(&text)).0, elsewhere(&formatted));
        }
    }
    // The first line end of several decides, also within what has a slip.
    assert_eq!(format(SOURCE, "plane {\r\n}\nbox {size = 1,\n}").0, "plane {}\r\nbox {size = 1,\r\n}\r\n");
    assert_eq!(format(SOURCE, "plane {\n}\r\n/* a\r\n b */").0, "plane {}\n/* a\n b */\n");
}

// --- Texts without slips, laid out at random ---------------------------------------------------------------

fn one_of(words: &'static [&'static str]) -> impl Strategy<Value = String> + Clone {
    prop::sample::select(words).prop_map(str::to_string)
}

/// White space where a line must not end.
fn space() -> impl Strategy<Value = String> + Clone {
    one_of(&[" ", " ", " ", "  ", " /* s */ ", "\t"])
}

/// White space where it may.
fn gap() -> impl Strategy<Value = String> + Clone {
    one_of(&["", " ", " ", "\n", " // g\n", "\n // own\n\n", " /* g */ ", "\n/* a\n b */", "/// doc\n"])
}

/// What stands between two entries.
fn between() -> impl Strategy<Value = String> + Clone {
    one_of(&[
        "\n",
        "\n\n",
        ", ",
        ",\n",
        " // b\n",
        "\n// own\n",
        "\n\n/// doc\n/// more\n",
        " /* b */, ",
        ", /* b */ ",
        "\n\n\n// own\n\n",
        " /// no doc\n",
        "\n/* a */ // b\n",
        "\n/* a */ /// b\n",
    ])
}

fn value() -> impl Strategy<Value = String> {
    let leaf = one_of(&[
        "1",
        "0.5",
        "1e-3",
        "8mm",
        "25%",
        "10W/m2",
        "a",
        "vase",
        "#fff",
        "\"text\"",
        "true",
        "a_long_name_of_a_thing",
        "some.path.of.names",
        "1_000.25in",
    ]);
    leaf.prop_recursive(5, 40, 6, |inner| {
        let bare = inner.clone();
        let list = |inner: BoxedStrategy<String>| {
            prop::collection::vec((gap(), inner, gap()), 1..6).prop_map(|items| {
                items.iter().map(|(a, b, c)| format!("{a}{b}{c}")).collect::<Vec<_>>().join(",")
            })
        };
        let inner = inner.boxed();
        let operator = one_of(&["+", "-", "*", "/", "|>", "and", "or", "==", "<", ">=", "to"]);
        prop_oneof![
            list(inner.clone()).prop_map(|items| format!("({items})")),
            list(inner.clone()).prop_map(|items| format!("[{items}]")),
            list(inner.clone()).prop_map(|items| format!("f({items})")),
            (list(inner.clone()), bare.clone()).prop_map(|(items, x)| format!("g({items},\n name: {x})")),
            (inner.clone(), gap(), operator, gap(), inner.clone())
                .prop_map(|(a, x, op, y, b)| format!("({a}) {op}{y} ({b}{x})")),
            (inner.clone(), gap(), inner.clone()).prop_map(|(a, x, b)| format!("({a}) +{x} ({b}) - a * b")),
            (inner.clone(), inner.clone(), inner.clone(), gap())
                .prop_map(|(a, b, c, x)| format!("(if ({a}) then {b} else{x} {c})")),
            inner.clone().prop_map(|a| format!("-({a})[0].x")),
            inner.clone().prop_map(|a| format!("not ({a})")),
            (space(), inner.clone(), between(), inner.clone())
                .prop_map(|(x, a, y, b)| format!("kind{x}{{ a: {a}{y}b: {b} }}")),
        ]
    })
}

fn body(inner: impl Strategy<Value = String>) -> impl Strategy<Value = String> {
    (prop::collection::vec((inner, between()), 0..4), gap(), gap()).prop_map(|(entries, open, close)| {
        let entries: String = entries.into_iter().map(|(entry, between)| entry + &between).collect();
        format!("{{{open}{entries}{close}}}")
    })
}

fn entry() -> impl Strategy<Value = String> {
    let v = || value().boxed();
    let leaf = prop_oneof![
        (space(), v()).prop_map(|(s, a)| format!("a:{s}{a}")),
        (space(), v()).prop_map(|(s, a)| format!("let{s}a ={s}{a}")),
        (space(), v(), gap()).prop_map(|(s, a, g)| format!("param a{s}: [length] = {g} ({a}) in 1{s}to 2")),
        (space(), v()).prop_map(|(s, a)| format!("fn f(a{s}: int, b: [angle]) ->{s}number ={s}{a}")),
        space().prop_map(|s| format!("import{s}\"a.rt\" as{s}b")),
        (space(), v()).prop_map(|(s, a)| format!("assert ({a}) {s},{s}\"message\"")),
    ];
    leaf.prop_recursive(3, 20, 4, |inner| {
        let inner = inner.boxed();
        prop_oneof![
            (space(), body(inner.clone())).prop_map(|(s, b)| format!("group{s}{b}")),
            (gap(), body(inner.clone()))
                .prop_map(|(g, b)| format!("@off{g}\n@allow(W0601, \"why\") a.b c {b}")),
            (space(), body(inner.clone())).prop_map(|(s, b)| format!("part a{s}{b}")),
            (value(), body(inner.clone())).prop_map(|(a, b)| format!("for i in ({a}) {b}")),
            (value(), body(inner.clone()), body(inner.clone()), space())
                .prop_map(|(a, b, c, s)| format!("if ({a}) {b}{s}else if a {c} else {{}}")),
        ]
    })
}

fn scene() -> impl Strategy<Value = String> {
    prop::collection::vec((entry(), between()), 0..5).prop_map(|entries| {
        let text: String = entries.into_iter().map(|(entry, between)| entry + &between).collect();
        text.trim_end_matches([' ', ',']).to_string()
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn generated_scenes_keep_their_meaning(text in scene()) {
        check(&text);
    }

    #[test]
    fn any_pieces_keep_their_meaning(text in pieces()) {
        check(&text);
    }

    #[test]
    fn mutated_cases_keep_their_meaning(text in mutated()) {
        check(&text);
    }

    #[test]
    fn spliced_cases_keep_their_meaning(text in spliced()) {
        check(&text);
    }
}

#[test]
fn syntax_cases_keep_their_meaning() {
    for (_, text) in case_files() {
        check(&text);
    }
}
