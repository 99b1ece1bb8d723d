//! What goes on behind a value.

use super::List;
use crate::check::{Declared, Type};
use crate::ide::typing::Typing;
use crate::schema::FieldType;
use crate::span::Span;

const COMPUTES: &[&str] = &["+", "-", "*", "/"];
const ORDERS: &[&str] = &["<", "<=", ">", ">="];
const EQUALS: &[&str] = &["==", "!="];
const JOINS: &[&str] = &["and", "or"];

impl List<'_> {
    /// These words, and the operators that take what ends before the cursor and may give what is wanted.
    pub(super) fn behind(&mut self, typing: &Typing, words: &[&'static str], field: Option<&str>) {
        words.iter().for_each(|word| self.word(word));
        let before = &typing.analysis.source().text[..typing.cursor.word.start];
        let ty = typing.type_before(before.trim_end().len());
        // Between `if` and `then` stands a condition.
        let wanted = match words.contains(&"then") {
            true => Some(Declared::Field(FieldType::Bool)),
            false => typing.wanted_here(field),
        };
        let taken: &[&[&str]] = match ty {
            Type::Scalar(number) if number.is_int() => &[COMPUTES, ORDERS, EQUALS, &["to"]],
            Type::Scalar(_) => &[COMPUTES, ORDERS, EQUALS],
            Type::Tuple(..) | Type::Color => &[COMPUTES, EQUALS],
            Type::Bool => &[JOINS, EQUALS],
            Type::Text => &[EQUALS],
            Type::Transform => &[&["|>"]],
            Type::Invalid => &[COMPUTES, ORDERS, EQUALS, JOINS, &["to", "|>"]],
            _ => &[],
        };
        let fits = taken.concat().into_iter().filter(|operator| may_give(operator, wanted.as_ref()));
        fits.for_each(|operator| self.word(operator));
    }
}

impl Typing<'_> {
    /// The type of the longest expression that ends at a byte.
    pub(in crate::ide) fn type_before(&self, end: usize) -> Type {
        let ends = |span: Span| span.source == self.analysis.main && span.range().end == end;
        let types = self.analysis.study.notes.types.iter();
        let longest = types.filter(|(span, _)| ends(*span)).min_by_key(|(span, _)| span.start);
        longest.map_or(Type::Invalid, |(_, ty)| ty.clone())
    }
}

/// Whether an expression with an operator may be what is wanted.
fn may_give(operator: &str, wanted: Option<&Declared>) -> bool {
    match wanted {
        None | Some(Declared::Invalid) => true,
        Some(Declared::Field(ty)) => may_be(operator, *ty),
        Some(Declared::List(_)) => operator == "to" || COMPUTES.contains(&operator),
        Some(Declared::Thing) => false,
    }
}

fn may_be(operator: &str, ty: FieldType) -> bool {
    match ty {
        FieldType::Bool => !matches!(operator, "to" | "|>"),
        FieldType::Transform => operator == "|>",
        FieldType::OneOf(types) => types.iter().any(|ty| may_be(operator, *ty)),
        FieldType::Scalar(_) | FieldType::Int | FieldType::Tuple(..) | FieldType::IntTuple(_) => {
            COMPUTES.contains(&operator)
        }
        FieldType::Color | FieldType::Paint => COMPUTES.contains(&operator),
        _ => false,
    }
}
