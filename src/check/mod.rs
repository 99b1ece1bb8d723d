//! Tree to typed program: every name is resolved, every type and unit is right, every field exists.
//!
//! What is wrong is reported once, where it is, and becomes an `Invalid` expression, which fits everywhere and
//! silences every further complaint about it. A program with errors can still be evaluated, so that one run
//! finds the slips in values too. Parts, functions and branches are checked where they are written, used or not.

mod block;
mod declared;
mod errors;
mod expr;
mod fields;
mod functions;
mod make;
mod notes;
mod order;
mod part;
mod program;
mod query;
mod rows;
mod scope;
mod setting;
mod sweep;
mod table;
mod textures;
mod types;
mod unknown;

pub use declared::{Declared, TYPES};
pub use functions::{Function, Way};
pub use notes::{Filled, Home, Meaning, Notes, Visible};
pub use program::*;
pub use setting::{Setting, blame, settings};
pub use sweep::{Moment, words as swept_words};
pub use textures::parameters as texture_parameters;
pub use types::{Element, FieldSet, Kind, Making, Type, describe_wanted};

use crate::diagnostic::Diagnostic;
use crate::files::{Files, NoFiles};
use crate::import::Imported;
use crate::source::Sources;
use crate::span::Span;
use crate::syntax::Shape;
use crate::syntax::ast::{self, Entry, StatementKind as Tree};
use smol_str::SmolStr;
use std::cell::Cell;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Checks a file with everything it imports.
pub fn check(
    files: &dyn Files,
    sources: &Sources,
    imported: &Imported,
    settings: &[Setting],
) -> (Program, Vec<Diagnostic>) {
    let mut checker = Checker::new(files, sources, settings);
    checker.all(imported);
    (checker.program, checker.diagnostics)
}

/// The same, with what it learns of the names.
pub fn study(
    files: &dyn Files,
    sources: &Sources,
    imported: &Imported,
    settings: &[Setting],
) -> (Program, Vec<Diagnostic>, Notes) {
    let mut checker = Checker::new(files, sources, settings);
    checker.notes = Some(Box::default());
    checker.all(imported);
    let notes = checker.notes.map(|notes| notes.finish()).unwrap_or_default();
    (checker.program, checker.diagnostics, notes)
}

/// Checks one expression by itself, as the value of a field: nothing but what is built in is in scope.
pub fn check_value(field: &'static crate::schema::Field, value: &ast::Expr) -> (Expr, Vec<Diagnostic>) {
    let sources = Sources::default();
    let mut checker = Checker::new(&NoFiles, &sources, &[]);
    let value = checker.field_value(field, value);
    (value, checker.diagnostics)
}

/// What is known while checking.
struct Checker<'a> {
    files: &'a dyn Files,
    sources: &'a Sources,
    settings: &'a [Setting],
    /// What its import statements mean.
    imports: BTreeMap<Span, FileId>,
    /// Innermost last.
    scopes: Vec<scope::Scope>,
    /// How many slots the parts, functions and files around have so far, innermost last.
    frames: Vec<usize>,
    /// The params of the innermost part, in the order written; none until it is checked.
    params: Vec<(SmolStr, Option<Param>)>,
    /// The shape of rows that is being checked: its literals stand for those of each row.
    shape: Option<Arc<Shape>>,
    /// The words above the statement that is being checked.
    doc: Option<SmolStr>,
    /// Tables by path.
    tables: BTreeMap<crate::files::FilePath, Option<TableId>>,
    program: Program,
    diagnostics: Vec<Diagnostic>,
    /// Unknown names, each with its diagnostic by index: an inner scope may declare them.
    lost: Vec<(usize, SmolStr)>,
    /// What the scopes declared that were closed in this file.
    closed: BTreeMap<SmolStr, Span>,
    /// The kinds whose names something declares, which was reported.
    hiding: Vec<crate::schema::KindId>,
    /// The category of the thing that is made next, where only one can stand.
    wanted: Option<crate::schema::Category>,
    /// The names of the cameras of the file.
    cameras: Vec<SmolStr>,
    /// How many declared names may still be compared with unknown ones.
    guesses: Cell<usize>,
    /// How many expressions and things were checked: what evaluating a body costs.
    nodes: u64,
    /// What is kept of the names, for who asks for it.
    notes: Option<Box<Notes>>,
}

