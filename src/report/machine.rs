//! Diagnostics for programs: one JSON object a line. `docs/diagnostics-json.md` is its contract.

use crate::diagnostic::{Diagnostic, Severity};
use crate::source::{Place, Sources};
use crate::span::Span;
use serde::Serialize;

/// The version of the form. It grows when a field goes or changes its meaning, not when one is added.
pub const SCHEMA: u32 = 1;

#[derive(Serialize)]
struct Object<'a> {
    schema: u32,
    code: &'static str,
    title: &'static str,
    severity: &'static str,
    message: &'a str,
    #[serde(flatten)]
    place: Place<'a>,
    label: Option<&'a str>,
    labels: Vec<Note<'a>>,
    help: Option<&'a str>,
    fixes: Vec<Mend<'a>>,
    uses: Vec<Used<'a>>,
}

/// A range with what is said of it.
#[derive(Serialize)]
struct Note<'a> {
    #[serde(flatten)]
    place: Place<'a>,
    text: &'a str,
}

/// A use, with the first line of its text.
#[derive(Serialize)]
struct Used<'a> {
    #[serde(flatten)]
    note: Note<'a>,
    #[serde(skip_serializing_if = "Option::is_none")]
    turn: Option<&'a str>,
}

#[derive(Serialize)]
struct Mend<'a> {
    edits: Vec<Note<'a>>,
}

/// One diagnostic as a JSON object, without a line end in it.
pub fn json(diagnostic: &Diagnostic, sources: &Sources) -> String {
    let note = |span: Span, text| Note { place: sources.place_of(span), text };
    let mends = diagnostic
        .fix
        .iter()
        .map(|fix| Mend { edits: fix.edits.iter().map(|(span, text)| note(*span, text.as_str())).collect() });
    let object = Object {
        schema: SCHEMA,
        code: diagnostic.code.as_str(),
        title: diagnostic.code.title(),
        severity: severity(diagnostic),
        message: &diagnostic.message,
        place: sources.place_of(diagnostic.primary.span),
        label: Some(diagnostic.primary.text.as_str()).filter(|text| !text.is_empty()),
        labels: diagnostic.labels.iter().map(|label| note(label.span, label.text.as_str())).collect(),
        help: diagnostic.help.as_deref(),
        fixes: mends.collect(),
        uses: diagnostic
            .uses
            .iter()
            .map(|used| Used {
                note: note(used.span, sources.first_line(used.span)),
                turn: used.turn.as_deref(),
            })
            .collect(),
    };
    serde_json::to_string(&object).unwrap_or_else(|_| unreachable!("texts and numbers are always JSON"))
}

/// One line of a workflow command, by which GitHub shows a diagnostic beside the changed line.
///
/// Source: GitHub documentation, "Workflow commands for GitHub Actions", setting an error message.
pub fn github(diagnostic: &Diagnostic, sources: &Sources) -> String {
    let place = sources.place_of(diagnostic.primary.span);
    let title = format!("{} {}", diagnostic.code.as_str(), diagnostic.code.title());
    let mut text = diagnostic.message.clone();
    if let Some(help) = &diagnostic.help {
        text.push_str("\nhelp: ");
        text.push_str(help);
    }
    format!(
        "::{} file={},line={},col={},endLine={},endColumn={},title={}::{}",
        severity(diagnostic),
        property(place.file),
        place.start.line,
        place.start.column,
        place.end.line,
        place.end.column,
        property(&title),
        data(&text)
    )
}

fn data(text: &str) -> String {
    text.replace('%', "%25").replace('\r', "%0D").replace('\n', "%0A")
}

fn property(text: &str) -> String {
    data(text).replace(':', "%3A").replace(',', "%2C")
}

/// One line: place, severity, code and message, as many editors read it.
pub fn short(diagnostic: &Diagnostic, sources: &Sources) -> String {
    let at = super::at(diagnostic.primary.span, sources);
    let message = super::sentence(&diagnostic.message).replace('\n', " ");
    format!("{at}: {}[{}]: {message}", severity(diagnostic), diagnostic.code.as_str())
}

fn severity(diagnostic: &Diagnostic) -> &'static str {
    match diagnostic.severity() {
        Severity::Error => "error",
        Severity::Warning => "warning",
    }
}
