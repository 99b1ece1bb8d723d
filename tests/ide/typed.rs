//! What is taken from the list of a completion stands in a text that goes on behind the cursor.

use super::root;
use rt_lang::eval::Limits;
use rt_lang::files::FilePath;
use rt_lang::ide::{self, Completion};
use rt_lang::source::Source;

/// A text without the `|` at which the cursor stands, and what is offered there.
fn offered(marked: &str) -> (String, Vec<Completion>) {
    let at = marked.find('|').unwrap();
    let text = marked.replacen('|', "", 1);
    let source = Source::new("any.rt", text.as_str()).at(FilePath::root("any.rt"));
    let offered = ide::complete(&root(), &source, at, &Limits::default(), &|| false);
    (text, offered)
}

/// A text after what has this label was taken at `|`.
fn taken(marked: &str, label: &str) -> String {
    let (text, offered) = offered(marked);
    let offer = offered.iter().find(|offer| offer.label == label).unwrap_or_else(|| panic!("{marked}"));
    let (before, after) = (&text[..offer.replace.start], &text[offer.replace.end..]);
    format!("{before}{}{after}", offer.insert.text)
}

#[test]
fn what_is_written_already_is_not_written_again() {
    for (marked, label, wanted) in [
        ("sph|ere { radius: 1m }", "sphere", "sphere { radius: 1m }"),
        ("sph| ball { radius: 1m }", "sphere", "sphere ball { radius: 1m }"),
        ("sphere { rad|ius: 1m }", "radius", "sphere { radius: 1m }"),
        ("sphere { rad| : 1m }", "radius", "sphere { radius : 1m }"),
        ("sphere { radius: 1m * co|s(3deg) }", "cos", "sphere { radius: 1m * cos(3deg) }"),
        (
            "plane { material: dif|fuse { color: red } }",
            "diffuse",
            "plane { material: diffuse { color: red } }",
        ),
        (
            "fn f(a: length) -> length = a\nsphere { radius: f|(1m) }",
            "f",
            "fn f(a: length) -> length = a\nsphere { radius: f(1m) }",
        ),
        ("camera { le| { aperture: 1mm } }", "lens", "camera { lens { aperture: 1mm } }"),
        ("le| a = 3", "let", "let a = 3"),
        ("impor| \"lantern.rt\" as a", "import", "import \"lantern.rt\" as a"),
        ("@all|(unused_name, \"x\") let a = 1", "@allow", "@allow(unused_name, \"x\") let a = 1"),
        // What belongs to something else is not meant.
        ("sphere { rad| }", "radius", "sphere { radius: 1m }"),
        ("sph|\nplane { }", "sphere", "sphere { radius: 1m }\nplane { }"),
        ("sphere { radius: co| * 1m }", "cos", "sphere { radius: cos(angle) * 1m }"),
        ("sphere { rad|, at: (0, 1, 0)m }", "radius", "sphere { radius: 1m, at: (0, 1, 0)m }"),
    ] {
        assert_eq!(taken(marked, label), wanted, "{marked}");
    }
}

#[test]
fn what_cannot_stand_there_is_not_offered() {
    for (marked, label, stands) in [
        ("let a = |", "diffuse", false),
        ("let a = |", "sphere", true),
        ("let a = sphere { material: | }", "diffuse", true),
        ("material a = |", "diffuse", true),
        ("for i in |", "if", false),
        ("for i in |", "range", true),
        ("sphere { radius: | }", "if", true),
    ] {
        let (_, offered) = offered(marked);
        assert_eq!(offered.iter().any(|offer| offer.label == label), stands, "{marked}: {label}");
    }
}
