//! The built-in functions. Their arguments were checked.

use super::{Value, errors};
use crate::check::Function;
use crate::color;
use crate::diagnostic::Diagnostic;
use crate::math::{self, DAffine3, DMat3, DVec3, PI};
use crate::span::Span;
use std::rc::Rc;

/// What a function of numbers gives. It may not be finite; an error says why no number is the answer.
pub(super) fn compute(function: Function, numbers: &[f64]) -> Result<f64, &'static str> {
    use Function::*;
    Ok(match (function, numbers) {
        (Sin, [x]) => math::sin(*x),
        (Cos, [x]) => math::cos(*x),
        (Tan, [x]) => math::tan(*x),
        (Asin, [x]) if x.abs() <= 1.0 => math::asin(*x),
        (Acos, [x]) if x.abs() <= 1.0 => math::acos(*x),
        (Asin | Acos, _) => return Err("no angle has a sine or cosine beyond −1 and 1"),
        (Atan2, [y, x]) => math::atan2(*y, *x),
        (Sqrt, [x]) if *x >= 0.0 => x.sqrt(),
        (Sqrt, _) => return Err("no number has a negative square"),
        (Abs, [x]) => x.abs(),
        (Min, numbers) => numbers.iter().copied().fold(f64::INFINITY, f64::min),
        (Max, numbers) => numbers.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        (Clamp, [x, low, high]) if low <= high => x.clamp(*low, *high),
        (Clamp, _) => return Err("its `low` lies above its `high`"),
        (Mix, [a, b, t]) => a * (1.0 - t) + b * t,
        (Floor, [x]) => x.floor(),
        (Ceil, [x]) => x.ceil(),
        (Round, [x]) => x.round(),
        (Mod, [_, 0.0]) => return Err("there is no remainder of a division by 0"),
        (Mod, [a, b]) => {
            let remainder = a % b;
            if remainder != 0.0 && (remainder < 0.0) != (*b < 0.0) { remainder + b } else { remainder }
        }
        (Pow, [a, b]) => math::pow(*a, *b),
        (Exp, [x]) => math::exp(*x),
        (Log, [x]) if *x > 0.0 => math::ln(*x),
        (Log, _) => return Err("only numbers above 0 have a logarithm"),
        (Rand, numbers) => rand(numbers),
        // No other function gives a number for numbers: the checker knows.
        _ => f64::NAN,
    })
}

/// Calls any other function. The result may not be finite; an error says what no number can answer.
pub(super) fn call(
    function: Function,
    arguments: &[Value],
    span: impl Fn(usize) -> Span,
) -> Result<Value, Box<Diagnostic>> {
    use Function::*;
    use Value::{Color, Number, Tuple};
    let number = |x: f64| Ok(Number(x));
    let transform = |transform: DAffine3| Ok(Value::Transform(Rc::new(transform)));
    let wrong = |what: &str| Err(Box::new(errors::outside_domain(function, what, arguments, span(0))));
    match (function, arguments) {
        (Mix, [Tuple(a), Tuple(b), Number(t)]) => Ok(Tuple(*a * (1.0 - t) + *b * *t)),
        (Mix, [Color(a), Color(b), Number(t)]) => Ok(Color(*a * (1.0 - t) + *b * *t)),
        (Length, [Tuple(v)]) => number(length(*v)),
        (Length, [Value::List(list)]) => number(list.len() as f64),
        (Normalize, [Tuple(v)]) if *v != DVec3::ZERO => {
            // Scaled first, so that neither huge nor tiny components leave the numbers on the way.
            let scaled = *v / v.abs().max_element();
            Ok(Tuple(scaled / scaled.length()))
        }
        (Normalize, _) => wrong("a triple of length 0 has no direction"),
        (Dot, [Tuple(a), Tuple(b)]) => number(a.dot(*b)),
        (Cross, [Tuple(a), Tuple(b)]) => Ok(Tuple(a.cross(*b))),
        (Rgb, [Number(r), Number(g), Number(b)]) => Ok(Color(DVec3::new(*r, *g, *b))),
        (Srgb, [Number(r), Number(g), Number(b)]) => match [r, g, b].iter().all(|c| (0.0..=1.0).contains(*c))
        {
            true => Ok(Color(color::srgb(*r, *g, *b))),
            false => wrong("a display-referred channel lies between 0 and 1"),
        },
        (Hsv, [Number(h), Number(s), Number(v)]) => match [s, v].iter().all(|c| (0.0..=1.0).contains(*c)) {
            true => Ok(Color(color::hsv(h / (2.0 * PI), *s, *v))),
            false => wrong("saturation and value lie between 0 and 1"),
        },
        (Blackbody, [Number(kelvin)]) if (100.0..=1e9).contains(kelvin) => {
            Ok(Color(color::blackbody(*kelvin)))
        }
        (Blackbody, _) => wrong("a glowing body is between 100K and 1 000 000 000K hot"),
        (Checker | Stripes | Noise | Image, _) => {
            super::texture::make(function, arguments, &(0..arguments.len()).map(span).collect::<Vec<_>>())
        }
        (Scale, numbers) if numbers.iter().any(|x| as_number(x) == Some(0.0)) => {
            let zero = numbers.iter().position(|x| as_number(x) == Some(0.0)).unwrap_or(0);
            Err(Box::new(errors::scale_to_nothing(span(zero))))
        }
        (Scale, [Number(k)]) => transform(DAffine3::from_scale(DVec3::splat(*k))),
        (Scale, [Number(x), Number(y), Number(z)]) => transform(DAffine3::from_scale(DVec3::new(*x, *y, *z))),
        (Turn, [Number(axis), Number(angle)]) => {
            transform(DAffine3 { matrix3: turn(*axis as usize, *angle), translation: DVec3::ZERO })
        }
        (Move, [Number(x), Number(y), Number(z)]) => {
            transform(DAffine3::from_translation(DVec3::new(*x, *y, *z)))
        }
        (Move, [Tuple(v)]) => transform(DAffine3::from_translation(*v)),
        (Matrix, [Tuple(x), Tuple(y), Tuple(z), Tuple(origin)]) => {
            transform(DAffine3::from_cols(*x, *y, *z, *origin))
        }
        // Types were checked, so only what is invalid already comes here.
        _ => Ok(Value::Invalid),
    }
}

