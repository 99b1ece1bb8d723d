//! What the words of a text are.

use super::lex::{Lexeme, lex, split};
use super::walk::Piece;
use super::{Analysis, Stop, Token, TokenKind};
use crate::check::{Making, Meaning, Type};
use crate::schema::Category;
use crate::span::Span;
use crate::syntax::RESERVED;
use crate::syntax::ast::{StatementKind, TypeName};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

/// What the words of a part of the text are; only some once `stop` says so.
pub(super) fn tokens(analysis: &Analysis, range: Range<usize>, stop: Stop) -> Vec<Token> {
    let text = &analysis.source().text;
    let range = range.start.min(text.len())..range.end.min(text.len());
    let words = Words::of(analysis, range.clone(), stop);
    let mut found = vec![];
    for (lexeme, place) in lex(text, 0) {
        if place.start > range.end || stop() {
            break;
        }
        if place.end >= range.start && lexeme != Lexeme::Line {
            words.push(lexeme, place, text, &mut found);
        }
    }
    found
}

/// What is known of the words of a part of a text.
struct Words<'a> {
    analysis: &'a Analysis,
    uses: BTreeMap<usize, Meaning>,
    declared: BTreeSet<usize>,
    types: BTreeSet<usize>,
}

impl<'a> Words<'a> {
    fn of(analysis: &'a Analysis, range: Range<usize>, stop: Stop) -> Words<'a> {
        let uses = analysis.uses(analysis.main, range.clone()).into_iter();
        let here = |(span, _): &&(Span, Type)| span.source == analysis.main && !span.range().is_empty();
        let declared = analysis.study.notes.declared.iter().filter(here);
        let mut types = BTreeSet::new();
        analysis.walk_until(analysis.main, range, stop, &mut |piece| {
            if let Piece::Type(ty) = piece {
                let mut ty = ty;
                while let TypeName::List(inner, _) = ty {
                    ty = inner;
                }
                if let TypeName::Named(name) = ty {
                    types.insert(name.span.range().start);
                }
            }
        });
        Words {
            analysis,
            uses: uses.map(|(span, meaning)| (span.range().start, meaning)).collect(),
            declared: declared.map(|(span, _)| span.range().start).collect(),
            types,
        }
    }

    fn push(&self, lexeme: Lexeme, place: Range<usize>, text: &str, found: &mut Vec<Token>) {
        let source = self.analysis.main;
        let mut token = |start: usize, end: usize, kind| {
            let span = Span::new(source, start, end);
            found.push(Token { span, kind, declaration: false, built_in: false });
        };
        match lexeme {
            Lexeme::Comment => {
                let doc = text[place.clone()].starts_with("///") && !text[place.clone()].starts_with("////");
                let kind = if doc { TokenKind::Doc } else { TokenKind::Comment };
                // None goes over a line end.
                let mut start = place.start;
                for line in text[place].split_inclusive('\n') {
                    let shown = line.trim_end();
                    let before = shown.len() - shown.trim_start().len();
                    if !shown.trim_start().is_empty() {
                        token(start + before, start + shown.len(), kind);
                    }
                    start += line.len();
                }
            }
            Lexeme::Number => {
                let (number, unit) = split(&text[place.clone()]);
                let middle = place.start + number.len();
                token(place.start, middle, TokenKind::Number);
                if !unit.is_empty() {
                    token(middle, place.end, TokenKind::Unit);
                }
            }
            Lexeme::Text => token(place.start, place.end, TokenKind::Text),
            Lexeme::Color => token(place.start, place.end, TokenKind::Colour),
            Lexeme::Prefix => token(place.start, place.end, TokenKind::Prefix),
            Lexeme::Mark if text[place.clone()].starts_with(is_operator) => {
                token(place.start, place.end, TokenKind::Operator)
            }
            Lexeme::Mark | Lexeme::Line => {}
            Lexeme::Word => found.extend(self.word(place, text)),
        }
    }

    fn word(&self, place: Range<usize>, text: &str) -> Option<Token> {
        let (start, word) = (place.start, &text[place.clone()]);
        let span = Span::new(self.analysis.main, place.start, place.end);
        let token = |kind| Token { span, kind, declaration: false, built_in: true };
        if self.declared.contains(&start) {
            let kind = self.declared_kind(span);
            return Some(Token { span, kind, declaration: true, built_in: false });
        }
        Some(match self.uses.get(&start) {
            Some(Meaning::Declared(declared)) => {
                Token { span, kind: self.declared_kind(*declared), declaration: false, built_in: false }
            }
            Some(Meaning::Kind(_)) => token(TokenKind::Kind),
            Some(Meaning::Field(..) | Meaning::Placed(_) | Meaning::Component) => token(TokenKind::Field),
            Some(Meaning::Function(_)) => token(TokenKind::Function),
            Some(Meaning::Color(_)) => token(TokenKind::Value),
            Some(Meaning::Word(_)) => token(TokenKind::Word),
            None if self.types.contains(&start) => token(TokenKind::Type),
            None if RESERVED.contains(&word) => token(TokenKind::Keyword),
            // Behind parentheses a unit stands by itself.
            None if text[..start].ends_with([')', ']']) => {
                Token { built_in: false, ..token(TokenKind::Unit) }
            }
            None => return None,
        })
    }

    /// What the name is that is declared at a place.
    fn declared_kind(&self, place: Span) -> TokenKind {
        let by_statement = self.analysis.declared(place, |declared| match declared {
            super::walk::Declared::Parameter(_) | super::walk::Declared::Variable(_) => {
                Some(TokenKind::Variable)
            }
            super::walk::Declared::Statement(statement) => match statement.kind {
                StatementKind::Param { .. } => Some(TokenKind::Param),
                StatementKind::Part { .. } => Some(TokenKind::Part),
                StatementKind::Import { .. } => Some(TokenKind::Module),
                StatementKind::Function { .. } => Some(TokenKind::Function),
                StatementKind::Thing { .. } => Some(TokenKind::Thing),
                _ => None,
            },
        });
        let ty = self.analysis.study.notes.declared(place);
        by_statement.flatten().unwrap_or(match ty {
            Some(Type::Made(Making { kind, .. })) if kind.category() == Category::Material => {
                TokenKind::Material
            }
            Some(Type::Made(_)) => TokenKind::Prototype,
            _ => TokenKind::Value,
        })
    }
}

fn is_operator(mark: char) -> bool {
    "+-*/=!<>|".contains(mark)
}
