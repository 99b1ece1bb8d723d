//! How types, values and fields are said in a few words.

use crate::check::{Declared, Function, Type, Way, describe_wanted};
use crate::color::{Rgb, encode_srgb};
use crate::eval::Seen;
use crate::math::DVec3;
use crate::schema::{Field, FieldType, Preset};
use crate::units::{self, Dim};

/// What holds when a field is not given.
pub fn default(field: &Field) -> String {
    match field.default {
        Preset::Required => "must be given".to_string(),
        Preset::Absent(words) => words.to_string(),
        Preset::Value(value) => format!("`{value}`"),
    }
}

/// What a field's value must lie in, as it goes on behind what the field wants; nothing where it may be anything.
pub fn range(field: &Field) -> String {
    let show = |x: f64| bound(x, field.ty);
    match (field.range.low, field.range.high, field.range.above) {
        (f64::NEG_INFINITY, f64::INFINITY, _) => String::new(),
        (low, f64::INFINITY, true) => format!(", above {}", show(low)),
        (low, f64::INFINITY, false) => format!(", {} or more", show(low)),
        (low, high, true) => format!(", above {} and at most {}", show(low), show(high)),
        (low, high, false) => format!(", from {} to {}", show(low), show(high)),
    }
}

/// A bound in the unit that a writer would use.
fn bound(x: f64, ty: FieldType) -> String {
    match ty {
        FieldType::Scalar(dim) if dim != units::NONE && x != 0.0 => {
            let unit = dim.example_unit();
            let factor = units::parse_unit(&unit).map_or(1.0, |unit| unit.factor);
            format!("{}{unit}", (x / factor * 1e6).round() / 1e6)
        }
        _ => x.to_string(),
    }
}

