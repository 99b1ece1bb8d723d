//! Things as they are put into the picture: flat, each with the group it stands in and where it came from.

use super::draw::Fresh;
use super::origin::Turns;
use super::value::{Fields, Given, Group, Made, Placed, Site, ThingId, Value};
use crate::math::DAffine3;
use crate::schema::{Category, KindId, placed};
use crate::span::Span;
use std::ops::Range;
use std::rc::Rc;

/// No link, no group: what is outermost.
pub(super) const NONE: u32 = u32::MAX;

/// What a scene, or a group that is not drawn, holds. The group 0 is the scene or group itself.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Built {
    /// In the order written.
    pub(super) things: Vec<Stored>,
    /// Where things were made.
    sites: Vec<Rc<Site>>,
    /// The values of their fields.
    pub(super) values: Vec<Value>,
    /// The last groups that were copied, each with where its sites and its values begin here: another copy shares
    /// them.
    copies: Vec<(Rc<Group>, [u32; 2])>,
    /// Groups, each behind the one it stands in.
    pub(super) groups: Vec<GroupPlace>,
    /// Which things something that was named has become.
    pub(super) places: Vec<Range<u32>>,
    /// Places that are left out.
    pub(super) off: Vec<ThingId>,
    /// Places beside which all others are left out.
    pub(super) solo: Vec<ThingId>,
    /// Chains of uses: a place, and the link of the use around it.
    pub(super) links: Vec<(Span, u32)>,
    /// Which of these are turns of a loop.
    pub(super) turns: Turns,
}

/// One thing. There are many: what they share is kept once, and their values one behind the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stored {
    /// Its kind, and what is the same for all that were made there: an index into [`Built::sites`].
    site: u32,
    /// Where its values begin in [`Built::values`].
    values: u32,
    /// Of which row, if it was made of rows.
    row: u32,
    /// The group it stands in.
    pub(super) group: u32,
    /// Where it came from.
    pub(super) link: u32,
}

/// Where a group stands.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct GroupPlace {
    /// In which group.
    pub(super) parent: u32,
    /// Where in that.
    pub(super) placement: DAffine3,
    /// What members are made of that name no material.
    pub(super) material: Option<Given>,
    /// Where in it the textures of members lie that do not say.
    pub(super) grain: Option<DAffine3>,
}

/// By how much the indices of what was copied from one [`Built`] to another have grown.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Shift {
    pub(super) places: u32,
    pub(super) groups: u32,
}

/// How many of the last links, sites and copies are looked through for the one that is needed: a loop's body seldom has more
/// statements.
const RECENT: usize = 8;

impl Built {
    /// Nothing, in the group 0.
    pub(super) fn new() -> Built {
        let mut built = Built::default();
        built.begin_group(NONE);
        built
    }

    /// Adds a group that stands where its parent does, until its fields are known.
    pub(super) fn begin_group(&mut self, parent: u32) -> u32 {
        let placement = DAffine3::IDENTITY;
        self.groups.push(GroupPlace { parent, placement, material: None, grain: None });
        self.groups.len() as u32 - 1
    }

    /// Says where a group stands, and what it is made of.
    pub(super) fn place_group(&mut self, group: u32, made: Fields) {
        let place = &mut self.groups[group as usize];
        place.placement = placement(made);
        place.material = material(made);
        place.grain = grain(made);
    }

    /// Adds a thing to a group.
    pub(super) fn put(&mut self, fresh: Fresh, group: u32, link: u32) {
        let site = self.site(&fresh);
        self.things.push(Stored { site, values: fresh.values, row: fresh.row, group, link });
    }

    /// Where a thing was made; the same again where that was so just now, as in a loop.
    fn site(&mut self, fresh: &Fresh) -> u32 {
        let from = self.sites.len().saturating_sub(RECENT);
        let known = self.sites[from..].iter().rposition(|site| fresh.is_of(site));
        if let Some(known) = known {
            return (from + known) as u32;
        }
        self.sites.push(fresh.site());
        self.sites.len() as u32 - 1
    }

    /// Adds what was made already.
    pub(super) fn put_again(&mut self, made: &Made, group: u32, link: u32) {
        let (site, values) = (self.sites.len() as u32, self.values.len() as u32);
        self.sites.push(made.site.clone());
        self.values.extend_from_slice(&made.values);
        self.things.push(Stored { site, values, row: made.row, group, link });
    }

