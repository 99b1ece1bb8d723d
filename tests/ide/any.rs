//! No question panics, whatever the text and wherever it is asked, and none points outside of a text.

use super::{analysed, root};
use crate::fuzz::texts;
use proptest::prelude::*;
use rt_lang::eval::Limits;
use rt_lang::ide::{self, Symbol};
use rt_lang::span::Span;

/// Asks everything there is at a byte.
fn ask(text: &str, at: usize) {
    let limits = Limits { things: 1000, steps: 10_000, ..Limits::default() };
    let analysis = analysed(&root(), "any.rt", text);
    let sound =
        |span: Span| assert!(analysis.sources.get(span.source).text.get(span.range()).is_some(), "{text}");
    let all = 0..text.len();
    let (mut last, mut around) = (0, None::<Span>);
    for token in analysis.tokens(all.clone()) {
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
    analysis.colours().iter().for_each(|colour| sound(colour.span));
    analysis.symbols().iter().for_each(|symbol| {
        sound(symbol.span);
        assert!(symbol.span.contains(symbol.select), "{text}");
    });
    assert_eq!(places(&ide::outline(analysis.source())), places(&analysis.symbols()), "{text}");
    assert!(analysis.hints(all.clone()).iter().all(|hint| text.is_char_boundary(hint.at)), "{text}");
    for fix in analysis.fixes(all.clone()) {
        assert!(fix.edits.iter().all(|edit| text.get(edit.at.range.clone()).is_some()), "{text}");
    }
    analysis.format(at..at);
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
