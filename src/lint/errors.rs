//! One function for each warning.

use super::{Lint, precision::MOST_RATIO};
use crate::diagnostic::{Code, Diagnostic};
use crate::scene::OriginId;
use crate::span::{SourceId, Span};

/// The beginning of the file, for what has no place.
pub(super) fn start() -> Span {
    Span::new(SourceId(0), 0, 0)
}

pub(super) fn camera_inside(lint: &Lint, solid: OriginId) -> Diagnostic {
    let message = "the camera is inside a solid, and sees only that";
    let place = lint.marks.from.or(lint.marks.camera);
    let place = place.or_else(|| lint.at(solid).map(|at| at.span)).unwrap_or_else(start);
    let diagnostic = Diagnostic::new(Code::W0601, message, place).at("inside");
    lint.label(diagnostic, solid, "this solid").help("move the camera out, or make the solid smaller")
}

pub(super) fn nothing_in_view(lint: &Lint) -> Diagnostic {
    let place = lint.marks.look.or(lint.marks.from).or(lint.marks.camera).unwrap_or_else(start);
    let diagnostic = Diagnostic::new(Code::W0602, "nothing of the scene is in view", place)
        .at("the picture shows only what is behind everything");
    let diagnostic = match lint.scene.primitives.first() {
        Some(first) => lint.label(diagnostic, first.origin, "not in view, like the others"),
        None => diagnostic,
    };
    diagnostic.help("turn the camera with `look`, move it with `from`, or leave both out to frame everything")
}

pub(super) fn dark(lint: &Lint, first: OriginId, others: &[OriginId]) -> Diagnostic {
    let message = "no light gives any light: the picture will be black";
    let mut diagnostic = lint.about(Code::W0603, message, first).at("gives nothing");
    // A few are enough to see what is meant.
    for other in others.iter().take(3) {
        diagnostic = lint.label(diagnostic, *other, "nor does this");
    }
    diagnostic.help("give a `power`, `radiance` or `irradiance` above 0, and a colour that is not black")
}

pub(super) fn sealed(lint: &Lint, lamp: OriginId, solid: OriginId) -> Diagnostic {
    let message = "this light is shut in by an opaque solid, and lights nothing else";
    let diagnostic = lint.about(Code::W0604, message, lamp).at("inside");
    let help = "move it out, make the solid of a `dielectric`, or make the solid itself glow";
    lint.label(diagnostic, solid, "this solid").help(help)
}

pub(super) fn overlap(lint: &Lint, later: OriginId, earlier: OriginId) -> Diagnostic {
    let message = "two dielectric solids overlap, and neither lies in the other";
    let diagnostic = lint.about(Code::W0605, message, later).at("fills the common part, as the later one");
    lint.label(diagnostic, earlier, "the other").help("draw them apart, or let one contain the other wholly")
}

pub(super) fn coincide(lint: &Lint, later: OriginId, earlier: OriginId, count: usize) -> Diagnostic {
    let message = match count {
        1 => "two surfaces lie in the same place".to_string(),
        2 => "two surfaces lie in the same place, and so does 1 more pair made here".to_string(),
        _ => format!("two surfaces lie in the same place, and so do {} more pairs made here", count - 1),
    };
    let diagnostic = lint.about(Code::W0606, message, later).at("which of the two is seen is left to chance");
    let help = "leave one of them out, or draw them apart by a little";
    lint.label(diagnostic, earlier, "the other").help(help)
}

pub(super) fn no_inside(lint: &Lint, origin: OriginId) -> Diagnostic {
    let message = "this dielectric is a surface without an inside";
    lint.about(Code::W0607, message, origin)
        .at("bends light once, and encloses no medium")
        .help("close it, as by a `height` without `open`; a thin pane is a `box`")
}

pub(super) fn focus_misses(lint: &Lint, nearest: Option<f64>) -> Diagnostic {
    let focus = lint.camera.focus;
    let message = format!("nothing in view is near the plane of focus, {} away", length(focus));
    let place = lint.marks.focus.or(lint.marks.camera).unwrap_or_else(start);
    let diagnostic = Diagnostic::new(Code::W0608, message, place).at("all is blurred");
    match nearest {
        Some(nearest) => diagnostic.help(format!(
            "the thing nearest to being sharp is {} away along the view: `focus: {}`, or name it",
            length(nearest),
            length(nearest)
        )),
        None => diagnostic.help("focus on what should be sharp: `focus: NAME`"),
    }
}

pub(super) fn too_far(lint: &Lint, origin: OriginId, ratio: f64) -> Diagnostic {
    // Nobody counts on beyond what a number holds.
    let ratio = ratio.min(f64::MAX);
    let message = format!(
        "this thing is {ratio:.0e} times its own size away from the origin, and more than {MOST_RATIO:.0e} is imprecise"
    );
    lint.about(Code::W0609, message, origin)
        .at("its shape may come out coarse")
        .help("move the scene to the origin, or check the units of its size and place")
}

pub(super) fn too_small(lint: &Lint, small: OriginId, large: OriginId, ratio: f64) -> Diagnostic {
    let message = format!(
        "these things differ in size by a factor of {ratio:.0e}, and more than {MOST_RATIO:.0e} is imprecise"
    );
    let diagnostic = lint.about(Code::W0609, message, small).at("the smallest");
    lint.label(diagnostic, large, "the largest").help("check the units of both; make the large one smaller")
}

/// A length of three digits, as the language writes it.
fn length(metres: f64) -> String {
    let rounded: f64 = format!("{metres:.2e}").parse().unwrap_or(metres);
    if (1e-3..1e6).contains(&rounded) { format!("{rounded}m") } else { format!("{rounded:e}m") }
}
