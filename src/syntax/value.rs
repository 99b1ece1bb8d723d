//! Expressions: the flat list that the grammar gives becomes a tree by precedence.

use super::BLANKS;
use super::angled;
use super::ast::{BinaryOp, Expr, ExprKind, Name, Path, UnaryOp};
use super::branches::is_half_typed;
use super::build::{Builder, Deep, Node, Rule, is_reserved};
use super::elements::{elements, group, list};
use super::errors::{self, statements};
use super::literal::{color, literal, text};
use crate::diagnostic::Diagnostic;
use crate::span::Span;
use pest::pratt_parser::{Assoc, Op, PrattParser};
use smol_str::SmolStr;
use std::sync::LazyLock;

/// The operators, the loosest first.
static PRECEDENCE: LazyLock<PrattParser<Rule>> = LazyLock::new(|| {
    let left = |rule| Op::infix(rule, Assoc::Left);
    PrattParser::new()
        .op(left(Rule::pipe))
        .op(left(Rule::or) | left(Rule::foreign_or))
        .op(left(Rule::and) | left(Rule::foreign_and))
        .op(Op::prefix(Rule::not))
        .op(left(Rule::compare) | left(Rule::foreign_compare) | left(Rule::foreign_equals))
        .op(left(Rule::to) | left(Rule::dots))
        .op(left(Rule::sum))
        .op(left(Rule::product) | left(Rule::foreign_product))
        .op(Op::prefix(Rule::negate))
        .op(left(Rule::foreign_power))
        .op(Op::postfix(Rule::member) | Op::postfix(Rule::index))
});

fn binary(symbol: &str) -> Option<BinaryOp> {
    BinaryOp::ALL.iter().copied().find(|operator| operator.symbol() == symbol)
}

pub(super) fn invalid(span: Span) -> Deep<Expr> {
    (Expr { kind: ExprKind::Invalid, span }, 1)
}

/// The tree of an expression, and its depth.
pub(super) fn expression(builder: &Builder, pair: Node) -> Deep<Expr> {
    let span = pair.as_span();
    let span = builder.at(span.start(), builder.before(span.end()).len().max(span.start()));
    let mut pairs = pair.into_inner();
    // Most expressions are one value.
    if pairs.len() == 1 {
        return primary(builder, pairs.next().expect("there is one"));
    }
    joined(builder, pairs, span)
}

/// `a = b`, which a value never is: what stands before the sign, the sign, and what stands behind it.
pub(super) fn at_equals<'t>(pair: &Node<'t>) -> Option<(Vec<Node<'t>>, Node<'t>, Vec<Node<'t>>)> {
    let mut left: Vec<Node> = pair.clone().into_inner().collect();
    let at = left.iter().position(|pair| pair.as_rule() == Rule::foreign_equals)?;
    let right = left.split_off(at + 1);
    let sign = left.pop()?;
    (!left.is_empty() && !right.is_empty()).then_some((left, sign, right))
}

/// The tree of a part of an expression.
pub(super) fn part_of(builder: &Builder, pairs: Vec<Node>) -> Deep<Expr> {
    let place = |pairs: &[Node]| match pairs {
        [first, .., last] => builder.span(first).to(builder.trimmed(last)),
        [only] => builder.trimmed(only),
        [] => builder.at(0, 0),
    };
    let span = place(&pairs);
    joined(builder, pairs.into_iter(), span)
}

/// The tree of values and the operators between them.
fn joined<'t>(builder: &Builder, pairs: impl Iterator<Item = Node<'t>> + Clone, span: Span) -> Deep<Expr> {
    // The parser calls itself for each operator of a row of prefixes.
    let mut row = 0;
    let mut last = None;
    for pair in pairs.clone() {
        if pair.as_rule() == Rule::conditional && last.is_some_and(|rule| rule != Rule::pipe) {
            let place = builder.span(&pair);
            builder.report(statements::loose_if(Span { end: place.start + 2, ..place }));
        }
        last = Some(pair.as_rule());
        row = if matches!(pair.as_rule(), Rule::negate | Rule::not) { row + 1 } else { 0 };
        if row >= builder.most_depth() {
            builder.allows(row + 1, builder.span(&pair));
            return invalid(span);
        }
    }
    PRECEDENCE
        .map_primary(|pair| primary(builder, pair))
        .map_prefix(|operator, operand| prefix(builder, &operator, operand))
        .map_postfix(|value, member| postfix(builder, value, member))
        .map_infix(|left, operator, right| infix(builder, left, &operator, right))
        .parse(pairs)
}

/// The expression, unless it is too deep.
pub(super) fn checked(builder: &Builder, expr: Expr, depth: usize, place: Span) -> Deep<Expr> {
    if builder.allows(depth, place) { (expr, depth) } else { invalid(expr.span) }
}

