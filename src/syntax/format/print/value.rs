//! Expressions, their rows of operators and their lists.

use super::*;

impl<'t> Printer<'t> {
    pub(super) fn expr(&mut self, expr: &'t Expr, out: &mut Docs<'t>) {
        self.led(start(expr.span), out, |this, out| this.bare_expr(expr, out));
    }

    /// What begins at an offset, behind the comments before it; where these end a line, all of it is indented.
    fn led(
        &mut self,
        offset: usize,
        out: &mut Docs<'t>,
        print: impl FnOnce(&mut Printer<'t>, &mut Docs<'t>),
    ) {
        let mut inner = vec![];
        self.lead(offset, &mut inner);
        if inner.iter().any(Doc::hangs) {
            print(self, &mut inner);
            out.push(Doc::Nest(inner));
        } else {
            out.extend(inner);
            print(self, out);
        }
    }

    /// Without the comments before it.
    fn bare_expr(&mut self, expr: &'t Expr, out: &mut Docs<'t>) {
        let closer = end(expr.span).saturating_sub(1);
        match &expr.kind {
            ExprKind::Invalid
            | ExprKind::Number { .. }
            | ExprKind::Quantity { .. }
            | ExprKind::Bool(_)
            | ExprKind::Text(_)
            | ExprKind::Color(_)
            | ExprKind::Name(_) => out.push(Doc::Text(self.source(expr.span))),
            ExprKind::Scaled { value, unit } => {
                self.expr(value, out);
                out.push(Doc::Text(self.source(unit.span)));
            }
            ExprKind::Tuple(values) => self.values(["(", ")"], closer, values, false, out),
            ExprKind::List(values) => {
                let fill = values.iter().all(is_small);
                self.values(["[", "]"], closer, values, fill, out);
            }
            ExprKind::Paren(value) => {
                self.values(["(", ")"], closer, std::slice::from_ref(&**value), false, out);
            }
            ExprKind::Call { function, arguments } => {
                self.path(function, out);
                self.arguments(arguments, closer, out);
            }
            ExprKind::Member { value, member } => {
                self.expr(value, out);
                self.lead(start(member.span), out);
                out.push(Doc::Text("."));
                out.push(Doc::Text(self.source(member.span)));
            }
            ExprKind::Index { value, index } => {
                self.expr(value, out);
                self.values(["[", "]"], closer, std::slice::from_ref(&**index), false, out);
            }
            ExprKind::If { condition, then, otherwise } => {
                let mut inner = vec![];
                self.conditional([condition, then, otherwise], &mut inner);
                out.push(group(vec![Doc::Nest(inner)]));
            }
            ExprKind::Construct(construct) => self.construct(construct, out),
            ExprKind::Unary { operator, operand } => {
                out.push(Doc::Text(if *operator == UnaryOp::Not { "not " } else { "-" }));
                self.expr(operand, out);
            }
            ExprKind::Binary { operator, .. } => {
                let (mut first, mut behind) = (vec![], vec![]);
                self.chain(expr, level(*operator), &mut first, &mut behind);
                let mut first = hung(first);
                first.push(Doc::Nest(behind));
                out.push(group(first));
            }
        }
    }

    /// A row of operators that bind alike: the first operand, and what follows. It breaks before operators, but
    /// behind `-`, which at the beginning of a line would be another entry.
    pub(super) fn chain(&mut self, expr: &'t Expr, level: u8, first: &mut Docs<'t>, behind: &mut Docs<'t>) {
        match &expr.kind {
            ExprKind::Binary { operator, at, left, right } if self::level(*operator) == level => {
                self.chain(left, level, first, behind);
                let last = if behind.is_empty() { &mut *first } else { &mut *behind };
                self.trail(end(left.span), start(*at), last);
                match operator {
                    BinaryOp::Subtract => {
                        self.lead(start(*at), behind);
                        behind.push(Doc::Text(" -"));
                        self.trail(end(*at), start(right.span), behind);
                        behind.push(Doc::Line);
                        self.lead(start(right.span), behind);
                    }
                    _ => {
                        behind.push(Doc::Line);
                        self.lead(start(*at), behind);
                        behind.push(Doc::Text(operator.symbol()));
                        behind.push(Doc::Text(" "));
                    }
                }
                self.expr(right, behind);
            }
            _ => self.expr(expr, first),
        }
    }

