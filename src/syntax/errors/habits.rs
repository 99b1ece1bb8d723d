//! What is said to whoever writes as in another language: one message for the habit, with the way it is written
//! here.

use super::{shown, unexpected};
use crate::diagnostic::{Code, Diagnostic};
use crate::span::Span;
use crate::syntax::ast::Name;
use crate::syntax::{is_name, is_word, mark_of, with_mark};
use crate::units;

/// What begins a statement elsewhere, and how that is written here.
const WORDS: &[(&[&str], &str)] = &[
    (&["while", "loop", "repeat", "foreach", "do"], "`for` repeats: `for i in range(7) { … }`"),
    (
        &["def", "function", "func", "fun", "macro", "define", "lambda"],
        "a function is written `fn name(x: number) -> number = 2 * x`",
    ),
    (
        &["include", "from", "using", "use", "require", "load"],
        "a file is taken in by `import \"file.rt\" as name`",
    ),
    (
        &[
            "var", "const", "local", "global", "static", "auto", "declare", "float", "double", "int",
            "string", "color", "vec3", "set",
        ],
        "a value is named by `let name = …`",
    ),
    (&["class", "struct", "module", "object"], "what is used several times is a `part name { … }`"),
    (&["switch", "match", "case", "when", "unless"], "a choice is written `if … { … } else { … }`"),
    (&["print", "echo", "log", "trace"], "nothing is printed; `rtc info` tells what a scene holds"),
    (&["return"], "a function is one value: `fn name(x: number) -> number = 2 * x`"),
];

/// `while i < 3 {`, `def f(x):`, `var x = 3`: a statement of another language, if the word begins one.
pub(in crate::syntax) fn habit(word: &str, span: Span) -> Option<Diagnostic> {
    let (_, way) = WORDS.iter().find(|(words, _)| words.contains(&word))?;
    let diagnostic = unexpected(word, span).at("is no word of the language").help(*way);
    Some(match word {
        "var" | "const" => diagnostic.fix(span, "let"),
        _ => diagnostic,
    })
}

/// `le a = 3m`: which word of the language was probably meant.
pub(in crate::syntax) fn mistyped(keyword: &str, word: &Name) -> Diagnostic {
    unexpected(&word.text, word.span)
        .at("is no word of the language")
        .help(format!("did you mean `{keyword}`?"))
        .offer(format!("replace it with `{keyword}`"), vec![(word.span, keyword.to_string())])
}

/// How the things that scenes of other tools are made of are written here.
fn written(kind: &str) -> &'static str {
    match kind {
        "sphere" | "ball" => "`sphere { at: (0, 1, 0)m, radius: 2m, material: diffuse { color: red } }`",
        "box" | "cube" => "`box { at: (0, 1, 0)m, size: (2, 2, 2)m }`, which stands around `at`",
        "plane" => "`plane { at: (0, -1, 0)m, normal: (0, 1, 0) }`",
        "cylinder" | "cone" => "`cylinder { at: (0, 1, 0)m, radius: 50cm, height: 2m }`",
        "disc" | "disk" => "`disk { at: (0, 1, 0)m, normal: (0, 1, 0), radius: 50cm }`",
        "camera" => "`camera { from: (0, 1, 4)m, look: (0, 0, 0)m }`",
        "pigment" | "texture" | "finish" | "material" | "color" | "interior" => {
            "`material: diffuse { color: rgb(1, 0.5, 0) }`"
        }
        "light" | "light_source" => "`light { at: (2, 4, 3)m, power: 60W, color: white }`",
        _ => "`sphere { at: (0, 1, 0)m, radius: 2m }`",
    }
}

/// `sphere { <0, 1, 0>, 2 pigment { color Red } }`, `camera { location <0, 1, 4> }`
pub(in crate::syntax) fn foreign_body(kind: &str, span: Span, angled: Span) -> Diagnostic {
    Diagnostic::new(Code::E0001, format!("the body of this `{kind}` is written as in another language"), span)
        .at("its fields have names, each with `:` behind it")
        .label(angled, "and no value stands in `<…>`")
        .help(format!("write {}", written(kind)))
}

/// `sphere ★ { … }`
pub(in crate::syntax) fn signs_in_name(name: &str, span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0001, format!("`{name}` cannot be a name"), span)
        .at("has signs that are no letters")
        .help("a name is made of the letters a to z, digits and `_`")
}

