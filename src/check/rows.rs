//! Rows of literals: each shape is checked once, for all its rows.

use super::Checker;
use super::program::{Base, ExprKind, Make, Statement, StatementKind};
use super::scope::{Item, Place};
use super::types::{Kind, Type};
use crate::schema::{Category, group};
use crate::span::Span;
use crate::syntax::ast::StatementKind as Tree;
use crate::syntax::{Rows, Shape};
use std::collections::BTreeMap;
use std::rc::Rc;
use std::sync::Arc;

impl Checker<'_> {
    /// Things that differ in their literals only. Where something is to be said of a shape, it is said of each of its
    /// rows by itself.
    pub(super) fn rows(&mut self, rows: &Arc<Rows>, place: Place) -> Statement {
        let before = self.nodes;
        let mut costs = vec![];
        let makes: Vec<Option<Make>> = rows
            .shapes()
            .iter()
            .map(|shape| {
                self.nodes = 0;
                let make = self.row_shape(rows, shape);
                costs.push(if make.is_some() { self.nodes } else { 0 });
                make
            })
            .collect();
        self.nodes = before;
        let mut apart = BTreeMap::new();
        for row in 0..rows.len() {
            let shape = rows.shape(row);
            self.nodes += costs[shape];
            if makes[shape].is_none() {
                let written = rows.statement(row, self.sources.get(rows.span().source).text.as_str());
                let (statement, _) = self.item(&Item::Statement(&written), place, None);
                apart.insert(row, statement);
            }
        }
        let kind = StatementKind::Rows { rows: rows.clone(), makes, apart };
        Statement { kind, span: rows.span(), off: false, solo: false }
    }

    /// How things of a shape are made, where all of them are alike.
    fn row_shape(&mut self, rows: &Arc<Rows>, shape: &Arc<Shape>) -> Option<Make> {
        let Tree::Thing { construct, .. } = &shape.statement().kind else { return None };
        let said = self.diagnostics.len();
        self.shape = Some(shape.clone());
        let (drawn, ty, silent) = self.quietly(|checker| {
            let (drawn, ty) = checker.drawn(construct, None, None);
            (drawn, ty, checker.diagnostics.len() == said)
        });
        self.shape = None;
        let (StatementKind::Draw { make, .. }, Type::Thing(making)) = (drawn, ty) else { return None };
        let single = matches!(making.kind, Kind::BuiltIn(kind)
            if kind != group::KIND && kind.get().category != Category::Block);
        let mut make = *make;
        (silent && single).then(|| {
            in_rows(&mut make, rows);
            make
        })
    }

    /// Which literal of the shape that is being checked stands at a place.
    pub(super) fn literal(&self, place: Span) -> Option<usize> {
        self.shape.as_ref().and_then(|shape| shape.literal(place))
    }

    /// A number in a unit.
    pub(super) fn number(&self, value: f64, factor: f64, place: Span) -> ExprKind {
        match self.literal(place) {
            Some(literal) => ExprKind::RowNumber { literal, factor },
            None => ExprKind::Number(value * factor),
        }
    }
}

/// Says of what is made that its places are those of a row.
fn in_rows(make: &mut Make, rows: &Arc<Rows>) {
    Rc::make_mut(&mut make.written).rows = Some(rows.clone());
    if let Base::Prototype(prototype) = &mut make.base {
        in_rows_within(&mut prototype.kind, rows);
    }
    make.fields.iter_mut().for_each(|(_, value)| in_rows_within(&mut value.kind, rows));
}

fn in_rows_within(value: &mut ExprKind, rows: &Arc<Rows>) {
    if let ExprKind::Make(make) = value {
        in_rows(make, rows);
    }
}
