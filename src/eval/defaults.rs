//! The values of fields that are not given: the schema's expressions, evaluated by the language itself.

use super::{Evaluator, Read, Value};
use crate::check;
use crate::schema::{Field, Key, KindId, Preset};
use crate::span::SourceId;
use crate::syntax;
use std::cell::RefCell;
use std::collections::BTreeMap;

/// Defaults, evaluated when they are first asked for.
#[derive(Debug, Default)]
pub struct Defaults {
    values: RefCell<BTreeMap<(KindId, usize), Value>>,
}

impl Defaults {
    /// The default of a field that has one.
    pub(super) fn read<T: Read>(&self, kind: KindId, key: Key<T>) -> T::Out {
        let index = key.index(kind);
        let mut values = self.values.borrow_mut();
        let value = values.entry((kind, index)).or_insert_with(|| evaluate(kind.field(index)));
        T::read(value).expect("a sound thing has what is required, and a test evaluates every default")
    }

    /// The same by index, as a value.
    pub(super) fn value(&self, kind: KindId, index: usize) -> Value {
        let mut values = self.values.borrow_mut();
        values.entry((kind, index)).or_insert_with(|| evaluate(kind.field(index))).clone()
    }
}

fn evaluate(field: &'static Field) -> Value {
    let Preset::Value(text) = field.default else { return Value::Invalid };
    // The place is never shown: a test holds that no default has an error.
    let (tree, _) = syntax::parse_expression(SourceId(u32::MAX), text);
    let (expr, _) = check::check_value(field, &tree);
    Evaluator::alone(&expr)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::eval::errors;
    use crate::schema::KINDS;

    fn all() -> impl Iterator<Item = (&'static str, &'static Field, Value)> {
        let kinds = (0..KINDS.len()).map(|index| KindId(index as u8));
        kinds.flat_map(|kind| {
            let with_value = kind.fields().filter(|field| matches!(field.default, Preset::Value(_)));
            with_value.map(move |field| (kind.get().name, field, evaluate(field)))
        })
    }

    #[test]
    fn every_default_is_a_sound_value_of_its_field_and_in_range() {
        for (kind, field, value) in all() {
            let Preset::Value(text) = field.default else { continue };
            assert_ne!(value, Value::Invalid, "{kind}.{}: {text}", field.name);
            let (tree, slips) = syntax::parse_expression(SourceId(0), text);
            assert_eq!(slips, [], "{kind}.{}: {text}", field.name);
            let (expr, slips) = check::check_value(field, &tree);
            assert_eq!(slips, [], "{kind}.{}: {text}", field.name);
            let kind = crate::schema::kind(kind).unwrap();
            assert_eq!(errors::out_of_range(kind, field, &value, &expr), None);
        }
    }
}
