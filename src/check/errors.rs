//! One function for each thing that can be wrong with names, things and fields; types and units have a file of
//! their own.

mod declared;
mod guess;
mod query;
mod types;
mod unknown;
mod words;

pub(super) use declared::*;
pub(super) use guess::*;
pub(super) use query::*;
pub(super) use types::*;
pub(super) use unknown::*;
pub(super) use words::name_as_unit;
use words::{is_side, offer, said_otherwise, unit_in_other_case, unit_of_elsewhere, written_as};

use super::block::{path_span, path_text};
use super::types::{Kind, Making, Type, describe_wanted, list};
use crate::diagnostic::{Code, Diagnostic};
use crate::schema::{self, Category, Field, FieldType, KindId, Preset, familiar};
use crate::span::Span;
use crate::syntax::ast::{Keyword, Name, Path};
use crate::syntax::is_near;
use crate::units;

fn quoted(names: &[&str]) -> String {
    list(names.iter().map(|name| format!("`{name}`")).collect(), "and")
}

pub(super) fn unknown(code: Code, what: &str, name: &Name, candidates: &[&str]) -> Diagnostic {
    let diagnostic =
        Diagnostic::new(code, format!("unknown {what} `{}`", name.text), name.span).at("not known here");
    // A unit of two letters is near to all others; only its first letter tells what was meant.
    let start = name.text.chars().next();
    let same_start = |guess: &str| {
        what != "unit" || guess.chars().next() == start || guess.eq_ignore_ascii_case(&name.text)
    };
    if let Some(word) = written_as(what, &name.text) {
        return diagnostic.help(format!("write `{word}`")).fix(name.span, word);
    }
    if let Some((help, unit)) = unit_in_other_case(what, &name.text) {
        return offer(diagnostic.help(help), name, unit);
    }
    if let Some(help) = said_otherwise(what, &name.text) {
        return diagnostic.help(help);
    }
    if what == "unit"
        && let Some(help) = unit_of_elsewhere(&name.text)
    {
        return diagnostic.help(help);
    }
    if what == "function"
        && let Some(here) = familiar::function(&name.text)
    {
        let diagnostic = with_familiar(diagnostic, here, name.span, candidates);
        return match here.name {
            Some(function) if !here.same_value => offer(diagnostic, name, function),
            _ => diagnostic,
        };
    }
    // What only stands inside another is not meant where anything may stand.
    let inner = |kind: &&str| what == "kind" && schema::is_part(kind);
    let free: Vec<&str> = candidates.iter().copied().filter(|kind| !inner(kind)).collect();
    let guess = closest(&name.text, &free).filter(|guess| same_start(guess.name));
    let guess = guess.map(|mut guess| {
        guess.near.retain(|near| same_start(near));
        // What is near to a function or a unit is mostly one of elsewhere, such as `sign` and `Mm`.
        guess.certain &= !["function", "unit"].contains(&what) || name.text.eq_ignore_ascii_case(guess.name);
        guess
    });
    // An exact word of elsewhere says more than what merely lies near.
    let elsewhere =
        || familiar::kind(&name.text).filter(|here| here.name.is_none_or(|name| candidates.contains(&name)));
    match guess.filter(|_| what != "unit" || !name.text.contains(|c: char| c.is_ascii_digit())) {
        Some(guess) if guess.certain => guess.ask(diagnostic, name.span, ""),
        _ if what == "kind"
            && let Some(keyword) = ["part", "else"].into_iter().find(|word| is_near(&name.text, word)) =>
        {
            offer(diagnostic.help(format!("did you mean `{keyword}`?")), name, keyword)
        }
        _ if what == "kind"
            && let Some(here) = elsewhere() =>
        {
            let diagnostic = with_familiar(diagnostic, here, name.span, candidates);
            match here.name {
                Some(kind) if !here.same_value => offer(diagnostic, name, kind),
                _ => diagnostic,
            }
        }
        Some(guess) => guess.ask(diagnostic, name.span, ""),
        None if what == "unit" && is_side(&name.text) => {
            diagnostic.help("width and height are a pair: `(320, 240)`")
        }
        None if what == "unit" => diagnostic.help(format!("the units are {}", quoted(candidates))),
        None if what == "kind" => diagnostic.help(format!("the kinds known here are {}", quoted(candidates))),
        None if what == "function" => diagnostic.help(format!("the functions are {}", quoted(candidates))),
        None if what == "name" => diagnostic.help(format!("declare it: `let {} = …`", name.text)),
        None => diagnostic,
    }
}

pub(super) fn unknown_name(name: &Name, candidates: &[&str]) -> Diagnostic {
    unknown(Code::E0101, "name", name, candidates)
}

