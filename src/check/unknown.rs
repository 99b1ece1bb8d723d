//! Names that nothing declares: what was probably meant, by what is wanted where they stand.

use super::declared::Declared;
use super::types::Type;
use super::{Checker, errors};
use crate::diagnostic::Diagnostic;
use crate::schema::{self, FieldType};
use crate::span::Span;
use crate::syntax::ast::{self, ExprKind as Tree, Name};
use smol_str::SmolStr;

impl Checker<'_> {
    /// What is wrong with a value that is an unknown name, where a field wants a type.
    pub(super) fn unknown_value(&mut self, wanted: FieldType, value: &ast::Expr) -> Option<Diagnostic> {
        let first = match &value.kind {
            Tree::Name(name) => name,
            // What looks like a member may be the end of a file's name.
            Tree::Member { value, .. } if wanted == FieldType::Text => match &value.kind {
                Tree::Name(name) => name,
                _ => return None,
            },
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

    /// The declared name that a text in quotes is, and what it names.
    pub(super) fn quoted(&mut self, value: &ast::Expr) -> Option<(Name, Type)> {
        let Tree::Text(text) = &value.kind else { return None };
        let found = self.is_declared(text).then(|| self.lookup(text))??;
        Some((Name { text: text.clone(), span: value.span }, found.ty))
    }

    /// Whether a place lies in a setting from outside.
    pub(super) fn is_setting(&self, span: Span) -> bool {
        self.settings.iter().any(|setting| setting.value.span.source == span.source)
    }
}
