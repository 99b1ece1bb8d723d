//! Expressions to values. Types were checked; what remains to go wrong is arithmetic that leaves the numbers.

use super::list::Items;
use super::{Evaluator, List, Value, errors};
use crate::check::{Expr, ExprKind, Function};
use crate::color;
use crate::math::DVec3;
use crate::span::Span;
use crate::syntax::ast::{BinaryOp, UnaryOp};
use smallvec::SmallVec;
use std::rc::Rc;

/// Beyond this, whole numbers are no longer exact.
const MAX_INT: f64 = 9_007_199_254_740_992.0;

impl Evaluator<'_> {
    pub(super) fn value(&mut self, kind: &ExprKind, span: Span) -> Value {
        match kind {
            ExprKind::Invalid => Value::Invalid,
            ExprKind::Number(value) => self.finite(Value::Number(*value), span),
            ExprKind::Bool(value) => Value::Bool(*value),
            ExprKind::Text(text) => Value::Text(text.clone()),
            ExprKind::Color(color) => Value::Color(*color),
            ExprKind::RowNumber { literal, factor } => {
                self.finite(Value::Number(self.row_literal(*literal) * factor), span)
            }
            ExprKind::RowColor { literal } => {
                Value::Color(color::from_bits(self.row_literal(*literal) as u32))
            }
            ExprKind::Word(word) => Value::Word(word),
            ExprKind::Tuple(parts) => {
                let mut tuple = DVec3::ZERO;
                for (axis, part) in parts.iter().enumerate() {
                    match self.expr(part) {
                        Value::Number(x) => tuple[axis] = x,
                        _ => return Value::Invalid,
                    }
                }
                Value::Tuple(tuple)
            }
            // Handled before it comes here, as the most common of all.
            ExprKind::Name { up, slot } => {
                self.frame.outer(*up).map_or(Value::Invalid, |frame| frame.get(*slot))
            }
            ExprKind::FileName { file, slot } => {
                self.file(*file).map_or(Value::Invalid, |frame| frame.get(*slot))
            }
            ExprKind::List(items) => self.list(items, span),
            ExprKind::Index { value, index } => self.index(value, index),
            ExprKind::Field { value, field } => self.field(value, *field),
            ExprKind::Inside { value, slot } => self.name_inside(value, *slot),
            ExprKind::Corner { value, corner } => self.corner(value, *corner, span),
            ExprKind::Column { value, column } => self.column(value, *column),
            ExprKind::Table(table) => {
                let count = self.program.tables[table.index()].rows;
                match self.may_list(count as f64, false, span) {
                    true => Value::List(Rc::new(List::Rows { table: *table, count })),
                    false => Value::Invalid,
                }
            }
            ExprKind::If(parts) => match self.expr(&parts[0]) {
                Value::Bool(true) => self.expr(&parts[1]),
                Value::Bool(false) => self.expr(&parts[2]),
                _ => Value::Invalid,
            },
            ExprKind::CallDeclared { function, around, arguments } => {
                self.call_declared(*function, *around, arguments, span)
            }
            ExprKind::Component { value, axis } => match self.expr(value) {
                Value::Tuple(tuple) => Value::Number(tuple[*axis]),
                _ => Value::Invalid,
            },
            ExprKind::Unary { operator, operand } => match (operator, self.expr(operand)) {
                (UnaryOp::Negate, Value::Number(x)) => Value::Number(-x),
                (UnaryOp::Negate, Value::Tuple(v)) => Value::Tuple(-v),
                (UnaryOp::Not, Value::Bool(x)) => Value::Bool(!x),
                _ => Value::Invalid,
            },
            ExprKind::Binary { operator, left, right, int } => {
                let left = self.expr(left);
                // What follows `and` or `or` is asked only where it matters.
                match (operator, &left) {
                    (BinaryOp::And, Value::Bool(false)) | (BinaryOp::Or, Value::Bool(true)) => return left,
                    _ => {}
                }
                let right = self.expr(right);
                if *operator == BinaryOp::To {
                    return self.to(&left, &right, span);
                }
                let result = binary(*operator, &left, &right);
                match &result {
                    Value::Number(x) if *int && x.is_finite() && x.abs() > MAX_INT => {
                        self.report(errors::inexact(span))
                    }
                    _ => self.finite_result(*operator, result, &left, &right, span),
                }
            }
            ExprKind::Call { function, arguments } => {
                let mut values: SmallVec<[Value; 4]> = SmallVec::new();
                for argument in arguments {
                    match self.expr(argument) {
                        Value::Invalid => return Value::Invalid,
                        value => values.push(value),
                    }
                }
                match function {
                    Function::Range | Function::Linspace => return self.range(*function, &values, span),
                    Function::Bounds => return self.bounds(&values[0], span),
                    _ => {}
                }
                match super::functions::call(*function, &values, |index| arguments[index].span) {
                    Ok(value) if is_finite(&value) => value,
                    Ok(_) => self.report(errors::call_not_finite(*function, &values, span)),
                    Err(diagnostic) => self.report(*diagnostic),
                }
            }
            ExprKind::Make(make) => self.make(make),
        }
    }

    fn list(&mut self, items: &[Expr], span: Span) -> Value {
        if !self.may_list(items.len() as f64, true, span) {
            return Value::Invalid;
        }
        let mut values = Vec::with_capacity(items.len());
        for item in items {
            match self.expr(item) {
                Value::Invalid => return Value::Invalid,
                value => values.push(value),
            }
        }
        Value::List(Rc::new(List::Items(Items::new(values, &self.live))))
    }

    /// `low to high`, both included.
    fn to(&mut self, low: &Value, high: &Value, span: Span) -> Value {
        let (Value::Number(low), Value::Number(high)) = (low, high) else { return Value::Invalid };
        self.whole_numbers(*low, high - low + 1.0, span)
    }

    fn range(&mut self, function: Function, arguments: &[Value], span: Span) -> Value {
        match (function, arguments) {
            (Function::Range, [Value::Number(count)]) => self.whole_numbers(0.0, *count, span),
            (Function::Range, [Value::Number(low), Value::Number(high)]) => {
                self.whole_numbers(*low, high - low, span)
            }
            (Function::Linspace, [from, to, Value::Number(count)]) => {
                if *count < 2.0 {
                    return self.report(errors::few_steps(*count, span));
                }
                if !self.may_list(*count, false, span) {
                    return Value::Invalid;
                }
                let triple = matches!(from, Value::Tuple(_)) || matches!(to, Value::Tuple(_));
                let [from, to] = [from, to].map(|end| match end {
                    Value::Number(_) if triple => Value::Tuple(DVec3::ZERO),
                    end => end.clone(),
                });
                Value::List(Rc::new(List::Linspace { from, to, count: *count as usize }))
            }
            _ => Value::Invalid,
        }
    }

    fn whole_numbers(&mut self, first: f64, count: f64, span: Span) -> Value {
        match self.may_list(count, false, span) {
            true => Value::List(Rc::new(List::Range { first, count: count.max(0.0) as usize })),
            false => Value::Invalid,
        }
    }

    fn finite(&mut self, value: Value, span: Span) -> Value {
        if is_finite(&value) { value } else { self.report(errors::number_not_finite(span)) }
    }

    fn finite_result(
        &mut self,
        operator: BinaryOp,
        result: Value,
        a: &Value,
        b: &Value,
        span: Span,
    ) -> Value {
        if is_finite(&result) { result } else { self.report(errors::not_finite(operator, a, b, span)) }
    }
}

