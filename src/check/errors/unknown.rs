//! What is said of names that nothing declares, by what is wanted where they stand.

use super::words::is_nothing;
use super::{closest, quoted, unknown, unknown_name};
use crate::check::functions::by_name;
use crate::color;
use crate::diagnostic::{Code, Diagnostic};
use crate::schema::{self, Category, FieldType, familiar};
use crate::span::Span;
use crate::syntax::ast::{Name, Path};
use crate::syntax::with_mark;
use crate::units;

/// An unknown name as a value. `setting` is whether it stands in a `--set`.
pub(in crate::check) fn unknown_value(
    wanted: FieldType,
    name: &Name,
    candidates: &[&str],
    setting: bool,
) -> Diagnostic {
    let text = name.text.as_str();
    let guess = closest(text, candidates);
    let diagnostic =
        Diagnostic::new(Code::E0101, format!("unknown name `{text}`"), name.span).at("not known here");
    if wanted == FieldType::Made(Category::Material) {
        if is_material(text) {
            return offer_braces(unknown_name(name, candidates), name.span, text);
        }
        let is_near = guess.as_ref().is_some_and(|guess| guess.certain);
        if let Some(kind) = slip_of_material(text).filter(|_| !is_near) {
            let diagnostic = diagnostic.help(format!("did you mean `{kind} {{ … }}`?"));
            return offer_braces(diagnostic, name.span, kind);
        }
    }
    match wanted {
        // It is a kind, which makes what is wanted, or nothing does.
        _ if schema::kind(text).is_some() || is_nothing(text) && guess.is_none() => {
            unknown_name(name, candidates)
        }
        FieldType::Text if guess.is_none() && setting => {
            diagnostic.help(format!("a text has quotes of its own: `--set 'NAME=\"{text}\"'`"))
        }
        FieldType::Text if guess.is_none() => diagnostic
            .help(format!("a text stands in quotes: `\"{text}\"`"))
            .fix(name.span, format!("\"{text}\"")),
        FieldType::Color | FieldType::Paint => unknown_color(name, candidates),
        FieldType::Tuple(3, units::NONE) if let Some(axis) = axis(text).filter(|_| guess.is_none()) => {
            diagnostic
                .help(format!("a direction is written as a triple: `{axis}`"))
                .offer(format!("replace it with `{axis}`"), vec![(name.span, axis.to_string())])
        }
        FieldType::Made(Category::Material) if guess.is_none() => {
            let made = familiar::kind(text).and_then(|here| here.name).filter(|kind| is_material(kind));
            let made = made.unwrap_or("diffuse");
            diagnostic.help(format!("declare it: `material {text} = {made} {{ … }}`"))
        }
        _ if setting && guess.is_none() => unknown_in_setting(name),
        _ => unknown_name(name, candidates),
    }
}

/// The direction that an axis is called by elsewhere.
fn axis(name: &str) -> Option<&'static str> {
    match name {
        "x" | "X" | "right" => Some("(1, 0, 0)"),
        "y" | "Y" | "up" => Some("(0, 1, 0)"),
        "z" | "Z" => Some("(0, 0, 1)"),
        _ => None,
    }
}

fn is_material(kind: &str) -> bool {
    schema::kind(kind).is_some_and(|kind| kind.get().category == Category::Material)
}

/// The kind of material that a name is with a slip of typing.
fn slip_of_material(name: &str) -> Option<&'static str> {
    let kinds: Vec<&str> =
        schema::KINDS.iter().map(|kind| kind.name).filter(|kind| is_material(kind)).collect();
    closest(name, &kinds).filter(|guess| guess.certain).map(|guess| guess.name)
}

/// Offers to make a thing of a kind in place of a name, where nothing has to be given for that.
fn offer_braces(diagnostic: Diagnostic, place: Span, kind: &str) -> Diagnostic {
    let needs_none = |kind: &schema::KindId| {
        let kind = kind.get();
        let needs = |rule: &schema::Rule| matches!(rule, schema::Rule::ExactlyOne(_));
        kind.fields.iter().all(|field| field.default != schema::Preset::Required)
            && !kind.rules.iter().any(needs)
    };
    match schema::kind(kind).filter(needs_none) {
        Some(_) => diagnostic.offer(format!("write `{kind} {{}}`"), vec![(place, format!("{kind} {{}}"))]),
        None => diagnostic,
    }
}

