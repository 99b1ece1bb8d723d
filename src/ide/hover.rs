//! What is said of what stands at a place.

use super::{Analysis, Hover};

/// What can be said of what stands at a byte.
pub(super) fn hover(_: &Analysis, _: usize) -> Option<Hover> {
    None
}
