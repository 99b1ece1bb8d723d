//! Params, parts, imports and functions: what is declared in one place and used in others.

use super::block::apart;
use super::declared::Declared;
use super::notes::Meaning;
use super::program::StatementKind;
use super::program::{Allow, Expr, ExprKind, FileId, FunctionBody, FunctionId, Param, Part, PartId};
use super::scope::{Item, Place};
use super::types::Type;
use super::{Checker, errors};
use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::schema::{self, Category, PLACED, camera};
use crate::span::Span;
use crate::syntax;
use crate::syntax::ast::StatementKind as TreeStatement;
use crate::syntax::ast::{self, BinaryOp, ExprKind as Tree, Name, Parameter, TypeName};
use smol_str::SmolStr;

/// What a call, or a use of a part, counts by itself, in expressions: about as long as it takes.
const CALL: u64 = 9;

impl<'a> Checker<'a> {
    /// A whole file as a part.
    pub(super) fn file(&mut self, tree: &ast::File, main: bool) -> PartId {
        let (items, fields) = apart(&tree.body.entries);
        let place = if main { Place::Main } else { Place::Imported };
        self.cameras = items.iter().filter_map(camera_name).collect();
        let part = self.body("", &items, &fields, place, tree.body.span, None);
        self.say_closed();
        part
    }

    /// `part name { … }`
    pub(super) fn part(
        &mut self,
        name: &Name,
        body: &ast::Body,
        statement: &ast::Statement,
        place: Place,
    ) -> (StatementKind, Type) {
        if !matches!(place, Place::Main | Place::Imported | Place::Part) {
            self.report(errors::not_here("part", name, "a file or another part"));
            self.quietly(|checker| checker.part(name, body, statement, Place::Part));
            return (StatementKind::Nothing, Type::Invalid);
        }
        let (items, fields) = apart(&body.entries);
        let part = self.body(&name.text, &items, &fields, Place::Part, body.span, statement.doc.clone());
        (StatementKind::Nothing, Type::Part(part))
    }

    fn body(
        &mut self,
        name: &str,
        items: &[Item],
        fields: &[&ast::Field],
        place: Place,
        span: Span,
        doc: Option<smol_str::SmolStr>,
    ) -> PartId {
        let before = self.nodes;
        let params = std::mem::take(&mut self.params);
        self.params = items
            .iter()
            .filter_map(|item| match item {
                Item::Statement(statement) => match &statement.kind {
                    TreeStatement::Param { name, .. } => Some((name.text.clone(), None)),
                    _ => None,
                },
                Item::Rows(_) | Item::Broken(_) => None,
            })
            .collect();
        self.begin_frame();
        let mut block = self.open(items, place, span);
        let fields = match place {
            Place::Part => self.part_fields(fields),
            _ => {
                self.stray(items, fields, "a file");
                vec![]
            }
        };
        let inside = self.keep_names();
        self.close(Some(&mut block));
        let slots = self.end_frame();
        let found = std::mem::replace(&mut self.params, params);
        // One that is not there had an error, such as a name twice.
        let params = found.into_iter().filter_map(|(_, param)| param).collect();
        let cost = self.nodes - before + CALL;
        self.program.parts.push(Part { name: name.into(), params, block, fields, slots, inside, cost, doc });
        PartId(self.program.parts.len() as u32 - 1)
    }

    /// What a part says of all its members: their material, and where they stand.
    fn part_fields(&mut self, fields: &[&ast::Field]) -> Vec<(usize, Expr)> {
        let mut found: Vec<(usize, Expr)> = vec![];
        let mut first = [None; PLACED.len()];
        for field in fields {
            let Some(index) = PLACED.iter().position(|placed| placed.name == field.name.text) else {
                self.report(errors::field_of_part(&field.name));
                self.infer(&field.value);
                continue;
            };
            self.note(field.name.span, Some(Meaning::Placed(index)));
            let value = self.field_value(&PLACED[index], &field.value);
            match first[index] {
                Some(first) => self.report(errors::repeated(&field.name, first)),
                None => {
                    first[index] = Some(field.name.span);
                    found.push((index, value));
                }
            }
        }
        found
    }

