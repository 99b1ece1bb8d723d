//! What editors know of the language is the compiler's own: the lists of words in their files are made from the tables,
//! queries and settings that several have are made from one of them, and snippets are scenes.
//! `INSTA_UPDATE=always cargo test --test main editors` writes them anew.

use rt_lang::check::Function;
use rt_lang::files::{FileError, FilePath, Files};
use rt_lang::schema::{FieldType, KINDS, PLACED};
use rt_lang::source::{Source, Sources};
use rt_lang::{Options, color, compile, syntax, units};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

fn editors() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("editors")
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// What a file should hold: that is compared, or written.
fn settle(path: &Path, fresh: &str) {
    let held = std::fs::read_to_string(path).unwrap_or_default();
    if std::env::var("INSTA_UPDATE").is_ok_and(|update| update == "always") {
        if held != fresh {
            std::fs::write(path, fresh).unwrap();
        }
    } else {
        assert!(
            held == fresh,
            "{} is stale: run `INSTA_UPDATE=always cargo test --test main editors`",
            path.display()
        );
    }
}

// --- Lists of words ---------------------------------------------------------------------------------------------

/// The words that a list is made of.
fn words(list: &str) -> Vec<&'static str> {
    match list {
        "keywords" => syntax::RESERVED.to_vec(),
        "types" => syntax::TYPE_WORDS.to_vec(),
        "kinds" => KINDS.iter().map(|kind| kind.name).collect(),
        "functions" => Function::ALL.iter().map(|function| function.name()).collect(),
        "colours" => color::NAMED.iter().map(|(name, _)| *name).collect(),
        "units" => units::UNITS.iter().map(|(name, _)| *name).filter(|name| *name != "%").collect(),
        "words" => {
            let fields = KINDS.iter().flat_map(|kind| kind.fields).chain(PLACED);
            let found: BTreeSet<&str> = fields.flat_map(|field| choices(field.ty)).collect();
            found.into_iter().collect()
        }
        _ => panic!("no list is called {list}"),
    }
}

/// The bare words that a field understands.
fn choices(ty: FieldType) -> Vec<&'static str> {
    match ty {
        FieldType::Choice(words) => words.iter().map(|word| word.name).collect(),
        FieldType::OneOf(types) => types.iter().flat_map(|ty| choices(*ty)).collect(),
        _ => vec![],
    }
}

/// Makes the lists of a text anew: each stands on the line behind one that says `made from: LIST, between A and B, joined
/// by C`.
fn with_lists(text: &str) -> String {
    let mut out: Vec<String> = vec![];
    let mut made: Option<(String, String, String)> = None;
    for line in text.split('\n') {
        out.push(match made.take() {
            Some((before, after, list)) => {
                let start =
                    line.find(&before).unwrap_or_else(|| panic!("no {before} in {line}")) + before.len();
                let length = line[start..].find(&after).unwrap_or_else(|| panic!("no {after} in {line}"));
                format!("{}{list}{}", &line[..start], &line[start + length..])
            }
            None => line.into(),
        });
        made = line.split_once("made from: ").map(|(_, rest)| {
            // In JSON it is the value of a key.
            let rest =
                if line.trim_start().starts_with('"') { rest.trim_end_matches([',', '"']) } else { rest };
            let (list, rest) = rest.split_once(", between ").expect("the marker says between what");
            let (before, rest) = rest.split_once(" and ").expect("the marker says before what");
            let (after, joiner) =
                rest.split_once(", joined by ").expect("the marker says by what it is joined");
            (before.into(), after.into(), words(list).join(joiner))
        });
    }
    out.join("\n")
}

#[test]
fn lists_of_words_are_made_from_the_tables() {
    let files = [
        "emacs/rt-mode.el",
        "sublime/rt.sublime-syntax",
        "tree-sitter-rt/queries/highlights.scm",
        "vim/syntax/rt.vim",
        "vscode/syntaxes/rt.tmLanguage.json",
    ];
    for file in files {
        let path = editors().join(file);
        let held = read(&path);
        assert!(held.contains("made from: kinds"), "{file} lists the kinds");
        settle(&path, &with_lists(&held));
    }
}

// --- What several editors have ----------------------------------------------------------------------------------

/// What captures are called elsewhere, the longer names before those they begin with.
const HELIX: &[(&str, &str)] = &[
    ("@boolean", "@constant.builtin.boolean"),
    ("@comment.documentation", "@comment.block.documentation"),
    ("@function.call", "@function"),
    ("@keyword.conditional", "@keyword.control.conditional"),
    ("@keyword.import", "@keyword.control.import"),
    ("@keyword.repeat", "@keyword.control.repeat"),
    ("@module", "@namespace"),
    ("@number", "@constant.numeric"),
    ("@string.escape", "@constant.character.escape"),
    ("@variable.member", "@variable.other.member"),
    // Text objects
    ("@assignment.lhs", "@entry.inside"),
    ("@assignment.rhs", "@entry.inside"),
    ("@assignment.outer", "@entry.around"),
    (".inner", ".inside"),
    (".outer", ".around"),
];

