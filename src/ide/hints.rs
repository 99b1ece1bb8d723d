//! What a text does not say and is known all the same.

use super::walk::Piece;
use super::{Analysis, Hint, Stop, hover, optics, say};
use crate::check::Type;
use crate::math::atan2;
use crate::scene::{Camera, Projection};
use crate::schema::{camera, lens};
use crate::span::Span;
use crate::syntax::ast::{Expr, ExprKind, StatementKind};
use crate::units;
use std::collections::BTreeMap;
use std::ops::Range;

/// Width of the film that f-numbers are said for where no sensor is given: that of the default of `sensor`.
const FULL_FRAME: f64 = 0.036;

/// The hints of a part of the text, in its order; only some once `stop` says so.
pub(super) fn hints(analysis: &Analysis, range: Range<usize>, stop: Stop) -> Vec<Hint> {
    let mut found = vec![];
    analysis.walk_until(analysis.main, range.clone(), stop, &mut |piece| match piece {
        Piece::Field(field) => found.extend(value(analysis, &field.value)),
        Piece::Statement(statement) => {
            if let StatementKind::Definition { value: written, .. } = &statement.kind {
                found.extend(value(analysis, written));
            }
        }
        _ => {}
    });
    found.extend(of_cameras(analysis, stop));
    found.retain(|hint| range.start <= hint.at && hint.at <= range.end);
    found.sort_by_key(|hint| hint.at);
    found
}

/// What follows from the fields of cameras and lenses. Of what several cameras are made of only that is said which holds
/// for all of them.
fn of_cameras(analysis: &Analysis, stop: Stop) -> Vec<Hint> {
    let mut found: BTreeMap<usize, Option<Hint>> = BTreeMap::new();
    let here = analysis.study.views.iter().filter(|(_, place)| place.source == analysis.main);
    let beside = if here.clone().count() == 1 { optics::beside(analysis) } else { None };
    for (seen, place) in here.take_while(|_| !stop()) {
        for hint in camera_hints(analysis, optics::places(analysis, *place, beside), seen) {
            let known = found.entry(hint.at).or_insert_with(|| Some(hint.clone()));
            known.take_if(|known| *known != hint);
        }
    }
    found.into_values().flatten().collect()
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

/// What follows from the fields of one camera and its lens.
fn camera_hints(analysis: &Analysis, places: optics::Places, seen: &Camera) -> Vec<Hint> {
    if seen.projection == Projection::Orthographic {
        return vec![];
    }
    let fov = 2.0 * atan2(seen.half_extent.x, 1.0);
    let place = |kind, index| places.get(&(kind, index)).copied();
    let mut found = vec![];
    let mut hint = |at: Option<Span>, text: String, about: &str| {
        let at = at.filter(|at| at.source == analysis.main);
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
