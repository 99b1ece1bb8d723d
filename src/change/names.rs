//! What a person calls a change of a text: the names of what it lies in, such as `glass.ior`.

use crate::span::{SourceId, Span};
use crate::syntax::{
    self,
    ast::{Body, Construct, Entry, Expr, ExprKind, Path, Statement, StatementKind},
};
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::ops::Range;

/// Longer texts are not looked through: it would take longer than the change.
const LONGEST: usize = 1 << 20;
/// So many are named, at most.
const MOST: usize = 16;

/// The names of what is different between two texts: of a field, with what it belongs to; of things, each by its name or
/// kind. None where the difference lies between things, in comments or layout, or is too large to tell.
pub fn names(before: &str, after: &str) -> Vec<String> {
    if before.len().max(after.len()) > LONGEST {
        return vec![];
    }
    let (old, new) = (parts(before), parts(after));
    // What stands in both, wherever, is the same.
    let mut texts: BTreeMap<&str, usize> = BTreeMap::new();
    new.iter().for_each(|part| *texts.entry(part.text).or_default() += 1);
    let (kept, gone): (Vec<&Part>, Vec<&Part>) = old.iter().partition(|part| take(&mut texts, part.text));
    let mut texts: BTreeMap<&str, usize> = BTreeMap::new();
    kept.iter().for_each(|part| *texts.entry(part.text).or_default() += 1);
    let come = new.iter().filter(|part| !take(&mut texts, part.text));
    // Of the rest, what is called the same is the same thing, changed.
    let mut before: BTreeMap<Vec<String>, VecDeque<&Part>> = BTreeMap::new();
    gone.into_iter().for_each(|part| before.entry(part.whole()).or_default().push_back(part));
    let mut found = vec![];
    for new in come {
        let own = new.whole();
        match before.get_mut(&own).and_then(VecDeque::pop_front) {
            Some(old) => {
                let (gone, come) = differing(old.text, new.text);
                // What is gone has no name in the new text.
                found.extend(if come.is_empty() { old.named(&gone) } else { new.named(&come) });
            }
            None => found.extend(own),
        }
    }
    found
        .extend(before.into_iter().flat_map(|(own, parts)| parts.into_iter().flat_map(move |_| own.clone())));
    let mut named = BTreeSet::new();
    found.retain(|name| named.insert(name.clone()));
    found.truncate(MOST);
    found
}

/// Takes one of so many that are counted.
fn take<'t>(counts: &mut BTreeMap<&'t str, usize>, text: &'t str) -> bool {
    counts.get_mut(text).filter(|count| **count > 0).map(|count| *count -= 1).is_some()
}

/// An entry of a file with its text.
struct Part<'t> {
    entry: Entry,
    start: usize,
    text: &'t str,
}

fn parts(text: &str) -> Vec<Part<'_>> {
    let (file, _) = syntax::parse(SourceId(0), text);
    let part = |entry: Entry| {
        let range = place(&entry).range();
        Part { start: range.start, text: text.get(range).unwrap_or(""), entry }
    };
    file.body.entries.into_iter().map(part).collect()
}

fn place(entry: &Entry) -> Span {
    match entry {
        Entry::Field(field) => Span { end: field.value.span.end, ..field.name.span },
        Entry::Statement(statement) => statement.span,
        Entry::Rows(rows) => rows.span(),
        Entry::Broken(broken) => broken.span,
    }
}

impl Part<'_> {
    /// The names of what holds a range of its text.
    fn named(&self, range: &Range<usize>) -> Vec<String> {
        let mut found = vec![];
        entry(&self.entry, &(self.start + range.start..self.start + range.end), &mut vec![], &mut found);
        found
    }

    /// Its own name.
    fn whole(&self) -> Vec<String> {
        self.named(&(0..1))
    }
}

/// What is left of two texts without what they begin and end with in common.
fn differing(before: &str, after: &str) -> (Range<usize>, Range<usize>) {
    let start = before.bytes().zip(after.bytes()).take_while(|(a, b)| a == b).count();
    let rest = before.len().min(after.len()) - start;
    let ends = before.bytes().rev().zip(after.bytes().rev());
    let end = ends.take(rest).take_while(|(a, b)| a == b).count();
    (start..before.len() - end, start..after.len() - end)
}

/// Whether a place of the text has a part of the range, which may be empty.
fn touches(span: Span, range: &Range<usize>) -> bool {
    let (start, end) = (span.start as usize, span.end as usize);
    start < range.end.max(range.start + 1) && range.start < end
}

fn body<'a>(body: &'a Body, range: &Range<usize>, way: &mut Vec<&'a str>, found: &mut Vec<String>) {
    body.entries.iter().for_each(|inner| entry(inner, range, way, found));
}

fn entry<'a>(entry: &'a Entry, range: &Range<usize>, way: &mut Vec<&'a str>, found: &mut Vec<String>) {
    if !touches(place(entry), range) {
        return;
    }
    match entry {
        Entry::Field(field) => {
            within(&field.name.text, |way, found| expr(&field.value, range, way, found), way, found);
        }
        Entry::Statement(inner) => statement(inner, range, way, found),
        Entry::Broken(broken) => found.extend(broken.name.as_ref().map(|name| joined(way, &name.text))),
        Entry::Rows(_) => {}
    }
}

