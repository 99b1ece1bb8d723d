//! Expressions to values. Types were checked; what remains to go wrong is arithmetic that leaves the numbers.

use super::list::Items;
use super::{Evaluator, List, Value, errors};
use crate::check::{Arithmetic, Expr, ExprKind, Function};
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
            ExprKind::Number(_)
            | ExprKind::RowNumber { .. }
            | ExprKind::Component { .. }
            | ExprKind::Arithmetic { .. }
            | ExprKind::Compute { .. } => self.computed(kind, span).map_or(Value::Invalid, Value::Number),
            ExprKind::Bool(value) => Value::Bool(*value),
            ExprKind::Text(text) => Value::Text(text.clone()),
            ExprKind::Color(color) => Value::Color(*color),
            ExprKind::RowColor { literal } => {
                Value::Color(color::from_bits(self.row_literal(*literal) as u32))
            }
            ExprKind::Word(word) => Value::Word(word),
            ExprKind::Tuple(parts) => {
                let [x, y, z] = match &parts[..] {
                    [x, y] => [self.number(x), self.number(y), Some(0.0)],
                    [x, y, z] => [self.number(x), self.number(y), self.number(z)],
                    _ => [None; 3],
                };
                match (x, y, z) {
                    (Some(x), Some(y), Some(z)) => Value::Tuple(DVec3::new(x, y, z)),
                    _ => Value::Invalid,
                }
            }
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
            ExprKind::Unary { operator, operand } => match (operator, self.expr(operand)) {
                (UnaryOp::Negate, Value::Number(x)) => Value::Number(-x),
                (UnaryOp::Negate, Value::Tuple(v)) => Value::Tuple(-v),
                (UnaryOp::Not, Value::Bool(x)) => Value::Bool(!x),
                _ => Value::Invalid,
            },
            ExprKind::Binary { operator, left, right, .. } => {
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
                match is_finite(&result) {
                    true => result,
                    false => self.report(errors::not_finite(*operator, &left, &right, span)),
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

    /// The value of an expression that is a number; none where it has an error. Numbers are most of what there is to
    /// compute, and are handed on by themselves.
    #[inline(always)]
    pub(super) fn number(&mut self, expr: &Expr) -> Option<f64> {
        match &expr.kind {
            ExprKind::Number(x) if x.is_finite() => Some(*x),
            ExprKind::Name { up: 0, slot } => self.frame.number(*slot),
            _ => self.deeper_number(expr),
        }
    }

    fn deeper_number(&mut self, expr: &Expr) -> Option<f64> {
        match &expr.kind {
            ExprKind::Number(_)
            | ExprKind::RowNumber { .. }
            | ExprKind::Component { .. }
            | ExprKind::Arithmetic { .. }
            | ExprKind::Compute { .. } => {
                self.deeper(expr.span, |inside| inside.computed(&expr.kind, expr.span))?
            }
            _ => match self.expr(expr) {
                Value::Number(x) => Some(x),
                _ => None,
            },
        }
    }

    /// A number that is computed from others, or stands in the text.
    #[inline(always)]
    fn computed(&mut self, kind: &ExprKind, span: Span) -> Option<f64> {
        match kind {
            ExprKind::Number(x) => self.finite(*x, span),
            ExprKind::RowNumber { literal, factor } => self.finite(self.row_literal(*literal) * factor, span),
            ExprKind::Component { value, axis } => match self.expr(value) {
                Value::Tuple(tuple) => Some(tuple[*axis]),
                _ => None,
            },
            ExprKind::Arithmetic { operator, left, right, int } => {
                let (left, right) = (self.number(left), self.number(right));
                let (left, right) = (left?, right?);
                let result = arithmetic(*operator, left, right);
                if result.is_finite() && (!*int || result.abs() < MAX_INT) {
                    return Some(result);
                }
                self.beyond(*operator, [left, right], result, span)
            }
            ExprKind::Compute { function, arguments } => self.compute(*function, arguments, span),
            _ => None,
        }
    }

    /// Reports a result that is no number to go on with.
    #[cold]
    fn beyond(&mut self, operator: Arithmetic, operands: [f64; 2], result: f64, span: Span) -> Option<f64> {
        let [left, right] = operands.map(Value::Number);
        self.report(match result.is_finite() {
            true => errors::inexact(span),
            false => errors::not_finite(operator.operator(), &left, &right, span),
        });
        None
    }

    /// What a function of numbers gives.
    fn compute(&mut self, function: Function, arguments: &[Expr], span: Span) -> Option<f64> {
        /// Only a few functions take more, and those any number.
        const FEW: usize = 4;
        let (mut few, mut many) = ([0.0; FEW], vec![]);
        let numbers = match few.get_mut(..arguments.len()) {
            Some(few) => few,
            None => {
                many.resize(arguments.len(), 0.0);
                &mut many[..]
            }
        };
        for (number, argument) in numbers.iter_mut().zip(arguments) {
            *number = self.number(argument)?;
        }
        let found = super::functions::compute(function, numbers);
        if let Ok(number) = found
            && number.is_finite()
        {
            return Some(number);
        }
        let values: Vec<Value> = numbers.iter().copied().map(Value::Number).collect();
        self.report(match found {
            Ok(_) => errors::call_not_finite(function, &values, span),
            Err(what) => errors::outside_domain(function, what, &values, arguments[0].span),
        });
        None
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

    fn finite(&mut self, x: f64, span: Span) -> Option<f64> {
        if !x.is_finite() {
            self.report(errors::number_not_finite(span));
            return None;
        }
        Some(x)
    }
}

#[inline]
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
    match (left, right) {
        (Number(a), Number(b)) => compare(operator, *a, *b),
        (Tuple(a), Tuple(b)) => match operator {
            Add => Tuple(*a + *b),
            Subtract => Tuple(*a - *b),
            Equal => Bool(a == b),
            NotEqual => Bool(a != b),
            _ => Value::Invalid,
        },
        (Tuple(v), Number(x)) | (Number(x), Tuple(v)) if operator == Multiply => Tuple(*v * *x),
        (Tuple(v), Number(x)) if operator == Divide => Tuple(*v / *x),
        (Color(a), Color(b)) => match operator {
            Add => Color(*a + *b),
            Subtract => Color(*a - *b),
            Multiply => Color(*a * *b),
            Equal => Bool(a == b),
            NotEqual => Bool(a != b),
            _ => Value::Invalid,
        },
        (Color(c), Number(x)) | (Number(x), Color(c)) if operator == Multiply => Color(*c * *x),
        (Color(c), Number(x)) if operator == Divide => Color(*c / *x),
        (Bool(a), Bool(b)) => match operator {
            Or => Bool(*a || *b),
            And => Bool(*a && *b),
            Equal => Bool(a == b),
            NotEqual => Bool(a != b),
            _ => Value::Invalid,
        },
        (Value::Text(a), Value::Text(b)) => match operator {
            Equal => Bool(a == b),
            NotEqual => Bool(a != b),
            _ => Value::Invalid,
        },
        (Transform(first), Transform(then)) if operator == Pipe => Transform(Rc::new(**then * **first)),
        _ => Value::Invalid,
    }
}

#[inline]
fn arithmetic(operator: Arithmetic, a: f64, b: f64) -> f64 {
    match operator {
        Arithmetic::Add => a + b,
        Arithmetic::Subtract => a - b,
        Arithmetic::Multiply => a * b,
        Arithmetic::Divide => a / b,
    }
}

#[inline]
fn compare(operator: BinaryOp, a: f64, b: f64) -> Value {
    use BinaryOp::*;
    use Value::Bool;
    match operator {
        Equal => Bool(a == b),
        NotEqual => Bool(a != b),
        Less => Bool(a < b),
        LessEqual => Bool(a <= b),
        Greater => Bool(a > b),
        GreaterEqual => Bool(a >= b),
        _ => Value::Invalid,
    }
}
