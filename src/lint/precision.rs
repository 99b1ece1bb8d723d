//! Things too small for where they are: W0609.

use super::{Lint, errors};
use crate::diagnostic::Code;
use crate::scene::{OriginId, Primitive};

/// The greatest ratio of sizes, and of a thing's coordinates to its size.
///
/// Tracing may be done with numbers of 24 bits, and must then still show the thing. At this ratio their spacing,
/// 2⁻²⁴ of the coordinate, is 6 % of the thing's size: its outline becomes coarse. On surfaces this many times larger
/// than the thing a ray's end is off by about 7e-8 of the surface's radius, 7 % of the thing.
pub const MOST_RATIO: f64 = 1e6;

/// W0609: a thing with bounds whose coordinates are more than [`MOST_RATIO`] times its size, or which is that much
/// smaller than the largest thing. Sizes are the longest edges of bounds. Exact; a thing is compared with the largest
/// one only, and the one most out of proportion is named for each of the two.
pub(super) fn look(lint: &mut Lint) {
    let mut largest: Option<(f64, OriginId)> = None;
    let mut smallest: Option<(f64, OriginId)> = None;
    let mut farthest: Option<(f64, OriginId)> = None;
    for Primitive { shape, origin, .. } in lint.scene.primitives.iter() {
        let Some(bounds) = shape.bounds() else { continue };
        let size = bounds.size().max_element();
        let ratio = bounds.min.abs().max(bounds.max.abs()).max_element() / size;
        keep(&mut largest, size, *origin, |new, old| new > old);
        keep(&mut smallest, size, *origin, |new, old| new < old);
        keep(&mut farthest, ratio, *origin, |new, old| new > old);
    }
    if let Some((ratio, origin)) = farthest.filter(|(ratio, _)| *ratio > MOST_RATIO)
        && lint.is_new(Code::W0609, origin)
    {
        let diagnostic = errors::too_far(lint, origin, ratio);
        lint.report(diagnostic);
    }
    let (Some((large, large_one)), Some((small, small_one))) = (largest, smallest) else { return };
    if large / small > MOST_RATIO && lint.is_new(Code::W0609, small_one) {
        let diagnostic = errors::too_small(lint, small_one, large_one, large / small);
        lint.report(diagnostic);
    }
}

fn keep(best: &mut Option<(f64, OriginId)>, value: f64, origin: OriginId, better: impl Fn(f64, f64) -> bool) {
    if best.is_none_or(|(known, _)| better(value, known)) {
        *best = Some((value, origin));
    }
}
