//! What a text does not say and is known all the same.

use super::walk::Piece;
use super::{Analysis, Hint, hover, say};
use crate::check::{Meaning, Type};
use crate::math::atan2;
use crate::scene::{Camera, Projection};
use crate::schema::{camera, lens};
use crate::span::Span;
use crate::syntax::ast::{Construct, Expr, ExprKind, StatementKind};
use crate::units;
use std::ops::Range;

/// Width of the film that f-numbers are said for where no sensor is given: that of the default of `sensor`.
const FULL_FRAME: f64 = 0.036;

/// The hints of a part of the text, in its order.
pub(super) fn hints(analysis: &Analysis, range: Range<usize>) -> Vec<Hint> {
    let mut found = vec![];
    analysis.walk(analysis.main, range.clone(), &mut |piece| match piece {
        Piece::Field(field) => found.extend(value(analysis, &field.value)),
        Piece::Statement(statement) => {
            if let StatementKind::Definition { value: written, .. } = &statement.kind {
                found.extend(value(analysis, written));
            }
        }
        Piece::Construct(construct) => {
            let cameras = analysis.study.cameras.iter();
            if let Some((seen, _)) = cameras.into_iter().find(|(_, place)| *place == construct.span) {
                found.extend(camera_hints(analysis, construct, seen));
            }
        }
        _ => {}
    });
    found.retain(|hint| range.start <= hint.at && hint.at <= range.end);
    found.sort_by_key(|hint| hint.at);
    found
}

/// What a computed expression comes to.
fn value(analysis: &Analysis, written: &Expr) -> Option<Hint> {
    let ty = analysis.study.notes.type_of(written.span);
    // A name says what it is, and a colour or text is shown as such.
    let computed = !matches!(written.kind, ExprKind::Name(_) | ExprKind::Member { .. } | ExprKind::If { .. });
    let shown = matches!(ty, Some(Type::Scalar(_) | Type::Tuple(..)));
    let value = hover::value(analysis, written.span).filter(|_| computed && shown)?;
    let about = "what it comes to; in a loop or a part, the first time".into();
    Some(Hint { at: written.span.range().end, text: format!(" = {value}"), about })
}

/// What follows from the fields of the camera and its lens.
fn camera_hints(analysis: &Analysis, construct: &Construct, seen: &Camera) -> Vec<Hint> {
    if seen.projection == Projection::Orthographic {
        return vec![];
    }
    let fov = 2.0 * atan2(seen.half_extent.x, 1.0);
    let mut places = vec![];
    let body = construct.body.span.range();
    analysis.walk(analysis.main, body.clone(), &mut |piece| {
        let Piece::Field(field) = piece else { return };
        if let Some(Meaning::Field(kind, index)) = analysis.meaning(field.name.span) {
            places.push((kind, index, field.value.span));
        }
    });
    places.retain(|(_, _, span)| body.start <= span.range().start && span.range().end <= body.end);
    let place = |kind, index| -> Option<Span> {
        places.iter().find(|place| (place.0, place.1) == (kind, index)).map(|place| place.2)
    };
    let mut found = vec![];
    let mut hint = |at: Option<Span>, text: String, about: &str| {
        found.extend(at.map(|at| Hint { at: at.range().end, text, about: about.into() }));
    };
    let of_lens = |index| place(lens::KIND, index);
    let angle = format!(" fov {:.1}deg", fov.to_degrees());
    hint(of_lens(lens::FOCAL.index(lens::KIND)), angle, "the angle of view across the width");
    let focal = 0.5 * FULL_FRAME / seen.half_extent.x;
    if seen.lens_radius > 0.0 {
        let text = format!(" f/{:.1}, focal {}", focal / (2.0 * seen.lens_radius), millimetres(focal));
        let about = "the f-number and the focal length that would do the same before a sensor of 36mm";
        hint(of_lens(lens::APERTURE.index(lens::KIND)), text, about);
        let diameter = format!(" opening {}", millimetres(2.0 * seen.lens_radius));
        hint(of_lens(lens::STOP.index(lens::KIND)), diameter, "the diameter of the opening");
    }
    let focus = of_lens(lens::FOCUS.index(lens::KIND)).filter(|_| seen.lens_radius > 0.0);
    // A distance that is computed is said as such.
    let focus = focus.filter(|place| hover::value(analysis, *place).is_none());
    let distance = format!(" at {}", say::quantity(seen.focus, units::LENGTH));
    hint(focus, distance, "the distance along the view that is sharp");
    let as_focal = format!(" as {}", millimetres(focal));
    let fov_place = place(camera::KIND, camera::FOV.index(camera::KIND));
    hint(fov_place, as_focal, "the focal length that gives this angle of view on a sensor of 36mm");
    found
}

/// A length as photographers say it.
fn millimetres(x: f64) -> String {
    format!("{}mm", say::number((x * 1e4).round() / 10.0))
}
