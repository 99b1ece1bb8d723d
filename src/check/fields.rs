//! The fields of what may stand before `{`: of built-in kinds, of parts, and of what may be any of them; and what must
//! hold between these.

use super::notes::Meaning;
use super::program::{Expr, FieldPlace, PartId};
use super::scope::Found;
use super::types::{FieldSet, Kind, Making, Type};
use super::unknown::ask;
use super::{Checker, errors};
use crate::diagnostic::Diagnostic;
use crate::schema::{self, Category, FieldType, KindId, PLACED, Preset, Rule, familiar};
use crate::span::Span;
use crate::syntax::ast::{self, Entry, Name};

impl Checker<'_> {
    /// Fields that exclude each other. Reported where this body gives at least one of them.
    pub(super) fn conflicts(&mut self, kind: KindId, given: FieldSet, places: &[Option<Span>]) {
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

    /// Everything that must be given is. `place` is where the thing is used, `body` where it is made there.
    pub(super) fn complete(&mut self, making: Making, place: Span, body: Option<Span>) {
        let Kind::BuiltIn(kind) = making.kind else { return };
        let body = body.map(|body| (body, self.text(body)));
        // That its brace is open was said, and what was to come is not known.
        if body.is_some_and(|(_, text)| !text.ends_with('}')) {
            return;
        }
        for (index, field) in kind.fields().enumerate() {
            if field.default == Preset::Required && !making.given.has(index) {
                let diagnostic = errors::missing(kind, field, place);
                self.report(match body {
                    Some((body, text)) => errors::offer_field(diagnostic, field, body, text),
                    None => diagnostic,
                });
            }
        }
        if let Some(diagnostic) = broken_rule(kind, making.given, place) {
            self.report(diagnostic);
        }
    }

    /// The field of a kind with this name.
    pub(super) fn find_field(&self, kind: Kind, name: &str) -> Option<FieldPlace> {
        let placed = || PLACED.iter().position(|field| field.name == name).map(FieldPlace::Placed);
        match kind {
            Kind::BuiltIn(kind) => kind.field_index(name).map(FieldPlace::Index),
            Kind::Part(part) => {
                let params = &self.program.part(part).params;
                params.iter().position(|param| param.name == name).map(FieldPlace::Param).or_else(placed)
            }
            Kind::Thing => placed(),
            Kind::Material => None,
        }
    }

    /// What the name of a field of a kind means.
    pub(super) fn meaning(&self, kind: Kind, place: FieldPlace) -> Option<Meaning> {
        Some(match (kind, place) {
            (Kind::Part(part), FieldPlace::Param(index)) => {
                Meaning::Declared(self.program.part(part).params[index].span)
            }
            (Kind::BuiltIn(kind), FieldPlace::Index(index)) => Meaning::Field(kind, index),
            (_, FieldPlace::Placed(index)) => Meaning::Placed(index),
            _ => return None,
        })
    }

    /// What a thing of the kind is called in a message.
    pub(super) fn kind_name(&self, kind: Kind) -> String {
        match kind {
            Kind::BuiltIn(kind) => kind.get().name.into(),
            Kind::Part(part) if self.program.part(part).name.is_empty() => self.name_of_file(part),
            Kind::Part(part) => self.program.part(part).name.to_string(),
            Kind::Material => "material".into(),
            Kind::Thing => "thing".into(),
        }
    }

    /// What an imported file is called here.
    fn name_of_file(&self, part: PartId) -> String {
        let is_it =
            |ty: &Type| matches!(ty, Type::File(file) if self.program.files[file.index()].part == part);
        let known = self.scopes.iter().flat_map(|scope| &scope.known);
        known
            .into_iter()
            .find(|known| is_it(&known.ty))
            .map_or("the imported file".into(), |known| known.name.text.to_string())
    }

    /// Whether what stands in a thing of a kind is its material, without the name of the field.
    pub(super) fn material_of(&mut self, outer: Kind, inner: &ast::Construct) -> bool {
        let name = &inner.kind.first.text;
        let category = match (schema::kind(name), self.lookup(name)) {
            (Some(kind), _) => Some(kind.get().category),
            (None, Some(Found { ty: Type::Made(making), .. })) => Some(making.kind.category()),
            _ => None,
        };
        category == Some(Category::Material) && self.find_field(outer, "material").is_some()
    }

    /// Whether the body of a thing has no material by name, and one of which the name was left out.
    pub(super) fn lacks_name_of_material(&mut self, kind: Kind, entries: &[Entry]) -> bool {
        let mut bare = 0;
        for entry in entries {
            match entry {
                Entry::Statement(statement) => {
                    if let ast::StatementKind::Thing { construct, .. } = &statement.kind {
                        bare += usize::from(self.material_of(kind, construct));
                    }
                }
                entry if gives_material(entry) => return false,
                _ => {}
            }
        }
        bare == 1
    }

    /// The field of `kind` that a statement of this kind, or of a prototype of it, inside fills.
    pub(super) fn part_field(&mut self, kind: KindId, inner: &ast::Path) -> Option<usize> {
        let found = self.lookup(&inner.first.text).map(|found| found.ty);
        let inner = match found {
            Some(Type::Made(Making { kind: Kind::BuiltIn(kind), .. })) => kind.get().name,
            _ => &inner.first.text,
        };
        kind.fields().position(|field| matches!(field.ty, FieldType::Part(part) if part == inner))
    }

    /// A value where a thing of some category may be wanted, which then is what a misspelt kind is taken for.
    pub(super) fn infer_wanted(&mut self, wanted: FieldType, value: &ast::Expr) -> (Expr, Type) {
        if let (FieldType::Made(category), ast::ExprKind::Construct(_)) = (wanted, &value.kind) {
            self.wanted = Some(category);
        }
        self.infer(value)
    }

    /// The names of all fields of a kind.
    pub(super) fn field_names(&self, kind: Kind) -> Vec<String> {
        let placed = PLACED.iter().map(|field| field.name.to_string());
        match kind {
            Kind::BuiltIn(kind) => kind.fields().map(|field| field.name.to_string()).collect(),
            Kind::Part(part) => {
                let params = self.program.part(part).params.iter();
                params.map(|param| param.name.to_string()).chain(placed).collect()
            }
            Kind::Thing => placed.collect(),
            Kind::Material => vec![],
        }
    }

    /// How many fields a kind has.
    pub(super) fn field_count(&self, kind: Kind) -> usize {
        match kind {
            Kind::BuiltIn(kind) => kind.field_count(),
            Kind::Part(part) => self.program.part(part).params.len() + PLACED.len(),
            Kind::Thing | Kind::Material => PLACED.len(),
        }
    }

    /// Where a field comes among all of its kind.
    pub(super) fn bit(&self, kind: Kind, place: FieldPlace) -> usize {
        match (kind, place) {
            (Kind::Part(part), FieldPlace::Placed(index)) => self.program.part(part).params.len() + index,
            (_, FieldPlace::Param(index) | FieldPlace::Index(index) | FieldPlace::Placed(index)) => index,
        }
    }

    /// Which fields a body gives by their own names.
    pub(super) fn named(
        &self,
        kind: Kind,
        entries: &[Entry],
        parts: &[(usize, &ast::Construct)],
    ) -> Vec<bool> {
        let mut named = vec![false; self.field_count(kind)];
        for entry in entries {
            if let Entry::Field(ast::Field { name, .. }) | Entry::Broken(ast::Broken { name: Some(name), .. }) =
                entry
                && let Some(field) = self.find_field(kind, &name.text)
            {
                named[self.bit(kind, field)] = true;
            }
        }
        parts.iter().for_each(|(index, _)| named[*index] = true);
        named
    }

    /// `free` says of each field whether the body may still give it. `told` is where the last one of this body was reported
    /// whose way to write it here takes in several: `min` and `max`, which are one slip.
    pub(super) fn unknown_field(&mut self, kind: Kind, name: &Name, free: &[bool], told: &mut Option<usize>) {
        let all = self.field_names(kind);
        let all: Vec<&str> = all.iter().map(String::as_str).collect();
        let free: Vec<&str> =
            all.iter().zip(free).filter(|(_, free)| **free).map(|(name, _)| *name).collect();
        let kind_name = self.kind_name(kind);
        let diagnostic = errors::unknown_field(&kind_name, kind.category(), name, &free, &all);
        // Of a param, it may be the declaration that is mistyped.
        let diagnostic = if matches!(kind, Kind::Part(_)) { ask(diagnostic) } else { diagnostic };
        let joined =
            familiar::field(&kind_name, kind.category(), &name.text).is_some_and(|here| !here.same_value);
        let before = told.filter(|_| joined).and_then(|told| self.diagnostics.get_mut(told));
        if let Some(before) = before.filter(|before| before.help == diagnostic.help) {
            *before = before.clone().label(name.span, "nor this one");
            return;
        }
        *told = joined.then_some(self.diagnostics.len());
        self.report(diagnostic);
    }

    /// The field that an unknown name probably means, and whether its value is certainly meant for that.
    pub(super) fn probable_field(
        &self,
        kind: Kind,
        name: &Name,
        free: &[bool],
    ) -> Option<(FieldPlace, bool)> {
        let all = self.field_names(kind);
        let free: Vec<&str> =
            all.iter().zip(free).filter(|(_, free)| **free).map(|(name, _)| name.as_str()).collect();
        let here = familiar::field(&self.kind_name(kind), kind.category(), &name.text);
        let here = here.and_then(|here| Some((here.name?, here.same_value)));
        let here = here.filter(|(name, _)| free.contains(name));
        let guess = || errors::closest(&name.text, &free).map(|guess| (guess.name, guess.certain));
        let (name, certain) = here.or_else(guess)?;
        Some((self.find_field(kind, name)?, certain))
    }
}

/// The field that may stand for those of which one must be given and none is, such that it breaks no other rule.
pub(super) fn one_of_several(kind: KindId, has: impl Fn(&&str) -> bool) -> Option<usize> {
    let rules = kind.get().rules;
    let names = rules.iter().find_map(|rule| match rule {
        Rule::ExactlyOne(names) if !names.iter().any(&has) => Some(names),
        _ => None,
    })?;
    let breaks = |name: &str, rule: &Rule| match rule {
        Rule::Excludes(one, others) => {
            *one == name && others.iter().any(&has) || others.contains(&name) && has(one)
        }
        Rule::Together(names) => names.contains(&name),
        _ => false,
    };
    let name = names.iter().find(|name| !rules.iter().any(|rule| breaks(name, rule)))?;
    kind.field_index(name)
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

/// Whether an entry is the material of a thing, or may be.
fn gives_material(entry: &Entry) -> bool {
    matches!(entry, Entry::Field(ast::Field { name, .. }) | Entry::Broken(ast::Broken { name: Some(name), .. })
        if name.text == "material")
}