/// A field among statements: at the top level of a file, or in a branch.
pub(super) fn field_of_nothing(name: &Name, inside: &str) -> Diagnostic {
    let diagnostic = Diagnostic::new(Code::E0301, format!("`{}` belongs to no thing", name.text), name.span)
        .at("a field stands in the braces of a thing");
    match inside {
        _ if &name.text == "material" => {
            diagnostic.help("write it inside a thing, or define one for many: `material name = …`")
        }
        "a file" => diagnostic
            .help("a file holds things such as `sphere { … }`, and definitions such as `let r = 5cm`"),
        word => diagnostic.help(format!(
            "the body of `{word}` holds things; inside a thing choose the value: `radius: if … then … else …`"
        )),
    }
}

pub(super) fn duplicate(name: &Name, first: Option<&Name>) -> Diagnostic {
    let diagnostic = Diagnostic::new(Code::E0102, format!("`{}` is declared twice", name.text), name.span)
        .at("again here")
        .help("give one of them another name; a value is never changed once it is declared");
    match first {
        Some(first) => diagnostic.label(first.span, "first declared here"),
        None => diagnostic,
    }
}

pub(super) fn shadows(name: &Name, outer: &Name) -> Diagnostic {
    Diagnostic::new(Code::E0103, format!("`{}` hides a name of the scope around it", name.text), name.span)
        .at("declared again")
        .label(outer.span, "already means this")
        .help("give the inner one another name")
}

pub(super) fn built_in(name: &Name, what: &str) -> Diagnostic {
    Diagnostic::new(Code::E0103, format!("`{}` is {what}, and cannot be declared", name.text), name.span)
        .at(format!("{what} already"))
        .help(format!("choose another name, such as `my_{}`", name.text))
}

/// The most names of a cycle that are shown.
const MAX_CYCLE: usize = 8;

/// `goes_on_below`: whether a value begins on the line below the name.
pub(super) fn cycle(names: &[&Name], goes_on_below: bool) -> Diagnostic {
    let Some(first) = names.first() else {
        unreachable!("only what has a name can be used, and so lie on a cycle")
    };
    let shown = &names[..names.len().min(MAX_CYCLE)];
    let mut path: Vec<String> = shown.iter().map(|name| format!("`{}`", name.text)).collect();
    let message = match names.len() - shown.len() {
        0 if names.len() == 1 => format!("`{}` is defined by itself", first.text),
        0 => format!("{} are defined by each other", list(path.clone(), "and")),
        more => format!("{} and {more} more are defined by each other", path.join(", ")),
    };
    if shown.len() < names.len() {
        path.push("…".into());
    }
    path.push(format!("`{}`", first.text));
    let mut diagnostic = Diagnostic::new(Code::E0104, message, first.span).at("the cycle begins here");
    for pair in shown.windows(2) {
        diagnostic = diagnostic.label(pair[1].span, format!("used by `{}`", pair[0].text));
    }
    if names.len() == 1 && goes_on_below {
        return diagnostic.help(format!(
            "the value goes on in the next line: if that begins something new, give `{}` a value before it",
            first.text
        ));
    }
    if names.len() == 1 && crate::color::named(&first.text).is_some() {
        let help = format!(
            "the name stands for what is declared here, not for the built-in colour; choose another, such as `my_{}`",
            first.text
        );
        return diagnostic.help(help);
    }
    diagnostic.help(format!("break the cycle {}", path.join(" → ")))
}

/// `--set n=n`, also by way of others.
pub(super) fn cycle_of_setting(name: &Name, value: Span, names: &[&Name]) -> Diagnostic {
    let diagnostic = Diagnostic::new(Code::E0104, format!("`{}` is set by way of itself", name.text), value)
        .at("needs what it sets");
    let others: Vec<&str> =
        names.iter().map(|other| other.text.as_str()).filter(|other| *other != name.text).collect();
    match others.is_empty() {
        true => diagnostic.help("give it a value that does not use it"),
        false => diagnostic.help(format!(
            "{} {} `{}`",
            quoted(&others),
            if others.len() == 1 { "uses" } else { "lead to" },
            name.text
        )),
    }
}

pub(super) fn unused(name: &Name, ty: &Type) -> Diagnostic {
    let drawn = match ty {
        Type::Made(making) if making.kind.category() != Category::Material => {
            format!("; a prototype is drawn by `{} {{}}`", name.text)
        }
        Type::Part(_) | Type::File(_) => format!("; it is drawn by `{} {{}}`", name.text),
        _ => String::new(),
    };
    Diagnostic::new(Code::W0106, format!("`{}` is never used", name.text), name.span)
        .at("declared here")
        .help(format!("use it, or remove it{drawn}"))
}

