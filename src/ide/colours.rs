//! Colours as they are written, and how another would be.

use super::lex::split;
use super::walk::Piece;
use super::{Analysis, Colour, Stop, say};
use crate::check::{Function, Meaning};
use crate::color::{self, Rgb};
use crate::eval::Seen;
use crate::span::Span;
use crate::syntax::ast::{Argument, Expr, ExprKind};
use crate::units::{NONE, parse_unit};
use std::ops::Range;

/// The colours that are written in the text: with `#`, by a built-in name, or as numbers.
pub(super) fn colours(analysis: &Analysis, stop: Stop) -> Vec<Colour> {
    let all = 0..analysis.source().text.len();
    let mut found = written(analysis, all, stop);
    found.sort_by_key(|(span, _)| *span);
    found.into_iter().map(|(span, color)| Colour { span, value: say::displayed(color) }).collect()
}

/// The colours that are written in a part of the text, linear.
fn written(analysis: &Analysis, range: Range<usize>, stop: Stop) -> Vec<(Span, Rgb)> {
    let mut found = vec![];
    analysis.walk_until(analysis.main, range, stop, &mut |piece| {
        let Piece::Expr(expr) = piece else { return };
        let color = match &expr.kind {
            ExprKind::Color(digits) => color::from_hex(digits),
            ExprKind::Name(name) => match analysis.meaning(expr.span) {
                Some(Meaning::Color(_)) => color::named(name),
                _ => None,
            },
            ExprKind::Call { function, arguments } => match analysis.meaning(function.first.span) {
                Some(Meaning::Function(function)) => called(function, arguments),
                _ => None,
            },
            _ => None,
        };
        found.extend(color.map(|color| (expr.span, color)));
    });
    // What is computed can be seen as well, where it is the value of a field or a definition.
    let computed = analysis.study.values.iter().filter_map(|(span, seen)| match seen {
        Seen::Color(color) if span.source == analysis.main => Some((*span, *color)),
        _ => None,
    });
    found.extend(computed.filter(|(span, _)| analysis.sources.text(*span).starts_with("blackbody(")));
    found
}

/// The colour that a call with numbers gives.
fn called(function: Function, arguments: &[Argument]) -> Option<Rgb> {
    let [a, b, c] = arguments else { return None };
    let [a, b, c] = [number(&a.value)?, number(&b.value)?, number(&c.value)?];
    match function {
        Function::Rgb => Some(Rgb::new(a, b, c)),
        Function::Srgb => Some(color::srgb(a, b, c)),
        Function::Hsv => Some(color::hsv(a / (2.0 * crate::math::PI), b, c)),
        _ => None,
    }
}

/// A number that is written out, in base units.
fn number(value: &Expr) -> Option<f64> {
    match &value.kind {
        ExprKind::Number { value, .. } => Some(*value),
        ExprKind::Quantity { value, unit } => parse_unit(&unit.text).ok().map(|unit| value * unit.factor),
        _ => None,
    }
}

/// The ways to write a colour in place of the one in a part of the text.
pub(super) fn present(analysis: &Analysis, range: Range<usize>, value: [f64; 3]) -> Vec<String> {
    // A picker knows nothing brighter than white: what is brighter stays so by as much.
    let there = written(analysis, range.clone(), &|| false);
    let there = there.iter().find(|(span, _)| span.range() == range).map(|(_, color)| color.max_element());
    let scale = there.filter(|most| most.is_finite()).map_or(1.0, |most| most.max(1.0));
    let written = analysis.source().text.get(range.clone()).unwrap_or("");
    let place = Span::new(analysis.main, range.start, range.start);
    // What a file declares hides the built-in colour of that name.
    let is_hidden = |name: &str| {
        let mut seen = analysis.study.notes.scopes.iter().filter(|scope| scope.span.contains(place));
        seen.any(|scope| scope.names.iter().any(|(known, ..)| known == name))
    };
    let mut ways = ways(written, value, scale);
    ways.retain(|way| color::named(way).is_none() || !is_hidden(way));
    ways
}

/// The ways to write a colour in place of the one that stands there as `written`, so many times as bright. What is brighter
/// than white has one way only.
fn ways(written: &str, value: [f64; 3], scale: f64) -> Vec<String> {
    let value = value.map(|x| if x.is_finite() { x.clamp(0.0, 1.0) } else { 0.0 });
    let linear = value.map(|x| color::decode_srgb(x) * scale);
    if scale > 1.0 {
        return vec![call("rgb", linear, ["", "", ""], written)];
    }
    let hex = say::hex(value);
    let named =
        color::NAMED.iter().find(|(_, digits)| hex[1..] == **digits).map(|(name, _)| name.to_string());
    let [hue, saturation, lightness] = hue_of(value);
    let hsv = call("hsv", [hue.to_radians(), saturation, lightness], ["deg", "", ""], written);
    let mut ways = vec![
        hex,
        call("srgb", value, ["", "", ""], written),
        call("rgb", linear, ["", "", ""], written),
        hsv,
    ];
    ways.extend(named);
    // Its own form begins alike.
    let own = |way: &String| match written.find('(') {
        Some(end) => way.starts_with(&written[..=end]),
        None => !way.contains('(') && way.starts_with('#') == written.starts_with('#'),
    };
    ways.sort_by_key(|way| !own(way));
    ways
}

