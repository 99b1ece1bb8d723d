//! Names: who declares them, what hides what, and whether they are used.

use super::notes::{Home, Meaning, Visible, color_of};
use super::program::{Block, StatementKind};
use super::types::{Kind, Making, Type};
use super::{Checker, ExprKind, errors, functions};
use crate::schema::{self, Category};
use crate::span::Span;
use crate::syntax::Rows;
use crate::syntax::ast::{self, Name, StatementKind as Tree};
use crate::{color, syntax, units};
use smol_str::SmolStr;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The names of one body.
pub(super) struct Scope {
    /// What holds it.
    pub(super) place: Place,
    /// The text in which its names mean what they do.
    span: Span,
    /// Index into `known`.
    pub(super) names: BTreeMap<SmolStr, usize>,
    pub(super) known: Vec<Known>,
    /// How many parts, functions and files are around it.
    level: usize,
    /// Whether something in it could not be understood that may declare any name.
    pub(super) nameless: bool,
    /// The unknown names that are probably one of its own, by the indices of their diagnostics.
    pub(super) guessed: Vec<usize>,
}

/// What a body belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Place {
    /// The file that is drawn.
    Main,
    /// A file that is imported.
    Imported,
    Part,
    Group,
    /// Of `for` or `if`.
    Branch,
    /// Of a thing that holds no others: definitions alone.
    Fields,
    /// What a function takes, or the variable of a loop.
    Parameters,
}

/// What is known of a name.
pub(super) struct Known {
    pub(super) name: Name,
    pub(super) ty: Type,
    pub(super) slot: usize,
    /// The statement that declares it, by its index in the scope.
    pub(super) item: usize,
    pub(super) used: bool,
    /// Whether nobody needs to use it: what is drawn, what an imported file declares.
    pub(super) free: bool,
    /// Whether what declares it could not be understood: nothing is said to hide it.
    lost: bool,
    /// Where it can stand, as far as what declares it shows, whose type may not be known yet.
    form: Form,
    /// Whether that is half typed, as its name may be.
    pub(super) doubtful: bool,
}

/// Where a name can stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Form {
    Value,
    /// As a value, and before braces.
    Made,
    /// Before braces.
    Part,
    /// Before parentheses.
    Function,
}

/// A statement, many of them, or the name of one that could not be understood.
#[derive(Clone, Copy)]
pub(super) enum Item<'t> {
    Statement(&'t ast::Statement),
    Broken(&'t ast::Broken),
    Rows(&'t Arc<Rows>),
}

/// A name that was found.
pub(super) struct Found {
    pub(super) kind: ExprKind,
    pub(super) ty: Type,
    /// How many frames out it is.
    pub(super) up: usize,
    /// What it means, for who asks later.
    pub(super) meaning: Option<Meaning>,
}

impl<'t> Item<'t> {
    pub(super) fn name(&self) -> Option<&'t Name> {
        match self {
            Item::Broken(broken) => broken.name.as_ref(),
            Item::Rows(_) => None,
            Item::Statement(statement) => match &statement.kind {
                Tree::Thing { name, .. } => name.as_ref(),
                Tree::Definition { name, .. }
                | Tree::Param { name, .. }
                | Tree::Part { name, .. }
                | Tree::Import { name, .. }
                | Tree::Function { name, .. } => Some(name),
                Tree::For { .. } | Tree::If { .. } | Tree::Assert { .. } => None,
            },
        }
    }

    /// The name that it would declare here, or inside, if it were understood: that of a loop without a body too, since
    /// what stands behind it is probably the body.
    fn lost_name(&self) -> Option<&'t Name> {
        match self {
            Item::Broken(broken) => broken.name.as_ref(),
            Item::Statement(ast::Statement { kind: Tree::For { variable, body, .. }, .. }) => {
                body.span.range().is_empty().then_some(variable)
            }
            Item::Statement(_) | Item::Rows(_) => None,
        }
    }

    fn form(&self) -> Form {
        let Item::Statement(statement) = self else { return Form::Value };
        match &statement.kind {
            Tree::Function { .. } => Form::Function,
            Tree::Part { .. } => Form::Part,
            Tree::Import { .. } => Form::Made,
            Tree::Definition { value, .. } if matches!(value.kind, ast::ExprKind::Construct(_)) => Form::Made,
            _ => Form::Value,
        }
    }

    /// Whether a part of what declares a name is missing.
    fn is_half_typed(&self) -> bool {
        let Item::Statement(statement) = self else { return false };
        let invalid = |value: &ast::Expr| matches!(value.kind, ast::ExprKind::Invalid);
        let untyped = |ty: &ast::TypeName| matches!(ty, ast::TypeName::Invalid(_));
        match &statement.kind {
            Tree::Definition { value, .. } => invalid(value),
            Tree::Param { ty, default, .. } => untyped(ty) || invalid(default),
            Tree::Function { parameters, result, value, .. } => {
                parameters.iter().any(|parameter| untyped(&parameter.ty)) || untyped(result) || invalid(value)
            }
            Tree::Part { body, .. } => body.span.range().is_empty(),
            _ => false,
        }
    }

    /// Where it begins.
    pub(super) fn start(&self) -> u32 {
        match self {
            Item::Statement(statement) => statement.span.start,
            Item::Rows(rows) => rows.span().start,
            Item::Broken(broken) => broken.span.start,
        }
    }

    /// Whether it puts something into the picture by itself.
    fn drawn(&self) -> bool {
        matches!(self, Item::Statement(ast::Statement { kind: Tree::Thing { .. }, .. }))
    }
}