pub(super) fn wrong_keyword(keyword: Keyword, name: &Name, value: Span, ty: &Type) -> Diagnostic {
    let (message, help) = match keyword {
        Keyword::Let => {
            (format!("`let {}` names a material", name.text), format!("write `material {} = …`", name.text))
        }
        Keyword::Material => (
            format!("`material {}` wants a material, this is {}", name.text, ty.describe()),
            format!("write `let {} = …`", name.text),
        ),
    };
    Diagnostic::new(Code::E0201, message, value).at(ty.describe()).help(help)
}

pub(super) fn not_a_kind(name: &Name, ty: &Type) -> Diagnostic {
    let help = match ty {
        Type::Thing(Making { kind: Kind::BuiltIn(kind), .. }) => format!(
            "to make several alike, name a prototype: `let {} = {} {{ … }}`",
            name.text.rsplit('.').next().unwrap_or(""),
            kind.get().name
        ),
        Type::Thing(_) => format!(
            "to make several alike, name a prototype: `let {} = … {{ … }}`",
            name.text.rsplit('.').next().unwrap_or("")
        ),
        _ => "a kind or a prototype stands before `{`".to_string(),
    };
    Diagnostic::new(
        Code::E0201,
        format!("`{}` is {}, and makes no things", name.text, ty.describe()),
        name.span,
    )
    .at("not a kind")
    .help(help)
}

pub(super) fn material_drawn(path: &Path, given: Option<&Name>) -> Diagnostic {
    let name = path_text(path);
    let given = given.map_or("NAME", |given| given.text.as_str());
    Diagnostic::new(
        Code::E0305,
        format!("`{name}` is a material, which is not drawn by itself"),
        path_span(path),
    )
    .at("no surface here")
    .help(format!("name it with `material {given} = {name} {{ … }}`, or give it to a shape's `material`"))
}

pub(super) fn block_inside(path: &Path, kind: KindId) -> Diagnostic {
    let text = kind.get().name;
    let holds = |outer: &&schema::Kind| outer.fields.iter().any(|field| field.ty == FieldType::Part(text));
    let help = match schema::KINDS.iter().find(holds) {
        Some(outer) => format!("put it into the `{}`, or at the top level", outer.name),
        None => "move it to the top level".to_string(),
    };
    Diagnostic::new(Code::E0305, format!("`{text}` is no part of a group"), path_span(path))
        .at("not here")
        .help(help)
}

pub(super) fn cannot_hold(inner: &Path, outer: &str, category: Category) -> Diagnostic {
    let kind = path_text(inner);
    let known = familiar::field(outer, category, &kind);
    let help = match category {
        _ if let Some(known) = known => known.hint.to_string(),
        Category::Shape | Category::Light => "put both into a `group { … }`".to_string(),
        _ => format!("end the `{outer}` before it"),
    };
    Diagnostic::new(Code::E0301, format!("`{outer}` cannot hold things"), path_span(inner))
        .at(format!("`{kind}` does not belong inside"))
        .help(help)
}

/// `sphere { diffuse { color: red } }`; `free` is whether nothing else is its material.
pub(super) fn bare_material(inner: &Path, outer: &str, free: bool) -> Diagnostic {
    let (kind, place) = (path_text(inner), path_span(inner));
    let diagnostic =
        Diagnostic::new(Code::E0301, format!("`{outer}` cannot hold things"), place).at("a material");
    if !free {
        return diagnostic.help("what it is made of is its `material`, of which there is one");
    }
    diagnostic
        .help(format!("what it is made of is its `material`: `material: {kind} {{ … }}`"))
        .fix(place.before(), "material: ")
}

pub(super) fn cannot_hold_statement(span: Span, outer: &str) -> Diagnostic {
    Diagnostic::new(Code::E0301, format!("`{outer}` cannot hold statements"), span)
        .at("does not belong inside")
        .help("a field's value may be chosen: `radius: if … then … else …`; what holds things is a `group { … }`")
}

pub(super) fn named_part(kind: &Path, name: &Name, outer: &str) -> Diagnostic {
    let kind = path_text(kind);
    let message = format!("the `{kind}` of a `{outer}` has no name");
    Diagnostic::new(Code::E0301, message, name.span)
        .at("a name here")
        .help(format!("write `{kind} {{ … }}`"))
        .fix(name.span, "")
}

