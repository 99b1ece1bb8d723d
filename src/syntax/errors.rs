//! What is said of each slip: one small function a diagnostic.

mod brackets;
mod habits;
mod limits;
mod literals;
pub(super) mod statements;

pub(super) use brackets::*;
pub(super) use habits::*;
pub(super) use limits::*;
pub(super) use literals::*;

use crate::diagnostic::{Code, Diagnostic};
use crate::span::Span;
use crate::syntax::ast::Name;

/// Beyond so many nobody reads on, and a hostile file must not exhaust the memory.
const MAX_DIAGNOSTICS: usize = 1000;

/// So many `;` are mended at once.
const MAX_SEMICOLONS: usize = 10_000;

/// Collects diagnostics up to a limit.
#[derive(Debug, Default)]
pub(super) struct Sink {
    told: Vec<Diagnostic>,
    /// Each `;` that does not belong, with what should stand there: all of them are one habit, and one error.
    semicolons: Vec<(Span, &'static str)>,
}

/// How much a sink holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Held {
    told: usize,
    semicolons: usize,
}

impl Sink {
    pub(super) fn push(&mut self, diagnostic: Diagnostic) {
        if self.told.len() < MAX_DIAGNOSTICS {
            self.told.push(diagnostic);
        }
    }

    /// Adds a `;` in place of which something else should stand, or nothing.
    pub(super) fn push_semicolon(&mut self, place: Span, replacement: &'static str) {
        if self.semicolons.len() < MAX_SEMICOLONS {
            self.semicolons.push((place, replacement));
        }
    }

    pub(super) fn append(&mut self, other: Sink) {
        other.told.into_iter().for_each(|diagnostic| self.push(diagnostic));
        other.semicolons.into_iter().for_each(|(place, replacement)| self.push_semicolon(place, replacement));
    }

    pub(super) fn is_empty(&self) -> bool {
        self.held() == Held::default()
    }

    pub(super) fn held(&self) -> Held {
        Held { told: self.told.len(), semicolons: self.semicolons.len() }
    }

    /// Forgets what came later.
    pub(super) fn truncate(&mut self, held: Held) {
        self.told.truncate(held.told);
        self.semicolons.truncate(held.semicolons);
    }

    /// The diagnostics that tell of a missing `{`, each with its place, in the order of the text.
    pub(super) fn missing_braces(&self) -> Vec<(usize, Span)> {
        let told = self.told.iter().enumerate();
        let braces = told.filter(|(_, diagnostic)| statements::misses_brace(diagnostic));
        let mut found: Vec<(usize, Span)> = braces.map(|(index, told)| (index, told.primary.span)).collect();
        found.sort_by_key(|(_, place)| place.start);
        found
    }

    /// Adds a label to a diagnostic.
    pub(super) fn label(&mut self, index: usize, place: Span, text: &str) {
        self.told[index] = self.told[index].clone().label(place, text);
    }

    /// Whether a place lies in values, or behind parameters, of which it was said that they have no parentheses.
    pub(super) fn tells_of_parentheses(&self, place: Span) -> bool {
        self.told.iter().any(|diagnostic| {
            let span = diagnostic.primary.span;
            diagnostic.message == BARE_COMPONENTS && span.contains(place)
                || statements::misses_parentheses(diagnostic) && span.end == place.start
        })
    }

    /// What was collected, in the order of the text, with each place where it was written.
    pub(super) fn into_sorted(mut self, written: impl Fn(Span) -> Span) -> Vec<Diagnostic> {
        self.told.extend(semicolons(&self.semicolons));
        self.told.iter_mut().for_each(|diagnostic| diagnostic.move_places(&written));
        self.told.sort_by_key(|diagnostic| (diagnostic.primary.span.start, diagnostic.code));
        self.told
    }
}

// --- E0001: unexpected ------------------------------------------------------------------------------------

/// The beginning of a text, for a message: a word, a number or a sign.
pub(super) fn first_token(text: &str) -> &str {
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let word = text.find(|c| !is_word(c)).unwrap_or(text.len());
    let sign = text.chars().next().map_or(0, char::len_utf8);
    if let Some(rest) = text.strip_prefix('#') {
        let code = &rest[..rest.find(|c| !is_word(c)).unwrap_or(rest.len())];
        let is_code = code.bytes().all(|byte| byte.is_ascii_hexdigit());
        return if is_code { &text[..1 + code.len()] } else { "#" };
    }
    &text[..word.max(sign)]
}

