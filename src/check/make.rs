//! Things: their kind, their fields, and what must hold between these.

use super::types::{Element, FieldSet, Type};
use super::{Base, Checker, Expr, ExprKind, Make, errors, scope::Item};
use crate::diagnostic::Diagnostic;
use crate::schema::{Category, Field, FieldType, KindId, Preset, Rule};
use crate::span::Span;
use crate::syntax::ast::{self, Entry, ExprKind as Tree, Name, StatementKind};
use crate::units;

impl Checker<'_> {
    /// A thing in statement position.
    pub(super) fn drawn(&mut self, construct: &ast::Construct, top_level: bool) -> (Expr, Type) {
        let (make, ty) = self.make(construct);
        let expr = Expr { kind: ExprKind::Make(Box::new(make)), span: construct.span };
        let Type::Made(kind, given) = ty else { return (Expr::invalid(construct.span), Type::Invalid) };
        match kind.get().category {
            Category::Material => self.report(errors::material_drawn(&construct.kind.first)),
            Category::Block if !top_level => self.report(errors::block_inside(&construct.kind.first, kind)),
            _ => self.complete(kind, given, construct.kind.first.span),
        }
        (expr, Type::Thing(kind))
    }

    /// A thing, in the picture or not. What is missing is for whoever uses it to say.
    pub(super) fn make(&mut self, construct: &ast::Construct) -> (Make, Type) {
        let (base, known) = self.kind_of(&construct.kind.first);
        let holds = known.is_some_and(|(kind, _)| kind.get().category == Category::Group);
        let Sorted { items, parts, misplaced } =
            self.sort_entries(&construct.body.entries, known.map(|(kind, _)| kind), holds);
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
        for construct in misplaced {
            self.make(construct);
        }
        if make.block.is_some() {
            self.close();
        }
        match make.base {
            Base::Invalid => (make, Type::Invalid),
            _ => (make, ty),
        }
    }

    /// Splits the statements of a body: definitions and members on the one hand, things that are fields (a
    /// lens in its camera) on the other.
    fn sort_entries<'t>(&mut self, entries: &'t [Entry], kind: Option<KindId>, holds: bool) -> Sorted<'t> {
        let Sorted { mut items, mut parts, mut misplaced } = Sorted::default();
        for entry in entries {
            let Entry::Statement(statement) = entry else {
                // A broken entry with the name of a field is that field.
                if let Entry::Broken(broken) = entry
                    && let Some(name) = &broken.name
                    && kind.is_none_or(|kind| kind.field_index(&name.text).is_none())
                {
                    items.push(Item::Broken(broken));
                }
                continue;
            };
            match &statement.kind {
                StatementKind::Thing { construct, name } if !holds => {
                    let field = kind.and_then(|kind| self.part_field(kind, &construct.kind.first));
                    match (kind, field, name) {
                        (_, Some(index), None) => parts.push((index, construct)),
                        (Some(kind), Some(index), Some(name)) => {
                            self.report(errors::named_part(&construct.kind.first, name, kind));
                            parts.push((index, construct));
                        }
                        (Some(kind), None, _) => {
                            self.report(errors::cannot_hold(&construct.kind.first, kind));
                            misplaced.push(construct);
                        }
                        (None, ..) => {}
                    }
                }
                _ => items.push(Item::Statement(statement)),
            }
        }
        Sorted { items, parts, misplaced }
    }

    /// The field of `kind` that a statement of this kind, or of a prototype of it, inside fills.
    fn part_field(&mut self, kind: KindId, inner: &Name) -> Option<usize> {
        let inner = match self.lookup(&inner.text) {
            Some((_, Type::Made(kind, _))) => kind.get().name,
            _ => &inner.text,
        };
        kind.fields().position(|field| matches!(field.ty, FieldType::Part(part) if part == inner))
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
                if value.is_some() {
                    self.unknown_field(kind, name, &places);
                }
                // A misspelt field counts as given.
                if let Some(index) = probable_field(kind, name, &places) {
                    places[index] = Some(name.span);
                    make.fields.push((index, Expr::invalid(name.span)));
                }
                if let Some(value) = value.filter(|value| !matches!(value.kind, Tree::Name(_))) {
                    self.infer(value);
                }
                continue;
            };
            if let Some(first) = places[index] {
                self.report(errors::repeated(name, first));
                if let Some(value) = value {
                    self.field_value(kind.field(index), value);
                }
                continue;
            }
            places[index] = Some(name.span);
            let checked = match value {
                Some(value) => self.field_value(kind.field(index), value),
                None => Expr::invalid(name.span),
            };
            make.fields.push((index, checked));
        }
        for (index, construct) in parts {
            if let Some(first) = places[*index] {
                self.report(errors::repeated(&construct.kind.first, first));
                continue;
            }
            places[*index] = Some(construct.kind.first.span);
            let (part, ty) = self.make(construct);
            if let Type::Made(part, given) = ty {
                self.complete(part, given, construct.kind.first.span);
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

    fn unknown_field(&mut self, kind: KindId, name: &Name, places: &[Option<Span>]) {
        let all: Vec<&str> = kind.fields().map(|field| field.name).collect();
        self.report(errors::unknown_field(kind, name, &free_fields(kind, places), &all));
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
        if let Some(diagnostic) = broken_rule(kind, given, place) {
            self.report(diagnostic);
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

/// The names of the fields that are not given yet.
fn free_fields(kind: KindId, places: &[Option<Span>]) -> Vec<&'static str> {
    let free = kind.fields().zip(places).filter(|(_, place)| place.is_none());
    free.map(|(field, _)| field.name).collect()
}

/// The field that an unknown name probably means.
fn probable_field(kind: KindId, name: &Name, places: &[Option<Span>]) -> Option<usize> {
    errors::closest(&name.text, &free_fields(kind, places)).and_then(|guess| kind.field_index(guess))
}

/// The statements of a body by what they are.
#[derive(Default)]
struct Sorted<'t> {
    /// Definitions, and members of a group.
    items: Vec<Item<'t>>,
    /// Things that are fields, each with the field's index.
    parts: Vec<(usize, &'t ast::Construct)>,
    /// Things that do not belong here, which was reported.
    misplaced: Vec<&'t ast::Construct>,
}

/// What a rule misses beside the fields that are given. What lacks one field may break several rules: the one
/// that says most is said.
fn broken_rule(kind: KindId, given: FieldSet, place: Span) -> Option<Diagnostic> {
    let has = |name: &&str| kind.field_index(name).is_some_and(|index| given.has(index));
    let rules = kind.get().rules;
    let conflict = rules
        .iter()
        .any(|rule| matches!(rule, Rule::Excludes(one, others) if has(one) && others.iter().any(has)));
    if conflict {
        return None;
    }
    let beside = rules.iter().find_map(|rule| match rule {
        Rule::Together(names) if names.iter().any(has) => {
            let missing = names.iter().find(|name| !has(name))?;
            Some(errors::missing_beside(kind, missing, names, place))
        }
        Rule::Needs(one, other) if has(one) && !has(other) => {
            Some(errors::missing_beside(kind, other, &[one], place))
        }
        _ => None,
    });
    let one_of = || {
        rules.iter().find_map(|rule| match rule {
            Rule::ExactlyOne(names) if !names.iter().any(has) => {
                Some(errors::missing_one_of(kind, names, place))
            }
            _ => None,
        })
    };
    beside.or_else(one_of)
}

/// Whether a value of a type can stand in a field.
pub(super) fn accepts(field: FieldType, ty: Type) -> bool {
    match (field, ty) {
        (_, Type::Invalid) => true,
        (FieldType::Scalar(dim), Type::Scalar(element)) => element.fits(dim),
        (FieldType::Int, Type::Scalar(element)) => element.is_int(),
        (FieldType::Bool, Type::Bool) => true,
        (FieldType::Color, Type::Color) => true,
        (FieldType::Paint, Type::Color | Type::Texture) => true,
        (FieldType::Text, Type::Text) => true,
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

pub(super) fn find_word(ty: FieldType, name: &str) -> Option<&'static str> {
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
