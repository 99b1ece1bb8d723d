//! The ranges around a place.

use super::Analysis;
use crate::span::Span;

/// The ranges around a byte, innermost first.
pub(super) fn selection(_: &Analysis, _: usize) -> Vec<Span> {
    vec![]
}
