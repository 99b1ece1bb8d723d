//! Texts and the trees they give, in the form of `tree-sitter test`. `INSTA_UPDATE=always cargo test -p tree-sitter-rt`
//! writes the trees anew.

use crate::{files, here, parse, read};

/// One text with its tree.
struct Case {
    name: String,
    text: String,
    tree: String,
}

/// The cases of a file: a name between two rules of `=`, the text, a rule of `-`, the tree.
fn cases(file: &str) -> Vec<Case> {
    let rule = |line: &str, sign: char| line.len() >= 3 && line.chars().all(|c| c == sign);
    let lines: Vec<&str> = file.lines().collect();
    let heads: Vec<usize> = (0..lines.len().saturating_sub(2))
        .filter(|&at| rule(lines[at], '=') && rule(lines[at + 2], '='))
        .collect();
    let ends = heads.iter().skip(1).copied().chain([lines.len()]);
    let case = |(&head, end): (&usize, usize)| {
        let body = &lines[head + 3..end];
        let between =
            body.iter().rposition(|line| rule(line, '-')).expect("a rule of - stands before the tree");
        let part = |lines: &[&str]| lines.join("\n").trim_matches('\n').to_string();
        Case { name: lines[head + 1].into(), text: part(&body[..between]), tree: part(&body[between + 1..]) }
    };
    heads.iter().zip(ends).map(case).collect()
}

/// A tree with a node a line.
fn laid_out(tree: &str) -> String {
    let (mut out, mut depth) = (String::new(), 0);
    for word in tree.split(' ') {
        let node = word.starts_with('(');
        if out.ends_with(':') {
            out.push(' ');
        } else if !out.is_empty() && (node || word.ends_with(':')) {
            out += &format!("\n{}", "  ".repeat(depth));
        } else if !out.is_empty() {
            out.push(' ');
        }
        out += word;
        depth += word.matches('(').count();
        depth -= word.matches(')').count();
    }
    out
}

#[test]
fn texts_give_their_trees() {
    let mut wrong = vec![];
    let mut found = 0;
    for path in files(&here().join("test/corpus"), "txt") {
        let file = read(&path);
        let mut fresh = String::new();
        for Case { name, text, tree } in cases(&file) {
            let parsed = laid_out(&parse(&text).root_node().to_sexp());
            if parsed != tree {
                wrong.push(format!("{}: {name}\n{text}\n---\n{parsed}\n", path.display()));
            }
            let rule = "=".repeat(80);
            fresh += &format!("{rule}\n{name}\n{rule}\n\n{text}\n\n---\n\n{parsed}\n\n");
            found += 1;
        }
        if std::env::var("INSTA_UPDATE").is_ok_and(|update| update == "always") {
            std::fs::write(&path, format!("{}\n", fresh.trim_end())).expect("the corpus is written");
            wrong.clear();
        }
    }
    assert!(found > 20, "{found} cases were found");
    assert!(wrong.is_empty(), "{} differ\n\n{}", wrong.len(), wrong.join("\n"));
}
