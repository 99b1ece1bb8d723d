//! The queries of every editor are understood: no node or field in them is unknown to the grammar.

use crate::{files, read, repository};
use tree_sitter::{Language, Query};

#[test]
fn every_query_of_every_editor_is_well_formed() {
    let language: Language = tree_sitter_rt::LANGUAGE.into();
    let queries = files(&repository().join("editors"), "scm");
    assert!(queries.len() > 15, "{} queries were found", queries.len());
    for path in queries {
        if let Err(error) = Query::new(&language, &read(&path)) {
            panic!("{}: {error}", path.display());
        }
    }
}
