//! What the grammar gets to read.

use super::cut;
use crate::diagnostic::Code;
use crate::span::SourceId;

/// The items of a text, each as the grammar reads it.
fn items(text: &str) -> Vec<String> {
    let cut = cut(SourceId(0), text, 512);
    for item in &cut.items {
        let source = &text[item.start..item.start + item.text.len()];
        assert!(source.len() == item.text.len());
    }
    cut.items.into_iter().map(|item| item.text.replace('\u{1}', "?")).collect()
}

fn codes(text: &str) -> Vec<Code> {
    cut(SourceId(0), text, 512)
        .sink
        .into_sorted(|place| place)
        .iter()
        .map(|diagnostic| diagnostic.code)
        .collect()
}

#[test]
fn items_end_at_newlines_and_commas() {
    assert_eq!(items("a {}\nb {}, c {}\n\n"), ["a {}", "b {}", "c {}"]);
    assert_eq!(items("let a = 1; let b = 2"), ["let a = 1;", "let b = 2"]);
    assert_eq!(codes("a {}, , b {}"), [Code::E0001]);
    assert_eq!(codes("a {}\n, b {}"), []);
    assert_eq!(items("a {}\u{c}\n\u{c}b {}\r\n"), ["a {}", "b {}"]);
}

#[test]
fn comments_are_blank_and_kept() {
    assert_eq!(items("a { // é\n b: 1 /* 2 */ }"), ["a {      \n b: 1         }"]);
    assert_eq!(items("// only"), [""; 0]);
    let comments = cut(SourceId(0), "// a\n/* b\n*/ c {} /// d\r\n", 512).comments;
    assert_eq!(comments.iter().map(|c| c.span.range()).collect::<Vec<_>>(), [0..4, 5..12, 18..23]);
}

#[test]
fn an_item_that_reads_as_written_is_borrowed() {
    let cut = cut(SourceId(0), "sphere {\n  radius: 1m\n}\n", 512);
    assert!(matches!(cut.items[0].text, std::borrow::Cow::Borrowed(_)));
}

#[test]
fn lines_join_at_operators_and_in_parentheses() {
    assert_eq!(items("let a = 1 +\n 2"), ["let a = 1 +  2"]);
    assert_eq!(items("let a = b\n |> c\n .d\n and e"), ["let a = b  |> c  .d  and e"]);
    assert_eq!(items("let a = b\n-1"), ["let a = b", "-1"]);
    assert_eq!(items("let a = (1,\n2)"), ["let a = (1, 2)"]);
    assert_eq!(items("let a =\n 1"), ["let a =  1"]);
    assert_eq!(items("a\n{ b:\n 1 }"), ["a { b:  1 }"]);
    // Inside braces line ends separate, also in parentheses.
    assert_eq!(items("f(a {\nb: 1\n}\n)"), ["f(a {\nb: 1\n} )"]);
    // What begins a field does not go on with an expression.
    assert_eq!(items("a {\nb: 1 +\nc: 2 }"), ["a {\nb: 1 +\nc: 2 }"]);
}

#[test]
fn missing_closers_stand_in_white_space() {
    assert_eq!(items("a { b: (1, 2 }"), ["a { b: (1, 2)}"]);
    assert_eq!(items("a { b: (1, 2}"), ["a { b: ?????}"]);
    assert_eq!(items("a {\n  b: (1\n  c: 2\n}"), ["a {\n  b: (1) \nc: 2\n}"]);
    assert_eq!(items("a { b: (1] }"), ["a { b: (1) }"]);
    assert_eq!(codes("a { b: (1] }"), [Code::E0002]);
}

#[test]
fn a_closer_of_what_was_left_open_is_overlooked_once() {
    let strays =
        |text| cut(SourceId(0), text, 512).strays.iter().map(|stray| stray.forgiven).collect::<Vec<_>>();
    assert_eq!(items("let a = (1\nlet b = 2) + 3"), ["let a = (1", "let b = 2  + 3"]);
    assert_eq!(strays("let a = (1\nlet b = 2)\n)"), [true, false]);
    assert_eq!(strays("let a = (1\nlet b = 2\n}"), [false]);
    // Also where the item is read once more, for the sake of its brace.
    assert_eq!(strays("let a = (1\nlet b = 2) * c {\n"), [true]);
}

#[test]
fn layout_says_where_an_unclosed_item_ends() {
    assert_eq!(items("a {\n  b: 1\n\nc {}\n"), ["a {\n  b: 1", "c {}"]);
    assert_eq!(codes("a {\n  b: 1\n\nc {}\n"), [Code::E0002]);
    // Layout alone means nothing while brackets match.
    assert_eq!(items("a {\nb {}\n}"), ["a {\nb {}\n}"]);
    assert_eq!(codes("a {\nb {}\n}"), []);
}

#[test]
fn text_ends_on_its_line() {
    assert_eq!(items("a { b: \"c }"), ["a { b: ?? }"]);
    assert_eq!(items(r#"let a = "\"{" "#), [r#"let a = "\"{""#]);
    assert_eq!(codes("let a = \"b"), [Code::E0002]);
}

#[test]
fn marks_of_the_encoding_are_overlooked_behind_white_space_too() {
    assert_eq!(items("\u{feff}\u{feff}a {}"), ["a {}"]);
    assert_eq!(items("\r\n\u{feff}\n a {}"), ["a {}"]);
    assert_eq!(items("a {}\n\u{feff}b {}").len(), 2);
}

#[test]
fn limits_skip_one_item() {
    let text = format!("let a = {}1{}\nb {{}}", "(".repeat(600), ")".repeat(600));
    let cut = cut(SourceId(0), &text, 512);
    assert_eq!(cut.items.iter().map(|item| item.skipped).collect::<Vec<_>>(), [true, false]);
    assert_eq!(codes(&text), [Code::E0406]);
}
