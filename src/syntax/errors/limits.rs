//! What is said where a text goes over a limit: E0406.

use crate::diagnostic::{Code, Diagnostic};
use crate::span::Span;

/// Too many brackets inside each other.
pub(in crate::syntax) fn deep_brackets(span: Span, most: usize) -> Diagnostic {
    Diagnostic::new(Code::E0406, format!("brackets are nested more than {most} deep"), span)
        .at("one too many")
        .help("name the inner parts by `let`")
}

/// Too deep an expression.
pub(in crate::syntax) fn deep_expression(span: Span, most: usize) -> Diagnostic {
    Diagnostic::new(Code::E0406, format!("the expression is more than {most} operations deep"), span)
        .at("one too many")
        .help("name its parts by `let`")
}

/// Far too many operators.
pub(in crate::syntax) fn long_expression(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0406, "the expression has too many operators", span)
        .at("one too many")
        .help("name its parts by `let`")
}

/// Too many values in parentheses.
pub(in crate::syntax) fn many_values(span: Span, limit: usize) -> Diagnostic {
    Diagnostic::new(Code::E0406, format!("more than {limit} values in parentheses"), span).at("one too many")
}

/// Too long a text.
pub(in crate::syntax) fn long_source(span: Span, most: usize) -> Diagnostic {
    Diagnostic::new(Code::E0406, format!("the source is longer than {most} bytes"), span)
        .at("where it is over the limit")
}

/// Nested so deep that the grammar gave up.
pub(in crate::syntax) fn exhausted(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0406, "this is nested too deep to be read", span).at("skipped")
}
