//! Where the things of a picture came from.

use super::built::NONE;
use super::{Value, errors};
use crate::check::Variable;
use crate::diagnostic::Use;
use crate::scene::OriginId;
use crate::span::Span;
use std::sync::Arc;

/// A use on the way to what is being evaluated.
#[derive(Clone)]
pub(super) struct Way {
    pub(super) span: Span,
    /// Of a loop, its variable with its value in this turn.
    pub(super) turn: Option<(Arc<Variable>, Value)>,
}

impl From<Span> for Way {
    fn from(span: Span) -> Way {
        Way { span, turn: None }
    }
}

impl Way {
    /// As a message has it.
    pub(super) fn shown(&self) -> Use {
        let turn = self.turn.as_ref().and_then(|(variable, value)| errors::turn(variable, value));
        Use { span: self.span, turn }
    }
}

/// Chains of uses, each a place and the use around it. The first turns of loops in the picture have one each; the others of a
/// loop share one.
#[derive(Clone, Debug, Default)]
pub struct Origins {
    links: Vec<(Span, u32)>,
    turns: Turns,
}

/// The links that are turns of loops, in order, each with which one it is: `i = 2`. What is around them is the loop itself.
pub(super) type Turns = Vec<(u32, Box<str>)>;

impl Origins {
    /// Takes links in, each with the index of the one around it.
    pub(super) fn new(links: Vec<(Span, u32)>, turns: Turns) -> Origins {
        Origins { links, turns }
    }

    /// The chain of places, outermost use first.
    pub fn chain(&self, id: OriginId) -> Vec<Span> {
        self.uses(id).into_iter().map(|(span, _)| span).collect()
    }

    /// The same with the turns of loops where they are known.
    pub fn uses(&self, id: OriginId) -> Vec<(Span, Option<&str>)> {
        let mut chain = vec![];
        let mut next = id.0;
        while let Some((span, outer)) = self.link(next) {
            let turn = self.turn(next);
            chain.push((span, turn));
            next = match turn {
                Some(_) => self.link(outer).map_or(NONE, |(_, around)| around),
                None => outer,
            };
        }
        chain.reverse();
        chain
    }

    fn link(&self, index: u32) -> Option<(Span, u32)> {
        self.links.get(index as usize).copied().filter(|_| index != NONE)
    }

    fn turn(&self, link: u32) -> Option<&str> {
        let found = self.turns.binary_search_by_key(&link, |(turn, _)| *turn).ok()?;
        Some(&self.turns[found].1)
    }
}
