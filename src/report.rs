//! Diagnostics to text: for a person, through miette, which nothing else uses; and for programs, as JSON, SARIF and
//! GitHub's workflow commands.
//!
//! Sources may come from anywhere: a line is shown only around the place that is meant, however long it is,
//! control characters are shown as `�` so that no text can steer the terminal, and only so many diagnostics
//! are shown that the first of them is not swept away.

mod excerpt;
mod machine;
mod sarif;

use crate::diagnostic::{Diagnostic, Label, Severity, Use};
use crate::source::Sources;
use crate::span::{SourceId, Span};
use excerpt::Excerpt;
pub use machine::{SCHEMA, github, json, short};
use miette::{GraphicalReportHandler, GraphicalTheme, LabeledSpan, ThemeCharacters, ThemeStyles};
pub use sarif::Sarif;
use std::fmt;

/// The most diagnostics that [`all`] shows.
pub const MOST_SHOWN: usize = 50;

/// How the text looks.
#[derive(Clone, Copy, Debug)]
pub struct Style {
    /// Whether a terminal's colours are used.
    pub color: bool,
    /// Whether more than ASCII may be used to draw.
    pub unicode: bool,
    /// Columns of the terminal. Source lines are cut to fit; sentences are not broken.
    pub width: usize,
}

/// All diagnostics in the order of their places, errors before warnings where not all can be shown, and a
/// line with their count. Empty where there are none.
pub fn all(diagnostics: &[Diagnostic], sources: &Sources, style: Style) -> String {
    let mut shown: Vec<&Diagnostic> = diagnostics.iter().collect();
    shown.sort_by_key(|diagnostic| place(diagnostic));
    let repeated = drop_repeated(&mut shown);
    let worth = shown.len();
    shown.sort_by_key(|diagnostic| (diagnostic.severity(), place(diagnostic)));
    shown.truncate(MOST_SHOWN);
    shown.sort_by_key(|diagnostic| place(diagnostic));
    let mut text = String::new();
    for diagnostic in &shown {
        text.push_str(&human(diagnostic, sources, style));
        text.push('\n');
    }
    for (diagnostic, count) in repeated {
        let at = at(diagnostic.primary.span, sources);
        text.push_str(&format!("… {count} more of {} at {at}\n", diagnostic.code.as_str()));
    }
    if shown.len() < worth {
        text.push_str(&format!("… and {} more\n", worth - shown.len()));
    }
    if !shown.is_empty() {
        text.push_str(&format!("{} in {}\n", count(diagnostics), places(diagnostics, sources)));
    }
    text
}

/// The names of the sources that diagnostics are in: `a.rt`, `a.rt and b.rt`, `a.rt and 3 others`.
fn places(diagnostics: &[Diagnostic], sources: &Sources) -> String {
    let mut ids: Vec<SourceId> =
        diagnostics.iter().map(|diagnostic| diagnostic.primary.span.source).collect();
    ids.sort_unstable();
    ids.dedup();
    let mut names: Vec<String> = ids.into_iter().map(|id| printable(&sources.get(id).name)).collect();
    // Each setting is a source by itself.
    names.dedup();
    match names.as_slice() {
        [first, second] => format!("{first} and {second}"),
        [first, _, _, ..] => format!("{first} and {} others", names.len() - 1),
        names => names.concat(),
    }
}

/// How often one code is shown at one place: a slip in a loop has another value each turn.
const MOST_ALIKE: usize = 3;

/// Leaves the first few of those that share code and place, and gives one of each of the others with their count.
/// They come in the order of their places.
fn drop_repeated<'d>(shown: &mut Vec<&'d Diagnostic>) -> Vec<(&'d Diagnostic, usize)> {
    let mut dropped: Vec<(&Diagnostic, usize)> = vec![];
    let mut last = None;
    let mut alike = 0;
    shown.retain(|diagnostic| {
        let here = Some(place(diagnostic));
        alike = if here == last { alike + 1 } else { 1 };
        last = here;
        if alike > MOST_ALIKE {
            match dropped.last_mut() {
                Some((_, count)) if alike > MOST_ALIKE + 1 => *count += 1,
                _ => dropped.push((diagnostic, 1)),
            }
        }
        alike <= MOST_ALIKE
    });
    dropped
}

