//! `table("points.csv")`: the file is read while checking, so that its columns are known.

use super::program::{ExprKind, TableId};
use super::types::{Element, NUMBER, Type};
use super::{Checker, errors};
use crate::asset::table::{Cells, Column};
use crate::span::Span;
use crate::syntax::ast::{Argument, ExprKind as Tree, Name};

/// The most bytes of a table.
const MAX_TABLE: usize = 1 << 30;

impl Checker<'_> {
    /// A table that a file holds: a list of rows.
    pub(super) fn table(&mut self, arguments: &[Argument], span: Span) -> (ExprKind, Type) {
        let invalid = (ExprKind::Invalid, Type::Invalid);
        let [Argument { name: None, value }] = arguments else {
            self.report(errors::table_arguments(span));
            arguments
                .iter()
                .for_each(|argument| drop(self.quietly(|checker| checker.infer(&argument.value))));
            return invalid;
        };
        let Tree::Text(text) = &value.kind else {
            if !matches!(value.kind, Tree::Invalid) {
                self.infer(value);
                self.report(errors::table_arguments(value.span));
            }
            return invalid;
        };
        let written = Name { text: text.clone(), span: value.span };
        match self.read_table(&written) {
            Some(table) => (ExprKind::Table(table), Type::list(Type::Row(table))),
            None => invalid,
        }
    }

    fn read_table(&mut self, written: &Name) -> Option<TableId> {
        let from = self.sources.get(written.span.source).path.clone();
        let path = match from.join(&written.text) {
            Ok(path) => path,
            Err(error) => {
                self.report(error.diagnostic(&written.text, written.span));
                return None;
            }
        };
        if let Some(known) = self.tables.get(&path) {
            return *known;
        }
        let found = self.files.read(&path, MAX_TABLE);
        let table = match found {
            Ok(bytes) => crate::asset::table::read(&bytes).map_err(|why| errors::bad_table(written, &why)),
            Err(error) => Err(error.diagnostic(&written.text, written.span)),
        };
        let id = match table {
            Ok(table) => {
                self.program.tables.push(std::sync::Arc::new(table));
                Some(TableId(self.program.tables.len() as u32 - 1))
            }
            Err(diagnostic) => {
                self.report(diagnostic);
                None
            }
        };
        self.tables.insert(path, id);
        id
    }
}

/// What the cells of a column are.
pub(super) fn column_type(column: &Column) -> Type {
    match &column.cells {
        Cells::Texts(_) => Type::Text,
        Cells::Numbers { whole: true, .. } if column.unit.is_none() => Type::Scalar(Element::Int),
        Cells::Numbers { .. } => Type::Scalar(column.unit.map_or(NUMBER, |unit| Element::Quantity(unit.dim))),
    }
}
