//! The one binary of integration tests: what is seen from outside.

#![allow(clippy::unwrap_used)]

mod architecture;
mod command;
mod diagnostics;
mod documents;
mod dump;
mod folder;
mod language;
mod parse;
mod pictures;
mod scenes;
