//! Doc comments: which belong to a statement.

use super::BLANKS;
use super::ast::Comment;
use super::build::Source;
use crate::span::Span;
use smol_str::SmolStr;

/// What may stand between items.
const SEPARATORS: [char; 2] = [',', ';'];

/// The doc of a statement: the `///` comments above it, and those between its prefixes and itself. `whole` begins
/// with the prefixes, `bare` without them.
///
/// A doc comment stands alone on its line. Between it and the statement there may be other comments and blank
/// lines, and nothing else. Commas and semicolons between items are as blank here as they are when the text is laid out.
pub(super) fn of(source: &Source, whole: Span, bare: Span) -> Option<SmolStr> {
    // Most texts have no comments worth looking for.
    let before = source.comments.partition_point(|comment| comment.span.start < bare.start);
    let mut lines = vec![];
    let mut at = whole.start as usize;
    for comment in source.comments[..before].iter().rev() {
        let Comment { span } = comment;
        if span.start < whole.start {
            let between = source.text.get(span.end as usize..at).unwrap_or("");
            if !between.bytes().all(|byte| byte.is_ascii_whitespace() || SEPARATORS.contains(&(byte as char)))
            {
                break;
            }
            at = span.start as usize;
        }
        lines.extend(line(source.text, *span));
    }
    lines.reverse();
    if lines.is_empty() { None } else { Some(SmolStr::new(lines.join("\n"))) }
}

/// Whether a statement without prefixes that begins here has a doc.
pub(super) fn any(source: &Source, start: usize) -> bool {
    let place = Span::new(source.id, start, start);
    of(source, place, place).is_some()
}

/// The words of a doc comment; none where it is another comment.
fn line(text: &str, span: Span) -> Option<&str> {
    let words = text[span.range()].strip_prefix("///").filter(|words| !words.starts_with('/'))?;
    let blank = |c: char| BLANKS.contains(&c) || SEPARATORS.contains(&c);
    let before = text[..span.start as usize].trim_end_matches(blank);
    let alone = before.is_empty() || before.ends_with(['\n', '\u{feff}']);
    alone.then(|| words.strip_prefix(' ').unwrap_or(words).trim_end())
}