fn statement<'a>(
    statement: &'a Statement,
    range: &Range<usize>,
    way: &mut Vec<&'a str>,
    found: &mut Vec<String>,
) {
    match &statement.kind {
        StatementKind::Thing { name, construct: inner } => {
            let called = name.as_ref().map_or_else(|| last(&inner.kind), |name| &name.text);
            within(called, |way, found| construct(inner, range, way, found), way, found);
        }
        StatementKind::Definition { name, value, .. } => {
            within(&name.text, |way, found| expr(value, range, way, found), way, found);
        }
        StatementKind::Part { name, body: inner } => {
            within(&name.text, |way, found| body(inner, range, way, found), way, found);
        }
        StatementKind::Param { name, .. }
        | StatementKind::Import { name, .. }
        | StatementKind::Function { name, .. } => found.push(joined(way, &name.text)),
        StatementKind::For { body: inner, .. } => {
            within("for", |way, found| body(inner, range, way, found), way, found);
        }
        StatementKind::If { then, otherwise, .. } => {
            let both = |way: &mut Vec<&'a str>, found: &mut Vec<String>| {
                body(then, range, way, found);
                otherwise.iter().for_each(|inner| body(inner, range, way, found));
            };
            within("if", both, way, found);
        }
        StatementKind::Assert { .. } => {}
    }
}

/// Goes into something that has a name; where nothing in it has a name of its own, that is it.
fn within<'a>(
    name: &'a str,
    go: impl FnOnce(&mut Vec<&'a str>, &mut Vec<String>),
    way: &mut Vec<&'a str>,
    found: &mut Vec<String>,
) {
    let before = found.len();
    way.push(name);
    go(way, found);
    way.pop();
    if found.len() == before {
        found.push(joined(way, name));
    }
}

fn construct<'a>(
    construct: &'a Construct,
    range: &Range<usize>,
    way: &mut Vec<&'a str>,
    found: &mut Vec<String>,
) {
    // Its kind is it, as a whole.
    if construct.body.span.start as usize <= range.start {
        body(&construct.body, range, way, found);
    }
}

fn expr<'a>(value: &'a Expr, range: &Range<usize>, way: &mut Vec<&'a str>, found: &mut Vec<String>) {
    match &value.kind {
        ExprKind::Construct(inner) => construct(inner, range, way, found),
        ExprKind::Paren(inner) => expr(inner, range, way, found),
        _ => {}
    }
}

fn last(path: &Path) -> &str {
    path.rest.last().map_or(&path.first.text, |name| &name.text)
}

fn joined(way: &[&str], name: &str) -> String {
    let names: Vec<&str> =
        way.iter().copied().filter(|name| !["for", "if"].contains(name)).chain([name]).collect();
    names.join(".")
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "\
camera { from: (0, 1, 4)m }
material glass = dielectric { ior: 1.5 }
param count: int = 7 in 1 to 20
part lamp { sphere bulb { radius: 1cm, material: emitter { power: 5W } } }
for i in range(count) { sphere { radius: 1m * i } }
sphere { radius: 2m, at: (0, 1, 0)m } // a ball
";

    #[track_caller]
    fn changed(from: &str, to: &str) -> String {
        assert!(TEXT.contains(from), "{from}");
        names(TEXT, &TEXT.replacen(from, to, 1)).join(", ")
    }

    #[test]
    fn changes_are_called_by_what_they_lie_in() {
        assert_eq!(changed("1.5", "1.45"), "glass.ior");
        assert_eq!(changed("dielectric", "glass"), "glass");
        assert_eq!(changed("= 7", "= 8"), "count");
        assert_eq!(changed("5W", "15W"), "lamp.bulb.material.power");
        assert_eq!(changed("1m * i", "2m * i"), "sphere.radius");
        assert_eq!(changed("range(count)", "range(3)"), "for");
        assert_eq!(changed("(0, 1, 4)", "(0, 1, 40)"), "camera.from");
        assert_eq!(changed("radius: 2m, ", ""), "sphere.radius");
    }

    #[test]
    fn comments_and_layout_have_no_name() {
        assert_eq!(changed("// a ball", "// a round thing"), "");
        assert_eq!(changed("camera", "\n\ncamera"), "");
        // Beside another change they do not matter.
        let before = TEXT.replace("camera", "// A camera\ncamera");
        assert_eq!(names(&before, &TEXT.replace("1.5", "1.6")), ["glass.ior"]);
    }

    #[test]
    fn what_comes_and_goes_is_named() {
        assert_eq!(changed("sphere { radius: 2m, at: (0, 1, 0)m } ", ""), "sphere");
        assert_eq!(changed("param count", "plane floor {}\nparam count"), "floor");
        assert_eq!(names("", TEXT), ["camera", "glass", "count", "lamp", "for", "sphere"]);
    }

    #[test]
    fn only_what_changed_is_named_wherever_it_stands() {
        let with_clay = TEXT.replace("param count", "material clay = diffuse {}\nparam count");
        let moved = with_clay.replace("at: (0, 1, 0)m", "material: clay");
        assert_eq!(names(TEXT, &moved), ["clay", "sphere.material"]);
        let without =
            TEXT.replace("param count: int = 7 in 1 to 20\n", "").replace("range(count)", "range(7)");
        assert_eq!(names(TEXT, &without), ["for", "count"]);
        let lines: Vec<&str> = TEXT.lines().rev().collect();
        assert_eq!(names(TEXT, &lines.join("\n")), [""; 0], "in another order");
    }

    #[test]
    fn any_two_texts_may_come() {
        for (before, after) in [("", ""), ("é", "è"), ("sphere {", "sphere {}"), ("a", "aa"), ("}", "{")] {
            names(before, after);
        }
    }
}
