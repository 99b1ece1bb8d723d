//! What a text declares.

use super::{Analysis, Symbol};

/// What the text declares, as a tree.
pub(super) fn symbols(_: &Analysis) -> Vec<Symbol> {
    vec![]
}