/// An unknown name is declared inside a body that this one is not in.
pub(in crate::check) fn declared_inside(diagnostic: &mut Diagnostic, name: &str, declared: Span) {
    let place = diagnostic.primary.span;
    let message = format!("`{name}` is not visible here");
    *diagnostic = Diagnostic::new(diagnostic.code, message, place)
        .at("outside of the body that declares it")
        .label(declared, "known only inside")
        .help("a name is known inside the braces that declare it: declare it outside of them");
}

/// `new sphere { … }`, `off sphere { … }`: a word before a kind that says elsewhere what is to become of the thing.
pub(in crate::check) fn before_kind(word: &Name, kind: &Name) -> Option<Diagnostic> {
    let slip = Diagnostic::new(Code::E0101, format!("unknown kind `{}`", word.text), word.span);
    with_mark(slip, word, &kind.text, kind.span)
}

/// `Math.sqrt(4)`: a built-in function of something that there is not.
pub(in crate::check) fn function_of_nothing(path: &Path) -> Option<Diagnostic> {
    let [function] = &path.rest[..] else { return None };
    let signature = by_name(&function.text)?.signature();
    let (owner, edit) = (&path.first, Span { end: function.span.start, ..path.first.span });
    let diagnostic = Diagnostic::new(Code::E0101, format!("unknown name `{}`", owner.text), owner.span)
        .at("not known here")
        .help(format!("`{}` is called by itself: `{signature}`", function.text));
    Some(match owner.text.as_str() {
        "Math" | "math" | "MathF" | "std" | "glm" | "np" | "numpy" => diagnostic.fix(edit, ""),
        _ => diagnostic.offer(format!("call `{}` by itself", function.text), vec![(edit, String::new())]),
    })
}

/// The name of a camera that there is not.
pub(in crate::check) fn unknown_camera(name: &Name, cameras: &[&str]) -> Diagnostic {
    let diagnostic = Diagnostic::new(Code::E0101, format!("no camera is called `{}`", name.text), name.span)
        .at("not known here");
    match closest(&name.text, cameras) {
        Some(guess) => guess.ask(diagnostic, name.span, ""),
        None if cameras.is_empty() => {
            diagnostic.help(format!("give the camera that name: `camera {} {{ … }}`", name.text))
        }
        None if cameras.len() == 1 => diagnostic.help(format!("there is {}", quoted(cameras))),
        None => diagnostic.help(format!("there are {}", quoted(cameras))),
    }
}

/// An unknown name in a `--set`, which declares nothing.
pub(in crate::check) fn unknown_in_setting(name: &Name) -> Diagnostic {
    Diagnostic::new(Code::E0101, format!("unknown name `{}`", name.text), name.span)
        .at("not known here")
        .help("a setting may use what the scene declares at its top level, and the names of colours")
}

fn unknown_color(name: &Name, candidates: &[&str]) -> Diagnostic {
    let text = name.text.as_str();
    let code = color::css(text).or(color::from_hex(text).map(|_| text));
    if let Some(code) = code {
        return Diagnostic::new(Code::E0101, format!("unknown colour `{text}`"), name.span)
            .at("has no name here")
            .help(format!("write `#{code}`"))
            .fix(name.span, format!("#{code}"));
    }
    if closest(text, candidates).is_some() || schema::kind(text).is_some() {
        return unknown(Code::E0101, "name", name, candidates);
    }
    if let Some(function) = by_name(text) {
        return Diagnostic::new(Code::E0101, format!("`{text}` is a function"), name.span)
            .at("what it is given is missing")
            .help(format!("call it: `{}`", function.signature()));
    }
    let known: Vec<&str> = color::NAMED.iter().map(|(name, _)| *name).collect();
    Diagnostic::new(Code::E0101, format!("unknown colour `{text}`"), name.span)
        .at("not known here")
        .help(format!("the named colours are {}; any other is written `#d94f30`", quoted(&known)))
}
