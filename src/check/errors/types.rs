//! What can be wrong with types and units.

use crate::check::functions::Function;
use crate::check::make::suggested_unit;
use crate::check::types::{Element, Type, describe_wanted, list};
use crate::diagnostic::{Code, Diagnostic};
use crate::schema::{Category, FieldType, Word};
use crate::span::Span;
use crate::syntax::ast::Name;
use crate::units::{self, Dim};

/// A field's value is of another type. `text` is the value as written.
pub(in crate::check) fn mismatch(
    name: &str,
    field: FieldType,
    span: Span,
    text: &str,
    ty: &Type,
) -> Diagnostic {
    let wanted = describe_wanted(field);
    let message = format!("`{name}` wants {wanted}, this is {}", ty.describe());
    let code = mismatch_code(field, ty);
    let diagnostic = Diagnostic::new(code, message, span).at(ty.describe());
    match code {
        Code::E0202 | Code::E0204 => with_unit(diagnostic, text, suggested_unit(field)),
        Code::E0203 => match suggested_unit(field) {
            Some(unit) => diagnostic.help(format!("write {wanted}, such as `{}`", sample(field, &unit))),
            None if text.starts_with('(') => diagnostic.help("leave the unit away: a direction has none"),
            None => diagnostic.help("divide by a unit to make it a plain number: `x / 1m`"),
        },
        Code::E0205 => diagnostic.help(color_help(text, ty)),
        Code::E0206 if text.contains('.') => {
            diagnostic.help("whole numbers have no decimal point; `round(…)` makes one")
        }
        Code::E0206 if text.contains('/') => {
            diagnostic.help("a quotient is no whole number, even where nothing is left over; `round(…)` makes one")
        }
        Code::E0206 => diagnostic.help("whole numbers are written out, as in `1000`; `round(…)` makes one"),
        Code::E0305 => match field {
            FieldType::Named(kind) => {
                diagnostic.help(format!("name one that stands by itself: `{kind} NAME {{ … }}`"))
            }
            _ if matches!(ty, Type::Made(_)) => diagnostic.help(
                "a prototype is not in the picture, and stands nowhere; name a thing that is: `sphere ball { … }`",
            ),
            _ => diagnostic.help("name a thing that stands in the picture: `sphere ball { … }`"),
        },
        _ => match (field, ty) {
            (FieldType::Choice(words), Type::Text)
                if let Some(word) = words.iter().find(|word| word.name == text.trim_matches('"')) =>
            {
                diagnostic.help(format!("the word has no quotes: `{}`", word.name)).fix(span, word.name)
            }
            (FieldType::Choice(words), _) => diagnostic.help(word_list(words)),
            (FieldType::Tuple(..) | FieldType::IntTuple(_), _) => {
                diagnostic.help(format!("such as `{}`", example_tuple(field)))
            }
            (FieldType::Color | FieldType::Paint, Type::Text)
                if crate::color::named(text.trim_matches('"')).is_some() =>
            {
                let name = text.trim_matches('"');
                diagnostic.help(format!("the name of a colour has no quotes: `{name}`")).fix(span, name)
            }
            (FieldType::Color | FieldType::Paint, Type::Text) if is_code(text) => {
                let code = text.trim_matches('"');
                diagnostic.help(format!("a colour has no quotes: `{code}`")).fix(span, code)
            }
            (FieldType::Color | FieldType::Paint, _) => diagnostic.help(color_help(text, ty)),
            (FieldType::Made(_) | FieldType::Target | FieldType::Named(_), Type::Text) => {
                diagnostic.help(format!("a name has no quotes: `{}`", text.trim_matches('"')))
            }
            (FieldType::OneOf(types), Type::Text) if types.contains(&FieldType::Target) => {
                let place = suggested_unit(field).map_or(String::new(), |unit| sample(field, &unit));
                diagnostic.help(format!(
                    "such as `{place}`, or the name of a thing, which has no quotes"
                ))
            }
            (FieldType::Made(Category::Material), Type::Color) if text.len() < 60 && !text.contains('\n') => {
                let made = format!("diffuse {{ color: {text} }}");
                diagnostic
                    .help(format!("a colour is that of a material: `{made}`"))
                    .offer(format!("write `{made}`"), vec![(span, made)])
            }
            (FieldType::Scalar(_) | FieldType::Int, Type::Text) if is_quantity(text.trim_matches('"')) => {
                let bare = text.trim_matches('"');
                diagnostic.help(format!("a value has no quotes: `{bare}`")).fix(span, bare)
            }
            (FieldType::Made(_), _) => diagnostic.help("such as `diffuse { color: #d94f30 }`"),
            (FieldType::Part(kind), Type::Scalar(element)) if kind == "lens" && element.dim() == units::LENGTH => {
                diagnostic.help(format!("a lens has its fields in braces: `lens {{ focal: {text}, stop: 2.8 }}`"))
            }
            (FieldType::Part(kind), _) => diagnostic.help(format!("its fields stand in braces: `{kind} {{ … }}`")),
            (FieldType::Transform, _) => {
                diagnostic.help("such as `scale(2) |> turn(z: 10deg) |> move(0, 1m, 0)`")
            }
            (ty, _) => match suggested_unit(ty) {
                Some(unit) => diagnostic.help(format!("such as `{}`", sample(ty, &unit))),
                None => diagnostic,
            },
        },
    }
}

