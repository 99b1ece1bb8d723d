//! The one test binary.

mod dump;
mod parse;
