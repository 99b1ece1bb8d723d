//! One function for each thing that can be wrong with a value.

use super::{MAX_TEXTURE_LEVELS, Value};
use crate::check::{Declared, Expr, ExprKind, Function, Param, Variable};
use crate::diagnostic::{Code, Diagnostic};
use crate::math::DVec3;
use crate::schema::{Field, FieldType, KindId, Range};
use crate::span::Span;
use crate::syntax::ast::BinaryOp;
use crate::units::{self, Dim};

/// A number as a person would write it.
fn show(x: f64) -> String {
    if x == x.trunc() && x.abs() < 1e16 {
        return format!("{x}");
    }
    // To twelve digits, fewer than conversions and differences leave behind: 3cm − 5cm is −0.02m.
    let x: f64 = format!("{x:.11e}").parse().unwrap_or(x);
    let size = f64::abs(x);
    if size != 0.0 && !(1e-4..1e7).contains(&size) { format!("{x:e}") } else { format!("{x}") }
}

/// A quantity in the unit that a writer would reach for.
fn show_quantity(x: f64, dim: Dim) -> String {
    let unit = dim.example_unit();
    let factor = units::parse_unit(&unit).map_or(1.0, |unit| unit.factor);
    format!("{}{unit}", show(x / factor))
}

fn show_value(value: &Value) -> String {
    match value {
        Value::Number(x) => show(*x),
        Value::Tuple(v) | Value::Color(v) => format!("({}, {}, {})", show(v.x), show(v.y), show(v.z)),
        _ => "this".into(),
    }
}

/// `i = 2`: the turn of a loop, where its value can be said in a few words.
pub(super) fn turn(variable: &Variable, value: &Value) -> Option<String> {
    let Variable { name, dim, .. } = variable;
    let shown = match value {
        Value::Number(x) => show_quantity(*x, *dim),
        Value::Bool(value) => value.to_string(),
        Value::Text(text) => format!("\"{text}\""),
        Value::Color(_) => format!("rgb{}", show_value(value)),
        _ => return None,
    };
    Some(format!("{name} = {shown}"))
}

/// What the range of a field refuses, or none where the value lies in it.
#[inline]
pub(super) fn out_of_range(kind: KindId, field: &Field, value: &Value, expr: &Expr) -> Option<Diagnostic> {
    match value {
        // Most are.
        Value::Number(x) if field.range.contains(*x) && (*x != 0.0 || !is_direction(field.ty)) => None,
        Value::Tuple(v)
            if field.range.contains(v.min_element())
                && field.range.contains(v.max_element())
                && (*v != DVec3::ZERO || !is_direction(field.ty)) =>
        {
            None
        }
        _ => refused(kind, field, value, expr.span, is_literal(expr)),
    }
}

/// Whether a field holds a direction: every plain vector of a thing is one.
fn is_direction(ty: FieldType) -> bool {
    matches!(ty, FieldType::Tuple(3, units::NONE))
}

/// Whether a value is the number that is written, and not computed.
fn is_literal(expr: &Expr) -> bool {
    match &expr.kind {
        ExprKind::Number(_) | ExprKind::RowNumber { .. } => true,
        ExprKind::Unary { operand, .. } => is_literal(operand),
        ExprKind::Tuple(components) => components.iter().all(is_literal),
        _ => false,
    }
}

