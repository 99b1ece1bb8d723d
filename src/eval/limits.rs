//! How much a file may ask for.

use super::{Evaluator, Value, errors};
use crate::diagnostic::Diagnostic;
use crate::span::Span;
use crate::syntax;

/// What evaluating a file may take. Going over one is an error at the place.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Things that are made, those that prototypes hold among them.
    pub things: usize,
    /// Levels of parts, groups and calls within each other.
    pub levels: usize,
    /// Items of one list; ten times as many may live at once.
    pub items: usize,
    /// Expressions that are evaluated, those of each turn of a loop and of each call counted anew.
    pub steps: u64,
    /// What reading the files may take, which is done before.
    pub text: syntax::Limits,
}

impl Default for Limits {
    fn default() -> Limits {
        Limits {
            things: 10_000_000,
            levels: 64,
            items: 1_000_000,
            steps: 1_000_000_000,
            text: syntax::Limits::default(),
        }
    }
}

/// The most expressions within each other, bodies of parts and functions counted where they are used. The stack of
/// [`crate::compile`] holds as many.
pub(super) const MAX_DEPTH: usize = 8_000;

/// So many lists of the greatest length may live at once.
const LIVE_LISTS: usize = 10;

impl Evaluator<'_> {
    /// Counts what is to be done. False where it is too much.
    pub(super) fn step(&mut self, cost: u64, span: Span) -> bool {
        self.steps += cost;
        if self.steps > self.limits.steps && !self.halted {
            self.halt(errors::too_many_steps(self.limits.steps, span));
        }
        self.halted |= self.is_stopped();
        !self.halted
    }

    /// Counts things that are made. False where they are too many.
    pub(super) fn count_things(&mut self, count: usize, span: Span) -> bool {
        self.things = self.things.saturating_add(count);
        if self.things > self.limits.things && !self.halted {
            self.halt(errors::too_many_things(self.limits.things, span));
        }
        !self.halted
    }

    /// Whether a list may have so many items, which are kept or follow a rule.
    pub(super) fn may_list(&mut self, count: f64, kept: bool, span: Span) -> bool {
        if count > self.limits.items as f64 {
            self.halt(errors::long_list(self.limits.items, span));
        } else if kept && self.live.get() + count as usize > LIVE_LISTS * self.limits.items {
            self.halt(errors::many_items(LIVE_LISTS * self.limits.items, span));
        }
        !self.halted
    }

    /// One level further in. False where it is one too many; else [`Evaluator::leave`] ends it.
    pub(super) fn enter(&mut self, span: Span) -> bool {
        if self.levels >= self.limits.levels && !self.halted {
            self.halt(errors::too_many_levels(self.limits.levels, span));
        }
        if self.halted {
            return false;
        }
        self.levels += 1;
        true
    }

    /// Ends a level.
    pub(super) fn leave(&mut self) {
        self.levels -= 1;
    }

    /// A limit was passed: says so, and does nothing more.
    pub(super) fn halt(&mut self, diagnostic: Diagnostic) -> Value {
        if !self.halted {
            self.halted = true;
            self.incomplete = true;
            self.report(diagnostic);
        }
        Value::Invalid
    }
}
