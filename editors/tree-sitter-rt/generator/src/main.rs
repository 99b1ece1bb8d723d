//! Makes `src/parser.c` and what belongs to it from `grammar.js`, by node. With `--check` it only says whether that is
//! what stands there.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use tree_sitter_generate::{OptLevel, generate_parser_in_directory};

/// The version of the parser's form: the first that knows reserved words.
const ABI: usize = 15;

const MADE: &[&str] = &[
    "grammar.json",
    "node-types.json",
    "parser.c",
    "tree_sitter/alloc.h",
    "tree_sitter/array.h",
    "tree_sitter/parser.h",
];

fn main() -> ExitCode {
    let check = std::env::args().nth(1).is_some_and(|argument| argument == "--check");
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    match if check { compare(&folder) } else { make(&folder, folder.join("src")) } {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            eprintln!("{why}");
            ExitCode::FAILURE
        }
    }
}

fn make(folder: &Path, out: PathBuf) -> Result<(), String> {
    let mut told = vec![];
    let grammar = folder.join("grammar.js");
    let node = Some("node");
    let options = OptLevel::default();
    generate_parser_in_directory(folder, Some(out), Some(grammar), ABI, None, node, true, options, &mut told)
        .map_err(|error| error.to_string())?;
    if told.is_empty() { Ok(()) } else { Err(format!("{told:#?}")) }
}

fn compare(folder: &Path) -> Result<(), String> {
    let fresh = std::env::temp_dir().join(format!("tree-sitter-rt-{}", std::process::id()));
    make(folder, fresh.clone())?;
    let read = |path: PathBuf| std::fs::read(&path).map_err(|error| format!("{}: {error}", path.display()));
    let mut stale = vec![];
    for name in MADE {
        if read(folder.join("src").join(name))? != read(fresh.join(name))? {
            stale.push(*name);
        }
    }
    std::fs::remove_dir_all(&fresh).map_err(|error| error.to_string())?;
    if stale.is_empty() {
        Ok(())
    } else {
        Err(format!("stale: {}; run `cargo xtask grammar`", stale.join(", ")))
    }
}
