//! What is wanted where the cursor stands: by the call, the field or the statement around it.

use super::lex::{Lexeme, lex};
use super::signature::Inside;
use super::typing::Typing;
use crate::check::{Declared, Element, Function, FunctionBody, TYPES, Type, texture_parameters};
use crate::schema::{Category, Field, FieldType};
use crate::units;

/// The call between whose parentheses the cursor stands.
pub(super) struct Call<'t> {
    pub(super) callee: Callee<'t>,
    inside: Inside,
    /// The names of arguments behind the cursor.
    behind: Vec<String>,
}

/// What is called.
pub(super) enum Callee<'t> {
    BuiltIn(Function),
    Own(&'t FunctionBody),
}

impl Typing<'_> {
    /// The call around the cursor, where that is the innermost bracket.
    pub(super) fn call(&self) -> Option<Call<'_>> {
        let cursor = self.cursor;
        let (open, by) = cursor.open.last().zip(cursor.opened_by.clone())?;
        let text = &self.analysis.source().text;
        if text.as_bytes()[*open] != b'(' || by.end != *open {
            return None;
        }
        let name = &text[by];
        let own = || {
            let (.., ty) = self.visible().into_iter().find(|(known, ..)| *known == name)?;
            match ty {
                Type::Function(id) => Some(Callee::Own(&self.program.functions[id.index()])),
                _ => None,
            }
        };
        let built_in = Function::ALL.iter().find(|function| function.name() == name);
        let callee = built_in.map(|function| Callee::BuiltIn(*function)).or_else(own)?;
        let inside = Inside::of(text, *open, cursor.word.start);
        Some(Call { callee, inside, behind: names_behind(text, cursor.word.start) })
    }

    /// What a value at the cursor must be: of the field, where it is that of one. None where it may be anything.
    pub(super) fn wanted_here(&self, field: Option<&str>) -> Option<Declared> {
        if matches!(self.cursor.last(), "not" | "and" | "or" | "if") {
            return Some(Declared::Field(FieldType::Bool));
        }
        if self.cursor.is_index() {
            return Some(Declared::Field(FieldType::Int));
        }
        if let Some(call) = self.call() {
            return call.wanted();
        }
        let wanted = match (field, self.body().map(|body| body.kind)) {
            (Some("material"), None) => Some(Declared::Field(FieldType::Made(Category::Material))),
            (Some(field), Some(kind)) => self.wanted(kind, field),
            (Some(_), None) => None,
            (None, _) => self.wanted_by_statement().or_else(|| self.wanted_by_tuple()),
        };
        match (&wanted, self.cursor.in_tuple()) {
            (Some(Declared::Field(ty)), Some(has_unit)) => component(*ty, has_unit).or(wanted),
            _ => wanted,
        }
    }

    /// What a component of a triple is, by the first one.
    fn wanted_by_tuple(&self) -> Option<Declared> {
        let text = &self.analysis.source().text;
        let open = *self.cursor.open.last().filter(|open| text.as_bytes()[**open] == b'(')?;
        let comma =
            self.cursor.entry.iter().find(|piece| piece.start > open && text[(*piece).clone()] == *",")?;
        match self.type_before(text[..comma.start].trim_end().len()) {
            // A zero is of any dimension.
            Type::Scalar(Element::Zero) => None,
            Type::Scalar(element) => Some(Declared::Field(FieldType::Scalar(element.dim()))),
            _ => None,
        }
    }

    /// What the statement wants whose value is being typed.
    fn wanted_by_statement(&self) -> Option<Declared> {
        let pieces: Vec<&str> = (0..self.cursor.entry.len()).map(|index| self.cursor.piece(index)).collect();
        let between = |from: &str| {
            let begins = pieces.iter().position(|piece| *piece == from)? + 1;
            let ends = begins + pieces[begins..].iter().position(|piece| *piece == "=")?;
            declared(&pieces[begins..ends])
        };
        match *pieces.first()? {
            "param" => between(":"),
            "fn" => between("->"),
            "for" => Some(Declared::List(Box::new(Declared::Invalid))),
            "if" | "assert" => Some(Declared::Field(FieldType::Bool)),
            _ => None,
        }
    }
}

