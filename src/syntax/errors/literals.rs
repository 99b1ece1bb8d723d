//! What is said of numbers, colours and texts: E0008.

use crate::diagnostic::{Code, Diagnostic};
use crate::span::Span;

/// `1.2.3`, `1e`, `0x10`
pub(in crate::syntax) fn bad_number(text: &str, span: Span) -> Diagnostic {
    let diagnostic = Diagnostic::new(Code::E0008, format!("`{text}` is not a number"), span).at("malformed");
    if let Some(digits) = text.strip_prefix('.') {
        return diagnostic.help(format!("write `0.{digits}`")).fix(span.before(), "0");
    }
    if let Some(digits) = text.strip_suffix('.') {
        return diagnostic.help(format!("write `{digits}`")).fix(span, digits);
    }
    let lower = text.to_ascii_lowercase();
    if ["0x", "0b", "0o"].iter().any(|prefix| lower.starts_with(prefix)) {
        return diagnostic.help("numbers are decimal; a colour is written `#d94f30`");
    }
    if text.contains('_') {
        return diagnostic.help("`_` stands between two digits: `1_000`");
    }
    if lower.trim_start_matches(|c: char| c.is_ascii_digit() || c == '.').starts_with('e') {
        return diagnostic.help("digits follow the `e`: `1e-3`");
    }
    if text.matches('.').count() > 1 {
        return diagnostic
            .help("a number has one decimal point; several numbers stand in parentheses: `(1, 2, 3)`");
    }
    diagnostic.help("numbers are written `3`, `0.5` or `1e-3`")
}

/// `1e999`
pub(in crate::syntax) fn huge_number(text: &str, span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0008, format!("`{text}` is too large a number"), span)
        .at("beyond 1.8e308")
        .help("write a smaller number")
}

/// `9007199254740993`
pub(in crate::syntax) fn inexact_number(text: &str, span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0008, format!("`{text}` is too large a whole number"), span)
        .at("not exact")
        .help("whole numbers are below 2^53 = 9007199254740992; with a decimal point it is a number that is rounded")
}

/// `"\q"`
pub(in crate::syntax) fn bad_escape(escape: &str, span: Span) -> Diagnostic {
    let message = match escape.chars().any(char::is_control) {
        true => "a control character cannot be escaped in a text".to_string(),
        false => format!("`{escape}` means nothing in a text"),
    };
    Diagnostic::new(Code::E0008, message, span)
        .at("unknown escape")
        .help("write `\\\\` for a backslash; besides there are `\\\"`, `\\n` and `\\t`")
}

/// `#12345`
pub(in crate::syntax) fn bad_color(text: &str, span: Span) -> Diagnostic {
    let diagnostic = Diagnostic::new(Code::E0008, format!("`{text}` is not a colour"), span);
    let digits = &text[1..];
    if let Some(wrong) = digits.chars().find(|c| !c.is_ascii_hexdigit()) {
        return diagnostic
            .at(format!("`{wrong}` is not a hexadecimal digit"))
            .help("the digits are 0 to 9 and a to f: `#d94f30`");
    }
    let count = match digits.len() {
        0 => "no digits".to_string(),
        1 => "1 digit".to_string(),
        n => format!("{n} digits"),
    };
    let diagnostic = diagnostic.at(count);
    match digits.len() {
        4 | 8 => diagnostic.help("write three digits or six; a colour has no transparency"),
        _ => diagnostic.help("write three digits or six: `#fff` or `#d94f30`"),
    }
}
