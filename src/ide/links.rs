//! The files that a text names.

use super::{Analysis, Link};

/// The files that the text names.
pub(super) fn links(_: &Analysis) -> Vec<Link> {
    vec![]
}
