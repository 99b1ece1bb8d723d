//! Values.

use super::built::{Built, Shift};
use super::frame::Frame;
use super::list::List;
use super::read::Read;
use super::texture::Texture;
use crate::check::{PartId, TableId, Written};
use crate::color::Rgb;
use crate::math::{DAffine3, DVec3};
use crate::scene::shape::Bounds;
use crate::schema::{Key, KindId, PLACED, Preset};
use crate::span::Span;
use smallvec::SmallVec;
use smol_str::SmolStr;
use std::rc::Rc;

/// The value of an expression, in base units. Its type was checked.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// Has an error that was reported.
    Invalid,
    /// A number or quantity; finite.
    Number(f64),
    /// Two (with z = 0) or three numbers; finite.
    Tuple(DVec3),
    /// `true` or `false`.
    Bool(bool),
    /// A text.
    Text(SmolStr),
    /// A linear colour; finite.
    Color(Rgb),
    /// A colour by place.
    Texture(Rc<Texture>),
    /// A word that the field understands.
    Word(&'static str),
    /// A placement.
    Transform(Rc<DAffine3>),
    /// A prototype, or a value written in place.
    Made(Rc<Made>),
    /// A part that is not drawn.
    Part(Rc<PartValue>),
    /// A thing that stands in the scene.
    Thing(Rc<Placed>),
    /// A list.
    List(Rc<List>),
    /// A box in space.
    Bounds(Rc<Bounds>),
    /// A row of a table.
    Row(TableId, u32),
}

/// Names one thing of the picture: an index among the places of [`super::Things`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct ThingId(pub u32);

/// A thing that is kept by itself: a prototype, or a value written in place.
#[derive(Clone, Debug, PartialEq)]
pub struct Made {
    pub(super) site: Rc<Site>,
    /// Of which row, if it was made of rows.
    pub(super) row: u32,
    /// The values of the fields that were given here, in the order of [`KindId::fields`].
    pub(super) values: SmallVec<[Value; 2]>,
}

/// What is the same for all things that are made at one place from one prototype.
#[derive(Debug, PartialEq)]
pub(super) struct Site {
    pub(super) kind: KindId,
    /// Which fields are given here, a bit each by index in [`KindId::fields`].
    pub(super) mask: u64,
    pub(super) written: Rc<Written>,
    /// What they are made from.
    pub(super) base: Option<Rc<Made>>,
    /// What a group holds.
    pub(super) group: Option<Rc<Group>>,
}

/// A thing with its fields, wherever these are kept.
#[derive(Clone, Copy, Debug)]
pub struct Fields<'t> {
    pub(super) site: &'t Rc<Site>,
    pub(super) row: u32,
    pub(super) values: &'t [Value],
}

/// The members of a group that is not drawn.
#[derive(Debug, PartialEq)]
pub(super) struct Group {
    /// What is drawn where the group is.
    pub(super) built: Built,
    /// Which of the buffers that were being filled it was.
    pub(super) level: usize,
    /// Whether a field of a thing means another of them, or one around.
    pub(super) aims: bool,
    /// The names inside, by slot.
    pub(super) inside: Inside,
}

/// The values of the names inside a thing, by slot; none where there are no names.
pub(super) type Inside = Option<Rc<[(u32, Value)]>>;

/// A part that is not drawn, with what it is given.
#[derive(Debug)]
pub struct PartValue {
    pub(super) part: PartId,
    /// Where the names around the part are.
    pub(super) around: Option<Rc<Frame>>,
    /// By param.
    pub(super) params: Vec<Option<Given>>,
    /// By index in [`PLACED`].
    pub(super) placed: [Option<Given>; PLACED.len()],
    /// Where it was written.
    pub(super) span: Span,
}

impl PartialEq for PartValue {
    fn eq(&self, other: &PartValue) -> bool {
        std::ptr::eq(self, other)
    }
}

/// A thing that stands in the scene, as its name knows it.
#[derive(Clone, Debug, PartialEq)]
pub struct Placed {
    /// Its place.
    pub(super) id: ThingId,
    /// In which of the buffers that are being filled.
    pub(super) level: usize,
    /// The group it stands in.
    pub(super) stands: u32,
    /// The group from which it is seen: where the path to it begins.
    pub(super) from: u32,
    /// Its fields.
    pub(super) made: Rc<Made>,
    /// The names inside it.
    pub(super) inside: Inside,
    /// How these have been moved since they were made.
    pub(super) shift: Shift,
}

