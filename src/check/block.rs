//! Statements: the bodies of files, parts, groups and branches.

use super::order::{dependencies, sort};
use super::program::{
    Block, Expr, ExprKind, Inside, InsideId, InsideName, Statement, StatementKind, Variable,
};
use super::scope::{Item, Place};
use super::types::{Element, Kind, Type};
use super::{Checker, errors};
use crate::schema::{Category, FieldType};
use crate::span::Span;
use crate::syntax::ast::{self, Entry, Keyword, Name, StatementKind as Tree};
use crate::units;
use smol_str::SmolStr;
use std::collections::BTreeMap;
use std::rc::Rc;
use std::sync::Arc;

/// What a turn of a loop counts by itself, in expressions: about as long as it takes.
const TURN: u64 = 9;

/// The statements of a body, and its fields.
pub(super) fn apart(entries: &[Entry]) -> (Vec<Item<'_>>, Vec<&ast::Field>) {
    let (mut items, mut fields) = (vec![], vec![]);
    for entry in entries {
        match entry {
            Entry::Statement(statement) => items.push(Item::Statement(statement)),
            Entry::Rows(rows) => items.push(Item::Rows(rows)),
            Entry::Broken(broken) => items.push(Item::Broken(broken)),
            Entry::Field(field) => fields.push(field),
        }
    }
    (items, fields)
}

impl<'a> Checker<'a> {
    /// Fields where there are none: in the body of a branch of `for` or `if`, or in a file. Its scope is open, for what
    /// their values refer to.
    /// Fields in a row are one slip, and none behind a thing whose `{` is missing.
    pub(super) fn stray(&mut self, items: &[Item], fields: &[&ast::Field], inside: &str) {
        let mut before = None;
        for field in fields {
            let start = field.name.span.start;
            let last = items.partition_point(|item| item.start() < start).checked_sub(1);
            let explained = match last.map(|last| &items[last]) {
                Some(Item::Broken(broken)) if broken.name.is_some() => true,
                _ => before == Some(last),
            };
            if !explained {
                self.report(errors::field_of_nothing(&field.name, inside));
            }
            before = Some(last);
            self.infer(&field.value);
        }
    }

    /// Opens a scope with these statements and checks them. [`Checker::close`] ends it.
    pub(super) fn open(&mut self, items: &[Item], place: Place, span: Span) -> Block {
        let scope = self.declare(items, place, span);
        let item = |(name, &known): (&SmolStr, &usize)| (name.clone(), scope.known[known].item);
        let declared = scope.names.iter().map(item);
        // A loop without a body does not declare its variable for its own list, and nothing declares what a kind is called:
        // whoever uses that means the kind.
        let declares =
            |name: &str, item: usize| items[item].name().is_some() && crate::schema::kind(name).is_none();
        let declared: BTreeMap<SmolStr, usize> =
            declared.filter(|(name, item)| declares(name, *item)).collect();
        let settings = if place == Place::Main { self.settings } else { &[] };
        let setting = |item: &Item| {
            let Item::Statement(ast::Statement { kind: Tree::Param { .. }, .. }) = item else { return None };
            let name = item.name()?;
            settings.iter().find(|setting| setting.name.text == name.text).map(|setting| &setting.value)
        };
        let (order, cycles) = sort(&dependencies(items, &declared, setting));
        let known: BTreeMap<usize, usize> =
            scope.known.iter().enumerate().map(|(known, name)| (name.item, known)).collect();
        self.scopes.push(scope);
        for cycle in cycles {
            let names: Vec<&Name> = cycle.iter().filter_map(|&item| items[item].name()).collect();
            if names.is_empty() {
                // Loops without a body, by the variables that are taken to be known behind them: they were reported.
                continue;
            }
            let set = cycle.iter().find_map(|&item| setting(&items[item]).zip(items[item].name()));
            self.report(match set {
                Some((value, name)) => errors::cycle_of_setting(name, value.span, &names),
                None => errors::cycle(&names, self.goes_on_below(&items[cycle[0]])),
            });
        }
        let mut statements: Vec<Option<Statement>> = items.iter().map(|_| None).collect();
        for &index in &order {
            let slot = known.get(&index).map(|&known| self.current().known[known].slot);
            let (statement, ty) = self.item(&items[index], place, slot);
            if let Some(&known) = known.get(&index) {
                self.current().known[known].ty = ty;
            }
            statements[index] = Some(statement);
        }
        // What lies on a cycle has no place in the order, and is already of invalid type.
        for (item, _) in items.iter().zip(&statements).filter(|(_, found)| found.is_none()) {
            self.quietly(|checker| checker.item(item, place, None));
        }
        let missing = |item: &Item| {
            let span = match item {
                Item::Statement(statement) => statement.span,
                Item::Broken(broken) => broken.span,
                Item::Rows(rows) => rows.span(),
            };
            Statement { kind: StatementKind::Invalid, span, off: false, solo: false }
        };
        let statements = statements.into_iter().zip(items);
        let statements = statements.map(|(found, item)| found.unwrap_or_else(|| missing(item))).collect();
        let sorted = order.windows(2).all(|pair| pair[0] < pair[1]);
        let order = if sorted { vec![] } else { order.into_iter().map(|index| index as u32).collect() };
        Block { statements, order }
    }

