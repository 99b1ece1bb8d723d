//! What the documents say is true: their examples compile, and their tables are the compiler's own.
//! `INSTA_UPDATE=always cargo test` writes the tables anew.

use rt_lang::check::{self, Function};
use rt_lang::diagnostic::{Code, Severity};
use rt_lang::files::{FileError, FilePath, Files};
use rt_lang::schema::{Category, Field, FieldType, KINDS, KindId, PLACED};
use rt_lang::source::{Source, Sources};
use rt_lang::{Options, color, compile, ide, units};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn tables_of_the_reference_are_the_compilers_own() {
    let path = root().join("docs/reference.md");
    let written = std::fs::read_to_string(&path).unwrap();
    let mut fresh = written.clone();
    let tables = [
        ("units", units_table()),
        ("colours", colours()),
        ("functions", functions_table()),
        ("textures", textures_table()),
        ("placed", fields_table(PLACED.iter())),
        ("kinds", kinds()),
        ("codes", codes_table()),
    ];
    for (name, table) in tables {
        fresh = replace(&fresh, name, &table);
    }
    if std::env::var("INSTA_UPDATE").is_ok_and(|update| update == "always") {
        std::fs::write(&path, &fresh).unwrap();
    } else {
        assert!(
            fresh == written,
            "docs/reference.md is stale: run `INSTA_UPDATE=always cargo test --test main documents`"
        );
    }
}

/// Puts a table between its markers.
fn replace(text: &str, name: &str, table: &str) -> String {
    let begin = format!("<!-- {name} -->\n");
    let (before, rest) = text.split_once(&begin).unwrap_or_else(|| panic!("no marker for {name}"));
    let (_, after) = rest.split_once("<!-- end -->").unwrap();
    format!("{before}{begin}{table}<!-- end -->{after}")
}

fn units_table() -> String {
    let mut table = String::from("| what | units |\n|---|---|\n");
    for dim in [units::LENGTH, units::ANGLE, units::POWER, units::TEMPERATURE, units::NONE] {
        let names: Vec<String> = units::UNITS
            .iter()
            .filter(|(_, unit)| unit.dim == dim)
            .map(|(name, _)| format!("`{name}`"))
            .collect();
        let what = if dim == units::NONE { "a ratio".into() } else { dim.to_string() };
        writeln!(table, "| {what} | {} |", names.join(" ")).unwrap();
    }
    table
}

fn colours() -> String {
    let names: Vec<String> = color::NAMED.iter().map(|(name, hex)| format!("`{name}` (#{hex})")).collect();
    format!("{}.\n", names.join(", "))
}

fn functions_table() -> String {
    let mut table = String::from("| function | gives |\n|---|---|\n");
    for function in Function::ALL {
        writeln!(table, "| `{}` | {} |", function.signature(), function.doc()).unwrap();
    }
    table
}

fn textures_table() -> String {
    let mut text = String::new();
    for function in Function::ALL {
        let Some(parameters) = check::texture_parameters(*function) else { continue };
        let table = fields_table(parameters.iter()).replacen("field", "argument", 1);
        writeln!(text, "`{}`: {}\n\n{table}", function.signature(), function.doc()).unwrap();
    }
    text
}

fn codes_table() -> String {
    let mut table = String::from("| code | about |\n|---|---|\n");
    for code in Code::ALL {
        let kind = if code.severity() == Severity::Warning { " (warning)" } else { "" };
        writeln!(table, "| {} | {}{kind} |", code.as_str(), code.title()).unwrap();
    }
    table
}

fn kinds() -> String {
    let mut text = String::new();
    for (index, kind) in KINDS.iter().enumerate() {
        let category = match kind.category {
            Category::Shape => "shape",
            Category::Material => "material",
            Category::Light => "light",
            Category::Group => "group",
            Category::Block => "block",
        };
        writeln!(
            text,
            "### `{}`\n\n*{category}.* {}\n",
            kind.name,
            kind.doc.replace('\n', " ").replace("  ", " ")
        )
        .unwrap();
        let own = KindId(index as u8).get().fields;
        if !own.is_empty() {
            writeln!(text, "{}", fields_table(own.iter())).unwrap();
        }
        for field in own {
            words(&mut text, field.name, field.ty);
        }
    }
    text
}

