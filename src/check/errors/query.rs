//! What can be wrong with what is asked of values: lists, fields, paths and calls.

use super::{closest, quoted};
use crate::check::Function;
use crate::check::types::{Kind, Making, Type};
use crate::diagnostic::{Code, Diagnostic};
use crate::schema::Field;
use crate::span::Span;
use crate::syntax::ast::Name;
use crate::units;

pub(in crate::check) fn not_a_value(text: &str, span: Span, ty: &Type) -> Diagnostic {
    let help = match ty {
        Type::Function(_) => format!("call it: `{text}(…)`"),
        _ => format!("use it as a kind: `{text} {{ … }}`"),
    };
    Diagnostic::new(Code::E0201, format!("`{text}` is {}, and no value", ty.describe()), span)
        .at(ty.describe())
        .help(help)
}

pub(in crate::check) fn not_a_list(span: Span, ty: &Type) -> Diagnostic {
    Diagnostic::new(Code::E0201, format!("a list is wanted, this is {}", ty.describe()), span)
        .at(ty.describe())
        .help("such as `range(12)`, `0 to 3` or `[red, green]`")
}

pub(in crate::check) fn mixed_list([a, b]: [(Span, &Type); 2]) -> Diagnostic {
    let (first, other) = (a.1.describe(), b.1.describe());
    let diagnostic =
        Diagnostic::new(Code::E0201, format!("a list holds one type, these are {first} and {other}"), b.0)
            .at(other)
            .label(a.0, first);
    match (a.1, b.1) {
        (Type::Scalar(x), Type::Scalar(y)) if (x.dim() == units::NONE) != (y.dim() == units::NONE) => {
            diagnostic.help("each item has its unit")
        }
        _ => with_prototype(diagnostic, [a.1, b.1]),
    }
}

/// Says what makes a thing of the scene and a prototype differ, where these are the two.
fn with_prototype(diagnostic: Diagnostic, types: [&Type; 2]) -> Diagnostic {
    match types {
        [Type::Thing(_), Type::Made(_)] | [Type::Made(_), Type::Thing(_)] => diagnostic.help(
            "one is in the picture already, the other is what things are made from: name both by `let`, as prototypes",
        ),
        _ => diagnostic,
    }
}

pub(in crate::check) fn branches([a, b]: [(Span, &Type); 2]) -> Diagnostic {
    let (first, other) = (a.1.describe(), b.1.describe());
    let diagnostic = Diagnostic::new(
        Code::E0201,
        format!("both values of an `if` are of one type, these are {first} and {other}"),
        b.0,
    )
    .at(other)
    .label(a.0, first);
    with_prototype(diagnostic, [a.1, b.1])
}

pub(in crate::check) fn to_of_what(span: Span, ty: &Type) -> Diagnostic {
    let code = if matches!(ty, Type::Scalar(_)) { Code::E0206 } else { Code::E0201 };
    Diagnostic::new(code, format!("`to` wants whole numbers, this is {}", ty.describe()), span)
        .at(ty.describe())
        .help("steps of another size: `linspace(0m, 1m, 11)`")
}

pub(in crate::check) fn index_of_what(span: Span, ty: &Type) -> Diagnostic {
    let code = if matches!(ty, Type::Scalar(_)) { Code::E0206 } else { Code::E0201 };
    Diagnostic::new(code, format!("an index is a whole number, this is {}", ty.describe()), span)
        .at(ty.describe())
        .help("the first item is `[0]`")
}

pub(in crate::check) fn whole_argument(function: Function, span: Span, ty: &Type) -> Diagnostic {
    let code = if matches!(ty, Type::Scalar(_)) { Code::E0206 } else { Code::E0201 };
    let message = format!("`{}` wants a whole number, this is {}", function.name(), ty.describe());
    let help = match code {
        Code::E0206 => format!("call it as `{}`; `round(…)` makes a whole number", function.signature()),
        _ => format!("call it as `{}`", function.signature()),
    };
    Diagnostic::new(code, message, span).at(ty.describe()).help(help)
}

pub(in crate::check) fn no_bounds(span: Span, ty: &Type) -> Diagnostic {
    Diagnostic::new(Code::E0305, format!("only things have bounds, this is {}", ty.describe()), span)
        .at(ty.describe())
        .help("name a thing of the picture or a prototype: `bounds(ball)`")
}

pub(in crate::check) fn thing_of_file(member: &Name) -> Diagnostic {
    let message = format!("`{}` stands in the other file's picture, not in this one", member.text);
    Diagnostic::new(Code::E0305, message, member.span)
        .at("not a thing of this scene")
        .help("draw the file and ask that: `y left { … }`, then `left.ball`")
}

