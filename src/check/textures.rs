//! Calls of the functions that make textures: arguments by place or name, some with defaults.

use super::functions::Function;
use super::make::accepts;
use super::types::Type;
use super::{Checker, Expr, ExprKind, check_value, errors};
use crate::diagnostic::Code;
use crate::schema::{Field, Preset, textures};
use crate::span::{SourceId, Span};
use crate::syntax::{self, ast::Argument};

/// What a function takes that makes a texture; none for the others.
pub fn parameters(function: Function) -> Option<&'static [Field]> {
    Some(match function {
        Function::Checker => textures::CHECKER,
        Function::Stripes => textures::STRIPES,
        Function::Noise => textures::NOISE,
        Function::Image => textures::IMAGE,
        _ => return None,
    })
}

impl Checker<'_> {
    /// Checks a call by what the function takes. The arguments come out in its order, defaults among them.
    pub(super) fn texture(
        &mut self,
        function: Function,
        parameters: &'static [Field],
        arguments: &[Argument],
        values: Vec<(Expr, Type)>,
        span: Span,
    ) -> (ExprKind, Type) {
        const INVALID: (ExprKind, Type) = (ExprKind::Invalid, Type::Invalid);
        // With too few of them by place, which is which is not known.
        let named = arguments.iter().any(|argument| argument.name.is_some());
        let required = parameters.iter().filter(|field| field.default == Preset::Required).count();
        if !named && arguments.len() < required {
            self.report(errors::argument_count(function, span, arguments.len()));
            return INVALID;
        }
        let mut given: Vec<Option<Expr>> = parameters.iter().map(|_| None).collect();
        let mut sound = true;
        for (place, (argument, (value, ty))) in arguments.iter().zip(values).enumerate() {
            let index = match &argument.name {
                None => Some(place).filter(|&place| place < parameters.len() && given[place].is_none()),
                Some(name) => {
                    let index = parameters.iter().position(|field| field.name == name.text);
                    if index.is_none() {
                        let names: Vec<&str> = parameters.iter().map(|field| field.name).collect();
                        self.report(errors::unknown(Code::E0101, "argument", name, &names));
                        return INVALID;
                    }
                    index.filter(|&index| given[index].is_none())
                }
            };
            let Some(index) = index else {
                self.report(errors::argument_count(function, span, arguments.len()));
                return INVALID;
            };
            if !accepts(parameters[index].ty, &ty) {
                let text = self.text(value.span);
                self.report(errors::mismatch(
                    parameters[index].name,
                    parameters[index].ty,
                    value.span,
                    text,
                    &ty,
                ));
            }
            sound &= ty != Type::Invalid && accepts(parameters[index].ty, &ty);
            given[index] = Some(value);
        }
        let missing =
            |(given, field): (&Option<Expr>, &Field)| given.is_none() && field.default == Preset::Required;
        if given.iter().zip(parameters).any(missing) {
            self.report(errors::argument_count(function, span, arguments.len()));
            return INVALID;
        }
        if !sound {
            return INVALID;
        }
        let complete = given.into_iter().zip(parameters);
        let arguments =
            complete.map(|(given, field)| given.unwrap_or_else(|| default(field, span))).collect();
        (ExprKind::Call { function, arguments }, Type::Texture)
    }
}

/// The default of a parameter, as if written at the call.
fn default(field: &'static Field, span: Span) -> Expr {
    let Preset::Value(text) = field.default else { return Expr::invalid(span) };
    // The place is never shown: a test holds that no default has an error.
    let (tree, _) = syntax::parse_expression(SourceId(u32::MAX), text);
    let (value, _) = check_value(field, &tree);
    Expr { span, ..value }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_default_is_a_value_of_its_parameter() {
        for field in Function::ALL.iter().filter_map(|function| parameters(*function)).flatten() {
            let Preset::Value(text) = field.default else { continue };
            let (tree, slips) = syntax::parse_expression(SourceId(0), text);
            assert_eq!(slips, [], "{text}");
            assert_eq!(check_value(field, &tree).1, [], "{text}");
        }
    }
}
