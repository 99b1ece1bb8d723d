//! What checking learns of the names of a text, for who asks later: editors. A plain compilation keeps none of it.

use super::types::{FieldSet, Kind, Type};
use super::{Checker, Function};
use crate::schema::{FieldType, KindId, Word};
use crate::span::Span;
use smol_str::SmolStr;

/// What was learnt of the names of all files. Of rows it tells what stands in the first of each shape.
#[derive(Debug, Default)]
pub struct Notes {
    /// Names that are used, each with what it means there: by place, each place once.
    pub uses: Vec<(Span, Meaning)>,
    /// Names where they are declared, each with what it is: by place, each place once.
    pub declared: Vec<(Span, Type)>,
    /// Expressions with their types: by place.
    pub types: Vec<(Span, Type)>,
    /// What can be named where, each scope behind those inside it.
    pub scopes: Vec<Visible>,
    /// Bodies of things whose kind is known.
    pub bodies: Vec<Filled>,
}

/// What a name means where it is used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Meaning {
    /// What is declared by the name at this place.
    Declared(Span),
    /// A built-in kind.
    Kind(KindId),
    /// A field of a kind, by its index in [`KindId::fields`].
    Field(KindId, usize),
    /// A field that everything placed has, by its index in [`crate::schema::PLACED`].
    Placed(usize),
    /// A built-in function.
    Function(Function),
    /// A built-in colour, by its index in [`crate::color::NAMED`].
    Color(usize),
    /// A word that the field understands.
    Word(&'static Word),
    /// A component of a triple, a corner of bounds, or a column of a row.
    Component,
}

/// What a scope declares.
#[derive(Debug)]
pub struct Visible {
    /// The text in which it can be named.
    pub span: Span,
    /// What it belongs to.
    pub place: Home,
    /// The names, each with the place of its declaration and what it is.
    pub names: Vec<(SmolStr, Span, Type)>,
}

/// What a scope belongs to, as far as it says which statements it may hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Home {
    /// A file.
    File,
    /// A part.
    Part,
    /// A group.
    Group,
    /// A branch of `for` or `if`.
    Branch,
    /// A thing that holds no others.
    Thing,
    /// A function, or the head of a loop.
    Head,
}

/// The body of a thing.
#[derive(Debug)]
pub struct Filled {
    /// With its braces.
    pub span: Span,
    /// What the thing is.
    pub kind: Kind,
    /// What its prototype gives.
    pub given: FieldSet,
}

impl Notes {
    /// Puts everything in order.
    pub(super) fn finish(mut self) -> Notes {
        self.uses.sort_by_key(|(span, _)| *span);
        self.uses.dedup_by_key(|(span, _)| *span);
        self.declared.sort_by_key(|(span, _)| *span);
        self.declared.dedup_by_key(|(span, _)| *span);
        self.types.sort_by_key(|(span, _)| *span);
        self
    }

    /// What the name at a place means, if it is used there.
    pub fn meaning(&self, place: Span) -> Option<Meaning> {
        let index = self.uses.binary_search_by_key(&place, |(span, _)| *span).ok()?;
        Some(self.uses[index].1)
    }

    /// What the name that is declared at a place is.
    pub fn declared(&self, place: Span) -> Option<&Type> {
        let index = self.declared.binary_search_by_key(&place, |(span, _)| *span).ok()?;
        Some(&self.declared[index].1)
    }

    /// The type of the expression at a place, if one stands there.
    pub fn type_of(&self, place: Span) -> Option<&Type> {
        let behind = self.types.partition_point(|(span, _)| *span <= place);
        self.types[..behind].last().filter(|(span, _)| *span == place).map(|(_, ty)| ty)
    }
}

impl Checker<'_> {
    /// Notes what a name means where it is used.
    pub(super) fn note(&mut self, place: Span, meaning: Option<Meaning>) {
        if let (Some(notes), Some(meaning)) = (&mut self.notes, meaning) {
            notes.uses.push((place, meaning));
        }
    }

    /// Notes the type of an expression.
    pub(super) fn note_type(&mut self, place: Span, ty: &Type) {
        if let Some(notes) = &mut self.notes {
            notes.types.push((place, ty.clone()));
        }
    }

    /// Notes the body of a thing.
    pub(super) fn note_body(&mut self, span: Span, kind: Kind, given: FieldSet) {
        if let Some(notes) = &mut self.notes {
            notes.bodies.push(Filled { span, kind, given });
        }
    }
}

/// The word of this name that a field understands.
pub(super) fn word_of(ty: FieldType, name: &str) -> Option<&'static Word> {
    match ty {
        FieldType::Choice(words) => words.iter().find(|word| word.name == name),
        FieldType::OneOf(types) => types.iter().find_map(|ty| word_of(*ty, name)),
        _ => None,
    }
}

/// The built-in colour of a name.
pub(super) fn color_of(name: &str) -> Option<Meaning> {
    crate::color::NAMED.iter().position(|(known, _)| *known == name).map(Meaning::Color)
}
