//! The files that a text names.

use super::walk::Piece;
use super::{Analysis, Link};
use crate::check::{Function, Meaning};
use crate::files::FilePath;
use crate::schema::{FieldType, KindId};
use crate::span::Span;
use crate::syntax::ast::{Expr, ExprKind, StatementKind};
use std::ops::Range;

/// The files that the text names.
pub(super) fn links(analysis: &Analysis) -> Vec<Link> {
    let all = 0..analysis.source().text.len();
    let places = analysis.paths(all).into_iter();
    places
        .filter_map(|(span, text)| Some(Link { span, path: analysis.source().path.join(&text).ok()? }))
        .collect()
}

/// Whether a field takes the path of a file.
pub(super) fn takes_path(kind: KindId, index: usize) -> bool {
    // There is no other use for a text.
    kind.field(index).ty == FieldType::Text
}

impl Analysis {
    /// The paths that are written in a part of the text, each between its quotes.
    fn paths(&self, range: Range<usize>) -> Vec<(Span, String)> {
        let mut found = vec![];
        let meaning = |span: Span| self.meaning(span);
        self.walk(self.main, range, &mut |piece| match piece {
            Piece::Statement(statement) => {
                if let StatementKind::Import { path, .. } = &statement.kind {
                    found.extend(within(path.span, &path.text));
                }
            }
            Piece::Field(field) => {
                if let Some(Meaning::Field(kind, index)) = meaning(field.name.span)
                    && takes_path(kind, index)
                {
                    found.extend(text(&field.value));
                }
            }
            Piece::Expr(Expr { kind: ExprKind::Call { function, arguments }, .. }) => {
                let called = meaning(function.first.span);
                let reads = matches!(called, Some(Meaning::Function(Function::Image | Function::Table)));
                if let Some(first) = arguments.first().filter(|_| reads) {
                    found.extend(text(&first.value));
                }
            }
            _ => {}
        });
        found
    }

    /// The path at a byte, and the file it leads to.
    pub(super) fn path_at(&self, at: usize) -> Option<(Span, FilePath)> {
        let here = |span: &Span| span.range().start <= at && at <= span.range().end;
        let (span, written) = self.paths(at..at).into_iter().find(|(span, _)| here(span))?;
        Some((span, self.source().path.join(&written).ok()?))
    }

    /// The file that is imported under the name that is declared at a place.
    pub(super) fn import_path(&self, name: Span) -> Option<FilePath> {
        let mut found = None;
        self.walk(name.source, name.range(), &mut |piece| {
            if let Piece::Statement(statement) = piece
                && let StatementKind::Import { path, name: declared } = &statement.kind
                && declared.span == name
            {
                found = Some(path.text.clone());
            }
        });
        self.sources.get(name.source).path.join(&found?).ok()
    }
}

fn text(value: &Expr) -> Option<(Span, String)> {
    match &value.kind {
        ExprKind::Text(text) => within(value.span, text),
        _ => None,
    }
}

/// Between the quotes.
fn within(span: Span, text: &str) -> Option<(Span, String)> {
    let inside = Span { start: span.start + 1, end: span.end.checked_sub(1)?, ..span };
    (inside.start <= inside.end).then(|| (inside, text.to_string()))
}
