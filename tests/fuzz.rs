//! Replays what fuzzing found, and the cases, from which it starts.

use crate::{invariants, script};
use std::path::Path;

/// Texts of a folder, at most so long: a bounded replay.
pub fn texts(folder: &str) -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let mut paths: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.is_file() && path.extension().is_none_or(|extension| extension == "rt"));
    paths.sort();
    let read = |path| String::from_utf8_lossy(&std::fs::read(path).unwrap()).into_owned();
    paths.into_iter().map(read).filter(|text| text.len() < 20_000).collect()
}

#[test]
fn found_texts_hold() {
    texts("fuzz/corpus/parse").iter().for_each(|text| invariants::parse(text));
    texts("fuzz/corpus/fmt").iter().for_each(|text| invariants::fmt(text));
    texts("fuzz/corpus/compile").iter().for_each(|text| invariants::compile(text));
    texts("fuzz/corpus/edits").iter().for_each(|text| invariants::ask(&script::run(text.as_bytes())));
}

#[test]
fn cases_hold() {
    for folder in ["tests/cases/syntax", "tests/cases/format", "tests/cases/diagnostics"] {
        for text in texts(folder) {
            invariants::parse(&text);
            invariants::fmt(&text);
        }
    }
}
