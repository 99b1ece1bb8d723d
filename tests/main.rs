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
mod dump;
mod expand;
mod export;
mod format;
mod fuzz;
#[path = "../fuzz/invariants.rs"]
mod invariants;
mod oracle;
mod parse;
mod pictures;
mod scenes;
mod why;