/// The most comparisons of unknown names with declared ones; beyond, only built-in names are suggested. It keeps
/// the time in bounds where thousands of names are unknown.
const MAX_GUESSES: usize = 1_000_000;

impl<'a> Checker<'a> {
    fn new(files: &'a dyn Files, sources: &'a Sources, settings: &'a [Setting]) -> Checker<'a> {
        Checker {
            files,
            sources,
            settings,
            imports: BTreeMap::new(),
            scopes: vec![],
            frames: vec![],
            params: vec![],
            shape: None,
            doc: None,
            tables: BTreeMap::new(),
            program: Program::default(),
            diagnostics: vec![],
            lost: vec![],
            closed: BTreeMap::new(),
            hiding: vec![],
            wanted: None,
            cameras: vec![],
            guesses: Cell::new(MAX_GUESSES),
            nodes: 0,
            notes: None,
        }
    }

    /// Checks every file, the one that is drawn last.
    fn all(&mut self, imported: &Imported) {
        for (index, file) in imported.files.iter().enumerate() {
            let main = index + 1 == imported.files.len();
            let ids = file.imports.iter().map(|(statement, file)| (*statement, FileId(*file as u32)));
            self.imports = ids.collect();
            let part = self.file(&file.tree, main);
            self.program.files.push(program::File { source: file.source, part });
            if main {
                self.unknown_settings(&file.tree);
            }
        }
    }

    fn report(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }

    /// Reports an unknown name.
    fn report_lost(&mut self, name: &SmolStr, diagnostic: Diagnostic) {
        let diagnostic = self.ask_unless_sure(name, diagnostic);
        self.lost.push((self.diagnostics.len(), name.clone()));
        self.report(diagnostic);
    }

    /// Says of the unknown names of a file which of them a scope inside it declares.
    fn say_closed(&mut self) {
        let closed = std::mem::take(&mut self.closed);
        for (index, name) in std::mem::take(&mut self.lost) {
            if let Some(diagnostic) = self.diagnostics.get_mut(index)
                && let Some(declared) =
                    closed.get(&name).filter(|place| place.source == diagnostic.primary.span.source)
            {
                errors::declared_inside(diagnostic, &name, *declared);
            }
        }
    }

    /// Checks what means nothing where it stands, for the names that are used in it. What is wrong there is not said.
    fn quietly<T>(&mut self, check: impl FnOnce(&mut Self) -> T) -> T {
        let (reported, lost, allows) = (self.diagnostics.len(), self.lost.len(), self.program.allows.len());
        let found = check(self);
        self.diagnostics.truncate(reported);
        self.lost.truncate(lost);
        for scope in &mut self.scopes {
            let kept = scope.guessed.partition_point(|index| *index < reported);
            scope.guessed.truncate(kept);
        }
        self.program.allows.truncate(allows);
        found
    }

    /// The source text of a span.
    fn text(&self, span: Span) -> &'a str {
        self.sources.text(span)
    }

    /// Settings that no param of the file takes.
    fn unknown_settings(&mut self, tree: &ast::File) {
        let params = tree.body.entries.iter().filter_map(|entry| match entry {
            Entry::Statement(statement) => match &statement.kind {
                Tree::Param { name, .. } => Some(name.text.as_str()),
                _ => None,
            },
            // What could not be understood may be the param.
            Entry::Broken(broken) => broken.name.as_ref().map(|name| name.text.as_str()),
            Entry::Field(_) | Entry::Rows(_) => None,
        });
        let params: Vec<&str> = params.collect();
        for setting in self.settings.iter().filter(|setting| !params.contains(&setting.name.text.as_str())) {
            let ty = self.type_alone(&setting.value).and_then(|ty| Declared::of(&ty));
            // What it begins with is what it would be declared with.
            let value = setting.ends.as_ref().map_or(&setting.value, |ends| &ends[0]);
            let value = self.text(value.span);
            self.report(errors::no_such_param(&setting.name, &params, ty.as_ref(), value));
        }
    }

    /// The type of an expression where only what is built in is known; what is wrong with it is not reported.
    fn type_alone(&mut self, value: &ast::Expr) -> Option<Type> {
        self.begin_frame();
        let (_, ty) = self.quietly(|checker| checker.infer(value));
        self.end_frame();
        (ty != Type::Invalid).then_some(ty)
    }
}