/// Text of several lines as one paragraph.
pub(super) fn paragraph(doc: &str) -> String {
    doc.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// A field with all there is to say of it, as Markdown.
pub(super) fn field(field: &Field) -> String {
    let wanted = describe_wanted(field.ty);
    format!("{}\n\nWants {wanted}{}; {}.", paragraph(field.doc), range(field), said_default(field))
}

fn said_default(field: &Field) -> String {
    match field.default {
        Preset::Required => default(field),
        Preset::Absent(_) | Preset::Value(_) => format!("if it is not given: {}", default(field)),
    }
}

/// A type as it is written where it has a name, else as messages say it.
pub(super) fn ty(ty: &Type) -> String {
    match ty {
        Type::Scalar(_)
        | Type::Tuple(..)
        | Type::Bool
        | Type::Text
        | Type::Color
        | Type::Texture
        | Type::Transform
        | Type::List(_) => match Declared::of(ty) {
            Some(declared) => declared.written(),
            None => ty.describe(),
        },
        _ => ty.describe(),
    }
}

/// A way to call a built-in function, with the types of what it takes and gives: `sin(angle) -> number`.
pub(super) fn way(function: Function, way: &Way) -> String {
    format!("{}({}) -> {}", function.name(), taken(function, way).join(", "), way.gives)
}

/// What is taken in one way to call a function, as it stands in [`way`]. What is called as its type is not said twice, but where
/// the name is written.
pub(super) fn taken(function: Function, way: &Way) -> Vec<String> {
    let named = function == Function::Turn;
    let taken = way.takes.iter().map(|(name, ty)| match *name == *ty && !named || *name == "…" {
        true => name.to_string(),
        false => format!("{name}: {ty}"),
    });
    taken.collect()
}

/// All ways to call a built-in function, a line each.
pub(super) fn ways(function: Function) -> String {
    function.ways().iter().map(|found| way(function, found)).collect::<Vec<_>>().join("\n")
}

/// A value as the language writes it, in a unit that suits its size; none of what it has no writing for.
pub(super) fn value(seen: &Seen, ty: Option<&Type>) -> Option<String> {
    let dim = match ty {
        Some(Type::Scalar(element) | Type::Tuple(_, element)) => element.dim(),
        _ => units::NONE,
    };
    Some(match seen {
        Seen::Number(x) => quantity(*x, dim),
        Seen::Tuple(v) => {
            let (unit, factor) = unit(v.abs().max_element(), dim);
            let mut parts = vec![number(v.x / factor), number(v.y / factor)];
            if !matches!(ty, Some(Type::Tuple(2, _))) {
                parts.push(number(v.z / factor));
            }
            format!("({}){unit}", parts.join(", "))
        }
        Seen::Bool(value) => value.to_string(),
        Seen::Text(text) => format!("{text:?}"),
        // What is brighter than white is written in numbers; what is no mixture of the three, not at all.
        Seen::Color(color) if color.min_element() < 0.0 => return None,
        Seen::Color(color) if color.max_element() > 1.0 => {
            let channel = |x: f64| number((x * 1e3).round() / 1e3);
            format!("rgb({}, {}, {})", channel(color.x), channel(color.y), channel(color.z))
        }
        Seen::Color(color) => hex(displayed(*color)),
        Seen::List(1) => "1 item".into(),
        Seen::List(count) => format!("{count} items"),
    })
}

/// A quantity in base units, in a unit that suits its size.
pub(super) fn quantity(x: f64, dim: Dim) -> String {
    let (unit, factor) = unit(x.abs(), dim);
    format!("{}{unit}", number(x / factor))
}

/// The unit that suits a size, and how many base units it is.
fn unit(size: f64, dim: Dim) -> (String, f64) {
    const LENGTHS: &[(f64, &str)] =
        &[(1e3, "km"), (1.0, "m"), (0.1, "cm"), (1e-3, "mm"), (1e-6, "um"), (0.0, "nm")];
    const POWERS: &[(f64, &str)] = &[(1e4, "kW"), (0.1, "W"), (0.0, "mW")];
    let steps = match dim {
        units::LENGTH if size > 0.0 => LENGTHS,
        units::POWER if size > 0.0 => POWERS,
        _ => &[],
    };
    let chosen = steps.iter().find(|(least, _)| size >= *least).map(|(_, unit)| unit.to_string());
    let unit = chosen.unwrap_or_else(|| dim.example_unit());
    let factor = units::parse_unit(&unit).map_or(1.0, |unit| unit.factor);
    (unit, factor)
}

/// A number to six digits.
pub(super) fn number(x: f64) -> String {
    let short: f64 = format!("{x:.5e}").parse().unwrap_or(x);
    let size = short.abs();
    if short == 0.0 {
        "0".into()
    } else if (1e-4..1e9).contains(&size) {
        format!("{short}")
    } else {
        format!("{short:e}")
    }
}

/// A linear colour as it is displayed: each channel from 0 to 1. What is brighter than white keeps its hue.
pub(super) fn displayed(color: Rgb) -> [f64; 3] {
    let color = color / color.max_element().max(1.0);
    let shown = |x: f64| if x.is_finite() { encode_srgb(x.clamp(0.0, 1.0)) } else { 0.0 };
    let DVec3 { x, y, z } = color;
    [shown(x), shown(y), shown(z)]
}

/// A colour with `#`; display-referred, red, green and blue from 0 to 1.
pub fn hex(color: [f64; 3]) -> String {
    let [r, g, b] = color.map(|x| (x.clamp(0.0, 1.0) * 255.0).round() as u8);
    format!("#{r:02x}{g:02x}{b:02x}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::Element;

    #[test]
    fn quantities_are_said_in_a_unit_that_suits_them() {
        assert_eq!(quantity(0.1575, units::LENGTH), "15.75cm");
        assert_eq!(quantity(-0.035, units::LENGTH), "-35mm");
        assert_eq!(quantity(0.0, units::LENGTH), "0m");
        assert_eq!(quantity(1.0 / 3.0, units::NONE), "0.333333");
        let point = Type::Tuple(3, Element::Quantity(units::LENGTH));
        let written = value(&Seen::Tuple(DVec3::new(0.0, 0.03, -0.02)), Some(&point));
        assert_eq!(written.as_deref(), Some("(0, 30, -20)mm"));
    }

    #[test]
    fn what_is_brighter_than_white_keeps_its_hue_and_is_written_by_its_channels() {
        let color = |r, g, b| DVec3::new(r, g, b);
        assert_eq!(hex(displayed(color(2.0, 1.0, 0.0))), hex(displayed(color(1.0, 0.5, 0.0))));
        let written = |color| value(&Seen::Color(color), None);
        assert_eq!(written(color(2.0, 1.0, 0.0)).as_deref(), Some("rgb(2, 1, 0)"));
        assert_eq!(written(color(1.0, -0.1, 0.0)), None);
        assert_eq!(written(color(1.0, 0.0, 0.0)).as_deref(), Some("#ff0000"));
        assert_eq!(hex([-1.0, 2.0, f64::NAN]), "#00ff00");
    }
}
