//! Where parts of a scene were written.

use crate::eval::{Given, Value};
use crate::scene::{OriginId, PrimitiveId};
use crate::span::Span;
use std::collections::BTreeMap;

/// Where those parts of a scene came from that are no primitives. What was chosen for the user has no place.
#[derive(Clone, Debug, Default)]
pub struct Marks {
    /// The camera's block.
    pub camera: Option<Span>,
    /// Where it stands: its `from`.
    pub from: Option<Span>,
    /// What it looks at: its `look`.
    pub look: Option<Span>,
    /// The lens, or what it is focused on.
    pub focus: Option<Span>,
    /// How many samples a pixel has.
    pub samples: Option<Span>,
    /// By the index of a light in the scene.
    pub lights: Vec<Option<OriginId>>,
    /// What primitives are made of.
    pub materials: MaterialMarks,
}

/// Where the materials of primitives were written. Neighbours mostly share one, and are kept as one run.
#[derive(Clone, Debug, Default)]
pub struct MaterialMarks {
    /// The first primitive of each run, with the place.
    runs: Vec<(u32, Option<Span>)>,
    /// The names of those that have one.
    names: BTreeMap<Span, String>,
}

impl MaterialMarks {
    /// Notes what the next primitive is given.
    pub(super) fn note(&mut self, primitive: usize, given: Option<&Given>) {
        let made = match given.map(|given| &given.value) {
            Some(Value::Made(made)) => Some(made.fields()),
            _ => None,
        };
        let span = made.map(|made| made.span());
        if self.runs.last().is_some_and(|(_, last)| *last == span) {
            return;
        }
        self.runs.push((primitive as u32, span));
        if let (Some(span), Some(name)) = (span, made.and_then(|made| made.known_as())) {
            self.names.entry(span).or_insert_with(|| name.to_string());
        }
    }

    /// Runs of primitives whose materials were written at one place, by the first of each, with the place.
    pub fn runs(&self) -> impl Iterator<Item = (PrimitiveId, Option<Span>)> {
        self.runs.iter().map(|(first, span)| (PrimitiveId(*first), *span))
    }

    /// Where the material of a primitive was written, and the name that it, or what it was made from, was given there; none
    /// where nobody wrote it.
    pub fn of(&self, primitive: PrimitiveId) -> Option<(Span, Option<&str>)> {
        let behind = self.runs.partition_point(|(first, _)| *first <= primitive.0);
        let span = self.runs[..behind].last()?.1?;
        Some((span, self.names.get(&span).map(String::as_str)))
    }
}
