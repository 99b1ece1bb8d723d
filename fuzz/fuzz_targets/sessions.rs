//! Any session with the language server: see `src/cli/lsp/server/script.rs`.

#![no_main]

#[path = "../../src/cli/mod.rs"]
#[allow(dead_code, unused_imports)]
mod cli;

libfuzzer_sys::fuzz_target!(|script: &[u8]| cli::session::run(script));