    /// `param name: type = default in low to high`
    pub(super) fn param(
        &mut self,
        name: &Name,
        ty: &TypeName,
        default: &ast::Expr,
        range: Option<&ast::Expr>,
        place: Place,
    ) -> (StatementKind, Type) {
        // Statements inside the default have their own.
        let doc = self.doc.take();
        if PLACED.iter().any(|field| name.text == field.name) && !syntax::RESERVED.contains(&&*name.text) {
            self.report(errors::param_hides_field(name));
        }
        let declared = self.declared(ty);
        let (mut value, fits) = self.fitting_value(&name.text, &declared, default);
        let range_found = range.and_then(|range| self.range(name, &declared, range));
        let outside = range_found.as_ref().and_then(|range| self.literal_outside(&name.text, &value, range));
        if let Some(diagnostic) = outside {
            self.report(diagnostic);
            value = Expr::invalid(value.span);
        }
        if !matches!(place, Place::Main | Place::Imported | Place::Part) {
            self.report(errors::not_here("param", name, "a file or a part"));
            return (StatementKind::Nothing, declared.ty());
        }
        let settings = if place == Place::Main { self.settings } else { &[] };
        let set = settings.iter().find(|setting| setting.name.text == name.text);
        if let Some(setting) = set {
            value = match &setting.ends {
                Some(ends) => self.swept_value(&name.text, &declared, setting, ends),
                None => self.declared_value(&name.text, &declared, &setting.value),
            };
        }
        // Of a type that its default does not have, which of the two was meant is not known.
        let ty = if fits { declared.ty() } else { Type::Invalid };
        let default = self.text(default.span).into();
        let scope = self.current();
        let Some(known) = scope.names.get(&name.text).map(|&known| &scope.known[known]) else {
            return (StatementKind::Invalid, ty);
        };
        // A second one of the name is reported, and no param.
        if known.name.span != name.span {
            return (StatementKind::Nothing, ty);
        }
        let (slot, span) = (known.slot, name.span);
        let index = self.params.iter().position(|(known, _)| *known == name.text);
        let Some(index) = index else { return (StatementKind::Nothing, ty) };
        let param = Param {
            name: name.text.clone(),
            declared,
            default: value,
            written: default,
            set: set.is_some(),
            range: range_found,
            slot,
            doc,
            span,
        };
        self.params[index].1 = Some(param);
        (StatementKind::Param(index), ty)
    }

    /// `low to high` behind `in`.
    fn range(&mut self, name: &Name, declared: &Declared, range: &ast::Expr) -> Option<[Expr; 2]> {
        let Tree::Binary { operator: BinaryOp::To, left, right, .. } = &range.kind else {
            if !matches!(range.kind, Tree::Invalid) {
                self.infer(range);
                self.report(errors::not_a_range(range.span));
            }
            return None;
        };
        if !matches!(declared.ty(), Type::Scalar(_) | Type::Invalid) {
            [left, right].into_iter().for_each(|end| drop(self.infer(end)));
            self.report(errors::range_of_what(range.span, &declared.describe()));
            return None;
        }
        let ends = [left, right].map(|end| self.declared_value(&name.text, declared, end));
        if let (Some(low), Some(high)) = (literal(&ends[0]), literal(&ends[1]))
            && low > high
        {
            self.report(errors::empty_range(range.span, self.text(left.span), self.text(right.span)));
            return None;
        }
        (declared.ty() != Type::Invalid).then_some(ends)
    }

    /// What can be seen to be out of range before anything is evaluated.
    pub(super) fn literal_outside(&self, name: &str, value: &Expr, range: &[Expr; 2]) -> Option<Diagnostic> {
        let (x, low, high) = (literal(value)?, literal(&range[0])?, literal(&range[1])?);
        let [low_text, high_text, text] = [&range[0], &range[1], value].map(|end| self.text(end.span));
        let outside = || errors::outside_range(name, [low_text, high_text], text, value.span);
        (!(low..=high).contains(&x)).then(outside)
    }

    /// A value where a type was declared.
    pub(super) fn declared_value(&mut self, name: &str, declared: &Declared, value: &ast::Expr) -> Expr {
        self.fitting_value(name, declared, value).0
    }

    /// The same, and whether the value is of the type, as far as both are known.
    fn fitting_value(&mut self, name: &str, declared: &Declared, value: &ast::Expr) -> (Expr, bool) {
        if let Some(diagnostic) = self.unknown_declared(declared, value) {
            self.report_lost(&self.text(value.span).into(), diagnostic);
            return (Expr::invalid(value.span), true);
        }
        let (checked, ty) = self.infer(value);
        if ty == Type::Invalid || *declared == Declared::Invalid {
            return (Expr::invalid(value.span), true);
        }
        if !declared.accepts(&ty) {
            let text = self.text(value.span);
            let diagnostic = match declared {
                Declared::Field(field) => errors::mismatch(name, *field, value.span, text, &ty),
                other => errors::mismatch_declared(name, &other.describe(), value.span, &ty),
            };
            self.report(diagnostic);
            return (Expr::invalid(value.span), false);
        }
        if let Type::Made(making) = ty {
            self.complete(making, value.span, super::make::body_of(value));
        }
        (checked, true)
    }

    /// `import "file.rt" as name`
    pub(super) fn import(
        &mut self,
        statement: &ast::Statement,
        name: &Name,
        place: Place,
    ) -> (StatementKind, Type) {
        if !matches!(place, Place::Main | Place::Imported) {
            self.report(errors::not_here("import", name, "the top level of a file"));
            return (StatementKind::Nothing, Type::Invalid);
        }
        let file = self.imports.get(&statement.span).copied();
        (StatementKind::Nothing, file.map_or(Type::Invalid, Type::File))
    }

