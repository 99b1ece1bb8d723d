//! Statements that begin with a word of their own. The grammar takes what there is; here it is said what is
//! missing.

use super::ast::{Body, Broken, Entry, Expr, ExprKind, Name, Parameter, StatementKind, TypeName};
use super::build::{Builder, Deep, Node, Rule, is_reserved};
use super::errors::{self, statements as slips};
use super::{BLANKS, RANGED_WORDS, TYPE_WORDS, branches, is_name, leading, literal, value};
use crate::span::Span;
use pest::iterators::Pairs;
use smol_str::SmolStr;

/// Whether a rule is a word of the language that only tells parts of a statement from each other.
fn is_word(rule: Rule) -> bool {
    use Rule::*;
    matches!(
        rule,
        param_word | part_word | import_word | fn_word | for_word | if_word | assert_word | in_word
    )
}

/// A statement, or what is left of one.
pub(super) fn statement<'t>(builder: &Builder<'t>, pair: Node<'t>) -> Deep<Entry> {
    let span = builder.trimmed(&pair);
    let rule = pair.as_rule();
    let mut parts = pair.into_inner();
    if rule != Rule::unfinished && parts.peek().is_some_and(|part| is_word(part.as_rule())) {
        parts.next();
    }
    if rule == Rule::import && parts.peek().is_some_and(|path| path.as_rule() == Rule::bare_path) {
        return (unquoted(builder, parts, span), 0);
    }
    if rule == Rule::function && parts.clone().any(|part| part.as_rule() == Rule::bare_parameters) {
        return (unparenthesized(builder, parts, span), 0);
    }
    if rule == Rule::repetition && parts.clone().any(|part| part.as_rule() == Rule::more_variables) {
        return (several_variables(builder, parts, span), 0);
    }
    if rule == Rule::repetition && parts.peek().is_some_and(|name| name.as_str() == "in") {
        builder.report(slips::missing_variable(Span { end: span.start + 3, ..span }));
        parts.filter(|part| part.as_rule() == Rule::body).for_each(|body| drop(builder.body(body)));
        return (Entry::Broken(Broken { name: None, span }), 0);
    }
    let open = rule == Rule::function
        && parts.clone().any(|part| part.as_rule() == Rule::parameters && !is_closed(&part));
    let (kind, depth) = match rule {
        Rule::param => param(builder, parts, span),
        Rule::part => part(builder, parts, span),
        Rule::import => import(builder, parts, span),
        Rule::function => function(builder, parts, span),
        Rule::repetition => branches::repetition(builder, parts, span),
        Rule::choice => branches::choice(builder, parts, span),
        Rule::assertion => branches::assertion(builder, parts),
        _ => return (unfinished(builder, parts, span), 0),
    };
    match kind {
        // Of neither is it known what it takes: nothing is said of its uses.
        StatementKind::Function { name, .. } if open => (Entry::Broken(Broken { name: Some(name), span }), 0),
        StatementKind::Part { name, body } if body.span.range().is_empty() => {
            (Entry::Broken(Broken { name: Some(name), span }), 0)
        }
        kind => builder.checked(builder.plain(kind, span), depth, span),
    }
}

/// Whether as many parentheses are closed in the parameters of a function as were opened.
fn is_closed(parameters: &Node) -> bool {
    let count = |sign| parameters.as_str().matches(sign).count();
    count('(') == count(')')
}

fn unfinished<'t>(builder: &Builder<'t>, mut parts: Pairs<'t, Rule>, span: Span) -> Entry {
    let word = parts.next().expect("an unfinished statement begins with its word");
    let head = parts.peek().filter(|head| head.as_rule() == Rule::before_body && word.as_str() == "for");
    builder.report(match head.filter(|head| head.as_str().starts_with('(')) {
        Some(head) => {
            let touches = !builder.all_before(head.as_span().start()).ends_with(BLANKS);
            slips::head_in_parentheses(head.as_str().trim_ascii_end(), builder.trimmed(&head), touches)
        }
        None => slips::unfinished(word.as_str(), builder.span(&word)),
    });
    // The body's own slips are still worth knowing.
    parts.filter(|part| part.as_rule() == Rule::body).for_each(|body| drop(builder.body(body)));
    Entry::Broken(Broken { name: None, span })
}

