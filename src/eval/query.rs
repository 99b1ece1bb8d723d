//! What is asked of things and lists.

use super::built::{Shift, moved};
use super::{Evaluator, Placed, Value, errors};
use crate::asset::table::Cells;
use crate::check::{Corner, Expr, FieldPlace};
use crate::math::DAffine3;
use crate::schema::{FieldType, KindId, Preset, placed};
use crate::span::Span;
use std::rc::Rc;

impl<'p> Evaluator<'p> {
    /// `list[index]`
    pub(super) fn index(&mut self, list: &Expr, index: &Expr) -> Value {
        let (Value::List(list), Value::Number(at)) = (self.expr(list), self.expr(index)) else {
            return Value::Invalid;
        };
        let found = if at >= 0.0 { list.get(at as usize) } else { None };
        match found {
            Some(value) => value,
            None => self.report(errors::index_out_of_range(at, list.len(), index.span)),
        }
    }

    /// `thing.field`
    pub(super) fn field(&mut self, value: &Expr, field: FieldPlace) -> Value {
        match self.expr(value) {
            Value::Made(made) => self.field_of(&made, field),
            Value::Thing(thing) => {
                let found = self.field_of(&thing.made, field);
                let at = FieldPlace::Index(placed::AT.index(thing.made.kind()));
                match found {
                    // A point inside is said as it is seen from where the path begins.
                    Value::Tuple(point)
                        if index_of(thing.made.kind(), field) == index_of(thing.made.kind(), at) =>
                    {
                        let carried = self.buffers.get(thing.level);
                        let carried = carried
                            .map_or(DAffine3::IDENTITY, |built| built.carries(thing.stands, thing.from));
                        Value::Tuple(carried.transform_point3(point))
                    }
                    found => found,
                }
            }
            Value::Part(part) => match field {
                FieldPlace::Param(index) => self.param_of(&part, index),
                FieldPlace::Placed(index) => match &part.placed[index] {
                    Some(given) => zero(crate::schema::PLACED[index].ty, given.value.clone()),
                    None => unplaced(index),
                },
                FieldPlace::Index(_) => Value::Invalid,
            },
            _ => Value::Invalid,
        }
    }

    fn field_of(&mut self, made: &super::Made, field: FieldPlace) -> Value {
        let Some(index) = index_of(made.kind(), field) else { return Value::Invalid };
        let known = made.kind().field(index);
        let value = match made.fields().find(index) {
            Some((value, _)) => value.clone(),
            None if matches!(known.default, Preset::Value(_)) => self.defaults.default(made.kind(), index),
            None if known.name == "place" => Value::Transform(Rc::new(DAffine3::IDENTITY)),
            None => Value::Invalid,
        };
        zero(known.ty, value)
    }

    /// A name inside a thing.
    pub(super) fn name_inside(&mut self, value: &Expr, slot: usize) -> Value {
        let Value::Thing(thing) = self.expr(value) else { return Value::Invalid };
        let found =
            thing.inside.iter().flat_map(|names| names.iter()).find(|(known, _)| *known as usize == slot);
        let Some((_, value)) = found else { return Value::Invalid };
        match carried(value, thing.shift, thing.level) {
            // Seen from where the path began.
            Value::Thing(inner) => Value::Thing(Rc::new(Placed { from: thing.from, ..(*inner).clone() })),
            value => value,
        }
    }

    /// `bounds(…).min` and the like.
    pub(super) fn corner(&mut self, value: &Expr, corner: Corner, span: Span) -> Value {
        let Value::Bounds(bounds) = self.expr(value) else { return Value::Invalid };
        let point = match corner {
            Corner::Min => bounds.min,
            Corner::Max => bounds.max,
            Corner::Center => bounds.center(),
            Corner::Size => bounds.size(),
        };
        if point.is_finite() { Value::Tuple(point) } else { self.report(errors::number_not_finite(span)) }
    }

    /// A cell of a row.
    pub(super) fn column(&mut self, row: &Expr, column: usize) -> Value {
        let Value::Row(table, row) = self.expr(row) else { return Value::Invalid };
        match &self.program.tables[table.index()].columns[column].cells {
            Cells::Numbers { values, .. } => Value::Number(values[row as usize]),
            Cells::Texts(texts) => Value::Text(texts[row as usize].clone()),
        }
    }
}

/// A value inside a thing that was copied.
pub(super) fn carried(value: &Value, shift: Shift, level: usize) -> Value {
    match value {
        Value::Thing(thing) => Value::Thing(Rc::new(moved(thing, shift, level))),
        value => value.clone(),
    }
}

fn index_of(kind: KindId, field: FieldPlace) -> Option<usize> {
    match field {
        FieldPlace::Index(index) => Some(index),
        FieldPlace::Placed(index) => Some(kind.get().fields.len() + index),
        FieldPlace::Param(_) => None,
    }
}

/// A lone 0 where the field has several components.
fn zero(ty: FieldType, value: Value) -> Value {
    match (ty, &value) {
        (FieldType::Tuple(..) | FieldType::IntTuple(_), Value::Number(_)) => {
            Value::Tuple(crate::math::DVec3::ZERO)
        }
        _ => value,
    }
}

/// What a field of `PLACED` is where it is not given.
fn unplaced(index: usize) -> Value {
    match crate::schema::PLACED[index].name {
        "at" => Value::Tuple(crate::math::DVec3::ZERO),
        "place" => Value::Transform(Rc::new(DAffine3::IDENTITY)),
        _ => Value::Invalid,
    }
}
