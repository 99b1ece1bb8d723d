//! Where the cursor is, in texts that are being typed.

use super::*;

/// The spot of a text with `|` where the cursor is, and the text as it is mended.
fn spot(marked: &str) -> (Spot, String) {
    let at = marked.find('|').unwrap();
    let text = marked.replacen('|', "", 1);
    let cursor = Cursor::new(&text, at);
    (cursor.spot.clone(), cursor.mended())
}

#[test]
fn the_place_tells_what_may_stand_there() {
    let value = |field: &str| Spot::Value(Some(field.to_string()));
    let words = |words: &[&'static str]| Spot::Keyword(words.to_vec());
    let behind = |words: &[&'static str]| Spot::Behind(words.to_vec(), None);
    for (text, wanted) in [
        ("|", Spot::Entry),
        ("sphere { ra|", Spot::Entry),
        ("sphere { radius: 1m, |", Spot::Entry),
        ("sphere {\n  radius: 1m\n  |\n}", Spot::Entry),
        ("sphere { material: |", value("material")),
        ("sphere { material: di|\nplane { }", value("material")),
        ("sphere { at: (0, |", value("at")),
        ("sphere { at: (0, cos(|", Spot::Value(None)),
        ("sphere { radius: 8|", Spot::Unit(Some("radius".into()))),
        ("sphere { radius: 8m|", Spot::Unit(Some("radius".into()))),
        ("sphere { at: (0, 1, 0)c|", Spot::Unit(Some("at".into()))),
        ("let a = |", Spot::Value(None)),
        ("let |", Spot::Nothing),
        ("sphere ba|", Spot::Nothing),
        ("material a = |", value("material")),
        ("param a: |", Spot::Type),
        ("param a: int =\nparam b: |", Spot::Type),
        ("sphere { radius: 1m +\n material: |", value("material")),
        ("param a: length = |", Spot::Value(None)),
        ("fn f(a: |", Spot::Type),
        ("fn f(a: length) -> |", Spot::Type),
        ("for i |", words(&["in"])),
        ("param n: int |", words(&["="])),
        ("param n: [int] |", words(&["="])),
        ("param n: int = 3 |", behind(&["in"])),
        ("param n: int = 3 in 1 |", behind(&["to"])),
        ("fn f(a: int) |", words(&["->"])),
        ("fn f(a: int) -> int |", words(&["="])),
        ("let q = gap |", behind(&[])),
        ("let q = if a |", behind(&["then"])),
        ("let q = (if a then b |)", behind(&["else"])),
        ("plane { place: turn(y: 3deg) |", Spot::Behind(vec![], Some("place".into()))),
        ("if a {} |", words(&["else"])),
        ("if a {} else if b {} |", words(&["else"])),
        ("if a {} else {} |", Spot::Nothing),
        ("if a { plane {} } else |", Spot::Branch),
        ("if a {} else i|", Spot::Branch),
        ("for i in a {} |", Spot::Nothing),
        ("for i in |", Spot::Value(None)),
        ("assert |", Spot::Value(None)),
        ("assert min(1, 2) > 1, |", Spot::Reason),
        ("assert a, \"b\" |", Spot::Nothing),
        ("import \"|", Spot::Path(true)),
        ("mesh { file: \"a/|\" }", Spot::Path(false)),
        ("// |", Spot::Nothing),
        ("@|", Spot::Prefix),
        ("@off |", Spot::Entry),
        ("@allow(|", Spot::Warning),
        ("@allow(\nparam a: |", Spot::Type),
        ("sphere { at: (0,\nmaterial a = |", value("material")),
        ("camera { look: a.|", Spot::Member(16)),
    ] {
        assert_eq!(spot(text).0, wanted, "{text}");
    }
}

#[test]
fn what_is_open_is_closed_before_what_follows() {
    assert_eq!(spot("sphere { ra|\nplane { }").1, "sphere { }\nplane { }");
    assert_eq!(spot("sphere { at: (0, |\nplane { }").1, "sphere { at: (0, 0)}\nplane { }");
    assert_eq!(spot("part a {\n  sphere { | }\n  let b = 1\n}").1, "part a {\n  sphere {  }\n  let b = 1\n}");
}