impl Checker<'_> {
    /// Begins a scope that declares nothing yet.
    pub(super) fn scope(&self, place: Place, span: Span) -> Scope {
        let level = self.frames.len();
        let (names, known, guessed) = (BTreeMap::new(), vec![], vec![]);
        Scope { place, span, names, known, level, nameless: false, guessed }
    }

    /// The innermost scope.
    pub(super) fn current(&mut self) -> &mut Scope {
        self.scopes.last_mut().expect("a scope is open while its items are checked")
    }

    /// Begins the frame of a part, function or file.
    pub(super) fn begin_frame(&mut self) {
        self.frames.push(0);
    }

    /// Ends it, and gives the number of its slots.
    pub(super) fn end_frame(&mut self) -> usize {
        self.frames.pop().unwrap_or(0)
    }

    /// A new slot of the frame.
    pub(super) fn slot(&mut self) -> usize {
        let frame = self.frames.last_mut().expect("names are declared inside a file");
        *frame += 1;
        *frame - 1
    }

    /// Declares one name by itself: a parameter, or a loop's variable.
    pub(super) fn declare_alone(&mut self, scope: &mut Scope, name: &Name, ty: Type, free: bool) -> usize {
        let slot = self.slot();
        match scope.names.get(&name.text) {
            Some(&first) => self.report(errors::duplicate(name, Some(&scope.known[first].name))),
            None => {
                self.report_shadowing(name);
                scope.names.insert(name.text.clone(), scope.known.len());
            }
        }
        let name = name.clone();
        let (item, used, lost, form, doubtful) = (0, false, false, Form::Value, false);
        scope.known.push(Known { name, ty, slot, item, used, free, lost, form, doubtful });
        slot
    }

    /// Declares the names of items, and gives which of them each known name belongs to.
    pub(super) fn declare(&mut self, items: &[Item], place: Place, span: Span) -> Scope {
        let mut scope = self.scope(place, span);
        scope.nameless =
            items.iter().any(|item| matches!(item, Item::Broken(broken) if broken.name.is_none()));
        for (item, statement) in items.iter().enumerate() {
            let (Item::Statement(_), Some(name)) = (statement, statement.name()) else { continue };
            let free = statement.drawn() || place == Place::Imported;
            match scope.names.get(&name.text) {
                // With a kind that there is not, the name may be the kind.
                Some(_) if schema::kind(&name.text).is_some() && self.is_of_no_kind(statement, items) => {}
                Some(&first) => self.report(errors::duplicate(name, Some(&scope.known[first].name))),
                None => {
                    if !self.is_of_no_kind(statement, items) {
                        self.report_shadowing(name);
                    }
                    scope.names.insert(name.text.clone(), scope.known.len());
                }
            }
            let slot = self.slot();
            scope.known.push(Known {
                name: name.clone(),
                ty: Type::Invalid,
                slot,
                item,
                used: false,
                free,
                lost: false,
                form: statement.form(),
                doubtful: statement.is_half_typed(),
            });
        }
        // A broken item's name counts as declared where nothing else declares it: its slip is one error.
        for (item, statement) in items.iter().enumerate() {
            let Some(name) = statement.lost_name() else { continue };
            if self.shadows(name).is_none() && !scope.names.contains_key(&name.text) {
                scope.names.insert(name.text.clone(), scope.known.len());
                let slot = self.slot();
                let (name, ty) = (name.clone(), Type::Invalid);
                let (used, free, lost, form, doubtful) = (true, true, true, Form::Value, true);
                scope.known.push(Known { name, ty, slot, item, used, free, lost, form, doubtful });
            }
        }
        scope
    }

    /// Ends the innermost scope, and warns of names nobody used. What is drawn keeps its name only where something
    /// refers to it, or may by a path.
    pub(super) fn close(&mut self, block: Option<&mut Block>) {
        let Some(scope) = self.scopes.pop() else { return };
        self.note_scope(&scope);
        self.ask_of_unused(&scope);
        for known in scope.known.iter().filter(|known| !known.used && !known.free) {
            self.report(errors::unused(&known.name, &known.ty));
        }
        if !self.scopes.is_empty() {
            for known in &scope.known {
                self.closed.entry(known.name.text.clone()).or_insert(known.name.span);
            }
        }
        let by_path = matches!(scope.place, Place::Part | Place::Group | Place::Imported);
        let Some(block) = block.filter(|_| !by_path) else { return };
        for known in scope.known.iter().filter(|known| !known.used) {
            if let Some(StatementKind::Draw { slot, .. }) =
                block.statements.get_mut(known.item).map(|statement| &mut statement.kind)
            {
                *slot = None;
            }
        }
    }

    /// Notes what a scope declares.
    fn note_scope(&mut self, scope: &Scope) {
        let Some(notes) = &mut self.notes else { return };
        let known = || scope.known.iter();
        notes.declared.extend(known().map(|known| (known.name.span, known.ty.clone())));
        let names = known().map(|known| (known.name.text.clone(), known.name.span, known.ty.clone()));
        let place = match scope.place {
            Place::Main | Place::Imported => Home::File,
            Place::Part => Home::Part,
            Place::Group => Home::Group,
            Place::Branch => Home::Branch,
            Place::Fields => Home::Thing,
            Place::Parameters => Home::Head,
        };
        notes.scopes.push(Visible { span: scope.span, place, names: names.collect() });
    }

    /// Whether it is a thing with the name of a kind, whose own kind is unknown: `new sphere { … }`.
    fn is_of_no_kind(&self, item: &Item, items: &[Item]) -> bool {
        let Item::Statement(ast::Statement { kind: Tree::Thing { construct, name: Some(name) }, .. }) = item
        else {
            return false;
        };
        let kind = &construct.kind.first.text;
        let declares = |item: &Item| item.name().is_some_and(|name| name.text == *kind);
        schema::kind(&name.text).is_some()
            && schema::kind(kind).is_none()
            && !self.is_declared(kind)
            && !items.iter().any(declares)
    }

    fn report_shadowing(&mut self, name: &Name) {
        if let Some(diagnostic) = self.shadows(name) {
            self.hiding.extend(schema::kind(&name.text));
            self.report(diagnostic);
        }
    }

    /// What a declaration of this name would hide.
    fn shadows(&self, name: &Name) -> Option<crate::diagnostic::Diagnostic> {
        let outer = self.scopes.iter().rev().find_map(|scope| {
            scope.names.get(&name.text).map(|&known| &scope.known[known]).filter(|known| !known.lost)
        });
        if let Some(outer) = outer {
            return Some(errors::shadows(name, &outer.name));
        }
        // What is wrong with a word of the language as a name was said.
        let what = if syntax::RESERVED.contains(&name.text.as_str()) {
            return None;
        } else if units::is_unit(&name.text) {
            "a unit"
        } else if schema::kind(&name.text).is_some() {
            "a built-in kind"
        } else if functions::by_name(&name.text).is_some() {
            "a built-in function"
        } else {
            return None;
        };
        Some(errors::built_in(name, what))
    }

    /// Looks a name up from the innermost scope outwards.
    pub(super) fn lookup(&mut self, name: &str) -> Option<Found> {
        let level = self.frames.len();
        for scope in self.scopes.iter_mut().rev() {
            if let Some(&known) = scope.names.get(name) {
                let known = &mut scope.known[known];
                known.used = true;
                let up = level - scope.level;
                let kind = ExprKind::Name { up, slot: known.slot };
                let meaning = Some(Meaning::Declared(known.name.span));
                return Some(Found { kind, ty: known.ty.clone(), up, meaning });
            }
        }
        let color = color::named(name)?;
        Some(Found { kind: ExprKind::Color(color), ty: Type::Color, up: 0, meaning: color_of(name) })
    }

    /// Whether a scope declares this name.
    pub(super) fn is_declared(&self, name: &str) -> bool {
        self.scopes.iter().any(|scope| scope.names.contains_key(name))
    }

    /// The scopes whose names can be compared with one more unknown name.
    fn comparable(&self) -> &[Scope] {
        let count = self.scopes.iter().map(|scope| scope.names.len()).sum();
        let left = self.guesses.get().checked_sub(count);
        self.guesses.set(left.unwrap_or(0));
        if left.is_some() { &self.scopes } else { &[] }
    }

    fn declared_names(&self, fits: impl Fn(&Known) -> bool) -> Vec<&str> {
        let scopes = self.comparable().iter();
        let known = scopes.flat_map(|scope| scope.names.values().map(|&known| &scope.known[known]));
        known
            .filter(|known| !known.name.text.is_empty() && fits(known))
            .map(|known| known.name.text.as_str())
            .collect()
    }

    /// Names in scope that may stand for a value, for suggestions.
    pub(super) fn value_names(&self) -> Vec<&str> {
        let mut names = self.declared_names(|known| !matches!(known.form, Form::Part | Form::Function));
        names.extend(color::NAMED.iter().map(|(name, _)| *name));
        names
    }

    /// Names that may stand before `{`, for suggestions: of the built-in ones those of a category that is wanted.
    pub(super) fn kind_names(&self, wanted: Option<Category>) -> Vec<&str> {
        let fits = |kind: &&schema::Kind| wanted.is_none_or(|wanted| kind.category == wanted);
        let mut names: Vec<&str> = schema::KINDS.iter().filter(fits).map(|kind| kind.name).collect();
        names.extend(self.declared_names(|known| {
            matches!(known.form, Form::Made | Form::Part) || matches!(known.ty, Type::Made(_))
        }));
        names
    }

    /// Names that may stand before `(`, for suggestions.
    pub(super) fn function_names(&self) -> Vec<&str> {
        let mut names: Vec<&str> = functions::Function::ALL.iter().map(|function| function.name()).collect();
        names.extend(self.declared_names(|known| known.form == Form::Function));
        names
    }
}

/// What a built-in kind is by itself.
pub(super) fn built_in(kind: schema::KindId) -> Making {
    Making::of(Kind::BuiltIn(kind))
}
