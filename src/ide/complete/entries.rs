//! Fields and statements.

use super::{List, Rank, detail_of, kind_of};
use crate::check::{Home, Kind, Type, describe_wanted};
use crate::ide::hover::kind_doc;
use crate::ide::typing::Typing;
use crate::ide::walk::Declared as Place;
use crate::ide::{CompletionKind, Insert, say};
use crate::schema::{Category, Field, FieldType, KINDS, KindId, PLACED, Preset};
use crate::span::Span;
use crate::units;

/// The statements that begin with a word, as they are written.
const STATEMENTS: &[(&str, &str, &str)] = &[
    ("let", "let ‹name› = ‹1›", "Names a value, or a prototype, which is not drawn."),
    ("material", "material ‹name› = ‹diffuse { color: #cccccc }›", "Names a material."),
    ("param", "param ‹name›: ‹number› = ‹1›", "A setting with a type, a default and optionally a range."),
    ("part", "part ‹name› {\n  ‹›\n}", "A group with params, which is used as a kind."),
    ("import", "import \"‹file.rt›\" as ‹name›", "Takes in another file, which is used as a part."),
    ("fn", "fn ‹name›(‹x›: ‹number›) -> ‹number› = ‹x›", "A function: one expression."),
    ("for", "for ‹i› in ‹range(3)› {\n  ‹›\n}", "Does the same with each item of a list."),
    ("if", "if ‹true› {\n  ‹›\n}", "Does something only where a condition holds."),
    ("assert", "assert ‹true›, \"‹why›\"", "Says what must hold."),
];

