//! What can stand where the cursor is.

mod behind;
mod entries;
mod paths;
mod values;

use super::cursor::{Cursor, Spot};
use super::typing::{Typing, typing};
use super::{Completion, CompletionKind, Insert, Stop, say};
use crate::check::{Declared, Type};
use crate::diagnostic::{Code, Severity};
use crate::eval::Limits;
use crate::files::Files;
use crate::schema::FieldType;
use crate::source::Source;
use crate::units;

/// What can stand at a byte of a text, which may be unfinished there: best first. `files` is what the text may import;
/// for paths it is asked what a folder holds.
pub fn complete(
    files: &dyn Files,
    source: &Source,
    at: usize,
    limits: &Limits,
    stop: Stop,
) -> Vec<Completion> {
    if source.text.len() > limits.text.source {
        return vec![];
    }
    let cursor = Cursor::new(&source.text, at);
    let mut list = List { cursor: &cursor, found: vec![] };
    match &cursor.spot {
        Spot::Nothing => {}
        Spot::Prefix => list.prefixes(),
        Spot::Warning => list.warnings(),
        Spot::Type => list.types(),
        Spot::Keyword(words) => words.iter().for_each(|word| list.word(word)),
        Spot::Branch => list.branch(),
        Spot::Reason => {
            list.push("\"…\"", CompletionKind::Word, Rank::Fits).insert = Insert::with_holes("\"‹why›\"");
        }
        Spot::Path(language) => list.paths(files, source, *language),
        Spot::Entry | Spot::Value(_) | Spot::Unit(_) | Spot::Member(_) | Spot::Behind(..) => {
            let found = typing(files, source, &cursor, limits, stop, |typing| {
                let mut list = List { cursor: typing.cursor, found: vec![] };
                match &typing.cursor.spot {
                    Spot::Entry => list.entry(typing),
                    Spot::Value(field) => list.value(typing, field.as_deref()),
                    Spot::Unit(field) => list.units(typing, field.as_deref()),
                    Spot::Behind(words, field) => list.behind(typing, words, field.as_deref()),
                    Spot::Member(dot) => list.members(typing, *dot),
                    _ => {}
                }
                list.found
            });
            list.found = found;
        }
    }
    let mut found = list.found;
    let behind = source.text[cursor.word.end..].trim_start_matches([' ', '\t']);
    for completion in &mut found {
        if is_written(completion, behind) {
            completion.insert = Insert { text: completion.label.clone(), holes: vec![] };
        }
    }
    found.sort_by(|a, b| (a.rank, &a.label).cmp(&(b.rank, &b.label)));
    found.dedup_by(|again, first| (again.kind, &again.label) == (first.kind, &first.label));
    found
}

/// Whether what a completion would put behind its label stands behind the cursor already.
fn is_written(completion: &Completion, behind: &str) -> bool {
    let Some(added) = completion.insert.text.strip_prefix(&completion.label) else { return false };
    let begins = |text: &str| text.trim_start().chars().next();
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    match (begins(added), behind.chars().next()) {
        (Some(added @ ('{' | ':' | '(')), Some(next)) if next == added => true,
        // `sphere ball {`
        (Some('{'), Some(next)) if is_word(next) => begins(behind.trim_start_matches(is_word)) == Some('{'),
        // The rest of a statement.
        (Some(added), Some(next)) if added.is_alphanumeric() || added == '"' => {
            is_word(next) || matches!(next, '"' | '(')
        }
        _ => false,
    }
}

/// How well something fits: the first fit best.
#[derive(Clone, Copy)]
#[repr(u32)]
enum Rank {
    /// It is needed, or of the type that is wanted.
    Fits,
    /// It may stand there.
    May,
    /// It may be part of what stands there.
    Rather,
    /// It seldom stands there.
    Seldom,
}

/// What was found so far.
struct List<'c> {
    cursor: &'c Cursor<'c>,
    found: Vec<Completion>,
}

