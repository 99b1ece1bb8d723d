//! Expressions to values. Types were checked; what remains to go wrong is arithmetic that leaves the numbers.

use super::{Evaluator, Value, errors};
use crate::check::ExprKind;
use crate::math::DVec3;
use crate::span::Span;
use crate::syntax::ast::{BinaryOp, UnaryOp};
use std::rc::Rc;

/// Beyond this, whole numbers are no longer exact.
const MAX_INT: f64 = 9_007_199_254_740_992.0;

impl Evaluator {
    pub(super) fn value(&mut self, kind: &ExprKind, span: Span) -> Value {
        match kind {
            ExprKind::Invalid => Value::Invalid,
            ExprKind::Number(value) => self.finite(Value::Number(*value), span),
            ExprKind::Bool(value) => Value::Bool(*value),
            ExprKind::Text(text) => Value::Text(text.clone()),
            ExprKind::Color(color) => Value::Color(*color),
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
            ExprKind::Name { up, slot } => {
                let frame = self.frames.len().checked_sub(1 + up).and_then(|index| self.frames.get(index));
                frame.and_then(|frame| frame.get(*slot)).cloned().unwrap_or(Value::Invalid)
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
                let right = self.expr(right);
                let result = binary(*operator, &left, &right);
                match &result {
                    Value::Number(x) if *int && x.is_finite() && x.abs() > MAX_INT => {
                        self.report(errors::inexact(span))
                    }
                    _ => self.finite_result(*operator, result, &left, &right, span),
                }
            }
            ExprKind::Call { function, arguments } => {
                let mut values = Vec::with_capacity(arguments.len());
                for argument in arguments {
                    match self.expr(argument) {
                        Value::Invalid => return Value::Invalid,
                        value => values.push(value),
                    }
                }
                let spans: Vec<Span> = arguments.iter().map(|argument| argument.span).collect();
                match super::functions::call(*function, &values, &spans) {
                    Ok(value) if is_finite(&value) => value,
                    Ok(_) => self.report(errors::call_not_finite(*function, &values, span)),
                    Err(diagnostic) => self.report(*diagnostic),
                }
            }
            ExprKind::Make(make) => self.make(make),
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
