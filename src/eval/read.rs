//! Reading values as the types that the schema promises.

use super::texture::Paint;
use super::value::{Made, ThingId, Value};
use crate::color::Rgb;
use crate::math::{DAffine3, DVec3};
use crate::schema::{self, Background, Filter, Tonemap, Typed};
use smol_str::SmolStr;
use std::rc::Rc;

/// A type of fields whose values can be read.
pub trait Read: Typed {
    /// What a reader gets.
    type Out;
    /// Reads a value of the type; none from [`Value::Invalid`].
    fn read(value: &Value) -> Option<Self::Out>;
}

/// What a camera looks at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Aim {
    /// A point, in metres.
    Point(DVec3),
    /// The middle of a thing.
    Thing(ThingId),
}

/// What a lens is focused on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Focus {
    /// A distance along the view, in metres.
    Distance(f64),
    /// A point or thing.
    Aim(Aim),
}

macro_rules! reads {
    ($($ty:ident as $out:ty: $pattern:pat => $value:expr;)*) => {
        $(impl Read for schema::$ty {
            type Out = $out;
            fn read(value: &Value) -> Option<$out> {
                match value { $pattern => $value, #[allow(unreachable_patterns)] _ => None }
            }
        })*
    };
}

reads! {
    Number as f64: Value::Number(x) => Some(*x);
    Length as f64: Value::Number(x) => Some(*x);
    Angle as f64: Value::Number(x) => Some(*x);
    Power as f64: Value::Number(x) => Some(*x);
    Radiance as f64: Value::Number(x) => Some(*x);
    Int as f64: Value::Number(x) => Some(*x);
    Bool as bool: Value::Bool(x) => Some(*x);
    Color as Rgb: Value::Color(color) => Some(*color);
    Paint as Paint: value => paint(value);
    Text as SmolStr: Value::Text(text) => Some(text.clone());
    Transform as DAffine3: Value::Transform(transform) => Some(**transform);
    Made as Rc<Made>: Value::Made(made) => Some(made.clone());
    LensPart as Rc<Made>: Value::Made(made) => Some(made.clone());
    CameraName as ThingId: Value::Thing(thing) => Some(thing.id);
    FilterWord as Filter: Value::Word(word) => Filter::from_word(word);
    BackgroundWord as Background: Value::Word(word) => Background::from_word(word);
    TonemapWord as Tonemap: Value::Word(word) => Tonemap::from_word(word);
    Point as DVec3: value => triple(value);
    Vector as DVec3: value => triple(value);
    Size as [u32; 2]: value => triple(value).map(|size| [size.x as u32, size.y as u32]);
    Aim as Aim: value => aim(value);
}

impl Read for schema::Focus {
    type Out = Focus;
    fn read(value: &Value) -> Option<Focus> {
        match value {
            Value::Number(distance) => Some(Focus::Distance(*distance)),
            value => aim(value).map(Focus::Aim),
        }
    }
}

impl Read for schema::Exposure {
    /// In stops; none is `auto`.
    type Out = Option<f64>;
    fn read(value: &Value) -> Option<Option<f64>> {
        match value {
            Value::Number(stops) => Some(Some(*stops)),
            Value::Word(_) => Some(None),
            _ => None,
        }
    }
}

/// A triple; a lone 0 is zero in every component.
fn triple(value: &Value) -> Option<DVec3> {
    match value {
        Value::Tuple(triple) => Some(*triple),
        Value::Number(0.0) => Some(DVec3::ZERO),
        _ => None,
    }
}

fn paint(value: &Value) -> Option<Paint> {
    match value {
        Value::Color(color) => Some(Paint::Plain(*color)),
        Value::Texture(texture) => Some(Paint::Texture(texture.clone())),
        _ => None,
    }
}

fn aim(value: &Value) -> Option<Aim> {
    match value {
        Value::Thing(thing) => Some(Aim::Thing(thing.id)),
        value => triple(value).map(Aim::Point),
    }
}