fn prefix(builder: &Builder, operator: &Node, (operand, depth): Deep<Expr>) -> Deep<Expr> {
    let place = builder.span(operator);
    let span = place.to(operand.span);
    let operator = if operator.as_rule() == Rule::not { UnaryOp::Not } else { UnaryOp::Negate };
    let kind = ExprKind::Unary { operator, operand: Box::new(operand) };
    checked(builder, Expr { kind, span }, depth + 1, place)
}

fn postfix(builder: &Builder, (value, depth): Deep<Expr>, pair: Node) -> Deep<Expr> {
    let place = builder.trimmed(&pair);
    let span = value.span.to(place);
    if pair.as_rule() == Rule::index {
        return index(builder, value, depth, pair);
    }
    let Some(word) = pair.into_inner().next() else {
        builder.report(errors::missing_member(place));
        return invalid(span);
    };
    let kind = ExprKind::Member { value: Box::new(value), member: builder.name(&word) };
    checked(builder, Expr { kind, span }, depth + 1, place)
}

/// `value[index]`
fn index(builder: &Builder, value: Expr, depth: usize, pair: Node) -> Deep<Expr> {
    let place = builder.trimmed(&pair);
    let span = value.span.to(place);
    let mut inner = pair.into_inner();
    let (mut index, deep) = expression(builder, inner.next().expect("the grammar puts an index here"));
    if let Some(extra) = inner.next() {
        builder.unexpected(&extra, errors::unexpected_in_index);
        index.kind = ExprKind::Invalid;
    }
    let kind = ExprKind::Index { value: Box::new(value), index: Box::new(index) };
    checked(builder, Expr { kind, span }, 1 + depth.max(deep), place)
}

fn infix(builder: &Builder, left: Deep<Expr>, operator: &Node, right: Deep<Expr>) -> Deep<Expr> {
    let ((left, left_depth), (right, right_depth)) = (left, right);
    let at = builder.span(operator);
    let span = left.span.to(right.span);
    let rule = operator.as_rule();
    if matches!(rule, Rule::foreign_power | Rule::foreign_product) && !matches!(operator.as_str(), "×" | "÷")
    {
        let function = if rule == Rule::foreign_power { "pow" } else { "mod" };
        let sign = operator.as_str();
        // `2 ** 3 ** 2`: of the first it was said.
        if matches!(left.kind, ExprKind::Invalid) {
            return invalid(span);
        }
        let before = builder.before(left.span.range().start - builder.base());
        let behind = builder.after(right.span.range().end - builder.base()).trim_start_matches(BLANKS);
        let alone = !before.ends_with(['*', '/', '%', '^', '-']) && !behind.starts_with(['*', '/', '%', '^']);
        if let (
            ExprKind::Quantity { unit, .. } | ExprKind::Scaled { unit, .. },
            ExprKind::Number { value, int: true },
            Rule::foreign_power,
        ) = (&left.kind, &right.kind, rule)
        {
            let edit = Span { start: left.span.end, end: right.span.start, ..at };
            let slip = errors::power_of_unit(sign, &unit.text, *value, at, edit);
            // `2m ^ 2` is what `2m` is times itself: only that of the unit touches it.
            let touches = edit == at;
            let unit = &unit.text;
            builder.report(match alone && touches {
                true => slip,
                false => slip
                    .help(format!(
                        "write `{unit}{value}` for the unit's power, and `a * a` for that of the value"
                    ))
                    .ask(format!("write `{unit}{value}`")),
            });
            return invalid(span);
        }
        let slip = errors::operator_for_function(sign, function, at, left.span, right.span);
        // A power is one of numbers, and whether a name is that of one is not known here.
        let certain = rule != Rule::foreign_power || alone && is_number(&left) && is_number(&right);
        // `2 ** 3 ** 2`: which of them is meant first is not known.
        let another = behind.starts_with(['^']) || behind.starts_with("**");
        builder.report(match certain {
            true => slip,
            false if another => Diagnostic { fix: None, ..slip },
            false => slip.ask(format!("write `{function}(a, b)`")),
        });
        return invalid(span);
    }
    if operator.as_str() == "|" {
        let sides = [&left, &right];
        let placement = sides.iter().any(|side| is_placement(side));
        builder.report(errors::bar(at, placement, sides.iter().any(|side| is_condition(side))));
        if !placement {
            return invalid(span);
        }
        let kind =
            ExprKind::Binary { operator: BinaryOp::Pipe, at, left: Box::new(left), right: Box::new(right) };
        return checked(builder, Expr { kind, span }, 1 + left_depth.max(right_depth), at);
    }
    // `if a =`: what is missing was said.
    if rule == Rule::foreign_equals && matches!(right.kind, ExprKind::Invalid) {
        return invalid(span);
    }
    let operator = match binary(operator.as_str()).or_else(|| foreign(builder, operator, left.span)) {
        Some(operator) => operator,
        // What is asked, or given, is not known.
        None if rule == Rule::foreign_equals => return invalid(span),
        None => {
            let edit = Span { start: left.span.end, end: right.span.start.max(at.end), ..at };
            builder.report(errors::dots(operator.as_str(), at, edit));
            BinaryOp::To
        }
    };
    let kind = ExprKind::Binary { operator, at, left: Box::new(left), right: Box::new(right) };
    checked(builder, Expr { kind, span }, 1 + left_depth.max(right_depth), at)
}