fn is_finite(value: &Value) -> bool {
    match value {
        Value::Number(x) => x.is_finite(),
        Value::Tuple(v) | Value::Color(v) => v.is_finite(),
        Value::Transform(transform) => transform.is_finite(),
        _ => true,
    }
}

fn binary(operator: BinaryOp, left: &Value, right: &Value) -> Value {
    use BinaryOp::*;
    use Value::{Bool, Color, Number, Transform, Tuple};
    match (operator, left, right) {
        (Pipe, Transform(first), Transform(then)) => Transform(Rc::new(**then * **first)),
        (Or, Bool(a), Bool(b)) => Bool(*a || *b),
        (And, Bool(a), Bool(b)) => Bool(*a && *b),
        (Equal, a, b) => equal(a, b).map_or(Value::Invalid, Bool),
        (NotEqual, a, b) => equal(a, b).map_or(Value::Invalid, |equal| Bool(!equal)),
        (Less, Number(a), Number(b)) => Bool(a < b),
        (LessEqual, Number(a), Number(b)) => Bool(a <= b),
        (Greater, Number(a), Number(b)) => Bool(a > b),
        (GreaterEqual, Number(a), Number(b)) => Bool(a >= b),
        (Add, Number(a), Number(b)) => Number(a + b),
        (Subtract, Number(a), Number(b)) => Number(a - b),
        (Multiply, Number(a), Number(b)) => Number(a * b),
        (Divide, Number(a), Number(b)) => Number(a / b),
        (Add, Tuple(a), Tuple(b)) => Tuple(*a + *b),
        (Subtract, Tuple(a), Tuple(b)) => Tuple(*a - *b),
        (Multiply, Tuple(a), Number(b)) | (Multiply, Number(b), Tuple(a)) => Tuple(*a * *b),
        (Divide, Tuple(a), Number(b)) => Tuple(*a / *b),
        (Add, Color(a), Color(b)) => Color(*a + *b),
        (Subtract, Color(a), Color(b)) => Color(*a - *b),
        (Multiply, Color(a), Color(b)) => Color(*a * *b),
        (Multiply, Color(a), Number(b)) | (Multiply, Number(b), Color(a)) => Color(*a * *b),
        (Divide, Color(a), Number(b)) => Color(*a / *b),
        _ => Value::Invalid,
    }
}

fn equal(a: &Value, b: &Value) -> Option<bool> {
    match (a, b) {
        (Value::Number(a), Value::Number(b)) => Some(a == b),
        (Value::Bool(a), Value::Bool(b)) => Some(a == b),
        (Value::Text(a), Value::Text(b)) => Some(a == b),
        (Value::Tuple(a), Value::Tuple(b)) | (Value::Color(a), Value::Color(b)) => Some(a == b),
        _ => None,
    }
}