/// `sphere 2nd { … }`, `sphere my-ball { … }`
pub(in crate::syntax) fn no_name(kind: &str, name: &str, span: Span) -> Diagnostic {
    let diagnostic = Diagnostic::new(Code::E0001, format!("`{name}` cannot be a name"), span);
    if name.starts_with(|c: char| c.is_ascii_digit()) {
        let better = format!("{kind}_{}", name.replace('-', "_"));
        return diagnostic
            .at("begins with a digit")
            .help(format!("a name begins with a letter: `{better}`"))
            .offer(format!("replace it with `{better}`"), vec![(span, better)]);
    }
    let better = name.replace('-', "_");
    // The same stands where it is used.
    diagnostic
        .at("`-` subtracts")
        .help(format!("join the words by `_`: `{better}`"))
        .offer(format!("replace it with `{better}`"), vec![(span, better)])
}

/// `sphere my ball { … }`
pub(in crate::syntax) fn name_of_words(name: &str, better: &str, span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0001, format!("`{name}` cannot be a name"), span)
        .at("more than one word")
        .help(format!("join the words by `_`: `{better}`"))
        .offer(format!("replace it with `{better}`"), vec![(span, better.to_string())])
}

/// `sphere "ball" { … }`, of which the text is given.
pub(in crate::syntax) fn quoted_name(text: &str, span: Span) -> Diagnostic {
    let diagnostic = Diagnostic::new(Code::E0001, "the name of a thing has no quotes", span).at("a text");
    if is_name(text) {
        diagnostic.help(format!("write `{text}`")).fix(span, text)
    } else if is_word(text) {
        diagnostic.help(format!("`{text}` is a word of the language: choose another name"))
    } else {
        diagnostic.help("a name is one word, of letters, digits and `_`, and begins with no digit")
    }
}

/// `"radius": 1m`
pub(in crate::syntax) fn quoted_field(name: &str, span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0001, "the name of a field has no quotes", span)
        .at("a text")
        .help(format!("write `{name}: …`"))
        .fix(span, name)
}

/// `radius: sqrt 4`, `material: diffuse red`; `shown` is what is given, as far as it is short, and `made` is whether a
/// kind is wanted.
pub(in crate::syntax) fn beside_name(
    name: &str,
    token: &str,
    shown: &str,
    made: bool,
    span: Span,
) -> Diagnostic {
    let diagnostic = unexpected(token, span).at("a value stands before this already");
    let is_name = shown.starts_with(|c: char| c.is_alphabetic() || c == '#');
    diagnostic.help(match made {
        true if is_name => format!("a kind has its fields in braces: `{name} {{ color: {shown} }}`"),
        true => format!("a kind has its fields in braces: `{name} {{ … }}`"),
        false if units::is_unit(token) => {
            format!("a unit touches its number: `1{token}`; times a value that is `{name} * 1{token}`")
        }
        false => {
            "what a function takes stands in parentheses, as in `sqrt(2)`; else a comma or an operator is \
                  missing"
                .to_string()
        }
    })
}

/// `sphere: { radius: 1m }`, `sphere = { radius: 1m }`
pub(in crate::syntax) fn sign_before_body(kind: &str, sign: &str, edit: Span) -> Diagnostic {
    unexpected(sign, edit)
        .at("the body follows its kind at once")
        .help(format!("write `{kind} {{ … }}`"))
        .fix(edit, " ")
}

/// `material: { color: red }`, `lens: { focal: 50mm }`; `open` is the brace.
pub(in crate::syntax) fn kindless_field(field: &str, open: Span) -> Option<Diagnostic> {
    let diagnostic = unexpected("{", open).at("its kind belongs before this");
    Some(match field {
        "lens" => diagnostic.help("write `lens: lens { … }`").fix(open.before(), "lens "),
        "material" => diagnostic
            .help("name the kind of material: `diffuse { … }`")
            .offer("make it `diffuse`", vec![(open.before(), "diffuse ".into())]),
        _ => return None,
    })
}

/// `new sphere ball { … }`, `off sphere ball { … }`, of which the kind and the name are given.
pub(in crate::syntax) fn word_before_thing(word: &Name, kind: &str, thing: Span) -> Option<Diagnostic> {
    with_mark(unexpected(&word.text, word.span), word, kind, thing)
}