/// A character or word as it is shown; those one cannot see or type by their number too.
fn shown(token: &str) -> String {
    match token.chars().next() {
        Some(c) if c.is_control() => format!("the control character U+{:04X}", u32::from(c)),
        Some(c) if !c.is_ascii() && !c.is_alphanumeric() => format!("`{c}` (U+{:04X})", u32::from(c)),
        _ => format!("`{token}`"),
    }
}

fn unexpected(token: &str, span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0001, format!("unexpected {}", shown(token)), span)
}

/// Text where a value should stand.
pub(super) fn unexpected_value(token: &str, span: Span) -> Diagnostic {
    let diagnostic = unexpected(token, span).at("a value belongs here");
    match token {
        "]" => diagnostic.help("an index or the values of a list stand in brackets: `[0]`"),
        "{" => diagnostic.help("name the kind before the brace: `sphere { … }`"),
        "'" | "“" | "”" | "„" | "‘" | "’" => {
            diagnostic.help("text stands in straight double quotes: `\"text\"`")
        }
        "<" => diagnostic.help("values stand in parentheses: `(0, 1, 0)m`"),
        "+" => diagnostic.help("a positive number has no sign").fix(span, ""),
        "!" => diagnostic.help("write `not`").fix(span, "not "),
        "=" => diagnostic.help("write one `=` or `:` and then the value"),
        _ => diagnostic.help("write a value such as `5cm`, `(0, 1, 0)m`, `#d94f30` or a name"),
    }
}

/// Text behind a whole entry.
pub(super) fn unexpected_extra(token: &str, span: Span) -> Diagnostic {
    let diagnostic = unexpected(token, span).at("the entry should have ended before this");
    match token {
        "{" => diagnostic.help("only a kind is followed by a body: `sphere { … }` or `sphere ball { … }`"),
        "°" => diagnostic.help("an angle is written `45deg`").fix(span, "deg"),
        "|" => diagnostic
            .help("placements stand in a field, joined by `|>`: `place: turn(y: 30deg) |> move(0, 1m, 0)`"),
        "'" => diagnostic.help("feet are written `3ft`, and inches `3in`"),
        "#" => diagnostic.help("a comment begins with `//`").fix(span, "//"),
        code if code.starts_with('#') => {
            diagnostic.help("a colour stands alone behind its field: `diffuse { color: #d94f30 }`")
        }
        "scale" | "turn" | "move" | "matrix" => {
            diagnostic.help("placements are joined by `|>`").fix(span.before(), "|> ")
        }
        "?" => diagnostic.help("a choice is written `if … then … else …`"),
        "if" => diagnostic.help("a choice is written `if … then … else …`"),
        "then" => diagnostic.help("`then` belongs to an `if` before it"),
        "else" | "elif" | "elseif" | "elsif" => {
            diagnostic.help(format!("`{token}` belongs to an `if` before it: `if … {{ … }} else {{ … }}`"))
        }
        "@" => diagnostic.help("a mark stands before what it is about: `@off sphere { … }`"),
        ":" => diagnostic.help("one `:` stands between a field's name and its value"),
        _ => diagnostic.help("end the entry with a comma or a new line, or put an operator between the two"),
    }
}

/// Text behind a value inside parentheses, or inside a list.
/// `behind` is where the value ends that stands before it.
pub(super) fn unexpected_in_brackets(
    token: &str,
    span: Span,
    closer: &str,
    behind: Option<Span>,
) -> Diagnostic {
    let diagnostic = unexpected(token, span).at(format!("a comma or `{closer}` belongs before this"));
    match token {
        "°" => diagnostic.help("an angle is written `45deg`").fix(span, "deg"),
        _ => {
            let diagnostic = diagnostic.help("separate the values by commas");
            let begins_value =
                token.starts_with(|c: char| c.is_alphanumeric() || matches!(c, '#' | '(' | '"'));
            match behind.filter(|_| begins_value) {
                Some(behind) => diagnostic.offer("add a comma", vec![(behind, ",".to_string())]),
                None => diagnostic,
            }
        }
    }
}

