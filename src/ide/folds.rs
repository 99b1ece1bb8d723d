//! Lines that can be hidden, and the layout of some of them.

use super::{Analysis, Edit, Fold};
use std::ops::Range;

/// The bodies and comments of more than one line.
pub(super) fn folds(_: &Analysis) -> Vec<Fold> {
    vec![]
}

/// The edits that lay out a part of the text.
pub(super) fn format(_: &Analysis, _: Range<usize>) -> Vec<Edit> {
    vec![]
}