/// The name of what is wanted stands in quotes.
pub(in crate::check) fn name_in_quotes(diagnostic: Diagnostic, name: &Name) -> Diagnostic {
    diagnostic.help(format!("a name has no quotes: `{}`", name.text)).fix(name.span, name.text.as_str())
}

/// Whether a quoted text is the name of a picture's file.
fn is_picture(text: &str) -> bool {
    let file = text.trim_matches('"').to_ascii_lowercase();
    text.len() < 60
        && [".png", ".jpg", ".jpeg", ".webp", ".hdr", ".exr"].iter().any(|end| file.ends_with(end))
}

/// Whether a text is a number with its unit.
fn is_quantity(text: &str) -> bool {
    let number = text.len() - text.trim_start_matches(|c: char| c.is_ascii_digit() || c == '.').len();
    let (number, unit) = text.split_at(number);
    let sound =
        number.starts_with(|c: char| c.is_ascii_digit()) && number.ends_with(|c: char| c.is_ascii_digit());
    sound && number.matches('.').count() < 2 && (unit.is_empty() || units::parse_unit(unit).is_ok())
}

/// Whether a quoted text is the code of a colour.
fn is_code(text: &str) -> bool {
    text.trim_matches('"').strip_prefix('#').is_some_and(|digits| crate::color::from_hex(digits).is_some())
}

fn mismatch_code(wanted: FieldType, ty: &Type) -> Code {
    match (wanted, ty) {
        (FieldType::OneOf(types), _) => {
            let codes = types.iter().map(|wanted| mismatch_code(*wanted, ty));
            codes.filter(|code| *code != Code::E0201).min().unwrap_or(Code::E0201)
        }
        (FieldType::Color | FieldType::Paint, Type::Scalar(_) | Type::Tuple(3, _)) => Code::E0205,
        (FieldType::Int, Type::Scalar(e)) | (FieldType::IntTuple(2), Type::Tuple(2, e))
            if e.fits(units::NONE) =>
        {
            Code::E0206
        }
        (FieldType::Scalar(dim), Type::Scalar(e)) => unit_code(dim, *e),
        (FieldType::Tuple(m, dim), Type::Tuple(n, e)) if m == *n => unit_code(dim, *e),
        (FieldType::Int, Type::Scalar(_)) | (FieldType::IntTuple(2), Type::Tuple(2, _)) => Code::E0203,
        (FieldType::Target, Type::Made(..)) | (FieldType::Target | FieldType::Named(_), Type::Thing(_)) => {
            Code::E0305
        }
        (FieldType::Named(_), Type::Made(..)) => Code::E0305,
        _ => Code::E0201,
    }
}

fn unit_code(wanted: Dim, found: Element) -> Code {
    match found.dim() == units::NONE {
        true if wanted == units::ANGLE => Code::E0204,
        true => Code::E0202,
        false => Code::E0203,
    }
}

/// Help for a bare number where a quantity is wanted. The unit is known to its author alone, so each that fits is offered.
fn with_unit(diagnostic: Diagnostic, text: &str, unit: Option<String>) -> Diagnostic {
    let Some(unit) = unit else { return diagnostic };
    if text.ends_with('%') {
        let number = text.trim_end_matches('%');
        let shown = if is_bare(number) { format!("{number}%") } else { "(…)".into() };
        return diagnostic.help(format!("a ratio has no unit: write `{shown} * 1{unit}`, or how much it is"));
    }
    let short = if text.is_empty() || text.len() > 40 || text.contains(['\n', '<']) { "(…)" } else { text };
    let shown = if is_bare(short) { short.to_string() } else { format!("({short})") };
    let help = match unit.as_str() {
        "m" => format!("write `{shown}m`, `{shown}cm` or `{shown}mm`"),
        unit => format!("write `{shown}{unit}`"),
    };
    let place = [(diagnostic.primary.span, text)];
    offer_units(diagnostic.help(help), &unit, &place, |unit| format!("write `{shown}{unit}`"))
}

