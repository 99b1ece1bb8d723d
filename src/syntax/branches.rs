//! Repetition, choice and assertions. The grammar takes what there is; here it is said what is missing.

use super::ast::{Body, Expr, ExprKind, Name, StatementKind};
use super::build::{Builder, Deep, Node, Rule};
use super::errors::{self, statements as slips};
use super::statement::{declared, empty, invalid};
use super::{is_name, value};
use crate::span::Span;
use pest::iterators::Pairs;

pub(super) fn repetition<'t>(
    builder: &Builder<'t>,
    parts: Pairs<'t, Rule>,
    span: Span,
) -> Deep<StatementKind> {
    let mut parts = parts.peekable();
    let variable = declared(builder, parts.next());
    let mut half_typed = false;
    match parts.next_if(|part| part.as_rule() == Rule::binder) {
        Some(binder) if binder.as_str() == "in" => {}
        Some(sign) => builder.report(slips::missing_in(sign.as_str(), builder.span(&sign))),
        None if parts.peek().is_some_and(|head| head.as_str().trim_ascii().is_empty()) => {
            let mut slip = slips::missing_in("", variable.span.after());
            slip.fix = None;
            builder.report(slip);
            let list = invalid(variable.span.after());
            let body = empty(span.after());
            return (StatementKind::For { variable, list, body }, 1);
        }
        None => {
            let behind = builder.after(variable.span.range().end - builder.base()).trim_ascii_start();
            let word = errors::first_token(behind);
            let place =
                builder.at(builder.text_len() - behind.len(), builder.text_len() - behind.len() + word.len());
            let more = behind[word.len()..].trim_ascii_start();
            let body = parts.clone().find(|part| part.as_rule() == Rule::body);
            if super::leading(more, "") == "in" && is_name(word) {
                // `for each i in list { … }`
                let extra = Span { end: place.start, ..variable.span };
                let slip = slips::named_twice(&variable.text, word, extra);
                let certain = slip.fix.is_some();
                builder.report(slip);
                let variable = Name { text: word.into(), span: place };
                let (list, span) = (invalid(place), span.after());
                let (mut body, depth) = body.map_or_else(|| (empty(span), 0), |body| builder.block(body));
                // Which of them is used in the body, and as what, is not known.
                body.entries.retain(|_| certain);
                return (StatementKind::For { variable, list, body }, depth + 1);
            }
            if matches!(word, "of" | "ni" | "n" | "i" | "im" | "on" | "is" | "from")
                && !more.is_empty()
                && !more.starts_with('{')
            {
                // `for i of list { … }`
                builder.report(slips::missing_in(word, place));
                let (list, span) = (invalid(place), span.after());
                let (body, depth) = body.map_or_else(|| (empty(span), 0), |body| builder.block(body));
                return (StatementKind::For { variable, list, body }, depth + 1);
            }
            // Without a body, the word may be half typed.
            let mut slip = slips::missing_in("", variable.span.after());
            slip.fix = slip.fix.filter(|_| body.is_some());
            builder.report(slip);
            half_typed = true;
        }
    }
    let (mut list, depth) = value::expression(builder, parts.next().expect("`for` has a head"));
    // `for i i {`: no list is called like the variable.
    if half_typed && matches!(&list.kind, ExprKind::Name(name) if *name == variable.text) {
        list = invalid(list.span);
    }
    let bodies = parts.clone().filter(|part| part.as_rule() == Rule::body);
    if let (ExprKind::Name(_) | ExprKind::Member { .. }, [changed, _]) =
        (&list.kind, &bodies.collect::<Vec<_>>()[..])
    {
        let thing = list.span.to(builder.span(changed));
        builder.report(slips::changed_in_head(thing, builder.span(changed)));
        list = invalid(thing);
        parts.find(|part| part.as_rule() == Rule::body);
    }
    let (body, deep) = block(builder, &mut parts, "for", &list, span);
    (StatementKind::For { variable, list, body }, depth.max(deep) + 1)
}