/// `fn f a: number -> number = 2 * a`: what it takes is not certain, so nothing is said of its uses.
fn unparenthesized<'t>(builder: &Builder<'t>, mut parts: Pairs<'t, Rule>, span: Span) -> Entry {
    let name = declared(builder, parts.next());
    if let Some(bare) = parts.next() {
        builder.report(slips::bare_parameters(&name.text, builder.trimmed(&bare)));
    }
    Entry::Broken(Broken { name: Some(name), span })
}

/// `for i, j in list { … }`: what the other names are to be is not known, and so neither is the body.
fn several_variables<'t>(builder: &Builder<'t>, mut parts: Pairs<'t, Rule>, span: Span) -> Entry {
    declared(builder, parts.next());
    if let Some(more) = parts.next() {
        builder.report(slips::several_variables(builder.trimmed(&more)));
    }
    parts.filter(|part| part.as_rule() == Rule::body).for_each(|body| drop(builder.body(body)));
    Entry::Broken(Broken { name: None, span })
}

/// The name that a statement gives, with a complaint where it is none.
pub(super) fn declared(builder: &Builder, pair: Option<Node>) -> Name {
    let name = builder.name(&pair.expect("the grammar puts a name here"));
    if is_reserved(&name.text) {
        builder.report(errors::reserved(&name.text, name.span));
    }
    name
}

pub(super) fn invalid(span: Span) -> Expr {
    Expr { kind: ExprKind::Invalid, span }
}

pub(super) fn empty(span: Span) -> Body {
    Body { entries: vec![], span }
}

// --- Settings, parts and files -----------------------------------------------------------------------------

fn param<'t>(builder: &Builder<'t>, mut parts: Pairs<'t, Rule>, span: Span) -> Deep<StatementKind> {
    let mut name = declared(builder, parts.next());
    let annotation = parts.next().expect("the grammar puts an annotation here");
    let has_colon = annotation.as_str().starts_with(':');
    let inner = annotation.into_inner().next().expect("an annotation holds a type");
    let absent = inner.as_rule() == Rule::type_absent;
    let named = matches!(inner.as_rule(), Rule::type_name | Rule::type_list);
    let of = format!("`{}`", name.text);
    let behind = type_first(&name, inner.as_str(), builder.trimmed(&inner)).filter(|_| !has_colon);
    let mut ty = match behind {
        Some(behind) => {
            builder.report(slips::type_first(&name, &behind));
            TypeName::Named(std::mem::replace(&mut name, behind))
        }
        // What is wrong with the name was said.
        None if absent && is_reserved(&name.text) => TypeName::Invalid(builder.behind(&inner)),
        None => {
            if !has_colon && named {
                builder.report(slips::missing_type_colon(&name.text, name.span, builder.trimmed(&inner)));
            }
            type_name(builder, inner, &of, "param")
        }
    };
    let (mut default, mut range) = (None, None);
    let mut depth = 0;
    let mut in_range = false;
    for part in parts {
        match part.as_rule() {
            Rule::assign => assigned(builder, &part, "param"),
            Rule::in_word => in_range = true,
            _ if in_range && default.is_none() && value::at_equals(&part).is_some() => {
                let Some((ends, sign, given)) = value::at_equals(&part) else { continue };
                let (ends, given) = (value::part_of(builder, ends), value::part_of(builder, given));
                let whole = Span { start: ends.0.span.start, ..span };
                builder.report(slips::range_first(&name.text, builder.span(&sign), whole));
                depth = depth.max(ends.1).max(given.1);
                (range, default) = (Some(ends.0), Some(given.0));
            }
            _ => {
                let (known, begins) = (builder.reported(), !in_range && begins_range(&part, &ty));
                let (value, deep) = value::expression(builder, part);
                depth = depth.max(deep);
                if begins {
                    builder.sink.borrow_mut().truncate(known);
                    // Of which type it is was asked first.
                    if !matches!(ty, TypeName::Invalid(_)) {
                        builder.report(errors::missing_value("in", span.after()));
                    }
                    (default, range) = (Some(invalid(value.span)), Some(invalid(span.after())));
                } else if in_range {
                    range = Some(value)
                } else {
                    default = Some(value)
                }
            }
        }
    }
    let default = default.unwrap_or_else(|| {
        let place = range.as_ref().map_or(span.after(), |_: &Expr| name.span.after());
        // Without a type, the slip is that nothing stands behind the name.
        if !absent && !matches!(ty, TypeName::Invalid(_)) {
            builder.report(slips::missing_default(&name.text, place));
        }
        // One that there is not is half typed.
        if let TypeName::Named(word) = &ty
            && !TYPE_WORDS.contains(&word.text.as_str())
        {
            ty = TypeName::Invalid(word.span);
        }
        invalid(place)
    });
    (StatementKind::Param { name, ty, default, range }, depth + 1)
}

