//! No question panics, whatever the text and wherever it is asked, and none points outside of a text.

use super::{analysed, root};
use crate::fuzz::texts;
use proptest::prelude::*;
use rt_lang::check::Function;
use rt_lang::diagnostic::Severity;
use rt_lang::eval::Limits;
use rt_lang::files::FilePath;
use rt_lang::ide::{self, CompletionKind, Symbol};
use rt_lang::source::Source;
use rt_lang::span::Span;

/// Asks everything there is at a byte.
fn ask(text: &str, at: usize) {
    let limits = Limits { things: 1000, steps: 10_000, ..Limits::default() };
    let analysis = analysed(&root(), "any.rt", text);
    let sound =
        |span: Span| assert!(analysis.sources.get(span.source).text.get(span.range()).is_some(), "{text}");
    let all = 0..text.len();
    let (mut last, mut around) = (0, None::<Span>);
    for token in analysis.tokens(all.clone(), &|| false) {
        sound(token.span);
        assert!(token.span.range().start >= last, "tokens overlap in {text}");
        last = token.span.range().end;
    }
    for span in analysis.selection(at) {
        sound(span);
        assert!(around.is_none_or(|inner| span.contains(inner)), "{text}");
        around = Some(span);
    }
    analysis.folds().iter().for_each(|fold| sound(fold.span));
    analysis.links().iter().for_each(|link| sound(link.span));
    analysis.lenses().iter().for_each(|lens| sound(lens.span));
    analysis.colours(&|| false).iter().for_each(|colour| sound(colour.span));
    analysis.symbols().iter().for_each(|symbol| {
        sound(symbol.span);
        assert!(symbol.span.contains(symbol.select), "{text}");
    });
    assert_eq!(places(&ide::outline(analysis.source())), places(&analysis.symbols()), "{text}");
    assert!(
        analysis.hints(all.clone(), &|| false).iter().all(|hint| text.is_char_boundary(hint.at)),
        "{text}"
    );
    for fix in analysis.fixes(all.clone()) {
        assert!(fix.edits.iter().all(|edit| text.get(edit.at.range.clone()).is_some()), "{text}");
    }
    analysis.format(at..at);
    analysis.present(at..at, [1.0, 0.0, 0.0]);
    analysis.present(at..text.len().max(at), [f64::NAN, 0.5, 2.0]);
    analysis.hover(at).iter().for_each(|hover| sound(hover.span));
    analysis.definition(at).iter().for_each(|found| sound(found.name));
    ide::references(&[], &analysis, at, true);
    let _ = ide::rename(&[], &analysis, at, "renamed");
    for completion in ide::complete(&root(), analysis.source(), at, &limits, &|| false) {
        assert!(text.get(completion.replace.clone()).is_some(), "{text}");
        assert!(
            completion.insert.holes.iter().all(|hole| completion.insert.text.get(hole.clone()).is_some())
        );
    }
    ide::signatures(&root(), analysis.source(), at, &limits, &|| false);
}

/// All that does not depend on what names mean.
fn places(symbols: &[Symbol]) -> Vec<(&str, Span, Span, bool)> {
    let within = symbols.iter().flat_map(|symbol| {
        let own = (symbol.name.as_str(), symbol.span, symbol.select, symbol.off);
        [vec![own], places(&symbol.children)].concat()
    });
    within.collect()
}

/// What is offered for a kind, or for a choice of two values, is a scene as it is, but for what only its writer knows.
#[test]
fn kinds_are_offered_with_values_that_fit() {
    let mut tried = 0;
    for (before, after) in [
        ("", ""),
        ("sphere { radius: 1m, material: ", " }"),
        ("camera { ", " }"),
        ("sphere { radius: ", " }"),
        ("sphere { radius: 1m, place: ", " }"),
        ("sphere { radius: 1m, material: diffuse { color: ", " } }"),
        ("camera { look: (0, 0, 0)m, from: ", " }"),
        ("camera { look: 0, from: (0, ", ", 2)m }"),
        ("render { size: (", ", 20) }"),
    ] {
        let source = Source::new("any.rt", format!("{before}{after}")).at(FilePath::root("any.rt"));
        let offered = ide::complete(&root(), &source, before.len(), &Limits::default(), &|| false);
        let kinds =
            offered.iter().filter(|offer| matches!(offer.kind, CompletionKind::Kind) || offer.label == "if");
        // A hole without a value is for a name or a file.
        for offer in kinds.filter(|offer| offer.insert.holes.iter().all(|hole| !hole.is_empty())) {
            // Something to be seen by a camera.
            let text = format!("{before}{}{after}\nsphere {{ radius: 1m }}\n", offer.insert.text);
            let analysis = analysed(&root(), "any.rt", &text);
            let errors: Vec<&str> = (analysis.diagnostics.iter())
                .filter(|said| said.severity() == Severity::Error)
                .map(|said| &*said.message)
                .collect();
            assert!(errors.is_empty(), "{text}{errors:?}");
            tried += 1;
        }
    }
    assert!(tried > 20, "{tried}");
}