/// Whether a value is seen to be a placement.
fn is_placement(value: &Expr) -> bool {
    match &value.kind {
        ExprKind::Call { function, .. } => {
            function.rest.is_empty()
                && matches!(function.first.text.as_str(), "scale" | "turn" | "move" | "matrix")
        }
        ExprKind::Binary { operator, .. } => *operator == BinaryOp::Pipe,
        ExprKind::Paren(inner) => is_placement(inner),
        _ => false,
    }
}

/// Whether a value is seen to be a number without a unit.
fn is_number(value: &Expr) -> bool {
    use BinaryOp::*;
    match &value.kind {
        ExprKind::Number { .. } => true,
        ExprKind::Paren(inner) | ExprKind::Unary { operator: UnaryOp::Negate, operand: inner } => {
            is_number(inner)
        }
        ExprKind::Binary { operator: Add | Subtract | Multiply | Divide, left, right, .. } => {
            is_number(left) && is_number(right)
        }
        _ => false,
    }
}

/// Whether a value is seen to be true or false.
fn is_condition(value: &Expr) -> bool {
    use BinaryOp::*;
    match &value.kind {
        ExprKind::Bool(_) | ExprKind::Unary { operator: UnaryOp::Not, .. } => true,
        ExprKind::Binary { operator, .. } => {
            matches!(operator, Or | And | Equal | NotEqual | Less | LessEqual | Greater | GreaterEqual)
        }
        ExprKind::Paren(inner) => is_condition(inner),
        _ => false,
    }
}

/// The operator that goes by another sign elsewhere.
fn foreign(builder: &Builder, operator: &Node, left: Span) -> Option<BinaryOp> {
    let here = match operator.as_rule() {
        Rule::foreign_and => BinaryOp::And,
        Rule::foreign_or => BinaryOp::Or,
        Rule::foreign_equals => BinaryOp::Equal,
        Rule::foreign_product if operator.as_str() == "×" => BinaryOp::Multiply,
        Rule::foreign_product => BinaryOp::Divide,
        Rule::foreign_compare => match operator.as_str() {
            "≥" => BinaryOp::GreaterEqual,
            "===" => BinaryOp::Equal,
            "≠" | "!==" => BinaryOp::NotEqual,
            _ => BinaryOp::LessEqual,
        },
        _ => return None,
    };
    let certain = operator.as_rule() != Rule::foreign_equals || builder.asks(left);
    let place = builder.span(operator);
    builder.report(errors::foreign_operator(operator.as_str(), here.symbol(), place, certain));
    certain.then_some(here)
}

fn primary(builder: &Builder, pair: Node) -> Deep<Expr> {
    let span = builder.span(&pair);
    let leaf = |kind| (Expr { kind, span }, 1);
    match pair.as_rule() {
        Rule::literal => leaf(literal(builder, pair)),
        Rule::reference | Rule::head_reference => reference(builder, pair),
        Rule::conditional => conditional(builder, pair),
        Rule::list => list(builder, pair),
        Rule::group => group(builder, pair),
        Rule::color => leaf(color(builder, pair.as_str(), span)),
        Rule::text => leaf(ExprKind::Text(text(builder, &pair))),
        Rule::angled => angled::triple(builder, pair),
        Rule::angled_color => angled::color(builder, pair, None),
        Rule::malformed => {
            builder.report(super::literal::bad_number(builder, pair.as_str(), span));
            invalid(span)
        }
        Rule::bare_body => {
            builder.report(builder.bare_body(span));
            invalid(span)
        }
        Rule::absent | Rule::head_absent => absent(builder, &pair),
        Rule::unexpected | Rule::head_unexpected => {
            builder.unexpected(&pair, errors::unexpected_value);
            invalid(span)
        }
        // The only other rule is `reported`.
        _ => invalid(span),
    }
}

