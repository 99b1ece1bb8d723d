//! Things: their kind, their fields, and what must hold between these.

use super::types::{Element, FieldSet, Type};
use super::{Checker, Expr, ExprKind, Make, errors, scope::Item};
use crate::schema::{Category, Field, FieldType, KindId, Preset, Rule};
use crate::span::Span;
use crate::syntax::ast::{self, Entry, ExprKind as Tree, Name, Statement};
use crate::units;

impl Checker<'_> {
    /// A thing in statement position.
    pub(super) fn drawn(&mut self, construct: &ast::Construct, top_level: bool) -> (Expr, Type) {
        let (make, ty) = self.make(construct);
        let expr = Expr { kind: ExprKind::Make(Box::new(make)), span: construct.span };
        let Type::Made(kind, given) = ty else { return (Expr::invalid(construct.span), Type::Invalid) };
        match kind.get().category {
            Category::Material => self.report(errors::material_drawn(&construct.kind)),
            Category::Block if !top_level => self.report(errors::block_inside(&construct.kind, kind)),
            _ => self.complete(kind, given, construct.kind.span),
        }
        (expr, Type::Thing(kind))
    }

    /// A thing, in the picture or not. What is missing is for whoever uses it to say.
    pub(super) fn make(&mut self, construct: &ast::Construct) -> (Make, Type) {
        let (base, known) = self.kind_of(&construct.kind);
        let holds = known.is_some_and(|(kind, _)| kind.get().category == Category::Group);
        let (items, parts) = self.sort_entries(&construct.body.entries, known.map(|(kind, _)| kind), holds);
        let block = (!items.is_empty()).then(|| self.open(&items, false));
        let mut make = Make { base, fields: vec![], block, span: construct.span };
        let ty = match known {
            Some((kind, inherited)) => {
                let given = self.fields(&mut make, kind, inherited, &construct.body.entries, &parts);
                Type::Made(kind, given)
            }
            None => {
                // The kind is unknown, yet what stands inside can be looked at.
                for entry in &construct.body.entries {
                    if let Entry::Field(field) = entry
                        && !matches!(field.value.kind, Tree::Name(_))
                    {
                        self.infer(&field.value);
                    }
                }
                Type::Invalid
            }
        };
        if make.block.is_some() {
            self.close();
        }
        (make, ty)
    }

    /// Splits the statements of a body: definitions and members on the one hand, things that are fields (a
    /// lens in its camera) on the other.
    fn sort_entries<'t>(
        &mut self,
        entries: &'t [Entry],
        kind: Option<KindId>,
        holds: bool,
    ) -> (Vec<Item<'t>>, Vec<(usize, &'t ast::Construct)>) {
        let mut items = vec![];
        let mut parts = vec![];
        for entry in entries {
            let Entry::Statement(statement) = entry else {
                // A broken entry with the name of a field is that field.
                if let Entry::Broken(broken) = entry
                    && let Some(name) = &broken.name
                    && kind.is_none_or(|kind| kind.field_index(&name.text).is_none())
                    && holds
                {
                    items.push(Item::Broken(broken));
                }
                continue;
            };
            match &**statement {
                Statement::Thing { construct, name } if !holds => {
                    let field = kind.and_then(|kind| self.part_field(kind, &construct.kind));
                    match (field, name) {
                        (Some(index), None) => parts.push((index, construct)),
                        _ => {
                            if let Some(kind) = kind {
                                self.report(errors::cannot_hold(&construct.kind, kind));
                            }
                        }
                    }
                }
                statement => items.push(Item::Statement(statement)),
            }
        }
        (items, parts)
    }

    /// The field of `kind` that a statement of this kind inside fills.
    fn part_field(&self, kind: KindId, inner: &Name) -> Option<usize> {
        kind.fields().position(|field| matches!(field.ty, FieldType::Part(part) if part == inner.text))
    }

    fn fields(
        &mut self,
        make: &mut Make,
        kind: KindId,
        inherited: FieldSet,
        entries: &[Entry],
        parts: &[(usize, &ast::Construct)],
    ) -> FieldSet {
        let mut places: Vec<Option<Span>> = vec![None; kind.field_count()];
        for entry in entries {
            let (name, value) = match entry {
                Entry::Field(field) => (&field.name, Some(&field.value)),
                Entry::Broken(ast::Broken { name: Some(name), .. }) => (name, None),
                _ => continue,
            };
            let Some(index) = kind.field_index(&name.text) else {
                if let Some(value) = value {
                    let guess = self.unknown_field(kind, name, &places);
                    // A misspelt field counts as given.
                    if let Some(index) = guess {
                        places[index].get_or_insert(name.span);
                    }
                    if !matches!(value.kind, Tree::Name(_)) {
                        self.infer(value);
                    }
                }
                continue;
            };
            if let Some(first) = places[index] {
                self.report(errors::repeated(name, first));
                continue;
            }
            places[index] = Some(name.span);
            if let Some(value) = value {
                let checked = self.field_value(kind.field(index), value);
                make.fields.push((index, checked));
            }
        }
        for (index, construct) in parts {
            if let Some(first) = places[*index] {
                self.report(errors::repeated(&construct.kind, first));
                continue;
            }
            places[*index] = Some(construct.kind.span);
            let (part, ty) = self.make(construct);
            if let Type::Made(part, given) = ty {
                self.complete(part, given, construct.kind.span);
            }
            make.fields.push((*index, Expr { kind: ExprKind::Make(Box::new(part)), span: construct.span }));
        }
        let mut own = FieldSet::default();
        places
            .iter()
            .enumerate()
            .filter(|(_, place)| place.is_some())
            .for_each(|(index, _)| own.insert(index));
        let given = own.union(inherited);
        self.conflicts(kind, given, &places);
        given
    }

    /// Reports an unknown field, and gives the one probably meant.
    fn unknown_field(&mut self, kind: KindId, name: &Name, places: &[Option<Span>]) -> Option<usize> {
        let free = kind.fields().enumerate().filter(|(index, _)| places[*index].is_none());
        let names: Vec<&str> = free.map(|(_, field)| field.name).collect();
        let all: Vec<&str> = kind.fields().map(|field| field.name).collect();
        let diagnostic = errors::unknown_field(kind, name, &names, &all);
        self.report(diagnostic);
        errors::closest(&name.text, &names).and_then(|guess| kind.field_index(guess))
    }

    /// Fields that exclude each other. Reported where this body gives at least one of them.
    fn conflicts(&mut self, kind: KindId, given: FieldSet, places: &[Option<Span>]) {
        let pair = |a: &'static str, b: &'static str| {
            let (i, j) = (kind.field_index(a)?, kind.field_index(b)?);
            let here = places[i].or(places[j])?;
            (given.has(i) && given.has(j)).then_some((a, b, here, places[i].and(places[j])))
        };
        for rule in kind.get().rules {
            let found = match rule {
                Rule::ExactlyOne(names) => {
                    names.iter().enumerate().find_map(|(n, a)| names[n + 1..].iter().find_map(|b| pair(a, b)))
                }
                Rule::Excludes(one, others) => others.iter().find_map(|other| pair(one, other)),
                Rule::Together(_) | Rule::Needs(..) => None,
            };
            if let Some((a, b, first, second)) = found {
                self.report(errors::conflict(kind, a, b, first, second));
                return;
            }
        }
    }

    /// Everything that must be given is. `place` is where the thing is used.
    fn complete(&mut self, kind: KindId, given: FieldSet, place: Span) {
        for (index, field) in kind.fields().enumerate() {
            if field.default == Preset::Required && !given.has(index) {
                self.report(errors::missing(kind, field, place));
            }
        }
        let has = |name: &str| kind.field_index(name).is_some_and(|index| given.has(index));
        for rule in kind.get().rules {
            match *rule {
                Rule::ExactlyOne(names) if !names.iter().any(|name| has(name)) => {
                    self.report(errors::missing_one_of(kind, names, place));
                }
                Rule::Together(names) if names.iter().any(|name| has(name)) => {
                    for missing in names.iter().filter(|name| !has(name)) {
                        self.report(errors::missing_beside(kind, missing, names, place));
                    }
                }
                Rule::Needs(one, other) if has(one) && !has(other) => {
                    self.report(errors::missing_beside(kind, other, &[one], place));
                }
                _ => {}
            }
        }
    }

    /// The value of a field, in the light of what the field wants.
    pub(super) fn field_value(&mut self, field: &'static Field, value: &ast::Expr) -> Expr {
        if let Tree::Name(name) = &value.kind {
            if let Some(word) = find_word(field.ty, name) {
                return Expr { kind: ExprKind::Word(word), span: value.span };
            }
            let words = words(field.ty);
            if !words.is_empty() && !self.scopes.iter().any(|scope| scope.knows(name)) {
                let name = Name { text: name.clone(), span: value.span };
                self.report(errors::unknown_word(field, &name, &words));
                return Expr::invalid(value.span);
            }
        }
        let (checked, ty) = self.infer(value);
        if ty == Type::Invalid {
            return Expr::invalid(value.span);
        }
        if !accepts(field.ty, ty) {
            let text = self.text(value.span);
            self.report(errors::mismatch(field, value.span, text, ty));
            return Expr::invalid(value.span);
        }
        if let Type::Made(kind, given) = ty {
            self.complete(kind, given, value.span);
        }
        checked
    }
}