/// `literal` is whether the value stands in the text.
fn refused(kind: KindId, field: &Field, value: &Value, span: Span, literal: bool) -> Option<Diagnostic> {
    if let Value::Texture(texture) = value {
        let parts = texture.parts.iter().flatten();
        return parts.into_iter().find_map(|part| refused(kind, field, &part.value, part.span, false));
    }
    if is_direction(field.ty) && matches!(value, Value::Number(0.0) | Value::Tuple(DVec3::ZERO)) {
        return Some(no_direction(field, span));
    }
    let refused = |x: &f64| !field.range.contains(*x);
    let bad = match value {
        Value::Number(x) => Some(*x).filter(refused),
        Value::Color(c) => c.to_array().into_iter().find(refused),
        Value::Tuple(v) => match field.ty {
            FieldType::IntTuple(2) => [v.x, v.y].into_iter().find(refused),
            // A point as the target of a field that also takes a distance is not bound by the distance's range.
            FieldType::Tuple(..) => v.to_array().into_iter().find(refused),
            _ => None,
        },
        _ => None,
    };
    bad.map(|bad| beyond(kind, field, bad, span, literal))
}

/// A field with a number that its range refuses.
fn beyond(kind: KindId, field: &Field, bad: f64, span: Span, literal: bool) -> Diagnostic {
    let dim = dimension(field.ty);
    let shown = show_quantity(bad, dim);
    let allowed = allowed(field.ty, field.range);
    if is_color(field.ty) && bad > field.range.high {
        let message = format!("this `{}` reflects more than it receives", kind.get().name);
        let diagnostic = Diagnostic::new(Code::E0402, message, span);
        let help = match bad > 2.0 && bad <= 255.0 {
            true => "channels go from 0 to 1; those of 0 to 255 are written `#d94f30`",
            false => "no channel of a reflectance is above 1",
        };
        return diagnostic.at(format!("a channel of {shown}")).help(help);
    }
    let what = if is_color(field.ty) { "channels of " } else { "" };
    let message = format!("{what}`{}` must be {allowed}, this is {shown}", field.name);
    let diagnostic = Diagnostic::new(Code::E0401, message, span).at("out of range");
    match mend_of_range(field, bad, literal) {
        Some(help) => diagnostic.help(help),
        None => diagnostic,
    }
}

/// What is probably meant by a value out of range, where that is more than the range itself says.
fn mend_of_range(field: &Field, bad: f64, literal: bool) -> Option<String> {
    let Range { low, high, .. } = field.range;
    let ratio = field.ty == FieldType::Scalar(units::NONE) && high == 1.0;
    match () {
        () if field.ty == FieldType::Color => Some("channels of light begin at 0, which is black".into()),
        () if ratio && (2.0..=100.0).contains(&bad) => {
            Some(format!("a ratio may be written in percent: `{}%`", show(bad)))
        }
        () if literal && low >= 0.0 && bad < 0.0 && field.range.contains(-bad) => {
            Some(format!("without its sign it would fit: `{}`", show_quantity(-bad, dimension(field.ty))))
        }
        () => None,
    }
}

fn is_color(ty: FieldType) -> bool {
    matches!(ty, FieldType::Color | FieldType::Paint)
}

/// What the range of a texture's argument refuses.
pub(super) fn argument_out_of_range(field: &Field, value: &Value, span: Span) -> Option<Diagnostic> {
    let Value::Number(x) = value else { return None };
    if field.range.contains(*x) {
        return None;
    }
    let (allowed, shown) = (allowed(field.ty, field.range), show_quantity(*x, dimension(field.ty)));
    let message = format!("`{}` must be {allowed}, this is {shown}", field.name);
    Some(Diagnostic::new(Code::E0401, message, span).at("out of range").help(field.doc))
}

pub(super) fn no_direction(field: &Field, span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0403, format!("`{}` has length 0, and so no direction", field.name), span)
        .at("points nowhere")
        .help("such as `(0, 1, 0)` for upwards")
}

/// `scale(0)`
pub(super) fn scale_to_nothing(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0403, "a `scale` of 0 flattens all to nothing", span)
        .at("leaves no extent")
        .help("give factors other than 0; what is flat is a `disk`, or a `box` that is thin")
}

pub(super) fn too_many_textures(span: Span) -> Diagnostic {
    let message = format!("more than {MAX_TEXTURE_LEVELS} textures within each other");
    Diagnostic::new(Code::E0406, message, span)
        .at("one too many")
        .help("draw the pattern into a picture and use `image`")
}

