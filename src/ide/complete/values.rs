//! Values, and what stands inside them.

use super::entries::{doc_of, example, example_of, is_used, used};
use super::{List, Rank, detail_of, kind_of};
use crate::check::{Declared, Function, Kind, Making, Type, describe_wanted, texture_parameters};
use crate::color;
use crate::ide::hover::function_doc;
use crate::ide::typing::Typing;
use crate::ide::walk::Declared as Place;
use crate::ide::{Completion, CompletionKind, Insert, say};
use crate::schema::{Category, FieldType, KINDS, PLACED};
use crate::span::Span;
use crate::syntax::ast::StatementKind;
use crate::units;

impl List<'_> {
    /// What can be the value of a field, or of anything.
    pub(super) fn value(&mut self, typing: &Typing, field: Option<&str>) {
        let call = typing.call();
        if let Some(call) = &call {
            if call.is_full() {
                return;
            }
            if call.wants_axis() {
                return ["x", "y", "z"]
                    .iter()
                    .for_each(|axis| self.argument(axis, "‹45deg›").detail = "angle".into());
            }
            for field in call.nameable() {
                let argument = self.argument(field.name, &example(field));
                argument.detail = describe_wanted(field.ty);
                argument.doc = say::field(field);
            }
        }
        if typing.cursor.divides_power() {
            self.push("m2", CompletionKind::Unit, Rank::Fits).detail = units::RADIANCE.to_string();
        }
        let wanted = typing.wanted_here(field);
        let ty = match &wanted {
            Some(Declared::Field(ty)) => Some(*ty),
            _ => None,
        };
        ty.into_iter().for_each(|ty| self.of_type(ty));
        self.names(typing, wanted.as_ref());
        // What has a type of its own is written out or named.
        let closed =
            |ty: FieldType| matches!(ty, FieldType::Choice(_) | FieldType::Named(_) | FieldType::Text);
        if ty.is_some_and(closed) {
            return;
        }
        self.functions(wanted.as_ref());
        if wanted.is_none() {
            self.colours(Rank::Seldom);
            // No function takes a thing that is made on the spot.
            let takes = |category| match category {
                Category::Block => false,
                // A material has a word of its own; a list of them has none.
                Category::Material => typing.cursor.piece(0) != "let" || typing.cursor.in_list(),
                _ => true,
            };
            let made = KINDS.iter().filter(|kind| takes(kind.category) && call.is_none());
            made.for_each(|kind| self.kind(kind.name, Rank::Rather));
            ["true", "false"].iter().for_each(|word| self.word(word));
        }
        if wanted == Some(Declared::Thing) && call.is_none() {
            let placed = |category| matches!(category, Category::Shape | Category::Group);
            KINDS
                .iter()
                .filter(|kind| placed(kind.category))
                .for_each(|kind| self.kind(kind.name, Rank::May));
        }
        self.choice(wanted.as_ref());
    }

    /// One of two values of the type that is wanted.
    fn choice(&mut self, wanted: Option<&Declared>) {
        let value = match wanted {
            Some(Declared::Field(ty)) => example_of(*ty),
            // A list is named or called for, and a thing is named or made for itself.
            Some(Declared::List(_) | Declared::Thing) => return,
            Some(Declared::Invalid) | None => "‹1›".into(),
        };
        let insert = Insert::with_holes(&format!("if ‹true› then {value} else {value}"));
        self.push("if", CompletionKind::Keyword, Rank::Seldom).insert = insert;
    }

    /// The name of an argument, and an example of it.
    fn argument(&mut self, name: &str, example: &str) -> &mut Completion {
        let completion = self.push(name, CompletionKind::Field, Rank::Fits);
        completion.insert = Insert::with_holes(&format!("{name}: {example}"));
        completion
    }

    /// What a type itself offers.
    fn of_type(&mut self, ty: FieldType) {
        match ty {
            // Nothing is computed with a word.
            FieldType::Choice(_) if matches!(self.cursor.last(), "+" | "-" | "*" | "/") => {}
            FieldType::Choice(words) => {
                for word in words {
                    self.push(word.name, CompletionKind::Word, Rank::Fits).doc = word.doc.into();
                }
            }
            FieldType::OneOf(types) => types.iter().for_each(|ty| self.of_type(*ty)),
            FieldType::Made(category) => {
                for kind in KINDS.iter().filter(|kind| kind.category == category) {
                    self.kind(kind.name, Rank::May);
                }
            }
            FieldType::Part(part) => self.kind(part, Rank::Fits),
            FieldType::Bool => {
                for word in ["true", "false"] {
                    self.push(word, CompletionKind::Keyword, Rank::Fits);
                }
            }
            FieldType::Color | FieldType::Paint => self.colours(Rank::May),
            _ => {}
        }
    }

    fn colours(&mut self, rank: Rank) {
        for (name, digits) in color::NAMED {
            self.push(name, CompletionKind::Colour, rank).detail = format!("#{digits}");
        }
    }

    /// The names that are in scope: those of the type that is wanted first.
    fn names(&mut self, typing: &Typing, wanted: Option<&Declared>) {
        let own = typing.cursor.declares();
        for (name, place, ty) in typing.visible() {
            let rank = match (wanted, ty) {
                (_, Type::Part(_)) => continue,
                // Nothing is made of itself.
                _ if place.source == typing.analysis.main && own == Some(place.range().start) => continue,
                (None, Type::File(_)) => Rank::Rather,
                (Some(wanted), Type::Function(id)) => {
                    let result = typing.program.functions[id.index()].result.ty();
                    match wanted.accepts(&result) {
                        true => Rank::Fits,
                        false if leads_to(&result, wanted) => Rank::Rather,
                        false => continue,
                    }
                }
                (Some(Declared::Thing), Type::Thing(_)) => Rank::Fits,
                (Some(wanted), ty) if wanted.accepts(ty) && *ty != Type::Invalid => Rank::Fits,
                (Some(wanted), ty) if leads_to(ty, wanted) => Rank::Rather,
                (Some(_), _) => continue,
                (None, _) => Rank::Fits,
            };
            let completion = self.push(name, kind_of(ty), rank);
            completion.detail = detail_of(ty);
            completion.doc = doc_of(typing, place);
            if matches!(ty, Type::Function(_)) {
                completion.insert = Insert::with_holes(&call_of(typing, place, name));
            }
        }
    }

    /// The built-in functions that give what is wanted, or may be part of an expression that does.
    fn functions(&mut self, wanted: Option<&Declared>) {
        for &function in Function::ALL {
            let rank = match wanted {
                None => Rank::Rather,
                Some(Declared::Field(ty)) if gives(function, *ty) => Rank::May,
                Some(Declared::Field(ty)) if is_computed(*ty) && is_numeric(function) => Rank::Rather,
                Some(Declared::List(_)) if function.ways().iter().any(|way| way.gives.starts_with('[')) => {
                    Rank::May
                }
                Some(_) => continue,
            };
            let completion = self.push(function.name(), CompletionKind::Function, rank);
            completion.insert = Insert::with_holes(&built_in_call(function));
            completion.detail = say::ways(function).lines().next().unwrap_or("").into();
            completion.doc = function_doc(function);
        }
    }

    /// What can be asked of what ends before a point.
    pub(super) fn members(&mut self, typing: &Typing, dot: usize) {
        let ty = match typing.type_before(dot) {
            Type::Invalid => self.path_type(typing, dot),
            ty => ty,
        };
        self.members_of(typing, &ty);
    }

    /// What the names before a point lead to.
    fn path_type(&self, typing: &Typing, dot: usize) -> Type {
        let text = &typing.analysis.source().text[..dot];
        let begins = text
            .rfind(|c: char| !(c.is_alphanumeric() || c == '_' || c == '.'))
            .map_or(0, |at| at + text[at..].chars().next().map_or(1, char::len_utf8));
        let mut names = text[begins..].split('.');
        let first = names.next().unwrap_or("");
        let mut ty = typing
            .visible()
            .into_iter()
            .find(|(name, ..)| *name == first)
            .map_or(Type::Invalid, |(.., ty)| ty.clone());
        for name in names {
            ty = inside(typing, &ty)
                .into_iter()
                .find(|(known, ..)| *known == name)
                .map_or(Type::Invalid, |(.., ty)| ty);
        }
        ty
    }

    fn members_of(&mut self, typing: &Typing, ty: &Type) {
        let begins = typing.cursor.begins_statement();
        let field = (typing.cursor.piece(1) == ":").then(|| typing.cursor.piece(0));
        // What a file holds is taken for itself, or computed with.
        let wanted = typing.wanted_here(field).filter(|_| matches!(ty, Type::File(_)));
        let fits = |ty: &Type| match &wanted {
            // A statement begins with what is used as a kind, or with the file of that.
            _ if begins => is_used(ty),
            Some(wanted) => wanted.accepts(&result_of(typing, ty)) || leads_to(ty, wanted),
            None => true,
        };
        for (name, place, ty) in inside(typing, ty).into_iter().filter(|(.., ty)| fits(ty)) {
            let completion = self.push(&name, kind_of(&ty), Rank::Fits);
            completion.detail = detail_of(&ty);
            completion.doc = doc_of(typing, place);
            match ty {
                Type::Function(_) => {
                    completion.insert = Insert::with_holes(&call_of(typing, place, &name));
                }
                _ if begins => completion.insert = Insert::with_holes(&used(&name)),
                _ => {}
            }
        }
        if begins {
            return;
        }
        match ty {
            Type::Tuple(count, element) => {
                for axis in ["x", "y", "z"].iter().take(*count) {
                    self.push(axis, CompletionKind::Field, Rank::Fits).detail =
                        say::ty(&Type::Scalar(*element));
                }
            }
            Type::Bounds => {
                for corner in ["min", "max", "center", "size"] {
                    self.push(corner, CompletionKind::Field, Rank::Fits).detail = "point".into();
                }
            }
            Type::Row(table) => {
                for column in &typing.program.tables[table.index()].columns {
                    self.push(&column.name, CompletionKind::Field, Rank::Fits);
                }
            }
            Type::Made(Making { kind, .. }) | Type::Thing(Making { kind, .. }) => {
                self.fields_of(typing, *kind)
            }
            _ => {}
        }
    }

    /// The fields that can be asked of a thing.
    fn fields_of(&mut self, typing: &Typing, kind: Kind) {
        // What the thing holds hides a field of that name, and a param is held.
        let held: Vec<String> = self.found.iter().map(|held| held.label.clone()).collect();
        let mut field = |name: &str, doc: &str| {
            if held.iter().any(|held| held == name) {
                return;
            }
            self.push(name, CompletionKind::Field, Rank::May).doc = say::paragraph(doc);
        };
        match kind {
            Kind::BuiltIn(id) => id.fields().for_each(|known| field(known.name, known.doc)),
            Kind::Part(part) => {
                let params = typing.program.part(part).params.iter();
                params.for_each(|param| field(&param.name, param.doc.as_deref().unwrap_or("")));
                PLACED.iter().for_each(|known| field(known.name, known.doc));
            }
            Kind::Thing => PLACED.iter().for_each(|known| field(known.name, known.doc)),
            Kind::Material => {}
        }
    }
}

