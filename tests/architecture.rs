//! The table of who may use whom. A newcomer reads it to know what a module cannot know.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Each module of the library with the modules it may use. `lib.rs` puts the stages together, and the binary
/// may use everything the library shows.
const EDGES: &[(&str, &[&str])] = &[
    ("span", &[]),
    ("source", &["span", "files"]),
    ("diagnostic", &["span"]),
    ("files", &["span", "diagnostic"]),
    ("stack", &[]),
    ("math", &[]),
    ("color", &["math"]),
    ("units", &["math"]),
    ("asset", &["math", "color", "units"]),
    ("schema", &["units"]),
    ("develop", &["color", "math", "schema"]),
    ("syntax", &["span", "diagnostic", "units"]),
    ("import", &["span", "source", "diagnostic", "files", "syntax"]),
    (
        "check",
        &["span", "source", "diagnostic", "files", "asset", "color", "units", "schema", "syntax", "import"],
    ),
    (
        "eval",
        &["span", "diagnostic", "math", "color", "units", "asset", "schema", "syntax", "check", "scene"],
    ),
    ("allow", &["span", "diagnostic", "check"]),
    ("scene", &["math", "color", "schema", "asset"]),
    (
        "lower",
        &["span", "source", "diagnostic", "files", "math", "color", "schema", "eval", "asset", "scene"],
    ),
    // Where pictures and meshes were read stands beside the scene.
    // What it writes is laid out as `rtc fmt` does.
    ("expand", &["span", "files", "math", "color", "syntax", "scene"]),
    ("export", &["asset", "math", "color", "scene"]),
    ("lint", &["span", "diagnostic", "math", "color", "eval", "scene", "lower"]),
    ("render", &["math", "color", "develop", "asset", "scene"]),
    // It compares numbers of pixels with each other.
    ("denoise", &[]),
    ("output", &["math", "color", "develop", "scene"]),
    // Exact sums are shown by the picture that they make.
    ("saved", &["color", "scene", "render", "output"]),
    ("explain", &["diagnostic"]),
    ("change", &["span", "color", "scene", "syntax"]),
    ("inventory", &["source", "schema", "check", "eval", "scene"]),
    ("mend", &["span", "diagnostic"]),
    // It is given what the stages learn of a text; for a text that is being typed it asks the first of them itself.
    (
        "ide",
        &[
            "span",
            "source",
            "diagnostic",
            "files",
            "math",
            "color",
            "units",
            "schema",
            "syntax",
            "import",
            "check",
            "eval",
            "scene",
            "stack",
        ],
    ),
    ("report", &["span", "source", "diagnostic", "explain"]),
    // Places tell apart what has one name.
    ("aov", &["span", "math", "scene", "output", "render", "why"]),
    // It names what the tracer found, by what lowering kept beside the scene.
    ("why", &["span", "source", "diagnostic", "color", "eval", "scene", "lower", "render"]),
];

#[test]
fn modules_use_only_what_they_may_know() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let allowed: BTreeMap<&str, &[&str]> = EDGES.iter().copied().collect();
    let mut wrong = vec![];
    let mut seen = BTreeSet::new();
    for file in rust_files(&root) {
        let relative = file.strip_prefix(&root).unwrap();
        let first = relative.components().next().unwrap().as_os_str().to_str().unwrap();
        let module = first.trim_end_matches(".rs");
        if ["lib", "main", "cli"].contains(&module) {
            continue;
        }
        seen.insert(module.to_string());
        let Some(allowed) = allowed.get(module) else {
            wrong.push(format!("{module} has no row in the table"));
            continue;
        };
        let text = std::fs::read_to_string(&file).unwrap();
        for used in uses(&text) {
            if used != module && !allowed.contains(&used.as_str()) {
                wrong.push(format!("{} uses crate::{used}", relative.display()));
            }
        }
    }
    let listed: BTreeSet<String> = EDGES.iter().map(|(module, _)| module.to_string()).collect();
    assert_eq!(seen, listed, "the table lists the modules there are");
    assert!(wrong.is_empty(), "not in the table of permitted edges:\n{}", wrong.join("\n"));
}

/// The modules that `crate::…` paths of a file begin with, in code, not in comments.
fn uses(text: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for line in text.lines() {
        let code = line.split("//").next().unwrap_or("");
        for part in code.split("crate::").skip(1) {
            let names = match part.strip_prefix('{') {
                Some(group) => group.split(',').collect(),
                None => vec![part],
            };
            for name in names {
                let name: String =
                    name.trim().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
                found.insert(name);
            }
        }
    }
    found.remove("");
    found
}

fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let mut files = vec![];
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files.extend(rust_files(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    files.sort();
    files
}
