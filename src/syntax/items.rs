//! Items to entries of the tree, each parsed by itself unless it is like an earlier one.

use super::ast::{Entry, Expr, ExprKind};
use super::build::{Builder, Grammar, Rule, Source};
use super::cut::Item;
use super::errors::{self, Sink};
use super::remembered::Remembered;
use super::rows::Rows;
use super::shapes::Shapes;
use super::{docs, value};
use crate::span::Span;
use pest::Parser;
use std::borrow::Cow;

/// The entries of items.
pub(super) fn items(source: Source, items: &[Item]) -> (Vec<Entry>, Sink) {
    let mut entries = Vec::with_capacity(items.len());
    let mut sink = Sink::default();
    let mut shapes = Shapes::default();
    let mut rows = Rows::default();
    for item in items {
        // An item with comments inside has places that its text alone does not tell.
        let plain = matches!(item.text, Cow::Borrowed(_)) && !item.skipped && item.depth < DEEP;
        let start = item.start as u32;
        if plain && let Some((shape, literals)) = shapes.recall(&item.text) {
            if shape.is_plain() && !docs::any(&source, item.start) {
                rows.push(shape, &item.text, start, literals);
                continue;
            }
            let mut copies = shape.copy(&item.text, start, literals);
            copies.iter_mut().for_each(|entry| document(source, entry));
            close(&mut rows, &mut entries);
            entries.append(&mut copies);
            continue;
        }
        close(&mut rows, &mut entries);
        let (built, slips) = match source.known.filter(|_| item.depth < DEEP) {
            Some(known) => entries_again(source, item, known),
            None => on_enough_stack(source, item, || entries_of(source, item)),
        };
        if plain && slips.is_empty() {
            shapes.learn(&built, start);
        }
        entries.extend(built);
        sink.append(slips);
    }
    close(&mut rows, &mut entries);
    (entries, sink)
}

/// The entries of an item that may have been read before.
fn entries_again(source: Source, item: &Item, known: &Remembered) -> (Vec<Entry>, Sink) {
    if let Some(mut entries) = known.recall(&source, item) {
        entries.iter_mut().for_each(|entry| document(source, entry));
        return (entries, Sink::default());
    }
    let (entries, slips) = entries_of(source, item);
    if slips.is_empty() {
        known.learn(&source, item, &entries);
    }
    (entries, slips)
}

/// Ends a run of rows.
fn close(rows: &mut Rows, entries: &mut Vec<Entry>) {
    if !rows.is_empty() {
        entries.push(std::mem::take(rows).finish());
    }
}

/// Gives a copy of a statement its own doc.
fn document(source: Source, entry: &mut Entry) {
    if let Entry::Statement(statement) = entry {
        let whole = statement.prefixes.first().map_or(statement.span, |prefix| prefix.span);
        statement.doc = docs::of(&source, whole, statement.span);
    }
}

/// The one expression that an item is.
pub(super) fn value(source: Source, item: Option<&Item>) -> (Expr, Sink) {
    match item {
        Some(item) => on_enough_stack(source, item, || value_of(source, item)),
        None => {
            let mut sink = Sink::default();
            let span = Span::new(source.id, 0, source.text.len());
            sink.push(errors::missing_value("", span));
            (Expr { kind: ExprKind::Invalid, span }, sink)
        }
    }
}

fn entries_of(source: Source, item: &Item) -> (Vec<Entry>, Sink) {
    let builder = Builder::new(source, item);
    let entries = if item.skipped {
        vec![builder.unread()]
    } else if let Ok(pairs) = Grammar::parse(Rule::item, &item.text) {
        builder.entries(pairs, true).0
    } else {
        // The grammar takes any text; what it can lack is stack.
        builder.report(errors::exhausted(builder.whole()));
        vec![builder.unread()]
    };
    (entries, builder.sink.into_inner())
}

fn value_of(source: Source, item: &Item) -> (Expr, Sink) {
    let builder = Builder::new(source, item);
    let mut expr = Expr { kind: ExprKind::Invalid, span: builder.whole() };
    if !item.skipped {
        match Grammar::parse(Rule::value, &item.text) {
            Ok(pairs) => {
                for pair in pairs {
                    match pair.as_rule() {
                        Rule::expr => expr = value::expression(&builder, pair).0,
                        Rule::extra_all if matches!(expr.kind, ExprKind::Invalid) => {}
                        Rule::extra_all => builder.unexpected(&pair, errors::unexpected_behind),
                        _ => {}
                    }
                }
            }
            Err(_) => builder.report(errors::exhausted(builder.whole())),
        }
    }
    (expr, builder.sink.into_inner())
}

/// From this nesting on an item gets a stack of its own.
const DEEP: usize = 48;

/// Enough for a bracket, with all that the grammar can put between it and the next one.
const BRACKET_STACK: usize = 128 << 10;

/// Runs `read`, on a larger stack if the item is nested deep: the caller's may be that of a worker thread.
fn on_enough_stack<T: Send>(source: Source, item: &Item, read: impl FnOnce() -> T + Send) -> T {
    if item.depth < DEEP || item.skipped {
        return read();
    }
    std::thread::scope(|scope| {
        let thread = std::thread::Builder::new().stack_size(BRACKET_STACK * source.depth.max(2 * DEEP));
        let handle = thread.spawn_scoped(scope, read).expect("the system has a thread to spare");
        handle.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    })
}
