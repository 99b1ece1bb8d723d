//! What must hold of any text. The fuzz targets try it on texts they make up, `tests/fuzz.rs` on those that were
//! found, and the tests of the formatter on generated ones.

use crate::dump;
use rt_lang::diagnostic::Diagnostic;
use rt_lang::eval::Limits;
use rt_lang::files::NoFiles;
use rt_lang::ide::{Stop, complete, references, rename, signatures};
use rt_lang::source::{Source, Sources};
use rt_lang::span::SourceId;
use rt_lang::syntax::ast::File;
use rt_lang::syntax::{self, parse_expression};
use rt_lang::{Options, analyse, compile as compile_scene};

const SOURCE: SourceId = SourceId(0);

/// Parsing ends, and every place lies in the text, between characters.
pub fn parse(text: &str) {
    let (file, slips) = syntax::parse(SOURCE, text);
    dump::tree(text, &file);
    dump::diagnostics(text, &slips);
    let (expr, slips) = parse_expression(SOURCE, text);
    dump::expression(text, &expr);
    dump::diagnostics(text, &slips);
}

/// Laid out again, a text is the same; its comments and its tree are those of the text before; what has a slip
/// still has it; nothing is lost; and the text begins and its lines end as they did.
pub fn fmt(text: &str) {
    let (formatted, slips) = syntax::format(SOURCE, text);
    let (before, _) = syntax::parse(SOURCE, text);
    let (after, left) = syntax::parse(SOURCE, &formatted);
    assert_eq!(said(&slips), said(&left), "slips\n{text}\n---\n{formatted}");
    assert_eq!(comments(text, &before), comments(&formatted, &after), "comments\n{text}\n---\n{formatted}");
    let (shape, again) = (dump::shape(text, &before), dump::shape(&formatted, &after));
    assert_eq!(shape, again, "tree\n{text}\n---\n{formatted}");
    assert_eq!(signs(text), signs(&formatted), "signs\n{text}\n---\n{formatted}");
    assert_eq!(syntax::format(SOURCE, &formatted).0, formatted, "again\n{text}");
    let returns = ends(text).first().copied().unwrap_or(false);
    assert!(formatted == text || ends(&formatted).iter().all(|end| *end == returns), "line ends\n{text}");
}

/// Compiling ends, and says something of every text that gives no scene.
pub fn compile(text: &str) {
    let mut sources = Sources::default();
    let id = sources.add(Source::new("fuzz.rt", text));
    // Within what a fuzzer can wait for.
    let limits = Limits { things: 10_000, levels: 16, items: 10_000, steps: 100_000, ..Limits::default() };
    let options = Options { limits, ..Options::default() };
    let compiled = compile_scene(&NoFiles, &mut sources, id, &options);
    assert!(compiled.scene.is_some() || !compiled.diagnostics.is_empty());
    dump::diagnostics(text, &compiled.diagnostics);
}

/// Whatever is asked of a text wherever, there is an answer.
pub fn ask(text: &str) {
    let limits = Limits { things: 10_000, levels: 16, items: 10_000, steps: 100_000, ..Limits::default() };
    let options = Options { limits, ..Options::default() };
    let source = Source::new("fuzz.rt", text);
    let never: Stop = &|| false;
    let Some(found) = analyse(&NoFiles, source.clone(), &options, never) else { panic!("nobody stopped it") };
    let all = 0..text.len();
    // Places all over the text, also within characters and behind its end.
    for at in (0..=text.len() + 1).step_by(1 + text.len() / 8) {
        found.hover(at);
        found.definition(at);
        found.selection(at);
        references(&[&found], &found, at, true);
        if let Some(Ok(_)) = found.renamable(at) {
            let _ = rename(&[&found], &found, at, "other");
        }
        complete(&NoFiles, &source, at, &options.limits, never);
        signatures(&NoFiles, &source, at, &options.limits, never);
    }
    found.symbols();
    found.folds();
    found.tokens(all.clone(), &|| false);
    found.colours(&|| false);
    found.hints(all.clone(), &|| false);
    found.format(all.clone());
    found.links();
    found.lenses();
    found.fixes(all);
}

fn said(slips: &[Diagnostic]) -> Vec<String> {
    slips.iter().map(|slip| format!("{} {}", slip.code.as_str(), slip.message)).collect()
}

/// Whether a return stands before each line end.
fn ends(text: &str) -> Vec<bool> {
    text.match_indices('\n').map(|(at, _)| text[..at].ends_with('\r')).collect()
}

fn comments(text: &str, file: &File) -> Vec<String> {
    let lines =
        |text: &str| text.lines().map(|line| line.trim_end_matches('\r')).collect::<Vec<_>>().join("\n");
    file.comments.iter().map(|comment| lines(text[comment.span.range()].trim_end())).collect()
}

/// What no layout adds or takes away, in an order that does not depend on where comments stand.
fn signs(text: &str) -> Vec<char> {
    let mut signs: Vec<char> =
        text.chars().filter(|&c| !c.is_whitespace() && !matches!(c, ',' | '\u{feff}')).collect();
    signs.sort_unstable();
    signs
}
