//! What the compiler has to say about a source: plain data, no terminal.

use crate::span::Span;

/// Whether the described picture cannot be made, or is probably not the one meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// The picture cannot be made.
    Error,
    /// The picture can be made, and is probably not the one meant.
    Warning,
}

macro_rules! codes {
    ($($code:ident $title:literal,)*) => {
        /// What a diagnostic is about. The letter tells the severity, the first two digits the group.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[allow(missing_docs)]
        pub enum Code { $($code,)* }

        impl Code {
            /// Every code the compiler can give, in order.
            pub const ALL: &'static [Code] = &[$(Code::$code,)*];

            /// The code as written, such as `E0203`.
            pub fn as_str(self) -> &'static str {
                match self { $(Code::$code => stringify!($code),)* }
            }

            /// What it is about, in a few words.
            pub fn title(self) -> &'static str {
                match self { $(Code::$code => $title,)* }
            }
        }
    };
}

codes! {
    E0001 "unexpected text",
    E0002 "unclosed bracket, string or comment",
    E0003 "`=` or `;` in place of `:` or `,`",
    E0004 "space before a unit",
    E0005 "missing `:`",
    E0006 "angle brackets around a triple",
    E0007 "`a..b` in place of `a to b`",
    E0008 "malformed number, string or colour",
    E0009 "not UTF-8 text",
    E0101 "unknown name",
    E0102 "duplicate name",
    E0103 "shadowed name",
    E0104 "definitions in a cycle",
    W0105 "unused `@allow`",
    W0106 "unused name",
    E0201 "type mismatch",
    E0202 "missing unit",
    E0203 "wrong dimension",
    E0204 "angle without a unit",
    E0205 "number as a colour",
    E0206 "whole number wanted",
    E0207 "units of a root or a sum",
    E0301 "unknown field",
    E0302 "missing field or thing",
    E0303 "repeated field or block",
    E0304 "conflicting fields",
    E0305 "not a thing of the scene",
    E0401 "value out of range",
    E0402 "reflects more than it receives",
    E0403 "degenerate shape",
    E0404 "camera looks at itself",
    E0405 "failed assertion",
    E0406 "over a limit",
    E0407 "value that is not finite",
    E0501 "file that cannot be used",
    E0502 "files that import each other",
    E0503 "wrong `--set`",
    W0601 "camera inside a solid",
    W0602 "nothing in view",
    W0603 "lights that give no light",
    W0604 "light sealed in an opaque solid",
    W0605 "dielectrics that partly overlap",
    W0606 "surfaces that coincide",
    W0607 "dielectric without an inside",
    W0608 "focus that misses everything",
    W0609 "sizes beyond precision",
    W0701 "noise target not reached",
    W0702 "energy cut by the path depth",
    W0703 "over-exposed picture",
    W0704 "one cause of much of the noise",
    W0705 "light that gives nothing",
    W0706 "thing that no path meets",
}

impl Code {
    /// What it is about, as one word: `unused_name`.
    pub fn name(self) -> String {
        self.title().chars().map(|c| if c.is_alphanumeric() { c.to_ascii_lowercase() } else { '_' }).collect()
    }

    /// Error or warning, from the letter.
    pub fn severity(self) -> Severity {
        if self.as_str().starts_with('W') { Severity::Warning } else { Severity::Error }
    }
}

/// A span with a few words about it; the words may be empty.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Label {
    /// What is pointed at.
    pub span: Span,
    /// What is said of it.
    pub text: String,
}

/// An edit that mends the slip by itself: replace each span by its text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fix {
    /// Spans that do not overlap, each with what stands there afterwards.
    pub edits: Vec<(Span, String)>,
}

/// One of several edits that would mend the slip: which is meant only the writer knows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Offer {
    /// What it does, as an imperative sentence without a capital or a full stop.
    pub title: String,
    /// The edits.
    pub fix: Fix,
}

