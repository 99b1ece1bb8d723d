//! Things: their kind, and their fields.

use super::block::{path_span, path_text};
use super::fields::one_of_several;
use super::notes::{Meaning, word_of};
use super::program::{Around, Base, Expr, ExprKind, FieldPlace, Make, Written};
use super::scope::{Item, Place, built_in};
use super::types::{Element, FieldSet, Kind, Making, Type};
use super::{Checker, errors};
use crate::diagnostic::Code;
use crate::schema::{self, Category, Field, FieldType, PLACED, Preset};
use crate::span::Span;
use crate::syntax::ast::{self, Entry, ExprKind as Tree, Name, StatementKind as Statement};
use crate::units;
use std::rc::Rc;

impl Checker<'_> {
    /// A thing, in the picture or not. What is missing is for whoever uses it to say.
    pub(super) fn make(&mut self, construct: &ast::Construct, name: Option<&Name>) -> (Make, Type) {
        self.nodes += 1;
        let (base, known) = self.kind_of(&construct.kind, name);
        let holds = known.is_some_and(|making| making.kind == Kind::BuiltIn(schema::group::KIND));
        let Sorted { items, parts, misplaced, lost } =
            self.sort_entries(&construct.body.entries, known.map(|making| making.kind), holds);
        let place = if holds { Place::Group } else { Place::Fields };
        let mut block = (!items.is_empty()).then(|| self.open(&items, place, construct.body.span));
        let mut make = Unfinished { fields: vec![], given: FieldSet::default() };
        if let Some(making) = known {
            self.note_body(construct.body.span, making.kind, making.given);
        }
        match known {
            Some(making) => self.fields(&mut make, making, &construct.body.entries, &parts),
            None => {
                // The kind is unknown, yet what stands inside can be looked at.
                for entry in &construct.body.entries {
                    if let Entry::Field(field) = entry {
                        self.foreign_value(&field.value);
                    }
                }
            }
        }
        for construct in misplaced {
            // One that is not known either is one slip.
            let name = &construct.kind.first.text;
            match schema::kind(name).is_some() || self.lookup(name).is_some() {
                true => self.make(construct, None),
                false => self.quietly(|checker| checker.make(construct, None)),
            };
        }
        for statement in lost {
            self.quietly(|checker| checker.item(&Item::Statement(statement), place, None));
        }
        let inside = (block.is_some() && holds).then(|| self.keep_names());
        if block.is_some() {
            self.close(block.as_mut());
        }
        let ty = match (&base, known) {
            (Base::Invalid, _) | (_, None) => Type::Invalid,
            (_, Some(making)) => {
                Type::Made(Making { given: make.given, inside: inside.or(making.inside), ..making })
            }
        };
        make.fields.sort_by_key(|(place, _)| *place);
        let written = Rc::new(Written {
            name: name.map(|name| name.text.clone()),
            defined: None,
            span: construct.span,
            fields: make.fields.iter().map(|(_, value)| value.span).collect(),
            rows: None,
        });
        (Make { base, fields: make.fields, block, inside, written }, ty)
    }

    /// The value of a field that is not known. A name may be a word that the field understands.
    fn foreign_value(&mut self, value: &ast::Expr) {
        match value.kind {
            Tree::Name(_) => self.quietly(|checker| checker.infer(value)),
            _ => self.infer(value),
        };
    }

    /// What stands before `{`: what the thing begins as. `second` is the word behind that.
    fn kind_of(&mut self, path: &ast::Path, second: Option<&Name>) -> (Base, Option<Making>) {
        let (name, wanted) = (&path.first, self.wanted.take());
        if let Some(kind) = schema::kind(&name.text) {
            self.note(name.span, Some(Meaning::Kind(kind)));
            // Which of the two is meant is not known; that the name is taken was reported.
            if self.hiding.contains(&kind) && self.is_declared(&name.text) {
                return (Base::Invalid, None);
            }
            return match path.rest.first() {
                None => (Base::Kind(kind), Some(built_in(kind))),
                Some(inner) => {
                    self.report(errors::nothing_inside(inner, &name.text));
                    (Base::Invalid, Some(built_in(kind)))
                }
            };
        }
        let Some(found) = self.lookup(&name.text) else {
            if let Some((kind, second)) =
                second.and_then(|second| Some((schema::kind(&second.text)?, second)))
                && path.rest.is_empty()
                && let Some(diagnostic) = errors::before_kind(name, second)
            {
                self.report(diagnostic);
                return (Base::Invalid, Some(built_in(kind)));
            }
            let diagnostic = errors::unknown(Code::E0101, "kind", name, &self.kind_names(wanted));
            self.report_lost(&name.text, diagnostic);
            // What stands inside is looked at as if the kind had been spelt right.
            let fits = |kind: &&schema::Kind| wanted.is_none_or(|wanted| kind.category == wanted);
            let built_ins = schema::KINDS.iter().filter(fits).map(|kind| kind.name);
            let built_ins: Vec<&str> = built_ins.filter(|kind| !schema::is_part(kind)).collect();
            // What has another name elsewhere may have other fields too.
            let guess = errors::closest(&name.text, &built_ins)
                .filter(|guess| guess.certain || schema::familiar::kind(&name.text).is_none())
                .and_then(|guess| schema::kind(guess.name));
            return (Base::Invalid, guess.map(built_in));
        };
        self.note(name.span, found.meaning);
        let mut ty = found.ty;
        let mut value = found.kind;
        let mut around = Around::Up(found.up);
        for inner in &path.rest {
            let Type::File(file) = ty else {
                if ty != Type::Invalid {
                    self.report(errors::path_as_kind(inner, &ty));
                }
                return (Base::Invalid, None);
            };
            let Some(exported) = self.exported(file, &inner.text) else {
                self.report_not_in_file(file, inner, "kind");
                return (Base::Invalid, None);
            };
            value = ExprKind::FileName { file, slot: exported.slot };
            let place = exported.place;
            ty = exported.ty.clone();
            around = Around::File(file);
            self.note(inner.span, Some(Meaning::Declared(place)));
        }
        match ty {
            Type::Made(making) => {
                let prototype = Expr { kind: value, span: path_span(path) };
                (Base::Prototype(prototype), Some(making))
            }
            Type::Part(part) => (Base::Part { part, around }, Some(Making::of(Kind::Part(part)))),
            Type::File(file) => {
                let part = self.program.files[file.index()].part;
                (Base::Part { part, around: Around::Nothing }, Some(Making::of(Kind::Part(part))))
            }
            Type::Invalid => (Base::Invalid, None),
            ty => {
                let name = Name { text: path_text(path).into(), span: path_span(path) };
                self.report(errors::not_a_kind(&name, &ty));
                (Base::Invalid, None)
            }
        }
    }

    /// Splits the statements of a body: definitions and members on the one hand, things that are fields (a
    /// lens in its camera) on the other.
    fn sort_entries<'t>(&mut self, entries: &'t [Entry], kind: Option<Kind>, holds: bool) -> Sorted<'t> {
        let Sorted { mut items, mut parts, mut misplaced, mut lost } = Sorted::default();
        // Looked for where a material stands alone.
        let mut free = None;
        for entry in entries {
            let Entry::Statement(statement) = entry else {
                // A broken entry with the name of a field is that field.
                if let Entry::Broken(broken) = entry
                    && let Some(name) = &broken.name
                    && kind.is_none_or(|kind| self.find_field(kind, &name.text).is_none())
                {
                    items.push(Item::Broken(broken));
                }
                continue;
            };
            match &statement.kind {
                Statement::Thing { construct, name } if !holds => {
                    let built_in = match kind {
                        Some(Kind::BuiltIn(kind)) => Some(kind),
                        _ => None,
                    };
                    let field = built_in.and_then(|kind| self.part_field(kind, &construct.kind));
                    let is_off = field.is_some() && self.prefixes(statement).0;
                    match (kind, field, name) {
                        (_, Some(_), None) if is_off => misplaced.push(construct),
                        (_, Some(index), None) => parts.push((index, construct)),
                        (Some(kind), Some(index), Some(name)) => {
                            self.report(errors::named_part(&construct.kind, name, &self.kind_name(kind)));
                            parts.push((index, construct));
                        }
                        (Some(kind), None, _) => {
                            let (outer, category) = (self.kind_name(kind), kind.category());
                            let diagnostic = match self.material_of(kind, construct) {
                                true => {
                                    let free = name.is_none()
                                        && statement.prefixes.is_empty()
                                        && *free.get_or_insert_with(|| {
                                            self.lacks_name_of_material(kind, entries)
                                        });
                                    errors::bare_material(&construct.kind, &outer, free)
                                }
                                false => errors::cannot_hold(&construct.kind, &outer, category),
                            };
                            self.report(diagnostic);
                            misplaced.push(construct);
                        }
                        (None, ..) => lost.push(statement),
                    }
                }
                Statement::For { .. } | Statement::If { .. } | Statement::Assert { .. } if !holds => {
                    if let Some(kind) = kind {
                        let name = self.kind_name(kind);
                        self.report(errors::cannot_hold_statement(statement.span, &name));
                    }
                    lost.push(statement);
                }
                _ => items.push(Item::Statement(statement)),
            }
        }
        Sorted { items, parts, misplaced, lost }
    }

    fn fields(
        &mut self,
        make: &mut Unfinished,
        making: Making,
        entries: &[Entry],
        parts: &[(usize, &ast::Construct)],
    ) {
        let kind = making.kind;
        let mut places: Vec<Option<Span>> = vec![None; self.field_count(kind)];
        let mut told = None;
        // Where a field stands of which nothing is known.
        let mut foreign = None;
        // What another name cannot have meant, also where it stands before: found out where there is such a name.
        let mut named = None;
        for entry in entries {
            let (name, value) = match entry {
                Entry::Field(field) => (&field.name, Some(&field.value)),
                Entry::Broken(ast::Broken { name: Some(name), .. }) => (name, None),
                _ => continue,
            };
            let Some(field) = self.find_field(kind, &name.text) else {
                let named = named.get_or_insert_with(|| self.named(kind, entries, parts));
                let both = places.iter().zip(named.iter());
                let free: Vec<bool> = both.map(|(place, named)| place.is_none() && !named).collect();
                if value.is_some() {
                    self.unknown_field(kind, name, &free, &mut told);
                }
                // A misspelt field counts as given.
                let mut meant = None;
                if let Some((field, certain)) = self.probable_field(kind, name, &free) {
                    places[self.bit(kind, field)] = Some(name.span);
                    make.fields.push((field, Expr::invalid(name.span)));
                    meant = Some(field).filter(|_| certain);
                } else {
                    foreign = Some(name.span);
                }
                match (meant, value) {
                    (Some(field), Some(value)) => drop(self.value_of_field(kind, field, value)),
                    (None, Some(value)) => self.foreign_value(value),
                    (_, None) => {}
                }
                continue;
            };
            self.note(name.span, self.meaning(kind, field));
            let bit = self.bit(kind, field);
            if let Some(first) = places[bit] {
                self.report(errors::repeated(name, first));
                if let Some(value) = value {
                    self.value_of_field(kind, field, value);
                }
                continue;
            }
            places[bit] = Some(name.span);
            let checked = match value {
                Some(value) => self.value_of_field(kind, field, value),
                None => Expr::invalid(name.span),
            };
            make.fields.push((field, checked));
        }
        for (index, construct) in parts {
            let name = &construct.kind.first;
            if let Some(first) = places[*index] {
                self.report(errors::repeated(name, first));
                self.quietly(|checker| checker.make(construct, None));
                continue;
            }
            places[*index] = Some(name.span);
            let (part, ty) = self.make(construct, None);
            if let Type::Made(part) = ty {
                self.complete(part, name.span, Some(construct.body.span));
            }
            let kind = ExprKind::Make(Box::new(part));
            make.fields.push((FieldPlace::Index(*index), Expr { kind, span: construct.span }));
        }
        self.lost_fields(make, making, entries, foreign);
        let mut own = FieldSet::default();
        for (place, _) in &make.fields {
            match (kind, place) {
                (Kind::Part(_), FieldPlace::Placed(index)) => own.insert(*index),
                (Kind::Part(_), _) => {}
                (_, place) => own.insert(self.bit(kind, *place)),
            }
        }
        make.given = own.union(making.given);
        if let Kind::BuiltIn(kind) = kind {
            self.conflicts(kind, make.given, &places);
        }
    }

    /// An entry of which nothing was understood may be any field: those that must be given count as given. So does the
    /// only one where a field stands that means nothing here.
    fn lost_fields(&self, make: &mut Unfinished, making: Making, entries: &[Entry], foreign: Option<Span>) {
        let nameless = |entry: &Entry| match entry {
            Entry::Broken(ast::Broken { name: None, span }) => Some(*span),
            _ => None,
        };
        let lost = entries.iter().find_map(nameless);
        let (Kind::BuiltIn(kind), Some(place)) = (making.kind, lost.or(foreign)) else { return };
        let missing: Vec<FieldPlace> = (kind.fields().enumerate())
            .filter(|(index, field)| field.default == Preset::Required && !making.given.has(*index))
            .map(|(index, _)| FieldPlace::Index(index))
            .filter(|place| !make.fields.iter().any(|(given, _)| given == place))
            .collect();
        if lost.is_some() || missing.len() == 1 {
            make.fields.extend(missing.into_iter().map(|field| (field, Expr::invalid(place))));
        }
        // So does one of several of which one must be given.
        let has = |name: &&str| {
            let index = kind.field_index(name);
            let given = |index| make.fields.iter().any(|(given, _)| *given == FieldPlace::Index(index));
            index.is_some_and(|index| making.given.has(index) || given(index))
        };
        if let Some(index) = one_of_several(kind, has) {
            make.fields.push((FieldPlace::Index(index), Expr::invalid(place)));
        }
    }

    fn value_of_field(&mut self, kind: Kind, place: FieldPlace, value: &ast::Expr) -> Expr {
        match (kind, place) {
            (Kind::BuiltIn(kind), FieldPlace::Index(index)) => self.field_value(kind.field(index), value),
            (Kind::Part(part), FieldPlace::Param(index)) => {
                let param = &self.program.part(part).params[index];
                let (name, declared) = (param.name.clone(), param.declared.clone());
                let checked = self.declared_value(&name, &declared, value);
                let range = &self.program.part(part).params[index].range;
                if let Some(diagnostic) =
                    range.as_ref().and_then(|range| self.literal_outside(&name, &checked, range))
                {
                    self.report(diagnostic);
                    return Expr::invalid(value.span);
                }
                checked
            }
            (_, FieldPlace::Placed(index)) => self.field_value(&PLACED[index], value),
            _ => Expr::invalid(value.span),
        }
    }

    /// The value of a field, in the light of what the field wants.
    pub(super) fn field_value(&mut self, field: &'static Field, value: &ast::Expr) -> Expr {
        match &value.kind {
            Tree::Name(name) => {
                if let Some(word) = word_of(field.ty, name) {
                    self.note(value.span, Some(Meaning::Word(word)));
                    return Expr { kind: ExprKind::Word(word.name), span: value.span };
                }
                let words = words(field.ty);
                if !words.is_empty() && !self.is_declared(name) {
                    let name = Name { text: name.clone(), span: value.span };
                    self.report(errors::unknown_word(field, &name, &words));
                    return Expr::invalid(value.span);
                }
            }
            // The words reach into the branches.
            Tree::If { condition, then, otherwise } => {
                let condition = self.condition("if", condition);
                let [then, otherwise] = [then, otherwise].map(|branch| self.field_value(field, branch));
                let kind = ExprKind::If(Box::new([condition, then, otherwise]));
                return Expr { kind, span: value.span };
            }
            Tree::Paren(inner) => return self.field_value(field, inner),
            _ => {}
        }
        if let Some(diagnostic) = self.unknown_value(field.ty, value) {
            self.report_lost(&self.text(value.span).into(), diagnostic);
            return Expr::invalid(value.span);
        }
        let (checked, ty) = self.infer_wanted(field.ty, value);
        if ty == Type::Invalid {
            return Expr::invalid(value.span);
        }
        if !accepts(field.ty, &ty) {
            let named = self.quoted(value).filter(|(_, ty)| *ty != Type::Invalid && accepts(field.ty, ty));
            let text = self.text(value.span);
            let diagnostic = errors::mismatch(field.name, field.ty, value.span, text, &ty);
            let number = schema::familiar::number(field.name).filter(|_| diagnostic.code == Code::E0202);
            let diagnostic = match number {
                Some(hint) => diagnostic.help(hint),
                None => diagnostic,
            };
            self.report(match named {
                Some((name, _)) => errors::name_in_quotes(diagnostic, &name),
                None => diagnostic,
            });
            return Expr::invalid(value.span);
        }
        if let Type::Made(making) = ty {
            self.complete(making, value.span, body_of(value));
        }
        checked
    }
}

