//! Names of the things and materials that a picture shows, by which its source knows them.

use crate::render::first::Firsts;
use crate::scene::{OriginId, PrimitiveId};
use crate::why::{Provenance, ThingAt, Used};
use std::collections::{BTreeMap, BTreeSet};

/// The names of a scene's things.
pub(super) struct Names<'a> {
    from: Provenance<'a>,
}

/// The name of each primitive that is seen.
pub(super) type NameOf = BTreeMap<PrimitiveId, String>;

impl<'a> Names<'a> {
    pub(super) fn new(from: Provenance<'a>) -> Names<'a> {
        Names { from }
    }

    /// Paths such as `left.cushion`: what has no name is called by its kind and place, and of several that were made at one
    /// place each has its number.
    pub(super) fn of_objects(&self, pixels: &[&Firsts]) -> NameOf {
        let seen = seen(pixels);
        let mut counts: BTreeMap<OriginId, [usize; 2]> = BTreeMap::new();
        for primitive in self.from.scene.primitives.iter() {
            counts.entry(primitive.origin).or_default()[1] += 1;
        }
        let mut names = NameOf::new();
        for (id, primitive) in (0..).map(PrimitiveId).zip(self.from.scene.primitives.iter()) {
            let Some([before, all]) = counts.get_mut(&primitive.origin) else { continue };
            *before += 1;
            if seen.contains(&id) {
                let number = if *all > 1 { format!("#{before}") } else { String::new() };
                names.insert(id, path(&self.from.thing_of(id)) + &number);
            }
        }
        names
    }

    /// The names of materials; what has none is called by its kind and place.
    pub(super) fn of_materials(&self, pixels: &[&Firsts]) -> NameOf {
        let name = |id: PrimitiveId| match self.from.material(id) {
            None => "light".to_string(),
            Some(material) => match (material.name, material.place) {
                (Some(name), _) => name.to_string(),
                (None, Some(place)) => placed(material.kind, &place),
                (None, None) => material.kind.to_string(),
            },
        };
        seen(pixels).into_iter().map(|id| (id, name(id))).collect()
    }
}

fn seen(pixels: &[&Firsts]) -> BTreeSet<PrimitiveId> {
    pixels.iter().flat_map(|firsts| firsts.shown()).map(|(id, _)| id).collect()
}

fn path(thing: &ThingAt) -> String {
    let names: Vec<String> = thing.uses.iter().map(step).collect();
    if names.is_empty() { thing.kind.to_string() } else { names.join(".") }
}

/// A statement by its name, or by its kind and place.
fn step(used: &Used) -> String {
    let head = used.text.split('{').next().unwrap_or_default();
    let mut words = head.split_whitespace().filter(|word| !word.starts_with('@'));
    match (words.next(), words.next()) {
        (Some(keyword @ ("for" | "if")), _) => {
            placed(keyword, used) + &used.turn.map_or(String::new(), |turn| format!("[{turn}]"))
        }
        (Some(_), Some(name)) => name.to_string(),
        (kind, _) => placed(kind.unwrap_or_default(), used),
    }
}

fn placed(kind: &str, used: &Used) -> String {
    format!("{kind}:{}:{}", used.place.start.line, used.place.start.column)
}
