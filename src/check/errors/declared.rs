//! What can be wrong with params, parts, imports, functions and prefixes.

use super::{closest, quoted};
use crate::check::declared::{Declared, TYPES};
use crate::check::types::Type;
use crate::diagnostic::{Code, Diagnostic};
use crate::span::Span;
use crate::syntax::ast::{Name, Prefix};

pub(in crate::check) fn unknown_type(name: &Name) -> Diagnostic {
    let known: Vec<&str> = TYPES.iter().map(|(name, _)| *name).collect();
    let diagnostic =
        Diagnostic::new(Code::E0101, format!("unknown type `{}`", name.text), name.span).at("not known here");
    if let Some(here) = familiar_type(&name.text) {
        return diagnostic.help(format!("it is called `{here}` here")).fix(name.span, here);
    }
    match closest(&name.text, &known) {
        Some(guess) => guess.ask(diagnostic, name.span, ""),
        None if matches!(name.text.as_str(), "vec3" | "Vector3" | "float3" | "vec" | "position") => {
            diagnostic.help("a `point` has three lengths, and a `vector` three numbers")
        }
        None => diagnostic.help(format!("the types are {}, and lists of them: `[length]`", quoted(&known))),
    }
}

/// What a type of other languages is called here.
fn familiar_type(name: &str) -> Option<&'static str> {
    Some(match name {
        "string" | "str" | "String" => "text",
        "float" | "double" | "real" | "decimal" | "f32" | "f64" => "number",
        "integer" | "Integer" | "uint" | "i32" | "u32" => "int",
        "boolean" | "Boolean" => "bool",
        "colour" => "color",
        "placement" | "transformation" | "matrix" => "transform",
        "shape" | "object" => "thing",
        "distance" => "length",
        _ => return None,
    })
}

/// A param with the name of a field that every part has.
pub(in crate::check) fn param_hides_field(name: &Name) -> Diagnostic {
    Diagnostic::new(
        Code::E0103,
        format!("`{}` is a field of every part and file, and cannot be declared", name.text),
        name.span,
    )
    .at("a field already")
    .help(format!("choose another name, such as `my_{}`", name.text))
}

/// A `part`, `param`, `import` or `fn` where none can stand.
pub(in crate::check) fn not_here(word: &str, name: &Name, place: &str) -> Diagnostic {
    Diagnostic::new(Code::E0001, format!("`{word} {}` does not belong here", name.text), name.span)
        .at("not inside a thing or a branch")
        .help(format!("a `{word}` belongs to {place}"))
}

pub(in crate::check) fn field_of_part(name: &Name) -> Diagnostic {
    Diagnostic::new(Code::E0301, format!("a part has no field `{}`", name.text), name.span)
        .at("unknown field")
        .help(format!("what can be set is declared: `param {}: length = 10cm`", name.text))
}

pub(in crate::check) fn mismatch_declared(name: &str, wanted: &str, span: Span, ty: &Type) -> Diagnostic {
    Diagnostic::new(Code::E0201, format!("`{name}` wants {wanted}, this is {}", ty.describe()), span)
        .at(ty.describe())
}

pub(in crate::check) fn not_a_range(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0201, "a range goes from one value to another", span)
        .at("no range")
        .help("write `in 1 to 20`; both ends are included")
}

pub(in crate::check) fn range_of_what(span: Span, what: &str) -> Diagnostic {
    Diagnostic::new(Code::E0201, format!("only numbers and quantities have a range, this is {what}"), span)
        .at("no range here")
        .help("remove it, or say with `assert` what must hold")
}

/// A literal outside a range of literals, each as it is written.
pub(in crate::check) fn outside_range(
    name: &str,
    [low, high]: [&str; 2],
    value: &str,
    span: Span,
) -> Diagnostic {
    let message = format!("`{name}` must be from {low} to {high}, this is {value}");
    Diagnostic::new(Code::E0401, message, span).at("out of range")
}

/// `in 20 to 1`
pub(in crate::check) fn empty_range(span: Span, low: &str, high: &str) -> Diagnostic {
    Diagnostic::new(Code::E0401, "nothing lies in this range", span)
        .at("begins above its end")
        .help(format!("the lower end comes first: `{high} to {low}`"))
}

pub(in crate::check) fn unknown_prefix(name: &Name) -> Diagnostic {
    let known = ["off", "solo", "allow"];
    let diagnostic = Diagnostic::new(Code::E0101, format!("unknown prefix `@{}`", name.text), name.span)
        .at("not known here");
    match closest(&name.text, &known) {
        Some(guess) => guess.ask(diagnostic, name.span, "@"),
        None => diagnostic.help("there are `@off`, `@solo` and `@allow(code, \"why\")`"),
    }
}

pub(in crate::check) fn prefix_arguments(prefix: &Prefix) -> Diagnostic {
    let word = &prefix.name.text;
    let diagnostic = Diagnostic::new(Code::E0201, format!("`@{word}` takes no arguments"), prefix.span)
        .at("arguments here");
    if prefix.arguments.as_ref().is_none_or(Vec::is_empty) {
        return diagnostic.help(format!("write `@{word}`")).fix(prefix.span, format!("@{word}"));
    }
    // `@off(false)`
    let edit = |text: String| vec![(prefix.span, text)];
    diagnostic
        .help(format!(
            "write `@{word}` where it holds, and nothing where it does not; `if … {{ … }}` chooses"
        ))
        .offer(format!("write `@{word}`"), edit(format!("@{word}")))
        .offer("leave it out", edit(String::new()))
}