/// `material: shiny metal { … }`, `let ball = new sphere { … }`
pub(in crate::syntax) fn two_kinds(word: &str, kind: &str, first: Span, second: Span) -> Diagnostic {
    let diagnostic =
        unexpected(kind, second).at("a value stands before this already").label(first, "this word");
    let leave_out =
        (format!("leave `{word}` out"), vec![(Span { end: second.start, ..first }, String::new())]);
    if mark_of(word).is_some() {
        let help = format!("leave `{word}` out: a value begins with its kind: `{kind} {{ … }}`");
        return diagnostic.help(help).offer(leave_out.0, leave_out.1);
    }
    diagnostic
        .help(format!("one word stands before a body: `{kind} {{ … }}` or `{word} {{ … }}`"))
        .offer(leave_out.0, leave_out.1)
}

/// `sphere { material { color: red } }`
pub(in crate::syntax) fn kindless_material(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0001, "`material` has no kind", span)
        .at("`:` and a kind of material belong behind this")
        .help("write `material: diffuse { … }`")
        .offer("make it `diffuse`", vec![(span.after(), ": diffuse".into())])
}

/// Whether a text is that of several values, as a triple has them.
pub(in crate::syntax) fn is_components(text: &str) -> bool {
    text.contains(',')
        && text.split(',').all(|part| !part.trim().is_empty() && !part.contains([':', '{', '\n']))
}

/// `at: {1, 2, 3}m`
pub(in crate::syntax) fn components_in_braces(inside: &str, open: Span, close: Span) -> Diagnostic {
    unexpected("{", open)
        .at("a value belongs here")
        .help(format!("values stand in parentheses: `({inside})`"))
        .fix(open, "(")
        .fix(close, ")")
}

/// `rgb <1, 0, 0>`, `color rgb <1, 0, 0>`. `field` is the name of the field before it, where `:` is missing
/// behind that. `edits` is what comes before the parts and what comes behind them, where the mend is certain.
pub(in crate::syntax) fn angled_color(
    function: &str,
    parts: &[&str],
    span: Span,
    field: Option<&Name>,
    edits: Option<(Span, Span)>,
) -> Diagnostic {
    let call = match parts {
        [r, g, b, ..] => format!("{function}({r}, {g}, {b})"),
        _ => format!("{function}(1, 0, 0)"),
    };
    let diagnostic = Diagnostic::new(Code::E0006, "angle brackets do not hold the parts of a colour", span)
        .at("parentheses are wanted");
    let diagnostic = match field {
        Some(name) => diagnostic.help(format!("write `{}: {call}`", name.text)),
        None => diagnostic.help(format!("write `{call}`")),
    };
    let Some((open, close)) = edits else { return diagnostic };
    let diagnostic = diagnostic.fix(open, format!("{function}(")).fix(close, ")");
    match field {
        Some(name) => diagnostic.fix(name.span.after(), ":"),
        None => diagnostic,
    }
}

/// What is said of values without parentheses.
pub(super) const BARE_COMPONENTS: &str = "several values stand here without parentheses";

/// `at: 0,1,0`
pub(in crate::syntax) fn bare_components(span: Span, count: usize) -> Diagnostic {
    Diagnostic::new(Code::E0001, BARE_COMPONENTS, span).at("more than one value").help(match count {
        2 => "write `(width, height)`, such as `(640, 480)`",
        _ => "write `(x, y, z)`, with the unit behind it: `(0, 1, 0)m`",
    })
}

/// `radius: 1,5m`
pub(in crate::syntax) fn decimal_comma(whole: &str, rest: &str, span: Span, comma: Span) -> Diagnostic {
    // `1,200W` is 1200 W in some countries.
    let behind = rest.bytes().take_while(u8::is_ascii_digit).count();
    if behind == 3 && whole.len() <= 3 && !whole.starts_with('0') {
        let [point, none] = [".", ""].map(|sign| format!("{whole}{sign}{rest}"));
        return Diagnostic::new(Code::E0008, format!("`{whole},{rest}` has a comma"), span)
            .at("a number has none")
            .help(format!("write `{point}` for what has a decimal comma, or `{none}` for thousands"))
            .offer(format!("write `{none}`"), vec![(comma, String::new())])
            .offer(format!("write `{point}`"), vec![(comma, ".".to_string())]);
    }
    Diagnostic::new(Code::E0008, format!("`{whole},{rest}` has a decimal comma"), span)
        .at("a point is wanted")
        .help(format!("write a point: `{whole}.{rest}`"))
        .fix(comma, ".")
}

/// Whether the text behind a name at the top level goes on as where values are changed: `x += 1`, `ball.radius = 2m`.
pub(in crate::syntax) fn changes(rest: &str) -> bool {
    let rest = rest.trim_ascii_start();
    ["+=", "-=", "*=", "/=", "++", "--", "."].iter().any(|sign| rest.starts_with(sign))
}

