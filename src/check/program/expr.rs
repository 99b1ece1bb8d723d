//! Typed expressions: what has a value.

use super::{FieldPlace, FileId, FunctionId, Make, TableId};
use crate::check::functions::Function;
use crate::color::Rgb;
use crate::span::Span;
use crate::syntax::ast::{BinaryOp, UnaryOp};
use crate::units::Dim;
use smol_str::SmolStr;

/// A typed expression. Numbers are in base units.
#[derive(Debug)]
pub struct Expr {
    /// What it is.
    pub kind: ExprKind,
    /// Where it was written.
    pub span: Span,
}

/// The forms of a typed expression.
#[derive(Debug)]
pub enum ExprKind {
    /// Was reported.
    Invalid,
    /// A number or quantity.
    Number(f64),
    /// `true` or `false`.
    Bool(bool),
    /// A text.
    Text(SmolStr),
    /// A colour.
    Color(Rgb),
    /// A number of the row that is being evaluated.
    RowNumber {
        /// Which literal.
        literal: usize,
        /// What it is multiplied with: its unit.
        factor: f64,
    },
    /// A colour of the row that is being evaluated.
    RowColor {
        /// Which literal.
        literal: usize,
    },
    /// A word that the field understands.
    Word(&'static str),
    /// Two or three numbers.
    Tuple(Vec<Expr>),
    /// Items of one type.
    List(Vec<Expr>),
    /// The value of a name of this file.
    Name {
        /// In the frame so many levels out: 0 is the innermost part, function or file.
        up: usize,
        /// Where in it.
        slot: usize,
    },
    /// The value of a name of an imported file.
    FileName {
        /// The file, with its params as they are by default.
        file: FileId,
        /// Where in its frame.
        slot: usize,
    },
    /// A component of a triple.
    Component {
        /// The triple.
        value: Box<Expr>,
        /// 0, 1 or 2.
        axis: usize,
    },
    /// An item of a list.
    Index {
        /// The list.
        value: Box<Expr>,
        /// Which, from 0.
        index: Box<Expr>,
    },
    /// A field of a thing.
    Field {
        /// The thing.
        value: Box<Expr>,
        /// Which.
        field: FieldPlace,
    },
    /// A name inside a thing.
    Inside {
        /// The thing.
        value: Box<Expr>,
        /// The name's slot.
        slot: usize,
    },
    /// A point of bounds.
    Corner {
        /// The bounds.
        value: Box<Expr>,
        /// Which.
        corner: Corner,
    },
    /// A column of a row.
    Column {
        /// The row.
        value: Box<Expr>,
        /// Which, from 0.
        column: usize,
    },
    /// All rows of a table.
    Table(TableId),
    /// `if … then … else …`: condition, and both values.
    If(Box<[Expr; 3]>),
    /// An operator before its operand.
    Unary {
        /// The operator.
        operator: UnaryOp,
        /// Its operand.
        operand: Box<Expr>,
    },
    /// A sum, difference, product or quotient of two numbers.
    Arithmetic {
        /// The operator.
        operator: Arithmetic,
        /// Left operand.
        left: Box<Expr>,
        /// Right operand.
        right: Box<Expr>,
        /// Whether the result is a whole number.
        int: bool,
    },
    /// Any other operator between its operands.
    Binary {
        /// The operator.
        operator: BinaryOp,
        /// What is compared, where it has a dimension.
        dim: Dim,
        /// Left operand.
        left: Box<Expr>,
        /// Right operand.
        right: Box<Expr>,
    },
    /// A built-in function that computes a number from numbers.
    Compute {
        /// Which.
        function: Function,
        /// Its arguments, as its signature orders them.
        arguments: Vec<Expr>,
    },
    /// Any other built-in function.
    Call {
        /// Which.
        function: Function,
        /// Its arguments, as its signature orders them.
        arguments: Vec<Expr>,
    },
    /// A function that a file declares.
    CallDeclared {
        /// Which.
        function: FunctionId,
        /// Where the names around it are.
        around: Around,
        /// Its arguments in order.
        arguments: Vec<Expr>,
    },
    /// Makes a thing.
    Make(Box<Make>),
}

/// An operator that makes a number of two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arithmetic {
    /// `+`
    Add,
    /// `-`
    Subtract,
    /// `*`
    Multiply,
    /// `/`
    Divide,
}

impl Arithmetic {
    /// The operator as such, if it is one.
    pub fn of(operator: BinaryOp) -> Option<Arithmetic> {
        Some(match operator {
            BinaryOp::Add => Arithmetic::Add,
            BinaryOp::Subtract => Arithmetic::Subtract,
            BinaryOp::Multiply => Arithmetic::Multiply,
            BinaryOp::Divide => Arithmetic::Divide,
            _ => return None,
        })
    }

    /// As written.
    pub fn operator(self) -> BinaryOp {
        match self {
            Arithmetic::Add => BinaryOp::Add,
            Arithmetic::Subtract => BinaryOp::Subtract,
            Arithmetic::Multiply => BinaryOp::Multiply,
            Arithmetic::Divide => BinaryOp::Divide,
        }
    }
}

/// A point of bounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Corner {
    /// The least corner.
    Min,
    /// The greatest corner.
    Max,
    /// The middle.
    Center,
    /// From the least to the greatest.
    Size,
}

/// Where the names around a part or function are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Around {
    /// Nowhere: it is a file.
    Nothing,
    /// In the frame so many levels out.
    Up(usize),
    /// In an imported file with its params as they are by default.
    File(FileId),
}

impl Expr {
    pub(in super::super) fn invalid(span: Span) -> Expr {
        Expr { kind: ExprKind::Invalid, span }
    }
}
