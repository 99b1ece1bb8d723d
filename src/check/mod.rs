//! Tree to typed program: every name is resolved, every type and unit is right, every field exists.
//!
//! What is wrong is reported once, where it is, and becomes an `Invalid` expression, which fits everywhere and
//! silences every further complaint about it. A program with errors can still be evaluated, so that one run
//! finds the slips in values too.

mod errors;
mod expr;
mod functions;
mod make;
mod scope;
mod textures;
mod types;

pub use functions::Function;
pub use textures::parameters as texture_parameters;
pub use types::{Element, FieldSet, Type, describe_wanted};

use crate::color::Rgb;
use crate::diagnostic::Diagnostic;
use crate::schema::KindId;
use crate::span::Span;
use crate::syntax::ast::{self, BinaryOp, UnaryOp};
use smol_str::SmolStr;
use std::cell::Cell;

/// A checked file.
#[derive(Debug)]
pub struct Program {
    /// Everything at the top level.
    pub block: Block,
}

/// The statements of one scope.
#[derive(Debug, Default)]
pub struct Block {
    /// In the order written. A binding's index is its slot.
    pub bindings: Vec<Binding>,
    /// The slots in an order in which each comes after those it uses.
    pub order: Vec<usize>,
}

/// One statement.
#[derive(Debug)]
pub struct Binding {
    /// The name it gives, if any.
    pub name: Option<SmolStr>,
    /// What it means.
    pub value: Expr,
    /// Whether it is in the picture, or else only named.
    pub drawn: bool,
    /// The whole statement.
    pub span: Span,
}

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
    /// A word that the field understands.
    Word(&'static str),
    /// Two or three numbers.
    Tuple(Vec<Expr>),
    /// The value of a binding: in the scope so many levels out, at that slot.
    Name {
        /// 0 is the innermost scope.
        up: usize,
        /// The binding.
        slot: usize,
    },
    /// A component of a triple.
    Component {
        /// The triple.
        value: Box<Expr>,
        /// 0, 1 or 2.
        axis: usize,
    },
    /// An operator before its operand.
    Unary {
        /// The operator.
        operator: UnaryOp,
        /// Its operand.
        operand: Box<Expr>,
    },
    /// An operator between its operands.
    Binary {
        /// The operator.
        operator: BinaryOp,
        /// Left operand.
        left: Box<Expr>,
        /// Right operand.
        right: Box<Expr>,
        /// Whether the result is a whole number.
        int: bool,
    },
    /// A built-in function.
    Call {
        /// Which.
        function: Function,
        /// Its arguments, as its signature orders them.
        arguments: Vec<Expr>,
    },
    /// Makes a thing.
    Make(Box<Make>),
}

/// How a thing is made: what it begins as, and what is changed.
#[derive(Debug)]
pub struct Make {
    /// What it begins as.
    pub base: Base,
    /// Fields given here: index in [`KindId::fields`], and value.
    pub fields: Vec<(usize, Expr)>,
    /// Definitions the fields may use, and members of a group.
    pub block: Option<Block>,
    /// From the kind to the closing brace.
    pub span: Span,
}

/// What a thing begins as.
#[derive(Debug)]
pub enum Base {
    /// A built-in kind, with its defaults.
    Kind(KindId),
    /// A prototype: an expression that evaluates to a thing.
    Prototype(Expr),
    /// Unknown, and reported.
    Invalid,
}

/// Checks a file. `text` is the source the tree was read from.
pub fn check(file: &ast::File, text: &str) -> (Program, Vec<Diagnostic>) {
    let mut checker = Checker::new(text);
    let block = checker.block(&file.body.entries);
    (Program { block }, checker.diagnostics)
}

/// Checks one expression by itself, as the value of a field: nothing but what is built in is in scope.
pub fn check_value(
    field: &'static crate::schema::Field,
    value: &ast::Expr,
    text: &str,
) -> (Expr, Vec<Diagnostic>) {
    let mut checker = Checker::new(text);
    let value = checker.field_value(field, value);
    (value, checker.diagnostics)
}

/// What is known while checking.
struct Checker<'a> {
    text: &'a str,
    /// Innermost last.
    scopes: Vec<scope::Scope>,
    diagnostics: Vec<Diagnostic>,
    /// How many declared names may still be compared with unknown ones.
    guesses: Cell<usize>,
}

/// The most comparisons of unknown names with declared ones; beyond, only built-in names are suggested. It keeps
/// the time in bounds where thousands of names are unknown.
const MAX_GUESSES: usize = 1_000_000;

impl<'a> Checker<'a> {
    fn new(text: &'a str) -> Checker<'a> {
        Checker { text, scopes: vec![], diagnostics: vec![], guesses: Cell::new(MAX_GUESSES) }
    }

    fn report(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }

    /// The source text of a span.
    fn text(&self, span: Span) -> &'a str {
        self.text.get(span.range()).unwrap_or("")
    }
}

impl Expr {
    fn invalid(span: Span) -> Expr {
        Expr { kind: ExprKind::Invalid, span }
    }
}