/// The names that lie inside what has a type: of a file, a part or a group.
fn inside(typing: &Typing, ty: &Type) -> Vec<(String, Span, Type)> {
    let program = &typing.program;
    let of_part = |part| Some(program.part(part).inside);
    let names = match ty {
        Type::File(file) => of_part(program.files[file.index()].part),
        Type::Thing(Making { kind: Kind::Part(part), .. }) => of_part(*part),
        Type::Thing(making) => making.inside,
        _ => None,
    };
    let Some(names) = names else { return vec![] };
    let names = &program.insides[names.index()].names;
    // The things of a file are its own.
    let shown = |inner: &Type| !matches!((ty, inner), (Type::File(_), Type::Thing(_)));
    let names = names.iter().filter(|(_, name)| shown(&name.ty));
    names.map(|(name, known)| (name.to_string(), known.place, known.ty.clone())).collect()
}

/// What comes of what has a type: of a function, what it gives.
fn result_of(typing: &Typing, ty: &Type) -> Type {
    match ty {
        Type::Function(id) => typing.program.functions[id.index()].result.ty(),
        ty => ty.clone(),
    }
}

/// Whether a value of a type may be part of an expression that gives what is wanted.
fn leads_to(ty: &Type, wanted: &Declared) -> bool {
    match (wanted, ty) {
        (Declared::Field(FieldType::Choice(_) | FieldType::Named(_) | FieldType::Text), _) => false,
        (_, Type::Invalid | Type::List(_) | Type::Row(_) | Type::File(_)) => true,
        // `0 to count`
        (Declared::List(_), Type::Scalar(_)) => true,
        (Declared::Field(wanted), Type::Scalar(_) | Type::Tuple(..) | Type::Bool | Type::Thing(_)) => {
            is_computed(*wanted)
        }
        _ => false,
    }
}

