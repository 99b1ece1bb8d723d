//! Any script of edits: see `script.rs`.

#![no_main]

#[path = "../../src/cli/lsp/document.rs"]
#[allow(dead_code)]
mod document;
#[path = "../../tests/dump.rs"]
#[allow(dead_code)]
mod dump;
#[path = "../invariants.rs"]
#[allow(dead_code)]
mod invariants;
#[path = "../script.rs"]
mod script;

libfuzzer_sys::fuzz_target!(|script: &[u8]| invariants::ask(&script::run(script)));
