//! Values in angle brackets, as other languages have them.

use super::ast::{Expr, Name};
use super::build::{Builder, Deep, Node, Rule};
use super::errors;
use super::value::{expression, invalid};
use crate::span::Span;

/// The slip `<x, y, z>`. Whether a unit is missing too is not asked: the mend shows one.
pub(super) fn triple(builder: &Builder, pair: Node) -> Deep<Expr> {
    let span = builder.span(&pair);
    let open = Span { end: span.start + 1, ..span };
    let is_triple = pair.as_str().contains(',');
    let (ends, parts): (Vec<Node>, Vec<Node>) =
        pair.into_inner().partition(|inner| inner.as_rule() == Rule::angle_end);
    let Some(end) = ends.first().filter(|_| is_triple) else {
        builder.report(errors::unexpected_value("<", open));
        return invalid(span);
    };
    let end = builder.span(end);
    builder.report(errors::angle_brackets(span, open, Span { end: end.start + 1, ..end }));
    // What is wrong inside is said as well.
    parts.into_iter().for_each(|part| {
        expression(builder, part);
    });
    invalid(span)
}

/// The slip `rgb <1, 0, 0>`. `field` is the name of the field before it, where `:` is missing behind that.
pub(super) fn color(builder: &Builder, pair: Node, field: Option<&Name>) -> Deep<Expr> {
    let span = builder.trimmed(&pair);
    let mut inner = pair.into_inner();
    let words = inner.next().expect("a colour begins with its word");
    let angled = inner.next().expect("behind the word stand its parts");
    let open = builder.span(&angled).start + 1;
    let (ends, parts): (Vec<Node>, Vec<Node>) =
        angled.into_inner().partition(|inner| inner.as_rule() == Rule::angle_end);
    let shown: Vec<&str> = parts.iter().map(|part| part.as_str().trim_ascii()).collect();
    let function = if words.as_str().contains("srgb") { "srgb" } else { "rgb" };
    // One more part is how much light goes through; what is behind `>` is nothing that a colour has.
    let close = ends.first().filter(|end| end.as_str() == ">" && shown.len() == 3);
    let close = close.filter(|_| words.as_str().ends_with("rgb")).map(|end| builder.span(end));
    let edits = close.map(|close| (Span { end: open, ..builder.span(&words) }, close));
    builder.report(errors::angled_color(function, &shown, span, field, edits));
    // What is wrong inside is said as well.
    parts.into_iter().for_each(|part| {
        expression(builder, part);
    });
    invalid(span)
}

/// Whether an entry is a value in angle brackets, as other languages have them, with or without a name before it.
pub(super) fn is_angled(pair: &Node) -> bool {
    let text = match pair.as_rule() {
        Rule::broken => pair.as_str(),
        Rule::uncoloned => pair.as_str().trim_start_matches(|c: char| c.is_alphanumeric() || c == '_'),
        _ => return false,
    };
    let inside = text.trim_ascii_start().strip_prefix('<').map(str::trim_ascii_start);
    inside.is_some_and(|inside| inside.starts_with(|c: char| c.is_ascii_digit() || "-.(".contains(c)))
}