/// Text behind an index.
pub(super) fn unexpected_in_index(token: &str, span: Span) -> Diagnostic {
    unexpected(token, span).at("`]` belongs before this").help("an index is one whole number, from 0")
}

/// Text behind an expression that stands alone.
pub(super) fn unexpected_behind(token: &str, span: Span) -> Diagnostic {
    unexpected(token, span).at("the value should have ended before this").help("give one value alone")
}

/// An entry that begins like nothing in the language.
pub(super) fn unexpected_entry(token: &str, span: Span, top: bool) -> Diagnostic {
    let diagnostic = if top {
        unexpected(token, span).at("a thing or a definition should begin here")
    } else {
        unexpected(token, span).at("a field or a thing should begin here")
    };
    match token {
        "#" => diagnostic.help("a comment begins with `//`").fix(span, "//"),
        "\"" => diagnostic.help("the name of a field has no quotes: `radius: 5cm`"),
        "<" if !top => diagnostic.help("every value stands behind its field's name: `at: (0, 1, 0)m`"),
        "-" => {
            diagnostic.help("a line goes on in the next one behind an operator: end the line above with `-`")
        }
        _ if top => {
            diagnostic.help("begin with a kind, as in `sphere { … }`, or with `let`, `param` or `for`")
        }
        _ => diagnostic.help("begin with a name, as in `radius: 5cm` or `sphere { … }`"),
    }
}

/// A second comma, or one at the beginning.
pub(super) fn stray_separator(span: Span, separator: &str) -> Diagnostic {
    unexpected(separator, span).at("nothing stands before it").help("leave it out").fix(span, "")
}

/// A byte of the text that only programs write.
pub(super) fn control(span: Span) -> Diagnostic {
    // What it stands in place of is not known.
    unexpected("\u{1}", span).at("invisible").help("delete it")
}

/// What a word of the language does, for whoever meant it as a name.
fn does(word: &str) -> &'static str {
    match word {
        "let" => "defines a value",
        "material" => "defines a material",
        "param" => "declares a setting",
        "part" => "begins a part",
        "import" => "takes in a file",
        "as" => "names an imported file",
        "for" => "repeats what its body holds",
        "in" => "stands before a list or a range",
        "if" => "chooses",
        "then" => "stands before the value of an `if`",
        "else" => "stands before the other choice of an `if`",
        "fn" => "defines a function",
        "to" => "stands between the ends of a range",
        "assert" => "says what must hold",
        "and" | "or" | "not" => "joins conditions",
        _ => "is a value",
    }
}

/// A word of the language where a name should stand.
pub(super) fn reserved(word: &str, span: Span) -> Diagnostic {
    let message = format!("`{word}` is a word of the language and cannot be a name");
    Diagnostic::new(Code::E0001, message, span).at(format!("it {}", does(word))).help("choose another name")
}

/// A word of the language where a value should stand.
pub(super) fn reserved_value(word: &str, span: Span) -> Diagnostic {
    unexpected(word, span)
        .at("a value belongs here")
        .help(format!("`{word}` is a word of the language: it {}", does(word)))
}

/// Nothing where a value should stand; `before` is what it should follow.
pub(super) fn missing_value(before: &str, span: Span) -> Diagnostic {
    let message = match before {
        "" => "a value is missing".to_string(),
        before => format!("a value is missing after {}", shown(before)),
    };
    Diagnostic::new(Code::E0001, message, span).at("a value belongs here").help(match before {
        "|>" => "the next placement follows: `turn(y: 30deg) |> move(0, 1m, 0)`",
        "if" | "elif" | "elseif" | "elsif" => "a condition follows: `if n > 2 { … }`",
        "and" | "or" | "not" | "assert" | "==" | "!=" | "<" | "<=" | ">" | ">=" => {
            "a condition compares two values: `n > 2`"
        }
        "+" | "-" | "*" | "/" => "write what follows the sign, or leave it out",
        "in" => "a range or a list follows: `1 to 20`, `[1m, 2m]`",
        _ => "write a value such as `5cm`, `(0, 1, 0)m`, `#d94f30` or a name",
    })
}

/// `()`
pub(super) fn empty_parentheses(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0001, "these parentheses are empty", span)
        .at("a value belongs here")
        .help("write one value or several: `(0, 1, 0)m`")
}

