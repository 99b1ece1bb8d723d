//! A text that is being typed, mended at the cursor and checked: what completion and signatures are found from.

use super::cursor::{Cursor, Spot};
use super::walk::{Piece, name_of};
use super::{Analysis, Stop, Study};
use crate::check::{self, Filled, Kind, Program, Type};
use crate::eval::Limits;
use crate::files::Files;
use crate::import;
use crate::source::{Source, Sources};
use crate::span::Span;
use crate::stack;
use crate::syntax::ast::{Entry, StatementKind};
use smol_str::SmolStr;
use std::collections::BTreeSet;

/// A text that is being typed, and what is known of it.
pub(super) struct Typing<'t> {
    /// Where it is typed.
    pub(super) cursor: &'t Cursor<'t>,
    /// The mended text, not evaluated. All before the word at the cursor stands where it does in the text itself.
    pub(super) analysis: Analysis,
    /// What was checked.
    pub(super) program: Program,
}

/// Checks the text around a cursor, and asks something of it; nothing once `stop` says so.
pub(super) fn typing<T: Send + Default>(
    files: &dyn Files,
    source: &Source,
    cursor: &Cursor,
    limits: &Limits,
    stop: Stop,
    ask: impl FnOnce(&Typing) -> T + Send,
) -> T {
    let mut sources = Sources::default();
    let mended = Source::new(source.name.clone(), cursor.mended()).at(source.path.clone());
    let main = sources.add(mended);
    let mut imported = import::import(files, &mut sources, main, limits.levels, limits.text);
    imported.diagnostics.clear();
    if stop() {
        return T::default();
    }
    stack::deep(move || {
        let (program, _, notes) = check::study(files, &sources, &imported, &[]);
        let study = Study { files: imported.files, notes, ..Study::default() };
        let analysis = Analysis::new(sources, main, vec![], vec![], study);
        if stop() { T::default() } else { ask(&Typing { cursor, analysis, program }) }
    })
}

impl Typing<'_> {
    /// The names that can be used at the cursor, each with the place of its declaration and what it is.
    pub(super) fn visible(&self) -> Vec<(&SmolStr, Span, &Type)> {
        // The point before a member is left out of the mended text, which may end there.
        let at = match self.cursor.spot {
            Spot::Member(dot) => dot,
            _ => self.cursor.word.start,
        };
        let at = Span::new(self.analysis.main, at, at);
        let scopes = self.analysis.study.notes.scopes.iter().filter(|scope| scope.span.contains(at));
        let mut names: Vec<_> =
            scopes.flat_map(|scope| &scope.names).map(|(name, place, ty)| (name, *place, ty)).collect();
        // A name that is given twice is one.
        names.sort_by_key(|(name, place, _)| (*name, *place));
        names.dedup_by_key(|(name, _, _)| *name);
        names
    }

    /// The thing in whose body the cursor stands.
    pub(super) fn body(&self) -> Option<&Filled> {
        let text = &self.analysis.source().text;
        let brace = self.cursor.open.iter().rev().find(|open| text.as_bytes()[**open] == b'{')?;
        let here = |filled: &&Filled| {
            filled.span.source == self.analysis.main && filled.span.range().start == *brace
        };
        self.analysis.study.notes.bodies.iter().rev().find(here)
    }

    /// Where the names are of the statements in whose braces the cursor stands.
    pub(super) fn around(&self) -> Vec<Span> {
        let mut names = vec![];
        let at = self.cursor.word.start;
        self.analysis.walk(self.analysis.main, at..at, &mut |piece| {
            if let Piece::Statement(statement) = piece
                && self.cursor.open.iter().any(|open| statement.span.range().contains(open))
            {
                names.extend(name_of(statement).map(|name| name.span));
            }
        });
        names
    }

    /// The fields that the innermost body gives, by name.
    pub(super) fn given(&self) -> BTreeSet<SmolStr> {
        let text = &self.analysis.source().text;
        let brace = self.cursor.open.iter().rev().find(|open| text.as_bytes()[**open] == b'{');
        let mut found = BTreeSet::new();
        let Some(brace) = brace else { return found };
        self.analysis.walk(self.analysis.main, *brace..*brace, &mut |piece| {
            let Piece::Body(body) = piece else { return };
            if body.span.range().start != *brace {
                return;
            }
            for entry in &body.entries {
                match entry {
                    Entry::Field(field) => drop(found.insert(field.name.text.clone())),
                    Entry::Statement(statement) => {
                        if let StatementKind::Thing { construct, name: None } = &statement.kind {
                            found.insert(construct.kind.first.text.clone());
                        }
                    }
                    Entry::Broken(broken) => found.extend(broken.name.iter().map(|name| name.text.clone())),
                    Entry::Rows(_) => {}
                }
            }
        });
        found
    }

    /// What a field of a kind wants, as a type that a param could be declared with.
    pub(super) fn wanted(&self, kind: Kind, field: &str) -> Option<check::Declared> {
        let placed = || {
            let placed = crate::schema::PLACED.iter().find(|placed| placed.name == field);
            placed.map(|placed| check::Declared::Field(placed.ty))
        };
        match kind {
            Kind::BuiltIn(kind) => {
                kind.field_index(field).map(|index| check::Declared::Field(kind.field(index).ty))
            }
            Kind::Part(part) => {
                let params = &self.program.part(part).params;
                params
                    .iter()
                    .find(|param| param.name == field)
                    .map(|param| param.declared.clone())
                    .or_else(placed)
            }
            Kind::Thing => placed(),
            Kind::Material => None,
        }
    }
}