/// Offers to put a unit behind each of some values, which have none.
fn offer_units(
    diagnostic: Diagnostic,
    unit: &str,
    places: &[(Span, &str)],
    title: impl Fn(&str) -> String,
) -> Diagnostic {
    let units = if unit == "m" { &["m", "cm", "mm"][..] } else { &[unit] };
    units.iter().fold(diagnostic, |diagnostic, unit| {
        let edits = places.iter().flat_map(|(span, text)| match is_bare(text) {
            true => vec![(span.after(), unit.to_string())],
            false => vec![(span.before(), "(".into()), (span.after(), format!("){unit}"))],
        });
        diagnostic.offer(title(unit), edits.collect())
    })
}

fn sample(ty: FieldType, unit: &str) -> String {
    match ty {
        FieldType::OneOf(types) => types
            .iter()
            .find(|ty| suggested_unit(**ty).is_some())
            .map_or(String::new(), |ty| sample(*ty, unit)),
        FieldType::Tuple(..) => example_tuple(ty),
        _ if unit == "m" => "8cm".into(),
        _ => format!("30{unit}"),
    }
}

fn example_tuple(ty: FieldType) -> String {
    match ty {
        FieldType::IntTuple(_) => "(640, 480)".into(),
        FieldType::Tuple(_, dim) => format!("(1, 2, 3){}", dim.example_unit()),
        _ => "…".into(),
    }
}

fn word_list(words: &[Word]) -> String {
    list(words.iter().map(|word| format!("`{}`", word.name)).collect(), "or")
}

fn color_help(text: &str, ty: &Type) -> String {
    match ty {
        Type::Tuple(..) if text.starts_with('(') && text.ends_with(')') && text.len() < 60 => {
            format!("write `rgb{text}` for a linear colour, `srgb{text}` for one as colour pickers show it")
        }
        Type::Scalar(element) if element.dim() == units::TEMPERATURE && text.len() < 40 => {
            format!("write `blackbody({text})` for the colour of what glows so hot")
        }
        Type::Text if is_picture(text) => {
            format!("a picture is laid on by `image({text}, 1m)`, each copy 1m wide")
        }
        Type::Texture => "one colour is wanted here, no texture; the picture of a sky is its `image`".into(),
        _ => "write `#d94f30`, `rgb(1, 0.5, 0)` or a name such as `orange`".into(),
    }
}

pub(in crate::check) fn component(span: Span, text: &str, found: Element, others: Element) -> Diagnostic {
    let (found_text, others_text) = (Type::Scalar(found).describe(), Type::Scalar(others).describe());
    let message = format!("one component is {found_text}, another {others_text}");
    let code = match (found.dim() == units::NONE, others.dim()) {
        (true, units::ANGLE) => Code::E0204,
        (true, _) => Code::E0202,
        (false, _) => Code::E0203,
    };
    let diagnostic = Diagnostic::new(code, message, span).at(found_text);
    match code {
        Code::E0203 => diagnostic.help("the components of a triple have one dimension"),
        _ => with_unit(diagnostic, text, Some(others.dim().example_unit())),
    }
}

pub(in crate::check) fn component_not_number(span: Span, ty: &Type) -> Diagnostic {
    Diagnostic::new(
        Code::E0201,
        format!("a component is a number or a quantity, this is {}", ty.describe()),
        span,
    )
    .at(ty.describe())
}

pub(in crate::check) fn long_tuple(span: Span, count: usize) -> Diagnostic {
    Diagnostic::new(Code::E0201, format!("{count} components, where two or three are possible"), span)
        .at(format!("{count} components"))
        .help("commas separate, and a decimal point is written `.`: `(0.5, 1, 2)`")
}

pub(in crate::check) fn unit_on_quantity(unit: &Name, value: Span, ty: &Type) -> Diagnostic {
    let message = match ty {
        Type::Scalar(_) | Type::Tuple(..) => "this has a unit already".to_string(),
        _ => format!("a unit goes on numbers, this is {}", ty.describe()),
    };
    Diagnostic::new(Code::E0201, message, unit.span)
        .at("a second unit")
        .label(value, ty.describe())
        .help("remove one of them")
}

