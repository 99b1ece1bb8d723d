//! Diagnostics as one SARIF document (OASIS, *Static Analysis Results Interchange Format Version 2.1.0*, 2023),
//! which code-review services read.

use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::explain;
use crate::source::Sources;
use crate::span::Span;
use serde_json::{Value, json};

/// Collects the diagnostics of one run over any number of scenes.
#[derive(Debug, Default)]
pub struct Sarif {
    results: Vec<Value>,
}

impl Sarif {
    /// Adds a diagnostic.
    pub fn add(&mut self, diagnostic: &Diagnostic, sources: &Sources) {
        let mut text = diagnostic.message.clone();
        if let Some(help) = &diagnostic.help {
            text.push_str("\nhelp: ");
            text.push_str(help);
        }
        let notes = diagnostic.labels.iter().map(|label| (label.span, label.text.as_str()));
        let uses =
            diagnostic.uses.iter().map(|used| (used.span, used.turn.as_deref().unwrap_or("used here")));
        let related: Vec<Value> = notes
            .chain(uses)
            .map(|(span, text)| json!({ "physicalLocation": location(span, sources), "message": { "text": text } }))
            .collect();
        let mut result = json!({
            "ruleId": diagnostic.code.as_str(),
            "ruleIndex": Code::ALL.iter().position(|code| *code == diagnostic.code),
            "level": level(diagnostic.code),
            "message": { "text": text },
            "locations": [{ "physicalLocation": location(diagnostic.primary.span, sources) }],
        });
        if !related.is_empty() {
            result["relatedLocations"] = related.into();
        }
        if let Some(fix) = &diagnostic.fix {
            let changes: Vec<Value> = fix
                .edits
                .iter()
                .map(|(span, text)| {
                    let mut place = location(*span, sources);
                    json!({
                        "artifactLocation": place["artifactLocation"].take(),
                        "replacements": [{ "deletedRegion": place["region"].take(), "insertedContent": { "text": text } }],
                    })
                })
                .collect();
            let description = diagnostic.help.as_deref().unwrap_or("mend it");
            result["fixes"] = json!([{ "description": { "text": description }, "artifactChanges": changes }]);
        }
        self.results.push(result);
    }

    /// The document.
    pub fn finish(self) -> String {
        let rules: Vec<Value> = Code::ALL
            .iter()
            .map(|code| {
                let page = explain::page(*code);
                json!({
                    "id": code.as_str(),
                    "shortDescription": { "text": code.title() },
                    "help": { "text": page, "markdown": page },
                    "defaultConfiguration": { "level": level(*code) },
                })
            })
            .collect();
        let document = json!({
            "$schema": "https://json.schemastore.org/sarif-2.1.0.json",
            "version": "2.1.0",
            "runs": [{
                "tool": { "driver": { "name": "rtc", "version": env!("CARGO_PKG_VERSION"), "rules": rules } },
                "columnKind": "unicodeCodePoints",
                "results": self.results,
            }],
        });
        document.to_string()
    }
}

fn level(code: Code) -> &'static str {
    match code.severity() {
        Severity::Error => "error",
        Severity::Warning => "warning",
    }
}

fn location(span: Span, sources: &Sources) -> Value {
    let source = sources.get(span.source);
    let length = source.text.len() as u32;
    let (start, end) = (span.start.min(length), span.end.min(length));
    let at = |byte: u32| source.line_column(source.text.floor_char_boundary(byte as usize));
    let ((start_line, start_column), (end_line, end_column)) = (at(start), at(end));
    json!({
        "artifactLocation": { "uri": uri(&source.name) },
        "region": {
            "startLine": start_line,
            "startColumn": start_column,
            "endLine": end_line,
            "endColumn": end_column,
            "byteOffset": start,
            "byteLength": end - start,
        },
    })
}

/// A path as a relative URI reference: what is neither unreserved nor `/` is percent-encoded (RFC 3986, section 2.3).
fn uri(path: &str) -> String {
    let mut uri = String::new();
    for byte in path.replace('\\', "/").bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'.' | b'_' | b'~' | b'/' => {
                uri.push(byte as char)
            }
            _ => uri.push_str(&format!("%{byte:02X}")),
        }
    }
    uri
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_encoded() {
        assert_eq!(uri("rooms/my hall é.rt"), "rooms/my%20hall%20%C3%A9.rt");
        assert_eq!(uri("<stdin>"), "%3Cstdin%3E");
    }
}