/// The value of a field, and where it was written.
#[derive(Clone, Debug, PartialEq)]
pub struct Given {
    /// The value.
    pub value: Value,
    /// Its place.
    pub span: Span,
}

impl Made {
    /// A thing of a kind with nothing given.
    pub fn new(kind: KindId, span: Span) -> Made {
        let written = Rc::new(Written { name: None, defined: None, span, fields: [].into(), rows: None });
        let site = Rc::new(Site { kind, mask: 0, written, base: None, group: None });
        Made { site, row: 0, values: SmallVec::new() }
    }

    /// Its kind.
    pub fn kind(&self) -> KindId {
        self.site.kind
    }

    /// Where it was written.
    pub fn span(&self) -> Span {
        self.fields().span()
    }

    /// Its fields.
    pub fn fields(&self) -> Fields<'_> {
        Fields { site: &self.site, row: self.row, values: &self.values }
    }
}

impl<'t> Fields<'t> {
    /// The kind of the thing.
    pub fn kind(self) -> KindId {
        self.site.kind
    }

    /// Where it was written.
    pub fn span(self) -> Span {
        self.site.written.place(self.row, self.site.written.span)
    }

    /// The thing by itself.
    pub fn keep(self) -> Rc<Made> {
        Rc::new(Made { site: self.site.clone(), row: self.row, values: self.values.into() })
    }

    /// The field at an index of [`KindId::fields`] as given here or by the prototype.
    pub(super) fn find(self, index: usize) -> Option<(&'t Value, Span)> {
        let (made, rank) = self.giver(index)?;
        let written = &made.site.written;
        Some((&made.values[rank], written.place(made.row, written.fields[rank])))
    }

    /// Which of this thing and its prototypes gives the field at an index, as which of its values.
    fn giver(self, index: usize) -> Option<(Fields<'t>, usize)> {
        let mut made = self;
        while made.site.mask >> index & 1 == 0 {
            made = made.site.base.as_ref()?.fields();
        }
        Some((made, (made.site.mask & ((1 << index) - 1)).count_ones() as usize))
    }

    /// A field as given, without its place, which takes time to find.
    pub(super) fn read<T: Read>(self, key: Key<T>) -> Option<T::Out> {
        let (made, rank) = self.giver(key.index(self.kind()))?;
        T::read(&made.values[rank])
    }

    /// A field as given, with its place; none where it is not given, or has an error.
    pub fn given<T: Read>(self, key: Key<T>) -> Option<(T::Out, Span)> {
        let (value, span) = self.find(key.index(self.kind()))?;
        Some((T::read(value)?, span))
    }

    /// The name it was given where it stands.
    pub fn name(self) -> Option<&'t SmolStr> {
        self.site.written.name.as_ref()
    }

    /// The name by which it is known: its own, or that of its definition, or else that of the nearest prototype that has one.
    pub fn known_as(self) -> Option<&'t SmolStr> {
        let mut made = self;
        loop {
            let written = &made.site.written;
            match written.name.as_ref().or(written.defined.as_ref()) {
                Some(name) => return Some(name),
                None => made = made.site.base.as_ref()?.fields(),
            }
        }
    }

    /// Whether no field has an error, and none that must be given is missing.
    pub fn is_sound(self) -> bool {
        let mut given = 0;
        let mut made = Some(self);
        while let Some(here) = made {
            let mut index_bits = here.site.mask;
            for value in here.values {
                let bit = index_bits & index_bits.wrapping_neg();
                index_bits ^= bit;
                if given & bit == 0 && !value.is_sound() {
                    return false;
                }
            }
            given |= here.site.mask;
            made = here.site.base.as_ref().map(|base| base.fields());
        }
        let missing = |(index, field): (usize, &crate::schema::Field)| {
            field.default == Preset::Required && given >> index & 1 == 0
        };
        !self.kind().fields().enumerate().any(missing)
    }
}

impl Value {
    /// Whether neither it nor a field of it has an error.
    pub fn is_sound(&self) -> bool {
        match self {
            Value::Invalid => false,
            Value::Made(made) => made.fields().is_sound(),
            _ => true,
        }
    }
}