    /// Whether the value of a definition begins on a line below its name.
    fn goes_on_below(&self, item: &Item) -> bool {
        let Item::Statement(ast::Statement { kind: Tree::Definition { name, value, .. }, .. }) = item else {
            return false;
        };
        self.text(Span { end: value.span.start, ..name.span }).contains('\n')
    }

    /// A body of `for` or `if`.
    fn branch(&mut self, body: &ast::Body, word: &str) -> Block {
        let (items, fields) = apart(&body.entries);
        let mut block = self.open(&items, Place::Branch, body.span);
        self.stray(&items, &fields, word);
        self.close(Some(&mut block));
        block
    }

    /// The names of the innermost scope, for paths that lead inside.
    pub(super) fn keep_names(&mut self) -> InsideId {
        let scope = self.current();
        let names = scope.names.iter().map(|(name, &known)| {
            let known = &scope.known[known];
            (name.clone(), InsideName { slot: known.slot, ty: known.ty.clone(), place: known.name.span })
        });
        let inside = Inside { names: names.collect() };
        self.program.insides.push(inside);
        InsideId(self.program.insides.len() as u32 - 1)
    }

    /// One statement, and what its name means.
    pub(super) fn item(&mut self, item: &Item, place: Place, slot: Option<usize>) -> (Statement, Type) {
        let statement = match item {
            Item::Statement(statement) => *statement,
            Item::Rows(rows) => return (self.rows(rows, place), Type::Invalid),
            Item::Broken(broken) => {
                let kind = StatementKind::Invalid;
                return (Statement { kind, span: broken.span, off: false, solo: false }, Type::Invalid);
            }
        };
        let (off, solo) = self.prefixes(statement);
        let (kind, ty) = match &statement.kind {
            Tree::Thing { construct, name } => self.drawn(construct, name.as_ref(), slot),
            Tree::Definition { keyword, name, value } => {
                let (mut checked, ty) = self.defined(*keyword, value);
                if let ExprKind::Make(make) = &mut checked.kind
                    && let Some(written) = Rc::get_mut(&mut make.written)
                {
                    written.defined = Some(name.text.clone());
                }
                self.keyword_fits(*keyword, name, value, &ty);
                (self.define(slot, checked), ty)
            }
            Tree::Param { name, ty, default, range } => self.param(name, ty, default, range.as_ref(), place),
            Tree::Part { name, body } => self.part(name, body, statement, place),
            Tree::Import { name, .. } => self.import(statement, name, place),
            Tree::Function { name, parameters, result, value } => {
                self.function(name, parameters, result, value, statement, place)
            }
            Tree::For { variable, list, body } => (self.repeat(variable, list, body), Type::Invalid),
            Tree::If { condition, then, otherwise } => {
                let condition = self.condition("if", condition);
                let then = self.branch(then, "if");
                let otherwise = otherwise.as_ref().map(|body| self.branch(body, "else"));
                let otherwise = otherwise.unwrap_or_default();
                (StatementKind::If { condition, then, otherwise }, Type::Invalid)
            }
            Tree::Assert { condition, message } => {
                let condition = self.condition("assert", condition);
                let message = message.as_ref().map(|message| self.message(message));
                (StatementKind::Assert { condition, message }, Type::Invalid)
            }
        };
        (Statement { kind, span: statement.span, off, solo }, ty)
    }

