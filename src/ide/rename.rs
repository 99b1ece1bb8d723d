//! Who uses a name, and giving it another.

use super::{Analysis, Edit, Location};
use crate::span::Span;

/// The name at a byte, if it can be renamed.
pub(super) fn renamable(_: &Analysis, _: usize) -> Option<Result<Span, String>> {
    None
}

/// Every place of `all` that means what stands at a byte of the text of `of`, by file and place, each once; the declaration too
/// where that is wanted. Those of `of` are looked through even where it is not among them.
pub fn references(all: &[&Analysis], of: &Analysis, at: usize, declaration: bool) -> Vec<Location> {
    let _ = (all, of, at, declaration);
    vec![]
}

/// The edits that give what stands at a byte of the text of `of` another name wherever `all` use it; a sentence that says
/// why not where the name cannot be, or would mean another thing somewhere.
pub fn rename(all: &[&Analysis], of: &Analysis, at: usize, name: &str) -> Result<Vec<Edit>, String> {
    let _ = (all, of, at, name);
    Err("nothing here has a name that can be changed".into())
}
