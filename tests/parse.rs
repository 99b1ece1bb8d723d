//! Text to tree: the cases of `cases/syntax`, and what must hold for any text.

use crate::dump;
use proptest::prelude::*;
use rt_lang::diagnostic::{Code, Diagnostic};
use rt_lang::span::SourceId;
use rt_lang::syntax::ast::{Entry, Expr, ExprKind, File};
use rt_lang::syntax::{parse, parse_expression};
use std::time::{Duration, Instant};

const SOURCE: SourceId = SourceId(0);

fn read(text: &str) -> (File, Vec<Diagnostic>) {
    parse(SOURCE, text)
}

#[test]
fn cases() {
    insta::with_settings!({ snapshot_path => "cases/syntax", prepend_module_to_snapshot => false, omit_expression => true }, {
        insta::glob!("cases/syntax/*.rt", |path| {
            let text = std::fs::read_to_string(path).unwrap();
            let (file, diagnostics) = read(&text);
            let long = text.len() > 1000 && text.lines().any(|line| line.len() > 1000);
            let mut shown = String::new();
            if !diagnostics.is_empty() && !long {
                shown += &format!("{text}\n---\n{}\n---\n", dump::diagnostics(&text, &diagnostics));
            } else if !diagnostics.is_empty() {
                shown += &format!("{}\n---\n", dump::diagnostics(&text, &diagnostics));
            }
            let tree = dump::tree(&text, &file);
            shown += if long { "(a long tree)" } else { &tree };
            insta::assert_snapshot!(shown);
        });
    });
}