/// Where the braces of a value are that is made on the spot.
pub(super) fn body_of(value: &ast::Expr) -> Option<Span> {
    match &value.kind {
        ast::ExprKind::Construct(construct) => Some(construct.body.span),
        _ => None,
    }
}

/// What a body has given so far.
struct Unfinished {
    fields: Vec<(FieldPlace, Expr)>,
    given: FieldSet,
}

/// The statements of a body by what they are.
#[derive(Default)]
struct Sorted<'t> {
    /// Definitions, and members of a group.
    items: Vec<Item<'t>>,
    /// Things that are fields, each with the field's index.
    parts: Vec<(usize, &'t ast::Construct)>,
    /// Things that are left out, or do not belong here, which was reported.
    misplaced: Vec<&'t ast::Construct>,
    /// Statements of which it is not known whether they belong here, or that do not.
    lost: Vec<&'t ast::Statement>,
}

/// Whether a value of a type can stand in a field.
pub(super) fn accepts(field: FieldType, ty: &Type) -> bool {
    match (field, ty) {
        (_, Type::Invalid) => true,
        (FieldType::Scalar(dim), Type::Scalar(element)) => element.fits(dim),
        (FieldType::Int, Type::Scalar(element)) => element.is_int(),
        (FieldType::Bool, Type::Bool) => true,
        (FieldType::Paint, Type::Color | Type::Texture) => true,
        (FieldType::Text, Type::Text) => true,
        (FieldType::Color, Type::Color) => true,
        (FieldType::Tuple(_, _), Type::Scalar(Element::Zero)) => true,
        (FieldType::Tuple(count, dim), Type::Tuple(given, element)) => count == *given && element.fits(dim),
        (FieldType::IntTuple(count), Type::Tuple(given, element)) => count == *given && element.is_int(),
        (FieldType::Transform, Type::Transform) => true,
        (FieldType::Made(category), Type::Made(making)) => making.kind.category() == category,
        (FieldType::Part(name), Type::Made(Making { kind: Kind::BuiltIn(kind), .. })) => {
            kind.get().name == name
        }
        (FieldType::Target, Type::Thing(making)) => {
            matches!(making.kind.category(), Category::Shape | Category::Group | Category::Light)
        }
        (FieldType::Named(name), Type::Thing(Making { kind: Kind::BuiltIn(kind), .. })) => {
            kind.get().name == name
        }
        (FieldType::OneOf(types), ty) => types.iter().any(|field| accepts(*field, ty)),
        _ => false,
    }
}

/// Every word a field understands.
fn words(ty: FieldType) -> Vec<&'static str> {
    match ty {
        FieldType::Choice(words) => words.iter().map(|word| word.name).collect(),
        FieldType::OneOf(types) => types.iter().flat_map(|ty| words(*ty)).collect(),
        _ => vec![],
    }
}

/// A unit to suggest for a bare number in a field.
pub(super) fn suggested_unit(ty: FieldType) -> Option<String> {
    match ty {
        FieldType::Scalar(dim) | FieldType::Tuple(_, dim) if dim != units::NONE => Some(dim.example_unit()),
        FieldType::OneOf(types) => types.iter().find_map(|ty| suggested_unit(*ty)),
        _ => None,
    }
}
