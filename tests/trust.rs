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

/// Those of the library that name one of these, without the files that are tests alone.
fn of_library(words: &[&str]) -> BTreeSet<String> {
    let is_test = |path: &str| path.contains("/tests/") || path.ends_with("/tests.rs");
    let files = that_name(words).into_iter();
    files.filter(|path| !path.starts_with("src/cli/") && path != "src/main.rs" && !is_test(path)).collect()
}

#[test]
fn only_the_preview_has_sockets() {
    let words = [
        "TcpListener",
        "TcpStream",
        "TcpSocket",
        "UdpSocket",
        "unix::net",
        "tokio::net",
        "socket2::",
        "mio::",
    ];
    assert_eq!(that_name(&words), set(["src/cli/live/serve/mod.rs"]));
}

#[test]
fn the_library_knows_nothing_of_the_machine() {
    let environment = [
        "std::env",
        "env::var",
        "env::args",
        "env::current",
        "std::process",
        "std::os",
        "available_parallelism",
    ];
    let random = ["getrandom", "rand::", "RandomState", "DefaultHasher", "thread::current", "ThreadId"];
    let files = ["std::fs", "File::open", "stdin(", "stdout(", "stderr(", "println!", "std::net", "tempfile"];
    for words in [&environment[..], &random, &files, &["SystemTime", "UNIX_EPOCH"]] {
        assert_eq!(of_library(words), set([]), "{words:?}");
    }
    // How long a picture was traced for, which `--time` asks, and how long it was paused.
    assert_eq!(of_library(&["Instant"]), set(["src/render/control.rs", "src/render/making.rs"]));
}

#[test]
fn few_places_write_files() {
    let words = [
        "fs::write",
        "fs::copy",
        "fs::rename",
        "fs::remove",
        "fs::create",
        "fs::hard_link",
        "fs::set_permissions",
        "File::create",
        "OpenOptions",
        "NamedTempFile",
        "tempfile",
        "tempdir",
        "DirBuilder",
        "::symlink(",
    ];
    let places = set([
        // Whatever is made or changed, and moved to its place.
        "src/cli/target.rs",
        "src/cli/claim.rs",
        // What is removed when the process ends.
        "src/cli/interrupt.rs",
        // Films: a folder for frames, a file without a name for standard output, and samples of what is done.
        "src/cli/animate/orders.rs",
        "src/cli/animate/sink.rs",
        "src/cli/animate/mod.rs",
        // The secret of a preview, for the next run.
        "src/cli/live/serve/token.rs",
        // Folders that a flag names, and one among the temporary files.
        "src/cli/init.rs",
        "src/cli/manual.rs",
        "src/cli/lsp/pages.rs",
    ]);
    // Sessions of the language server are played by tests alone.
    let is_test = |path: &String| path.ends_with("/tests.rs") || path.ends_with("/script.rs");
    assert_eq!(that_name(&words).into_iter().filter(|path| !is_test(path)).collect::<BTreeSet<_>>(), places);
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

/// Whether a file is that of a module's tests: `src/cli/files.rs` and `src/asset/image/tests.rs` for `files` and `image`.
fn is_of(path: &str, module: &str) -> bool {
    [".rs", "/mod.rs", "/tests.rs"].iter().any(|end| path.ends_with(&format!("/{module}{end}")))
}

#[test]
fn every_test_that_is_promised_is_there() {
    let text = fs::read_to_string(root().join("SECURITY.md")).unwrap();
    let quoted = text.split('`').skip(1).step_by(2);
    let named: BTreeSet<(&str, &str)> = quoted.filter_map(|quoted| quoted.split_once("::")).collect();
    assert!(named.len() > 25, "{named:?}");
    let files: Vec<(String, String)> = ["src", "tests"].iter().flat_map(|folder| whole(folder)).collect();
    for (module, name) in named {
        let is_there = |code: &str| {
            ["", "    "].iter().any(|indent| code.contains(&format!("#[test]\n{indent}fn {name}(")))
        };
        let there: Vec<&String> = files
            .iter()
            .filter(|(path, code)| is_of(path, module) && is_there(code))
            .map(|(path, _)| path)
            .collect();
        assert!(there.len() == 1, "the test `{module}::{name}` is in {there:?}");
    }
}

/// The files of a folder with what they hold, tests included.
fn whole(folder: &str) -> Vec<(String, String)> {
    let whole = |(path, _): (String, String)| {
        let text = fs::read_to_string(root().join(&path)).unwrap();
        (path, text)
    };
    sources(folder).into_iter().map(whole).collect()
}
