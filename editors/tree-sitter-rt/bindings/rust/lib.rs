//! The grammar of `.rt` files for tree-sitter.
//!
//! Editors compile `src/parser.c` and `src/scanner.c` themselves; this crate is how the tests of the grammar reach it.

use tree_sitter_language::LanguageFn;

unsafe extern "C" {
    fn tree_sitter_rt() -> *const ();
}

/// The language, for `tree_sitter::Parser::set_language`.
///
/// The function behind it is the one that the parser's file defines under that name: it takes nothing and gives a
/// pointer to a table that is never freed.
pub const LANGUAGE: LanguageFn = unsafe { LanguageFn::from_raw(tree_sitter_rt) };

/// What colours each part of a text.
pub const HIGHLIGHTS_QUERY: &str = include_str!("../../queries/highlights.scm");

/// Where names are declared and used.
pub const LOCALS_QUERY: &str = include_str!("../../queries/locals.scm");

/// What is written in another language.
pub const INJECTIONS_QUERY: &str = include_str!("../../queries/injections.scm");