impl Call<'_> {
    /// What the argument at the cursor must be.
    fn wanted(&self) -> Option<Declared> {
        let place = |names: &[&str]| match &self.inside.name {
            Some(name) => names.iter().position(|known| known == name),
            None => Some(self.inside.commas),
        };
        match self.callee {
            Callee::Own(body) => body.parameters.get(self.inside.commas).map(|(_, wanted)| wanted.clone()),
            Callee::BuiltIn(function) => function.ways().iter().find_map(|way| {
                let names: Vec<&str> = way.takes.iter().map(|(name, _)| *name).collect();
                declared(&[way.takes.get(place(&names)?)?.1])
            }),
        }
    }

    /// Whether all that is taken stands before the cursor already.
    pub(super) fn is_full(&self) -> bool {
        let taken = match self.callee {
            Callee::Own(body) => body.parameters.len(),
            Callee::BuiltIn(function) => {
                let ways = function.ways();
                let most = ways.iter().map(|way| way.takes.len()).max().unwrap_or(0);
                if ways.iter().any(|way| way.takes.last() == Some(&("…", "…"))) {
                    usize::MAX
                } else {
                    most
                }
            }
        };
        self.inside.commas >= taken
    }

    /// The arguments that can be named at the cursor and are not given yet.
    pub(super) fn nameable(&self) -> Vec<&'static Field> {
        let Callee::BuiltIn(function) = self.callee else { return vec![] };
        if !self.inside.begins {
            return vec![];
        }
        let by_place = self.inside.commas - self.inside.named.len().min(self.inside.commas);
        let named =
            |field: &Field| self.inside.named.iter().chain(&self.behind).any(|name| name == field.name);
        let fields = texture_parameters(function).unwrap_or(&[]).iter();
        fields.skip(by_place).filter(|field| !named(field)).collect()
    }

    /// Whether `turn` is called, and its axis is not said yet.
    pub(super) fn wants_axis(&self) -> bool {
        let nothing = self.inside.commas == 0 && self.inside.begins && self.behind.is_empty();
        matches!(self.callee, Callee::BuiltIn(Function::Turn)) && nothing
    }
}

/// The names of arguments from a byte on, up to the end of the parentheses around it.
fn names_behind(text: &str, at: usize) -> Vec<String> {
    let (mut names, mut depth, mut last) = (vec![], 0usize, None);
    for (lexeme, range) in lex(text, at) {
        match (lexeme, &text[range]) {
            (Lexeme::Mark, "(" | "[" | "{") => depth += 1,
            (Lexeme::Mark, ")" | "]" | "}") if depth == 0 => break,
            (Lexeme::Mark, ")" | "]" | "}") => depth -= 1,
            (Lexeme::Mark, ":") if depth == 0 => names.extend(last.take()),
            (Lexeme::Word, word) => last = Some(word.to_string()),
            _ => last = None,
        }
    }
    names
}

/// What is wanted of each component, where what is wanted has several; `has_unit` is whether a unit stands behind
/// them all.
fn component(wanted: FieldType, has_unit: bool) -> Option<Declared> {
    let component = match wanted {
        FieldType::Tuple(..) if has_unit => FieldType::Scalar(units::NONE),
        FieldType::Tuple(_, dim) => FieldType::Scalar(dim),
        FieldType::IntTuple(_) => FieldType::Int,
        FieldType::OneOf(types) => return types.iter().find_map(|ty| component(*ty, has_unit)),
        _ => return None,
    };
    Some(Declared::Field(component))
}

/// A type as it is written; none of what is no type.
fn declared(words: &[&str]) -> Option<Declared> {
    match words {
        ["[", item @ .., "]"] => declared(item).map(|item| Declared::List(Box::new(item))),
        [word] => TYPES.iter().find(|(name, _)| name == word).map(|(_, declared)| declared.clone()),
        _ => None,
    }
}
