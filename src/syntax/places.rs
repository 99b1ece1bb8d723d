//! Goes through a tree in the order of the text, to change its places and the values of its literals.

use super::ast::{
    Argument, Body, Construct, Entry, Expr, ExprKind, Name, Path, Prefix, Statement, StatementKind, TypeName,
};
use crate::span::Span;
use smol_str::SmolStr;

/// What is done at each stop.
pub(super) trait Visit {
    /// A place.
    fn span(&mut self, span: &mut Span);
    /// A number, without or before its unit, of the literal that stands at this place.
    fn number(&mut self, value: &mut f64, at: Span);
    /// A colour's digits, of the literal that stands at this place.
    fn color(&mut self, digits: &mut SmolStr, at: Span);
}

pub(super) fn entry(entry: &mut Entry, visit: &mut impl Visit) {
    match entry {
        Entry::Field(field) => {
            name(&mut field.name, visit);
            expr(&mut field.value, visit);
        }
        Entry::Statement(inner) => statement(inner, visit),
        // Their places follow from others.
        Entry::Rows(_) => {}
        Entry::Broken(broken) => {
            visit.span(&mut broken.span);
            broken.name.iter_mut().for_each(|inner| name(inner, visit));
        }
    }
}

fn name(name: &mut Name, visit: &mut impl Visit) {
    visit.span(&mut name.span);
}

fn body(body: &mut Body, visit: &mut impl Visit) {
    visit.span(&mut body.span);
    body.entries.iter_mut().for_each(|inner| entry(inner, visit));
}

fn path(path: &mut Path, visit: &mut impl Visit) {
    name(&mut path.first, visit);
    path.rest.iter_mut().for_each(|inner| name(inner, visit));
}

fn construct(construct: &mut Construct, name_of_thing: Option<&mut Name>, visit: &mut impl Visit) {
    visit.span(&mut construct.span);
    path(&mut construct.kind, visit);
    name_of_thing.into_iter().for_each(|inner| name(inner, visit));
    body(&mut construct.body, visit);
}

fn statement(statement: &mut Statement, visit: &mut impl Visit) {
    for Prefix { name: word, arguments: given, span } in &mut statement.prefixes {
        visit.span(span);
        name(word, visit);
        given.iter_mut().for_each(|inner| arguments(inner, visit));
    }
    visit.span(&mut statement.span);
    match &mut statement.kind {
        StatementKind::Thing { name, construct: inner } => construct(inner, name.as_mut(), visit),
        StatementKind::Definition { name: inner, value, .. } => {
            name(inner, visit);
            expr(value, visit);
        }
        StatementKind::Param { name: inner, ty: annotation, default, range } => {
            name(inner, visit);
            ty(annotation, visit);
            expr(default, visit);
            range.iter_mut().for_each(|range| expr(range, visit));
        }
        StatementKind::Part { name: inner, body: members } => {
            name(inner, visit);
            body(members, visit);
        }
        StatementKind::Import { path, name: inner } => {
            name(path, visit);
            name(inner, visit);
        }
        StatementKind::Function { name: inner, parameters, result, value } => {
            name(inner, visit);
            for parameter in parameters {
                name(&mut parameter.name, visit);
                ty(&mut parameter.ty, visit);
            }
            ty(result, visit);
            expr(value, visit);
        }
        StatementKind::For { variable, list, body: members } => {
            name(variable, visit);
            expr(list, visit);
            body(members, visit);
        }
        StatementKind::If { condition, then, otherwise } => {
            expr(condition, visit);
            body(then, visit);
            otherwise.iter_mut().for_each(|otherwise| body(otherwise, visit));
        }
        StatementKind::Assert { condition, message } => {
            expr(condition, visit);
            message.iter_mut().for_each(|message| expr(message, visit));
        }
    }
}

fn ty(written: &mut TypeName, visit: &mut impl Visit) {
    match written {
        TypeName::Named(inner) => name(inner, visit),
        TypeName::List(inner, span) => {
            visit.span(span);
            ty(inner, visit);
        }
        TypeName::Invalid(span) => visit.span(span),
    }
}

fn arguments(arguments: &mut [Argument], visit: &mut impl Visit) {
    for argument in arguments {
        argument.name.iter_mut().for_each(|inner| name(inner, visit));
        expr(&mut argument.value, visit);
    }
}

fn expr(expression: &mut Expr, visit: &mut impl Visit) {
    let at = expression.span;
    visit.span(&mut expression.span);
    match &mut expression.kind {
        ExprKind::Invalid | ExprKind::Bool(_) | ExprKind::Text(_) | ExprKind::Name(_) => {}
        ExprKind::Number { value, .. } => visit.number(value, at),
        ExprKind::Quantity { value, unit } => {
            visit.number(value, at);
            name(unit, visit);
        }
        ExprKind::Color(digits) => visit.color(digits, at),
        ExprKind::Scaled { value, unit } => {
            expr(value, visit);
            name(unit, visit);
        }
        ExprKind::Tuple(values) | ExprKind::List(values) => {
            values.iter_mut().for_each(|value| expr(value, visit));
        }
        ExprKind::Paren(value) => expr(value, visit),
        ExprKind::Call { function, arguments: given } => {
            path(function, visit);
            arguments(given, visit);
        }
        ExprKind::Member { value, member } => {
            expr(value, visit);
            name(member, visit);
        }
        ExprKind::Index { value, index } => {
            expr(value, visit);
            expr(index, visit);
        }
        ExprKind::If { condition, then, otherwise } => {
            expr(condition, visit);
            expr(then, visit);
            expr(otherwise, visit);
        }
        ExprKind::Construct(inner) => construct(inner, None, visit),
        ExprKind::Unary { operand, .. } => expr(operand, visit),
        ExprKind::Binary { at, left, right, .. } => {
            expr(left, visit);
            visit.span(at);
            expr(right, visit);
        }
    }
}
