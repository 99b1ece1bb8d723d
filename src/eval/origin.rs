//! Where the things of a picture came from.

use crate::scene::OriginId;
use crate::span::Span;

/// Chains of uses, each a place and the use around it.
#[derive(Clone, Debug, Default)]
pub struct Origins {
    links: Vec<(Span, Option<OriginId>)>,
}

impl Origins {
    /// Adds a place that was reached by way of `outer`.
    pub(super) fn add(&mut self, span: Span, outer: Option<OriginId>) -> OriginId {
        self.links.push((span, outer));
        OriginId(self.links.len() as u32 - 1)
    }

    /// The chain of places, outermost use first.
    pub fn chain(&self, id: OriginId) -> Vec<Span> {
        let mut chain = vec![];
        let mut next = Some(id);
        while let Some((span, outer)) = next.and_then(|id| self.links.get(id.0 as usize)) {
            chain.push(*span);
            next = *outer;
        }
        chain.reverse();
        chain
    }
}
