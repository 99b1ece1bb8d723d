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

/// Chains of uses, each a place and the use around it. All turns of a loop share one.
#[derive(Clone, Debug, Default)]
pub struct Origins {
    links: Vec<(Span, u32)>,
}

impl Origins {
    /// Takes links in, each with the index of the one around it.
    pub(super) fn new(links: Vec<(Span, u32)>) -> Origins {
        Origins { links }
    }

    /// The chain of places, outermost use first.
    pub fn chain(&self, id: OriginId) -> Vec<Span> {
        let mut chain = vec![];
        let mut next = id.0;
        while let Some((span, outer)) = self.links.get(next as usize).filter(|_| next != NONE) {
            chain.push(*span);
            next = *outer;
        }
        chain.reverse();
        chain
    }
}
