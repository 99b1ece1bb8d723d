//! Lines that can be hidden, and the layout of some of them.

use super::lex::{Lexeme, lex};
use super::{Analysis, Edit, Fold, FoldKind, Location};
use crate::span::Span;
use crate::syntax;
use std::ops::Range;

/// The bodies, comments and imports of more than one line, by where they begin.
pub(super) fn folds(analysis: &Analysis) -> Vec<Fold> {
    let text = &analysis.source().text;
    let mut found: Vec<(Range<usize>, FoldKind)> = vec![];
    let mut open: Vec<(u8, usize)> = vec![];
    // Lines of one sort below each other.
    let mut run: Option<(Range<usize>, FoldKind)> = None;
    let mut begins = true;
    for (lexeme, range) in lex(text, 0) {
        let sort = match lexeme {
            Lexeme::Comment if begins => Some(FoldKind::Comment),
            Lexeme::Word if begins && &text[range.clone()] == "import" => Some(FoldKind::Imports),
            _ => None,
        };
        if begins && lexeme != Lexeme::Line {
            match (&mut run, sort) {
                (Some((before, kind)), Some(sort))
                    if *kind == sort && is_next_line(text, before.end, range.start) =>
                {
                    before.end = range.end;
                }
                _ => {
                    found.extend(run.take());
                    run = sort.map(|sort| (range.clone(), sort));
                }
            }
        } else if let (Some((before, FoldKind::Imports)), false) = (&mut run, lexeme == Lexeme::Line) {
            before.end = range.end;
        }
        begins = lexeme == Lexeme::Line;
        let mark = text.as_bytes()[range.start];
        match (lexeme, mark) {
            (Lexeme::Mark, b'(' | b'[' | b'{') => open.push((mark, range.start)),
            (Lexeme::Mark, b')' | b']' | b'}') => {
                let opener = match mark {
                    b')' => b'(',
                    b']' => b'[',
                    _ => b'{',
                };
                if let Some(index) = open.iter().rposition(|(bracket, _)| *bracket == opener) {
                    found.push((open[index].1..range.end, FoldKind::Body));
                    open.truncate(index);
                }
            }
            _ => {}
        }
    }
    found.extend(run);
    found.retain(|(range, _)| text[range.clone()].contains('\n'));
    found.sort_by_key(|(range, _)| (range.start, std::cmp::Reverse(range.end)));
    let span = |range: Range<usize>| Span::new(analysis.main, range.start, range.end);
    found.into_iter().map(|(range, kind)| Fold { span: span(range), kind }).collect()
}

/// Whether nothing but one line end lies between two places.
fn is_next_line(text: &str, end: usize, start: usize) -> bool {
    let between = &text[end..start];
    between.bytes().all(|byte| byte.is_ascii_whitespace())
        && between.bytes().filter(|byte| *byte == b'\n').count() == 1
}

/// The edits that lay out a part of the text, line by line. A place without extent is in the part of the line it stands in.
pub(super) fn format(analysis: &Analysis, range: Range<usize>) -> Vec<Edit> {
    let source = analysis.source();
    let (formatted, _) = syntax::format(analysis.main, &source.text);
    let edit = |(place, text): (Range<usize>, String)| Edit {
        at: Location { path: source.path.clone(), range: place },
        text,
    };
    let end = range.end.max(range.start + 1);
    let touches = |place: &Range<usize>| match place.is_empty() {
        true => range.start <= place.start && place.start <= range.end,
        false => range.start < place.end && place.start < end,
    };
    let edits = differences(&source.text, &formatted).into_iter();
    edits.filter(|(place, _)| touches(place)).map(edit).collect()
}

/// Longer texts are laid out as one: to compare them takes time with the square of their length.
const MOST_LINES: usize = 20_000;

/// The runs of lines in which two texts differ: bytes of the first, and what the second has there.
fn differences(before: &str, after: &str) -> Vec<(Range<usize>, String)> {
    let (old, new): (Vec<&str>, Vec<&str>) =
        (before.split_inclusive('\n').collect(), after.split_inclusive('\n').collect());
    if old.len().max(new.len()) > MOST_LINES {
        return if before == after { vec![] } else { vec![(0..before.len(), after.to_string())] };
    }
    let starts: Vec<usize> = std::iter::once(0)
        .chain(old.iter().scan(0, |at, line| {
            *at += line.len();
            Some(*at)
        }))
        .collect();
    let diff = similar::capture_diff_slices(similar::Algorithm::Myers, &old, &new);
    let changed = diff.into_iter().filter(|change| change.tag() != similar::DiffTag::Equal);
    let mut found = vec![];
    for change in changed {
        let (from, to) = (change.old_range(), change.new_range());
        let (mut a, mut b) = (from.start, to.start);
        for (lines, others) in cuts(&old[from.clone()], &new[to.clone()]) {
            let (next, other) = (from.start + lines, to.start + others);
            if old[a..next] != new[b..other] {
                found.push((starts[a]..starts[next], new[b..other].concat()));
            }
            (a, b) = (next, other);
        }
    }
    found
}

/// Where two runs of lines can be cut, in lines of each, so that the pieces before a cut differ in spaces alone: who lays out
/// one statement does not mean the one below it. The last cut is the end of both.
fn cuts(old: &[&str], new: &[&str]) -> Vec<(usize, usize)> {
    // What is written, and where in it each line ends.
    let written = |lines: &[&str]| {
        let mut text = String::new();
        let mut ends = vec![];
        for line in lines {
            text.extend(line.chars().filter(|c| !c.is_whitespace()));
            ends.push(text.len());
        }
        (text, ends)
    };
    let ((before, ends), (after, others)) = (written(old), written(new));
    let same = before.bytes().zip(after.bytes()).take_while(|(a, b)| a == b).count();
    let mut cuts = vec![];
    for (line, &end) in ends.iter().enumerate().filter(|(_, end)| (1..=same).contains(*end)) {
        // Empty lines belong to what follows them.
        let is_first = line == 0 || ends[line - 1] < end;
        let other = others.partition_point(|&other| other < end);
        if is_first && others.get(other) == Some(&end) {
            cuts.push((line + 1, other + 1));
        }
    }
    if cuts.last() != Some(&(old.len(), new.len())) {
        cuts.push((old.len(), new.len()));
    }
    cuts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_are_cut_where_only_spaces_differ() {
        let pieces = |before: &str, after: &str| differences(before, after);
        let edit = |range: Range<usize>, text: &str| (range, text.to_string());
        assert_eq!(
            pieces("a{b}\nc{\nd }\n", "a { b }\nc { d }\n"),
            [edit(0..5, "a { b }\n"), edit(5..12, "c { d }\n")]
        );
        // What is said in other words is one piece to the end of its run.
        assert_eq!(
            pieces("a{b}\nc{d,}\ne{f}\n", "a { b }\nc { d }\ne { f }\n"),
            [edit(0..5, "a { b }\n"), edit(5..16, "c { d }\ne { f }\n")]
        );
        assert_eq!(pieces("a\n", "a\n"), []);
    }
}
