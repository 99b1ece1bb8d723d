//! Where names are declared.

use super::{Analysis, Definition};

/// Where what is named at a byte is declared.
pub(super) fn definition(_: &Analysis, _: usize) -> Option<Definition> {
    None
}