/// `param n: int = 5 in`: whether the `in` at the end is the word of a range, and no inch.
fn begins_range(default: &Node, ty: &TypeName) -> bool {
    let TypeName::Named(ty) = ty else { return false };
    let Some(before) = default.as_str().trim_ascii_end().strip_suffix("in") else { return false };
    let mut parts = default.clone().into_inner().rev();
    // A quotient of lengths is a number, and a product of them is an area.
    let of_lengths = parts.nth(1).is_some_and(|sign| match sign.as_str().trim_ascii_end() {
        "/" => true,
        sign => sign == "*" && ty.text == "area",
    });
    RANGED_WORDS.contains(&ty.text.as_str()) && before.ends_with(super::BLANKS) && !of_lengths
}

/// `:=` where `=` should stand.
fn assigned(builder: &Builder, sign: &Node, word: &str) {
    if sign.as_str() != "=" {
        builder.report(slips::not_equals(word, builder.span(sign)));
    }
}

fn part<'t>(builder: &Builder<'t>, mut parts: Pairs<'t, Rule>, span: Span) -> Deep<StatementKind> {
    let name = declared(builder, parts.next());
    let mut parts = parts.peekable();
    let taken = parts.next_if(|part| part.as_rule() == Rule::parameters).map(|pair| {
        let place = builder.trimmed(&pair);
        let known = builder.reported();
        let taken = parameters(builder, pair);
        // One complaint about them is enough.
        if builder.reported() == known {
            builder.report(slips::part_takes(&name.text, place));
        }
        taken
    });
    let (mut body, depth) = match parts.next() {
        Some(body) if body.as_rule() == Rule::body => {
            let declares = builder.declares.replace(true);
            let body = builder.body(body);
            builder.declares.set(declares);
            body
        }
        Some(sign) => {
            builder.report(slips::part_is_no_value(&name.text, builder.span(&sign)));
            parts.for_each(|value| drop(value::expression(builder, value)));
            (empty(span.after()), 0)
        }
        None => {
            builder.report(slips::missing_block("part", span.after()));
            (empty(span.after()), 0)
        }
    };
    let params = taken.into_iter().flatten().map(|Parameter { name, ty }| {
        let (span, default) = (name.span, invalid(name.span));
        builder.plain(StatementKind::Param { name, ty, default, range: None }, span)
    });
    // They stand before the body.
    body.entries.splice(0..0, params);
    (StatementKind::Part { name, body }, depth)
}

