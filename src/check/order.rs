//! In which order the statements of a scope can be evaluated.

use super::functions::by_name;
use super::notes::word_of;
use super::scope::Item;
use crate::schema;
use crate::syntax::ast::{self, Entry, ExprKind as Tree, StatementKind as Kind};
use smol_str::SmolStr;
use std::collections::BTreeMap;

/// For each item the items it uses, in order and without repetition. `declared` says which item declares a name,
/// `setting` which expression stands in place of an item's default.
pub(super) fn dependencies<'t>(
    items: &[Item<'t>],
    declared: &BTreeMap<SmolStr, usize>,
    setting: impl Fn(&Item<'t>) -> Option<&'t ast::Expr>,
) -> Vec<Vec<usize>> {
    let of = |item: &Item<'t>| {
        let mut used = vec![];
        let mut visit = |name: &str| used.extend(declared.get(name));
        match item {
            Item::Statement(statement) => match setting(item) {
                Some(value) => names_in(value, &mut visit),
                None => names_in_statement(statement, &mut visit),
            },
            Item::Rows(rows) => {
                rows.shapes().iter().for_each(|shape| names_in_statement(shape.statement(), &mut visit));
            }
            Item::Broken(_) => {}
        }
        used.sort_unstable();
        used.dedup();
        used
    };
    items.iter().map(of).collect()
}

fn names_in_statement(statement: &ast::Statement, visit: &mut impl FnMut(&str)) {
    match &statement.kind {
        Kind::Thing { construct, .. } => names_in_construct(construct, visit),
        Kind::Definition { value, .. } | Kind::Function { value, .. } => names_in(value, visit),
        Kind::Param { default, range, .. } => {
            names_in(default, visit);
            range.iter().for_each(|range| names_in(range, visit));
        }
        Kind::Part { body, .. } => names_in_body(body, visit),
        Kind::Import { .. } => {}
        Kind::For { list, body, .. } => {
            names_in(list, visit);
            names_in_body(body, visit);
        }
        Kind::If { condition, then, otherwise } => {
            names_in(condition, visit);
            names_in_body(then, visit);
            otherwise.iter().for_each(|body| names_in_body(body, visit));
        }
        Kind::Assert { condition, message } => {
            names_in(condition, visit);
            message.iter().for_each(|message| names_in(message, visit));
        }
    }
}

fn names_in_body(body: &ast::Body, visit: &mut impl FnMut(&str)) {
    for entry in &body.entries {
        match entry {
            Entry::Field(field) if is_word(field) => {}
            Entry::Field(field) => names_in(&field.value, visit),
            Entry::Statement(statement) => names_in_statement(statement, visit),
            Entry::Rows(_) | Entry::Broken(_) => {}
        }
    }
}

fn names_in_construct(construct: &ast::Construct, visit: &mut impl FnMut(&str)) {
    visit(&construct.kind.first.text);
    names_in_body(&construct.body, visit);
}

/// Whether a field's value is a word that the field understands, and so no name. The kind may be a prototype's,
/// which is not known yet: fields of one name understand the same words in every kind.
fn is_word(field: &ast::Field) -> bool {
    let Tree::Name(word) = &field.value.kind else { return false };
    let fields = schema::KINDS.iter().flat_map(|kind| kind.fields);
    fields.filter(|known| known.name == field.name.text).any(|known| word_of(known.ty, word).is_some())
}

fn names_in(expr: &ast::Expr, visit: &mut impl FnMut(&str)) {
    match &expr.kind {
        Tree::Name(name) => visit(name),
        Tree::Construct(construct) => names_in_construct(construct, visit),
        Tree::Tuple(parts) | Tree::List(parts) => parts.iter().for_each(|part| names_in(part, visit)),
        Tree::Call { function, arguments } => {
            // A built-in function is itself, whatever declares its name, which was reported.
            if !function.rest.is_empty() || by_name(&function.first.text).is_none() {
                visit(&function.first.text);
            }
            arguments.iter().for_each(|argument| names_in(&argument.value, visit));
        }
        Tree::Scaled { value, .. } | Tree::Paren(value) | Tree::Member { value, .. } => {
            names_in(value, visit)
        }
        Tree::Index { value, index } => {
            names_in(value, visit);
            names_in(index, visit);
        }
        Tree::If { condition, then, otherwise } => {
            [condition, then, otherwise].into_iter().for_each(|part| names_in(part, visit));
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
pub(super) fn sort(edges: &[Vec<usize>]) -> (Vec<usize>, Vec<Vec<usize>>) {
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
