//! The ranges around a place.

use super::Analysis;
use super::lex::{Lexeme, lex};
use super::walk::{Piece, whole};
use crate::span::Span;

/// The most ranges around a place, in two halves.
const MOST: usize = 100;

/// The ranges around a byte that are units of the language, innermost first: the word, the expressions and bodies around it, the
/// file.
pub(super) fn selection(analysis: &Analysis, at: usize) -> Vec<Span> {
    let text = &analysis.source().text;
    let at = at.min(text.len());
    let all = Span::new(analysis.main, 0, text.len());
    let mut found = vec![all];
    analysis.walk(analysis.main, at..at, &mut |piece| match piece {
        Piece::Body(body) if body.span != all => {
            found.push(body.span);
            if text[body.span.range()].starts_with('{') && text[body.span.range()].ends_with('}') {
                found.push(Span::new(analysis.main, body.span.range().start + 1, body.span.range().end - 1));
            }
        }
        Piece::Statement(statement) => found.extend([whole(statement), statement.span]),
        Piece::Field(field) => found.push(field.name.span.to(field.value.span)),
        Piece::Construct(construct) => found.push(construct.span),
        Piece::Expr(expr) => found.push(expr.span),
        Piece::Argument(argument) => {
            found.extend(argument.name.as_ref().map(|name| name.span.to(argument.value.span)));
        }
        Piece::Body(_) | Piece::Type(_) => {}
    });
    let here = |range: &std::ops::Range<usize>| range.start <= at && at <= range.end;
    let word = lex(text, 0)
        .take_while(|(_, range)| range.start <= at)
        .filter(|(lexeme, range)| here(range) && !matches!(lexeme, Lexeme::Line | Lexeme::Mark));
    found.extend(word.last().map(|(_, range)| Span::new(analysis.main, range.start, range.end)));
    found.retain(|span| here(&span.range()));
    found.sort_by_key(|span| (span.range().len(), span.start));
    // Each lies in the next one.
    let mut nested: Vec<Span> = vec![];
    for span in found {
        if nested.last().is_none_or(|last| *last != span && span.contains(*last)) {
            nested.push(span);
        }
    }
    // The innermost and the outermost: clients read a chain of them as deep as it is.
    if nested.len() > MOST {
        nested.drain(MOST / 2..nested.len() - MOST / 2);
    }
    nested
}