impl List<'_> {
    /// What can stand behind `else`.
    pub(super) fn branch(&mut self) {
        for (word, insert, doc) in STATEMENTS.iter().filter(|(word, ..)| *word == "if") {
            self.statement(word, insert, doc, Rank::May);
        }
        self.push("{", CompletionKind::Keyword, Rank::May).insert = Insert::with_holes("{\n  ‹›\n}");
    }

    /// Fields that are not given yet, and statements, as far as the body takes them.
    pub(super) fn entry(&mut self, typing: &Typing) {
        // What is left out, or alone, is something that is drawn.
        let is_solo = typing.cursor.has_prefix("@solo");
        let is_marked = is_solo || typing.cursor.has_prefix("@off");
        let holds_members = match typing.body() {
            Some(body) => {
                if !is_marked {
                    self.fields(typing, body.kind);
                }
                body.kind == Kind::BuiltIn(crate::schema::group::KIND)
            }
            None => true,
        };
        if !holds_members && is_marked {
            return;
        }
        if !holds_members {
            for (word, insert, doc) in
                STATEMENTS.iter().filter(|(word, ..)| matches!(*word, "let" | "material"))
            {
                self.statement(word, insert, doc, Rank::Seldom);
            }
            return;
        }
        let home = home(typing);
        if home == Home::Part && !is_marked {
            let given = typing.given();
            PLACED
                .iter()
                .filter(|field| !given.contains(field.name))
                .for_each(|field| self.field(field, Rank::Rather));
        }
        self.kinds(home, is_solo);
        self.prototypes(typing);
        for (word, insert, doc) in STATEMENTS {
            let fits = match *word {
                "for" | "if" => true,
                "assert" => !is_solo,
                _ if is_marked => false,
                "import" => home == Home::File,
                "param" | "part" | "fn" => matches!(home, Home::File | Home::Part),
                _ => true,
            };
            if fits {
                self.statement(word, insert, doc, Rank::May);
            }
        }
    }

    fn statement(&mut self, word: &str, insert: &str, doc: &str, rank: Rank) {
        let completion = self.push(word, CompletionKind::Keyword, rank);
        completion.insert = Insert::with_holes(insert);
        completion.doc = doc.into();
    }

    /// The fields of a kind that the body does not give yet: those that it needs first.
    fn fields(&mut self, typing: &Typing, kind: Kind) {
        let given = typing.given();
        let free = |name: &str| !given.contains(name);
        match kind {
            Kind::BuiltIn(id) => {
                let base = typing.body().map(|body| body.given).unwrap_or_default();
                let has =
                    |name: &str| !free(name) || id.field_index(name).is_some_and(|index| base.has(index));
                let excluded = |name: &str| id.get().rules.iter().any(|rule| rule.excludes(name, has));
                let fields = id.fields().enumerate();
                for (index, field) in fields.filter(|(_, field)| free(field.name) && !excluded(field.name)) {
                    let needed = field.default == Preset::Required && !base.has(index);
                    self.field(field, if needed { Rank::Fits } else { Rank::May });
                }
            }
            Kind::Part(part) => {
                for param in typing.program.part(part).params.iter().filter(|param| free(&param.name)) {
                    let completion = self.push(&param.name, CompletionKind::Field, Rank::Fits);
                    completion.insert =
                        Insert::with_holes(&format!("{}: ‹{}›", param.name, plain(&param.written)));
                    completion.detail = format!("{} = {}", param.declared.written(), param.written);
                    completion.doc = param.doc.as_ref().map(|doc| doc.to_string()).unwrap_or_default();
                }
                PLACED.iter().filter(|field| free(field.name)).for_each(|field| self.field(field, Rank::May));
            }
            Kind::Thing => {
                PLACED.iter().filter(|field| free(field.name)).for_each(|field| self.field(field, Rank::May))
            }
            Kind::Material => {}
        }
    }

    fn field(&mut self, field: &Field, rank: Rank) {
        let completion = self.push(field.name, CompletionKind::Field, rank);
        completion.insert = match field.ty {
            FieldType::Part(part) => Insert::with_holes(&made(part)),
            _ => Insert::with_holes(&format!("{}: {}", field.name, example(field))),
        };
        completion.detail = describe_wanted(field.ty);
        completion.doc = say::field(field);
    }

    /// The kinds of things that can stand in a body.
    fn kinds(&mut self, home: Home, is_solo: bool) {
        for kind in KINDS {
            let rank = match kind.category {
                Category::Shape | Category::Light | Category::Group => Rank::May,
                Category::Block if !is_solo && matches!(home, Home::File | Home::Branch) => Rank::May,
                Category::Block | Category::Material => continue,
            };
            self.kind(kind.name, rank);
        }
    }

    /// A kind with the fields that it needs.
    pub(super) fn kind(&mut self, name: &str, rank: Rank) {
        let Some(id) = crate::schema::kind(name) else { return };
        let completion = self.push(name, CompletionKind::Kind, rank);
        completion.insert = Insert::with_holes(&made(name));
        completion.doc = kind_doc(id);
    }

    /// Names that are used as kinds. Nothing is made of what it lies in.
    fn prototypes(&mut self, typing: &Typing) {
        let around = typing.around();
        for (name, place, ty) in typing.visible() {
            if is_used(ty) && !around.contains(&place) {
                let completion = self.push(name, kind_of(ty), Rank::Fits);
                completion.insert = Insert::with_holes(&used(name));
                completion.detail = detail_of(ty);
                completion.doc = doc_of(typing, place);
            }
        }
    }
}

/// Whether a name that stands for something of a type is used as a kind.
pub(super) fn is_used(ty: &Type) -> bool {
    match ty {
        Type::Made(making) => making.kind.category() != Category::Material,
        Type::Part(_) | Type::File(_) => true,
        _ => false,
    }
}

/// A name that is used as a kind, with a hole for what its body gives.
pub(super) fn used(name: &str) -> String {
    format!("{name} {{ ‹› }}")
}

/// What the body belongs to in which the cursor stands.
fn home(typing: &Typing) -> Home {
    let text = &typing.analysis.source().text;
    let brace = typing.cursor.open.iter().rev().find(|open| text.as_bytes()[**open] == b'{');
    let Some(brace) = brace else { return Home::File };
    let scopes = typing.analysis.study.notes.scopes.iter();
    let here = scopes.filter(|scope| scope.span.source == typing.analysis.main && scope.place != Home::Head);
    here.filter(|scope| scope.span.range().start == *brace)
        .map(|scope| scope.place)
        .next()
        .unwrap_or(Home::Group)
}

