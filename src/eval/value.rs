//! Values.

use super::read::Read;
use super::texture::Texture;
use crate::color::Rgb;
use crate::math::{DAffine3, DVec3};
use crate::schema::{Key, KindId, Preset};
use crate::span::Span;
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
    /// A thing that stands in the scene.
    Thing(ThingId),
}

/// Names one thing among those made in a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct ThingId(pub u32);

/// A thing with its fields, in the scene or not.
#[derive(Clone, Debug, PartialEq)]
pub struct Made {
    /// Its kind.
    pub kind: KindId,
    /// What was given, by index in [`KindId::fields`].
    pub fields: Box<[Option<Given>]>,
    /// What a group holds.
    pub(super) members: Rc<[Member]>,
    /// Where the prototype it was made from was written.
    pub(super) proto: Option<Span>,
    /// Where it was written.
    pub span: Span,
    /// How many levels of groups it holds.
    pub(super) levels: usize,
    /// How many things and groups it holds, those that are held by others included.
    pub(super) inside: usize,
}

/// The value of a field, and where it was written.
#[derive(Clone, Debug, PartialEq)]
pub struct Given {
    /// The value.
    pub value: Value,
    /// Its place.
    pub span: Span,
}

/// A thing that a group holds.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Member {
    pub(super) id: ThingId,
    pub(super) name: Option<SmolStr>,
    pub(super) made: Rc<Made>,
    pub(super) span: Span,
}

impl Made {
    /// A field as given, with its place; none where it is not given, or has an error.
    pub fn given<T: Read>(&self, key: Key<T>) -> Option<(T::Out, Span)> {
        let given = self.fields[key.index(self.kind)].as_ref()?;
        Some((T::read(&given.value)?, given.span))
    }

    /// Whether no field has an error, and none that must be given is missing.
    pub fn is_sound(&self) -> bool {
        self.kind.fields().zip(&self.fields).all(|(field, given)| match given {
            Some(given) => given.value.is_sound(),
            None => field.default != Preset::Required,
        })
    }
}

impl Value {
    /// Whether neither it nor a field of it has an error.
    pub fn is_sound(&self) -> bool {
        match self {
            Value::Invalid => false,
            Value::Made(made) => made.is_sound(),
            _ => true,
        }
    }
}