/// A call with these numbers, in base units: in the units in which what stands there calls the same, or in usual ones.
fn call(name: &str, values: [f64; 3], usual: [&'static str; 3], written: &str) -> String {
    let own = written.strip_prefix(name).and_then(|rest| rest.strip_prefix('(')?.strip_suffix(')'));
    let mut own = own.unwrap_or("").split(',').map(str::trim);
    let argument = |(value, usual): (f64, &'static str)| {
        let unit = own.next().and_then(|written| unit_of(written, usual)).unwrap_or(usual);
        let steps = match unit {
            "deg" => 10.0,
            "%" => 100.0,
            _ => 1e4,
        };
        let value = value / parse_unit(unit).map_or(1.0, |unit| unit.factor);
        format!("{}{unit}", say::number((value * steps).round() / steps))
    };
    let arguments: Vec<String> = values.into_iter().zip(usual).map(argument).collect();
    format!("{name}({})", arguments.join(", "))
}

/// The unit of a number that is written out, where it is of the same dimension as another.
fn unit_of<'w>(written: &'w str, other: &str) -> Option<&'w str> {
    let (number, unit) = split(written);
    let dim = |unit| parse_unit(unit).map_or(NONE, |unit| unit.dim);
    let is_known = unit.is_empty() || parse_unit(unit).is_ok();
    (!number.is_empty() && is_known && dim(unit) == dim(other)).then_some(unit)
}

/// Hue in degrees, saturation and value (Smith, "Color gamut transform pairs", SIGGRAPH 1978).
fn hue_of([r, g, b]: [f64; 3]) -> [f64; 3] {
    let (high, low) = (r.max(g).max(b), r.min(g).min(b));
    let range = high - low;
    if range <= 0.0 {
        return [0.0, 0.0, high];
    }
    let sixth = if high == r {
        (g - b) / range
    } else if high == g {
        2.0 + (b - r) / range
    } else {
        4.0 + (r - g) / range
    };
    let hue = 60.0 * if sixth < 0.0 { sixth + 6.0 } else { sixth };
    [hue, range / high, high]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_colour_is_written_in_its_own_form_first() {
        for (written, color, first) in [
            ("#fff", [1.0, 0.0, 0.0], "#ff0000"),
            ("srgb(1, 1, 1)", [1.0, 0.0, 0.0], "srgb(1, 0, 0)"),
            ("hsv(0deg, 0, 0)", [0.0, 1.0, 0.0], "hsv(120deg, 1, 1)"),
            ("hsv(.1turn, 50%, 1 )", [0.0, 0.6, 0.0], "hsv(0.3333turn, 100%, 0.6)"),
            // What is no angle is not taken for one.
            ("hsv(30, 0, 50mm)", [0.0, 1.0, 0.0], "hsv(120deg, 1, 1)"),
            ("rgb(100%, 0, x)", [0.0, 1.0, 1.0], "rgb(0%, 1, 1)"),
            ("blue", [1.0, 0.0, 0.0], "red"),
            ("", [f64::NAN, 2.0, -1.0], "#00ff00"),
        ] {
            assert_eq!(ways(written, color, 1.0)[0], first, "{written}");
        }
    }

    #[test]
    fn what_is_brighter_than_white_stays_so() {
        for color in [[2.0, 3.0, 4.0], [2e3, 3e3, 1e-3]] {
            // As far as an editor tells it.
            let shown = say::displayed(color.into()).map(|x| f64::from(x as f32));
            let [r, g, b] = color.map(say::number);
            assert_eq!(
                ways("rgb(0, 0, 0)", shown, color[0].max(color[2]).max(color[1])),
                [format!("rgb({r}, {g}, {b})")]
            );
        }
    }

    #[test]
    fn hues_read_back() {
        for color in [[0.2, 0.4, 0.9], [0.9, 0.1, 0.3], [0.3, 0.8, 0.3], [0.5, 0.5, 0.5], [0.0; 3]] {
            let [hue, saturation, value] = hue_of(color);
            let again = say::displayed(color::hsv(hue / 360.0, saturation, value));
            assert!(color.iter().zip(again).all(|(a, b)| (a - b).abs() < 1e-9), "{color:?} {again:?}");
        }
    }
}