impl List<'_> {
    /// Adds what stands for itself.
    fn push(&mut self, label: &str, kind: CompletionKind, rank: Rank) -> &mut Completion {
        self.found.push(Completion {
            label: label.into(),
            kind,
            replace: self.cursor.word.clone(),
            insert: Insert { text: label.into(), holes: vec![] },
            detail: String::new(),
            doc: String::new(),
            rank: rank as u32,
        });
        let last = self.found.len() - 1;
        &mut self.found[last]
    }

    fn word(&mut self, word: &str) {
        self.push(word, CompletionKind::Keyword, Rank::May);
    }

    fn prefixes(&mut self) {
        for (label, insert, doc) in [
            ("@off", "@off", "Leaves a thing out of the picture."),
            ("@solo", "@solo", "Leaves all others out of the picture."),
            ("@allow", "@allow(‹unused_name›, \"‹why›\")", "Silences one warning on one thing."),
        ] {
            let completion = self.push(label, CompletionKind::Keyword, Rank::May);
            completion.insert = Insert::with_holes(insert);
            completion.doc = doc.into();
        }
    }

    fn warnings(&mut self) {
        for code in Code::ALL.iter().filter(|code| code.severity() == Severity::Warning) {
            let completion = self.push(&code.name(), CompletionKind::Code, Rank::May);
            completion.detail = code.as_str().into();
            completion.doc = code.title().into();
        }
    }

    fn types(&mut self) {
        for (name, declared) in crate::check::TYPES {
            self.push(name, CompletionKind::Type, Rank::May).detail = declared.describe();
        }
    }

    /// The units that fit behind a number: those of what the field wants first.
    fn units(&mut self, typing: &Typing, field: Option<&str>) {
        let wanted = typing.wanted_here(field);
        let dims: Vec<units::Dim> = match wanted {
            Some(Declared::Field(ty)) => dims_of(ty),
            _ => vec![],
        };
        for (name, unit) in units::UNITS {
            let rank = if dims.contains(&unit.dim) { Rank::Fits } else { Rank::May };
            self.push(name, CompletionKind::Unit, rank).detail = unit.dim.to_string();
        }
        let rank = if dims.contains(&units::RADIANCE) { Rank::Fits } else { Rank::May };
        self.push("W/m2", CompletionKind::Unit, rank).detail = units::RADIANCE.to_string();
    }
}

/// The dimensions of what a field may hold.
fn dims_of(ty: FieldType) -> Vec<units::Dim> {
    match ty {
        FieldType::Scalar(dim) | FieldType::Tuple(_, dim) => vec![dim],
        FieldType::OneOf(types) => types.iter().flat_map(|ty| dims_of(*ty)).collect(),
        _ => vec![],
    }
}

impl Insert {
    /// Text in which `‹…›` stands around each hole.
    pub(super) fn with_holes(marked: &str) -> Insert {
        let mut insert = Insert::default();
        let mut start = 0;
        for (index, piece) in marked.split(['‹', '›']).enumerate() {
            insert.text.push_str(piece);
            if index % 2 == 1 {
                insert.holes.push(start..insert.text.len());
            }
            start = insert.text.len();
        }
        insert
    }
}

/// What a name is that stands for something of a type.
fn kind_of(ty: &Type) -> CompletionKind {
    use crate::schema::Category;
    match ty {
        Type::Made(making) if making.kind.category() == Category::Material => CompletionKind::Material,
        Type::Made(_) | Type::Part(_) => CompletionKind::Prototype,
        Type::Thing(_) => CompletionKind::Thing,
        Type::File(_) => CompletionKind::Module,
        Type::Function(_) => CompletionKind::Function,
        Type::Color => CompletionKind::Colour,
        _ => CompletionKind::Value,
    }
}

/// The type of a name in a few words.
fn detail_of(ty: &Type) -> String {
    match ty {
        Type::Invalid => String::new(),
        ty => say::ty(ty),
    }
}
