//! The syntax tree: what was written, with its places, before any name is looked up.

use super::rows::Rows;
use crate::span::{SourceId, Span};
use smol_str::SmolStr;
use std::sync::Arc;

/// One source file. The entries are in the order of the text.
#[derive(Clone, Debug)]
pub struct File {
    /// The source it was read from.
    pub source: SourceId,
    /// Everything at the top level.
    pub body: Body,
    /// Every comment of the file, in order, for whoever prints the tree again.
    pub comments: Vec<Comment>,
}

/// A comment, delimiters included. Its kind shows in its text: `//`, `///` or `/*`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Comment {
    /// Where it stands.
    pub span: Span,
}

/// An identifier, or a unit.
#[derive(Clone, Debug)]
pub struct Name {
    /// As written.
    pub text: SmolStr,
    /// Where.
    pub span: Span,
}

/// What stands between braces, or at the top level of a file.
#[derive(Clone, Debug)]
pub struct Body {
    /// Fields and statements in the order written.
    pub entries: Vec<Entry>,
    /// With the braces; a file's whole text at the top level.
    pub span: Span,
}

/// One entry of a body.
#[derive(Clone, Debug)]
pub enum Entry {
    /// `name: value`
    Field(Field),
    /// Anything else. Boxed, since most entries are fields.
    Statement(Box<Statement>),
    /// Things of a file, of which an earlier one differs in its literals only. [`super::parse_rows`] gives them.
    Rows(Arc<Rows>),
    /// Text that could not be understood, and was reported. The name it seems to give counts as given.
    Broken(Broken),
}

impl Entry {
    /// Where it begins.
    pub fn start(&self) -> u32 {
        match self {
            Entry::Field(field) => field.name.span.start,
            Entry::Statement(statement) => statement.span.start,
            Entry::Rows(rows) => rows.span().start,
            Entry::Broken(broken) => broken.span.start,
        }
    }
}

/// `name: value`
#[derive(Clone, Debug)]
pub struct Field {
    /// The field's name.
    pub name: Name,
    /// Its value.
    pub value: Expr,
}

/// An entry that could not be understood.
#[derive(Clone, Debug)]
pub struct Broken {
    /// The field or definition it seems to give.
    pub name: Option<Name>,
    /// All of its text.
    pub span: Span,
}

/// A statement, with what stands before it.
#[derive(Clone, Debug)]
pub struct Statement {
    /// The lines of the `///` comments above it, without the slashes; none where there are none.
    pub doc: Option<SmolStr>,
    /// `@off`, `@solo` and `@allow(…)`, in order.
    pub prefixes: Vec<Prefix>,
    /// The statement itself.
    pub kind: StatementKind,
    /// From its first word to its end, without doc and prefixes.
    pub span: Span,
}

/// `@word` or `@word(argument, …)` before a statement.
#[derive(Clone, Debug)]
pub struct Prefix {
    /// The word behind `@`.
    pub name: Name,
    /// What stands in its parentheses; none where it has none.
    pub arguments: Option<Vec<Argument>>,
    /// With the `@` and the parentheses.
    pub span: Span,
}

/// The forms of a statement.
#[derive(Clone, Debug)]
pub enum StatementKind {
    /// `kind name? { … }`: a thing of the picture.
    Thing {
        /// The name it can be referred to by.
        name: Option<Name>,
        /// Kind and body.
        construct: Construct,
    },
    /// `let name = value` or `material name = value`.
    Definition {
        /// Which of the two words.
        keyword: Keyword,
        /// What is defined.
        name: Name,
        /// As what.
        value: Expr,
    },
    /// `param name: type = default in low to high`.
    Param {
        /// What is set.
        name: Name,
        /// Its type.
        ty: TypeName,
        /// What it is where it is not set.
        default: Expr,
        /// What stands behind `in`: an expression with `to`.
        range: Option<Expr>,
    },
    /// `part name { … }`
    Part {
        /// What it is used by.
        name: Name,
        /// Its params, definitions and members.
        body: Body,
    },
    /// `import "file.rt" as name`
    Import {
        /// The path as written, escapes resolved, with the place of the text.
        path: Name,
        /// What it is used by.
        name: Name,
    },
    /// `fn name(a: type, b: type) -> type = value`
    Function {
        /// What it is called by.
        name: Name,
        /// In order.
        parameters: Vec<Parameter>,
        /// Of what it gives.
        result: TypeName,
        /// What it gives.
        value: Expr,
    },
    /// `for variable in list { … }`
    For {
        /// Stands for each item in turn.
        variable: Name,
        /// What is gone through.
        list: Expr,
        /// What is done with each.
        body: Body,
    },
    /// `if condition { … } else { … }`. Behind `else` another `if` may stand: a body with that one statement.
    If {
        /// Which body it is.
        condition: Expr,
        /// Where it holds.
        then: Body,
        /// Where it does not.
        otherwise: Option<Body>,
    },
    /// `assert condition, "message"`
    Assert {
        /// What must hold.
        condition: Expr,
        /// What is said where it does not.
        message: Option<Expr>,
    },
}

/// A type as written.
#[derive(Clone, Debug)]
pub enum TypeName {
    /// `length`
    Named(Name),
    /// `[length]`: a list of them.
    List(Box<TypeName>, Span),
    /// Could not be understood, and was reported.
    Invalid(Span),
}