    /// A thing with its fields.
    pub(super) fn fields(&self, stored: &Stored) -> Fields<'_> {
        let site = &self.sites[stored.site as usize];
        let first = stored.values as usize;
        let values = &self.values[first..first + site.mask.count_ones() as usize];
        Fields { site, row: stored.row, values }
    }

    /// The newest thing by itself.
    pub(super) fn last(&self) -> Rc<Made> {
        let newest = self.things.last().expect("a thing was just put there");
        self.fields(newest).keep()
    }

    /// The kind of a thing.
    pub(super) fn kind(&self, stored: &Stored) -> KindId {
        self.sites[stored.site as usize].kind
    }

    /// A link of the chain of uses; the same again where it was added just now, as in a loop.
    pub(super) fn link(&mut self, span: Span, outer: u32) -> u32 {
        let from = self.links.len().saturating_sub(RECENT);
        let known = self.links[from..].iter().rposition(|link| *link == (span, outer));
        if let Some(known) = known {
            return (from + known) as u32;
        }
        self.links.push((span, outer));
        self.links.len() as u32 - 1
    }

    /// A link of one turn of a loop, whose own link is given.
    pub(super) fn turn(&mut self, span: Span, repeat: u32, which: String) -> u32 {
        self.links.push((span, repeat));
        let link = self.links.len() as u32 - 1;
        self.turns.push((link, which.into()));
        link
    }

    /// Names the things from `first` on.
    pub(super) fn place(&mut self, first: u32) -> ThingId {
        self.places.push(first..self.things.len() as u32);
        ThingId(self.places.len() as u32 - 1)
    }

    /// Copies what a group holds into one of this, which is at a level, as used by way of a link.
    pub(super) fn append(&mut self, held: &Rc<Group>, parent: u32, link: u32, level: usize) -> Shift {
        let other = &held.built;
        let shift = Shift { places: self.places.len() as u32, groups: self.groups.len() as u32 };
        let (first, first_link) = (self.things.len() as u32, self.links.len() as u32);
        self.groups.extend(other.groups.iter().map(|group| {
            let parent = if group.parent == NONE { parent } else { group.parent + shift.groups };
            GroupPlace { parent, ..group.clone() }
        }));
        self.places.extend(other.places.iter().map(|place| place.start + first..place.end + first));
        self.off.extend(other.off.iter().map(|id| ThingId(id.0 + shift.places)));
        self.solo.extend(other.solo.iter().map(|id| ThingId(id.0 + shift.places)));
        self.links.extend(
            other
                .links
                .iter()
                .map(|&(span, outer)| (span, if outer == NONE { link } else { outer + first_link })),
        );
        let [first_site, first_value] = self.copy_values(held, shift, level);
        self.things.extend(other.things.iter().map(|thing| Stored {
            site: thing.site + first_site,
            values: thing.values + first_value,
            row: thing.row,
            group: thing.group + shift.groups,
            link: if thing.link == NONE { link } else { thing.link + first_link },
        }));
        shift
    }

    /// Copies where the things of a group were made, and the values of their fields. Gives where they begin here.
    fn copy_values(&mut self, held: &Rc<Group>, shift: Shift, level: usize) -> [u32; 2] {
        if let Some((_, firsts)) = self.copies.iter().find(|(copied, _)| Rc::ptr_eq(copied, held)) {
            return *firsts;
        }
        let firsts = [self.sites.len() as u32, self.values.len() as u32];
        let levels = [held.level, level];
        self.sites.extend_from_slice(&held.built.sites);
        self.values.extend(held.built.values.iter().map(|value| aim_again(value, shift, levels)));
        // What aims does so at things of its own copy.
        if !held.aims {
            if self.copies.len() == RECENT {
                self.copies.remove(0);
            }
            self.copies.push((held.clone(), firsts));
        }
        firsts
    }

    /// Brings runs of things, each with the index of its statement, into the order written. `places` is the first
    /// that may lie among them.
    pub(super) fn reorder(&mut self, mut runs: Vec<(u32, Range<u32>)>, places: usize) {
        runs.retain(|(_, run)| !run.is_empty());
        let Some(first) = runs.first().map(|(_, run)| run.start) else { return };
        runs.sort_by_key(|(statement, _)| *statement);
        let segment = self.things.split_off(first as usize);
        // Where each run began, and where it begins now.
        let mut moves: Vec<(u32, u32)> = vec![];
        for (_, run) in &runs {
            moves.push((run.start, self.things.len() as u32));
            self.things.extend_from_slice(&segment[(run.start - first) as usize..(run.end - first) as usize]);
        }
        moves.sort_unstable();
        for place in self.places[places..].iter_mut().filter(|place| place.start < place.end) {
            let run = moves.partition_point(|(start, _)| *start <= place.start);
            if let Some((start, moved)) = run.checked_sub(1).map(|run| moves[run]) {
                *place = place.start - start + moved..place.end - start + moved;
            }
        }
    }

    /// From the space of a group to that of one around it.
    pub(super) fn carries(&self, mut group: u32, from: u32) -> DAffine3 {
        let mut carried = DAffine3::IDENTITY;
        while group != from && group != NONE {
            let place = &self.groups[group as usize];
            carried = place.placement * carried;
            group = place.parent;
        }
        carried
    }
}

/// The placement that a thing's own fields give: `place`, then `at`.
pub(super) fn placement(made: Fields) -> DAffine3 {
    if !matches!(made.kind().get().category, Category::Shape | Category::Group) {
        return DAffine3::IDENTITY;
    }
    let place = made.read(placed::PLACE).unwrap_or(DAffine3::IDENTITY);
    match made.read(placed::AT) {
        Some(at) => DAffine3::from_translation(at) * place,
        None => place,
    }
}

/// Where the space of textures lies that a thing's own field gives.
pub(super) fn grain(made: Fields) -> Option<DAffine3> {
    if !matches!(made.kind().get().category, Category::Shape | Category::Group) {
        return None;
    }
    made.given(placed::GRAIN).map(|(grain, _)| grain)
}

/// The material that a thing's own field gives.
pub(super) fn material(made: Fields) -> Option<Given> {
    if !matches!(made.kind().get().category, Category::Shape | Category::Group) {
        return None;
    }
    let (value, span) = made.find(placed::MATERIAL.index(made.kind()))?;
    Some(Given { value: value.clone(), span })
}

/// A value that means what was copied with it.
fn aim_again(value: &Value, shift: Shift, [from, to]: [usize; 2]) -> Value {
    match value {
        Value::Thing(placed) if placed.level == from => Value::Thing(Rc::new(moved(placed, shift, to))),
        value => value.clone(),
    }
}

/// A thing as it is after it was copied.
pub(super) fn moved(placed: &Placed, shift: Shift, level: usize) -> Placed {
    Placed {
        id: ThingId(placed.id.0 + shift.places),
        level,
        stands: placed.stands + shift.groups,
        from: placed.from + shift.groups,
        shift: Shift {
            places: placed.shift.places + shift.places,
            groups: placed.shift.groups + shift.groups,
        },
        ..placed.clone()
    }
}
