//! The fields of what may stand before `{`: of built-in kinds, of parts, and of what may be any of them.

use super::Checker;
use super::program::FieldPlace;
use super::types::Kind;
use crate::schema::PLACED;

impl Checker<'_> {
    /// The field of a kind with this name.
    pub(super) fn find_field(&self, kind: Kind, name: &str) -> Option<FieldPlace> {
        let placed = || PLACED.iter().position(|field| field.name == name).map(FieldPlace::Placed);
        match kind {
            Kind::BuiltIn(kind) => kind.field_index(name).map(FieldPlace::Index),
            Kind::Part(part) => {
                let params = &self.program.part(part).params;
                params.iter().position(|param| param.name == name).map(FieldPlace::Param).or_else(placed)
            }
            Kind::Thing => placed(),
            Kind::Material => None,
        }
    }

    /// What a thing of the kind is called in a message.
    pub(super) fn kind_name(&self, kind: Kind) -> String {
        match kind {
            Kind::BuiltIn(kind) => kind.get().name.into(),
            Kind::Part(part) if self.program.part(part).name.is_empty() => "the imported file".into(),
            Kind::Part(part) => self.program.part(part).name.to_string(),
            Kind::Material => "material".into(),
            Kind::Thing => "thing".into(),
        }
    }

    /// The names of all fields of a kind.
    pub(super) fn field_names(&self, kind: Kind) -> Vec<String> {
        let placed = PLACED.iter().map(|field| field.name.to_string());
        match kind {
            Kind::BuiltIn(kind) => kind.fields().map(|field| field.name.to_string()).collect(),
            Kind::Part(part) => {
                let params = self.program.part(part).params.iter();
                params.map(|param| param.name.to_string()).chain(placed).collect()
            }
            Kind::Thing => placed.collect(),
            Kind::Material => vec![],
        }
    }

    /// How many fields a kind has.
    pub(super) fn field_count(&self, kind: Kind) -> usize {
        match kind {
            Kind::BuiltIn(kind) => kind.field_count(),
            Kind::Part(part) => self.program.part(part).params.len() + PLACED.len(),
            Kind::Thing | Kind::Material => PLACED.len(),
        }
    }

    /// Where a field comes among all of its kind.
    pub(super) fn bit(&self, kind: Kind, place: FieldPlace) -> usize {
        match (kind, place) {
            (Kind::Part(part), FieldPlace::Placed(index)) => self.program.part(part).params.len() + index,
            (_, FieldPlace::Param(index) | FieldPlace::Index(index) | FieldPlace::Placed(index)) => index,
        }
    }
}
