//! Settings from outside: `name=value`, each a source of its own.

use super::errors;
use super::sweep::{self, Moment};
use crate::diagnostic::{Diagnostic, Label};
use crate::source::{Source, Sources};
use crate::span::{SourceId, Span};
use crate::syntax;
use crate::syntax::ast::{Expr, Name};

/// A value for a param of the file that is drawn.
#[derive(Debug)]
pub struct Setting {
    /// The param.
    pub name: Name,
    /// Its value.
    pub value: Expr,
    /// The values that it is between, of a sweep.
    pub ends: Option<Box<[Expr; 2]>>,
}

/// Points at a setting where the value that it gives is refused where the source has the name of its param: what is
/// wrong is in the setting. A name means one thing in all of a file.
pub fn blame(settings: &[Setting], sources: &Sources, main: SourceId, diagnostics: &mut [Diagnostic]) {
    let of_value = |diagnostic: &&mut Diagnostic| {
        diagnostic.code.as_str().starts_with("E04") && diagnostic.primary.span.source == main
    };
    for diagnostic in diagnostics.iter_mut().filter(of_value) {
        let place = diagnostic.primary.span;
        let set = settings.iter().find(|setting| *setting.name.text == *sources.text(place).trim());
        if let Some(setting) = set {
            diagnostic.primary.span = setting.value.span;
            diagnostic.labels.push(Label { span: place, text: "used here".into() });
        }
    }
}

/// Reads settings, each of the form `name=value`, into sources named `--set`; and those that go from one value to another,
/// at a moment: see [`Moment`].
pub fn settings(
    sources: &mut Sources,
    given: &[String],
    swept: &[String],
    moment: Moment,
) -> (Vec<Setting>, Vec<Diagnostic>) {
    let mut settings: Vec<Setting> = vec![];
    let mut diagnostics = vec![];
    for (index, text) in given.iter().enumerate() {
        let (source, whole) = source(sources, "--set", (index, given.len()), text);
        let Some((name, value)) = parts(source, text) else {
            diagnostics.push(errors::malformed_setting(whole));
            continue;
        };
        let (value, slips) = syntax::parse_expression(source, &value);
        add(&mut settings, &mut diagnostics, Setting { name, value, ends: None });
        diagnostics.extend(slips);
    }
    diagnostics.extend(sweep::sweeps(sources, swept, moment, &mut settings));
    (settings, diagnostics)
}

/// Takes in the text of a flag, the first number of the second, and says where all of it is.
pub(super) fn source(
    sources: &mut Sources,
    flag: &str,
    (index, of): (usize, usize),
    text: &str,
) -> (SourceId, Span) {
    // Of several, each has its number.
    let name = if of == 1 { flag.into() } else { format!("{flag}#{}", index + 1) };
    let source = sources.add(Source::new(&name, text));
    (source, Span::new(source, 0, text.len()))
}

/// The name, and the text of the value: with blanks in place of the name, which keep the places of the value.
pub(super) fn parts(source: SourceId, text: &str) -> Option<(Name, String)> {
    let (name, value) = text.split_once('=')?;
    let start = name.len() - name.trim_start().len();
    let name = Name { text: name.trim().into(), span: Span::new(source, start, start + name.trim().len()) };
    let word = name.text.chars().all(|c| c.is_alphanumeric() || c == '_') && !name.text.is_empty();
    (word && !value.trim().is_empty()).then(|| (name, " ".repeat(text.len() - value.len()) + value))
}

/// Adds a setting, unless there is one of its param.
pub(super) fn add(settings: &mut Vec<Setting>, diagnostics: &mut Vec<Diagnostic>, setting: Setting) {
    match settings.iter().find(|first| first.name.text == setting.name.text) {
        Some(first) => diagnostics.push(errors::set_twice(&setting.name, first.name.span)),
        None => settings.push(setting),
    }
}
