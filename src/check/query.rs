//! What is asked of values: components, items, fields, names by path; and calls of declared functions.

use super::block::path_span;
use super::declared::field_type;
use super::functions;
use super::notes::Meaning;
use super::program::{Around, Corner, FieldPlace, FileId};
use super::types::{Element, Kind, Making, Type};
use super::{Checker, Expr, ExprKind, errors};
use crate::diagnostic::Code;
use crate::schema::{Field, PLACED, Preset};
use crate::span::Span;
use crate::syntax::ast::{self, Argument, Name};
use crate::units;

const INVALID: (ExprKind, Type) = (ExprKind::Invalid, Type::Invalid);

impl Checker<'_> {
    /// `[a, b]`
    pub(super) fn list(&mut self, items: &[ast::Expr]) -> (ExprKind, Type) {
        let (values, types): (Vec<Expr>, Vec<Type>) = items.iter().map(|item| self.infer(item)).unzip();
        let mut joined = Type::Invalid;
        for (index, ty) in types.iter().enumerate() {
            match joined.join(ty) {
                Some(both) => joined = both,
                None => {
                    let (first, span) = (values[0].span, values[index].span);
                    self.report(errors::mixed_list([(first, &joined), (span, ty)]));
                    return INVALID;
                }
            }
        }
        if !values.is_empty() && types.contains(&Type::Invalid) {
            return INVALID;
        }
        if let Type::Made(Making { kind: Kind::Material | Kind::Thing, .. }) = joined {
            self.complete_all(&values, &types);
        }
        (ExprKind::List(values), Type::list(joined))
    }

    fn complete_all(&mut self, values: &[Expr], types: &[Type]) {
        for (value, ty) in values.iter().zip(types) {
            if let Type::Made(making) = ty {
                self.complete(*making, value.span, None);
            }
        }
    }

    /// `low to high`: whole numbers, both included.
    pub(super) fn to(&mut self, left: Expr, right: Expr, types: [Type; 2]) -> (ExprKind, Type) {
        let ends: Vec<(Span, &Type)> = [left.span, right.span].into_iter().zip(&types).collect();
        let wrong = |(_, ty): &&(Span, &Type)| !matches!(ty, Type::Scalar(element) if element.is_int());
        let wrong: Vec<_> = ends.iter().filter(wrong).collect();
        let sound = wrong.is_empty();
        match wrong[..] {
            // One slip.
            [(first, a), (second, b)] if a.describe() == b.describe() => {
                self.report(errors::to_of_what(*first, a).label(*second, "so is this"));
            }
            _ => wrong.iter().for_each(|(end, ty)| self.report(errors::to_of_what(*end, ty))),
        }
        let (left, right) = (Box::new(left), Box::new(right));
        let kind = ExprKind::Binary { operator: ast::BinaryOp::To, dim: units::NONE, left, right };
        if sound { (kind, Type::list(Type::Scalar(Element::Int))) } else { INVALID }
    }

    /// `list[index]`
    pub(super) fn index(&mut self, value: &ast::Expr, index: &ast::Expr) -> (ExprKind, Type) {
        let (value, ty) = self.infer(value);
        let (index, index_ty) = self.infer(index);
        let whole = match &index_ty {
            Type::Invalid => false,
            Type::Scalar(element) if element.is_int() => true,
            ty => {
                self.report(errors::index_of_what(index.span, ty));
                false
            }
        };
        match ty {
            Type::List(item) if whole => {
                let item = match &*item {
                    Type::Scalar(Element::Zero) => Type::Scalar(Element::Int),
                    item => item.clone(),
                };
                (ExprKind::Index { value: Box::new(value), index: Box::new(index) }, item)
            }
            Type::List(_) | Type::Invalid => INVALID,
            ty => {
                self.report(errors::not_a_list(value.span, &ty));
                INVALID
            }
        }
    }

    /// `if c then a else b`
    pub(super) fn choice(
        &mut self,
        condition: &ast::Expr,
        then: &ast::Expr,
        otherwise: &ast::Expr,
    ) -> (ExprKind, Type) {
        let condition = self.condition("if", condition);
        let (then, a) = self.infer(then);
        let (otherwise, b) = self.infer(otherwise);
        if a == Type::Invalid || b == Type::Invalid {
            return INVALID;
        }
        let Some(ty) = a.join(&b) else {
            self.report(errors::branches([(then.span, &a), (otherwise.span, &b)]));
            return INVALID;
        };
        if let Type::Made(Making { kind: Kind::Material | Kind::Thing, .. }) = ty {
            for (value, ty) in [(&then, &a), (&otherwise, &b)] {
                if let Type::Made(making) = ty {
                    self.complete(*making, value.span, None);
                }
            }
        }
        // A zero that was chosen is a whole number like others.
        let ty = if ty == Type::Scalar(Element::Zero) { Type::Scalar(Element::Int) } else { ty };
        (ExprKind::If(Box::new([condition, then, otherwise])), ty)
    }

    /// `value.member`
    pub(super) fn member(&mut self, value: &ast::Expr, member: &Name) -> (ExprKind, Type) {
        let (value, ty) = self.infer_name(value);
        let value = Box::new(value);
        match &ty {
            Type::Invalid => INVALID,
            Type::File(file) => match self.exported(*file, &member.text) {
                Some(name) => {
                    let (name, meaning) = (name.clone(), Meaning::Declared(name.place));
                    self.note(member.span, Some(meaning));
                    if matches!(name.ty, Type::Thing(_)) {
                        self.report(errors::thing_of_file(member));
                        return INVALID;
                    }
                    (ExprKind::FileName { file: *file, slot: name.slot }, name.ty)
                }
                None => {
                    self.report_not_in_file(*file, member, "name");
                    INVALID
                }
            },
            Type::Tuple(count, element) => match axis(member).filter(|axis| axis < count) {
                Some(axis) => {
                    self.note(member.span, Some(Meaning::Component));
                    (ExprKind::Component { value, axis }, Type::Scalar(*element))
                }
                None => self.no_member(member, &ty),
            },
            Type::Bounds => {
                let corner = match member.text.as_str() {
                    "min" => Corner::Min,
                    "max" => Corner::Max,
                    "center" => Corner::Center,
                    "size" => Corner::Size,
                    _ => return self.no_member(member, &ty),
                };
                self.note(member.span, Some(Meaning::Component));
                (ExprKind::Corner { value, corner }, Type::Tuple(3, Element::Quantity(units::LENGTH)))
            }
            Type::Row(table) => {
                let table = self.program.tables[table.index()].clone();
                match table.columns.iter().position(|column| column.name == member.text) {
                    Some(column) => {
                        self.note(member.span, Some(Meaning::Component));
                        let ty = super::table::column_type(&table.columns[column]);
                        (ExprKind::Column { value, column }, ty)
                    }
                    None => {
                        let names: Vec<&str> =
                            table.columns.iter().map(|column| column.name.as_str()).collect();
                        self.report(errors::unknown_column(member, &names));
                        INVALID
                    }
                }
            }
            Type::Made(making) => self.field_of(*value, *making, false, member),
            Type::Thing(making) => self.field_of(*value, *making, true, member),
            ty => self.no_member(member, ty),
        }
    }

    fn no_member(&mut self, member: &Name, ty: &Type) -> (ExprKind, Type) {
        self.report(errors::no_member(member, ty));
        INVALID
    }

    /// A name inside a thing, or a field of it.
    fn field_of(&mut self, value: Expr, making: Making, drawn: bool, member: &Name) -> (ExprKind, Type) {
        let inside = match making.kind {
            Kind::Part(part) => Some(self.program.part(part).inside),
            _ => making.inside,
        };
        let found = inside.and_then(|inside| self.program.insides[inside.index()].names.get(&member.text));
        let found = found.cloned();
        self.note(member.span, found.as_ref().map(|name| Meaning::Declared(name.place)));
        if let Some(name) = found.clone().filter(|_| drawn) {
            let reaches = !matches!(&name.ty, Type::Part(_) | Type::File(_) | Type::Function(_))
                && !matches!(&name.ty, Type::Made(Making { kind: Kind::Part(_) | Kind::Thing, .. }));
            if !reaches {
                self.report(errors::hidden_inside(member, &name.ty));
                return INVALID;
            }
            return (ExprKind::Inside { value: Box::new(value), slot: name.slot }, name.ty);
        }
        if found.is_some() {
            let (prototype, kind) = (self.text(value.span), self.kind_name(making.kind));
            self.report(errors::inside_prototype(prototype, member, &kind));
            return INVALID;
        }
        let Some(place) = self.find_field(making.kind, &member.text) else {
            let mut names: Vec<String> = inside.filter(|_| drawn).map_or(vec![], |inside| {
                self.program.insides[inside.index()].names.keys().map(|name| name.to_string()).collect()
            });
            names.extend(self.field_names(making.kind));
            self.report(errors::nothing_called(member, &self.kind_name(making.kind), &names));
            return INVALID;
        };
        let ty = match (making.kind, place) {
            (Kind::Part(part), FieldPlace::Param(index)) => {
                Some(self.program.part(part).params[index].declared.ty())
            }
            (Kind::BuiltIn(kind), FieldPlace::Index(index)) => {
                self.known_field(kind.field(index), making.given.has(index), member)
            }
            (Kind::Part(_), FieldPlace::Placed(index)) => {
                self.known_field(&PLACED[index], making.given.has(index), member)
            }
            (_, FieldPlace::Placed(index)) => self.known_field(&PLACED[index], true, member),
            _ => None,
        };
        self.note(member.span, self.meaning(making.kind, place));
        let Some(ty) = ty else { return INVALID };
        (ExprKind::Field { value: Box::new(value), field: place }, ty)
    }

    /// The type of a field that is given or has a default; what has neither cannot be asked for.
    fn known_field(&mut self, field: &'static Field, given: bool, member: &Name) -> Option<Type> {
        let known = given || matches!(field.default, Preset::Value(_)) || field.name == "place";
        let ty = field_type(field.ty);
        match (known, ty) {
            (true, Some(ty)) => Some(ty),
            (false, Some(_)) => {
                self.report(errors::field_not_given(field, member));
                None
            }
            (_, None) => {
                self.report(errors::field_not_asked(field, member));
                None
            }
        }
    }

    /// Says that a file declares no such name.
    pub(super) fn report_not_in_file(&mut self, file: FileId, name: &Name, what: &str) {
        let part = self.program.part(self.program.files[file.index()].part);
        let names = &self.program.insides[part.inside.index()].names;
        let names: Vec<&str> = names.keys().map(|name| name.as_str()).collect();
        let source = self.program.files[file.index()].source;
        let diagnostic = errors::not_in_file(name, what, &self.sources.get(source).name, &names);
        self.report(diagnostic);
    }

    /// A call: of a built-in function, or of a declared one.
    pub(super) fn call(&mut self, path: &ast::Path, arguments: &[Argument], span: Span) -> (ExprKind, Type) {
        if path.rest.is_empty() {
            if let Some(function) = functions::by_name(&path.first.text) {
                self.note(path.first.span, Some(Meaning::Function(function)));
            }
            if &*path.first.text == "table" {
                return self.table(arguments, span);
            }
            if let Some(function) = functions::by_name(&path.first.text) {
                return self.call_built_in(function, arguments, span);
            }
        }
        match self.declared_function(path) {
            Some((function, around)) => self.call_declared(path, function, around, arguments, span),
            None => {
                arguments.iter().for_each(|argument| drop(self.infer(&argument.value)));
                INVALID
            }
        }
    }

    fn declared_function(&mut self, path: &ast::Path) -> Option<(super::program::FunctionId, Around)> {
        let Some(found) = self.lookup(&path.first.text) else {
            let diagnostic = match path.rest.is_empty() {
                true => errors::unknown(Code::E0101, "function", &path.first, &self.function_names()),
                false => errors::function_of_nothing(path)
                    .unwrap_or_else(|| errors::unknown_name(&path.first, &self.value_names())),
            };
            self.report_lost(&path.first.text, diagnostic);
            return None;
        };
        self.note(path.first.span, found.meaning);
        let (mut ty, mut around) = (found.ty, Around::Up(found.up));
        for inner in &path.rest {
            let Type::File(file) = ty else { break };
            let Some(name) = self.exported(file, &inner.text) else {
                self.report_not_in_file(file, inner, "function");
                return None;
            };
            let place = name.place;
            (ty, around) = (name.ty.clone(), Around::File(file));
            self.note(inner.span, Some(Meaning::Declared(place)));
        }
        match ty {
            Type::Function(function) => Some((function, around)),
            Type::Invalid => None,
            ty => {
                self.report(errors::not_a_function(self.text(path_span(path)), path_span(path), &ty));
                None
            }
        }
    }

    fn call_declared(
        &mut self,
        path: &ast::Path,
        function: super::program::FunctionId,
        around: Around,
        arguments: &[Argument],
        span: Span,
    ) -> (ExprKind, Type) {
        let body = &self.program.functions[function.index()];
        let (parameters, ty) = (body.parameters.clone(), body.result.ty());
        let name = path.rest.last().unwrap_or(&path.first);
        if let Some(label) = arguments.iter().find_map(|argument| argument.name.as_ref()) {
            self.report(errors::named_argument_of(&name.text, label));
        }
        if arguments.len() != parameters.len() {
            let signature: Vec<String> =
                parameters.iter().map(|(name, ty)| format!("{name}: {}", ty.written())).collect();
            self.report(errors::declared_argument_count(&name.text, &signature, span, arguments.len()));
            arguments.iter().for_each(|argument| drop(self.infer(&argument.value)));
            return (ExprKind::Invalid, Type::Invalid);
        }
        let values = arguments.iter().zip(&parameters);
        let values: Vec<Expr> =
            values.map(|(value, (name, ty))| self.declared_value(name, ty, &value.value)).collect();
        (ExprKind::CallDeclared { function, around, arguments: values }, ty)
    }
}

fn axis(member: &Name) -> Option<usize> {
    ["x", "y", "z"].iter().position(|axis| *axis == member.text)
}
