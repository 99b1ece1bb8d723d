//! Names: who declares them, in which order they can be evaluated, and whether they are used.

use super::make::find_word;
use super::{Binding, Block, Checker, Expr, ExprKind, Type, errors, functions, types::FieldSet};
use crate::diagnostic::Code;
use crate::schema;
use crate::span::Span;
use crate::syntax::ast::{self, Entry, ExprKind as Tree, Keyword, Name, Statement, StatementKind};
use crate::{color, units};
use smol_str::SmolStr;
use std::collections::BTreeMap;

/// The names of one body.
pub(super) struct Scope {
    slots: BTreeMap<SmolStr, usize>,
    bindings: Vec<Known>,
}

/// What is known of a binding.
struct Known {
    name: Option<Name>,
    ty: Type,
    used: bool,
    drawn: bool,
}

/// A statement, or the name of one that could not be understood.
pub(super) enum Item<'a> {
    Statement(&'a Statement),
    Broken(&'a ast::Broken),
}

impl Scope {
    /// Whether it declares this name.
    pub(super) fn knows(&self, name: &str) -> bool {
        self.slots.contains_key(name)
    }
}

impl<'a> Item<'a> {
    fn name(&self) -> Option<&'a Name> {
        match self {
            Item::Statement(statement) => match &statement.kind {
                StatementKind::Thing { name, .. } => name.as_ref(),
                StatementKind::Definition { name, .. }
                | StatementKind::Param { name, .. }
                | StatementKind::Part { name, .. }
                | StatementKind::Import { name, .. }
                | StatementKind::Function { name, .. } => Some(name),
                StatementKind::For { .. } | StatementKind::If { .. } | StatementKind::Assert { .. } => None,
            },
            Item::Broken(broken) => broken.name.as_ref(),
        }
    }

    fn span(&self) -> Span {
        match self {
            Item::Statement(statement) => statement.span,
            Item::Broken(broken) => broken.span,
        }
    }

    fn drawn(&self) -> bool {
        matches!(self, Item::Statement(Statement { kind: StatementKind::Thing { .. }, .. }))
    }
}

