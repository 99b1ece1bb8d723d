//! What names of elsewhere are here, beyond those of kinds, fields and functions.

use crate::check::functions::by_name;
use crate::check::types::list;
use crate::diagnostic::{Code, Diagnostic};
use crate::schema;
use crate::syntax::ast::Name;
use crate::units;

/// Offers another word in place of a name.
pub(super) fn offer(diagnostic: Diagnostic, name: &Name, word: &str) -> Diagnostic {
    diagnostic.offer(format!("replace it with `{word}`"), vec![(name.span, word.to_string())])
}

/// `2a`, where `a` is a value.
pub(in crate::check) fn name_as_unit(name: &Name) -> Diagnostic {
    let text = &name.text;
    Diagnostic::new(Code::E0101, format!("unknown unit `{text}`"), name.span)
        .at("a name touches the number")
        .help(format!("a product has its sign: `2 * {text}`"))
        .offer("write a product", vec![(name.span.before(), " * ".into())])
}

/// A unit whose letter means something else in this case, what is said of that: `M` is a million, and `k` a thousand.
pub(super) fn unit_in_other_case(what: &str, name: &str) -> Option<(&'static str, &'static str)> {
    match (what, name) {
        ("unit", "M") => Some(("metres are written `m`, and millions are written out: `2_000_000`", "m")),
        ("unit", "k") => Some(("kelvins are written `K`, and thousands are written out: `2000`", "K")),
        _ => None,
    }
}

/// What there is in place of a unit that is known elsewhere, and near to one here by its letters alone.
pub(super) fn unit_of_elsewhere(name: &str) -> Option<String> {
    let measured = units::elsewhere(name)?;
    let known = units::UNITS.iter().filter(|(_, unit)| measured.is_none_or(|dim| unit.dim == dim));
    let known = list(known.map(|(unit, _)| format!("`{unit}`")).collect(), "and");
    Some(match measured {
        Some(dim) if dim == units::TEMPERATURE => format!("the unit of {dim} is {known}"),
        Some(dim) => format!("the units of {dim} are {known}"),
        None if ["lm", "cd", "lx"].iter().any(|unit| name.ends_with(unit)) => {
            "how much a light gives is said in watts: `60W`".into()
        }
        None => format!("the units are {known}"),
    })
}

/// The word that a name certainly means.
pub(super) fn written_as(what: &str, name: &str) -> Option<&'static str> {
    match (what, name) {
        ("name", "yes" | "on" | "True" | "TRUE") => Some("true"),
        ("name", "no" | "off" | "False" | "FALSE") => Some("false"),
        ("unit", "w") => Some("W"),
        ("unit", _) => units::spelt_out(name),
        _ => None,
    }
}

/// How one says here what a name means elsewhere, or at another place.
pub(super) fn said_otherwise(what: &str, name: &str) -> Option<String> {
    let kind = || schema::kind(name).is_some();
    Some(match (what, name) {
        ("name" | "function", _) if kind() => {
            format!("`{name}` is a kind, and makes something with its fields in braces: `{name} {{ … }}`")
        }
        ("name", "pi" | "PI" | "Pi") => "half a turn is `180deg`, and as a number `180deg / 1rad`".into(),
        ("name", "f") => {
            "an f-number is the number alone: `stop: 2.8`; any other value is declared: `let f = …`".into()
        }
        ("name", _) if is_nothing(name) => "nothing is no value: what is left out has its default".into(),
        ("name", "auto") => "only `exposure` knows `auto`; what is left out has its default".into(),
        ("name", _) => return undeclarable(name),
        ("kind", "new") => "leave it out: a thing begins with its kind: `sphere { … }`".into(),
        ("unit", "spp" | "sample" | "samples") => "a number of samples has no unit".into(),
        ("kind", "while") => "`for` repeats: `for i in range(7) { … }`".into(),
        ("unit", "px" | "pixel" | "pixels") => {
            "a number of pixels has no unit; a length is one of the scene, such as `10cm`".into()
        }
        _ => return None,
    })
}

/// Whether a name says elsewhere that there is no value.
pub(super) fn is_nothing(name: &str) -> bool {
    ["null", "nil", "None", "none", "undefined"].contains(&name)
}

/// How a name is used that means something already, and so cannot be declared.
fn undeclarable(name: &str) -> Option<String> {
    if let Some(function) = by_name(name) {
        return Some(format!("`{name}` is a function: `{}`", function.signature()));
    }
    units::is_unit(name).then(|| format!("`{name}` is a unit, and touches a number: `1{name}`"))
}

/// Whether what stands behind a number is rather the rest of a size: `320x240`.
pub(super) fn is_side(unit: &str) -> bool {
    unit.strip_prefix(['x', '×'])
        .is_some_and(|rest| !rest.is_empty() && rest.bytes().all(|b| b.is_ascii_digit()))
}
