//! What is said of brackets and quotes that do not match.

use crate::diagnostic::{Code, Diagnostic};
use crate::span::Span;

/// Brackets without a closer, the innermost first, and where that showed. `closers` is what closes them all, and where, if that mends
/// it.
pub(in crate::syntax) fn unclosed(
    openers: impl Iterator<Item = Span>,
    closer: char,
    seen: Option<Span>,
    closers: Option<(Span, String)>,
) -> Diagnostic {
    let opener = match closer {
        ')' => '(',
        ']' => '[',
        _ => '{',
    };
    let mut openers = openers;
    let first = openers.next().expect("at least one bracket is open");
    let mut diagnostic = Diagnostic::new(Code::E0002, format!("this `{opener}` is never closed"), first)
        .at("opened here")
        .help(format!("add the missing `{closer}`"));
    if let Some(closers) = closers {
        diagnostic = diagnostic.offer(format!("add `{}`", closers.1.trim()), vec![closers]);
    }
    if let Some(seen) = seen {
        diagnostic = diagnostic.label(seen, "still open when this begins");
    }
    openers.take(3).fold(diagnostic, |diagnostic, opener| diagnostic.label(opener, "nor is this one"))
}

/// `/*` without its end.
pub(in crate::syntax) fn unclosed_comment(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0002, "this comment is never closed", span)
        .at("the rest of the file is a comment")
        .help("end it with `*/`, or begin each of its lines with `//`")
}

/// `"` without its end on the line.
pub(in crate::syntax) fn unclosed_string(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0002, "this text is not closed on its line", span)
        .at("opened here")
        .help("end it with `\"` on the same line; a line end inside it is written `\\n`")
}

/// `(0, 1]`
pub(in crate::syntax) fn wrong_closer(span: Span, opener: Span, closer: char, right: char) -> Diagnostic {
    Diagnostic::new(Code::E0002, format!("`{closer}` does not close what is open"), span)
        .at(format!("`{right}` is wanted"))
        .label(opener, "opened here")
        .help(format!("write `{right}`"))
        .fix(span, right)
}

/// A closer without an opener.
pub(in crate::syntax) fn stray_closer(span: Span, closer: char) -> Diagnostic {
    Diagnostic::new(Code::E0001, format!("`{closer}` closes nothing"), span)
        .at("nothing of its kind is open here")
        .help("delete it, or open the bracket it should close")
        .offer("delete it", vec![(span, String::new())])
}
