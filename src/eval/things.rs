//! What evaluating gives: everything that stands in the picture.

use super::built::{Built, NONE, grain, material, placement};
use super::defaults::Defaults;
use super::{Fields, Given, Origins, Read, ThingId, Value};
use crate::math::DAffine3;
use crate::scene::OriginId;
use crate::schema::{Key, KindId};
use smol_str::SmolStr;
use std::ops::Range;

/// Everything that stands in the picture, groups taken apart, in the order written.
#[derive(Debug)]
pub struct Things {
    built: Built,
    /// By index.
    groups: Vec<Group>,
    /// Which are left out: `@off`, or not `@solo` where something is. None where nothing is.
    hidden: Option<Vec<bool>>,
    /// Where each came from.
    pub origins: Origins,
    /// The values of fields that are not given.
    defaults: Defaults,
    /// Whether something that was written is not among them, since it has an error.
    pub incomplete: bool,
}

/// What a group gives to its members.
#[derive(Clone, Debug, Default)]
struct Group {
    /// From its space to the world's.
    world_from_group: DAffine3,
    /// What they are made of by default.
    material: Option<Given>,
    /// From the space of their textures to the world's by default.
    world_from_grain: Option<DAffine3>,
}

/// One thing of the picture: a shape, a light or a block.
#[derive(Clone, Debug)]
pub struct Thing<'t> {
    /// Its kind and fields.
    pub made: Fields<'t>,
    /// Where it stands: its own placement and that of the groups around it.
    pub world_from_object: DAffine3,
    /// Where the space of its texture lies, if not where its own does.
    pub world_from_grain: Option<DAffine3>,
    /// Its material, or else that of the innermost group that has one.
    pub material: Option<Given>,
    /// Where it came from.
    pub origin: OriginId,
    /// Whether it is left out. It is checked, and others may aim at it, all the same.
    pub hidden: bool,
}

impl Things {
    /// Takes in what was built.
    pub(super) fn new(mut built: Built, incomplete: bool) -> Things {
        let mut groups: Vec<Group> = Vec::with_capacity(built.groups.len());
        for group in &built.groups {
            let around = match group.parent {
                NONE => Group::default(),
                parent => groups[parent as usize].clone(),
            };
            let world_from_group = around.world_from_group * group.placement;
            groups.push(Group {
                world_from_group,
                material: group.material.clone().or(around.material),
                world_from_grain: group
                    .grain
                    .map(|grain| world_from_group * grain)
                    .or(around.world_from_grain),
            });
        }
        let hidden = hidden(&built);
        let origins = Origins::new(std::mem::take(&mut built.links), std::mem::take(&mut built.turns));
        Things { built, groups, hidden, origins, defaults: Defaults::default(), incomplete }
    }

    /// How many there are, those that are left out among them.
    pub fn len(&self) -> usize {
        self.built.things.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.built.things.is_empty()
    }

    /// Each in turn.
    pub fn iter(&self) -> impl Iterator<Item = Thing<'_>> {
        (0..self.len()).map(|index| self.get(index))
    }

    /// Those of the kinds that are wanted, each with its index.
    pub fn of(&self, wanted: impl Fn(KindId) -> bool) -> impl Iterator<Item = (usize, Thing<'_>)> {
        let stored = self.built.things.iter().enumerate();
        stored
            .filter(move |(_, stored)| wanted(self.built.kind(stored)))
            .map(|(index, _)| (index, self.get(index)))
    }

    /// The thing at an index.
    pub fn get(&self, index: usize) -> Thing<'_> {
        let stored = &self.built.things[index];
        let around = &self.groups[stored.group as usize];
        let made = self.built.fields(stored);
        let grain = grain(made).map(|grain| around.world_from_group * grain);
        Thing {
            world_from_object: around.world_from_group * placement(made),
            world_from_grain: grain.or(around.world_from_grain),
            material: material(made).or_else(|| around.material.clone()),
            made,
            origin: OriginId(stored.link),
            hidden: self.hidden.as_ref().is_some_and(|hidden| hidden[index]),
        }
    }

    /// The kinds of all things that are not left out.
    pub fn kinds(&self) -> impl Iterator<Item = KindId> {
        let shown = |index: &usize| !self.hidden.as_ref().is_some_and(|hidden| hidden[*index]);
        (0..self.len()).filter(shown).map(|index| self.built.kind(&self.built.things[index]))
    }

    /// Which things one that was named has become.
    pub fn place(&self, id: ThingId) -> Option<Range<usize>> {
        self.built.places.get(id.0 as usize).map(|range| range.start as usize..range.end as usize)
    }

    /// A field of a thing: as given, or else its default.
    pub fn read<T: Read>(&self, made: Fields, key: Key<T>) -> T::Out {
        match made.read(key) {
            Some(value) => value,
            None => self.defaults.read(made.kind(), key),
        }
    }

    /// The default of a field by its index.
    pub(super) fn default(&self, kind: KindId, index: usize) -> Value {
        self.defaults.value(kind, index)
    }
}

impl<'t> Thing<'t> {
    /// The name it was given.
    pub fn name(&self) -> Option<&'t SmolStr> {
        self.made.name()
    }
}

/// Which things are left out. Where something is alone, cameras and other blocks stay.
fn hidden(built: &Built) -> Option<Vec<bool>> {
    if built.off.is_empty() && built.solo.is_empty() {
        return None;
    }
    use crate::schema::Category;
    let block = |index: usize| built.kind(&built.things[index]).get().category == Category::Block;
    let mut hidden: Vec<bool> =
        (0..built.things.len()).map(|index| !built.solo.is_empty() && !block(index)).collect();
    let range = |id: &ThingId| {
        let range = &built.places[id.0 as usize];
        range.start as usize..range.end as usize
    };
    built.solo.iter().for_each(|id| hidden[range(id)].fill(false));
    built.off.iter().for_each(|id| hidden[range(id)].fill(true));
    Some(hidden)
}
