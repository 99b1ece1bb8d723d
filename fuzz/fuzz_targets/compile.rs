//! Any text: see `compile` in `invariants.rs`.

#![no_main]

#[path = "../../tests/dump.rs"]
#[allow(dead_code)]
mod dump;
#[path = "../invariants.rs"]
#[allow(dead_code)]
mod invariants;

libfuzzer_sys::fuzz_target!(|text: &str| invariants::compile(text));