/// One diagnostic: code and message, the place with its labels, the help, and the uses that led there.
pub fn human(diagnostic: &Diagnostic, sources: &Sources, style: Style) -> String {
    let source = sources.get(diagnostic.primary.span.source);
    let (here, elsewhere): (Vec<&Label>, Vec<&Label>) = std::iter::once(&diagnostic.primary)
        .chain(&diagnostic.labels)
        .partition(|label| label.span.source == diagnostic.primary.span.source);
    let spans: Vec<Span> = here.iter().map(|label| label.span).collect();
    let excerpt = Excerpt::new(source, &spans, style.width);
    let labels = here.iter().zip(excerpt.ranges()).enumerate().map(|(index, (label, range))| {
        let text = (!label.text.is_empty()).then(|| sentence(&label.text));
        match index {
            0 => LabeledSpan::new_primary_with_span(text, range),
            _ => LabeledSpan::new_with_span(text, range),
        }
    });
    let shown = Shown {
        message: sentence(&diagnostic.message),
        severity: Some(diagnostic.severity()),
        labels: labels.collect(),
        help: diagnostic.help.as_deref().map(sentence),
        excerpt: &excerpt,
    };
    let mut text = String::new();
    let rendered = handler(diagnostic.code.as_str(), style).render_report(&mut text, &shown);
    // Writing to a string does not fail, and the excerpt has every place that a label names.
    debug_assert!(rendered.is_ok(), "a label outside the excerpt");
    // miette indents the first line by two columns.
    let mut text = text.trim_start().to_string();
    for label in elsewhere {
        text.push_str(&format!("  {}: {}\n", sentence(&label.text), at(label.span, sources)));
    }
    text.push_str(&uses(&diagnostic.uses, sources));
    text
}

/// What there is to say of a place that is no diagnostic: a sentence, the place with a label, and the uses that led there.
pub fn remark(message: &str, label: &Label, chain: &[Use], sources: &Sources, style: Style) -> String {
    let excerpt = Excerpt::new(sources.get(label.span.source), &[label.span], style.width);
    let said = (!label.text.is_empty()).then(|| sentence(&label.text));
    let labels = excerpt.ranges().map(|range| LabeledSpan::new_primary_with_span(said.clone(), range));
    let shown = Shown {
        message: sentence(message),
        severity: None,
        labels: labels.collect(),
        help: None,
        excerpt: &excerpt,
    };
    let mut text = String::new();
    let rendered = handler("", style).render_report(&mut text, &shown);
    debug_assert!(rendered.is_ok(), "a label outside the excerpt");
    text.trim_start().to_string() + &uses(chain, sources)
}

/// The most lines that a chain of uses takes; of a longer one, its ends are shown.
const MOST_USES: usize = 8;

/// The chain of uses, outermost first. A use within itself is one line.
fn uses(chain: &[Use], sources: &Sources) -> String {
    let mut runs: Vec<(&Use, usize)> = vec![];
    for used in chain {
        match runs.last_mut() {
            Some((last, count)) if *last == used => *count += 1,
            _ => runs.push((used, 1)),
        }
    }
    let line = |(Use { span, turn }, count): &(&Use, usize)| {
        let times = if *count > 1 { format!(", {count} levels") } else { String::new() };
        let turn = turn.as_ref().map_or(String::new(), |turn| format!(" at `{}`", sentence(turn)));
        format!("  in `{}`{turn}, {}{times}\n", head(sources.head(*span)), at(*span, sources))
    };
    if runs.len() <= MOST_USES {
        return runs.iter().map(line).collect();
    }
    let ends = (MOST_USES - 1) / 2;
    let (first, rest) = runs.split_at(MOST_USES - 1 - ends);
    let (middle, last) = rest.split_at(rest.len() - ends);
    let between = format!("  … {} more levels\n", middle.iter().map(|(_, count)| count).sum::<usize>());
    first.iter().map(line).chain([between]).chain(last.iter().map(line)).collect()
}

