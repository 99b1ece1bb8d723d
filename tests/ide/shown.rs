//! Answers as text.

use super::root;
use rt_lang::eval::Limits;
use rt_lang::ide::{self, Analysis, Completion, Edit, Insert, Symbol};
use rt_lang::source::Sources;
use rt_lang::span::Span;
use std::ops::Range;

/// The answer to what is asked of a whole file.
pub fn whole(analysis: &Analysis, question: &str) -> String {
    let all = 0..analysis.source().text.len();
    let lines: Vec<String> = match question {
        "symbols" => analysis.symbols().iter().map(|symbol| symbols(symbol, 0)).collect(),
        "outline" => ide::outline(analysis.source()).iter().map(|symbol| symbols(symbol, 0)).collect(),
        "tokens" => analysis
            .tokens(all, &|| false)
            .iter()
            .map(|token| {
                let declares = if token.declaration { ", declared" } else { "" };
                format!("{}: {:?}{declares}", text(analysis, token.span), token.kind)
            })
            .collect(),
        "folds" => analysis
            .folds()
            .iter()
            .map(|fold| format!("{} {:?}", place(&analysis.sources, fold.span), fold.kind))
            .collect(),
        "colours" => analysis
            .colours(&|| false)
            .iter()
            .map(|colour| {
                let written = text(analysis, colour.span);
                let ways = analysis.present(colour.span.range(), colour.value);
                format!("{written} is {:.3?}: {}", colour.value, ways.join(" or "))
            })
            .collect(),
        "hints" => {
            // As the text would look with them.
            let mut shown = analysis.source().text.clone();
            for hint in analysis.hints(all, &|| false).iter().rev() {
                shown.insert_str(hint.at, &format!("‹{}›", hint.text));
            }
            vec![shown]
        }
        "links" => analysis
            .links()
            .iter()
            .map(|link| format!("{}: {}", text(analysis, link.span), link.path))
            .collect(),
        "lenses" => analysis
            .lenses()
            .iter()
            .map(|lens| {
                format!("{} {:?} {:?}", place(&analysis.sources, lens.span), lens.action, lens.camera)
            })
            .collect(),
        "fixes" => vec![fixes(analysis, all)],
        "format" => vec![edits(&analysis.format(all))],
        other => panic!("nobody knows what `{other}` asks"),
    };
    lines.join("\n")
}

/// The answer to what is asked at a byte.
pub fn at(analysis: &Analysis, at: usize, question: &str) -> String {
    let (kind, argument) = question.split_once(':').unwrap_or((question, ""));
    let limits = Limits::default();
    match kind {
        "hover" => match analysis.hover(at) {
            Some(hover) => {
                let value = hover.value.map(|value| format!(" = {value}")).unwrap_or_default();
                let colour = hover.colour.map(|colour| format!(" colour {colour:.3?}")).unwrap_or_default();
                format!("{}{value}{colour}\n{}", hover.code, hover.doc)
            }
            None => "nothing".into(),
        },
        "complete" => {
            let found = ide::complete(&root(), analysis.source(), at, &limits, &|| false);
            let shown = found.iter().take(argument.parse().unwrap_or(12)).map(completion);
            shown
                .chain((found.len() > 12).then(|| format!("… {} in all", found.len())))
                .collect::<Vec<_>>()
                .join("\n")
        }
        "signature" => {
            let found = ide::signatures(&root(), analysis.source(), at, &limits, &|| false);
            let shown = found.iter().map(|signature| {
                let active = signature.active.and_then(|active| signature.parameters.get(active));
                let active = active.map(|active| signature.label[active.range.clone()].to_string());
                format!("{} at {active:?}\n{}", signature.label, signature.doc)
            });
            shown.collect::<Vec<_>>().join("\n")
        }
        "define" => match analysis.definition(at) {
            Some(found) => {
                let (name, whole) =
                    (place(&analysis.sources, found.name), place(&analysis.sources, found.whole));
                format!("{name} `{}` of {whole}", text(analysis, found.name))
            }
            None => "nowhere".into(),
        },
        "references" => {
            let found = ide::references(&[], analysis, at, true);
            let shown = found.iter().map(|location| {
                let (id, _) = analysis.source_at(&location.path).unwrap();
                place(&analysis.sources, Span::new(id, location.range.start, location.range.end))
            });
            shown.collect::<Vec<_>>().join("\n")
        }
        "renamable" => {
            format!("{:?}", analysis.renamable(at).map(|name| name.map(|name| text(analysis, name))))
        }
        "rename" => match ide::rename(&[], analysis, at, argument) {
            Ok(found) => edits(&found),
            Err(why) => format!("no: {why}"),
        },
        "select" => {
            let shown = analysis.selection(at).into_iter().map(|span| format!("{:?}", text(analysis, span)));
            shown.collect::<Vec<_>>().join("\n")
        }
        "fixes" => fixes(analysis, at..at),
        other => panic!("nobody knows what `{other}` asks"),
    }
}

fn fixes(analysis: &Analysis, range: Range<usize>) -> String {
    let shown = analysis.fixes(range).into_iter().map(|fix| {
        let code = analysis.diagnostics[fix.diagnostic].code.as_str();
        format!("{code} {}\n{}", fix.title, edits(&fix.edits))
    });
    shown.collect::<Vec<_>>().join("\n")
}

fn symbols(symbol: &Symbol, depth: usize) -> String {
    let off = if symbol.off { ", off" } else { "" };
    let mut shown =
        format!("{:1$}{2} {3:?} {4}{off}", "", 2 * depth, symbol.name, symbol.kind, symbol.detail);
    for child in &symbol.children {
        shown.push('\n');
        shown.push_str(&symbols(child, depth + 1));
    }
    shown
}

fn completion(completion: &Completion) -> String {
    let Completion { label, kind, insert, detail, rank, .. } = completion;
    format!("{rank} {label} ({kind:?}) {detail:?} {}", holes(insert))
}

/// Text with its holes marked.
fn holes(insert: &Insert) -> String {
    let mut shown = insert.text.clone();
    for hole in insert.holes.iter().rev() {
        shown.insert(hole.end, '›');
        shown.insert(hole.start, '‹');
    }
    shown.replace('\n', "⏎")
}

fn edits(edits: &[Edit]) -> String {
    let shown = edits.iter().map(|edit| format!("  {} {:?} → {:?}", edit.at.path, edit.at.range, edit.text));
    shown.collect::<Vec<_>>().join("\n")
}

fn text(analysis: &Analysis, span: Span) -> String {
    analysis.sources.text(span).to_string()
}

fn place(sources: &Sources, span: Span) -> String {
    let place = sources.place_of(span);
    format!(
        "{}:{}:{}-{}:{}",
        place.file, place.start.line, place.start.column, place.end.line, place.end.column
    )
}
