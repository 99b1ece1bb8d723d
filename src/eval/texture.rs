//! Textures as values.

use super::{Given, Value, errors};
use crate::check::{self, Function};
use crate::color::Rgb;
use crate::diagnostic::Diagnostic;
use crate::math::DVec3;
use crate::schema::textures;
use crate::span::Span;
use smol_str::SmolStr;
use std::rc::Rc;

/// The most textures within textures.
pub const MAX_TEXTURE_LEVELS: usize = 8;

/// One colour, or a texture.
#[derive(Clone, Debug, PartialEq)]
pub enum Paint {
    /// The same everywhere; linear.
    Plain(Rgb),
    /// By place.
    Texture(Rc<Texture>),
}

/// A colour by place, as it was written.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// What it is.
    pub pattern: Pattern,
    /// The two colours or textures that it is made of; none for a picture.
    pub parts: Option<[Given; 2]>,
    /// Of textures within it, itself included.
    levels: usize,
}

/// How a texture makes one colour of two, or finds its own. Lengths are in metres.
#[derive(Clone, Debug, PartialEq)]
pub enum Pattern {
    /// Cubes of this edge.
    Checker(f64),
    /// Layers of a width, across a direction of any length but 0.
    Stripes(f64, DVec3),
    /// Clouds of a size, so many octaves, and a seed.
    Noise(f64, u32, u64),
    /// A picture: its path as written, with its place, and the width of a copy.
    Image(SmolStr, Span, f64),
}

/// Makes the texture of a call. The arguments were checked, and are all there.
pub(super) fn make(
    function: Function,
    arguments: &[Value],
    spans: &[Span],
) -> Result<Value, Box<Diagnostic>> {
    let fields = check::texture_parameters(function).unwrap_or_default();
    for ((field, value), span) in fields.iter().zip(arguments).zip(spans) {
        if let Some(diagnostic) = errors::argument_out_of_range(field, value, *span) {
            return Err(Box::new(diagnostic));
        }
    }
    let pattern = match (function, arguments) {
        (Function::Image, [Value::Text(file), Value::Number(size)]) => {
            return Ok(texture(Pattern::Image(file.clone(), spans[0], *size), None, 1));
        }
        (Function::Checker, [_, _, Value::Number(size)]) => Pattern::Checker(*size),
        (Function::Stripes, [_, _, Value::Number(width), Value::Tuple(along)]) => {
            if *along == DVec3::ZERO {
                return Err(Box::new(errors::no_direction(&textures::STRIPES[3], spans[3])));
            }
            Pattern::Stripes(*width, *along)
        }
        (Function::Noise, [_, _, Value::Number(size), Value::Number(octaves), Value::Number(seed)]) => {
            Pattern::Noise(*size, *octaves as u32, *seed as u64)
        }
        _ => return Ok(Value::Invalid),
    };
    let part = |index: usize| Given { value: arguments[index].clone(), span: spans[index] };
    let levels = 1 + arguments.iter().map(levels).max().unwrap_or(0);
    if levels > MAX_TEXTURE_LEVELS {
        return Err(Box::new(errors::too_many_textures(spans[0])));
    }
    Ok(texture(pattern, Some([part(0), part(1)]), levels))
}

fn texture(pattern: Pattern, parts: Option<[Given; 2]>, levels: usize) -> Value {
    Value::Texture(Rc::new(Texture { pattern, parts, levels }))
}

fn levels(value: &Value) -> usize {
    match value {
        Value::Texture(texture) => texture.levels,
        _ => 0,
    }
}
