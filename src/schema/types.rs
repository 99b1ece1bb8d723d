//! What the table of kinds is made of.

use super::KindId;
use crate::units::Dim;
use std::marker::PhantomData;

/// What a kind is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Category {
    /// A surface of the picture; takes the fields of [`super::PLACED`].
    Shape,
    /// What a surface is made of.
    Material,
    /// A source of light that is no shape.
    Light,
    /// Holds other things.
    Group,
    /// Says how the picture is taken.
    Block,
}

/// A kind of thing: what may stand before `{`.
#[derive(Debug)]
pub struct Kind {
    /// As written.
    pub name: &'static str,
    /// What it is for.
    pub category: Category,
    /// One or more sentences.
    pub doc: &'static str,
    /// Fields of its own, in the order of the reference.
    pub fields: &'static [Field],
    /// What must hold between the fields.
    pub rules: &'static [Rule],
}

/// One field of a kind.
#[derive(Debug)]
pub struct Field {
    /// As written.
    pub name: &'static str,
    /// What its value must be.
    pub ty: FieldType,
    /// What holds when it is not given.
    pub default: Preset,
    /// What its value must lie in, in base units; a tuple's components each.
    pub range: Range,
    /// One or more sentences.
    pub doc: &'static str,
}

/// What a field's value must be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FieldType {
    /// A quantity of this dimension; a number where there is none.
    Scalar(Dim),
    /// A whole number.
    Int,
    /// `true` or `false`.
    Bool,
    /// A linear colour.
    Color,
    /// A linear colour, or a texture.
    Paint,
    /// A text.
    Text,
    /// So many quantities of one dimension.
    Tuple(usize, Dim),
    /// So many whole numbers.
    IntTuple(usize),
    /// A placement.
    Transform,
    /// A value whose kind is of this category.
    Made(Category),
    /// A value of this kind, which may also be written as a statement inside.
    Part(&'static str),
    /// A thing that stands in the scene and has bounds.
    Target,
    /// The name of a thing of this kind in the scene.
    Named(&'static str),
    /// One of these words.
    Choice(&'static [Word]),
    /// Any of these.
    OneOf(&'static [FieldType]),
}

/// A bare word that a field understands.
#[derive(Debug, PartialEq)]
pub struct Word {
    /// As written.
    pub name: &'static str,
    /// What it means.
    pub doc: &'static str,
}

/// What holds when a field is not given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Preset {
    /// It must be given.
    Required,
    /// It may be absent; the words say what then happens.
    Absent(&'static str),
    /// This expression of the language.
    Value(&'static str),
}

/// An interval of numbers in base units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Least value.
    pub low: f64,
    /// Greatest value.
    pub high: f64,
    /// Whether `low` itself is refused.
    pub above: bool,
}

impl Range {
    /// Whether it allows every value.
    #[inline]
    pub fn is_any(self) -> bool {
        self.low == f64::NEG_INFINITY && self.high == f64::INFINITY
    }

    /// Whether a value is allowed.
    #[inline]
    pub fn contains(self, value: f64) -> bool {
        (if self.above { value > self.low } else { value >= self.low }) && value <= self.high
    }
}

/// What must hold between the fields of a kind.
#[derive(Debug)]
pub enum Rule {
    /// Exactly one of them is given.
    ExactlyOne(&'static [&'static str]),
    /// The one excludes each of the others.
    Excludes(&'static str, &'static [&'static str]),
    /// All are given, or none is.
    Together(&'static [&'static str]),
    /// The one is given only beside the other.
    Needs(&'static str, &'static str),
}

impl Rule {
    /// Whether a field is refused beside others that are given.
    pub fn excludes(&self, name: &str, given: impl Fn(&str) -> bool) -> bool {
        let beside = |names: &[&str]| names.iter().any(|other| *other != name && given(other));
        match self {
            Rule::ExactlyOne(names) => names.contains(&name) && beside(names),
            Rule::Excludes(one, others) => {
                *one == name && beside(others) || others.contains(&name) && given(one)
            }
            Rule::Together(_) | Rule::Needs(..) => false,
        }
    }
}

/// Finds a field's place in a kind, and says by its type how to read the value.
pub struct Key<T> {
    pub(super) place: Place,
    pub(super) ty: PhantomData<T>,
}

impl<T> Clone for Key<T> {
    fn clone(&self) -> Key<T> {
        *self
    }
}

impl<T> Copy for Key<T> {}

#[derive(Clone, Copy)]
pub(super) enum Place {
    Own(usize),
    Common(usize),
}

impl<T> Key<T> {
    /// The index in [`KindId::fields`] of a kind that has the field.
    pub fn index(&self, kind: KindId) -> usize {
        match self.place {
            Place::Own(index) => index,
            Place::Common(index) => kind.get().fields.len() + index,
        }
    }
}

/// A type of fields, known when this is compiled.
pub trait Typed {
    /// The same as a value.
    const TYPE: FieldType;
}
