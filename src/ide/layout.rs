//! What is different between two texts, and the layout of a part of one: where nothing changes, cursors and folds stay.

use super::{Analysis, Edit, Location};
use crate::syntax;
use std::ops::Range;

/// The edits that lay out a part of the text, line by line.
pub(super) fn format(analysis: &Analysis, range: Range<usize>) -> Vec<Edit> {
    let source = analysis.source();
    let (formatted, _) = syntax::format(analysis.main, &source.text);
    let edit = |(range, text): (Range<usize>, String)| Edit {
        at: Location { path: source.path.clone(), range },
        text,
    };
    differences_within(&source.text, &formatted, range).map(edit).collect()
}

/// The [`differences`] of two texts that are in a part of the first. A place without extent is in the part of the line it
/// stands in.
pub fn differences_within(
    before: &str,
    after: &str,
    range: Range<usize>,
) -> impl Iterator<Item = (Range<usize>, String)> {
    let end = range.end.max(range.start + 1);
    differences(before, after).into_iter().filter(move |(place, _)| match place.is_empty() {
        true => range.start <= place.start && place.start <= range.end,
        false => range.start < place.end && place.start < end,
    })
}

/// In longer texts it is not looked for what both have in common: that takes time with the square of their length.
const MOST_LINES: usize = 5_000;

/// The pieces of whole lines in which two texts differ, in order: bytes of the first, and what the second has there.
pub fn differences(before: &str, after: &str) -> Vec<(Range<usize>, String)> {
    let (old, new): (Vec<&str>, Vec<&str>) =
        (before.split_inclusive('\n').collect(), after.split_inclusive('\n').collect());
    let ends = old.iter().scan(0, |at, line| {
        *at += line.len();
        Some(*at)
    });
    let starts: Vec<usize> = std::iter::once(0).chain(ends).collect();
    let is_same = |(a, b): &(&&str, &&str)| a == b;
    let head = old.iter().zip(&new).take_while(is_same).count();
    let tail = old[head..].iter().rev().zip(new[head..].iter().rev()).take_while(is_same).count();
    let (old, new) = (&old[head..old.len() - tail], &new[head..new.len() - tail]);
    let mut found = vec![];
    for (lines, others) in runs(old, new) {
        let (mut a, mut b) = (lines.start, others.start);
        for (line, other) in cuts(&old[lines.clone()], &new[others.clone()]) {
            let (next, then) = (lines.start + line, others.start + other);
            if old[a..next] != new[b..then] {
                found.push((starts[head + a]..starts[head + next], new[b..then].concat()));
            }
            (a, b) = (next, then);
        }
    }
    found
}

/// The runs of lines that both do not have in common.
fn runs(old: &[&str], new: &[&str]) -> Vec<(Range<usize>, Range<usize>)> {
    if old.len().max(new.len()) > MOST_LINES {
        return vec![(0..old.len(), 0..new.len())];
    }
    let diff = similar::capture_diff_slices(similar::Algorithm::Myers, old, new);
    let changed = diff.into_iter().filter(|change| change.tag() != similar::DiffTag::Equal);
    changed.map(|change| (change.old_range(), change.new_range())).collect()
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
        let edit = |range: Range<usize>, text: &str| (range, text.to_string());
        assert_eq!(
            differences("a{b}\nc{\nd }\n", "a { b }\nc { d }\n"),
            [edit(0..5, "a { b }\n"), edit(5..12, "c { d }\n")]
        );
        // What is said in other words is one piece to the end of its run.
        assert_eq!(
            differences("a{b}\nc{d,}\ne{f}\n", "a { b }\nc { d }\ne { f }\n"),
            [edit(0..5, "a { b }\n"), edit(5..16, "c { d }\ne { f }\n")]
        );
        assert_eq!(differences("a\n", "a\n"), []);
    }

    fn applied(before: &str, edits: &[(Range<usize>, String)]) -> String {
        let mut text = before.to_string();
        edits.iter().rev().for_each(|(range, new)| text.replace_range(range.clone(), new));
        text
    }

    #[test]
    fn edits_make_one_text_of_another() {
        let texts = ["", "a\n", "a\nb\nc\n", "a\r\nb\rc\n", "b\nc", "a\n😀\nc\nd\n", "\n\n", "x"];
        for (before, after) in texts.iter().flat_map(|a| texts.iter().map(move |b| (a, b))) {
            let edits = differences(before, after);
            assert_eq!(applied(before, &edits), **after, "{before:?} {after:?}");
            assert!(before != after || edits.is_empty());
        }
        assert_eq!(differences("a\nb\nc\n", "a\nx\nc\n"), [(2..4, "x\n".to_string())]);
    }

    #[test]
    fn long_texts_are_cut_into_lines_too() {
        let lines = |line: &str| line.repeat(20_000);
        let (before, after) = (lines("a{b}\n") + "c,\nd\n", lines("a { b }\n") + "c\nd\n");
        let edits = differences(&before, &after);
        assert_eq!((edits.len(), applied(&before, &edits) == after), (20_001, true));
    }
}
