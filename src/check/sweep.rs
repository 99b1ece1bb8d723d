//! Settings that go from one value to another through the frames of a film: `name = a to b`.
//!
//! The value of a frame is the one that `mix(a, b, t)` gives, so `--set` with those words makes the same picture.

use super::declared::Declared;
use super::setting::{self, Setting};
use super::types::Type;
use super::{Checker, Expr, ExprKind, errors};
use crate::diagnostic::Diagnostic;
use crate::schema::FieldType;
use crate::source::Sources;
use crate::span::Span;
use crate::syntax;
use crate::syntax::ast::{self, Argument, BinaryOp, ExprKind as Tree, Name, Path, UnaryOp};

/// Which frame of a film, in the order of time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Moment {
    /// From 0.
    pub index: u32,
    /// How many frames there are.
    pub of: u32,
}

impl Default for Moment {
    /// The only one.
    fn default() -> Moment {
        Moment { index: 0, of: 1 }
    }
}

/// What the last frame has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Last {
    /// The second value: `a to b`.
    End,
    /// The one before it, so that the first frame follows in a loop: `a until b`.
    Before,
}

impl Moment {
    /// How far it is from the one value to the other, in [0, 1].
    fn share(self, last: Last) -> f64 {
        let steps = match last {
            Last::End => self.of.saturating_sub(1),
            Last::Before => self.of,
        };
        f64::from(self.index) / f64::from(steps.max(1))
    }
}

/// The word of a sweep that leaves its end out. Only there it is one.
const UNTIL: &str = "until";

/// Reads sweeps, each of the form `name = a to b`, at a moment.
pub(super) fn sweeps(
    sources: &mut Sources,
    given: &[String],
    moment: Moment,
    settings: &mut Vec<Setting>,
) -> Vec<Diagnostic> {
    let mut diagnostics = vec![];
    for (index, text) in given.iter().enumerate() {
        let (source, whole) = setting::source(sources, "--sweep", (index, given.len()), text);
        let Some((name, value)) = setting::parts(source, text) else {
            diagnostics.push(errors::malformed_sweep(whole));
            continue;
        };
        let (value, last) = match until(&value) {
            Some(at) if until(&value[at + UNTIL.len()..]).is_some() => {
                diagnostics.push(errors::sweep_of_more(whole));
                continue;
            }
            Some(at) => (format!("{}to   {}", &value[..at], &value[at + UNTIL.len()..]), Last::Before),
            None => (value, Last::End),
        };
        let (read, slips) = syntax::parse_expression(source, &value);
        if !slips.is_empty() {
            diagnostics.extend(slips);
            continue;
        }
        let Tree::Binary { operator: BinaryOp::To, at, left, right } = read.kind else {
            diagnostics.push(errors::malformed_sweep(read.span));
            continue;
        };
        let ranges = |end: &ast::Expr| matches!(end.kind, Tree::Binary { operator: BinaryOp::To, .. });
        if ranges(&left) || ranges(&right) {
            diagnostics.push(errors::sweep_of_more(read.span));
            continue;
        }
        let word = match last {
            Last::End => at,
            Last::Before => Span::new(source, at.range().start, at.range().start + UNTIL.len()),
        };
        let share = ast::Expr { kind: Tree::Number { value: moment.share(last), int: false }, span: word };
        let value = call("mix", word, [(*left).clone(), (*right).clone(), share], read.span);
        setting::add(
            settings,
            &mut diagnostics,
            Setting { name, value, ends: Some(Box::new([*left, *right])) },
        );
    }
    diagnostics
}

/// What sweeps set at a moment, as one says it: `t = 0.5`, or `t = mix(A, B, 0.5)` where that is no single number.
pub fn words(given: &[String], moment: Moment, is_int: impl Fn(&str) -> bool) -> Vec<String> {
    let mut sources = Sources::default();
    let (settings, _) = setting::settings(&mut sources, &[], given, moment);
    let words = |setting: &Setting| {
        let [a, b] = setting.ends.as_deref()?;
        let Tree::Call { arguments, .. } = &setting.value.kind else { return None };
        let Tree::Number { value: share, .. } = arguments.last()?.value.kind else { return None };
        let int = is_int(&setting.name.text);
        let value = match (plain(a), plain(b)) {
            (Some((a, unit)), Some((b, other))) if unit == other => {
                let value = a * (1.0 - share) + b * share;
                // There is no whole number `-0`.
                format!("{}{unit}", if int { value.round() + 0.0 } else { value })
            }
            _ => {
                let mix = format!("mix({}, {}, {share})", sources.text(a.span), sources.text(b.span));
                if int { format!("round({mix})") } else { mix }
            }
        };
        Some(format!("{} = {value}", setting.name.text))
    };
    settings.iter().filter_map(words).collect()
}

