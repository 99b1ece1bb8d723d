//! Numbers, units, colours and texts as they are written.

use super::ast::{ExprKind, Name};
use super::build::{Builder, Node, Rule};
use super::errors;
use crate::diagnostic::Diagnostic;
use crate::span::Span;
use smol_str::{SmolStr, SmolStrBuilder};

/// From here on not every whole number is one that is computed with: 2^53.
const INEXACT: f64 = 9_007_199_254_740_992.0;

/// A number, with or without a unit.
pub(super) fn literal(builder: &Builder, pair: Node) -> ExprKind {
    let (all, span) = (pair.as_str(), builder.span(&pair));
    let mut inner = pair.into_inner();
    let number = inner.next().expect("a literal begins with a number").as_str();
    let unit = inner.next();
    if unit.as_ref().is_some_and(|unit| is_misread(number, unit.as_str())) {
        builder.report(bad_number(builder, all, span));
        return ExprKind::Invalid;
    }
    let value = if number.contains('_') { number.replace('_', "").parse() } else { number.parse() };
    let value: f64 = value.unwrap_or(f64::INFINITY);
    if !value.is_finite() {
        builder.report(errors::huge_number(number, span));
        return ExprKind::Invalid;
    }
    let int = number.bytes().all(|b| b.is_ascii_digit() || b == b'_');
    match unit {
        Some(unit) => ExprKind::Quantity { value, unit: unit_name(builder, unit) },
        None if int && value >= INEXACT => {
            builder.report(errors::inexact_number(number, span));
            ExprKind::Invalid
        }
        None => ExprKind::Number { value, int },
    }
}

/// Whether what looks like a unit is rather the rest of a number: `0x10`.
fn is_misread(number: &str, unit: &str) -> bool {
    let hexadecimal = |rest: &str| rest.bytes().all(|b| b.is_ascii_hexdigit());
    let digits = |rest: &str| rest.bytes().all(|b| b.is_ascii_digit());
    number == "0"
        && (unit.strip_prefix(['x', 'X']).is_some_and(hexadecimal)
            || unit.strip_prefix(['b', 'o', 'B', 'O']).is_some_and(digits))
}

/// A unit, or the slip of a space before it.
pub(super) fn unit_name(builder: &Builder, pair: Node) -> Name {
    if pair.as_rule() != Rule::spaced_unit {
        return builder.name(&pair);
    }
    let start = builder.span(&pair);
    let unit = builder.name(&pair.into_inner().next().expect("behind the space stands a unit"));
    builder.report(errors::space_before_unit(&unit.text, unit.span, Span { end: unit.span.start, ..start }));
    unit
}

/// `#d94f30`
pub(super) fn color(builder: &Builder, text: &str, span: Span) -> ExprKind {
    let digits = &text[1..];
    if matches!(digits.len(), 3 | 6) && digits.bytes().all(|b| b.is_ascii_hexdigit()) {
        return ExprKind::Color(SmolStr::new(digits));
    }
    builder.report(errors::bad_color(text, span));
    ExprKind::Invalid
}

/// The text between the quotes, its escapes resolved. An unknown one is reported and stands for itself.
pub(super) fn text(builder: &Builder, pair: &Node) -> SmolStr {
    let quoted = pair.as_str();
    let inside = &quoted[1..quoted.len() - 1];
    if !inside.contains('\\') {
        return SmolStr::new(inside);
    }
    let mut resolved = SmolStrBuilder::new();
    let mut characters = inside.char_indices();
    while let Some((index, character)) = characters.next() {
        if character != '\\' {
            resolved.push(character);
            continue;
        }
        match characters.next() {
            Some((_, same @ ('"' | '\\'))) => resolved.push(same),
            Some((_, 'n')) => resolved.push('\n'),
            Some((_, 't')) => resolved.push('\t'),
            Some((_, unknown)) => {
                let start = pair.as_span().start() + 1 + index;
                let end = start + 1 + unknown.len_utf8();
                builder.report(errors::bad_escape(&format!("\\{unknown}"), builder.at(start, end)));
                resolved.push(unknown);
            }
            None => {}
        }
    }
    resolved.finish()
}

/// What is said of a number that is none. More digits may follow a point that a line ends with.
pub(super) fn bad_number(builder: &Builder, text: &str, span: Span) -> Diagnostic {
    let slip = errors::bad_number(text, span);
    let digits = text.strip_suffix('.').filter(|_| builder.ends_line(span.end));
    match digits {
        Some(digits) => slip.ask(format!("write `{digits}`")),
        None => slip,
    }
}