/// The words above the declaration of a name.
pub(super) fn doc_of(typing: &Typing, place: Span) -> String {
    let doc = typing.analysis.declared(place, |declared| match declared {
        Place::Statement(statement) => statement.doc.as_ref().map(|doc| doc.to_string()),
        Place::Parameter(_) | Place::Variable(_) => None,
    });
    doc.flatten().unwrap_or_default()
}

/// A thing of a kind with the fields that it needs, as it is written, with holes.
pub(super) fn made(name: &str) -> String {
    let Some(id) = crate::schema::kind(name) else { return format!("{name} {{ ‹› }}") };
    // What is usual, and fits each other: a camera does not look at itself.
    let value = |field: &Field| match (id.get().name, field.name) {
        ("camera", "from") => "(‹0›, ‹1›, ‹4›)m".into(),
        ("lens", "focal") => "‹50›mm".into(),
        ("lens", "stop") => "‹2.8›".into(),
        ("render", "noise") => "‹1›%".into(),
        _ => example(field),
    };
    let fields: Vec<String> =
        usual(id).iter().map(|field| format!("{}: {}", field.name, value(field))).collect();
    if fields.is_empty() {
        format!("{name} {{ ‹› }}")
    } else {
        format!("{name} {{ {} }}", fields.join(", "))
    }
}

/// The fields that are written first: those that are needed, and what a thing is hardly ever without.
fn usual(id: KindId) -> Vec<&'static Field> {
    let also: &[&str] = match id.get().name {
        "camera" => &["from", "look"],
        "lens" => &["focal", "stop"],
        "render" => &["size", "noise"],
        "emitter" => &["radiance"],
        "light" => &["at"],
        "plane" => &["material"],
        "diffuse" | "metal" | "plastic" | "sky" => &["color"],
        "dielectric" => &["ior"],
        _ => &[],
    };
    id.fields().filter(|field| field.default == Preset::Required || also.contains(&field.name)).collect()
}

/// A value that a field may have, with the parts as holes that are to be filled in.
pub(super) fn example(field: &Field) -> String {
    match field.default {
        // A point or a direction is filled in by components.
        Preset::Value("0") if matches!(field.ty, FieldType::Tuple(..)) => example_of(field.ty),
        Preset::Value(value) => format!("‹{value}›"),
        Preset::Required | Preset::Absent(_) => match field.ty {
            FieldType::Tuple(count, dim) if field.range.low >= 0.0 => tuple(&["‹1›"; 3][..count.min(3)], dim),
            ty => example_of(ty),
        },
    }
}

/// The same of a type.
pub(super) fn example_of(ty: FieldType) -> String {
    match ty {
        FieldType::Scalar(units::ANGLE) => "‹45›deg".into(),
        FieldType::Scalar(units::POWER) => "‹60›W".into(),
        FieldType::Scalar(units::TEMPERATURE) => "‹3200›K".into(),
        FieldType::Scalar(dim) => format!("‹1›{}", dim.example_unit()),
        FieldType::Int => "‹1›".into(),
        FieldType::Bool => "‹true›".into(),
        FieldType::Color | FieldType::Paint => "‹#cccccc›".into(),
        FieldType::Text => "\"‹›\"".into(),
        FieldType::Tuple(count, dim) => tuple(&["‹0›", "‹1›", "‹0›"][..count.min(3)], dim),
        FieldType::IntTuple(_) => "(‹1280›, ‹720›)".into(),
        FieldType::Transform => "‹turn(y: 45deg)›".into(),
        FieldType::Made(Category::Material) => "‹diffuse { color: #cccccc }›".into(),
        FieldType::Choice([first, ..]) => format!("‹{}›", first.name),
        FieldType::OneOf([first, ..]) => example_of(*first),
        _ => "‹›".into(),
    }
}

fn tuple(holes: &[&str], dim: units::Dim) -> String {
    format!("({}){}", holes.join(", "), dim.example_unit())
}

/// Text in which nothing looks like a hole.
fn plain(text: &str) -> String {
    text.replace(['‹', '›', '\n'], " ")
}
