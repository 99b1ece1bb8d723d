//! What stands between parentheses, or in a list.

use super::ast::{Argument, Expr, ExprKind, Name};
use super::build::{Builder, Deep, Node, Rule};
use super::errors;
use super::literal::unit_name;
use super::value::{checked, expression, invalid, scaled};
use crate::span::Span;

/// The arguments in the parentheses of a prefix, and their depth.
pub(super) fn arguments(builder: &Builder, pair: Node) -> Deep<Vec<Argument>> {
    let Elements { arguments, depth, .. } = elements(builder, pair);
    (arguments, depth)
}

/// What stands between parentheses.
pub(super) struct Elements {
    pub(super) arguments: Vec<Argument>,
    pub(super) depth: usize,
    pub(super) unit: Option<Name>,
    /// The `=` behind the first name, where no values have names.
    equals: Option<Span>,
    /// Just behind the closing parenthesis.
    pub(super) end: u32,
    /// Whether the closing parenthesis was written.
    pub(super) closed: bool,
    /// Whether fields stand in it for want of that.
    swallows: bool,
}

pub(super) fn elements(builder: &Builder, pair: Node) -> Elements {
    let mut found = Elements {
        arguments: vec![],
        depth: 0,
        unit: None,
        equals: None,
        end: builder.span(&pair).end,
        closed: true,
        swallows: false,
    };
    let mut name = None;
    let call = !matches!(pair.as_rule(), Rule::group | Rule::list);
    let closer = if pair.as_rule() == Rule::list { "]" } else { ")" };
    for pair in pair.into_inner() {
        match pair.as_rule() {
            Rule::label => {
                let (label, sign) = label(&pair, builder);
                match sign {
                    Some(sign) if call => {
                        let edit = Span { start: label.span.end, ..sign };
                        builder.report(errors::equals_in_field(&label.text, sign, edit));
                    }
                    sign => found.equals = found.equals.or(sign),
                }
                name = Some(label);
            }
            Rule::expr => {
                let (value, depth) = expression(builder, pair);
                found.depth = found.depth.max(depth);
                found.arguments.push(Argument { name: name.take(), value });
            }
            Rule::extra => {
                builder.extra_value(&pair, closer, found.arguments.last());
                // Neither what it was to be nor how many is known.
                found.arguments.last_mut().into_iter().for_each(|last| last.value.kind = ExprKind::Invalid);
            }
            Rule::of_each => {
                let start = builder.span(&pair);
                let word = Span { end: start.start + "for".len() as u32, ..start };
                builder.report(errors::of_each(word));
                let value = Expr { kind: ExprKind::Invalid, span: start };
                found.arguments = vec![Argument { name: None, value }];
            }
            Rule::semicolon => builder.semicolon(&pair),
            _ => {
                let close = builder.span(&pair);
                // Where none was written, one may have been put into the white space before what showed that.
                found.closed = pair.as_str().starts_with([')', ']']) && !builder.is_blank(close.start);
                found.end = if found.closed { close.start + 1 } else { close.start };
                found.unit = pair.into_inner().next().map(|unit| unit_name(builder, unit));
            }
        }
    }
    found.swallows = !found.closed && builder.swallow(&mut found.arguments);
    found
}

/// `name:`, or the slip `name =`, with the place of its sign.
fn label(pair: &Node, builder: &Builder) -> (Name, Option<Span>) {
    let place = builder.trimmed(pair);
    let name = builder.name(&pair.clone().into_inner().next().expect("a label has a name"));
    let equals = pair.as_str().trim_ascii_end().ends_with('=');
    (name, equals.then_some(Span { start: place.end - 1, ..place }))
}

/// `(a)`, `(a, b)`, either with a unit behind it.
pub(super) fn group(builder: &Builder, pair: Node) -> Deep<Expr> {
    let outer = builder.span(&pair);
    let Elements { arguments, depth, unit, equals, end, closed, .. } = elements(builder, pair);
    let span = Span { end, ..outer };
    // `(a = b)`: whether they are equal is asked.
    if let ([Argument { name: Some(name), .. }], Some(sign)) = (&arguments[..], equals) {
        builder.report(errors::foreign_operator("=", "==", sign, builder.asks(name.span)));
        return invalid(span);
    }
    // One for all of them.
    if let Some(name) = arguments.iter().find_map(|argument| argument.name.as_ref()) {
        builder.report(errors::label_outside_call(&name.text, name.span));
    }
    let mut values: Vec<Expr> = arguments.into_iter().map(|argument| argument.value).collect();
    let kind = match values.len() {
        // What was to stand in them is not known; that they are open was said.
        _ if !closed => ExprKind::Invalid,
        0 => {
            builder.report(errors::empty_parentheses(span));
            ExprKind::Invalid
        }
        1 => ExprKind::Paren(Box::new(values.remove(0))),
        _ => ExprKind::Tuple(values),
    };
    let (expr, depth) = checked(builder, Expr { kind, span }, depth + 1, span);
    scaled(builder, expr, depth, unit, outer)
}

/// `[a, b]`
pub(super) fn list(builder: &Builder, pair: Node) -> Deep<Expr> {
    let span = builder.span(&pair);
    let Elements { arguments, depth, unit, end, swallows, .. } = elements(builder, pair);
    // One for all of them.
    if let Some(name) = arguments.iter().find_map(|argument| argument.name.as_ref()) {
        builder.report(errors::label_outside_call(&name.text, name.span));
    }
    if let Some(unit) = unit {
        let (open, close) = (Span { end: span.start + 1, ..span }, Span { start: end - 1, end, ..span });
        builder.report(errors::list_with_unit(unit.span, open, close));
        return invalid(span);
    }
    let values = arguments.into_iter().map(|argument| argument.value).collect();
    let kind = if swallows { ExprKind::Invalid } else { ExprKind::List(values) };
    checked(builder, Expr { kind, span }, depth + 1, span)
}
