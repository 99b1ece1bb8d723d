//! Settings from outside: `name=value`, each a source of its own.

use super::errors;
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

/// Reads settings, each of the form `name=value`, into sources named `--set`.
pub fn settings(sources: &mut Sources, given: &[String]) -> (Vec<Setting>, Vec<Diagnostic>) {
    let mut settings: Vec<Setting> = vec![];
    let mut diagnostics = vec![];
    for (index, text) in given.iter().enumerate() {
        // Of several, each has its number.
        let name = if given.len() == 1 { "--set".into() } else { format!("--set#{}", index + 1) };
        let source = sources.add(Source::new(&name, text.as_str()));
        let whole = Span::new(source, 0, text.len());
        let Some((name, value)) = text.split_once('=') else {
            diagnostics.push(errors::malformed_setting(whole));
            continue;
        };
        let start = name.len() - name.trim_start().len();
        let name =
            Name { text: name.trim().into(), span: Span::new(source, start, start + name.trim().len()) };
        let word = name.text.chars().all(|c| c.is_alphanumeric() || c == '_') && !name.text.is_empty();
        if !word || value.trim().is_empty() {
            diagnostics.push(errors::malformed_setting(whole));
            continue;
        }
        if let Some(first) = settings.iter().find(|first| first.name.text == name.text) {
            diagnostics.push(errors::set_twice(&name, first.name.span));
            continue;
        }
        // Blanks in place of the name keep the places of the value.
        let blank = " ".repeat(text.len() - value.len());
        let (value, slips) = syntax::parse_expression(source, &(blank + value));
        diagnostics.extend(slips);
        settings.push(Setting { name, value });
    }
    (settings, diagnostics)
}
