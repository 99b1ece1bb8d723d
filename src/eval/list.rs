//! Lists. Those that follow a rule are kept as the rule.

use super::value::Value;
use crate::check::TableId;
use std::cell::Cell;
use std::rc::Rc;

/// The items of a list.
#[derive(Debug, PartialEq)]
pub enum List {
    /// Whole numbers in a row.
    Range {
        /// The first.
        first: f64,
        /// How many.
        count: usize,
    },
    /// Values evenly from one to another, both included.
    Linspace {
        /// The first: a number or triple.
        from: Value,
        /// The last.
        to: Value,
        /// How many.
        count: usize,
    },
    /// The rows of a table.
    Rows {
        /// Which.
        table: TableId,
        /// How many.
        count: usize,
    },
    /// As written.
    Items(Items),
}

/// Values that are counted while they live, so that lists cannot fill the memory.
#[derive(Debug)]
pub struct Items {
    values: Vec<Value>,
    live: Rc<Cell<usize>>,
}

impl Items {
    pub(super) fn new(values: Vec<Value>, live: &Rc<Cell<usize>>) -> Items {
        live.set(live.get() + values.len());
        Items { values, live: live.clone() }
    }
}

impl Drop for Items {
    fn drop(&mut self) {
        self.live.set(self.live.get() - self.values.len());
    }
}

impl PartialEq for Items {
    fn eq(&self, other: &Items) -> bool {
        self.values == other.values
    }
}

impl List {
    /// How many items there are.
    pub fn len(&self) -> usize {
        match self {
            List::Range { count, .. } | List::Linspace { count, .. } | List::Rows { count, .. } => *count,
            List::Items(items) => items.values.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The item at an index from 0.
    #[inline]
    pub fn get(&self, index: usize) -> Option<Value> {
        if index >= self.len() {
            return None;
        }
        Some(match self {
            List::Range { first, .. } => Value::Number(first + index as f64),
            List::Rows { table, .. } => Value::Row(*table, index as u32),
            List::Items(items) => items.values[index].clone(),
            List::Linspace { from, .. } if index == 0 => from.clone(),
            List::Linspace { to, count, .. } if index + 1 == *count => to.clone(),
            List::Linspace { from, to, count } => {
                let t = index as f64 / (*count as f64 - 1.0);
                match (from, to) {
                    (Value::Number(a), Value::Number(b)) => Value::Number(a * (1.0 - t) + b * t),
                    (Value::Tuple(a), Value::Tuple(b)) => Value::Tuple(*a * (1.0 - t) + *b * t),
                    _ => Value::Invalid,
                }
            }
        })
    }
}
