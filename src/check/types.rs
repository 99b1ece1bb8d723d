//! Types, and how one is said in a message.

use super::program::{FileId, FunctionId, InsideId, PartId, TableId};
use crate::schema::{Category, FieldType, KindId};
use crate::units::{self, Dim};
use std::sync::Arc;

/// What an expression is.
#[derive(Clone, Debug, PartialEq)]
pub enum Type {
    /// Has an error that was reported; fits everywhere. Also what an empty list holds.
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
    /// A colour by place; a plain colour too, where a value may be either.
    Texture,
    /// A placement.
    Transform,
    /// A prototype, or a value written in place.
    Made(Making),
    /// A thing that stands in the scene.
    Thing(Making),
    /// A list of values of one type.
    List(Arc<Type>),
    /// What `bounds(…)` gives.
    Bounds,
    /// A row of a table.
    Row(TableId),
    /// The name of a part: no value.
    Part(PartId),
    /// The name of an imported file: no value.
    File(FileId),
    /// The name of a function: no value.
    Function(FunctionId),
}

/// What is known of a thing before it is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Making {
    /// What it is.
    pub kind: Kind,
    /// Its fields that are given; of a part only those in [`crate::schema::PLACED`], from bit 0 on.
    pub given: FieldSet,
    /// The names in the body of a group.
    pub inside: Option<InsideId>,
}

/// What a thing is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A kind of the schema.
    BuiltIn(KindId),
    /// A part, or a file as a part.
    Part(PartId),
    /// Some material.
    Material,
    /// Some shape, group or part.
    Thing,
}

impl Kind {
    /// What it is for. A part is a group.
    pub fn category(self) -> Category {
        match self {
            Kind::BuiltIn(kind) => kind.get().category,
            Kind::Part(_) => Category::Group,
            Kind::Material => Category::Material,
            Kind::Thing => Category::Shape,
        }
    }

    /// Whether it stands in a place of the scene and has bounds.
    pub fn is_placed(self) -> bool {
        matches!(self.category(), Category::Shape | Category::Group)
    }
}

impl Making {
    /// A thing with nothing given.
    pub fn of(kind: Kind) -> Making {
        Making { kind, given: FieldSet::default(), inside: None }
    }
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
        index < 64 && self.0 >> index & 1 == 1
    }

    /// Adds a field.
    pub fn insert(&mut self, index: usize) {
        self.0 |= 1 << index;
    }

    /// The fields in either.
    pub fn union(self, other: FieldSet) -> FieldSet {
        FieldSet(self.0 | other.0)
    }

    /// The fields in both.
    pub fn both(self, other: FieldSet) -> FieldSet {
        FieldSet(self.0 & other.0)
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
    /// A list of these.
    pub fn list(item: Type) -> Type {
        Type::List(Arc::new(item))
    }

    /// The type of a value that is one or the other: of the branches of an `if`, of the items of a list.
    pub fn join(&self, other: &Type) -> Option<Type> {
        Some(match (self, other) {
            (Type::Invalid, ty) | (ty, Type::Invalid) => ty.clone(),
            (Type::Scalar(a), Type::Scalar(b)) => Type::Scalar(a.join(*b)?),
            (Type::Tuple(m, a), Type::Tuple(n, b)) if m == n => Type::Tuple(*m, a.join(*b)?),
            (Type::List(a), Type::List(b)) => Type::list(a.join(b)?),
            (Type::Made(a), Type::Made(b)) => Type::Made(a.join(*b)?),
            (Type::Thing(a), Type::Thing(b)) => Type::Thing(a.join(*b)?),
            (Type::Color, Type::Texture) | (Type::Texture, Type::Color) => Type::Texture,
            (a, b) if a == b => a.clone(),
            _ => return None,
        })
    }

    /// As a message says it: `a length`.
    pub fn describe(&self) -> String {
        match self {
            Type::Invalid => "unknown".into(),
            Type::Scalar(Element::Zero | Element::Int) => "a number".into(),
            Type::Scalar(Element::Quantity(dim)) => dim.to_string(),
            Type::Tuple(count, element) => format!("{} {}", word(*count), plural(element.dim())),
            Type::Bool => "true or false".into(),
            Type::Text => "a text".into(),
            Type::Color => "a colour".into(),
            Type::Texture => "a texture".into(),
            Type::Transform => "a placement".into(),
            Type::Made(Making { kind: Kind::BuiltIn(kind), .. })
                if kind.get().category == Category::Material =>
            {
                format!("{} `{}`", article(*kind), kind.get().name)
            }
            Type::Made(Making { kind: Kind::BuiltIn(kind), .. }) => {
                format!("{} `{}` prototype", article(*kind), kind.get().name)
            }
            Type::Thing(Making { kind: Kind::BuiltIn(kind), .. }) => {
                format!("{} `{}` of the scene", article(*kind), kind.get().name)
            }
            Type::Made(Making { kind: Kind::Material, .. }) => "a material".into(),
            Type::Made(Making { kind: Kind::Part(_), .. }) => "a prototype of a part".into(),
            Type::Made(_) => "a prototype".into(),
            Type::Thing(_) => "a part of the scene".into(),
            Type::List(item) if **item == Type::Invalid => "an empty list".into(),
            Type::List(_) => "a list".into(),
            Type::Bounds => "bounds".into(),
            Type::Row(_) => "a row of a table".into(),
            Type::Part(_) => "a part".into(),
            Type::File(_) => "an imported file".into(),
            Type::Function(_) => "a function".into(),
        }
    }
}

impl Making {
    fn join(self, other: Making) -> Option<Making> {
        if self.kind == other.kind {
            let inside = self.inside.filter(|_| self.inside == other.inside);
            return Some(Making { kind: self.kind, given: self.given.both(other.given), inside });
        }
        let material = |kind: Kind| kind.category() == Category::Material;
        (material(self.kind) && material(other.kind)).then_some(Making::of(Kind::Material))
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
        FieldType::Text => "a text".into(),
        FieldType::Color => "a colour".into(),
        FieldType::Paint => "a colour or texture".into(),
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
