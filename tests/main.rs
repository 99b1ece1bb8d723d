//! The one test binary.

// A test that panics has said why.
#![allow(clippy::unwrap_used)]

mod dump;
mod parse;