pub(in crate::check) fn prefix_on_what(prefix: &Prefix) -> Diagnostic {
    let word = &prefix.name.text;
    Diagnostic::new(Code::E0201, format!("`@{word}` stands before what is drawn"), prefix.span)
        .at("nothing is drawn here")
        .help("put it before a thing, a `for` or an `if`")
}

pub(in crate::check) fn allow_arguments(prefix: &Prefix) -> Diagnostic {
    Diagnostic::new(Code::E0201, "`@allow` takes a warning and the reason", prefix.span)
        .at("which warning, and why?")
        .help("such as `@allow(W0106, \"kept for later\")`")
}

pub(in crate::check) fn allow_error(code: Code, prefix: &Prefix) -> Diagnostic {
    let message = format!("{} is an error, which cannot be allowed", code.as_str());
    Diagnostic::new(Code::E0201, message, prefix.span)
        .at("only warnings can be silenced")
        .help("the picture cannot be made until it is mended")
}

pub(in crate::check) fn allow_what(name: &Name) -> Diagnostic {
    // That an `@allow` is unused is not meant by one.
    let warnings = Code::ALL.iter().filter(|code| code.as_str().starts_with('W') && **code != Code::W0105);
    let names: Vec<String> = warnings.flat_map(|code| [code.as_str().to_string(), code.name()]).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let diagnostic = Diagnostic::new(Code::E0101, format!("no warning is called `{}`", name.text), name.span)
        .at("not known here");
    if let Some(guess) = closest(&name.text, &names) {
        return guess.ask(diagnostic, name.span, "");
    }
    // The first word of a name, as far as it was typed.
    let begun = |known: &&&str| name.text.chars().count() > 2 && known.starts_with(&*name.text);
    match names.iter().find(begun) {
        Some(known) => diagnostic
            .help(format!("did you mean `{known}`?"))
            .offer(format!("replace it with `{known}`"), vec![(name.span, known.to_string())]),
        None => diagnostic.help("write its code, such as `W0106`"),
    }
}

/// A `--set` that names no param of the file. `ty` is what its value would be declared as, if that is known.
pub(in crate::check) fn no_such_param(
    name: &Name,
    params: &[&str],
    ty: Option<&Declared>,
    value: &str,
) -> Diagnostic {
    let diagnostic =
        Diagnostic::new(Code::E0503, format!("the scene has no param `{}`", name.text), name.span)
            .at("not declared");
    match closest(&name.text, params) {
        Some(guess) => diagnostic.help(format!("did you mean `{}`?", guess.name)),
        None if params.is_empty() => {
            let ty = ty.map_or("type".into(), Declared::written);
            let value = if value.len() > 40 { "…" } else { value.trim() };
            diagnostic.help(format!("declare it in the scene: `param {}: {ty} = {value}`", name.text))
        }
        None => diagnostic.help(format!("its params are {}", quoted(params))),
    }
}

pub(in crate::check) fn set_twice(name: &Name, first: Span) -> Diagnostic {
    Diagnostic::new(Code::E0503, format!("`{}` is set twice", name.text), name.span)
        .at("again here")
        .label(first, "first set here")
        .help("keep one of them")
}

/// A `--set` that is not `name=value`.
pub(in crate::check) fn malformed_setting(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0503, "a setting is a name, `=` and a value", span)
        .at("not of this form")
        .help("such as `--set count=12` or `--set \"size=15cm\"`")
}

/// A `--sweep` that is not `name = a to b`.
pub(in crate::check) fn malformed_sweep(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0503, "a sweep is a name, `=`, and two values with `to` or `until` between", span)
        .at("not of this form")
        .help("such as `--sweep \"t = 0 to 1\"`; `\"angle = 0deg until 360deg\"` ends a frame before 360deg, for a loop")
}

/// A `--sweep` with more than two values.
pub(in crate::check) fn sweep_of_more(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0503, "a sweep goes from one value to another, and this has more", span)
        .at("two values belong here")
        .help("sweep a number, and choose the values by it in the scene: `if t < 0.5 then … else …`")
}

/// A sweep of a param whose values have nothing between them.
pub(in crate::check) fn sweeps_nothing(name: &str, what: &str, span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0503, format!("`{name}` is {what}, and nothing lies between two of these"), span)
        .at("cannot be swept")
        .help("sweep a number and choose by it in the scene: `if t < 0.5 then … else …`")
}

pub(in crate::check) fn table_arguments(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0201, "`table` wants the path of a file, written out", span)
        .at("no path")
        .help("such as `table(\"points.csv\")`; its columns are known before anything is evaluated")
}

pub(in crate::check) fn bad_table(written: &Name, problem: &str) -> Diagnostic {
    Diagnostic::new(Code::E0501, format!("`{}` is no table: {problem}", written.text), written.span)
        .at("cannot be used")
}
