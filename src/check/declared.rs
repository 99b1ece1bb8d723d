//! Types as they are written, on params and functions.

use super::types::{Element, Kind, Making, Type, describe_wanted};
use super::{Checker, errors};
use crate::schema::{Category, FieldType};
use crate::syntax::ast::TypeName;
use crate::units::{self, Dim};

/// The type of a param, or of what a function takes or gives.
#[derive(Clone, Debug, PartialEq)]
pub enum Declared {
    /// Was reported.
    Invalid,
    /// What a field may want.
    Field(FieldType),
    /// A shape, group or part that is not drawn.
    Thing,
    /// A list.
    List(Box<Declared>),
}

const AREA: Dim = Dim { length: 2, ..units::NONE };

/// Every type by its written name.
pub const TYPES: &[(&str, Declared)] = &[
    ("number", Declared::Field(FieldType::Scalar(units::NONE))),
    ("int", Declared::Field(FieldType::Int)),
    ("bool", Declared::Field(FieldType::Bool)),
    ("text", Declared::Field(FieldType::Text)),
    ("color", Declared::Field(FieldType::Color)),
    ("texture", Declared::Field(FieldType::Paint)),
    ("material", Declared::Field(FieldType::Made(Category::Material))),
    ("thing", Declared::Thing),
    ("transform", Declared::Field(FieldType::Transform)),
    ("point", Declared::Field(FieldType::Tuple(3, units::LENGTH))),
    ("vector", Declared::Field(FieldType::Tuple(3, units::NONE))),
    ("length", Declared::Field(FieldType::Scalar(units::LENGTH))),
    ("angle", Declared::Field(FieldType::Scalar(units::ANGLE))),
    ("power", Declared::Field(FieldType::Scalar(units::POWER))),
    ("radiance", Declared::Field(FieldType::Scalar(units::RADIANCE))),
    ("temperature", Declared::Field(FieldType::Scalar(units::TEMPERATURE))),
    ("area", Declared::Field(FieldType::Scalar(AREA))),
];

impl Declared {
    /// The type of a value that was declared so.
    pub fn ty(&self) -> Type {
        match self {
            Declared::Invalid => Type::Invalid,
            Declared::Field(ty) => field_type(*ty).unwrap_or(Type::Invalid),
            Declared::Thing => Type::Made(Making::of(Kind::Thing)),
            Declared::List(item) => Type::list(item.ty()),
        }
    }

    /// What a param is declared as that takes values of a type.
    pub fn of(ty: &Type) -> Option<Declared> {
        match ty {
            Type::Scalar(Element::Int) => Some(Declared::Field(FieldType::Int)),
            Type::List(item) if **item != Type::Invalid => {
                Declared::of(item).map(|item| Declared::List(Box::new(item)))
            }
            ty => TYPES.iter().map(|(_, declared)| declared).find(|declared| declared.accepts(ty)).cloned(),
        }
    }

    /// Whether a value of a type can stand where this is declared.
    pub fn accepts(&self, ty: &Type) -> bool {
        match (self, ty) {
            (Declared::Invalid, _) | (_, Type::Invalid) => true,
            (Declared::Field(field), ty) => super::make::accepts(*field, ty),
            (Declared::Thing, Type::Made(making)) => making.kind.is_placed(),
            (Declared::List(item), Type::List(given)) => item.accepts(given),
            _ => false,
        }
    }

    /// As a message says it.
    pub fn describe(&self) -> String {
        match self {
            Declared::Invalid => "unknown".into(),
            Declared::Field(ty) => describe_wanted(*ty),
            Declared::Thing => "a thing".into(),
            Declared::List(_) => "a list".into(),
        }
    }

    /// As it is written.
    pub fn written(&self) -> String {
        match self {
            Declared::List(item) => format!("[{}]", item.written()),
            other => TYPES.iter().find(|(_, ty)| ty == other).map_or("?", |(name, _)| name).to_string(),
        }
    }
}

/// The type of what a field holds, where it is a value that can be computed with.
pub(super) fn field_type(ty: FieldType) -> Option<Type> {
    Some(match ty {
        FieldType::Scalar(dim) => Type::Scalar(Element::Quantity(dim)),
        FieldType::Int => Type::Scalar(Element::Int),
        FieldType::Bool => Type::Bool,
        FieldType::Text => Type::Text,
        FieldType::Color => Type::Color,
        FieldType::Paint => Type::Texture,
        FieldType::Tuple(count, dim) => Type::Tuple(count, Element::Quantity(dim)),
        FieldType::IntTuple(count) => Type::Tuple(count, Element::Int),
        FieldType::Transform => Type::Transform,
        FieldType::Made(Category::Material) => Type::Made(Making::of(Kind::Material)),
        _ => return None,
    })
}

impl Checker<'_> {
    /// Reads a type as written.
    pub(super) fn declared(&mut self, ty: &TypeName) -> Declared {
        match ty {
            TypeName::Invalid(_) => Declared::Invalid,
            TypeName::List(item, _) => match self.declared(item) {
                Declared::Invalid => Declared::Invalid,
                item => Declared::List(Box::new(item)),
            },
            TypeName::Named(name) => match TYPES.iter().find(|(known, _)| *known == name.text) {
                Some((_, declared)) => declared.clone(),
                None => {
                    self.report(errors::unknown_type(name));
                    Declared::Invalid
                }
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Declared, TYPES, Type};
    use crate::schema::{Category, FieldType, KINDS, PLACED};
    use crate::syntax::{GROUP_WORD, PART_WORDS, PLACED_WORDS, RANGED_WORDS, RESERVED, TYPE_WORDS};

    #[test]
    fn the_parser_knows_their_names() {
        assert!(TYPES.iter().map(|(name, _)| name).eq(TYPE_WORDS));
        let ranged = |ty: &Declared| matches!(ty.ty(), Type::Scalar(_));
        let ranged = TYPES.iter().filter(|(name, ty)| ranged(ty) && *name != "length").map(|(name, _)| name);
        assert!(ranged.eq(RANGED_WORDS));
        let placed = PLACED.iter().map(|field| &field.name).filter(|name| !RESERVED.contains(name));
        assert!(placed.eq(PLACED_WORDS));
        let groups = KINDS.iter().filter(|kind| kind.category == Category::Group).map(|kind| kind.name);
        assert!(groups.eq([GROUP_WORD]));
        let part = |whole, name, ty| match ty {
            FieldType::Part(part) => Some(([whole, name], part)),
            _ => None,
        };
        let parts: Vec<_> = KINDS
            .iter()
            .flat_map(|kind| kind.fields.iter().filter_map(|field| part(kind.name, field.name, field.ty)))
            .collect();
        assert!(parts.iter().map(|(words, _)| words).eq(PART_WORDS));
        assert!(parts.iter().all(|([_, field], part)| field == part), "{parts:?}");
    }
}