pub(in crate::check) fn unknown_column(member: &Name, names: &[&str]) -> Diagnostic {
    let diagnostic =
        Diagnostic::new(Code::E0101, format!("the table has no column `{}`", member.text), member.span)
            .at("unknown column");
    match closest(&member.text, names) {
        Some(guess) => guess.ask(diagnostic, member.span, ""),
        None => diagnostic.help(format!("its columns are {}", quoted(names))),
    }
}

/// `low.ball`, where `low` is a prototype.
pub(in crate::check) fn inside_prototype(prototype: &str, member: &Name, kind: &str) -> Diagnostic {
    let message = format!("`{}` stands nowhere yet: this `{kind}` is a prototype", member.text);
    Diagnostic::new(Code::E0305, message, member.span).at("inside what is not drawn").help(format!(
        "draw it under a name of its own, and ask that: `{prototype} mine {{}}`, then `mine.{}`",
        member.text
    ))
}

pub(in crate::check) fn hidden_inside(member: &Name, ty: &Type) -> Diagnostic {
    let message = format!("`{}` cannot be reached from outside: it is {}", member.text, ty.describe());
    Diagnostic::new(Code::E0305, message, member.span)
        .at("not to be reached by a path")
        .help("things, params and values can be; prototypes and parts are shared by way of a file")
}

pub(in crate::check) fn nothing_called(member: &Name, kind: &str, names: &[String]) -> Diagnostic {
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let message = format!("nothing is called `{}` in `{kind}`", member.text);
    let diagnostic = Diagnostic::new(Code::E0101, message, member.span).at("unknown member");
    match closest(&member.text, &names) {
        Some(guess) => guess.ask(diagnostic, member.span, ""),
        None if names.is_empty() => diagnostic,
        None => diagnostic.help(format!("it has {}", quoted(&names))),
    }
}

pub(in crate::check) fn field_not_given(field: &Field, member: &Name) -> Diagnostic {
    Diagnostic::new(Code::E0302, format!("`{}` is not given, and has no one value", field.name), member.span)
        .at("nothing to be asked")
        .help(format!("give the thing its `{}`", field.name))
}

pub(in crate::check) fn field_not_asked(field: &Field, member: &Name) -> Diagnostic {
    Diagnostic::new(
        Code::E0201,
        format!("`{}` is no value that can be computed with", field.name),
        member.span,
    )
    .at("cannot be asked for")
}

pub(in crate::check) fn not_in_file(name: &Name, what: &str, file: &str, names: &[&str]) -> Diagnostic {
    let message = format!("`{file}` declares no {what} `{}`", name.text);
    let diagnostic = Diagnostic::new(Code::E0101, message, name.span).at("not known there");
    match closest(&name.text, names) {
        Some(guess) => guess.ask(diagnostic, name.span, ""),
        None if names.is_empty() => diagnostic.help("it declares nothing"),
        None => diagnostic.help(format!("it declares {}", quoted(names))),
    }
}

pub(in crate::check) fn nothing_inside(name: &Name, kind: &str) -> Diagnostic {
    Diagnostic::new(Code::E0101, format!("there is nothing called `{}` in `{kind}`", name.text), name.span)
        .at("a built-in kind holds no names")
}

pub(in crate::check) fn path_as_kind(name: &Name, ty: &Type) -> Diagnostic {
    let help = match ty {
        Type::Thing(Making { kind: Kind::Part(_) | Kind::BuiltIn(_), .. }) => {
            "what stands inside a thing is drawn already; name a prototype beside it"
        }
        _ => "only an imported file has kinds inside: `woods.oak { … }`",
    };
    Diagnostic::new(Code::E0201, format!("`{}` is looked for in {}", name.text, ty.describe()), name.span)
        .at("not a kind")
        .help(help)
}

pub(in crate::check) fn not_a_function(text: &str, span: Span, ty: &Type) -> Diagnostic {
    let message = format!("`{text}` is {}, and cannot be called", ty.describe());
    let diagnostic = Diagnostic::new(Code::E0201, message, span).at(ty.describe());
    match ty {
        Type::List(_) => diagnostic.help(format!("its items are `{text}[0]` and so on")),
        Type::Scalar(_) => diagnostic.help(format!("a product has its sign: `{text} * (…)`")),
        _ => diagnostic,
    }
}

pub(in crate::check) fn named_argument_of(function: &str, name: &Name) -> Diagnostic {
    Diagnostic::new(Code::E0201, format!("`{function}` does not name its arguments"), name.span)
        .at("a name here")
        .help("give the values alone, in order")
}

pub(in crate::check) fn declared_argument_count(
    function: &str,
    parameters: &[String],
    span: Span,
    count: usize,
) -> Diagnostic {
    let arguments = if count == 1 { "1 argument".to_string() } else { format!("{count} arguments") };
    Diagnostic::new(Code::E0201, format!("`{function}` does not take {arguments}"), span)
        .at(arguments)
        .help(format!("it is declared as `{function}({})`", parameters.join(", ")))
}