/// `x += 1`, `ball.radius = 2m`
pub(in crate::syntax) fn changed(name: &str, span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0001, format!("`{name}` cannot be changed"), span)
        .at("keeps the value that it is declared with")
        .help("a field is given where the thing is made, and another value has another name: `let next = …`")
}

/// `move(0, 1m, 0)` where a field should begin.
pub(in crate::syntax) fn placement_alone(name: &str, span: Span) -> Diagnostic {
    unexpected(name, span)
        .at("a field should begin here")
        .help("placements stand behind `place:`, joined by `|>`: `place: turn(y: 30deg) |> move(0, 1m, 0)`")
}

/// `a && b`, `a || b`, `a = b`: operators with another name here.
///
/// `certain` is whether nothing else can be meant: with `=` a value may be given at the wrong place.
pub(in crate::syntax) fn foreign_operator(
    sign: &str,
    here: &'static str,
    span: Span,
    certain: bool,
) -> Diagnostic {
    let diagnostic = unexpected(sign, span).at(format!("`{here}` is wanted"));
    let diagnostic = match here {
        "and" => diagnostic.help("both conditions at once are written `a and b`"),
        "or" => diagnostic.help("either condition is written `a or b`"),
        "==" => diagnostic.help("whether two values are equal is asked by `a == b`"),
        "*" => diagnostic.help("times is written `*`"),
        "/" => diagnostic.help("divided by is written `/`"),
        _ => diagnostic.help(format!("write `a {here} b`")),
    };
    match certain {
        true => diagnostic.fix(span, here),
        false => diagnostic.offer(format!("replace it with `{here}`"), vec![(span, here.to_string())]),
    }
}

/// `turn(y: 45deg) | move(0, 1m, 0)`, `a < b | c`
pub(in crate::syntax) fn bar(span: Span, placement: bool, condition: bool) -> Diagnostic {
    let diagnostic = unexpected("|", span);
    match (placement, condition) {
        (true, _) => {
            diagnostic.at("`|>` is wanted").help("`|>` passes a placement on: `a |> b`").fix(span, "|>")
        }
        (_, true) => {
            diagnostic.at("`or` is wanted").help("either condition is written `a or b`").fix(span, "or")
        }
        _ => diagnostic
            .at("is no operator")
            .help("either condition is written `a or b`, and placements are joined by `a |> b`"),
    }
}

/// `a % b`, `a ** b`: functions here.
pub(in crate::syntax) fn operator_for_function(
    sign: &str,
    function: &str,
    span: Span,
    left: Span,
    right: Span,
) -> Diagnostic {
    let what = if function == "mod" { "the remainder" } else { "a power" };
    let between = Span { start: left.end, end: right.start.max(left.end), ..span };
    unexpected(sign, span)
        .at("is no operator")
        .help(format!("{what} is written `{function}(a, b)`"))
        .fix(left.before(), format!("{function}("))
        .fix(between, ", ")
        .fix(right.after(), ")")
}

/// `10W/m^2`
pub(in crate::syntax) fn power_of_unit(
    sign: &str,
    unit: &str,
    power: f64,
    span: Span,
    edit: Span,
) -> Diagnostic {
    unexpected(sign, span)
        .at("the power of a unit touches it")
        .help(format!("write `{unit}{power}`"))
        .fix(edit, "")
}

/// `1 meter`: a unit is not written out. `place` is from behind the number.
pub(in crate::syntax) fn long_unit(number: &str, word: &str, span: Span, place: Span) -> Option<Diagnostic> {
    let unit = units::spelt_out(word)?;
    let diagnostic =
        Diagnostic::new(Code::E0101, format!("unknown unit `{word}`"), span).at("not known here");
    Some(
        diagnostic
            .help(format!("write `{unit}`, which touches its number: `{number}{unit}`"))
            .fix(place, unit),
    )
}

/// `[for i in list { … }]`, `[2 * i for i in list]`
pub(in crate::syntax) fn of_each(word: Span) -> Diagnostic {
    unexpected("for", word).at("repeats statements, and makes no list").help(
        "draw in its body: `for i in range(3) { sphere { at: (3m * i, 0, 0), radius: 1m } }`; lists are written \
         `[1, 4, 9]`, `range(3)` or `linspace(0, 1, 5)`",
    )
}