fn words(text: &mut String, field: &str, ty: FieldType) {
    match ty {
        FieldType::Choice(words) => {
            writeln!(text, "`{field}` knows these words:\n").unwrap();
            for word in words {
                writeln!(text, "- `{}`: {}", word.name, word.doc).unwrap();
            }
            text.push('\n');
        }
        FieldType::OneOf(types) => types.iter().for_each(|ty| words(text, field, *ty)),
        _ => {}
    }
}

fn fields_table<'a>(fields: impl Iterator<Item = &'a Field>) -> String {
    let mut table = String::from("| field | wants | default | |\n|---|---|---|---|\n");
    for field in fields {
        let (default, range) = (ide::default(field), ide::range(field));
        let doc = field.doc.replace('\n', " ").replace("  ", " ");
        let wants = rt_lang::check::describe_wanted(field.ty);
        writeln!(table, "| `{}` | {wants}{range} | {default} | {doc} |", field.name).unwrap();
    }
    table
}

#[test]
fn every_example_in_the_documents_compiles() {
    let mut found = 0;
    for file in documents() {
        let text = std::fs::read_to_string(&file).unwrap();
        for (index, block) in text.split("```rt\n").skip(1).enumerate() {
            let block = block.split("```").next().unwrap();
            compiles(&format!("{} example {}", file.display(), index + 1), block);
            found += 1;
        }
    }
    assert!(found >= 4, "the documents have examples, {found} were found");
}

#[test]
fn every_scene_in_examples_compiles_without_a_warning() {
    let mut found = 0;
    for folder in ["examples", "examples/report"] {
        for entry in std::fs::read_dir(root().join(folder)).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|extension| extension == "rt") {
                compiles(&path.display().to_string(), &std::fs::read_to_string(&path).unwrap());
                found += 1;
            }
        }
    }
    assert!(found >= 10, "{found} examples were found");
}

#[test]
fn what_is_shown_is_laid_out() {
    let laid_out = |name: &str, text: &str| {
        let (formatted, _) = rt_lang::syntax::format(rt_lang::span::SourceId(0), text);
        assert_eq!(formatted, text, "{name}: `rtc fmt` lays it out otherwise");
    };
    let first = root().join("src/cli/init/scene.rt");
    laid_out("the scene of `rtc init`", &std::fs::read_to_string(first).unwrap());
    for file in documents() {
        let text = std::fs::read_to_string(&file).unwrap();
        for (index, block) in text.split("```rt\n").skip(1).enumerate() {
            let block = block.split("```").next().unwrap();
            laid_out(&format!("{} example {}", file.display(), index + 1), block);
        }
    }
}

/// Whatever picture an example names is there.
struct AnyPicture;

impl Files for AnyPicture {
    fn read(&self, path: &FilePath, _: usize) -> Result<Arc<[u8]>, FileError> {
        let picture = match path.as_str().rsplit_once('.') {
            Some((_, "png")) => "letter.png",
            Some((_, "hdr")) => "dusk.hdr",
            _ => return Err(FileError::Missing),
        };
        Ok(std::fs::read(root().join("tests/cases/pictures").join(picture)).unwrap().into())
    }
}

fn compiles(name: &str, text: &str) {
    let mut sources = Sources::default();
    let id = sources.add(Source::new(name, text));
    let compiled = compile(&AnyPicture, &mut sources, id, &Options::default());
    assert!(compiled.diagnostics.is_empty(), "{name}:\n{text}\n{:#?}", compiled.diagnostics);
    assert!(compiled.scene.is_some(), "{name}");
}

fn documents() -> Vec<PathBuf> {
    let docs = std::fs::read_dir(root().join("docs")).unwrap().map(|entry| entry.unwrap().path());
    let markdown = docs.filter(|path| path.extension().is_some_and(|extension| extension == "md"));
    [root().join("README.md")].into_iter().chain(markdown).collect()
}
