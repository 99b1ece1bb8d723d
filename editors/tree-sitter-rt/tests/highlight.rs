//! Which colours parts of a text get, in the form of `tree-sitter test`: a comment below a line names the capture at
//! its `^`, or with `<-` the one at its own column.

use crate::{files, here, parse, read};
use std::ops::Range;
use tree_sitter::{Language, Query, QueryCursor, StreamingIterator};

/// The capture of each place: that of the innermost node, and of several patterns the last.
struct Colours {
    /// Place, number of the pattern, name.
    found: Vec<(Range<usize>, usize, String)>,
}

impl Colours {
    fn of(text: &str) -> Colours {
        let language: Language = tree_sitter_rt::LANGUAGE.into();
        let query =
            Query::new(&language, tree_sitter_rt::HIGHLIGHTS_QUERY).expect("the query is well formed");
        let tree = parse(text);
        let mut cursor = QueryCursor::new();
        let mut captures = cursor.captures(&query, tree.root_node(), text.as_bytes());
        let mut found = vec![];
        while let Some((matched, index)) = captures.next() {
            let capture = matched.captures()[*index];
            let name = query.capture_names()[capture.index as usize].to_string();
            found.push((capture.node.byte_range(), matched.pattern_index, name));
        }
        Colours { found }
    }

    fn at(&self, place: usize) -> &str {
        let here = self.found.iter().filter(|(range, _, _)| range.contains(&place));
        here.min_by_key(|(range, pattern, _)| (range.len(), std::cmp::Reverse(*pattern)))
            .map_or("", |(_, _, name)| name)
    }
}

/// The claims of a file: a place, and the capture there.
fn claims(text: &str) -> Vec<(usize, &str)> {
    let (mut claims, mut line, mut at) = (vec![], 0, 0);
    for written in text.split_inclusive('\n') {
        let claim = written.trim_start().strip_prefix("//").map(str::trim_start);
        match claim.filter(|claim| claim.starts_with(['^', '<'])) {
            Some(claim) if claim.starts_with("<-") => {
                claims.push((line + written.find("//").unwrap_or(0), claim[2..].trim()));
            }
            Some(claim) => {
                let carets = written.match_indices('^').map(|(column, _)| line + column);
                claims.extend(carets.map(|place| (place, claim.trim_matches(['^', ' ', '\n']))));
            }
            None => line = at,
        }
        at += written.len();
    }
    claims
}

#[test]
fn parts_have_their_colours() {
    let (mut wrong, mut found) = (vec![], 0);
    for path in files(&here().join("test/highlight"), "rt") {
        let text = read(&path);
        let colours = Colours::of(&text);
        for (place, claim) in claims(&text) {
            found += 1;
            let line = text[..place].matches('\n').count() + 1;
            let column = place - text[..place].rfind('\n').map_or(0, |end| end + 1) + 1;
            let is = colours.at(place);
            if is != claim {
                wrong.push(format!("{}:{line}:{column}: `{is}`, not `{claim}`", path.display()));
            }
        }
    }
    assert!(found > 50, "{found} claims were found");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Whatever is written gets a colour, save white space.
#[test]
fn nothing_is_left_plain() {
    for path in files(&crate::repository().join("examples"), "rt") {
        let text = read(&path);
        let colours = Colours::of(&text);
        let plain =
            text.char_indices().find(|(place, c)| !c.is_whitespace() && colours.at(*place).is_empty());
        assert_eq!(plain, None, "{}", path.display());
    }
}