/// `name: type` among what a function takes.
#[derive(Clone, Debug)]
pub struct Parameter {
    /// What it is called inside.
    pub name: Name,
    /// Its type.
    pub ty: TypeName,
}

/// The word a definition begins with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Keyword {
    /// Any value but a material.
    Let,
    /// A material.
    Material,
}

/// `kind { … }`
#[derive(Clone, Debug)]
pub struct Construct {
    /// A built-in kind, or the path to a prototype, part or imported file.
    pub kind: Path,
    /// Its fields, and its members where it is a group.
    pub body: Body,
    /// From the kind to the closing brace.
    pub span: Span,
}

/// `name` or `name.name…`
#[derive(Clone, Debug)]
pub struct Path {
    /// Where the search begins.
    pub first: Name,
    /// Behind each point.
    pub rest: Vec<Name>,
}

/// An expression.
#[derive(Clone, Debug)]
pub struct Expr {
    /// What it is.
    pub kind: ExprKind,
    /// Where it stands.
    pub span: Span,
}

/// The forms of an expression. A tree is at most [`crate::syntax::MAX_DEPTH`] deep.
#[derive(Clone, Debug)]
pub enum ExprKind {
    /// Could not be understood, and was reported.
    Invalid,
    /// `3`, `0.5`, `1e-3`: a number without a unit.
    Number {
        /// Its value.
        value: f64,
        /// Whether it is written as a whole number: digits only.
        int: bool,
    },
    /// `8mm`, `25%`, `10W/m2`: a number that touches its unit.
    Quantity {
        /// The number before the unit.
        value: f64,
        /// The unit as written.
        unit: Name,
    },
    /// `(…)m`: a unit behind parentheses goes on every component.
    Scaled {
        /// What stands in the parentheses.
        value: Box<Expr>,
        /// The unit as written.
        unit: Name,
    },
    /// `true` or `false`.
    Bool(bool),
    /// `"text"`, with its escapes resolved.
    Text(SmolStr),
    /// `#rgb` or `#rrggbb`: the digits, which are well formed.
    Color(SmolStr),
    /// A bare word: a name, or a word that the field's type knows.
    Name(SmolStr),
    /// `(a, b)` or `(a, b, c)`: two components or more.
    Tuple(Vec<Expr>),
    /// `[a, b]`
    List(Vec<Expr>),
    /// `(a)`: kept for the formatter and for exact spans.
    Paren(Box<Expr>),
    /// `f(a, b: c)`
    Call {
        /// The function's name, or the path to it in an imported file.
        function: Path,
        /// Its arguments in order.
        arguments: Vec<Argument>,
    },
    /// `value.member`
    Member {
        /// What is looked into.
        value: Box<Expr>,
        /// The component, field, or name inside.
        member: Name,
    },
    /// `value[index]`
    Index {
        /// The list.
        value: Box<Expr>,
        /// Which item, from 0.
        index: Box<Expr>,
    },
    /// `if condition then value else value`
    If {
        /// Which value it is.
        condition: Box<Expr>,
        /// Where it holds.
        then: Box<Expr>,
        /// Where it does not.
        otherwise: Box<Expr>,
    },
    /// `kind { … }` as a value: a prototype, not drawn.
    Construct(Box<Construct>),
    /// `-a` or `not a`
    Unary {
        /// The operator.
        operator: UnaryOp,
        /// Its operand.
        operand: Box<Expr>,
    },
    /// `a + b`
    Binary {
        /// The operator.
        operator: BinaryOp,
        /// Where the operator stands.
        at: Span,
        /// Left operand.
        left: Box<Expr>,
        /// Right operand.
        right: Box<Expr>,
    },
}

/// One argument of a call.
#[derive(Clone, Debug)]
pub struct Argument {
    /// The parameter's name, where it is given: `turn(z: 10deg)`.
    pub name: Option<Name>,
    /// Its value.
    pub value: Expr,
}

/// An operator before its operand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnaryOp {
    /// `-`
    Negate,
    /// `not`
    Not,
}

/// An operator between its operands, from the loosest to the tightest. `if` stands between [`BinaryOp::Pipe`] and
/// [`BinaryOp::Or`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum BinaryOp {
    Pipe,
    Or,
    And,
    Equal,
    NotEqual,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
    To,
    Add,
    Subtract,
    Multiply,
    Divide,
}

impl BinaryOp {
    /// Every operator, from the loosest to the tightest.
    pub const ALL: &'static [BinaryOp] = {
        use BinaryOp::*;
        &[
            Pipe,
            Or,
            And,
            Equal,
            NotEqual,
            Less,
            LessEqual,
            Greater,
            GreaterEqual,
            To,
            Add,
            Subtract,
            Multiply,
            Divide,
        ]
    };

    /// As written.
    pub fn symbol(self) -> &'static str {
        match self {
            BinaryOp::Pipe => "|>",
            BinaryOp::Or => "or",
            BinaryOp::And => "and",
            BinaryOp::Equal => "==",
            BinaryOp::NotEqual => "!=",
            BinaryOp::Less => "<",
            BinaryOp::LessEqual => "<=",
            BinaryOp::Greater => ">",
            BinaryOp::GreaterEqual => ">=",
            BinaryOp::To => "to",
            BinaryOp::Add => "+",
            BinaryOp::Subtract => "-",
            BinaryOp::Multiply => "*",
            BinaryOp::Divide => "/",
        }
    }
}