/// Whether a value ends with one that is missing, or was not understood.
pub(super) fn is_half_typed(value: &Expr) -> bool {
    match &value.kind {
        ExprKind::Invalid => true,
        ExprKind::Binary { right, .. } => is_half_typed(right),
        ExprKind::Unary { operand, .. } => is_half_typed(operand),
        _ => false,
    }
}

/// The body behind a head, with a complaint where it is missing or something stands before it.
fn block<'t>(
    builder: &Builder<'t>,
    parts: &mut std::iter::Peekable<Pairs<'t, Rule>>,
    word: &str,
    head: &Expr,
    span: Span,
) -> Deep<Body> {
    let known = !is_half_typed(head);
    if let Some(before) = parts.next_if(|part| part.as_rule() == Rule::before_body) {
        let text = before.as_str().trim_ascii();
        if text.len() > 1 && text.starts_with(':') {
            // The braces that follow are those of something within.
            drop(parts.next());
            let start = before.as_span().start();
            return unbraced(builder, word, builder.at(start, start + 1), span);
        }
        if known && is_kind(text) && parts.peek().is_some_and(|body| body.as_rule() == Rule::body) {
            let start = before.as_span().end() - before.as_str().trim_ascii_start().len();
            let kind = errors::first_token(text);
            builder.report(slips::unbraced_thing(word, kind, builder.at(start, start + kind.len())));
            // The slips in the body of the thing are still worth knowing.
            parts.next().into_iter().for_each(|body| drop(builder.block(body)));
            return (empty(span.after()), 0);
        }
        if known {
            builder.unexpected(&before, slips::before_block);
        }
    }
    let colon = builder.after((head.span.range().end).saturating_sub(builder.base())).trim_ascii_start();
    if parts.peek().is_none() && colon.starts_with(':') && known {
        let start = builder.base() + builder.text_len() - colon.len();
        return unbraced(builder, word, Span::new(span.source, start, start + 1), span);
    }
    match parts.next_if(|part| part.as_rule() == Rule::body) {
        Some(body) => builder.block(body),
        None => {
            let place = head.span.after();
            if known {
                builder.report(slips::missing_block(word, place));
            }
            (empty(Span { end: span.end.max(place.start), ..place }.after()), 0)
        }
    }
}

/// Whether a text is that of a kind, and of a name behind it.
fn is_kind(text: &str) -> bool {
    let word = |path: &str| path.split('.').all(is_name);
    text.split_ascii_whitespace().count() <= 2 && text.split_ascii_whitespace().all(word)
}

/// A body without braces, as in Python. What belongs to it is not known, nor to its `else`: that is one slip.
fn unbraced(builder: &Builder, word: &str, colon: Span, span: Span) -> Deep<Body> {
    if !builder.unbraced.replace(true) {
        builder.report(errors::unbraced(word, colon));
    }
    (empty(span.after()), 0)
}

/// `head { … } else …`
pub(super) fn choice<'t>(builder: &Builder<'t>, parts: Pairs<'t, Rule>, span: Span) -> Deep<StatementKind> {
    let mut parts = parts.peekable();
    let (condition, depth) = value::expression(builder, parts.next().expect("`if` has a head"));
    if let Some(then) = parts.next_if(|part| part.as_rule() == Rule::then_word) {
        let values: Vec<Node> = parts.filter(|part| part.as_rule() == Rule::expr).collect();
        let place = builder.span(&then);
        if values.iter().all(|value| bare_body(value).is_some()) {
            builder.report(slips::then_before_block(place));
        } else {
            builder.report(slips::then_in_statement(place));
        }
        let mut bodies = values.into_iter().filter_map(|value| match bare_body(&value) {
            Some(body) => Some(builder.block(body)),
            None => {
                value::expression(builder, value);
                None
            }
        });
        let (then, deep) = bodies.next().unwrap_or_else(|| (empty(span.after()), 0));
        let otherwise = bodies.next();
        let deepest = depth.max(deep).max(otherwise.as_ref().map_or(0, |(_, depth)| *depth));
        let otherwise = otherwise.map(|(body, _)| body);
        return (StatementKind::If { condition, then, otherwise }, deepest + 1);
    }
    let (then, deep) = block(builder, &mut parts, "if", &condition, span);
    let otherwise = parts.next().map(|pair| otherwise(builder, pair));
    let deepest = depth.max(deep).max(otherwise.as_ref().map_or(0, |(_, depth)| *depth));
    let otherwise = otherwise.map(|(body, _)| body);
    (StatementKind::If { condition, then, otherwise }, deepest + 1)
}

