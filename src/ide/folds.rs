//! Lines that can be hidden.

use super::lex::{Lexeme, lex};
use super::{Analysis, Fold, FoldKind};
use crate::span::Span;
use std::ops::Range;

/// The bodies, comments and imports of more than one line, by where they begin.
pub(super) fn folds(analysis: &Analysis) -> Vec<Fold> {
    let text = &analysis.source().text;
    let mut found: Vec<(Range<usize>, FoldKind)> = vec![];
    let mut open: Vec<(u8, usize)> = vec![];
    // Lines of one sort below each other.
    let mut run: Option<(Range<usize>, FoldKind)> = None;
    let mut begins = true;
    for (lexeme, range) in lex(text, 0) {
        let sort = match lexeme {
            Lexeme::Comment if begins => Some(FoldKind::Comment),
            Lexeme::Word if begins && &text[range.clone()] == "import" => Some(FoldKind::Imports),
            _ => None,
        };
        if begins && lexeme != Lexeme::Line {
            match (&mut run, sort) {
                (Some((before, kind)), Some(sort))
                    if *kind == sort && is_next_line(text, before.end, range.start) =>
                {
                    before.end = range.end;
                }
                _ => {
                    found.extend(run.take());
                    run = sort.map(|sort| (range.clone(), sort));
                }
            }
        } else if let (Some((before, FoldKind::Imports)), false) = (&mut run, lexeme == Lexeme::Line) {
            before.end = range.end;
        }
        begins = lexeme == Lexeme::Line;
        let mark = text.as_bytes()[range.start];
        match (lexeme, mark) {
            (Lexeme::Mark, b'(' | b'[' | b'{') => open.push((mark, range.start)),
            (Lexeme::Mark, b')' | b']' | b'}') => {
                let opener = match mark {
                    b')' => b'(',
                    b']' => b'[',
                    _ => b'{',
                };
                if let Some(index) = open.iter().rposition(|(bracket, _)| *bracket == opener) {
                    found.push((open[index].1..range.end, FoldKind::Body));
                    open.truncate(index);
                }
            }
            _ => {}
        }
    }
    found.extend(run);
    found.retain(|(range, _)| text[range.clone()].contains('\n'));
    found.sort_by_key(|(range, _)| (range.start, std::cmp::Reverse(range.end)));
    let span = |range: Range<usize>| Span::new(analysis.main, range.start, range.end);
    found.into_iter().map(|(range, kind)| Fold { span: span(range), kind }).collect()
}

/// Whether nothing but one line end lies between two places.
fn is_next_line(text: &str, end: usize, start: usize) -> bool {
    let between = &text[end..start];
    between.bytes().all(|byte| byte.is_ascii_whitespace())
        && between.bytes().filter(|byte| *byte == b'\n').count() == 1
}