fn import<'t>(builder: &Builder<'t>, mut parts: Pairs<'t, Rule>, span: Span) -> Deep<StatementKind> {
    let written = parts.next().expect("an import has a path");
    let place = builder.trimmed(&written);
    let path = Name { text: literal::text(builder, &written), span: place };
    let name = match (parts.next(), parts.next()) {
        (Some(_), Some(name)) => declared(builder, Some(name)),
        (given, _) => {
            let name = match given {
                Some(_) => {
                    builder.report(slips::missing_import_name(span.after()));
                    stem(&path.text).unwrap_or("")
                }
                None => unnamed(builder, &path.text, place.range().end - builder.base()),
            };
            Name { text: SmolStr::new(name), span: place.after() }
        }
    };
    (StatementKind::Import { path, name }, 1)
}

/// The name of a file where `as` does not follow its path, with a complaint.
fn unnamed<'a>(builder: &Builder<'a>, path: &'a str, end: usize) -> &'a str {
    let rest = builder.after(end);
    let line = rest.split('\n').next().unwrap_or("");
    let start = end + line.len() - line.trim_start_matches(BLANKS).len();
    let words: Vec<&str> = line.split_ascii_whitespace().collect();
    let (name, edit, place) = match words[..] {
        [] => (stem(path), stem(path).map(|name| format!(" as {name}")), builder.at(end, end)),
        [name] if is_name(name) => (Some(name), Some(" as".into()), builder.at(end, end)),
        [sign @ ("=" | "sa" | "is" | "AS" | "As"), name] if is_name(name) => {
            (Some(name), Some("as".into()), builder.at(start, start + sign.len()))
        }
        _ => (None, None, builder.at(end, end)),
    };
    builder.report(slips::missing_as(name, edit, place));
    name.unwrap_or("")
}

/// `import lantern as l`: which file is meant is not certain, so none is read.
fn unquoted<'t>(builder: &Builder<'t>, mut parts: Pairs<'t, Rule>, span: Span) -> Entry {
    let written = parts.next().expect("an import has a path");
    let place = builder.trimmed(&written);
    let path = written.as_str().trim_ascii_end();
    if let Some((name, quoted)) = path.split_once(" from ").map(|(name, path)| (name.trim(), path.trim()))
        && is_name(name)
        && quoted.len() > 2
        && quoted.starts_with('"')
        && quoted.ends_with('"')
    {
        builder.report(slips::path_behind(name, quoted, place));
        let name = Name { text: name.into(), span: Span { end: place.start + name.len() as u32, ..place } };
        return Entry::Broken(Broken { name: Some(name), span });
    }
    if !path.contains('\u{1}') {
        builder.report(slips::bare_path(path, place));
    }
    let named = parts.find(|part| part.as_rule() == Rule::word).map(|name| declared(builder, Some(name)));
    let name = named.or_else(|| is_name(path).then(|| Name { text: SmolStr::new(path), span: place }));
    Entry::Broken(Broken { name, span })
}

/// What a file is called, if that can be a name.
fn stem(path: &str) -> Option<&str> {
    let file = path.rsplit('/').next()?;
    let stem = file.strip_suffix(".rt")?;
    is_name(stem).then_some(stem)
}

// --- Functions ---------------------------------------------------------------------------------------------

fn function<'t>(builder: &Builder<'t>, parts: Pairs<'t, Rule>, span: Span) -> Deep<StatementKind> {
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
            result = type_name(builder, parts.next().expect("a type follows"), "the result", "fn");
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

fn parameters(builder: &Builder, pair: Node) -> Vec<Parameter> {
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
fn type_first(ty: &Name, behind: &str, place: Span) -> Option<Name> {
    let word = behind.trim_ascii();
    let start = place.end - word.len() as u32;
    let swapped = is_name(word) && TYPE_WORDS.contains(&ty.text.as_str()) && !TYPE_WORDS.contains(&word);
    swapped.then(|| Name { text: SmolStr::new(word), span: Span { start, ..place } })
}

/// A type, of what is said in `of` in the statement that begins with `word`.
fn type_name(builder: &Builder, pair: Node, of: &str, word: &str) -> TypeName {
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
