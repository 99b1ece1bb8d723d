//! What is said of what stands at a place.

use super::walk::{Declared, Piece, whole};
use super::{Analysis, Hover, say};
use crate::check::{Function, Meaning, Type, describe_wanted, texture_parameters};
use crate::color;
use crate::eval::Seen;
use crate::schema::{Category, KindId, PLACED, Preset};
use crate::span::Span;
use crate::syntax::ast::{Expr, ExprKind, Statement, StatementKind};
use crate::units;

/// What can be said of what stands at a byte.
pub(super) fn hover(analysis: &Analysis, at: usize) -> Option<Hover> {
    match analysis.named(at) {
        Some((span, meaning)) => named(analysis, span, meaning),
        None => literal(analysis, at),
    }
}

fn named(analysis: &Analysis, span: Span, meaning: Meaning) -> Option<Hover> {
    let plain = |code: String, doc: String| Hover { span, code, value: None, doc, colour: None };
    Some(match meaning {
        Meaning::Declared(place) => return declared(analysis, span, place),
        Meaning::Kind(kind) => plain(kind_code(kind), kind_doc(kind)),
        Meaning::Field(kind, index) => {
            let field = kind.field(index);
            seen_field(
                analysis,
                span,
                plain(format!("{}: {}", field.name, describe_wanted(field.ty)), say::field(field)),
            )
        }
        Meaning::Placed(index) => {
            let field = &PLACED[index];
            seen_field(
                analysis,
                span,
                plain(format!("{}: {}", field.name, describe_wanted(field.ty)), say::field(field)),
            )
        }
        Meaning::Function(function) => called(analysis, plain(say::ways(function), function_doc(function))),
        Meaning::Color(index) => {
            let (name, digits) = color::NAMED.get(index)?;
            let colour = color::from_hex(digits).map(say::displayed);
            Hover { colour, ..plain(format!("{name} // #{digits}"), String::new()) }
        }
        Meaning::Word(word) => plain(word.name.into(), word.doc.into()),
        Meaning::Component => component(analysis, span)?,
    })
}

/// A function, with what its call at the place gives.
fn called(analysis: &Analysis, hover: Hover) -> Hover {
    let mut found = None;
    analysis.walk(hover.span.source, hover.span.range(), &mut |piece| {
        if let Piece::Expr(Expr { kind: ExprKind::Call { function, .. }, span }) = piece
            && function.rest.last().unwrap_or(&function.first).span == hover.span
        {
            found = Some(*span);
        }
    });
    with_value(analysis, hover, found)
}

/// A field with what its value comes to, also where it is asked for behind a point.
fn seen_field(analysis: &Analysis, span: Span, hover: Hover) -> Hover {
    let mut found = None;
    analysis.walk(span.source, span.range(), &mut |piece| match piece {
        Piece::Field(field) if field.name.span == span => found = Some(field.value.span),
        Piece::Expr(Expr { kind: ExprKind::Member { member, .. }, span: all }) if member.span == span => {
            found = Some(*all);
        }
        _ => {}
    });
    with_value(analysis, hover, found)
}

/// With what the expression at a place came to.
fn with_value(analysis: &Analysis, hover: Hover, found: Option<Span>) -> Hover {
    match found {
        Some(place) => Hover { value: value(analysis, place), colour: colour(analysis, place), ..hover },
        None => hover,
    }
}

