//! Goes through the trees of a text in its order.

use super::{Analysis, Stop};
use crate::span::{SourceId, Span};
use crate::syntax::Rows;
use crate::syntax::ast::{
    Argument, Body, Construct, Entry, Expr, ExprKind, Field, Name, Parameter, Statement, StatementKind,
    TypeName,
};
use std::ops::Range;

/// A piece of a tree. What it holds comes behind it.
#[derive(Clone, Copy)]
pub(super) enum Piece<'t> {
    Body(&'t Body),
    Field(&'t Field),
    Statement(&'t Statement),
    Construct(&'t Construct),
    Expr(&'t Expr),
    Argument(&'t Argument),
    Type(&'t TypeName),
}

/// What a name is declared by.
#[derive(Clone, Copy)]
pub(super) enum Declared<'t> {
    /// A statement that has a name.
    Statement(&'t Statement),
    /// Something that a function takes.
    Parameter(&'t Parameter),
    /// The variable of a loop.
    Variable(&'t Statement),
}

impl Analysis {
    /// Goes through those pieces of a text that touch a range.
    pub(super) fn walk(&self, source: SourceId, range: Range<usize>, visit: &mut dyn FnMut(Piece)) {
        self.walk_until(source, range, &|| false, visit);
    }

    /// The same, which ends early once `stop` says so.
    pub(super) fn walk_until(
        &self,
        source: SourceId,
        range: Range<usize>,
        stop: Stop,
        visit: &mut dyn FnMut(Piece),
    ) {
        let Some(file) = self.study.files.iter().find(|file| file.source == source) else { return };
        let text = &self.sources.get(source).text;
        Walk { text, range, stop, visit }.body(&file.tree.body);
    }

    /// What the name at a place is declared by; none where none is declared there.
    pub(super) fn declared<T>(&self, place: Span, say: impl FnOnce(Declared) -> T) -> Option<T> {
        let (mut say, mut said) = (Some(say), None);
        self.walk(place.source, place.range(), &mut |piece| {
            let Piece::Statement(statement) = piece else { return };
            let found = match &statement.kind {
                StatementKind::Function { parameters, .. } => {
                    let parameter = parameters.iter().find(|parameter| parameter.name.span == place);
                    parameter.map(Declared::Parameter)
                }
                StatementKind::For { variable, .. } if variable.span == place => {
                    Some(Declared::Variable(statement))
                }
                _ => None,
            };
            let named = name_of(statement).filter(|name| name.span == place);
            let found = found.or(named.map(|_| Declared::Statement(statement)));
            if let Some(found) = found
                && let Some(say) = say.take()
            {
                said = Some(say(found));
            }
        });
        said
    }
}

/// The name that a statement declares around it.
pub(super) fn name_of(statement: &Statement) -> Option<&Name> {
    match &statement.kind {
        StatementKind::Thing { name, .. } => name.as_ref(),
        StatementKind::Definition { name, .. }
        | StatementKind::Param { name, .. }
        | StatementKind::Part { name, .. }
        | StatementKind::Import { name, .. }
        | StatementKind::Function { name, .. } => Some(name),
        StatementKind::For { .. } | StatementKind::If { .. } | StatementKind::Assert { .. } => None,
    }
}

/// All of a statement, with what stands before it.
pub(super) fn whole(statement: &Statement) -> Span {
    statement.prefixes.first().map_or(statement.span, |prefix| prefix.span.to(statement.span))
}

/// The rows that touch a range.
pub(super) fn rows_in(rows: &Rows, range: &Range<usize>) -> Range<usize> {
    let place = |row: usize| rows.place(row, rows.shapes()[rows.shape(row)].statement().span).range();
    let behind = |from: usize, fits: &dyn Fn(Range<usize>) -> bool| {
        let (mut low, mut high) = (from, rows.len());
        while low < high {
            let middle = low + (high - low) / 2;
            if fits(place(middle)) { low = middle + 1 } else { high = middle }
        }
        low
    };
    let first = behind(0, &|place| place.end < range.start);
    first..behind(first, &|place| place.start <= range.end)
}

/// The entries of a body that touch a range: they are in the order of the text, and none overlaps another.
pub(super) fn entries_in<'b>(body: &'b Body, range: &Range<usize>) -> &'b [Entry] {
    let place = |entry: &Entry| match entry {
        Entry::Field(field) => field.name.span.to(field.value.span).range(),
        Entry::Statement(statement) => whole(statement).range(),
        Entry::Rows(rows) => rows.span().range(),
        Entry::Broken(broken) => broken.span.range(),
    };
    let first = body.entries.partition_point(|entry| place(entry).end < range.start);
    let rest = &body.entries[first..];
    &rest[..rest.partition_point(|entry| place(entry).start <= range.end)]
}

struct Walk<'w> {
    text: &'w str,
    range: Range<usize>,
    stop: Stop<'w>,
    visit: &'w mut dyn FnMut(Piece),
}

impl Walk<'_> {
    fn touches(&self, span: Span) -> bool {
        let span = span.range();
        span.start <= self.range.end && self.range.start <= span.end
    }

    fn body(&mut self, body: &Body) {
        if !self.touches(body.span) {
            return;
        }
        (self.visit)(Piece::Body(body));
        for entry in entries_in(body, &self.range) {
            match entry {
                Entry::Field(field) => {
                    (self.visit)(Piece::Field(field));
                    self.expr(&field.value);
                }
                Entry::Statement(statement) => self.statement(statement),
                Entry::Rows(rows) => {
                    for row in rows_in(rows, &self.range) {
                        if (self.stop)() {
                            return;
                        }
                        self.statement(&rows.statement(row, self.text));
                    }
                }
                Entry::Broken(_) => {}
            }
        }
    }

    fn statement(&mut self, statement: &Statement) {
        if (self.stop)() || !self.touches(whole(statement)) {
            return;
        }
        (self.visit)(Piece::Statement(statement));
        for prefix in &statement.prefixes {
            self.arguments(prefix.arguments.as_deref().unwrap_or(&[]));
        }
        match &statement.kind {
            StatementKind::Thing { construct, .. } => self.construct(construct),
            StatementKind::Definition { value, .. } => self.expr(value),
            StatementKind::Param { ty, default, range, .. } => {
                (self.visit)(Piece::Type(ty));
                self.expr(default);
                range.iter().for_each(|range| self.expr(range));
            }
            StatementKind::Part { body, .. } => self.body(body),
            StatementKind::Import { .. } => {}
            StatementKind::Function { parameters, result, value, .. } => {
                parameters.iter().for_each(|parameter| (self.visit)(Piece::Type(&parameter.ty)));
                (self.visit)(Piece::Type(result));
                self.expr(value);
            }
            StatementKind::For { list, body, .. } => {
                self.expr(list);
                self.body(body);
            }
            StatementKind::If { condition, then, otherwise } => {
                self.expr(condition);
                self.body(then);
                otherwise.iter().for_each(|body| self.body(body));
            }
            StatementKind::Assert { condition, message } => {
                self.expr(condition);
                message.iter().for_each(|message| self.expr(message));
            }
        }
    }

    fn construct(&mut self, construct: &Construct) {
        if self.touches(construct.span) {
            (self.visit)(Piece::Construct(construct));
            self.body(&construct.body);
        }
    }

    fn arguments(&mut self, arguments: &[Argument]) {
        for argument in arguments {
            (self.visit)(Piece::Argument(argument));
            self.expr(&argument.value);
        }
    }

    fn expr(&mut self, expr: &Expr) {
        if !self.touches(expr.span) {
            return;
        }
        (self.visit)(Piece::Expr(expr));
        match &expr.kind {
            ExprKind::Scaled { value, .. }
            | ExprKind::Paren(value)
            | ExprKind::Member { value, .. }
            | ExprKind::Unary { operand: value, .. } => self.expr(value),
            ExprKind::Tuple(values) | ExprKind::List(values) => {
                values.iter().for_each(|value| self.expr(value));
            }
            ExprKind::Call { arguments, .. } => self.arguments(arguments),
            ExprKind::Index { value, index } => [value, index].into_iter().for_each(|value| self.expr(value)),
            ExprKind::If { condition, then, otherwise } => {
                [condition, then, otherwise].into_iter().for_each(|value| self.expr(value));
            }
            ExprKind::Construct(construct) => self.construct(construct),
            ExprKind::Binary { left, right, .. } => {
                [left, right].into_iter().for_each(|value| self.expr(value));
            }
            ExprKind::Invalid
            | ExprKind::Number { .. }
            | ExprKind::Quantity { .. }
            | ExprKind::Bool(_)
            | ExprKind::Text(_)
            | ExprKind::Color(_)
            | ExprKind::Name(_) => {}
        }
    }
}