fn dimension(ty: FieldType) -> Dim {
    match ty {
        FieldType::Scalar(dim) | FieldType::Tuple(_, dim) => dim,
        FieldType::OneOf(types) => types.iter().map(|ty| dimension(*ty)).next().unwrap_or(units::NONE),
        _ => units::NONE,
    }
}

fn allowed(ty: FieldType, range: Range) -> String {
    let dim = dimension(ty);
    // Nothing is nothing in any unit.
    let with_unit = |x: f64| if x == 0.0 { show(x) } else { show_quantity(x, dim) };
    let (low, high) = (with_unit(range.low), with_unit(range.high));
    match (range.above, range.high == f64::INFINITY) {
        (true, true) => format!("above {low}"),
        (false, true) => format!("{low} or more"),
        (true, false) => format!("above {low} and at most {high}"),
        (false, false) if ty == FieldType::Int && range.high == range.low + 1.0 => format!("{low} or {high}"),
        (false, false) => format!("from {low} to {high}"),
    }
}

pub(super) fn number_not_finite(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0407, "this number is too large to be held", span).at("not finite")
}

pub(super) fn not_finite(operator: BinaryOp, a: &Value, b: &Value, span: Span) -> Diagnostic {
    let (a, b) = (show_value(a), show_value(b));
    let message = format!("`{a} {} {b}` is not finite", operator.symbol());
    let diagnostic = Diagnostic::new(Code::E0407, message, span).at("not a number to draw with");
    match operator {
        BinaryOp::Divide => diagnostic.help("the divisor is 0, or as good as"),
        _ => diagnostic.help("the result is too large"),
    }
}

pub(super) fn inexact(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0407, "this whole number is too large to be exact", span)
        .at("beyond 2^53")
        .help("write one of the numbers with a decimal point to compute with real numbers")
}

pub(super) fn call_not_finite(function: Function, arguments: &[Value], span: Span) -> Diagnostic {
    let shown: Vec<String> = arguments.iter().map(show_value).collect();
    let message = format!("`{}({})` is not finite", function.name(), shown.join(", "));
    Diagnostic::new(Code::E0407, message, span).at("not a number to draw with")
}

pub(super) fn outside_domain(function: Function, what: &str, arguments: &[Value], span: Span) -> Diagnostic {
    let shown: Vec<String> = arguments.iter().map(show_value).collect();
    let message = format!("`{}({})` has no value", function.name(), shown.join(", "));
    Diagnostic::new(Code::E0407, message, span).at(what.to_string())
}

pub(super) fn too_many_levels(most: usize, span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0406, format!("more than {most} levels of groups, parts and calls"), span)
        .at("one level too many")
        .help("put the things of some levels into one")
}

pub(super) fn too_many_things(most: usize, span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0406, format!("more than {most} things"), span)
        .at("too many in all")
        .help("what is used within what is used multiplies; those that prototypes hold count as well")
}

pub(super) fn too_many_steps(most: u64, span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0406, format!("more than {most} steps to evaluate this file"), span)
        .at("given up here")
        .help("loops within loops, and functions that call functions, multiply")
}

pub(super) fn too_deep(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0406, "too many expressions within each other", span).at("given up here")
}

pub(super) fn long_list(most: usize, span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0406, format!("a list of more than {most} items"), span)
        .at("too long")
        .help("go through two lists, one inside the other")
}

pub(super) fn many_items(most: usize, span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0406, format!("more than {most} items in all lists together"), span).at("too many")
}

pub(super) fn few_steps(count: f64, span: Span) -> Diagnostic {
    Diagnostic::new(
        Code::E0401,
        format!("`linspace` wants two values or more, this is {}", show(count)),
        span,
    )
    .at("out of range")
    .help("the first is `a`, the last is `b`")
}

