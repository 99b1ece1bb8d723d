//! Tree to text: the one layout of a file.
//!
//! A body whose `{` ends its line has one entry a line, without commas; another body stays on its line if it fits
//! in [`WIDTH`] columns. Longer values are broken before operators and inside parentheses. Numbers, texts and
//! comments stay as they are written, and so does the group that a blank line sets off. Lines end as the first one does, and a
//! mark that tells the encoding stays. `print` makes a document of the tree and of the comments between its tokens, `doc` lays it
//! out.

mod doc;
mod print;

use super::ast::{Body, File};
use super::errors::Sink;
use super::{BLANKS, Limits, cut, lookalikes, parse};
use crate::diagnostic::Diagnostic;
use crate::span::{SourceId, Span};
use print::{Printer, Unit};
use std::ops::Range;

/// The widest line, in characters, where there is a choice.
pub const WIDTH: usize = 100;

/// Enough for the deepest tree.
const STACK: usize = 64 << 20;

/// Formats a text. Top-level items with a slip stay as they are, but for line ends; the slips are given beside the
/// text, with their places in the text as it was.
pub fn format(source: SourceId, text: &str) -> (String, Vec<Diagnostic>) {
    let work = || {
        let (file, slips) = parse(source, text);
        let formatted = as_begun(&print(&file, text, &slips), text);
        // What stands beside a broken item might decide how it is read.
        let kept = slips.is_empty() || {
            let (again, left) = parse(source, &formatted);
            is_alike(&slips, &left) && file.body.entries.len() == again.body.entries.len()
        };
        (if kept { formatted } else { text.to_string() }, slips)
    };
    std::thread::scope(|scope| {
        let thread = std::thread::Builder::new().stack_size(STACK);
        let handle = thread.spawn_scoped(scope, work).expect("the system has a thread to spare");
        handle.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    })
}

/// The text with the mark of its encoding and the line ends of another: those of its first line, where they are mixed.
fn as_begun(formatted: &str, text: &str) -> String {
    let mark = if cut::after_marks(text) > 0 { "\u{feff}" } else { "" };
    let returns = text.split_once('\n').is_some_and(|(line, _)| line.ends_with('\r'));
    let lines: Vec<&str> = formatted.split('\n').map(|line| line.trim_end_matches('\r')).collect();
    format!("{mark}{}", lines.join(if returns { "\r\n" } else { "\n" }))
}

fn is_alike(before: &[Diagnostic], after: &[Diagnostic]) -> bool {
    let said = |slip: &Diagnostic| (slip.code, slip.message.clone());
    before.iter().map(said).eq(after.iter().map(said))
}

fn print(file: &File, text: &str, slips: &[Diagnostic]) -> String {
    let broken = broken(file, text, slips);
    let mut printer = Printer::new(text, &file.comments);
    let docs = printer.file(&units(&file.body, &broken));
    doc::render(&docs, WIDTH)
}

/// What is printed as it stands: items with slips. A slip between two items concerns both.
fn broken(file: &File, text: &str, slips: &[Diagnostic]) -> Vec<Range<usize>> {
    if slips.is_empty() {
        return vec![];
    }
    let written = lookalikes::read(file.source, text, &mut Sink::default());
    let cut = cut::cut(file.source, &written.text, Limits::default().depth);
    let items: Vec<Range<usize>> = cut
        .items
        .iter()
        .map(|item| {
            text.floor_char_boundary(item.start)..text.ceil_char_boundary(item.start + item.text.len())
        })
        .collect();
    let mut ranges: Vec<Range<usize>> = vec![];
    // What a mend would change is part of the slip.
    let edits =
        |slip: &Diagnostic| slip.fix.iter().flat_map(|fix| &fix.edits).map(|(span, _)| *span).collect();
    let mut places: Vec<Range<usize>> = slips
        .iter()
        .flat_map(|slip| {
            let edits: Vec<Span> = edits(slip);
            slip.labels.iter().chain([&slip.primary]).map(|label| label.span).chain(edits)
        })
        // A closer that is overlooked is part of the slip that its opener is.
        .chain(cut.strays.iter().map(|stray| written.whole(stray.span, text)))
        .chain(cut.foreign.iter().map(|&place| written.whole(place, text)))
        .map(Span::range)
        .collect();
    places.sort_by_key(|place| place.start);
    for place in places {
        let first = items.partition_point(|item| item.end < place.start);
        let last = items.partition_point(|item| item.start <= place.end);
        let inside = items.get(first).is_some_and(|item| item.start <= place.start && place.end <= item.end);
        let (mut first, mut last) =
            if inside { (first, first + 1) } else { (first.saturating_sub(1), last + 1) };
        // At the beginning or the end of a line an operator would go on with the next one.
        let same_line = |a: &Range<usize>, b: &Range<usize>| !text[a.end..b.start].contains('\n');
        while first > 0 && items.get(first).is_some_and(|item| same_line(&items[first - 1], item)) {
            first -= 1;
        }
        while last < items.len() && same_line(&items[last - 1], &items[last]) {
            last += 1;
        }
        let start = items.get(first).map_or(place.start, |item| item.start.min(place.start));
        let end = items[..last.min(items.len())].last().map_or(place.end, |item| item.end.max(place.end));
        // A comment that is never closed is no item.
        let comment = file.comments.partition_point(|comment| comment.span.range().start <= place.start);
        let comment = file.comments[..comment].last().map_or(0, |comment| comment.span.range().end);
        let end = end.max(if place.start < comment { comment } else { 0 });
        let mut range = start..start.max(text[..end].trim_ascii_end().len());
        // How lines are indented against each other may decide how they are read.
        if text[range.clone()].contains('\n') {
            let before = text[..start].trim_end_matches(BLANKS);
            let is_first = before.len() <= cut::after_marks(text);
            range.start = if is_first || before.ends_with('\n') { before.len() } else { start };
        }
        match ranges.last_mut() {
            Some(before) if range.start < before.end => before.end = before.end.max(range.end),
            _ => ranges.push(range),
        }
    }
    ranges
}

/// The entries of a file and its broken items, in order.
fn units<'t>(body: &'t Body, broken: &[Range<usize>]) -> Vec<Unit<'t>> {
    let mut units: Vec<Unit> = body.entries.iter().map(Unit::Entry).collect();
    units.retain(|unit| {
        let before = broken.partition_point(|range| range.end <= unit.start());
        broken.get(before).is_none_or(|range| unit.start() < range.start)
    });
    units.extend(broken.iter().cloned().map(Unit::Verbatim));
    units.sort_by_key(Unit::start);
    units
}
