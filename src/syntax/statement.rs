//! Statements that begin with a word of their own. The grammar takes what there is; here it is said what is
//! missing.

use super::ast::{Body, Broken, Entry, Expr, ExprKind, Keyword, Name, Parameter, StatementKind, TypeName};
use super::build::{Builder, Deep, Node, Rule, is_reserved};
use super::errors::{self, statements as slips};
use super::functions::{function, is_closed, parameters, type_first, type_name};
use super::{BLANKS, RANGED_WORDS, TYPE_WORDS, branches, is_name, literal, value};
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

fn unfinished<'t>(builder: &Builder<'t>, mut parts: Pairs<'t, Rule>, span: Span) -> Entry {
    let word = parts.next().expect("an unfinished statement begins with its word");
    if builder.digit_first(word.as_str(), word.as_span().end()) {
        return Entry::Broken(Broken { name: None, span });
    }
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

impl<'t> Builder<'t> {
    /// `let a = 5`, `material glass = dielectric {}`
    pub(super) fn definition(&self, keyword: &Node, mut inner: Pairs<'t, Rule>, span: Span) -> Deep<Entry> {
        let name = self.name(&inner.next().expect("a definition has a name"));
        let sign = inner.next().expect("a definition has `=` or `:`");
        let bare = keyword.as_str() == "material"
            && inner.peek().is_some_and(|value| super::branches::bare_body(&value).is_some());
        let (value, depth) = match bare {
            true => self.kindless("material", inner.next().expect("it was seen")),
            false => self.expression(inner),
        };
        if matches!(sign.as_str(), ":" | ":=" | "==") {
            let place = self.span(&sign);
            // `let r: length 5cm`: what stands before the value is a type.
            let behind = self.after(value.span.range().end - self.base()).trim_start_matches(BLANKS);
            let is_type = matches!(value.kind, ExprKind::Name(_))
                && behind.starts_with(|c: char| c.is_alphanumeric() || "#.\"".contains(c));
            let end = if is_type { value.span.range().end - self.base() } else { sign.as_span().end() };
            let edit = self.at(name.span.range().end - self.base(), end);
            self.report(errors::colon_in_definition(keyword.as_str(), &name.text, place, edit));
        } else if let Some(ty) = sign.clone().into_inner().next() {
            let edit = self.at(name.span.range().end - self.base(), ty.as_span().end());
            self.report(errors::type_in_definition(keyword.as_str(), &name.text, self.span(&ty), edit));
        }
        if is_reserved(&name.text) {
            self.report(errors::reserved(&name.text, name.span));
        }
        let keyword = if keyword.as_str() == "let" { Keyword::Let } else { Keyword::Material };
        (self.plain(StatementKind::Definition { keyword, name, value }, span), depth)
    }
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
pub(super) fn assigned(builder: &Builder, sign: &Node, word: &str) {
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