/// `[0, 1, 2]m`
pub(in crate::syntax) fn list_with_unit(unit: Span, open: Span, close: Span) -> Diagnostic {
    Diagnostic::new(Code::E0001, "a unit stands behind a list", unit)
        .at("goes on numbers and on triples")
        .help("a triple stands in parentheses: `(0, 1, 2)m`")
        .fix(open, "(")
        .fix(close, ")")
}

/// `for i in range(3):` with its body on the next lines, without braces.
pub(in crate::syntax) fn unbraced(word: &str, colon: Span) -> Diagnostic {
    unexpected(":", colon).at("`{` is wanted").help(match word {
        "for" => "the body stands in braces: `for i in range(3) { … }`",
        _ => "the body stands in braces: `if … { … } else { … }`",
    })
}

/// A comment as another language has it.
pub(in crate::syntax) struct ForeignComment {
    /// Of the sign that it begins with.
    pub(in crate::syntax) place: Span,
    /// What makes it one of ours; none where nothing does.
    pub(in crate::syntax) edits: Vec<(Span, &'static str)>,
    /// Whether it can be nothing else, and holds nothing else.
    pub(in crate::syntax) certain: bool,
}

/// `# a comment`, `-- a comment`, `<!-- a comment -->`: those of a text that are as certain, of which the first begins
/// with `sign`.
pub(in crate::syntax) fn foreign_comments(sign: &str, found: &[ForeignComment]) -> Option<Diagnostic> {
    let first = found.first()?;
    let diagnostic = unexpected(sign, first.place).at("a comment begins with `//`");
    let ours = match first.edits[..] {
        [(_, "/*"), ..] => "`/* … */`",
        _ if sign.starts_with(';') => "`//` before a comment, and a comma before another entry",
        _ => "`//`",
    };
    let diagnostic = diagnostic.help(match found.len() {
        1 => format!("write {ours}"),
        n => format!("write {ours}, here and in {} more {}", n - 1, if n == 2 { "place" } else { "places" }),
    });
    let mut edits = found.iter().flat_map(|found| &found.edits).peekable();
    if found.iter().all(|found| found.certain) {
        return Some(edits.fold(diagnostic, |diagnostic, (place, with)| diagnostic.fix(*place, *with)));
    }
    let offered = edits.peek().is_some();
    let edits = edits.map(|&(place, with)| (place, with.to_string())).collect();
    Some(if offered { diagnostic.offer("make it a comment", edits) } else { diagnostic })
}

/// `#include "shapes.inc"`, `#declare R = 2;`
pub(in crate::syntax) fn directive(word: &str, span: Span) -> Diagnostic {
    let diagnostic = unexpected("#", span).at("there are no directives");
    let known = WORDS.iter().find(|(words, _)| words.contains(&word));
    diagnostic.help(known.map_or("a comment begins with `//`", |(_, way)| *way))
}

/// `“1m”`: the places of the quotes around values that have none.
pub(in crate::syntax) fn quoted_values(places: &[Span]) -> Option<Diagnostic> {
    let diagnostic = Diagnostic::new(Code::E0001, "this value stands in quotes", *places.first()?)
        .at("a quote of typesetting")
        .help("a number and a colour have none: `1m`, `#d94f30`");
    Some(places.iter().fold(diagnostic, |diagnostic, place| diagnostic.fix(*place, "")))
}

/// Characters that look like those of the language: the first of them, and where they stand for what.
pub(in crate::syntax) fn lookalike(found: char, places: &[(Span, &'static str)]) -> Option<Diagnostic> {
    let (first, means) = *places.first()?;
    let code = u32::from(found);
    let (message, looks, write) = match means {
        "" => (
            format!("unexpected invisible character U+{code:04X}"),
            "means nothing".into(),
            "delete it".into(),
        ),
        " " => {
            let message = format!("unexpected special space U+{code:04X}");
            (message, "looks like a space".into(), "write a plain space".into())
        }
        _ => {
            let message = format!("unexpected {}", shown(&found.to_string()));
            (message, format!("looks like `{means}`"), format!("write `{means}`"))
        }
    };
    let others = match (places.len() - 1, means) {
        (0, _) => String::new(),
        (n, "") => format!(", and {n} more like it"),
        (n, " ") => format!(", and for {n} more like it"),
        (1, _) => "; another only looks like a sign of the language".into(),
        (n, _) => format!("; {n} more only look like signs of the language"),
    };
    let diagnostic = Diagnostic::new(Code::E0001, message, first).at(looks).help(write + &others);
    Some(places.iter().fold(diagnostic, |diagnostic, (place, means)| diagnostic.fix(*place, *means)))
}
