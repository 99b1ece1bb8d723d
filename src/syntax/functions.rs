//! Functions, what they take, and types.

use super::ast::{Name, Parameter, StatementKind, TypeName};
use super::build::{Builder, Deep, Node, Rule, is_reserved};
use super::errors::statements as slips;
use super::statement::{assigned, declared, invalid};
use super::{TYPE_WORDS, branches, is_name, leading, value};
use crate::span::Span;
use pest::iterators::Pairs;
use smol_str::SmolStr;

/// Whether as many parentheses are closed in the parameters of a function as were opened.
pub(super) fn is_closed(parameters: &Node) -> bool {
    let count = |sign| parameters.as_str().matches(sign).count();
    count('(') == count(')')
}

pub(super) fn function<'t>(builder: &Builder<'t>, parts: Pairs<'t, Rule>, span: Span) -> Deep<StatementKind> {
    let mut parts = parts.peekable();
    let name = declared(builder, parts.next());
    let mut place = name.span;
    let mut parameters = vec![];
    // One complaint about the head is enough.
    let mut complete = false;
    match parts.next_if(|part| part.as_rule() == Rule::parameters) {
        Some(pair) => {
            place = builder.trimmed(&pair);
            let known = builder.reported();
            let closed = is_closed(&pair);
            parameters = self::parameters(builder, pair);
            complete = closed && builder.reported() == known;
        }
        None => {
            builder.report(slips::missing_parameters(place.after()));
        }
    }
    let mut result = TypeName::Invalid(place.after());
    match parts.next_if(|part| part.as_rule() == Rule::arrow) {
        Some(arrow) => {
            let sign = arrow.as_str().trim_ascii_end();
            // Without its parameters, what the sign stands before may be one of them.
            if sign != "->" && place != name.span {
                let touches = !builder.all_before(arrow.as_span().start()).ends_with(super::BLANKS);
                builder.report(slips::wrong_arrow(sign, builder.trimmed(&arrow), touches));
            }
            let known = builder.reported();
            result = type_name(builder, parts.next().expect("a type follows"), "the result", "fn");
            complete &= builder.reported() == known;
        }
        None if complete => {
            complete = false;
            let behind = builder.after(place.range().end - builder.base()).trim_ascii_start();
            let typed = TYPE_WORDS.contains(&leading(behind, ""));
            builder.report(match typed {
                true => slips::missing_arrow(place.after()),
                false => slips::missing_type("the result", place.after(), "fn"),
            });
        }
        None => {}
    }
    let (value, depth) = match (parts.next(), parts.next()) {
        (Some(sign), Some(value)) => {
            assigned(builder, &sign, "fn");
            match branches::bare_body(&value) {
                Some(body) => {
                    let place = builder.span(&body);
                    builder.report(slips::function_braces(Span { end: place.start + 1, ..place }, true));
                    (invalid(place), 0)
                }
                None => value::expression(builder, value),
            }
        }
        (Some(body), None) => {
            let place = builder.span(&body);
            builder.report(slips::function_braces(Span { end: place.start + 1, ..place }, false));
            (invalid(place), 0)
        }
        _ => {
            if complete {
                builder.report(slips::missing_function_value(&name.text, span.after()));
            }
            (invalid(span.after()), 0)
        }
    };
    (StatementKind::Function { name, parameters, result, value }, depth + 1)
}

pub(super) fn parameters(builder: &Builder, pair: Node) -> Vec<Parameter> {
    let mut found = vec![];
    let closed = is_closed(&pair);
    for pair in pair.into_inner() {
        if pair.as_rule() == Rule::semicolon {
            builder.semicolon(&pair);
            continue;
        }
        let mut inner = pair.into_inner().peekable();
        let mut parameter = inner.next_if(|part| part.as_rule() == Rule::word).map(|name| {
            let name = declared(builder, Some(name));
            let ty = TypeName::Invalid(name.span.after());
            Parameter { name, ty }
        });
        let mut typed = false;
        for part in inner {
            let behind = parameter.as_ref().filter(|_| part.as_rule() == Rule::beyond && !typed);
            if let Some(behind) =
                behind.and_then(|first| type_first(&first.name, part.as_str(), builder.trimmed(&part)))
                && let Some(parameter) = &mut parameter
            {
                typed = true;
                builder.report(slips::type_first(&parameter.name, &behind));
                parameter.ty = TypeName::Named(std::mem::replace(&mut parameter.name, behind));
                continue;
            }
            match (&mut parameter, part.as_rule()) {
                (_, Rule::beyond) => {
                    if let Some(next) = crowded_parameter(builder, &part).filter(|_| typed) {
                        found.extend(parameter.replace(next));
                    } else if closed || !part.as_str().starts_with('(') {
                        builder.unexpected(&part, slips::in_parameters);
                    }
                    typed = true;
                }
                (Some(parameter), _) => {
                    typed = true;
                    let of = format!("`{}`", parameter.name.text);
                    parameter.ty = type_name(builder, part, &of, "fn");
                }
                (None, _) => {}
            }
        }
        if let Some(parameter) = &parameter
            && !typed
        {
            let of = format!("`{}`", parameter.name.text);
            builder.report(slips::missing_type(&of, parameter.name.span.after(), "fn"));
        }
        found.extend(parameter);
    }
    found
}

/// `i: int r: length`: a parameter behind another, without a comma between them.
fn crowded_parameter(builder: &Builder, pair: &Node) -> Option<Parameter> {
    let text = pair.as_str().trim_ascii_end();
    let (name, ty) = text.split_once(':')?;
    let (name, ty) = (name.trim_ascii(), ty.trim_ascii());
    if !is_name(name) || !TYPE_WORDS.contains(&ty) {
        return None;
    }
    let span = builder.trimmed(pair);
    let name = Name { text: name.into(), span: Span { end: span.start + name.len() as u32, ..span } };
    let ty = Name { text: ty.into(), span: Span { start: span.end - ty.len() as u32, ..span } };
    builder.report(slips::in_parameters(&name.text, name.span).fix(builder.behind(pair), ","));
    Some(Parameter { name, ty: TypeName::Named(ty) })
}

/// `int count`: the name that stands behind a type in place of before it.
pub(super) fn type_first(ty: &Name, behind: &str, place: Span) -> Option<Name> {
    let word = behind.trim_ascii();
    let start = place.end - word.len() as u32;
    let swapped = is_name(word) && TYPE_WORDS.contains(&ty.text.as_str()) && !TYPE_WORDS.contains(&word);
    swapped.then(|| Name { text: SmolStr::new(word), span: Span { start, ..place } })
}

/// A type, of what is said in `of` in the statement that begins with `word`.
pub(super) fn type_name(builder: &Builder, pair: Node, of: &str, word: &str) -> TypeName {
    let span = builder.trimmed(&pair);
    match pair.as_rule() {
        Rule::type_name => {
            let name = builder.name(&pair.into_inner().next().expect("the type has a name"));
            if is_reserved(&name.text) && &name.text != "material" {
                builder.report(slips::not_a_type(&name.text, name.span));
                return TypeName::Invalid(name.span);
            }
            TypeName::Named(name)
        }
        Rule::type_list => {
            let inner = pair.into_inner().next().expect("the list has a type");
            TypeName::List(Box::new(type_name(builder, inner, of, word)), span)
        }
        Rule::type_absent => {
            let place = builder.behind(&pair);
            builder.report(slips::missing_type(of, place, word));
            TypeName::Invalid(place)
        }
        _ => {
            builder.unexpected(&pair, slips::not_a_type);
            TypeName::Invalid(span)
        }
    }
}