/// Whether a value of a type can stand in a field.
fn accepts(field: FieldType, ty: Type) -> bool {
    match (field, ty) {
        (_, Type::Invalid) => true,
        (FieldType::Scalar(dim), Type::Scalar(element)) => element.fits(dim),
        (FieldType::Int, Type::Scalar(element)) => element.is_int(),
        (FieldType::Bool, Type::Bool) => true,
        (FieldType::Color, Type::Color) => true,
        (FieldType::Tuple(_, _), Type::Scalar(Element::Zero)) => true,
        (FieldType::Tuple(count, dim), Type::Tuple(given, element)) => count == given && element.fits(dim),
        (FieldType::IntTuple(count), Type::Tuple(given, element)) => count == given && element.is_int(),
        (FieldType::Transform, Type::Transform) => true,
        (FieldType::Made(category), Type::Made(kind, _)) => kind.get().category == category,
        (FieldType::Part(name), Type::Made(kind, _)) => kind.get().name == name,
        (FieldType::Target, Type::Thing(kind)) => {
            matches!(kind.get().category, Category::Shape | Category::Group | Category::Light)
        }
        (FieldType::Named(name), Type::Thing(kind)) => kind.get().name == name,
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

fn find_word(ty: FieldType, name: &str) -> Option<&'static str> {
    words(ty).into_iter().find(|word| *word == name)
}

/// A unit to suggest for a bare number in a field.
pub(super) fn suggested_unit(ty: FieldType) -> Option<String> {
    match ty {
        FieldType::Scalar(dim) | FieldType::Tuple(_, dim) if dim != units::NONE => Some(dim.example_unit()),
        FieldType::OneOf(types) => types.iter().find_map(|ty| suggested_unit(*ty)),
        _ => None,
    }
}
