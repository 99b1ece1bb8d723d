//! Names of the things and materials that a picture shows, by which its source knows them.

use crate::render::first::Firsts;
use crate::scene::{OriginId, PrimitiveId};
use crate::span::Span;
use crate::why::{MaterialAt, Provenance, ThingAt, Used};
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
        let primitives = &self.from.scene.primitives;
        let mut counts: BTreeMap<OriginId, [usize; 2]> = BTreeMap::new();
        for primitive in primitives.iter() {
            counts.entry(primitive.origin).or_default()[1] += 1;
        }
        let origin = |id: PrimitiveId| primitives[id.0 as usize].origin;
        let named = seen.iter().map(|id| (origin(*id), Named::of_thing(&self.from.thing_of(*id))));
        let paths = told_apart(named.collect());
        let mut names = NameOf::new();
        for (id, primitive) in (0..).map(PrimitiveId).zip(primitives.iter()) {
            let Some([before, all]) = counts.get_mut(&primitive.origin) else { continue };
            *before += 1;
            if seen.contains(&id) {
                let number = if *all > 1 { format!("#{before}") } else { String::new() };
                names.insert(id, paths[&primitive.origin].clone() + &number);
            }
        }
        names
    }

    /// The names of materials; what has none is called by its kind and place.
    pub(super) fn of_materials(&self, pixels: &[&Firsts]) -> NameOf {
        let seen = seen(pixels);
        let material = |id| (self.origin(id), Named::of_material(self.from.material(id)));
        let mut materials: BTreeMap<Origin, Named> = seen.iter().map(|id| material(*id)).collect();
        // They are told apart from those that are not seen too: a name must not change when another thing comes into view.
        let bare: BTreeSet<String> = materials.values().map(|named| named.bare.clone()).collect();
        materials
            .extend(self.of_each_material().map(material).filter(|(_, named)| bare.contains(&named.bare)));
        let names = told_apart(materials);
        seen.into_iter().map(|id| (id, names[&self.origin(id)].clone())).collect()
    }

    /// The hash of all that names are made of, whatever is seen: as long as it is the same, the same picture has the same names.
    pub(super) fn digest(&self) -> blake3::Hash {
        let mut hasher = blake3::Hasher::new();
        let mut add = |named: &Named| {
            for text in [&named.bare, &named.name(2)] {
                hasher.update(&(text.len() as u64).to_le_bytes());
                hasher.update(text.as_bytes());
            }
        };
        let mut last = None;
        for (id, primitive) in (0..).map(PrimitiveId).zip(self.from.scene.primitives.iter()) {
            // Those of one statement mostly follow one another.
            if last.replace(primitive.origin) != Some(primitive.origin) {
                add(&Named::of_thing(&self.from.thing_of(id)));
            }
        }
        for id in self.of_each_material() {
            add(&Named::of_material(self.from.material(id)));
        }
        hasher.finalize()
    }

    /// A primitive at least of each material in the scene.
    fn of_each_material(&self) -> impl Iterator<Item = PrimitiveId> {
        let marks = &self.from.marks.materials;
        let ends = marks.runs().skip(1).map(|(first, _)| first.0);
        let ends = ends.chain([self.from.scene.primitives.len() as u32]);
        let runs = marks.runs().zip(ends);
        // What nobody wrote may be of several kinds.
        runs.flat_map(|((PrimitiveId(first), place), end)| {
            first..if place.is_some() { first + 1 } else { end }
        })
        .map(PrimitiveId)
    }

    /// Where the material of a primitive was written, or what it is where nobody wrote it.
    fn origin(&self, id: PrimitiveId) -> Origin {
        match self.from.marks.materials.of(id) {
            Some((place, _)) => Origin::Written(place),
            None => Origin::Chosen(self.from.material(id).map_or(LAMP, |material| material.kind)),
        }
    }
}

/// What lamps are made of.
const LAMP: &str = "light";

/// What makes a material one, whichever things are made of it.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
enum Origin {
    Written(Span),
    Chosen(&'static str),
}

/// What something may be called, and where it stands, unless nobody wrote it.
struct Named<'a> {
    bare: String,
    place: Option<Used<'a>>,
}

impl<'a> Named<'a> {
    fn of_thing(thing: &ThingAt<'a>) -> Named<'a> {
        Named { bare: path(thing), place: thing.uses.last().cloned() }
    }

    fn of_material(material: Option<MaterialAt<'a>>) -> Named<'a> {
        let Some(MaterialAt { kind, name, place }) = material else {
            return Named { bare: LAMP.into(), place: None };
        };
        let bare = match (name, &place) {
            (Some(name), _) => name.into(),
            (None, Some(place)) => placed(kind, place),
            (None, None) => kind.into(),
        };
        Named { bare, place }
    }

    /// Its name with so much of its place: nothing, the file, or all.
    fn name(&self, detail: usize) -> String {
        match &self.place {
            Some(used) if detail == 1 => format!("{}:{}", used.place.file, self.bare),
            Some(used) if detail > 1 => placed(&format!("{}:{}", used.place.file, self.bare), used),
            _ => self.bare.clone(),
        }
    }
}

/// Gives what stands at different places different names, with no more of the place than it takes.
fn told_apart<K: Ord>(named: BTreeMap<K, Named>) -> BTreeMap<K, String> {
    let mut names: Vec<String> = named.values().map(|named| named.name(0)).collect();
    for detail in [1, 2] {
        let mut places: BTreeMap<&str, BTreeSet<Option<Span>>> = BTreeMap::new();
        for (name, named) in names.iter().zip(named.values()) {
            places.entry(name).or_default().insert(named.place.as_ref().map(|used| used.span));
        }
        let shared: Vec<bool> = names.iter().map(|name| places[name.as_str()].len() > 1).collect();
        for ((name, named), shared) in names.iter_mut().zip(named.values()).zip(shared) {
            if shared {
                *name = named.name(detail);
            }
        }
    }
    named.into_keys().zip(names).collect()
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