/// A use of a group, part, function or prototype, or a turn of a loop.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Use {
    /// The statement or the call.
    pub span: Span,
    /// Of a turn of a loop, which one: `i = 2`.
    pub turn: Option<String>,
}

impl From<Span> for Use {
    fn from(span: Span) -> Use {
        Use { span, turn: None }
    }
}

/// One error or warning.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// What it is about.
    pub code: Code,
    /// One sentence without a full stop.
    pub message: String,
    /// The place.
    pub primary: Label,
    /// Further places. No label overlaps another: [`Diagnostic::label`] sees to it.
    pub labels: Vec<Label>,
    /// How to mend it.
    pub help: Option<String>,
    /// The mend as an edit, where it can be applied blindly.
    pub fix: Option<Fix>,
    /// Mends to choose from, where none can be applied blindly: for who is asked, as in an editor.
    pub offers: Vec<Offer>,
    /// The uses that led to the place, outermost first.
    pub uses: Vec<Use>,
}

impl Diagnostic {
    /// A diagnostic at a place, with nothing further said.
    pub fn new(code: Code, message: impl Into<String>, span: Span) -> Diagnostic {
        let primary = Label { span, text: String::new() };
        Diagnostic {
            code,
            message: message.into(),
            primary,
            labels: vec![],
            help: None,
            fix: None,
            offers: vec![],
            uses: vec![],
        }
    }

    /// Says something of the primary place.
    pub fn at(mut self, text: impl Into<String>) -> Diagnostic {
        self.primary.text = text.into();
        self
    }

    /// Points at a further place; one that overlaps an earlier label is left out.
    pub fn label(mut self, span: Span, text: impl Into<String>) -> Diagnostic {
        let overlaps = |other: Span| {
            other.source == span.source
                && other.start < span.end.max(span.start + 1)
                && span.start < other.end
        };
        if !overlaps(self.primary.span) && !self.labels.iter().any(|label| overlaps(label.span)) {
            self.labels.push(Label { span, text: text.into() });
        }
        self
    }

    /// Says how to mend it.
    pub fn help(mut self, help: impl Into<String>) -> Diagnostic {
        self.help = Some(help.into());
        self
    }

    /// Adds an edit that mends it.
    pub fn fix(mut self, span: Span, replacement: impl Into<String>) -> Diagnostic {
        self.fix.get_or_insert(Fix { edits: vec![] }).edits.push((span, replacement.into()));
        self
    }

    /// Adds a mend to choose: each span is replaced by its text.
    pub fn offer(mut self, title: impl Into<String>, edits: Vec<(Span, String)>) -> Diagnostic {
        self.offers.push(Offer { title: title.into(), fix: Fix { edits } });
        self
    }

    /// Offers the mend in place of making it, where it is not certain after all.
    pub fn ask(mut self, title: impl Into<String>) -> Diagnostic {
        match self.fix.take() {
            Some(fix) => self.offer(title, fix.edits),
            None => self,
        }
    }

    /// Moves all that it points at.
    pub fn move_places(&mut self, moved: impl Fn(Span) -> Span) {
        let labels = self.labels.iter_mut().chain([&mut self.primary]).map(|label| &mut label.span);
        let offered = self.offers.iter_mut().map(|offer| &mut offer.fix);
        let edits = self.fix.iter_mut().chain(offered).flat_map(|fix| &mut fix.edits).map(|(span, _)| span);
        let uses = self.uses.iter_mut().map(|used| &mut used.span);
        labels.chain(edits).chain(uses).for_each(|span| *span = moved(*span));
    }

    /// Error or warning.
    pub fn severity(&self) -> Severity {
        self.code.severity()
    }
}

/// Whether any of them is an error.
pub fn any_errors(diagnostics: &[Diagnostic]) -> bool {
    diagnostics.iter().any(|diagnostic| diagnostic.severity() == Severity::Error)
}
