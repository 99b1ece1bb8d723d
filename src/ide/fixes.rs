//! Mends that need no thought.

use super::{Analysis, Fix};
use std::ops::Range;

/// What can be mended in a part of the text.
pub(super) fn fixes(_: &Analysis, _: Range<usize>) -> Vec<Fix> {
    vec![]
}
