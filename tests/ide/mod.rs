//! What an editor is told: `cases/ide/*.rt`, with the answers beside them.
//!
//! `$hover$` in a text stands for the cursor and names what is asked there; it is taken out before the text is read.
//! `$rename:NAME$` asks for the edits of a renaming. A first line `// ask: symbols, tokens` asks of the whole file.

mod allowed;
mod any;
mod large;
mod rename;
mod shown;
mod typed;

use crate::folder::Folder;
use rt_lang::files::FilePath;
use rt_lang::ide::Analysis;
use rt_lang::lower::Overrides;
use rt_lang::source::Source;
use rt_lang::{Options, analyse};
use std::path::Path;

/// The folder of the cases, whose files import each other.
fn root() -> Folder {
    Folder(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cases/ide"))
}

/// What a text means among the files of a folder.
fn analysed(files: &Folder, name: &str, text: &str) -> Analysis {
    let source = Source::new(name, text).at(FilePath::root(name));
    analyse(files, source, &options(), &|| false).unwrap()
}

/// What an editor asks for.
fn options() -> Options {
    let overrides = Overrides { every_camera: true, ..Overrides::default() };
    Options { overrides, ..Options::default() }
}

/// A text without its marks, and these: where each stands, and what it asks.
fn marks(marked: &str) -> (String, Vec<(usize, String)>) {
    let (mut text, mut marks) = (String::new(), vec![]);
    for (index, piece) in marked.split('$').enumerate() {
        match index % 2 {
            0 => text.push_str(piece),
            _ => marks.push((text.len(), piece.to_string())),
        }
    }
    (text, marks)
}

#[test]
fn questions_are_answered() {
    let mut settings = insta::Settings::clone_current();
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.set_snapshot_path("../cases/ide");
    settings.bind(|| {
        insta::glob!("..", "cases/ide/*.rt", |path| {
            let (text, marks) = marks(&std::fs::read_to_string(path).unwrap());
            let name = path.file_name().unwrap().to_str().unwrap();
            let analysis = analysed(&root(), name, &text);
            let mut shown = String::new();
            let whole = text.lines().next().and_then(|line| line.strip_prefix("// ask: "));
            for question in whole.unwrap_or_default().split(", ").filter(|question| !question.is_empty()) {
                shown.push_str(&format!("== {question}\n{}\n", shown::whole(&analysis, question)));
            }
            for (at, question) in marks {
                let (line, column) = analysis.source().line_column(at);
                shown.push_str(&format!(
                    "== {question} {line}:{column}\n{}\n",
                    shown::at(&analysis, at, &question)
                ));
            }
            insta::assert_snapshot!("answers", shown);
        });
    });
}