/// A name that a file declares.
fn declared(analysis: &Analysis, span: Span, place: Span) -> Option<Hover> {
    let ty = analysis.study.notes.declared(place).cloned().unwrap_or(Type::Invalid);
    let text = |span: Span| analysis.sources.text(span).to_string();
    let mut hover = analysis.declared(place, |declared| match declared {
        Declared::Statement(statement) => of_statement(analysis, statement, &ty),
        Declared::Parameter(parameter) => {
            let code = format!("{}: {}", parameter.name.text, say::ty(&ty));
            Hover { span, code, value: None, doc: String::new(), colour: None }
        }
        Declared::Variable(statement) => {
            let found = analysis.study.values.get(&place);
            let shown = found.and_then(|seen| say::value(seen, Some(&ty)));
            let code = match &statement.kind {
                StatementKind::For { variable, list, .. } => {
                    format!("for {} in {} // {}", variable.text, first_line(&text(list.span)), say::ty(&ty))
                }
                _ => text(place),
            };
            Hover { span, code, value: shown, doc: String::new(), colour: colour(analysis, place) }
        }
    })?;
    hover.span = span;
    Some(match ty {
        Type::Function(_) => called(analysis, hover),
        _ => hover,
    })
}

fn of_statement(analysis: &Analysis, statement: &Statement, ty: &Type) -> Hover {
    let text = |span: Span| first_line(analysis.sources.text(span));
    let head = analysis.sources.head(statement.span);
    let (code, place) = match &statement.kind {
        StatementKind::Definition { name, value, .. } => {
            let made = matches!(value.kind, ExprKind::Construct(_));
            let code = match made || *ty == Type::Invalid {
                true => format!("{head}{}", if made { " { … }" } else { "" }),
                false => format!("{} // {}", text(statement.span), say::ty(ty)),
            };
            (code, Some((name.span, value.span)))
        }
        StatementKind::Param { name, .. } => (text(statement.span), Some((name.span, name.span))),
        StatementKind::Function { value, .. } => {
            let signature = Span { end: value.span.start, ..statement.span };
            (text(signature).trim_end().trim_end_matches('=').trim_end().into(), None)
        }
        StatementKind::Import { .. } => (text(statement.span), None),
        StatementKind::Part { .. } => (format!("{head} {{ … }}{}", params(analysis, statement)), None),
        _ => (format!("{head} {{ … }}"), None),
    };
    let doc = statement.doc.as_ref().map(|doc| doc.to_string()).unwrap_or_default();
    let (shown, colour) = match place {
        Some((name, value)) => (
            seen(analysis, name, value).and_then(|seen| say::value(seen, Some(ty))),
            colour(analysis, value).or(colour(analysis, name)),
        ),
        None => (None, None),
    };
    // What is written out is not said again.
    let value = shown.filter(|value| !code.split([' ', '\n']).any(|word| word == value));
    Hover { span: statement.span, code, value, doc, colour }
}

/// The params of a part, a line each.
fn params(analysis: &Analysis, part: &Statement) -> String {
    let StatementKind::Part { body, .. } = &part.kind else { return String::new() };
    let params = body.entries.iter().filter_map(|entry| match entry {
        crate::syntax::ast::Entry::Statement(statement) => match statement.kind {
            StatementKind::Param { .. } => Some(first_line(analysis.sources.text(statement.span))),
            _ => None,
        },
        _ => None,
    });
    params.map(|param| format!("\n{param}")).collect()
}

fn first_line(text: &str) -> String {
    let line = text.lines().next().unwrap_or("").trim_end();
    match text.contains('\n') {
        true => format!("{line} …"),
        false => line.to_string(),
    }
}

/// What an expression, or a param by its name, came to.
fn seen(analysis: &Analysis, name: Span, value: Span) -> Option<&Seen> {
    let values = &analysis.study.values;
    values.get(&value).or_else(|| values.get(&name))
}

/// What an expression came to, as the language writes it.
pub(super) fn value(analysis: &Analysis, place: Span) -> Option<String> {
    let seen = analysis.study.values.get(&place)?;
    say::value(seen, analysis.study.notes.type_of(place))
}

/// The colour that an expression is.
fn colour(analysis: &Analysis, place: Span) -> Option<[f64; 3]> {
    match analysis.study.values.get(&place) {
        Some(Seen::Color(color)) => Some(say::displayed(*color)),
        Some(_) => None,
        None => {
            let text = analysis.sources.text(place);
            let written = match analysis.meaning(place) {
                Some(Meaning::Color(_)) => color::named(text),
                _ => text.strip_prefix('#').and_then(color::from_hex),
            };
            written.map(say::displayed)
        }
    }
}