impl Checker<'_> {
    /// Checks the top level of a file.
    pub(super) fn block(&mut self, entries: &[Entry]) -> Block {
        let mut items = vec![];
        for entry in entries {
            match entry {
                Entry::Statement(statement) => items.push(Item::Statement(statement)),
                Entry::Broken(broken) => items.push(Item::Broken(broken)),
                Entry::Field(field) => self.report(errors::field_at_top_level(&field.name)),
            }
        }
        let block = self.open(&items, true);
        self.close();
        block
    }

    /// Opens a scope with these statements and checks them. [`Checker::close`] ends it.
    pub(super) fn open(&mut self, items: &[Item], top_level: bool) -> Block {
        let scope = self.declare(items);
        let edges = dependencies(items, &scope);
        let (order, cycles) = sort(&edges);
        self.scopes.push(scope);
        for cycle in cycles {
            let names: Vec<&Name> = cycle.iter().filter_map(|&slot| items[slot].name()).collect();
            self.report(errors::cycle(&names));
        }
        let mut bindings: Vec<Option<Binding>> = items.iter().map(|_| None).collect();
        for &slot in &order {
            let (value, ty) = self.item(&items[slot], top_level);
            self.current().bindings[slot].ty = ty;
            bindings[slot] = Some(Binding {
                name: items[slot].name().map(|name| name.text.clone()),
                value,
                drawn: items[slot].drawn(),
                span: items[slot].span(),
            });
        }
        // What lies on a cycle has no place in the order, and is already of invalid type.
        let missing = |slot: usize| Binding {
            name: None,
            value: Expr::invalid(items[slot].span()),
            drawn: false,
            span: items[slot].span(),
        };
        let bindings = bindings.into_iter().enumerate();
        Block { bindings: bindings.map(|(slot, b)| b.unwrap_or_else(|| missing(slot))).collect(), order }
    }

    /// Ends the innermost scope, and warns of names nobody used.
    pub(super) fn close(&mut self) {
        let Some(scope) = self.scopes.pop() else { return };
        for known in &scope.bindings {
            if let Some(name) = &known.name
                && !known.used
                && !known.drawn
            {
                self.report(errors::unused(name, known.ty));
            }
        }
    }

    fn current(&mut self) -> &mut Scope {
        self.scopes.last_mut().expect("a scope is open while its items are checked")
    }

    fn declare(&mut self, items: &[Item]) -> Scope {
        let mut scope = Scope { slots: BTreeMap::new(), bindings: vec![] };
        for (slot, item) in items.iter().enumerate() {
            let mut known = Known { name: None, ty: Type::Invalid, used: false, drawn: item.drawn() };
            if let (Item::Statement(_), Some(name)) = (item, item.name()) {
                match scope.slots.get(&name.text) {
                    Some(&first) => {
                        let first = scope.bindings[first].name.clone();
                        self.report(errors::duplicate(name, first.as_ref()));
                    }
                    None => {
                        if let Some(diagnostic) = self.shadows(name) {
                            self.report(diagnostic);
                        }
                        scope.slots.insert(name.text.clone(), slot);
                    }
                }
                known.name = Some(name.clone());
            }
            scope.bindings.push(known);
        }
        // A broken item's name counts as declared where nothing else declares it: its slip is one error.
        for (slot, item) in items.iter().enumerate() {
            if let (Item::Broken(_), Some(name)) = (item, item.name())
                && self.shadows(name).is_none()
            {
                scope.slots.entry(name.text.clone()).or_insert(slot);
            }
        }
        scope
    }

    /// What a declaration of this name would hide.
    fn shadows(&self, name: &Name) -> Option<crate::diagnostic::Diagnostic> {
        let outer = self.scopes.iter().rev().find_map(|scope| {
            scope.slots.get(&name.text).and_then(|&slot| scope.bindings[slot].name.as_ref())
        });
        if let Some(outer) = outer {
            return Some(errors::shadows(name, outer));
        }
        let what = if units::is_unit(&name.text) {
            "a unit"
        } else if schema::kind(&name.text).is_some() {
            "a built-in kind"
        } else if functions::by_name(&name.text).is_some() {
            "a built-in function"
        } else {
            return None;
        };
        Some(errors::built_in(name, what))
    }

    fn item(&mut self, item: &Item, top_level: bool) -> (Expr, Type) {
        match item {
            Item::Broken(broken) => (Expr::invalid(broken.span), Type::Invalid),
            Item::Statement(statement) => match &statement.kind {
                StatementKind::Thing { construct, .. } => self.drawn(construct, top_level),
                StatementKind::Definition { keyword, name, value } => {
                    let (checked, ty) = self.infer(value);
                    self.keyword_fits(*keyword, name, value, ty);
                    (checked, ty)
                }
                _ => (Expr::invalid(statement.span), Type::Invalid),
            },
        }
    }

    fn keyword_fits(&mut self, keyword: Keyword, name: &Name, value: &ast::Expr, ty: Type) {
        let material = matches!(ty, Type::Made(kind, _) if kind.get().category == schema::Category::Material);
        if ty == Type::Invalid || material == (keyword == Keyword::Material) {
            return;
        }
        self.report(errors::wrong_keyword(keyword, name, value.span, ty));
    }

    /// Looks a name up from the innermost scope outwards.
    pub(super) fn lookup(&mut self, name: &str) -> Option<(ExprKind, Type)> {
        for (up, scope) in self.scopes.iter_mut().rev().enumerate() {
            if let Some(&slot) = scope.slots.get(name) {
                let known = &mut scope.bindings[slot];
                known.used = true;
                return Some((ExprKind::Name { up, slot }, known.ty));
            }
        }
        color::named(name).map(|color| (ExprKind::Color(color), Type::Color))
    }

    /// The scopes whose names can be compared with one more unknown name.
    fn comparable(&self) -> &[Scope] {
        let count = self.scopes.iter().map(|scope| scope.slots.len()).sum();
        let left = self.guesses.get().checked_sub(count);
        self.guesses.set(left.unwrap_or(0));
        if left.is_some() { &self.scopes } else { &[] }
    }

    /// Names in scope that may stand for a value, for suggestions.
    pub(super) fn value_names(&self) -> Vec<&str> {
        let scopes = self.comparable().iter();
        let declared = scopes.flat_map(|scope| scope.slots.keys().map(SmolStr::as_str));
        declared.chain(color::NAMED.iter().map(|(name, _)| *name)).collect()
    }

    /// Names that may stand before `{`, for suggestions.
    pub(super) fn kind_names(&self) -> Vec<&str> {
        let prototypes = self.comparable().iter().flat_map(|scope| {
            let made =
                scope.slots.iter().filter(|(_, slot)| matches!(scope.bindings[**slot].ty, Type::Made(..)));
            made.map(|(name, _)| name.as_str())
        });
        schema::KINDS.iter().map(|kind| kind.name).chain(prototypes).collect()
    }

    /// A name used as a kind: what it begins as.
    pub(super) fn kind_of(&mut self, name: &Name) -> (super::Base, Option<(schema::KindId, FieldSet)>) {
        if let Some(kind) = schema::kind(&name.text) {
            return (super::Base::Kind(kind), Some((kind, FieldSet::default())));
        }
        match self.lookup(&name.text) {
            Some((kind, Type::Made(made, given))) => {
                (super::Base::Prototype(Expr { kind, span: name.span }), Some((made, given)))
            }
            Some((_, Type::Invalid)) => (super::Base::Invalid, None),
            Some((_, ty)) => {
                self.report(errors::not_a_kind(name, ty));
                (super::Base::Invalid, None)
            }
            None => {
                let diagnostic = errors::unknown(Code::E0101, "kind", name, &self.kind_names());
                self.report(diagnostic);
                // What stands inside is looked at as if the kind had been spelt right.
                let built_in: Vec<&str> = schema::KINDS.iter().map(|kind| kind.name).collect();
                let guess = errors::closest(&name.text, &built_in).and_then(schema::kind);
                (super::Base::Invalid, guess.map(|kind| (kind, FieldSet::default())))
            }
        }
    }
}