fn handler(code: &str, style: Style) -> GraphicalReportHandler {
    let mut characters = if style.unicode { ThemeCharacters::unicode() } else { ThemeCharacters::ascii() };
    characters.error = format!("{code} {}", if style.unicode { "×" } else { "x" });
    characters.warning = format!("{code} {}", if style.unicode { "⚠" } else { "!" });
    let styles = if style.color { ThemeStyles::ansi() } else { ThemeStyles::none() };
    GraphicalReportHandler::new_themed(GraphicalTheme { characters, styles })
        .with_context_lines(0)
        .with_wrap_lines(false)
        .without_syntax_highlighting()
}

/// Where a diagnostic stands, to sort by.
fn place(diagnostic: &Diagnostic) -> (Span, &'static str) {
    (diagnostic.primary.span, diagnostic.code.as_str())
}

/// `3 errors, 1 warning`.
fn count(diagnostics: &[Diagnostic]) -> String {
    let counted = |severity, word| {
        let n = diagnostics.iter().filter(|diagnostic| diagnostic.severity() == severity).count();
        (n > 0).then(|| format!("{n} {word}{}", if n == 1 { "" } else { "s" }))
    };
    let parts = [counted(Severity::Error, "error"), counted(Severity::Warning, "warning")];
    parts.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

/// `garden.rt:31:5`.
fn at(span: Span, sources: &Sources) -> String {
    let source = sources.get(span.source);
    let (line, column) = source.line_column(span.start as usize);
    format!("{}:{line}:{column}", printable(&source.name))
}

/// The head of a statement, enough to know it by.
fn head(text: &str) -> String {
    const MOST: usize = 40;
    match text.char_indices().nth(MOST) {
        Some((cut, _)) => printable(&text[..cut]) + "…",
        None => printable(text),
    }
}

/// A sentence about a source, [`printable`], with what is too long to be read in it cut in its middle: it may
/// name something that was found there.
fn sentence(text: &str) -> String {
    const LONG: usize = 100;
    const HEAD: usize = 60;
    const TAIL: usize = 20;
    let shorten = |word: &str| match word.char_indices().nth(LONG) {
        None => word.to_string(),
        Some(_) => {
            let head: String = word.chars().take(HEAD).collect();
            let tail = word.char_indices().rev().nth(TAIL - 1).map_or("", |(at, _)| &word[at..]);
            format!("{head}…{tail}")
        }
    };
    let line = |line: &str| printable(&line.split(' ').map(shorten).collect::<Vec<_>>().join(" "));
    text.lines().map(line).collect::<Vec<_>>().join("\n")
}

/// A text of one line that cannot steer a terminal, nor reorder what is shown beside it.
fn printable(text: &str) -> String {
    text.chars().map(printable_char).collect()
}

/// The same for a text of several lines, whichever line ends it has.
pub fn printable_lines(text: &str) -> String {
    let line = |line: &str| {
        let end = ["\r\n", "\n"].into_iter().find(|end| line.ends_with(end)).unwrap_or_default();
        printable(&line[..line.len() - end.len()]) + end
    };
    text.split_inclusive('\n').map(line).collect()
}

fn printable_char(c: char) -> char {
    let reorders = matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    if c != '\t' && (c.is_control() || reorders) { char::REPLACEMENT_CHARACTER } else { c }
}

/// What miette is given.
struct Shown<'a> {
    message: String,
    /// None of a remark.
    severity: Option<Severity>,
    labels: Vec<LabeledSpan>,
    help: Option<String>,
    excerpt: &'a Excerpt,
}

impl fmt::Debug for Shown<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl fmt::Display for Shown<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Shown<'_> {}

impl miette::Diagnostic for Shown<'_> {
    fn severity(&self) -> Option<miette::Severity> {
        Some(match self.severity {
            Some(Severity::Error) => miette::Severity::Error,
            Some(Severity::Warning) => miette::Severity::Warning,
            None => miette::Severity::Advice,
        })
    }

    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.help.as_ref().map(|help| Box::new(help) as _)
    }

    fn source_code(&self) -> Option<&dyn miette::SourceCode> {
        Some(self.excerpt)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        Some(Box::new(self.labels.iter().cloned()))
    }
}

#[cfg(test)]
mod tests;
