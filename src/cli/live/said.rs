//! What the compiler says, as a page shows it: the text of `rtc check`, with the places that it names.

use super::hub::{Mention, Said};
use rt_lang::diagnostic::{Diagnostic, Severity};
use rt_lang::report::{self, Style};
use rt_lang::source::Sources;

/// Columns of a text that goes to no terminal, as `rtc check` has it.
const WIDTH: usize = 100;

/// What is said of a scene.
pub fn said(diagnostics: &[Diagnostic], sources: &Sources) -> Said {
    let count = |severity| diagnostics.iter().filter(|diagnostic| diagnostic.severity() == severity).count();
    let style = Style { color: false, unicode: true, width: WIDTH };
    let text = report::all(diagnostics, sources, style);
    // A setting is in no file.
    let files = sources.iter().filter(|(_, source)| !source.name.starts_with("--set"));
    let mut places: Vec<Mention> = files.flat_map(|(_, source)| mentions(&text, &source.name)).collect();
    places.sort_by_key(|place| place.start);
    Said { errors: count(Severity::Error), warnings: count(Severity::Warning), text, places }
}

/// What is said where a scene cannot be read at all.
pub fn unreadable(message: &str, help: Option<&str>) -> Said {
    let help = help.map_or_else(String::new, |help| format!("  help: {help}\n"));
    Said { errors: 1, warnings: 0, text: format!("error: {message}\n{help}"), places: vec![] }
}

/// Where a text has `name:line:column`.
fn mentions(text: &str, name: &str) -> Vec<Mention> {
    let mut found = vec![];
    for (start, _) in text.match_indices(name) {
        let behind = &text[start + name.len()..];
        let before = text[..start].chars().next_back();
        let Some((line, rest)) = number(behind) else { continue };
        let Some((column, rest)) = number(rest) else { continue };
        // The end of a longer path is another file.
        if before.is_some_and(|c| c.is_alphanumeric() || "/\\._-".contains(c)) {
            continue;
        }
        let end = text.len() - rest.len();
        let units = |end: usize| text[..end].encode_utf16().count();
        let (file, start, end) = (name.to_string(), units(start), units(end));
        found.push(Mention { file, line, column, start, end });
    }
    found
}

/// `:123` and what is behind.
fn number(text: &str) -> Option<(usize, &str)> {
    let text = text.strip_prefix(':')?;
    let length = text.bytes().take_while(u8::is_ascii_digit).count();
    Some((text[..length].parse().ok()?, &text[length..]))
}

/// What a person is told of names.
pub fn listed(names: &[String]) -> Option<String> {
    /// More than anybody reads.
    const MOST: usize = 3;
    let quoted: Vec<String> = names.iter().take(MOST).map(|name| format!("`{name}`")).collect();
    let more = if names.len() > MOST { " and more" } else { "" };
    (!quoted.is_empty()).then(|| format!("{}{more}", quoted.join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_found_in_the_text() {
        let text = "é [a.rt:12:3] b/a.rt:1:1 a.rt: a.rt:7 (a.rt:4:5)";
        let found = mentions(text, "a.rt");
        let places: Vec<_> =
            found.iter().map(|found| (found.line, found.column, found.start, found.end)).collect();
        assert_eq!(places, [(12, 3, 3, 12), (4, 5, 39, 47)]);
    }
}