    /// What a definition gives a name to.
    fn defined(&mut self, keyword: Keyword, value: &ast::Expr) -> (Expr, Type) {
        let material = FieldType::Made(Category::Material);
        let unknown = (keyword == Keyword::Material).then(|| self.unknown_value(material, value)).flatten();
        match unknown {
            Some(diagnostic) => {
                self.report_lost(&self.text(value.span).into(), diagnostic);
                (Expr::invalid(value.span), Type::Invalid)
            }
            None if keyword == Keyword::Material => self.infer_wanted(material, value),
            None => self.infer(value),
        }
    }

    fn define(&self, slot: Option<usize>, value: Expr) -> StatementKind {
        match slot {
            Some(slot) => StatementKind::Define { slot, value },
            None => StatementKind::Invalid,
        }
    }

    fn keyword_fits(&mut self, keyword: Keyword, name: &Name, value: &ast::Expr, ty: &Type) {
        let material = matches!(ty, Type::Made(making) if making.kind.category() == Category::Material);
        if *ty == Type::Invalid || material == (keyword == Keyword::Material) {
            return;
        }
        self.report(errors::wrong_keyword(keyword, name, value.span, ty));
    }

    /// What must be true or false.
    pub(super) fn condition(&mut self, word: &str, condition: &ast::Expr) -> Expr {
        let (checked, ty) = self.infer(condition);
        if !matches!(ty, Type::Bool | Type::Invalid) {
            self.report(errors::operand(word, "true or false", condition.span, &ty));
            return Expr::invalid(condition.span);
        }
        checked
    }

    fn message(&mut self, message: &ast::Expr) -> Expr {
        let (checked, ty) = self.infer(message);
        if !matches!(ty, Type::Text | Type::Invalid) {
            self.report(errors::operand("assert", "a text to say", message.span, &ty));
        }
        checked
    }

    fn repeat(&mut self, variable: &Name, list: &ast::Expr, body: &ast::Body) -> StatementKind {
        let before = self.nodes;
        let (list_found, ty) = self.infer(list);
        let item = match &ty {
            Type::List(item) => (**item).clone(),
            Type::Invalid => Type::Invalid,
            ty => {
                self.report(errors::not_a_list(list.span, ty));
                Type::Invalid
            }
        };
        if body.span.range().is_empty() {
            // Its variable counts as declared around it, where its body probably stands.
            return StatementKind::Invalid;
        }
        let item = if item == Type::Scalar(Element::Zero) { Type::Scalar(Element::Int) } else { item };
        let mut scope = self.scope(Place::Parameters, body.span);
        let dim = match item {
            Type::Scalar(element) => element.dim(),
            _ => units::NONE,
        };
        let said = Arc::new(Variable { name: variable.text.clone(), dim, span: variable.span });
        let slot = self.declare_alone(&mut scope, variable, item, true);
        self.scopes.push(scope);
        let body = self.branch(body, "for");
        self.close(None);
        StatementKind::For { slot, variable: said, list: list_found, body, cost: self.nodes - before + TURN }
    }

    /// A thing in statement position.
    pub(super) fn drawn(
        &mut self,
        construct: &ast::Construct,
        name: Option<&Name>,
        slot: Option<usize>,
    ) -> (StatementKind, Type) {
        let (make, ty) = self.make(construct, name);
        let Type::Made(making) = ty else { return (StatementKind::Invalid, Type::Invalid) };
        let span = path_span(&construct.kind);
        let category = making.kind.category();
        let inner = self.scopes.iter().any(|scope| matches!(scope.place, Place::Part | Place::Group));
        match making.kind {
            _ if category == Category::Material => {
                self.report(errors::material_drawn(&construct.kind, name));
                // Its name stands for it, as was meant.
                return (StatementKind::Invalid, ty);
            }
            Kind::BuiltIn(kind) if category == Category::Block && inner => {
                self.report(errors::block_inside(&construct.kind, kind))
            }
            _ => self.complete(making, span, Some(construct.body.span)),
        }
        (StatementKind::Draw { slot, make: Box::new(make) }, Type::Thing(making))
    }
}

/// All of a path.
pub(super) fn path_span(path: &ast::Path) -> crate::span::Span {
    path.rest.last().map_or(path.first.span, |last| path.first.span.to(last.span))
}

/// A path as written.
pub(super) fn path_text(path: &ast::Path) -> String {
    let names = std::iter::once(&path.first).chain(&path.rest);
    names.map(|name| name.text.as_str()).collect::<Vec<_>>().join(".")
}
