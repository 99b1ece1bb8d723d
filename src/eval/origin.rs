//! Where the things of a picture came from.

use super::built::NONE;
use crate::scene::OriginId;
use crate::span::Span;

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