const ZED: &[(&str, &str)] = &[
    ("@comment.documentation", "@comment.doc"),
    ("@constant.builtin", "@constant"),
    ("@function.call", "@function"),
    ("@module", "@namespace"),
    ("@variable.member", "@property"),
];

/// Lists are part of the queries, so they are made first.
fn query(name: &str, names: &[(&str, &str)]) -> String {
    let written = with_lists(&read(&editors().join("tree-sitter-rt/queries").join(name)));
    names.iter().fold(written, |text, (theirs, ours)| text.replace(theirs, ours))
}

#[test]
fn queries_of_editors_are_those_of_the_grammar() {
    let neovim = editors().join("nvim/queries/rt");
    for name in ["highlights", "locals", "folds", "indents", "injections", "textobjects"] {
        let name = format!("{name}.scm");
        settle(&neovim.join(&name), &query(&name, &[]));
    }
    for name in ["highlights.scm", "locals.scm", "injections.scm", "textobjects.scm"] {
        settle(&editors().join("helix/queries/rt").join(name), &query(name, HELIX));
    }
    for name in ["highlights.scm", "injections.scm"] {
        settle(&editors().join("zed/languages/rt").join(name), &query(name, ZED));
    }
}

#[test]
fn what_neovim_shares_with_vim_is_the_same() {
    for name in ["syntax/rt.vim", "indent/rt.vim", "compiler/rtc.vim"] {
        settle(&editors().join("nvim").join(name), &with_lists(&read(&editors().join("vim").join(name))));
    }
}

/// What `:helptags` makes: without it, nobody who puts the folder on the runtimepath by hand finds the help.
#[test]
fn help_of_neovim_is_found() {
    let folder = editors().join("nvim/doc");
    let text = read(&folder.join("rtc.txt"));
    let is_tag = |word: &&str| {
        word.len() > 2
            && word.starts_with('*')
            && word.ends_with('*')
            && !word[1..word.len() - 1].contains('*')
    };
    let tags: BTreeSet<&str> =
        text.split_whitespace().filter(is_tag).map(|tag| tag.trim_matches('*')).collect();
    assert!(tags.contains(":RtcPreview"));
    let line = |tag: &&str| format!("{tag}\trtc.txt\t/*{tag}*\n");
    settle(&folder.join("tags"), &tags.iter().map(line).collect::<String>());
}

// --- Snippets ---------------------------------------------------------------------------------------------------

/// A snippet as it is before anything is typed: each place holds its first choice.
fn typed(body: &str) -> String {
    let mut text = body.replace("$0", "");
    while let Some(start) = text.find("${") {
        let length = text[start..].find('}').expect("a place in a snippet ends");
        let (number, held) =
            text[start + 2..start + length].split_once([':', '|']).expect("a place holds something");
        let held = held.split([',', '|']).next().filter(|_| held.ends_with('|')).unwrap_or(held).to_string();
        let again = format!("${number}");
        text.replace_range(start..=start + length, &held);
        text = text.replace(&again, &held);
    }
    text
}

struct NoFiles;

impl Files for NoFiles {
    fn read(&self, _: &FilePath, _: usize) -> Result<Arc<[u8]>, FileError> {
        Err(FileError::Missing)
    }
}

#[test]
fn snippets_are_scenes() {
    let snippets: serde_json::Value =
        serde_json::from_str(&read(&editors().join("vscode/snippets/rt.json"))).unwrap();
    let snippets = snippets.as_object().unwrap();
    assert!(snippets.len() >= 10);
    for (name, snippet) in snippets {
        let lines = snippet["body"].as_array().unwrap().iter().map(|line| line.as_str().unwrap());
        let body = typed(&lines.collect::<Vec<_>>().join("\n"));
        let mut sources = Sources::default();
        let id = sources.add(Source::new(name, format!("{body}\nsphere {{ radius: 1m }}\n")));
        let compiled = compile(&NoFiles, &mut sources, id, &Options::default());
        let errors: Vec<_> =
            compiled.diagnostics.iter().filter(|found| found.code.as_str().starts_with('E')).collect();
        assert!(errors.is_empty(), "{name}:\n{body}\n{errors:#?}");
        let (laid_out, _) = syntax::format(rt_lang::span::SourceId(0), &body);
        assert_eq!(laid_out.trim_end(), body.trim_end(), "{name} is not laid out");
    }
}
