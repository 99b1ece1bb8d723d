//! What the words of a text are.

use super::{Analysis, Token};
use std::ops::Range;

/// What the words of a part of the text are.
pub(super) fn tokens(_: &Analysis, _: Range<usize>) -> Vec<Token> {
    vec![]
}