/// For each item the slots it uses, in order and without repetition.
fn dependencies(items: &[Item], scope: &Scope) -> Vec<Vec<usize>> {
    items
        .iter()
        .map(|item| {
            let mut used = vec![];
            let mut visit = |name: &str| used.extend(scope.slots.get(name));
            match item {
                Item::Statement(statement) => names_in_statement(statement, &mut visit),
                Item::Broken(_) => {}
            }
            used.sort_unstable();
            used.dedup();
            used
        })
        .collect()
}

fn names_in_statement(statement: &Statement, visit: &mut impl FnMut(&str)) {
    match &statement.kind {
        StatementKind::Thing { construct, .. } => names_in_construct(construct, visit),
        StatementKind::Definition { value, .. } => names_in(value, visit),
        _ => {}
    }
}

fn names_in_construct(construct: &ast::Construct, visit: &mut impl FnMut(&str)) {
    visit(&construct.kind.first.text);
    for entry in &construct.body.entries {
        match entry {
            Entry::Field(field) if is_word(field) => {}
            Entry::Field(field) => names_in(&field.value, visit),
            Entry::Statement(statement) => names_in_statement(statement, visit),
            Entry::Broken(_) => {}
        }
    }
}

/// Whether a field's value is a word that the field understands, and so no name. The kind may be a prototype's,
/// which is not known yet: fields of one name understand the same words in every kind.
fn is_word(field: &ast::Field) -> bool {
    let Tree::Name(word) = &field.value.kind else { return false };
    let fields = schema::KINDS.iter().flat_map(|kind| kind.fields);
    fields.filter(|known| known.name == field.name.text).any(|known| find_word(known.ty, word).is_some())
}

