//! How things are made.

use super::{Around, Block, Expr, InsideId, PartId};
use crate::schema::KindId;
use crate::span::Span;
use crate::syntax::Rows;
use smol_str::SmolStr;
use std::rc::Rc;
use std::sync::Arc;

/// How a thing is made: what it begins as, and what is changed.
#[derive(Debug)]
pub struct Make {
    /// What it begins as.
    pub base: Base,
    /// Fields given here, in the order of [`FieldPlace`].
    pub fields: Vec<(FieldPlace, Expr)>,
    /// Definitions the fields may use, and members of a group.
    pub block: Option<Block>,
    /// The names inside that can be referred to by path.
    pub inside: Option<InsideId>,
    /// What is the same for everything made here.
    pub written: Rc<Written>,
}

/// What is the same for all things made at one place.
#[derive(Clone, Debug)]
pub struct Written {
    /// The name it is given.
    pub name: Option<SmolStr>,
    /// The name of the definition whose value it is.
    pub defined: Option<SmolStr>,
    /// From the kind to the closing brace.
    pub span: Span,
    /// Where the fields' values stand, in the order of [`Make::fields`].
    pub fields: Box<[Span]>,
    /// The rows that things are made of here, where these places are those of their shape.
    pub rows: Option<Arc<Rows>>,
}

/// Which field of a thing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FieldPlace {
    /// Of a part: an index into [`super::Part::params`].
    Param(usize),
    /// Of a kind: an index of [`KindId::fields`].
    Index(usize),
    /// An index into [`crate::schema::PLACED`], of a part or of a kind that is not known yet.
    Placed(usize),
}

/// What a thing begins as.
#[derive(Debug)]
pub enum Base {
    /// A built-in kind, with its defaults.
    Kind(KindId),
    /// A prototype: an expression that evaluates to a thing.
    Prototype(Expr),
    /// A part, or a file as one.
    Part {
        /// Which.
        part: PartId,
        /// Where the names around it are.
        around: Around,
    },
    /// Unknown, and reported.
    Invalid,
}

impl Written {
    /// Where a place lies in what was made of a row.
    pub fn place(&self, row: u32, place: Span) -> Span {
        match &self.rows {
            Some(rows) => rows.place(row as usize, place),
            None => place,
        }
    }
}

impl PartialEq for Written {
    /// Written at one place, under one name.
    fn eq(&self, other: &Written) -> bool {
        (&self.name, self.span, &self.fields) == (&other.name, other.span, &other.fields)
    }
}