/// `(x: 1, 2)` outside a call.
pub(super) fn label_outside_call(name: &str, span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0001, format!("unexpected name `{name}` in a group of values"), span)
        .at("only the values of a function have names")
        .help("leave the name out, or put a function before the parentheses: `turn(y: 30deg)`")
}

/// `value.` with nothing behind the dot.
pub(super) fn missing_member(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0001, "a name is missing after `.`", span)
        .at("what of it?")
        .help("name the part that is meant: `ball.radius`")
}

/// Two entries on a line; `edit` is what is between them.
pub(super) fn crowded(word: &str, span: Span, edit: Span) -> Diagnostic {
    unexpected(word, span)
        .at("begins something new on the same line")
        .help("put a comma or a new line before it")
        .fix(edit, ", ")
}

/// A name at the top level, and nothing more.
pub(super) fn missing_body(name: &str, span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0001, format!("`{name}` has no body"), span)
        .at("`{` is missing behind this")
        .help(format!("write `{name} {{ … }}`"))
}

/// A kind with something other than a body behind it, at the top level.
pub(super) fn no_brace(kind: &str, span: Span, value: Span) -> Diagnostic {
    Diagnostic::new(Code::E0001, format!("`{{` is missing after `{kind}`"), span)
        .at("a kind")
        .label(value, "its body belongs here")
        .help(format!("a thing has its fields in braces: `{kind} {{ … }}`"))
}

/// A name in a body, and nothing more; `things` is whether that holds things.
pub(super) fn lone_name(name: &str, span: Span, things: bool) -> Diagnostic {
    if name == "material" {
        return Diagnostic::new(Code::E0001, "`material` has no value", span)
            .at("`:` is missing behind this")
            .help("write `material: …` for a field, or `material NAME = …` for a definition");
    }
    if !things && name != "lens" {
        return Diagnostic::new(Code::E0001, format!("`{name}` has no value"), span)
            .at("`:` is missing behind this, or the name of a field before it")
            .help(format!("write `{name}: …`; a value follows the name of its field, as in `color: red`"));
    }
    Diagnostic::new(Code::E0001, format!("`{name}` has neither a value nor a body"), span)
        .at("`:` or `{` is missing behind this")
        .help(format!("write `{name}: …` for a field, or `{name} {{ … }}` for a thing"))
}

/// `let a 5`, `material glass { … }`
pub(super) fn missing_equals(keyword: &str, name: &str, span: Span) -> Diagnostic {
    let value = if keyword == "material" { "diffuse { … }" } else { "…" };
    Diagnostic::new(Code::E0001, format!("`=` is missing after `{keyword} {name}`"), span)
        .at("named, but not defined")
        .help(format!("write `{keyword} {name} = {value}`"))
}

/// `let mut i = 0`
pub(super) fn word_in_definition(keyword: &str, word: &Name, name: &Name) -> Diagnostic {
    unexpected(&word.text, word.span)
        .at("no word stands before the name")
        .help(format!("write `{keyword} {} = …`, which never changes", name.text))
        .fix(Span { end: name.span.start, ..word.span }, "")
}

/// `export let r = 1m`
pub(super) fn word_before_statement(word: &Name, keyword: &str, place: Span) -> Diagnostic {
    unexpected(&word.text, word.span)
        .at(format!("no word stands before `{keyword}`"))
        .help("leave it out: what a file defines is known to those that import it")
        .fix(Span { end: place.start, ..word.span }, "")
}

/// `let f(x) = 2 * x`
pub(super) fn function_by_let(keyword: &str, name: &str, span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0001, format!("`{keyword} {name}` takes no parameters"), span)
        .at("names one value")
        .help(format!("a function is written `fn {name}(x: number) -> number = …`"))
}

/// `let = 5`, `let`
pub(super) fn missing_name(keyword: &str, span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0001, format!("a name is missing after `{keyword}`"), span)
        .at("defines what?")
        .help(format!("write `{keyword} name = …`"))
}

/// `x = 5` at the top level.
pub(super) fn missing_let(name: &str, span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0001, format!("`let` is missing before `{name}`"), span)
        .at("a definition needs its word")
        .help(format!("write `let {name} = …`, or `material {name} = …` for a material"))
}

// --- E0003: `=` or `;` ------------------------------------------------------------------------------------