fn names_in(expr: &ast::Expr, visit: &mut impl FnMut(&str)) {
    match &expr.kind {
        Tree::Name(name) => visit(name),
        Tree::Construct(construct) => names_in_construct(construct, visit),
        Tree::Tuple(parts) | Tree::List(parts) => parts.iter().for_each(|part| names_in(part, visit)),
        Tree::Call { arguments, .. } => {
            arguments.iter().for_each(|argument| names_in(&argument.value, visit))
        }
        Tree::Scaled { value, .. } | Tree::Paren(value) | Tree::Member { value, .. } => {
            names_in(value, visit)
        }
        Tree::Index { value, index } => {
            names_in(value, visit);
            names_in(index, visit);
        }
        Tree::If { condition, then, otherwise } => {
            names_in(condition, visit);
            names_in(then, visit);
            names_in(otherwise, visit);
        }
        Tree::Unary { operand, .. } => names_in(operand, visit),
        Tree::Binary { left, right, .. } => {
            names_in(left, visit);
            names_in(right, visit);
        }
        Tree::Invalid
        | Tree::Number { .. }
        | Tree::Quantity { .. }
        | Tree::Bool(_)
        | Tree::Text(_)
        | Tree::Color(_) => {}
    }
}

/// An order in which every item comes after those it uses, without the items on a cycle; and the cycles, each
/// as the path that closes it. Depth first, with its own stack: a chain of definitions may be long.
fn sort(edges: &[Vec<usize>]) -> (Vec<usize>, Vec<Vec<usize>>) {
    #[derive(Clone, Copy, PartialEq)]
    enum State {
        New,
        Open,
        Done,
    }
    let mut state = vec![State::New; edges.len()];
    let mut cyclic = vec![false; edges.len()];
    let mut order = vec![];
    let mut cycles = vec![];
    for start in 0..edges.len() {
        // The path from `start`, each with the number of its edges followed so far.
        let mut path: Vec<(usize, usize)> = vec![];
        if state[start] == State::New {
            state[start] = State::Open;
            path.push((start, 0));
        }
        while let Some((item, followed)) = path.last_mut() {
            match edges[*item].get(*followed) {
                None => {
                    state[*item] = State::Done;
                    if !cyclic[*item] {
                        order.push(*item);
                    }
                    path.pop();
                }
                Some(&next) => {
                    *followed += 1;
                    match state[next] {
                        State::New => {
                            state[next] = State::Open;
                            path.push((next, 0));
                        }
                        State::Open => {
                            let from = path.iter().position(|(item, _)| *item == next).unwrap_or(0);
                            let cycle: Vec<usize> = path[from..].iter().map(|(item, _)| *item).collect();
                            // A second way around the same things is the same slip.
                            if !cycle.iter().all(|&item| cyclic[item]) {
                                cycle.iter().for_each(|&item| cyclic[item] = true);
                                cycles.push(cycle);
                            }
                        }
                        State::Done => {}
                    }
                }
            }
        }
    }
    (order, cycles)
}

#[cfg(test)]
mod tests {
    use super::sort;

    #[test]
    fn order_follows_use_and_cycles_are_paths() {
        let (order, cycles) = sort(&[vec![1], vec![2], vec![], vec![4], vec![3], vec![3]]);
        assert_eq!(order, [2, 1, 0, 5]);
        assert_eq!(cycles, [[3, 4]]);
        let long: Vec<Vec<usize>> =
            (0..200_000).map(|i| if i < 199_999 { vec![i + 1] } else { vec![] }).collect();
        assert_eq!(sort(&long).0.first(), Some(&199_999));
    }
}
