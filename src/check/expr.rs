//! Expressions: their types, and the units of what they compute.

use super::program::Arithmetic;
use super::types::{Element, NUMBER, Type};
use super::{Checker, Expr, ExprKind, errors};
use crate::color;
use crate::diagnostic::Code;
use crate::span::Span;
use crate::syntax::ast::{self, BinaryOp, ExprKind as Tree, Name, UnaryOp};
use crate::units;

impl Checker<'_> {
    /// Finds the type of an expression, wherever it stands. It is a value: the name of a part, file or function
    /// alone is none.
    pub(super) fn infer(&mut self, expr: &ast::Expr) -> (Expr, Type) {
        let (found, ty) = self.infer_name(expr);
        if matches!(ty, Type::Part(_) | Type::File(_) | Type::Function(_)) {
            self.report(errors::not_a_value(self.text(expr.span), expr.span, &ty));
            return (Expr::invalid(expr.span), Type::Invalid);
        }
        (found, ty)
    }

    /// The same, where the name of a file may stand to be looked into.
    pub(super) fn infer_name(&mut self, expr: &ast::Expr) -> (Expr, Type) {
        self.nodes += 1;
        let span = expr.span;
        let (kind, ty) = match &expr.kind {
            Tree::Invalid => (ExprKind::Invalid, Type::Invalid),
            Tree::Number { value, int } => {
                let element = match (*value == 0.0, *int) {
                    (true, _) => Element::Zero,
                    (false, true) => Element::Int,
                    (false, false) => NUMBER,
                };
                (self.number(*value, 1.0, span), Type::Scalar(element))
            }
            Tree::Quantity { value, unit } => match self.unit(unit) {
                Some(unit) => {
                    let number = self.number(*value, unit.factor, span);
                    (number, Type::Scalar(Element::Quantity(unit.dim)))
                }
                None => (ExprKind::Invalid, Type::Invalid),
            },
            Tree::Scaled { value, unit } => self.scaled(value, unit, span),
            Tree::Bool(value) => (ExprKind::Bool(*value), Type::Bool),
            Tree::Text(text) => (ExprKind::Text(text.clone()), Type::Text),
            Tree::Color(digits) => match (self.literal(span), color::from_hex(digits)) {
                (Some(literal), _) => (ExprKind::RowColor { literal }, Type::Color),
                (None, Some(color)) => (ExprKind::Color(color), Type::Color),
                (None, None) => (ExprKind::Invalid, Type::Invalid),
            },
            Tree::Name(name) => match self.lookup(name) {
                Some(found) => {
                    self.note(span, found.meaning);
                    (found.kind, found.ty)
                }
                None => {
                    let name = Name { text: name.clone(), span };
                    let diagnostic = match self.is_setting(span) {
                        true => errors::unknown_in_setting(&name),
                        false => errors::unknown_name(&name, &self.value_names()),
                    };
                    self.report_lost(&name.text, diagnostic);
                    (ExprKind::Invalid, Type::Invalid)
                }
            },
            Tree::Tuple(parts) => self.tuple(parts, span),
            Tree::List(items) => self.list(items),
            Tree::Paren(inner) => return self.infer_name(inner),
            Tree::Call { function, arguments } => self.call(function, arguments, span),
            Tree::Member { value, member } => self.member(value, member),
            Tree::Index { value, index } => self.index(value, index),
            Tree::If { condition, then, otherwise } => self.choice(condition, then, otherwise),
            Tree::Construct(construct) => {
                let (make, ty) = self.make(construct, None);
                (ExprKind::Make(Box::new(make)), ty)
            }
            Tree::Unary { operator, operand } => self.unary(*operator, operand),
            Tree::Binary { operator, at, left, right } => self.binary(*operator, *at, left, right),
        };
        let kind = if ty == Type::Invalid { ExprKind::Invalid } else { kind };
        self.note_type(span, &ty);
        (Expr { kind, span }, ty)
    }

    fn unit(&mut self, unit: &Name) -> Option<units::Unit> {
        match units::parse_unit(&unit.text) {
            Ok(found) => Some(found),
            Err(part) => {
                if part == unit.text && self.is_declared(part) {
                    self.report(errors::name_as_unit(unit));
                    return None;
                }
                let name = Name { text: part.into(), span: unit.span };
                let known: Vec<&str> = units::UNITS.iter().map(|(name, _)| *name).collect();
                self.report(errors::unknown(Code::E0101, "unit", &name, &known));
                None
            }
        }
    }

    fn scaled(&mut self, value: &ast::Expr, unit: &Name, span: Span) -> (ExprKind, Type) {
        let (value, ty) = self.infer(value);
        let Some(unit_found) = self.unit(unit) else { return (ExprKind::Invalid, Type::Invalid) };
        let quantity = Element::Quantity(unit_found.dim);
        let scaled = match ty {
            Type::Scalar(element) if element.fits(units::NONE) => Type::Scalar(quantity),
            Type::Tuple(count, element) if element.fits(units::NONE) => Type::Tuple(count, quantity),
            Type::Invalid => return (ExprKind::Invalid, Type::Invalid),
            _ => {
                self.report(errors::unit_on_quantity(unit, value.span, &ty));
                return (ExprKind::Invalid, Type::Invalid);
            }
        };
        let factor = Expr { kind: ExprKind::Number(unit_found.factor), span };
        (operation(BinaryOp::Multiply, units::NONE, [value, factor], &scaled), scaled)
    }

    fn tuple(&mut self, parts: &[ast::Expr], span: Span) -> (ExprKind, Type) {
        let (exprs, types): (Vec<Expr>, Vec<Type>) = parts.iter().map(|part| self.infer(part)).unzip();
        if types.contains(&Type::Invalid) {
            return (ExprKind::Invalid, Type::Invalid);
        }
        if exprs.len() > 3 {
            self.report(errors::long_tuple(span, exprs.len()));
            return (ExprKind::Invalid, Type::Invalid);
        }
        let mut joined = Element::Zero;
        for ty in &types {
            let Type::Scalar(element) = ty else { continue };
            let element = *element;
            // The first component with a dimension sets it for all, wherever it stands.
            joined = match joined.join(element) {
                Some(both) => both,
                None if joined.dim() == units::NONE => element,
                None => joined,
            };
        }
        let mut sound = true;
        for (expr, ty) in exprs.iter().zip(&types) {
            match ty {
                Type::Scalar(element) if joined.join(*element).is_some() => {}
                Type::Scalar(element) => {
                    sound = false;
                    self.report(errors::component(expr.span, self.text(expr.span), *element, joined));
                }
                other => {
                    sound = false;
                    self.report(errors::component_not_number(expr.span, other));
                }
            }
        }
        match sound {
            true => (ExprKind::Tuple(exprs), Type::Tuple(parts.len(), joined)),
            false => (ExprKind::Invalid, Type::Invalid),
        }
    }

    fn unary(&mut self, operator: UnaryOp, operand: &ast::Expr) -> (ExprKind, Type) {
        let (operand, ty) = self.infer(operand);
        let fits = match operator {
            UnaryOp::Negate => matches!(ty, Type::Scalar(_) | Type::Tuple(..)),
            UnaryOp::Not => ty == Type::Bool,
        };
        if !fits {
            if ty != Type::Invalid {
                let (symbol, wanted) = match operator {
                    UnaryOp::Negate => ("-", "a number"),
                    UnaryOp::Not => ("not", "true or false"),
                };
                self.report(errors::operand(symbol, wanted, operand.span, &ty));
            }
            return (ExprKind::Invalid, Type::Invalid);
        }
        (ExprKind::Unary { operator, operand: Box::new(operand) }, ty)
    }

    fn binary(
        &mut self,
        operator: BinaryOp,
        at: Span,
        left: &ast::Expr,
        right: &ast::Expr,
    ) -> (ExprKind, Type) {
        let (left, a) = self.infer(left);
        let (right, b) = self.infer(right);
        if a == Type::Invalid || b == Type::Invalid {
            return (ExprKind::Invalid, Type::Invalid);
        }
        if operator == BinaryOp::To {
            return self.to(left, right, [a, b]);
        }
        let operands = [(left.span, &a), (right.span, &b)];
        let ty = match self.result(operator, at, operands) {
            Some(ty) => ty,
            None => return (ExprKind::Invalid, Type::Invalid),
        };
        let dims = [&a, &b].map(|ty| match ty {
            Type::Scalar(element) | Type::Tuple(_, element) => element.dim(),
            _ => units::NONE,
        });
        let dim = if dims[0] == units::NONE { dims[1] } else { dims[0] };
        (operation(operator, dim, [left, right], &ty), ty)
    }

    /// The type of an operation; none where it is wrong, and was reported.
    fn result(&mut self, operator: BinaryOp, at: Span, operands: [(Span, &Type); 2]) -> Option<Type> {
        use BinaryOp::*;
        let symbol = operator.symbol();
        match operator {
            Pipe => self.both(symbol, "a placement", operands, |ty| *ty == Type::Transform)?,
            Or | And => self.both(symbol, "true or false", operands, |ty| *ty == Type::Bool)?,
            _ => {}
        }
        let [a, b] = [operands[0].1, operands[1].1];
        match (operator, a, b) {
            (Pipe, ..) => Some(Type::Transform),
            (Or | And, ..) => Some(Type::Bool),
            (Equal | NotEqual, Type::Bool, Type::Bool)
            | (Equal | NotEqual, Type::Text, Type::Text)
            | (Equal | NotEqual, Type::Color, Type::Color) => Some(Type::Bool),
            (Equal | NotEqual, Type::Tuple(m, x), Type::Tuple(n, y)) if m == n => {
                self.join(symbol, at, *x, *y, operands).map(|_| Type::Bool)
            }
            (
                Equal | NotEqual | Less | LessEqual | Greater | GreaterEqual,
                Type::Scalar(x),
                Type::Scalar(y),
            ) => self.join(symbol, at, *x, *y, operands).map(|_| Type::Bool),
            (Add | Subtract, Type::Color, Type::Color) => Some(Type::Color),
            (Add | Subtract, Type::Scalar(x), Type::Scalar(y)) => {
                self.join(symbol, at, *x, *y, operands).map(|element| Type::Scalar(whole(element)))
            }
            (Add | Subtract, Type::Tuple(m, x), Type::Tuple(n, y)) if m == n => {
                self.join(symbol, at, *x, *y, operands).map(|element| Type::Tuple(*m, whole(element)))
            }
            (Multiply, Type::Color, Type::Color) => Some(Type::Color),
            (Multiply | Divide, Type::Color, Type::Scalar(x)) if x.fits(units::NONE) => Some(Type::Color),
            (Multiply, Type::Scalar(x), Type::Color) if x.fits(units::NONE) => Some(Type::Color),
            (Multiply | Divide, Type::Scalar(x), Type::Scalar(y)) => {
                self.product(operator, at, *x, *y).map(Type::Scalar)
            }
            (Multiply | Divide, Type::Tuple(n, x), Type::Scalar(y))
            | (Multiply, Type::Scalar(x), Type::Tuple(n, y)) => {
                self.product(operator, at, *x, *y).map(|element| Type::Tuple(*n, element))
            }
            _ => {
                self.report(errors::operands(symbol, at, operands));
                None
            }
        }
    }

    fn both(
        &mut self,
        symbol: &str,
        wanted: &str,
        operands: [(Span, &Type); 2],
        fits: impl Fn(&Type) -> bool,
    ) -> Option<()> {
        let wrong: Vec<_> = operands.into_iter().filter(|(_, ty)| !fits(ty)).collect();
        match wrong[..] {
            // Wrong in the same way on both sides: what was to be joined is another thing, which is one slip.
            [(span, a), (other, b)] if a.describe() == b.describe() => {
                self.report(errors::operand(symbol, wanted, span, a).label(other, "so is this"));
            }
            _ => wrong.iter().for_each(|(span, ty)| self.report(errors::operand(symbol, wanted, *span, ty))),
        }
        wrong.is_empty().then_some(())
    }

    /// The type of both sides of a sum or comparison, which have one dimension.
    fn join(
        &mut self,
        symbol: &str,
        at: Span,
        x: Element,
        y: Element,
        operands: [(Span, &Type); 2],
    ) -> Option<Element> {
        let joined = x.join(y);
        if joined.is_none() {
            self.report(errors::sum(symbol, at, operands));
        }
        joined
    }

    fn product(&mut self, operator: BinaryOp, at: Span, x: Element, y: Element) -> Option<Element> {
        if operator == BinaryOp::Multiply && x.is_int() && y.is_int() {
            return Some(Element::Int);
        }
        let dim = match operator {
            BinaryOp::Divide => x.dim().over(y.dim()),
            _ => x.dim().times(y.dim()),
        };
        if dim.is_none() {
            self.report(errors::exponent(at));
        }
        dim.map(Element::Quantity)
    }
}

/// An operation that gives a value of a type. What gives a number, but for comparisons, is of numbers.
fn operation(operator: BinaryOp, dim: units::Dim, [left, right]: [Expr; 2], ty: &Type) -> ExprKind {
    let (left, right) = (Box::new(left), Box::new(right));
    match (ty, Arithmetic::of(operator)) {
        (Type::Scalar(element), Some(operator)) => {
            ExprKind::Arithmetic { operator, left, right, int: *element == Element::Int }
        }
        _ => ExprKind::Binary { operator, dim, left, right },
    }
}

/// What a computed value counts: a zero that was computed is a whole number like others, not the literal 0.
fn whole(element: Element) -> Element {
    if element == Element::Zero { Element::Int } else { element }
}
