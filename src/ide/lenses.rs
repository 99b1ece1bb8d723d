//! Where something can be done with the picture.

use super::{Analysis, Lens};

/// Where something can be done with the picture.
pub(super) fn lenses(_: &Analysis) -> Vec<Lens> {
    vec![]
}