/// What is said of the types of what the built-in functions take and give is so.
#[test]
fn built_in_functions_take_what_is_said_of_them() {
    let value = |ty: &str| match ty {
        "angle" => "30deg",
        "quantity" => "4m2",
        "triple" => "(1, 2, 3)m",
        "vector" => "(1, 2, 3)",
        "point" | "value" => "(1m, 2m, 3m)",
        "number" => "0.5",
        "int" => "3",
        "color" => "red",
        "texture" => "checker(red, blue, 1m)",
        "temperature" => "3000K",
        "length" => "2m",
        "thing" => "ball",
        other => panic!("nobody knows a value of type {other}"),
    };
    for function in
        Function::ALL.iter().filter(|function| !matches!(function, Function::Image | Function::Table))
    {
        for way in function.ways() {
            let named = matches!(function, Function::Turn);
            let argument = |(name, ty): &(&str, &str)| match named {
                true => format!("{name}: {}", value(ty)),
                false => value(ty).to_string(),
            };
            let taken: Vec<String> =
                way.takes.iter().filter(|(name, _)| *name != "…").map(argument).collect();
            let call = format!("{}({})", function.name(), taken.join(", "));
            let given = match way.gives {
                "quantity" | "triple" | "value" | "[value]" | "bounds" => format!("let given = {call}"),
                ty => format!("param given: {ty} = {call}"),
            };
            let text = format!("sphere ball {{ radius: 1m }}\n{given}\n");
            let analysis = analysed(&root(), "any.rt", &text);
            let said: Vec<&str> = (analysis.diagnostics.iter())
                .filter(|said| said.severity() == Severity::Error)
                .map(|said| &*said.message)
                .collect();
            assert!(said.is_empty(), "{text}{said:?}");
        }
    }
}

/// A value that is made of itself would be a cycle.
#[test]
fn a_name_is_not_offered_where_it_is_declared() {
    for begun in ["let b = 1m\nlet a = ", "let b = 1m\nfor a in ", "let b = 1m\nparam a: length = "] {
        let source = Source::new("any.rt", begun).at(FilePath::root("any.rt"));
        let offered = ide::complete(&root(), &source, begun.len(), &Limits::default(), &|| false);
        let has = |label: &str| offered.iter().any(|offer| offer.label == label);
        assert!(has("b") && !has("a"), "{begun}");
    }
}

/// Every few bytes of the cases, as if they were being typed.
#[test]
fn typed_texts_hold() {
    let mut asked = 0;
    for text in texts("tests/cases/ide").iter().chain(&texts("examples")) {
        let text = text.replace('$', "");
        for at in (0..text.len()).step_by(61).filter(|at| text.is_char_boundary(*at)) {
            ask(&text[..at], at);
            asked += 1;
        }
    }
    assert!(asked > 50, "{asked} places were asked of");
}

fn some_text() -> impl Strategy<Value = String> {
    let folders = ["tests/cases/syntax", "tests/cases/diagnostics", "tests/cases/ide"];
    let all: Vec<String> =
        folders.iter().flat_map(|folder| texts(folder)).filter(|text| text.len() < 3000).collect();
    prop::sample::select(all)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, ..ProptestConfig::default() })]

    #[test]
    fn any_edit_holds(text in some_text(), other in some_text(), places in prop::array::uniform4(0.0..1.0)) {
        let place = |text: &str, share: f64| text.floor_char_boundary((share * text.len() as f64) as usize);
        let (cut, from) = (place(&text, places[0]), place(&other, places[1]));
        let edited = format!("{}{}{}", &text[..cut], &other[from..place(&other, places[1] + 0.1).max(from)], &text[cut..]);
        let at = place(&edited, places[2]);
        ask(&edited, at);
        ask(&edited[..at], at);
        ask(&edited, edited.len() + 7);
    }
}
