//! Numbers as texts that read back as the same numbers.

use crate::color::Rgb;
use crate::math::{DMat3, DVec3};

/// How many numbers on each side of a guess are tried.
const TRIES: usize = 64;

/// A number that a function takes to another, near a guess; the guess itself, if none is.
pub(super) fn preimage(wanted: f64, guess: f64, function: impl Fn(f64) -> f64) -> f64 {
    let up = std::iter::successors(Some(guess), |x| Some(x.next_up())).take(TRIES);
    let down = std::iter::successors(Some(guess), |x| Some(x.next_down())).take(TRIES);
    let mut near = up.zip(down).flat_map(|(above, below)| [above, below]);
    near.find(|x| function(*x) == wanted).unwrap_or(guess)
}

/// The field `at`, unless it is the default.
pub(super) fn at(p: DVec3) -> String {
    if p == DVec3::ZERO { String::new() } else { format!("at: {}m, ", triple(p)) }
}

pub(super) fn matrix(m: DMat3, origin: DVec3) -> String {
    let axes = [m.x_axis, m.y_axis, m.z_axis].map(triple).join(", ");
    format!("matrix({axes}, {}m)", triple(origin))
}

pub(super) fn rgb(color: Rgb) -> String {
    format!("rgb{}", triple(color))
}

pub(super) fn triple(v: DVec3) -> String {
    format!("({}, {}, {})", number(v.x), number(v.y), number(v.z))
}

/// The fewest digits that read back as the same number.
pub(super) fn number(x: f64) -> String {
    let text = format!("{x:?}");
    text.strip_suffix(".0").map_or(text.clone(), str::to_string)
}

/// A text as the language writes it.
pub(super) fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_no_more_digits_than_they_need() {
        for (x, text) in [(1.0, "1"), (-0.5, "-0.5"), (1e-7, "1e-7"), (0.1, "0.1"), (1e300, "1e300")] {
            assert_eq!(number(x), text);
        }
    }
}
