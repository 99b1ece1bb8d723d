//! What a text does not say and is known all the same.

use super::{Analysis, Hint};
use std::ops::Range;

/// The hints of a part of the text.
pub(super) fn hints(_: &Analysis, _: Range<usize>) -> Vec<Hint> {
    vec![]
}
