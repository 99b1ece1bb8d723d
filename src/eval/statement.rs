//! Statements.

use super::origin::Way;
use super::{Evaluator, Given, Value, errors};
use crate::check::{Block, Expr, ExprKind, Make, Statement, StatementKind, Variable};
use crate::span::Span;
use crate::syntax::Rows;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The most turns of loops that are told apart in the table of origins, for those who ask later.
const MOST_TURNS: usize = 10_000;
/// The longest text, in bytes, that names a turn there.
const MOST_TEXT: usize = 100;

impl Evaluator<'_> {
    /// Evaluates the statements of a scope. With `definitions` only what is named: nothing else of an imported file
    /// is asked for.
    pub(super) fn block(&mut self, block: &Block, definitions: bool) {
        if block.order.is_empty() {
            for statement in &block.statements {
                if self.halted {
                    return;
                }
                self.statement(statement, definitions);
            }
            return;
        }
        let places = self.out().places.len();
        let mut runs = vec![];
        for &index in &block.order {
            if self.halted {
                return;
            }
            let first = self.out().things.len() as u32;
            self.statement(&block.statements[index as usize], definitions);
            runs.push((index, first..self.out().things.len() as u32));
        }
        let lies_on_cycle = block.order.len() < block.statements.len();
        self.incomplete |= lies_on_cycle;
        self.out().reorder(runs, places);
    }

    fn statement(&mut self, statement: &Statement, definitions: bool) {
        if definitions && !statement.names() {
            return;
        }
        let span = statement.span;
        let marked = (statement.off || statement.solo).then(|| self.out().things.len() as u32);
        match &statement.kind {
            StatementKind::Nothing => {}
            StatementKind::Invalid => self.incomplete = true,
            StatementKind::Define { slot, value } => {
                let found = self.expr(value);
                self.see(value, &found);
                self.incomplete |= found == Value::Invalid;
                self.frame.set(*slot, found);
            }
            StatementKind::Param(index) => self.param(*index),
            StatementKind::Draw { slot, make } => {
                let placed = self.draw(make, span, slot.is_some());
                if let (Some(slot), Some(value)) = (slot, placed) {
                    self.frame.set(*slot, value);
                }
            }
            StatementKind::Rows { rows, makes, apart } => self.rows(rows, makes, apart),
            StatementKind::For { slot, variable, list, body, cost } => {
                self.repeat((*slot, variable), list, body, *cost, span)
            }
            StatementKind::If { condition, then, otherwise } => match self.expr(condition) {
                Value::Bool(true) => self.block(then, false),
                Value::Bool(false) => self.block(otherwise, false),
                _ => self.incomplete = true,
            },
            StatementKind::Assert { condition, message } if !statement.off => {
                self.assert(condition, message.as_ref())
            }
            StatementKind::Assert { .. } => {}
        }
        if let Some(first) = marked {
            let id = self.out().place(first);
            let list = if statement.off { &mut self.out().off } else { &mut self.out().solo };
            list.push(id);
        }
    }

    /// Things that differ in their literals only.
    fn rows(&mut self, rows: &Arc<Rows>, makes: &[Option<Make>], apart: &BTreeMap<usize, Statement>) {
        let outer = self.row.take();
        for row in 0..rows.len() {
            if self.halted {
                break;
            }
            let shape = rows.shape(row);
            if let Some(make) = &makes[shape] {
                self.row = Some((rows.clone(), row as u32));
                let span = self.here(rows.shapes()[shape].statement().span);
                self.draw(make, span, false);
                self.row = None;
            } else if let Some(statement) = apart.get(&row) {
                self.statement(statement, false);
            }
        }
        self.row = outer;
    }

    /// A literal of the row that is being evaluated.
    pub(super) fn row_literal(&self, literal: usize) -> f64 {
        self.row.as_ref().map_or(f64::NAN, |(rows, row)| rows.value(*row as usize, literal))
    }

    /// Which row is being evaluated.
    pub(super) fn row_index(&self) -> u32 {
        self.row.as_ref().map_or(0, |(_, row)| *row)
    }

    /// Where a place lies in the row that is being evaluated.
    pub(super) fn here(&self, place: Span) -> Span {
        self.row.as_ref().map_or(place, |(rows, row)| rows.place(*row as usize, place))
    }

    fn repeat(
        &mut self,
        (slot, variable): (usize, &Arc<Variable>),
        list: &Expr,
        body: &Block,
        cost: u64,
        span: Span,
    ) {
        let Value::List(list) = self.expr(list) else {
            self.incomplete = true;
            return;
        };
        let outer = self.link;
        let link = self.out().link(span, outer);
        self.uses.push(Way { span, turn: None });
        let mut index = 0;
        while let Some(item) = list.get(index) {
            if !self.step(cost, span) {
                break;
            }
            self.link = self.turn(span, link, variable, &item);
            if let Some(way) = self.uses.last_mut() {
                way.turn = Some((variable.clone(), item.clone()));
            }
            if index == 0 {
                self.see_at(variable.span, &item);
            }
            self.frame.set(slot, item);
            self.block(body, false);
            index += 1;
            if index == 1 {
                self.repeats(true);
            }
        }
        if index > 0 {
            self.repeats(false);
        }
        self.uses.pop();
        self.link = outer;
    }

    /// The link of a turn of a loop: one of its own while there are few in the picture, else the loop's.
    fn turn(&mut self, span: Span, repeat: u32, variable: &Variable, item: &Value) -> u32 {
        let drawn = self.buffers.len() == 1;
        let long = matches!(item, Value::Text(text) if text.len() > MOST_TEXT);
        let out = self.out();
        if long || !drawn || out.turns.len() >= MOST_TURNS {
            return repeat;
        }
        match errors::turn(variable, item) {
            Some(which) => out.turn(span, repeat, which),
            None => repeat,
        }
    }

    fn assert(&mut self, condition: &Expr, message: Option<&Expr>) {
        if self.expr(condition) != Value::Bool(false) {
            return;
        }
        let message = match message.map(|message| self.expr(message)) {
            Some(Value::Text(text)) => Some(text),
            _ => None,
        };
        let sides = match &condition.kind {
            ExprKind::Binary { operator, dim, left, right } => {
                let sides = [self.expr(left), self.expr(right)];
                errors::sides(*operator, *dim, &sides)
            }
            _ => None,
        };
        self.report(errors::assertion(message.as_deref(), condition.span, sides));
    }

    /// Gives a param its value: as set, or its default; in its range.
    fn param(&mut self, index: usize) {
        let Some(param) = self.part.and_then(|part| part.params.get(index)) else { return };
        let given = self.given.get(index).cloned().flatten();
        let Given { value, span } = match given {
            Some(given) => given,
            None => Given { value: self.expr(&param.default), span: param.default.span },
        };
        let value = zero_of(&param.declared, value);
        let range = param.range.as_ref().map(|[low, high]| [self.expr(low), self.expr(high)]);
        let value = match (&value, range) {
            (_, Some([Value::Number(low), Value::Number(high)])) if low > high => {
                let range = param.range.as_ref().map_or(param.span, |[low, high]| low.span.to(high.span));
                self.report(errors::empty_range(param, [low, high], range))
            }
            (&Value::Number(x), Some([Value::Number(low), Value::Number(high)]))
                if !(low..=high).contains(&x) =>
            {
                self.report(errors::param_out_of_range(param, [low, high], x, span))
            }
            _ => value,
        };
        self.incomplete |= value == Value::Invalid;
        self.see_at(param.span, &value);
        self.frame.set(param.slot, value);
    }
}

/// A lone 0 where three components are declared.
pub(super) fn zero_of(declared: &crate::check::Declared, value: Value) -> Value {
    use crate::schema::FieldType;
    match (declared, &value) {
        (crate::check::Declared::Field(FieldType::Tuple(..)), Value::Number(_)) => {
            Value::Tuple(crate::math::DVec3::ZERO)
        }
        _ => value,
    }
}