/// A component, corner or column: what it is follows from the expression that ends with it.
fn component(analysis: &Analysis, span: Span) -> Option<Hover> {
    let mut found = None;
    analysis.walk(span.source, span.range(), &mut |piece| {
        if let Piece::Expr(Expr { kind: ExprKind::Member { member, .. }, span: all }) = piece
            && member.span == span
        {
            found = Some(*all);
        }
    });
    let all = found?;
    let ty = analysis.study.notes.type_of(all)?;
    let code = format!("{} // {}", first_line(analysis.sources.text(all)), say::ty(ty));
    Some(Hover { span, code, value: value(analysis, all), doc: String::new(), colour: None })
}

/// A number with its unit, or a colour.
fn literal(analysis: &Analysis, at: usize) -> Option<Hover> {
    let mut found: Option<Hover> = None;
    analysis.walk(analysis.main, at..at, &mut |piece| {
        let Piece::Expr(expr) = piece else { return };
        let code = analysis.sources.text(expr.span).to_string();
        let hover = Hover { span: expr.span, code, value: None, doc: String::new(), colour: None };
        match &expr.kind {
            ExprKind::Quantity { value, unit } => {
                let Ok(unit) = units::parse_unit(&unit.text) else { return };
                let shown = say::quantity(value * unit.factor, unit.dim);
                let value = Some(shown).filter(|shown| *shown != hover.code);
                found = Some(Hover { value, doc: unit.dim.to_string(), ..hover });
            }
            ExprKind::Color(digits) => {
                found = Some(Hover { colour: color::from_hex(digits).map(say::displayed), ..hover });
            }
            _ => {}
        }
    });
    found
}

/// How a thing of a kind is written: its name, and the fields that it needs.
pub(super) fn kind_code(kind: KindId) -> String {
    let needed: Vec<String> = (kind.fields())
        .filter(|field| field.default == Preset::Required)
        .map(|field| format!("{}: {}", field.name, describe_wanted(field.ty)))
        .collect();
    match needed.is_empty() {
        true => format!("{} {{ }}", kind.get().name),
        false => format!("{} {{ {} }}", kind.get().name, needed.join(", ")),
    }
}

/// What a kind is, and its fields.
pub(super) fn kind_doc(kind: KindId) -> String {
    let own = kind.get().fields.iter();
    let fields: Vec<String> =
        own.map(|field| format!("- `{}`: {}", field.name, say::paragraph(field.doc))).collect();
    let common = match kind.get().category {
        Category::Shape | Category::Group => {
            let names: Vec<String> = PLACED.iter().map(|field| format!("`{}`", field.name)).collect();
            let and = if fields.is_empty() { "- " } else { "\n- and " };
            format!("{and}{}", names.join(", "))
        }
        _ => String::new(),
    };
    format!("{}\n\n{}{common}", say::paragraph(kind.get().doc), fields.join("\n"))
}

/// What a function gives, and what it takes where that has names.
pub(super) fn function_doc(function: Function) -> String {
    let parameters = texture_parameters(function).unwrap_or(&[]).iter();
    let parameters: String = parameters
        .map(|field| {
            let (wanted, range) = (describe_wanted(field.ty), say::range(field));
            format!(
                "\n- `{}`: {wanted}{range}; {}. {}",
                field.name,
                say::default(field),
                say::paragraph(field.doc)
            )
        })
        .collect();
    match parameters.is_empty() {
        true => function.doc().into(),
        false => format!("{}\n{parameters}", function.doc()),
    }
}

/// All of the statement that declares a name, with what stands before it.
pub(super) fn statement_of(analysis: &Analysis, place: Span) -> Option<Span> {
    analysis.declared(place, |declared| match declared {
        Declared::Statement(statement) | Declared::Variable(statement) => whole(statement),
        Declared::Parameter(_) => place,
    })
}