fn as_number(value: &Value) -> Option<f64> {
    match value {
        Value::Number(x) => Some(*x),
        _ => None,
    }
}

/// A number in [0, 1) that depends on the bits of these: each is mixed in by the finaliser of SplitMix64 (Steele,
/// Lea, Flood, 2014).
fn rand(numbers: &[f64]) -> f64 {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    for &number in numbers {
        // 0 and −0 are one number.
        state = mix_bits(state.wrapping_add((number + 0.0).to_bits()).wrapping_mul(0xd134_2543_de82_ef95));
    }
    (mix_bits(state) >> 11) as f64 / (1_u64 << 53) as f64
}

#[inline]
fn mix_bits(mut z: u64) -> u64 {
    z = z.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Length of a vector, also where its square would overflow.
fn length(v: DVec3) -> f64 {
    let greatest = v.abs().max_element();
    if greatest == 0.0 { 0.0 } else { greatest * (v / greatest).length() }
}

/// Rotation about an axis by the right-hand rule. Quarter turns are exact.
fn turn(axis: usize, angle: f64) -> DMat3 {
    let (sin, cos) = exact_quarter(angle).unwrap_or_else(|| (math::sin(angle), math::cos(angle)));
    let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut matrix = DMat3::IDENTITY;
    matrix.col_mut(i)[i] = cos;
    matrix.col_mut(i)[j] = sin;
    matrix.col_mut(j)[i] = -sin;
    matrix.col_mut(j)[j] = cos;
    matrix
}

/// Sine and cosine of a multiple of 90°, which radians cannot say exactly.
fn exact_quarter(angle: f64) -> Option<(f64, f64)> {
    let quarters = angle / (0.5 * PI);
    let nearest = quarters.round();
    if (quarters - nearest).abs() > 1e-14 * quarters.abs().max(1.0) {
        return None;
    }
    Some(match (nearest % 4.0 + 4.0) % 4.0 {
        0.0 => (0.0, 1.0),
        1.0 => (1.0, 0.0),
        2.0 => (0.0, -1.0),
        _ => (-1.0, 0.0),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turning_follows_the_right_hand() {
        let quarter = 0.5 * PI;
        assert_eq!(turn(2, quarter) * DVec3::X, DVec3::Y);
        assert_eq!(turn(0, quarter) * DVec3::Y, DVec3::Z);
        assert_eq!(turn(1, quarter) * DVec3::Z, DVec3::X);
        assert_eq!(turn(1, -quarter) * DVec3::X, DVec3::Z);
        let eighth = turn(2, 0.25 * PI) * DVec3::X;
        assert!((eighth - DVec3::new(0.5f64.sqrt(), 0.5f64.sqrt(), 0.0)).length() < 1e-15);
    }

    #[test]
    fn random_numbers_are_even_and_differ() {
        let numbers: Vec<f64> = (0..10_000).map(|i| rand(&[f64::from(i)])).collect();
        assert!(numbers.iter().all(|x| (0.0..1.0).contains(x)));
        let mean = numbers.iter().sum::<f64>() / 1e4;
        assert!((mean - 0.5).abs() < 0.01, "{mean}");
        assert_ne!(rand(&[1.0, 2.0]), rand(&[2.0, 1.0]));
        assert_eq!(rand(&[0.0]), rand(&[-0.0]));
    }

    #[test]
    fn the_remainder_has_the_sign_of_the_divisor() {
        for (a, b, wanted) in [(7.0, 3.0, 1.0), (-7.0, 3.0, 2.0), (7.0, -3.0, -2.0), (6.0, 3.0, 0.0)] {
            assert_eq!(compute(Function::Mod, &[a, b]), Ok(wanted));
        }
    }
}
