//! The typed program: what checking gives, and evaluating takes.

mod expr;
mod making;

pub use expr::*;
pub use making::*;

use super::declared::Declared;
use super::types::Type;
use crate::asset::table::Table;
use crate::diagnostic::Code;
use crate::span::{SourceId, Span};
use crate::syntax::Rows;
use crate::units::Dim;
use smol_str::SmolStr;
use std::collections::BTreeMap;
use std::sync::Arc;

macro_rules! ids {
    ($($(#[doc = $doc:literal])* $name:ident;)*) => {
        $($(#[doc = $doc])* #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)] pub struct $name(pub u32);

        impl $name {
            /// As an index.
            pub fn index(self) -> usize {
                self.0 as usize
            }
        })*
    };
}

ids! {
    /// Index into [`Program::parts`].
    PartId;
    /// Index into [`Program::functions`].
    FunctionId;
    /// Index into [`Program::files`].
    FileId;
    /// Index into [`Program::insides`].
    InsideId;
    /// Index into [`Program::tables`].
    TableId;
}

/// A checked file with everything it imports.
#[derive(Debug, Default)]
pub struct Program {
    /// Files, each behind those it imports: the last is the one that is drawn.
    pub files: Vec<File>,
    /// Parts, files among them.
    pub parts: Vec<Part>,
    /// Functions the files declare.
    pub functions: Vec<FunctionBody>,
    /// Names by path: inside parts, groups and files.
    pub insides: Vec<Inside>,
    /// Tables that were read.
    pub tables: Vec<Arc<Table>>,
    /// Warnings that are to be silenced.
    pub allows: Vec<Allow>,
}

/// A file of the program.
#[derive(Debug)]
pub struct File {
    /// Its text.
    pub source: SourceId,
    /// Its content as a part.
    pub part: PartId,
}

/// A part, or a file.
#[derive(Debug)]
pub struct Part {
    /// What it is called; empty for a file.
    pub name: SmolStr,
    /// What can be set, in the order written.
    pub params: Vec<Param>,
    /// Its statements.
    pub block: Block,
    /// Fields of [`crate::schema::PLACED`] that its body gives: index and value.
    pub fields: Vec<(usize, Expr)>,
    /// How many slots a frame of it has.
    pub slots: usize,
    /// The names inside.
    pub inside: InsideId,
    /// How much one evaluation counts.
    pub cost: u64,
    /// The words above it.
    pub doc: Option<SmolStr>,
}

/// A setting of a part or file.
#[derive(Debug)]
pub struct Param {
    /// What it is called.
    pub name: SmolStr,
    /// Its type.
    pub declared: Declared,
    /// What it is where it is not set: by `--set`, where that sets it.
    pub default: Expr,
    /// The default as the file has it.
    pub written: String,
    /// Whether `--set` set it.
    pub set: bool,
    /// What its value must lie in, both ends included.
    pub range: Option<[Expr; 2]>,
    /// Its slot in the part's frame.
    pub slot: usize,
    /// The words above it.
    pub doc: Option<SmolStr>,
    /// The whole statement.
    pub span: Span,
}

/// A function that a file declares.
#[derive(Debug)]
pub struct FunctionBody {
    /// What it is called.
    pub name: SmolStr,
    /// What it takes; their slots count from 0.
    pub parameters: Vec<(SmolStr, Declared)>,
    /// Of what it gives.
    pub result: Declared,
    /// What it gives.
    pub value: Expr,
    /// How many slots a frame of it has.
    pub slots: usize,
    /// How much one call counts.
    pub cost: u64,
    /// The words above it.
    pub doc: Option<SmolStr>,
}

/// The names inside a part, group or file.
#[derive(Debug, Default)]
pub struct Inside {
    /// By name.
    pub names: BTreeMap<SmolStr, InsideName>,
}

/// A name inside a part, group or file.
#[derive(Clone, Debug)]
pub struct InsideName {
    /// Its slot in the frame it was declared in.
    pub slot: usize,
    /// What it is.
    pub ty: Type,
    /// Where it is declared.
    pub place: Span,
}

/// `@allow(code, "why")` before a statement.
#[derive(Clone, Debug)]
pub struct Allow {
    /// What is silenced.
    pub code: Code,
    /// On this statement.
    pub on: Span,
    /// The prefix itself.
    pub span: Span,
    /// The same with the white space behind it, which goes with it.
    pub all: Span,
}

/// The statements of one scope.
#[derive(Debug, Default)]
pub struct Block {
    /// In the order written.
    pub statements: Vec<Statement>,
    /// The statements in an order in which each comes after those it uses; empty where that is the order written.
    pub order: Vec<u32>,
}

/// One statement.
#[derive(Debug)]
pub struct Statement {
    /// What it does.
    pub kind: StatementKind,
    /// From its first word to its end.
    pub span: Span,
    /// Whether its things are left out: `@off`.
    pub off: bool,
    /// Whether all others are: `@solo`.
    pub solo: bool,
}

/// The variable of a loop, as a message says it.
#[derive(Debug, PartialEq)]
pub struct Variable {
    /// Its name.
    pub name: SmolStr,
    /// The dimension of its value, if that is a quantity.
    pub dim: Dim,
    /// Where it is named.
    pub span: Span,
}

/// The forms of a statement.
#[derive(Debug)]
pub enum StatementKind {
    /// Nothing is left to do.
    Nothing,
    /// Has an error that was reported.
    Invalid,
    /// Gives a slot its value.
    Define {
        /// The slot.
        slot: usize,
        /// The value.
        value: Expr,
    },
    /// Gives the slot of a param its value.
    Param(usize),
    /// Puts a thing into the picture.
    Draw {
        /// The slot of its name, where anything refers to it.
        slot: Option<usize>,
        /// How it is made.
        make: Box<Make>,
    },
    /// Puts a thing into the picture for each row.
    Rows {
        /// The rows.
        rows: Arc<Rows>,
        /// How things are made, by shape; none where the rows of a shape are checked apart.
        makes: Vec<Option<Make>>,
        /// Those that are not all alike, by row.
        apart: BTreeMap<usize, Statement>,
    },
    /// Goes through a list.
    For {
        /// The slot of the variable.
        slot: usize,
        /// How the variable is said in a message.
        variable: Arc<Variable>,
        /// What is gone through.
        list: Expr,
        /// What is done with each.
        body: Block,
        /// How much one turn counts.
        cost: u64,
    },
    /// Does the one or the other.
    If {
        /// Which.
        condition: Expr,
        /// Where it holds.
        then: Block,
        /// Where it does not.
        otherwise: Block,
    },
    /// Must hold.
    Assert {
        /// What.
        condition: Expr,
        /// What is said where it does not.
        message: Option<Expr>,
    },
}

impl Statement {
    /// Whether it gives a name its value.
    pub fn names(&self) -> bool {
        matches!(
            self.kind,
            StatementKind::Define { .. }
                | StatementKind::Param(_)
                | StatementKind::Draw { slot: Some(_), .. }
        )
    }
}

impl Program {
    /// The part with this id.
    pub fn part(&self, id: PartId) -> &Part {
        &self.parts[id.index()]
    }

    /// The file that is drawn.
    pub fn main(&self) -> Option<&Part> {
        self.files.last().map(|file| self.part(file.part))
    }
}