/// `radius = 5cm`
pub(super) fn equals_in_field(name: &str, sign: Span, edit: Span) -> Diagnostic {
    Diagnostic::new(Code::E0003, format!("the value of `{name}` follows `:`"), sign)
        .at("`:` is wanted")
        .help(format!("write `{name}: …`"))
        .fix(edit, ":")
}

/// `let x: 5`
pub(super) fn colon_in_definition(keyword: &str, name: &str, sign: Span, edit: Span) -> Diagnostic {
    Diagnostic::new(Code::E0003, format!("the value of `{keyword} {name}` follows `=`"), sign)
        .at("`=` is wanted")
        .help(format!("write `{keyword} {name} = …`"))
        .fix(edit, " =")
}

/// `let r: length = 5cm`
pub(super) fn type_in_definition(keyword: &str, name: &str, ty: Span, edit: Span) -> Diagnostic {
    Diagnostic::new(Code::E0001, format!("`{keyword} {name}` takes no type"), ty)
        .at("follows from the value")
        .help(format!("write `{keyword} {name} = …`; only a `param` and a `fn` name types"))
        .fix(edit, "")
}

/// `radius: 5cm;`: each `;` of a text, and what should stand there.
fn semicolons(places: &[(Span, &'static str)]) -> Option<Diagnostic> {
    let mut places = places.to_vec();
    places.sort_unstable();
    let first = places.first()?.0;
    // Those that touch, as in `;;`, are one edit, with a comma where one of them wants it.
    let mut edits: Vec<(Span, &str)> = Vec::new();
    for &(place, replacement) in &places {
        match edits.last_mut() {
            Some((last, with)) if last.source == place.source && last.end == place.start => {
                (last.end, *with) = (place.end, [*with, replacement].into_iter().max().unwrap_or(""));
            }
            _ => edits.push((place, replacement)),
        }
    }
    let commas = places.iter().filter(|(_, replacement)| *replacement == ",").count();
    let help = match (places.len() - commas, commas) {
        (_, 0) => "delete it: the end of a line is enough",
        (0, _) => "write a comma",
        _ => "delete it at the end of a line, and write a comma within one",
    };
    let label = match places.len() - 1 {
        0 => "not a separator".to_string(),
        n if n + 1 == MAX_SEMICOLONS => format!("not a separator, here and in more than {n} places"),
        n => format!("not a separator, here and in {n} more {}", if n == 1 { "place" } else { "places" }),
    };
    let diagnostic = Diagnostic::new(Code::E0003, "`;` does not separate", first).at(label).help(help);
    Some(
        edits
            .into_iter()
            .fold(diagnostic, |diagnostic, (place, replacement)| diagnostic.fix(place, replacement)),
    )
}

// --- E0004 to E0007 ---------------------------------------------------------------------------------------

/// `8 mm`
pub(super) fn space_before_unit(unit: &str, span: Span, space: Span) -> Diagnostic {
    Diagnostic::new(Code::E0004, format!("a space stands before the unit `{unit}`"), span)
        .at("a unit touches its number or `)`")
        .help("delete the space")
        .fix(space, "")
}

/// `radius 50cm`
pub(super) fn missing_colon(name: &str, span: Span, value: Span) -> Diagnostic {
    Diagnostic::new(Code::E0005, format!("`:` is missing after `{name}`"), span)
        .at("a field's name")
        .label(value, "its value")
        .help(format!("write `{name}: …`"))
        .fix(span.after(), ":")
}

/// `<x, y, z>`
pub(super) fn angle_brackets(span: Span, open: Span, close: Span) -> Diagnostic {
    Diagnostic::new(Code::E0006, "angle brackets do not hold values", span)
        .at("parentheses are wanted")
        .help("write `(x, y, z)`; that of lengths has its unit behind it: `(0, 1, 0)m`")
        .fix(open, "(")
        .fix(close, ")")
}

/// `a..b`. `edit` is what `to` takes the place of, the white space around the points included. Languages differ in
/// whether `..` and `...` include the end, so only `..=` is certain.
pub(super) fn dots(dots: &str, span: Span, edit: Span) -> Diagnostic {
    let diagnostic = Diagnostic::new(Code::E0007, format!("a range is not written with `{dots}`"), span)
        .at("`to` is wanted")
        .help("write `a to b`, which includes both ends, or `range(a, b)`, which leaves out `b`");
    if dots == "..=" { diagnostic.fix(edit, " to ") } else { diagnostic }
}
