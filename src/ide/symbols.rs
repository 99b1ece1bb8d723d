//! What a text declares.

use super::walk::{name_of, whole};
use super::{Analysis, Symbol, SymbolKind, say};
use crate::check::{Making, Meaning, Notes, Type};
use crate::schema::Category;
use crate::source::{Source, Sources};
use crate::span::Span;
use crate::syntax::ast::{Body, Construct, Entry, Expr, ExprKind, Keyword, Statement, StatementKind};
use crate::syntax::{self, Limits};

/// The most things without a name that are listed one by one where they are all alike.
const MOST_ROWS: usize = 1000;

/// What the text declares, as a tree.
pub(super) fn symbols(analysis: &Analysis) -> Vec<Symbol> {
    let file = analysis.study.files.iter().find(|file| file.source == analysis.main);
    let outline = Outline { sources: &analysis.sources, notes: &analysis.study.notes };
    file.map(|file| outline.body(&file.tree.body)).unwrap_or_default()
}

/// What a text declares by its form alone, without looking at what it imports or what names mean: the symbols of its
/// [`Analysis`], though of some it is only guessed what they are. It is soon known, for files that nobody has open.
/// The places are in the first source, whatever the text is.
pub fn outline(source: &Source) -> Vec<Symbol> {
    let mut sources = Sources::default();
    let id = sources.add(source.clone());
    let (tree, _) = syntax::parse_rows(id, &source.text, Limits::default());
    Outline { sources: &sources, notes: &Notes::default() }.body(&tree.body)
}

struct Outline<'a> {
    sources: &'a Sources,
    /// What names mean, as far as it is known.
    notes: &'a Notes,
}

impl Outline<'_> {
    fn body(&self, body: &Body) -> Vec<Symbol> {
        let mut found = vec![];
        for entry in &body.entries {
            match entry {
                Entry::Statement(statement) => self.statement(statement, &mut found),
                Entry::Rows(rows) => {
                    let text = &self.sources.get(body.span.source).text;
                    for row in 0..rows.len().min(MOST_ROWS) {
                        self.statement(&rows.statement(row, text), &mut found);
                    }
                }
                Entry::Field(field) => self.within(&field.value, &mut found),
                Entry::Broken(_) => {}
            }
        }
        found
    }

    /// What a value that is written in place declares.
    fn within(&self, value: &Expr, found: &mut Vec<Symbol>) {
        if let ExprKind::Construct(construct) = &value.kind {
            found.extend(self.body(&construct.body));
        }
    }

    fn statement(&self, statement: &Statement, found: &mut Vec<Symbol>) {
        let (kind, children) = match &statement.kind {
            StatementKind::Thing { construct, .. } => (self.kind_of(construct), self.body(&construct.body)),
            StatementKind::Definition { keyword, name, value } => {
                let mut children = vec![];
                self.within(value, &mut children);
                let made = self.notes.declared(name.span);
                let kind = match (keyword, made) {
                    (Keyword::Material, _) => SymbolKind::Material,
                    (Keyword::Let, Some(Type::Made(_))) => SymbolKind::Prototype,
                    (Keyword::Let, None) if matches!(value.kind, ExprKind::Construct(_)) => {
                        SymbolKind::Prototype
                    }
                    (Keyword::Let, _) => SymbolKind::Value,
                };
                (kind, children)
            }
            StatementKind::Param { .. } => (SymbolKind::Param, vec![]),
            StatementKind::Part { body, .. } => (SymbolKind::Part, self.body(body)),
            StatementKind::Import { .. } => (SymbolKind::Module, vec![]),
            StatementKind::Function { .. } => (SymbolKind::Function, vec![]),
            // What a branch or a loop holds stands beside it.
            StatementKind::For { body, .. } => return found.extend(self.body(body)),
            StatementKind::If { then, otherwise, .. } => {
                found.extend(self.body(then));
                found.extend(otherwise.iter().flat_map(|body| self.body(body)));
                return;
            }
            StatementKind::Assert { .. } => return,
        };
        let (name, select) = self.title(statement);
        let detail = self.detail(statement);
        let off = statement.prefixes.iter().any(|prefix| prefix.name.text == "off");
        found.push(Symbol { name, kind, detail, span: whole(statement), select, children, off });
    }

    /// The name of a statement, or else what stands in place of it.
    fn title(&self, statement: &Statement) -> (String, Span) {
        match (name_of(statement), &statement.kind) {
            (Some(name), _) => (name.text.to_string(), name.span),
            (None, StatementKind::Thing { construct, .. }) => {
                let path = &construct.kind;
                let span = path.rest.last().map_or(path.first.span, |last| path.first.span.to(last.span));
                (self.sources.text(span).to_string(), span)
            }
            (None, _) => (self.sources.head(statement.span).to_string(), statement.span),
        }
    }

    fn detail(&self, statement: &Statement) -> String {
        let declared = |span: Span| self.notes.declared(span);
        let text = |span: Span| self.sources.first_line(span).to_string();
        match &statement.kind {
            StatementKind::Thing { name: Some(_), construct } => construct.kind.first.text.to_string(),
            StatementKind::Definition { name, .. } => match declared(name.span) {
                Some(Type::Invalid) | None => String::new(),
                Some(ty) => say::ty(ty),
            },
            StatementKind::Param { default, .. } => text(default.span),
            StatementKind::Import { path, .. } => path.text.to_string(),
            StatementKind::Function { result, .. } => match result {
                crate::syntax::ast::TypeName::Named(name) => name.text.to_string(),
                crate::syntax::ast::TypeName::List(_, span) => text(*span),
                crate::syntax::ast::TypeName::Invalid(_) => String::new(),
            },
            _ => String::new(),
        }
    }

    fn kind_of(&self, construct: &Construct) -> SymbolKind {
        let last = construct.kind.rest.last().unwrap_or(&construct.kind.first);
        let notes = self.notes;
        let category = match notes.meaning(last.span) {
            Some(Meaning::Kind(kind)) => Some(kind.get().category),
            Some(Meaning::Declared(place)) => match notes.declared(place) {
                Some(Type::Made(Making { kind, .. })) => Some(kind.category()),
                Some(Type::Part(_) | Type::File(_)) => Some(Category::Group),
                _ => None,
            },
            // Of rows only the first of each shape is noted.
            _ => crate::schema::kind(&last.text).map(|kind| kind.get().category),
        };
        match category {
            Some(Category::Group) => SymbolKind::Group,
            Some(Category::Light) => SymbolKind::Light,
            Some(Category::Block) => SymbolKind::Block,
            Some(Category::Material) => SymbolKind::Material,
            Some(Category::Shape) | None => SymbolKind::Shape,
        }
    }
}