/// What a number is, and its unit, where nothing is computed: `3`, `-90deg`.
fn plain(value: &ast::Expr) -> Option<(f64, &str)> {
    match &value.kind {
        Tree::Number { value, .. } => Some((*value, "")),
        Tree::Quantity { value, unit } => Some((*value, &unit.text)),
        Tree::Unary { operator: UnaryOp::Negate, operand } => {
            plain(operand).map(|(value, unit)| (-value, unit))
        }
        Tree::Paren(inner) => plain(inner),
        _ => None,
    }
}

/// Where the word stands between two values: outside of brackets and texts.
fn until(text: &str) -> Option<usize> {
    let (mut depth, mut quoted, mut escaped) = (0u32, false, false);
    let word = |c: char| c.is_alphanumeric() || c == '_';
    for (at, c) in text.char_indices() {
        match c {
            _ if escaped => escaped = false,
            '\\' if quoted => escaped = true,
            '"' => quoted = !quoted,
            _ if quoted => {}
            '(' | '[' | '{' => depth += 1,
            ')' | ']' | '}' => depth = depth.saturating_sub(1),
            _ => {}
        }
        let (before, from) = text.split_at(at);
        if depth == 0 && !quoted
            && let Some(after) = from.strip_prefix(UNTIL)
            && !before.ends_with(word) && !after.starts_with(word)
            // A name may be called so.
            && !before.trim().is_empty() && !after.trim().is_empty()
        {
            return Some(at);
        }
    }
    None
}

/// The call of a built-in function that nobody wrote, said to stand at a word.
fn call<const N: usize>(function: &str, at: Span, arguments: [ast::Expr; N], span: Span) -> ast::Expr {
    let first = Name { text: function.into(), span: at };
    let arguments = arguments.into_iter().map(|value| Argument { name: None, value }).collect();
    ast::Expr { kind: Tree::Call { function: Path { first, rest: vec![] }, arguments }, span }
}

impl Checker<'_> {
    /// The value of a param at a moment of its sweep. Both ends must be values of its type. Of an int it is the nearest whole
    /// number.
    pub(super) fn swept_value(
        &mut self,
        name: &str,
        declared: &Declared,
        setting: &Setting,
        ends: &[ast::Expr; 2],
    ) -> Expr {
        let invalid = Expr::invalid(setting.value.span);
        let mixes = matches!(
            declared.ty(),
            Type::Scalar(_) | Type::Tuple(..) | Type::Color | Type::Texture | Type::Invalid
        );
        if !mixes {
            self.report(errors::sweeps_nothing(name, &declared.describe(), setting.value.span));
            return invalid;
        }
        let ends = ends.each_ref().map(|end| self.declared_value(name, declared, end));
        if ends.iter().any(|end| matches!(end.kind, ExprKind::Invalid)) {
            return invalid;
        }
        if *declared == Declared::Field(FieldType::Int) {
            let span = setting.value.span;
            let rounded = call("round", span, [setting.value.clone()], span);
            return self.declared_value(name, declared, &rounded);
        }
        self.declared_value(name, declared, &setting.value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_frame_has_the_end_or_comes_before_it() {
        let shares =
            |of: u32, last: Last| (0..of).map(|index| Moment { index, of }.share(last)).collect::<Vec<f64>>();
        assert_eq!(shares(5, Last::End), [0.0, 0.25, 0.5, 0.75, 1.0]);
        assert_eq!(shares(4, Last::Before), [0.0, 0.25, 0.5, 0.75]);
        assert_eq!((shares(1, Last::End), shares(1, Last::Before)), (vec![0.0], vec![0.0]));
    }

    #[test]
    fn what_a_frame_has_is_said_as_it_is_written() {
        let said = |given: &[&str]| {
            let given: Vec<String> = given.iter().copied().map(String::from).collect();
            words(&given, Moment { index: 1, of: 3 }, |name| name.starts_with('n'))
        };
        let given = ["t = 0 to 3", "angle = 0deg until 360deg", "n = 1 to 4", "at = (0, 1)m to (1, 1)m", "t"];
        assert_eq!(said(&given), ["t = 1.5", "angle = 120deg", "n = 3", "at = mix((0, 1)m, (1, 1)m, 0.5)"]);
        let signed = ["turn = -90deg to 60deg", "n = -4 until (-(1))", "near = -1 to 0.2", "nth = a to 4"];
        assert_eq!(said(&signed), ["turn = -15deg", "n = -3", "near = 0", "nth = round(mix(a, 4, 0.5))"]);
    }

    #[test]
    fn until_is_a_word_between_values_only() {
        assert_eq!(until(" 0 until 360deg"), Some(3));
        for none in [
            "0 to 1",
            "until to 5",
            "0 to until",
            "untilted until",
            "(0 until 1)",
            "\"a until b\"",
            "0untils 1",
        ] {
            assert_eq!(until(none), None, "{none}");
        }
        assert_eq!(until("f(1)until(2)"), Some(4));
    }
}