pub(super) fn unknown_field(
    kind: &str,
    category: Category,
    name: &Name,
    free: &[&str],
    all: &[&str],
) -> Diagnostic {
    let diagnostic =
        Diagnostic::new(Code::E0301, format!("`{kind}` has no field `{}`", name.text), name.span)
            .at("unknown field");
    let here = familiar::field(kind, category, &name.text);
    let here = here.filter(|here| here.name.is_none_or(|name| all.contains(&name)));
    match (here, closest(&name.text, free)) {
        (Some(here), _) => with_familiar(diagnostic, here, name.span, free),
        (None, Some(guess)) => guess.ask(diagnostic, name.span, ""),
        (None, None) if all.is_empty() => {
            diagnostic.help("what a material of any kind has is not known here; name one of them")
        }
        (None, None) => diagnostic.help(format!("its fields are {}", quoted(all))),
    }
}

/// Says what a name from elsewhere is called here; the name is free to be taken where it is among `free`.
fn with_familiar(diagnostic: Diagnostic, here: familiar::Familiar, span: Span, free: &[&str]) -> Diagnostic {
    let diagnostic = diagnostic.help(here.hint);
    match here.name {
        Some(name) if here.same_value && free.contains(&name) => diagnostic.fix(span, name),
        _ => diagnostic,
    }
}

pub(super) fn repeated(name: &Name, first: Span) -> Diagnostic {
    Diagnostic::new(Code::E0303, format!("`{}` is given twice", name.text), name.span)
        .at("again here")
        .label(first, "first given here")
        .help("keep one of them")
}

pub(super) fn conflict(kind: KindId, a: &str, b: &str, first: Span, second: Option<Span>) -> Diagnostic {
    let (message, here) = (format!("`{a}` and `{b}` exclude each other"), "one of the two");
    let diagnostic = Diagnostic::new(Code::E0304, message, second.unwrap_or(first)).at(here);
    match second {
        Some(_) => diagnostic.label(first, "the other").help("keep one of them"),
        None => diagnostic.help(format!(
            "the prototype gives the other already; begin with `{} {{ … }}` instead",
            kind.get().name
        )),
    }
}

pub(super) fn missing(kind: KindId, field: &Field, place: Span) -> Diagnostic {
    Diagnostic::new(Code::E0302, format!("`{}` needs `{}`", kind.get().name, field.name), place)
        .at(format!("without `{}`", field.name))
        .help(format!("add `{}: {}`. {}", field.name, example(field), field.doc))
}

/// Offers to write a field that is needed into a body.
pub(super) fn offer_field(diagnostic: Diagnostic, field: &Field, body: Span, text: &str) -> Diagnostic {
    let inner = text.strip_prefix('{').and_then(|rest| rest.strip_suffix('}'));
    let (Some(inner), value) = (inner, example(field)) else { return diagnostic };
    // What only the writer knows is not made up.
    if value.contains('…') {
        return diagnostic;
    }
    let given = format!("{}: {value}", field.name);
    let edit = match inner.trim().is_empty() {
        true => (body, format!("{{ {given} }}")),
        false => (Span { start: body.start + 1, end: body.start + 1, ..body }, format!(" {given},")),
    };
    diagnostic.offer(format!("add `{given}`"), vec![edit])
}

/// A value as the field wants it, to show.
fn example(field: &Field) -> String {
    if let Preset::Value(value) = field.default {
        return value.to_string();
    }
    match field.ty {
        FieldType::Scalar(dim) if dim == units::LENGTH => "10cm".into(),
        FieldType::Scalar(dim) => format!("10{}", dim.example_unit()),
        FieldType::Tuple(count, dim) => {
            let parts = ["1", "2", "3"];
            format!("({}){}", parts[..count.min(3)].join(", "), dim.example_unit())
        }
        _ => "…".into(),
    }
}

pub(super) fn missing_one_of(kind: KindId, names: &[&str], place: Span) -> Diagnostic {
    let names = list(names.iter().map(|name| format!("`{name}`")).collect(), "or");
    Diagnostic::new(Code::E0302, format!("`{}` needs {names}", kind.get().name), place)
        .at("neither is given")
        .help("add one of them")
}

pub(super) fn missing_beside(kind: KindId, name: &str, beside: &[&str], place: Span) -> Diagnostic {
    let others: Vec<&str> = beside.iter().copied().filter(|other| *other != name).collect();
    Diagnostic::new(
        Code::E0302,
        format!("`{}` with {} needs `{name}`", kind.get().name, quoted(&others)),
        place,
    )
    .at(format!("without `{name}`"))
    .help(format!("add `{name}`"))
}

pub(super) fn unknown_word(field: &Field, name: &Name, words: &[&str]) -> Diagnostic {
    let diagnostic =
        Diagnostic::new(Code::E0101, format!("`{}` does not know `{}`", field.name, name.text), name.span)
            .at("unknown word");
    match closest(&name.text, words) {
        Some(guess) => guess.ask(diagnostic, name.span, ""),
        None => diagnostic.help(format!("it wants {}", describe_wanted(field.ty))),
    }
}
