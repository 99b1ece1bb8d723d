//! Text to tree.

pub mod ast;

/// The deepest nesting of brackets, and the deepest tree of an expression.
pub const MAX_DEPTH: usize = 512;
