//! Colours as they are written, and how another would be.

use super::walk::Piece;
use super::{Analysis, Colour, Stop, say};
use crate::check::{Function, Meaning};
use crate::color;
use crate::eval::Seen;
use crate::math::DVec3;
use crate::span::Span;
use crate::syntax::ast::{Argument, Expr, ExprKind};
use std::ops::Range;

/// The colours that are written in the text: with `#`, by a built-in name, or as numbers.
pub(super) fn colours(analysis: &Analysis, stop: Stop) -> Vec<Colour> {
    let mut found = vec![];
    let all = 0..analysis.source().text.len();
    analysis.walk_until(analysis.main, all, stop, &mut |piece| {
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
        found.extend(color.map(|color| Colour { span: expr.span, value: say::displayed(color) }));
    });
    // What is computed can be seen as well, where it is the value of a field or a definition.
    let computed = analysis.study.values.iter().filter_map(|(span, seen)| match seen {
        Seen::Color(color) if span.source == analysis.main => Some((*span, *color)),
        _ => None,
    });
    let blackbodies = computed.filter(|(span, _)| analysis.sources.text(*span).starts_with("blackbody("));
    found.extend(blackbodies.map(|(span, color)| Colour { span, value: say::displayed(color) }));
    found.sort_by_key(|colour| colour.span);
    found
}

/// The colour that a call with numbers gives.
fn called(function: Function, arguments: &[Argument]) -> Option<DVec3> {
    let [a, b, c] = arguments else { return None };
    let [a, b, c] = [number(&a.value)?, number(&b.value)?, number(&c.value)?];
    match function {
        Function::Rgb => Some(DVec3::new(a, b, c)),
        Function::Srgb => Some(color::srgb(a, b, c)),
        Function::Hsv => Some(color::hsv(a / (2.0 * crate::math::PI), b, c)),
        _ => None,
    }
}

/// A number that is written out, in base units.
fn number(value: &Expr) -> Option<f64> {
    match &value.kind {
        ExprKind::Number { value, .. } => Some(*value),
        ExprKind::Quantity { value, unit } => {
            crate::units::parse_unit(&unit.text).ok().map(|unit| value * unit.factor)
        }
        _ => None,
    }
}

/// The ways to write a colour in place of the one in a part of the text.
pub(super) fn present(analysis: &Analysis, range: Range<usize>, value: [f64; 3]) -> Vec<String> {
    let written = analysis.source().text.get(range.clone()).unwrap_or("");
    let place = Span::new(analysis.main, range.start, range.start);
    // What a file declares hides the built-in colour of that name.
    let is_hidden = |name: &str| {
        let mut seen = analysis.study.notes.scopes.iter().filter(|scope| scope.span.contains(place));
        seen.any(|scope| scope.names.iter().any(|(known, ..)| known == name))
    };
    let mut ways = ways(written, value);
    ways.retain(|way| color::named(way).is_none() || !is_hidden(way));
    ways
}

/// The ways to write a colour in place of the one that stands there as `written`.
fn ways(written: &str, value: [f64; 3]) -> Vec<String> {
    let value = value.map(|x| if x.is_finite() { x.clamp(0.0, 1.0) } else { 0.0 });
    let short = |x: f64| say::number((x * 1e4).round() / 1e4);
    let triple =
        |name: &str, v: [f64; 3]| format!("{name}({}, {}, {})", short(v[0]), short(v[1]), short(v[2]));
    let hex = say::hex(value);
    let named =
        color::NAMED.iter().find(|(_, digits)| hex[1..] == **digits).map(|(name, _)| name.to_string());
    let [hue, saturation, lightness] = hue_of(value);
    let hsv = format!(
        "hsv({}deg, {}, {})",
        say::number((hue * 10.0).round() / 10.0),
        short(saturation),
        short(lightness)
    );
    let mut ways = vec![hex, triple("srgb", value), triple("rgb", value.map(color::decode_srgb)), hsv];
    ways.extend(named);
    // Its own form begins alike.
    let own = |way: &String| match written.find('(') {
        Some(end) => way.starts_with(&written[..=end]),
        None => !way.contains('(') && way.starts_with('#') == written.starts_with('#'),
    };
    ways.sort_by_key(|way| !own(way));
    ways
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
        assert_eq!(ways("#fff", [1.0, 0.0, 0.0])[0], "#ff0000");
        assert_eq!(ways("srgb(1, 1, 1)", [1.0, 0.0, 0.0])[0], "srgb(1, 0, 0)");
        assert_eq!(ways("hsv(0deg, 0, 0)", [0.0, 1.0, 0.0])[0], "hsv(120deg, 1, 1)");
        assert_eq!(ways("blue", [1.0, 0.0, 0.0])[0], "red");
        assert_eq!(ways("", [f64::NAN, 2.0, -1.0])[0], "#00ff00");
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
