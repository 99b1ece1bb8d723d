//! What expressions come to, kept for who asks later: editors. A plain compilation keeps none of it.

use super::{Evaluator, Value};
use crate::check::{Expr, ExprKind};
use crate::color::Rgb;
use crate::math::DVec3;
use crate::span::Span;
use smol_str::SmolStr;
use std::collections::BTreeMap;

/// How many steps are taken before it is asked again whether to stop.
const PATIENCE: u64 = 1 << 16;

/// A value, as far as it can be said in a few words. Numbers are in base units.
#[derive(Clone, Debug, PartialEq)]
pub enum Seen {
    /// A number or quantity.
    Number(f64),
    /// Two (with z = 0) or three of them.
    Tuple(DVec3),
    /// `true` or `false`.
    Bool(bool),
    /// A text.
    Text(SmolStr),
    /// A linear colour.
    Color(Rgb),
    /// A list of so many items.
    List(usize),
}

/// What the values of definitions, params and fields were when they were first asked for, by the place of the expression, or of the
/// name of a param or of the variable of a loop. Of a loop only the first turn is looked at, and no literals are.
pub type Values = BTreeMap<Span, Seen>;

/// Looks on while a program is evaluated.
pub(super) struct Watch<'w> {
    pub(super) values: Values,
    stop: &'w dyn Fn() -> bool,
    /// How many steps there were when it was last asked whether to stop.
    asked: u64,
    /// How many loops are past their first turn.
    repeated: usize,
}

impl<'w> Watch<'w> {
    pub(super) fn new(stop: &'w dyn Fn() -> bool) -> Watch<'w> {
        Watch { values: Values::new(), stop, asked: 0, repeated: 0 }
    }
}

impl Evaluator<'_> {
    /// Keeps the value of an expression, if anybody looks on.
    #[inline(always)]
    pub(super) fn see(&mut self, expr: &Expr, value: &Value) {
        if self.watch.is_some() && !is_literal(expr) {
            self.see_at(expr.span, value);
        }
    }

    /// The same, by a place.
    pub(super) fn see_at(&mut self, place: Span, value: &Value) {
        if self.row.is_some() {
            return;
        }
        if let Some(watch) = self.watch.as_mut().filter(|watch| watch.repeated == 0)
            && let Some(seen) = seen(value)
        {
            watch.values.entry(place).or_insert(seen);
        }
    }

    /// Says that a loop goes on from its first turn, or has ended.
    pub(super) fn repeats(&mut self, goes_on: bool) {
        if let Some(watch) = &mut self.watch {
            watch.repeated = if goes_on { watch.repeated + 1 } else { watch.repeated - 1 };
        }
    }

    /// Whether whoever looks on has lost interest.
    pub(super) fn is_stopped(&mut self) -> bool {
        let steps = self.steps;
        let Some(watch) = self.watch.as_mut().filter(|watch| steps - watch.asked >= PATIENCE) else {
            return false;
        };
        watch.asked = steps;
        (watch.stop)()
    }
}

fn seen(value: &Value) -> Option<Seen> {
    Some(match value {
        Value::Number(x) => Seen::Number(*x),
        Value::Tuple(v) => Seen::Tuple(*v),
        Value::Bool(value) => Seen::Bool(*value),
        Value::Text(text) => Seen::Text(text.clone()),
        Value::Color(color) => Seen::Color(*color),
        Value::List(list) => Seen::List(list.len()),
        _ => return None,
    })
}

/// Whether the value stands in the text.
fn is_literal(expr: &Expr) -> bool {
    match &expr.kind {
        ExprKind::Number(_)
        | ExprKind::Bool(_)
        | ExprKind::Text(_)
        | ExprKind::Color(_)
        | ExprKind::RowNumber { .. }
        | ExprKind::RowColor { .. }
        | ExprKind::Word(_) => true,
        ExprKind::Unary { operand, .. } => is_literal(operand),
        ExprKind::Tuple(parts) => parts.iter().all(is_literal),
        // A unit behind parentheses, whose place is that of both.
        ExprKind::Binary { left, right, .. } => right.span == expr.span && is_literal(left),
        _ => false,
    }
}
