//! What `SECURITY.md` promises of the source as a whole, and that the tests it names are there.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The files of a folder that end in `.rs`, with what they hold but for their own tests.
fn sources(folder: &str) -> Vec<(String, String)> {
    let mut found = vec![];
    let mut folders = vec![root().join(folder)];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path: PathBuf = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                let text = fs::read_to_string(&path).unwrap();
                let code = text.split("\n#[cfg(test)]\nmod tests {").next().unwrap_or_default().to_string();
                found.push((path.strip_prefix(root()).unwrap().display().to_string(), code));
            }
        }
    }
    found
}

/// The files of the program that name one of these.
fn that_name(words: &[&str]) -> BTreeSet<String> {
    let names = |code: &str| words.iter().any(|word| code.contains(word));
    sources("src").into_iter().filter(|(_, code)| names(code)).map(|(path, _)| path).collect()
}

fn set<const N: usize>(paths: [&str; N]) -> BTreeSet<String> {
    paths.map(String::from).into()
}

#[test]
fn only_the_preview_has_sockets() {
    let words = ["TcpListener", "TcpStream", "UdpSocket", "UnixStream", "UnixListener", "tokio::net"];
    assert_eq!(that_name(&words), set(["src/cli/live/serve/mod.rs"]));
}

#[test]
fn only_flags_run_programs() {
    let words = ["Command::new(", "open::that", "open::with"];
    assert_eq!(
        that_name(&words),
        set([
            "src/cli/animate/video.rs",
            "src/cli/live/editor.rs",
            "src/cli/live/mod.rs",
            "src/cli/lsp/preview.rs"
        ])
    );
}

#[test]
fn the_compiler_forbids_unsafe_code() {
    for manifest in ["Cargo.toml", "xtask/Cargo.toml"] {
        let text = fs::read_to_string(root().join(manifest)).unwrap();
        assert!(text.lines().any(|line| line == "unsafe_code = \"forbid\""), "{manifest}");
    }
    // Elsewhere only the tests of the tree-sitter grammar need it, to reach what is generated in C.
    let others = ["fuzz/fuzz_targets", "editors/zed/src", "editors/tree-sitter-rt/bindings"];
    let found = others.iter().flat_map(|folder| sources(folder)).filter(|(_, code)| code.contains("unsafe"));
    let found: Vec<String> = found.map(|(path, _)| path).collect();
    assert_eq!(found, ["editors/tree-sitter-rt/bindings/rust/lib.rs"]);
}

#[test]
fn every_test_that_is_promised_is_there() {
    let text = fs::read_to_string(root().join("SECURITY.md")).unwrap();
    let named = text.split('`').skip(1).step_by(2);
    let names: BTreeSet<&str> = named
        .filter(|name| name.contains('_') && name.chars().all(|c| c.is_ascii_lowercase() || c == '_'))
        .collect();
    assert!(names.len() > 15, "{names:?}");
    let all: Vec<String> = [("src"), ("tests")].iter().flat_map(|folder| whole(folder)).collect();
    for name in names {
        let test = format!("#[test]\n    fn {name}(");
        let alone = format!("#[test]\nfn {name}(");
        assert!(
            all.iter().any(|code| code.contains(&test) || code.contains(&alone)),
            "there is no test `{name}`"
        );
    }
}

/// What the files of a folder hold, tests included.
fn whole(folder: &str) -> Vec<String> {
    sources(folder).into_iter().map(|(path, _)| fs::read_to_string(root().join(path)).unwrap()).collect()
}
