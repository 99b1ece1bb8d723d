//! What the call around the cursor takes.

use super::{Signature, Stop};
use crate::eval::Limits;
use crate::files::Files;
use crate::source::Source;

/// The ways to call or make what is being called or made around a byte of a text, which may be unfinished there.
pub fn signatures(
    files: &dyn Files,
    source: &Source,
    at: usize,
    limits: &Limits,
    stop: Stop,
) -> Vec<Signature> {
    let _ = (files, source, at, limits, stop);
    vec![]
}