    /// `fn name(…) -> type = value`
    pub(super) fn function(
        &mut self,
        name: &Name,
        parameters: &[Parameter],
        result: &TypeName,
        value: &ast::Expr,
        statement: &ast::Statement,
        place: Place,
    ) -> (StatementKind, Type) {
        if !matches!(place, Place::Main | Place::Imported | Place::Part) {
            self.report(errors::not_here("fn", name, "a file or a part"));
            self.quietly(|checker| checker.function(name, parameters, result, value, statement, Place::Part));
            return (StatementKind::Nothing, Type::Invalid);
        }
        let before = self.nodes;
        self.begin_frame();
        let mut scope = self.scope(Place::Parameters, statement.span);
        let mut taken = vec![];
        for parameter in parameters {
            let declared = self.declared(&parameter.ty);
            self.declare_alone(&mut scope, &parameter.name, declared.ty(), false);
            taken.push((parameter.name.text.clone(), declared));
        }
        let result = self.declared(result);
        self.scopes.push(scope);
        let (value, fits) = self.fitting_value(&name.text, &result, value);
        let result = if fits { result } else { Declared::Invalid };
        self.close(None);
        let slots = self.end_frame();
        self.program.functions.push(FunctionBody {
            name: name.text.clone(),
            parameters: taken,
            result,
            value,
            slots,
            cost: self.nodes - before + CALL,
            doc: statement.doc.clone(),
        });
        let id = FunctionId(self.program.functions.len() as u32 - 1);
        (StatementKind::Nothing, Type::Function(id))
    }

    /// What stands before a statement: whether it is left out, and whether all others are.
    pub(super) fn prefixes(&mut self, statement: &ast::Statement) -> (bool, bool) {
        let (mut off, mut solo) = (false, false);
        self.doc = statement.doc.clone();
        for prefix in &statement.prefixes {
            let word = prefix.name.text.as_str();
            let drawn = matches!(
                statement.kind,
                TreeStatement::Thing { .. } | TreeStatement::For { .. } | TreeStatement::If { .. }
            );
            let asserts = matches!(statement.kind, TreeStatement::Assert { .. });
            match word {
                "off" | "solo" if prefix.arguments.is_some() => {
                    self.report(errors::prefix_arguments(prefix));
                }
                "off" if drawn || asserts => off = true,
                "solo" if drawn && !is_block(statement) => solo = true,
                "off" | "solo" => self.report(errors::prefix_on_what(prefix)),
                "allow" => self.allow(prefix, statement),
                "" => {}
                _ => self.report(errors::unknown_prefix(&prefix.name)),
            }
        }
        (off, solo)
    }

    fn allow(&mut self, prefix: &ast::Prefix, statement: &ast::Statement) {
        let arguments = prefix.arguments.as_deref().unwrap_or(&[]);
        let [code, why] = arguments else { return self.report(errors::allow_arguments(prefix)) };
        if code.name.is_some() || !matches!(why.value.kind, Tree::Text(_) | Tree::Invalid) {
            return self.report(errors::allow_arguments(prefix));
        }
        let written = match &code.value.kind {
            Tree::Name(name) | Tree::Text(name) => name.clone(),
            Tree::Invalid => return,
            _ => return self.report(errors::allow_arguments(prefix)),
        };
        let found =
            Code::ALL.iter().copied().find(|code| *written == *code.as_str() || *written == code.name());
        match found {
            Some(code) if code.severity() == Severity::Warning => {
                let behind = &self.sources.get(prefix.span.source).text[prefix.span.range().end..];
                let blank = behind.len() - behind.trim_ascii_start().len();
                let all = Span { end: prefix.span.end + blank as u32, ..prefix.span };
                self.program.allows.push(Allow { code, on: statement.span, span: prefix.span, all });
            }
            Some(code) => self.report(errors::allow_error(code, prefix)),
            None => {
                let name = Name { text: written, span: code.value.span };
                self.report(errors::allow_what(&name));
            }
        }
    }

    /// The type of a name inside an imported file.
    pub(super) fn exported(&self, file: FileId, name: &str) -> Option<&super::program::InsideName> {
        let part = self.program.part(self.program.files[file.index()].part);
        self.program.insides[part.inside.index()].names.get(name)
    }
}

/// Whether it is one of the blocks that say how the picture is taken, which is no part of it.
fn is_block(statement: &ast::Statement) -> bool {
    let TreeStatement::Thing { construct, .. } = &statement.kind else { return false };
    let kind = schema::kind(&construct.kind.first.text);
    kind.is_some_and(|kind| kind.get().category == Category::Block)
}

/// The name of a camera.
fn camera_name(item: &Item) -> Option<SmolStr> {
    let Item::Statement(ast::Statement { kind: TreeStatement::Thing { construct, name }, .. }) = item else {
        return None;
    };
    let name = name.as_ref().filter(|_| construct.kind.first.text == camera::KIND.get().name)?;
    Some(name.text.clone())
}

/// The value of a number as written, sign included.
fn literal(value: &Expr) -> Option<f64> {
    match &value.kind {
        ExprKind::Number(x) => Some(*x),
        ExprKind::Unary { operator: ast::UnaryOp::Negate, operand } => literal(operand).map(|x| -x),
        _ => None,
    }
}