pub(in crate::check) fn no_member(member: &Name, ty: &Type) -> Diagnostic {
    let message = format!("no member `{}` in {}", member.text, ty.describe());
    let diagnostic = Diagnostic::new(Code::E0101, message, member.span).at("unknown member");
    match ty {
        Type::Tuple(2, _) => diagnostic.help("it has `.x` and `.y`"),
        Type::Bounds => diagnostic.help("it has `.min`, `.max`, `.center` and `.size`"),
        Type::Tuple(..) => diagnostic.help("it has `.x`, `.y` and `.z`"),
        Type::List(_) => diagnostic.help("its items are `list[0]` and so on, and `length(list)` is how many"),
        Type::Color | Type::Texture => {
            diagnostic.help("a colour is a value as a whole; `mix(a, b, t)` lies between two")
        }
        Type::Part(_) => diagnostic.help(format!(
            "a part is asked where it is drawn: `part_name left {{ … }}`, then `left.{}`",
            member.text
        )),
        Type::Scalar(_) => diagnostic.help("it is one value; a triple has `.x`, `.y` and `.z`"),
        _ => diagnostic.help("a triple has `.x`, `.y` and `.z`, and a thing has its fields"),
    }
}

pub(in crate::check) fn operand(symbol: &str, wanted: &str, span: Span, ty: &Type) -> Diagnostic {
    let message = format!("`{symbol}` wants {wanted}, this is {}", ty.describe());
    let diagnostic = Diagnostic::new(Code::E0201, message, span).at(ty.describe());
    match symbol {
        "|>" => diagnostic.help("it joins placements: `scale(2) |> turn(z: 10deg) |> move(0, 1m, 0)`"),
        "if" | "and" | "or" | "not" | "assert" if matches!(ty, Type::Scalar(_)) => {
            diagnostic.help("ask something of it, such as `x > 0`")
        }
        _ => diagnostic,
    }
}

pub(in crate::check) fn operands(symbol: &str, at: Span, [a, b]: [(Span, &Type); 2]) -> Diagnostic {
    let message = format!("`{symbol}` cannot join {} and {}", a.1.describe(), b.1.describe());
    let diagnostic = Diagnostic::new(Code::E0201, message, at)
        .at("these do not fit")
        .label(a.0, a.1.describe())
        .label(b.0, b.1.describe());
    match (a.1, b.1) {
        _ if matches!(symbol, "==" | "!=") => diagnostic.help(
            "two of one type can be compared: numbers, quantities, triples, colours, texts, and what is true or false",
        ),
        (Type::Transform, Type::Transform) => {
            diagnostic.help("placements are joined by `|>`, in the order in which they act: `a |> b`")
        }
        (Type::Text, Type::Text) => diagnostic.help("write it as one text: texts are not computed"),
        _ => diagnostic,
    }
}

pub(in crate::check) fn sum(symbol: &str, at: Span, [a, b]: [(Span, &Type); 2]) -> Diagnostic {
    let message =
        format!("`{symbol}` wants two of one dimension, these are {} and {}", a.1.describe(), b.1.describe());
    let diagnostic = Diagnostic::new(Code::E0207, message, at).at("these do not add up");
    let bare = [a, b]
        .iter()
        .any(|(_, ty)| matches!(ty, Type::Scalar(e) | Type::Tuple(_, e) if e.dim() == units::NONE));
    let diagnostic = diagnostic.label(a.0, a.1.describe()).label(b.0, b.1.describe());
    diagnostic.help(match bare {
        true => "give the number the unit of the other",
        false => "only what is measured alike adds up; `*` and `/` join what differs",
    })
}

pub(in crate::check) fn exponent(at: Span) -> Diagnostic {
    Diagnostic::new(Code::E0207, "the exponents of this unit grow beyond reason", at).at("too high a power")
}

pub(in crate::check) fn root(span: Span, ty: &Type) -> Diagnostic {
    Diagnostic::new(Code::E0207, format!("the root of {} has no unit", ty.describe()), span)
        .at(ty.describe())
        .help("the exponents must be even: the root of `m2` is `m`")
}

pub(in crate::check) fn argument_count(function: Function, span: Span, count: usize) -> Diagnostic {
    let arguments = if count == 1 { "1 argument".to_string() } else { format!("{count} arguments") };
    Diagnostic::new(Code::E0201, format!("`{}` does not take {arguments}", function.name()), span)
        .at(arguments)
        .help(format!("call it as `{}`. {}", function.signature(), function.doc()))
}

pub(in crate::check) fn turn_axis(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0201, "`turn` turns about one axis, `x`, `y` or `z`", span)
        .at("about which axis?")
        .help("such as `turn(y: 30deg)`; chain several with `|>`")
}