pub(super) fn index_out_of_range(index: f64, len: usize, span: Span) -> Diagnostic {
    let message = match len {
        0 => "an empty list has no items".to_string(),
        1 => format!("the one item of this list is `[0]`, this is `[{}]`", show(index)),
        len => format!("the items of this list are `[0]` to `[{}]`, this is `[{}]`", len - 1, show(index)),
    };
    Diagnostic::new(Code::E0401, message, span).at("out of range")
}

pub(super) fn param_out_of_range(param: &Param, [low, high]: [f64; 2], value: f64, span: Span) -> Diagnostic {
    let dim = match &param.declared {
        Declared::Field(ty) => dimension(*ty),
        _ => units::NONE,
    };
    let [low, high, value] = [low, high, value].map(|x| show_quantity(x, dim));
    let message = format!("`{}` must be from {low} to {high}, this is {value}", param.name);
    Diagnostic::new(Code::E0401, message, span).at("out of range").label(param.span, "declared here")
}

/// `in 20 to n`, where `n` is 1.
pub(super) fn empty_range(param: &Param, [low, high]: [f64; 2], range: Span) -> Diagnostic {
    let dim = match &param.declared {
        Declared::Field(ty) => dimension(*ty),
        _ => units::NONE,
    };
    let [low, high] = [low, high].map(|x| show_quantity(x, dim));
    Diagnostic::new(Code::E0401, format!("nothing lies from {low} to {high}"), range)
        .at("begins above its end")
        .help("the lower end comes first")
}

/// The two sides of a comparison that does not hold, as they are written to be read.
pub(super) struct Sides {
    /// `2.54cm == 3cm`
    shown: String,
    /// Whether they differ by less than that shows: by rounding.
    rounded: bool,
}

/// What stands on both sides of a comparison; none where it is none, or they cannot be said in a few words.
pub(super) fn sides(operator: BinaryOp, dim: Dim, values: &[Value; 2]) -> Option<Sides> {
    use BinaryOp::*;
    if !matches!(operator, Equal | NotEqual | Less | LessEqual | Greater | GreaterEqual) {
        return None;
    }
    let one = |value: &Value| match value {
        Value::Number(x) => Some(show_quantity(*x, dim)),
        Value::Tuple(v) => {
            let unit = dim.example_unit();
            let factor = units::parse_unit(&unit).map_or(1.0, |unit| unit.factor);
            Some(format!("{}{unit}", show_value(&Value::Tuple(*v / factor))))
        }
        Value::Bool(value) => Some(value.to_string()),
        Value::Text(text) if text.len() < 40 => Some(format!("\"{text}\"")),
        _ => None,
    };
    let [left, right] = [one(&values[0])?, one(&values[1])?];
    let rounded = left == right && operator == Equal;
    Some(Sides { shown: format!("{left} {} {right}", operator.symbol()), rounded })
}

/// What must hold does not.
pub(super) fn assertion(message: Option<&str>, condition: Span, sides: Option<Sides>) -> Diagnostic {
    let diagnostic = Diagnostic::new(Code::E0405, message.unwrap_or("this does not hold"), condition);
    match sides {
        None => diagnostic.at("does not hold"),
        Some(Sides { shown, rounded: false }) => diagnostic.at(format!("`{shown}` does not hold")),
        Some(Sides { shown, rounded: true }) => diagnostic
            .at(format!("`{shown}` but for rounding"))
            .help("computed values are rounded: ask whether they are close, as in `abs(a - b) < 1um`"),
    }
}

pub(super) fn endless_bounds(span: Span, thing: Span) -> Diagnostic {
    Diagnostic::new(Code::E0305, "this has no bounds, since a part of it has no end", span)
        .at("endless")
        .label(thing, "has no end")
        .help("ask something with an end; a `height` gives one to a hyperboloid")
}

pub(super) fn no_bounds(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0305, "there is nothing here that has bounds", span).at("empty, or in no place")
}
