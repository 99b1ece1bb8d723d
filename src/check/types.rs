//! Types, and how one is said in a message.

use crate::schema::{Category, FieldType, KindId};
use crate::units::{self, Dim};

/// What an expression is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Type {
    /// Has an error that was reported; fits everywhere.
    Invalid,
    /// A number or quantity.
    Scalar(Element),
    /// Two or three numbers or quantities.
    Tuple(usize, Element),
    /// `true` or `false`.
    Bool,
    /// A text.
    Text,
    /// A linear colour.
    Color,
    /// A colour by place.
    Texture,
    /// A placement.
    Transform,
    /// A prototype, or a value written in place.
    Made(KindId, FieldSet),
    /// A thing that stands in the scene.
    Thing(KindId),
}

/// What a number counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Element {
    /// A literal 0, which fits every dimension.
    Zero,
    /// A whole number.
    Int,
    /// A quantity; a plain number where it has no dimension.
    Quantity(Dim),
}

/// A plain number.
pub const NUMBER: Element = Element::Quantity(units::NONE);

/// Which fields of a kind are given, by index.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FieldSet(u64);

impl FieldSet {
    /// Whether a field is in the set.
    pub fn has(self, index: usize) -> bool {
        self.0 >> index & 1 == 1
    }

    /// Adds a field.
    pub fn insert(&mut self, index: usize) {
        self.0 |= 1 << index;
    }

    /// The fields in either.
    pub fn union(self, other: FieldSet) -> FieldSet {
        FieldSet(self.0 | other.0)
    }
}

impl Element {
    /// The type of a sum of both, if there is one.
    pub fn join(self, other: Element) -> Option<Element> {
        match (self, other) {
            (Element::Zero, x) | (x, Element::Zero) => Some(x),
            (Element::Int, NUMBER) | (NUMBER, Element::Int) => Some(NUMBER),
            (a, b) => (a == b).then_some(a),
        }
    }

    /// Its dimension; a zero counts as a plain number.
    pub fn dim(self) -> Dim {
        match self {
            Element::Zero | Element::Int => units::NONE,
            Element::Quantity(dim) => dim,
        }
    }

    /// Whether it can stand where this dimension is wanted.
    pub fn fits(self, dim: Dim) -> bool {
        self == Element::Zero || self.dim() == dim
    }

    /// Whether it can stand where a whole number is wanted.
    pub fn is_int(self) -> bool {
        matches!(self, Element::Zero | Element::Int)
    }
}

impl Type {
    /// As a message says it: `a length`.
    pub fn describe(self) -> String {
        match self {
            Type::Invalid => "unknown".into(),
            Type::Scalar(Element::Zero | Element::Int) => "a number".into(),
            Type::Scalar(Element::Quantity(dim)) => dim.to_string(),
            Type::Tuple(count, element) => format!("{} {}", word(count), plural(element.dim())),
            Type::Bool => "true or false".into(),
            Type::Text => "a text".into(),
            Type::Color => "a colour".into(),
            Type::Texture => "a texture".into(),
            Type::Transform => "a placement".into(),
            Type::Made(kind, _) if matches!(kind.get().category, Category::Material) => {
                format!("{} `{}`", article(kind), kind.get().name)
            }
            Type::Made(kind, _) => format!("{} `{}` that is not drawn", article(kind), kind.get().name),
            Type::Thing(kind) => format!("{} `{}` of the scene", article(kind), kind.get().name),
        }
    }
}

fn article(kind: KindId) -> &'static str {
    if kind.get().name.starts_with(['a', 'e', 'i', 'o', 'u']) { "an" } else { "a" }
}

fn word(count: usize) -> &'static str {
    if count == 2 { "two" } else { "three" }
}

fn plural(dim: Dim) -> String {
    let one = dim.to_string();
    let name = one.trim_start_matches("a ").trim_start_matches("an ");
    match name.split_once(' ') {
        Some((first, rest)) => format!("{} {rest}", first.replace("quantity", "quantities")),
        None => format!("{name}s"),
    }
}

/// As a message says what a field wants: `a length`, `a colour`.
pub fn describe_wanted(ty: FieldType) -> String {
    match ty {
        FieldType::Scalar(dim) => dim.to_string(),
        FieldType::Int => "a whole number".into(),
        FieldType::Bool => "`true` or `false`".into(),
        FieldType::Color => "a colour".into(),
        FieldType::Paint => "a colour or texture".into(),
        FieldType::Text => "a text".into(),
        FieldType::Tuple(count, dim) => format!("{} {}", word(count), plural(dim)),
        FieldType::IntTuple(count) => format!("{} whole numbers", word(count)),
        FieldType::Transform => "a placement".into(),
        FieldType::Made(Category::Material) => "a material".into(),
        FieldType::Made(_) => "a thing".into(),
        FieldType::Part(kind) => format!("a `{kind}`"),
        FieldType::Target => "a thing of the scene".into(),
        FieldType::Named(kind) => format!("the name of a {kind}"),
        FieldType::Choice(words) => list(words.iter().map(|word| format!("`{}`", word.name)).collect(), "or"),
        FieldType::OneOf(types) => list(types.iter().map(|ty| describe_wanted(*ty)).collect(), "or"),
    }
}

/// `a`, `a or b`, `a, b or c`.
pub fn list(mut items: Vec<String>, last: &str) -> String {
    match items.pop() {
        Some(only) if items.is_empty() => only,
        Some(end) => format!("{} {last} {end}", items.join(", ")),
        None => String::new(),
    }
}