/// No value where one must stand. The place is just behind what it should follow.
fn absent(builder: &Builder, pair: &Node) -> Deep<Expr> {
    let before = builder.before(pair.as_span().start());
    let place = builder.at(before.len(), before.len());
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let word = before.len() - before.trim_end_matches(is_word).len();
    let sign = before.len() - before.trim_end_matches(|c: char| "|>=!<.:".contains(c)).len();
    let last = before.chars().next_back().map_or(0, char::len_utf8);
    let token = &before[before.len() - word.max(sign).max(last)..];
    if !token.starts_with('\u{1}') {
        builder.report(errors::missing_value(token, place));
    }
    invalid(place)
}

// --- Names, calls and parentheses ---------------------------------------------------------------------------

fn reference(builder: &Builder, pair: Node) -> Deep<Expr> {
    let span = builder.span(&pair);
    let mut inner = pair.into_inner();
    let word = inner.next().expect("a reference begins with a word");
    let leaf = |kind| (Expr { kind, span: builder.span(&word) }, 1);
    match (word.as_str(), inner.next()) {
        ("true", None) => leaf(ExprKind::Bool(true)),
        ("false", None) => leaf(ExprKind::Bool(false)),
        (name, rest) if is_reserved(name) => {
            builder.report(errors::reserved_value(name, builder.span(&word)));
            match rest {
                Some(body) if body.as_rule() == Rule::body => drop(builder.body(body)),
                Some(arguments) if arguments.as_rule() == Rule::arguments => {
                    drop(elements(builder, arguments))
                }
                _ => {}
            }
            invalid(builder.span(&word))
        }
        (name, None) => leaf(ExprKind::Name(SmolStr::new(name))),
        (_, Some(next)) => {
            let mut kind = vec![builder.name(&word)];
            let mut body = next;
            for next in inner {
                kind.push(builder.name(&body));
                body = next;
            }
            if body.as_rule() == Rule::arguments {
                return call(builder, kind, body, span);
            }
            let (made, depth) = builder.made(kind, body, span);
            checked(builder, Expr { span, ..made }, depth, span)
        }
    }
}

/// A call, behind the path to its function.
fn call(builder: &Builder, mut path: Vec<Name>, arguments: Node, span: Span) -> Deep<Expr> {
    let elements = elements(builder, arguments);
    let depth = elements.depth + 1;
    let call_end = elements.unit.as_ref().map_or(span, |_| Span { end: elements.end, ..span });
    let rest = path.split_off(1);
    let first = path.pop().expect("a function has a name");
    let kind = match elements.closed {
        true => ExprKind::Call { function: Path { first, rest }, arguments: elements.arguments },
        // How many there were to be is not known; that the parenthesis is open was said.
        false => ExprKind::Invalid,
    };
    let (call, depth) = checked(builder, Expr { kind, span: call_end }, depth, span);
    scaled(builder, call, depth, elements.unit, span)
}

/// `if condition then value else value`
fn conditional(builder: &Builder, pair: Node) -> Deep<Expr> {
    let span = builder.trimmed(&pair);
    let mut parts = pair
        .into_inner()
        .filter(|part| !matches!(part.as_rule(), Rule::if_word | Rule::then_word | Rule::else_word));
    let (condition, depth) = expression(builder, parts.next().expect("the grammar puts a condition here"));
    let known = !is_half_typed(&condition);
    let Some(then) = parts.next() else {
        if known {
            let behind = builder.after(span.range().end - builder.base()).trim_ascii_start();
            builder.report(statements::missing_then(condition.span.after(), errors::first_token(behind)));
        }
        return invalid(span);
    };
    if then.as_rule() == Rule::braces {
        let place = builder.span(&then);
        builder.report(statements::braces_in_value(Span { end: place.start + 1, ..place }));
        return invalid(span);
    }
    let (then, then_depth) = expression(builder, then);
    let Some(otherwise) = parts.next() else {
        if !matches!(then.kind, ExprKind::Invalid) {
            builder.report(statements::missing_else(then.span.after()));
        }
        return invalid(span);
    };
    let (otherwise, otherwise_depth) = expression(builder, otherwise);
    let depth = 1 + depth.max(then_depth).max(otherwise_depth);
    let span = span.to(otherwise.span);
    let (condition, then, otherwise) = (Box::new(condition), Box::new(then), Box::new(otherwise));
    checked(builder, Expr { kind: ExprKind::If { condition, then, otherwise }, span }, depth, span)
}

/// An expression with its unit behind the parenthesis, if there is one.
pub(super) fn scaled(
    builder: &Builder,
    value: Expr,
    depth: usize,
    unit: Option<Name>,
    span: Span,
) -> Deep<Expr> {
    let Some(unit) = unit else { return (value, depth) };
    let kind = ExprKind::Scaled { value: Box::new(value), unit };
    checked(builder, Expr { kind, span }, depth + 1, span)
}