    /// `if … then … else …`, whose last choice may be another one.
    fn conditional(&mut self, [condition, then, otherwise]: [&'t Expr; 3], out: &mut Docs<'t>) {
        out.push(Doc::Text("if "));
        self.expr(condition, out);
        self.trail(end(condition.span), start(then.span), out);
        out.extend([Doc::Line, Doc::Text("then ")]);
        self.expr(then, out);
        self.trail(end(then.span), start(otherwise.span), out);
        out.extend([Doc::Line, Doc::Text("else ")]);
        match &otherwise.kind {
            ExprKind::If { condition, then, otherwise: next } => {
                let choice = [&**condition, then, next];
                self.led(start(otherwise.span), out, |this, out| this.conditional(choice, out));
            }
            _ => self.expr(otherwise, out),
        }
    }

    pub(super) fn values(
        &mut self,
        brackets: [&'static str; 2],
        closer: usize,
        values: &'t [Expr],
        fill: bool,
        out: &mut Docs<'t>,
    ) {
        let place = |value: &Expr| value.span.range();
        self.enclosed(brackets, closer, values, place, fill, out, |this, value, out| this.expr(value, out));
    }

    pub(super) fn arguments(&mut self, arguments: &'t [Argument], closer: usize, out: &mut Docs<'t>) {
        let place = |argument: &Argument| {
            let first = argument.name.as_ref().map_or(argument.value.span, |name| name.span);
            start(first)..end(argument.value.span)
        };
        self.enclosed(["(", ")"], closer, arguments, place, false, out, |this, argument, out| {
            if let Some(name) = &argument.name {
                this.name(name, out);
                out.push(Doc::Text(": "));
            }
            this.expr(&argument.value, out);
        });
    }

    /// What stands between brackets, separated by commas: on one line, or each on its own, or as many on a line as
    /// fit (`fill`).
    #[allow(clippy::too_many_arguments)]
    pub(super) fn enclosed<T>(
        &mut self,
        [open, close]: [&'static str; 2],
        closer: usize,
        items: &'t [T],
        place: impl Fn(&T) -> Range<usize>,
        fill: bool,
        out: &mut Docs<'t>,
        mut print: impl FnMut(&mut Printer<'t>, &'t T, &mut Docs<'t>),
    ) {
        let mut inner = vec![Doc::Soft];
        for (index, item) in items.iter().enumerate() {
            let mut one = vec![];
            if index > 0 {
                one.push(Doc::Line);
            }
            self.lead(place(item).start, &mut one);
            print(self, item, &mut one);
            let next = items.get(index + 1).map_or(closer, |next| place(next).start);
            if index + 1 < items.len() {
                one.push(Doc::Text(","));
            }
            self.trail(place(item).end, next, &mut one);
            match fill && index > 0 {
                true => inner.push(group(one)),
                false => inner.extend(one),
            }
        }
        self.lead(closer, &mut inner);
        out.push(group(vec![Doc::Text(open), Doc::Nest(inner), Doc::Soft, Doc::Text(close)]));
    }
}

/// How tight an operator binds: those of one level stand in one row.
fn level(operator: BinaryOp) -> u8 {
    use BinaryOp::*;
    match operator {
        Pipe => 0,
        Or => 1,
        And => 2,
        Equal | NotEqual | Less | LessEqual | Greater | GreaterEqual => 3,
        To => 4,
        Add | Subtract => 5,
        Multiply | Divide => 6,
    }
}

/// Values of which many stand on a line.
fn is_small(expr: &Expr) -> bool {
    match &expr.kind {
        ExprKind::Number { .. }
        | ExprKind::Quantity { .. }
        | ExprKind::Bool(_)
        | ExprKind::Color(_)
        | ExprKind::Name(_) => true,
        ExprKind::Tuple(values) => values.iter().all(is_small),
        ExprKind::Scaled { value, .. } => is_small(value),
        ExprKind::Unary { operand, .. } => is_small(operand),
        _ => false,
    }
}
