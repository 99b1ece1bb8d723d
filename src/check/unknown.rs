//! Names that nothing declares: what was probably meant, by what is wanted where they stand.

use super::declared::Declared;
use super::functions::Function;
use super::scope::Scope;
use super::types::Type;
use super::{Checker, Expr, errors};
use crate::diagnostic::Diagnostic;
use crate::schema::{self, FieldType};
use crate::span::Span;
use crate::syntax::RESERVED;
use crate::syntax::ast::{self, ExprKind as Tree, Name};
use smol_str::SmolStr;

impl Checker<'_> {
    /// What is wrong with a value that is an unknown name, where a field wants a type.
    pub(super) fn unknown_value(&mut self, wanted: FieldType, value: &ast::Expr) -> Option<Diagnostic> {
        let first = match &value.kind {
            Tree::Name(name) => name,
            // What looks like a member, or a division, may be the name of a file.
            _ if wanted == FieldType::Text => first_of_path(value)?,
            _ => return None,
        };
        if self.lookup(first).is_some() {
            return None;
        }
        let name = Name { text: self.text(value.span).trim().into(), span: value.span };
        if matches!(wanted, FieldType::Named(_)) && schema::kind(&name.text).is_none() {
            let cameras: Vec<&str> = self.cameras.iter().map(SmolStr::as_str).collect();
            return Some(errors::unknown_camera(&name, &cameras));
        }
        Some(errors::unknown_value(wanted, &name, &self.value_names(), self.is_setting(value.span)))
    }

    /// The same where a param wants it.
    pub(super) fn unknown_declared(&mut self, wanted: &Declared, value: &ast::Expr) -> Option<Diagnostic> {
        match wanted {
            Declared::Field(wanted) => self.unknown_value(*wanted, value),
            _ => None,
        }
    }

    /// The type of what should be the path of a file.
    pub(super) fn infer_path(&mut self, value: &ast::Expr) -> (Expr, Type) {
        match self.unknown_value(FieldType::Text, value) {
            Some(diagnostic) => {
                self.report(diagnostic);
                (Expr::invalid(value.span), Type::Invalid)
            }
            None => self.infer(value),
        }
    }

    /// The declared name that a text in quotes is, and what it names.
    pub(super) fn quoted(&mut self, value: &ast::Expr) -> Option<(Name, Type)> {
        let Tree::Text(text) = &value.kind else { return None };
        let found = self.is_declared(text).then(|| self.lookup(text))??;
        Some((Name { text: text.clone(), span: value.span }, found.ty))
    }

    /// Offers the mend of an unknown name, the next diagnostic, in place of making it, where another may be meant: a name
    /// that is only half typed, or one that is mistyped where it is declared. That a name has other uses is known when its
    /// scope is closed.
    pub(super) fn ask_unless_sure(&mut self, name: &str, diagnostic: Diagnostic) -> Diagnostic {
        let Some(meant) = replacement(&diagnostic) else { return diagnostic };
        let longer = |word: &str| word.len() > name.len() && word.starts_with(name) && word != meant;
        let half_typed = RESERVED.iter().any(|word| longer(word))
            || Function::ALL.iter().any(|function| longer(function.name()))
            || self.scopes.iter().any(|scope| scope.names.keys().any(|word| longer(word)));
        if half_typed || self.scopes.iter().any(|scope| scope.nameless) {
            return ask(diagnostic);
        }
        let declaring = self.scopes.iter_mut().rev().find(|scope| scope.names.contains_key(meant));
        if let Some(scope) = declaring {
            if scope.known[scope.names[meant]].doubtful {
                return ask(diagnostic);
            }
            scope.guessed.push(self.diagnostics.len());
        }
        diagnostic
    }

    /// Offers the mends to names of a scope that have no other use.
    pub(super) fn ask_of_unused(&mut self, scope: &Scope) {
        for &index in &scope.guessed {
            let known = replacement(&self.diagnostics[index]).and_then(|meant| scope.names.get(meant));
            if known.is_some_and(|&known| !scope.known[known].used) {
                self.diagnostics[index] = ask(self.diagnostics[index].clone());
            }
        }
    }

    /// Whether a place lies in a setting from outside.
    pub(super) fn is_setting(&self, span: Span) -> bool {
        self.settings.iter().any(|setting| setting.value.span.source == span.source)
    }
}

/// What a mend puts in place of a name.
fn replacement(diagnostic: &Diagnostic) -> Option<&str> {
    match &diagnostic.fix.as_ref()?.edits[..] {
        [(_, meant)] => Some(meant),
        _ => None,
    }
}

/// Offers to replace a name in place of doing it.
pub(super) fn ask(diagnostic: Diagnostic) -> Diagnostic {
    match replacement(&diagnostic).map(|meant| format!("replace it with `{meant}`")) {
        Some(title) => diagnostic.ask(title),
        None => diagnostic,
    }
}

/// The first name of what may be the path of a file without quotes: `maps/oak.png`.
fn first_of_path(value: &ast::Expr) -> Option<&SmolStr> {
    match &value.kind {
        Tree::Name(name) => Some(name),
        Tree::Member { value, .. } => first_of_path(value),
        Tree::Binary { operator: ast::BinaryOp::Divide, left, right, .. } => {
            first_of_path(right)?;
            first_of_path(left)
        }
        _ => None,
    }
}