/// The body that a value is, without a kind before it.
pub(super) fn bare_body<'t>(value: &Node<'t>) -> Option<Node<'t>> {
    let mut inner = value.clone().into_inner();
    let first = inner.next().filter(|first| first.as_rule() == Rule::bare_body)?;
    inner.next().is_none().then(|| first.into_inner().next())?
}

/// What follows `else`, or the slip `elif`.
fn otherwise<'t>(builder: &Builder<'t>, pair: Node<'t>) -> Deep<Body> {
    let mut parts = pair.into_inner();
    let word = parts.next().expect("the other choice begins with a word");
    let place = builder.span(&word);
    if word.as_rule() == Rule::elif {
        if !builder.unbraced.get() {
            builder.report(slips::else_if(word.as_str(), place));
        }
        let span = parts.clone().last().map_or(place, |last| place.to(builder.trimmed(&last)));
        let (kind, depth) = choice(builder, parts, span);
        return chained(builder, kind, depth, span);
    }
    match parts.next() {
        Some(pair) if pair.as_rule() == Rule::body => builder.block(pair),
        Some(pair) => {
            let span = builder.trimmed(&pair);
            let mut parts = pair.into_inner();
            parts.next();
            let (kind, depth) = choice(builder, parts, span);
            chained(builder, kind, depth, span)
        }
        None => {
            let behind = builder.after(place.range().end - builder.base()).trim_ascii_start();
            let thing =
                behind.split_once('{').map(|(thing, _)| thing.trim_ascii()).filter(|thing| is_kind(thing));
            match thing.filter(|thing| !thing.is_empty()) {
                Some(thing) => {
                    let start = builder.text_len() - behind.len();
                    let kind = errors::first_token(thing);
                    builder.report(slips::unbraced_thing(
                        "else",
                        kind,
                        builder.at(start, start + kind.len()),
                    ));
                }
                None if !builder.unbraced.get() => builder.report(slips::missing_else_block(place)),
                None => {}
            }
            (empty(place.after()), 0)
        }
    }
}

/// A body of one `if`.
fn chained(builder: &Builder, kind: StatementKind, depth: usize, span: Span) -> Deep<Body> {
    let (entry, depth) = builder.checked(builder.plain(kind, span), depth, span);
    (Body { entries: vec![entry], span }, depth)
}

pub(super) fn assertion<'t>(builder: &Builder<'t>, mut parts: Pairs<'t, Rule>) -> Deep<StatementKind> {
    let (mut condition, depth) = value::expression(builder, parts.next().expect("`assert` has a condition"));
    let mut inside = None;
    if let ExprKind::Tuple(values) = &mut condition.kind
        && matches!(values[..], [_, Expr { kind: ExprKind::Text(_), .. }])
    {
        let (open, close) = (condition.span.start, condition.span.end);
        let (open, close) =
            (Span { end: open + 1, ..condition.span }, Span { start: close - 1, ..condition.span });
        builder.report(slips::assert_parentheses(open, close));
        inside = values.pop();
        condition = values.remove(0);
    }
    let message = parts.next().map(|pair| {
        let start = pair.as_span().start();
        if !builder.before(start).ends_with(',') {
            builder.report(slips::missing_comma(condition.span.after()));
        }
        value::expression(builder, pair)
    });
    let deepest = depth.max(message.as_ref().map_or(0, |(_, depth)| *depth));
    let message = message.map(|(value, _)| value).or(inside);
    (StatementKind::Assert { condition, message }, deepest + 1)
}