/// `turn(x: 30deg, y: 20deg)`
pub(in crate::check) fn turn_axes(turns: &[String], span: Span) -> Diagnostic {
    let diagnostic = Diagnostic::new(Code::E0201, "`turn` turns about one axis at a time", span);
    let diagnostic = diagnostic.at("about several");
    match turns {
        [_, _, ..] => {
            diagnostic.help(format!("write one for each, the first to act first: `{}`", turns.join(" |> ")))
        }
        _ => diagnostic.help(format!("write `{}`", turns.first().map_or("turn(y: 30deg)", String::as_str))),
    }
}

pub(in crate::check) fn named_argument(function: Function, name: &Name) -> Diagnostic {
    Diagnostic::new(Code::E0201, format!("`{}` does not name its arguments", function.name()), name.span)
        .at("a name here")
        .help(format!("call it as `{}`", function.signature()))
}

pub(in crate::check) fn argument(
    function: Function,
    wanted: Dim,
    span: Span,
    text: &str,
    ty: &Type,
) -> Diagnostic {
    let message = format!("`{}` wants {wanted}, this is {}", function.name(), ty.describe());
    let code = match ty {
        Type::Scalar(element) => unit_code(wanted, *element),
        _ => Code::E0201,
    };
    let diagnostic = Diagnostic::new(code, message, span).at(ty.describe());
    match code {
        Code::E0202 | Code::E0204 => with_unit(diagnostic, text, Some(wanted.example_unit())),
        Code::E0203 if wanted == units::NONE => {
            diagnostic.help("divide by a unit to make it a plain number: `x / 1m`")
        }
        _ => diagnostic.help(format!("call it as `{}`", function.signature())),
    }
}

/// Several arguments that are wrong in the same way, each with its text. The first is where the error is.
pub(in crate::check) fn arguments(
    function: Function,
    wanted: Dim,
    places: &[(Span, &str)],
    ty: &Type,
) -> Diagnostic {
    let Some(((span, text), others)) = places.split_first() else {
        unreachable!("what is reported is at least one argument")
    };
    let diagnostic = argument(function, wanted, *span, text, ty);
    if others.is_empty() {
        return diagnostic;
    }
    let diagnostic =
        others.iter().fold(diagnostic, |diagnostic, (span, _)| diagnostic.label(*span, "so is this"));
    match diagnostic.code {
        Code::E0202 | Code::E0204 => {
            let unit = wanted.example_unit();
            let with_unit = |(_, text): &(Span, &str)| match is_bare(text) {
                true => format!("`{text}{unit}`"),
                false => format!("`({text}){unit}`"),
            };
            let short = places.iter().all(|(_, text)| text.len() <= 20 && !text.contains('\n'));
            let diagnostic = Diagnostic { offers: vec![], ..diagnostic };
            let title = |unit: &str| format!("write each in `{unit}`");
            let diagnostic = offer_units(diagnostic, &unit, places, title);
            match short {
                true => diagnostic.help(format!(
                    "each has its unit: {}",
                    list(places.iter().map(with_unit).collect(), "and")
                )),
                false => diagnostic.help(format!("each has its unit, such as `1{unit}`")),
            }
        }
        _ => diagnostic,
    }
}

/// Whether a text is a number or stands in parentheses, which a unit can touch.
fn is_bare(text: &str) -> bool {
    let mut depth = 0usize;
    let closes = text.bytes().position(|byte| {
        depth = match byte {
            b'(' => depth + 1,
            b')' => depth.saturating_sub(1),
            _ => depth,
        };
        depth == 0
    });
    let is_number = !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit() || b == b'.');
    is_number || text.starts_with('(') && closes == Some(text.len() - 1)
}

pub(in crate::check) fn triple_wanted(
    function: Function,
    span: Span,
    ty: &Type,
    dim: Option<Dim>,
) -> Diagnostic {
    let of = dim.map_or("a triple".to_string(), |dim| describe_wanted(FieldType::Tuple(3, dim)));
    let code = match (ty, dim) {
        (Type::Tuple(3, element), Some(dim)) => unit_code(dim, *element),
        _ => Code::E0201,
    };
    let diagnostic =
        Diagnostic::new(code, format!("`{}` wants {of}, this is {}", function.name(), ty.describe()), span)
            .at(ty.describe());
    match (code, dim) {
        (Code::E0202 | Code::E0204, Some(dim)) => {
            diagnostic.help(format!("give it a unit, such as `(0, 1, 0){}`", dim.example_unit()))
        }
        _ => diagnostic.help(format!("call it as `{}`", function.signature())),
    }
}
