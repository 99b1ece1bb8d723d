//! Where the fields stand that make up a camera and its lens.

use super::Analysis;
use super::walk::Piece;
use crate::check::{Kind, Making, Meaning, Type};
use crate::schema::{KindId, camera, lens};
use crate::span::Span;
use crate::syntax::ast::{Construct, Entry, Expr, ExprKind, Path, StatementKind};
use std::collections::{BTreeMap, BTreeSet};

/// The values of fields, by kind and index.
pub(super) type Places = BTreeMap<(KindId, usize), Span>;

/// Where the values stand that a camera and its lens have: in the camera that is written at a place, in what it is made of, in
/// its lens, or else the one `beside` it, and in what that is made of.
pub(super) fn places(analysis: &Analysis, camera: Span, beside: Option<Span>) -> Places {
    let mut made = Made::default();
    made.add(analysis, camera, camera::KIND);
    if let Some(lens) = made.lens.or(beside) {
        made.add(analysis, lens, lens::KIND);
    }
    made.places
}

/// The lens at the top level, which is that of the only camera.
pub(super) fn beside(analysis: &Analysis) -> Option<Span> {
    let file = analysis.study.files.iter().find(|file| file.source == analysis.main)?;
    file.tree.body.entries.iter().find_map(|entry| lens_of(analysis, entry))
}

/// The lens that an entry is or gives: its construct, or the prototype that it names.
fn lens_of(analysis: &Analysis, entry: &Entry) -> Option<Span> {
    match entry {
        Entry::Statement(statement) => match &statement.kind {
            StatementKind::Thing { construct, .. } => {
                (analysis.kind_of(&construct.kind) == Some(lens::KIND)).then_some(construct.span)
            }
            _ => None,
        },
        Entry::Field(field) => {
            let index = camera::LENS.index(camera::KIND);
            let is_lens = analysis.meaning(field.name.span) == Some(Meaning::Field(camera::KIND, index));
            let (ExprKind::Name(_) | ExprKind::Construct(_)) = &field.value.kind else { return None };
            is_lens.then(|| construct_of(analysis, &field.value))?
        }
        Entry::Rows(_) | Entry::Broken(_) => None,
    }
}

/// The construct that an expression is, or that the name stands for which it is.
fn construct_of(analysis: &Analysis, value: &Expr) -> Option<Span> {
    match &value.kind {
        ExprKind::Construct(construct) => Some(construct.span),
        ExprKind::Name(_) => match analysis.meaning(value.span)? {
            Meaning::Declared(place) => analysis.prototype(place),
            _ => None,
        },
        _ => None,
    }
}

#[derive(Default)]
struct Made {
    places: Places,
    /// Where the lens of the camera is made.
    lens: Option<Span>,
    /// A prototype may be made of itself, which is an error and no reason to go on for ever.
    seen: BTreeSet<Span>,
}

impl Made {
    /// Adds what the construct at a place gives, and then what it is made of: the first that gives a field counts.
    fn add(&mut self, analysis: &Analysis, place: Span, kind: KindId) {
        let mut next = Some(place);
        while let Some(place) = next.take().filter(|place| self.seen.insert(*place)) {
            analysis.walk(place.source, place.range(), &mut |piece| {
                if let Piece::Construct(construct) = piece
                    && construct.span == place
                {
                    self.own(analysis, construct, kind);
                    next = prototype(analysis, &construct.kind);
                }
            });
        }
    }

    fn own(&mut self, analysis: &Analysis, construct: &Construct, kind: KindId) {
        for entry in &construct.body.entries {
            if kind == camera::KIND && self.lens.is_none() {
                self.lens = lens_of(analysis, entry);
            }
            if let Entry::Field(field) = entry
                && let Some(Meaning::Field(of, index)) = analysis.meaning(field.name.span)
                && of == kind
            {
                self.places.entry((kind, index)).or_insert(field.value.span);
            }
        }
    }
}

/// The construct of what a construct is made of; none where that is built in.
fn prototype(analysis: &Analysis, path: &Path) -> Option<Span> {
    match analysis.meaning(path.rest.last().unwrap_or(&path.first).span)? {
        Meaning::Declared(place) => analysis.prototype(place),
        _ => None,
    }
}

impl Analysis {
    /// The built-in kind that a path leads to, by itself or as what a prototype is made of.
    pub(super) fn kind_of(&self, path: &Path) -> Option<KindId> {
        match self.meaning(path.rest.last().unwrap_or(&path.first).span)? {
            Meaning::Kind(kind) => Some(kind),
            Meaning::Declared(place) => match self.study.notes.declared(place)? {
                Type::Made(Making { kind: Kind::BuiltIn(kind), .. }) => Some(*kind),
                _ => None,
            },
            _ => None,
        }
    }

    /// The construct that a name is defined as, by the place of its declaration.
    fn prototype(&self, name: Span) -> Option<Span> {
        let construct = self.declared(name, |declared| match declared {
            super::walk::Declared::Statement(statement) => match &statement.kind {
                StatementKind::Definition { value, .. } => match &value.kind {
                    ExprKind::Construct(construct) => Some(construct.span),
                    _ => None,
                },
                _ => None,
            },
            super::walk::Declared::Parameter(_) | super::walk::Declared::Variable(_) => None,
        });
        construct.flatten()
    }
}
