//! The one binary of integration tests: what is seen from outside.

#![allow(clippy::unwrap_used)]

mod agreement;
mod architecture;
mod change;
mod command;
mod diagnostics;
mod documents;
mod editors;
mod folder;
mod language;
#[path = "../src/cli/lsp/document.rs"]
mod document;
mod dump;
mod edits;
mod expand;
mod export;
mod format;
mod halt;
mod fuzz;
mod ide;
#[path = "../fuzz/invariants.rs"]
mod invariants;
mod oracle;
mod parse;
mod pictures;
mod scenes;
#[path = "../fuzz/script.rs"]
mod script;
mod trust;
mod why;
mod work;