/// Whether what is wanted is computed with operators.
fn is_computed(wanted: FieldType) -> bool {
    match wanted {
        FieldType::Scalar(_) | FieldType::Int | FieldType::Tuple(..) | FieldType::Bool => true,
        FieldType::OneOf(types) => types.iter().any(|ty| is_computed(*ty)),
        _ => false,
    }
}

/// Whether a function gives a number, several of them, or what has such parts.
fn is_numeric(function: Function) -> bool {
    let gives = |gives: &str| !matches!(gives, "color" | "texture" | "transform") && !gives.starts_with('[');
    function.ways().iter().all(|way| gives(way.gives))
}

/// Whether a function may well give what is wanted.
fn gives(function: Function, wanted: FieldType) -> bool {
    use Function::*;
    match wanted {
        FieldType::Color => matches!(function, Rgb | Srgb | Hsv | Blackbody | Mix),
        FieldType::Paint => {
            matches!(function, Rgb | Srgb | Hsv | Blackbody | Mix) || texture_parameters(function).is_some()
        }
        FieldType::Transform => matches!(function, Scale | Turn | Move | Matrix),
        FieldType::OneOf(types) => types.iter().any(|ty| gives(function, *ty)),
        FieldType::Scalar(_) | FieldType::Int | FieldType::Tuple(..) | FieldType::IntTuple(_) => {
            is_numeric(function)
        }
        _ => false,
    }
}

/// A call of a built-in function, with a hole for each of what it takes.
fn built_in_call(function: Function) -> String {
    let signature = function.signature();
    let first = signature.split(" or ").next().unwrap_or(signature);
    let first = first.split_once("), ").map_or(first, |(first, _)| first).trim_end_matches(')');
    let (name, taken) = first.split_once('(').unwrap_or((first, ""));
    if function == Function::Turn {
        return "turn(‹y›: ‹45deg›)".into();
    }
    let holes: Vec<String> =
        taken.split(", ").filter(|taken| *taken != "…").map(|taken| format!("‹{taken}›")).collect();
    format!("{name}({})", holes.join(", "))
}

/// A call of a declared function, with a hole for each of what it takes.
fn call_of(typing: &Typing, place: Span, name: &str) -> String {
    let taken = typing.analysis.declared(place, |declared| match declared {
        Place::Statement(statement) => match &statement.kind {
            StatementKind::Function { parameters, .. } => {
                parameters.iter().map(|parameter| format!("‹{}›", parameter.name.text)).collect()
            }
            _ => vec![],
        },
        Place::Parameter(_) | Place::Variable(_) => vec![],
    });
    format!("{name}({})", taken.unwrap_or_default().join(", "))
}
