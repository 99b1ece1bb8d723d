//! Who uses a name, and giving it another.

use super::walk::Piece;
use super::{Analysis, Edit, Location};
use crate::check::{Function, Home, Meaning, Visible};
use crate::diagnostic::{Severity, any_errors};
use crate::schema::{self, FieldType, KINDS, PLACED};
use crate::span::Span;
use crate::syntax::ast::{Construct, Expr, ExprKind};
use crate::syntax::{self, RESERVED};
use crate::{color, units};
use std::collections::BTreeSet;

/// The name at a byte, if it can be renamed; else why it cannot.
pub(super) fn renamable(analysis: &Analysis, at: usize) -> Option<Result<Span, String>> {
    let (span, meaning) = analysis.named(at)?;
    let built_in = |what: &str| Some(Err(format!("{what} is built in and keeps its name")));
    match meaning {
        Meaning::Declared(_) => Some(Ok(span)),
        Meaning::Kind(_) => built_in("a kind"),
        Meaning::Field(..) | Meaning::Placed(_) => built_in("a field of a kind"),
        Meaning::Function(_) => built_in("a function"),
        Meaning::Color(_) => built_in("a colour"),
        Meaning::Word(_) => built_in("a word that a field understands"),
        Meaning::Component => built_in("a component"),
    }
}

/// Every place of `all` that means what stands at a byte of the text of `of`, by file and place, each once; the declaration too
/// where that is wanted. Those of `of` are looked through even where it is not among them.
pub fn references(all: &[&Analysis], of: &Analysis, at: usize, declaration: bool) -> Vec<Location> {
    let Some((_, meaning)) = of.named(at) else { return vec![] };
    let Meaning::Declared(place) = meaning else {
        let uses = of.uses(of.main, 0..of.source().text.len()).into_iter();
        let same = uses.filter(|(_, other)| *other == meaning);
        return same.filter_map(|(span, _)| of.location(span)).collect();
    };
    let Some(declared) = of.location(place) else { return vec![] };
    let found =
        all.iter().copied().chain([of]).flat_map(|analysis| uses_of(analysis, &declared, declaration));
    found.collect::<BTreeSet<Location>>().into_iter().collect()
}

/// The places of one analysis that mean what is declared at a place.
fn uses_of(analysis: &Analysis, declared: &Location, declaration: bool) -> Vec<Location> {
    let Some(place) = place_in(analysis, declared) else { return vec![] };
    let uses = analysis.files().flat_map(|(id, source)| analysis.uses(id, 0..source.text.len()));
    let same = uses.filter(|(_, meaning)| *meaning == Meaning::Declared(place)).map(|(span, _)| span);
    same.chain(declaration.then_some(place)).filter_map(|span| analysis.location(span)).collect()
}

/// Where an analysis has a place, if something is declared there.
fn place_in(analysis: &Analysis, place: &Location) -> Option<Span> {
    let (id, _) = analysis.source_at(&place.path)?;
    let place = Span::new(id, place.range.start, place.range.end);
    analysis.study.notes.declared(place).map(|_| place)
}

/// The edits that give what stands at a byte of the text of `of` another name wherever `all` use it; a sentence that says
/// why not where the name cannot be, or would mean another thing somewhere.
pub fn rename(all: &[&Analysis], of: &Analysis, at: usize, name: &str) -> Result<Vec<Edit>, String> {
    let nothing = || "nothing here has a name that can be changed".to_string();
    renamable(of, at).ok_or_else(nothing)??;
    let Some((_, Meaning::Declared(place))) = of.named(at) else { return Err(nothing()) };
    let declared = of.location(place).ok_or("it is declared outside of the scene's files")?;
    if of.sources.text(place) == name {
        return Ok(vec![]);
    }
    allowed(name)?;
    let mut edits = BTreeSet::new();
    for analysis in all.iter().copied().chain([of]) {
        let Some(place) = place_in(analysis, &declared) else { continue };
        readable(analysis)?;
        understood(analysis, place)?;
        let places = uses_of(analysis, &declared, true);
        free(analysis, place, &places, name)?;
        edits.extend(places.into_iter().map(|at| Edit { at, text: name.to_string() }));
    }
    Ok(edits.into_iter().collect())
}

/// Whether this may be a name at all.
fn allowed(name: &str) -> Result<(), String> {
    if !syntax::is_word(name) {
        return Err(format!("`{name}` is no name: letters, digits and `_`, and no digit first"));
    }
    let what = if RESERVED.contains(&name) {
        "a word of the language"
    } else if units::is_unit(name) {
        "a unit"
    } else if schema::kind(name).is_some() {
        "a built-in kind"
    } else if Function::ALL.iter().any(|function| function.name() == name) {
        "a built-in function"
    } else if KINDS.iter().flat_map(|kind| kind.fields).any(|field| has_word(field.ty, name)) {
        "a word that a field understands"
    } else {
        return Ok(());
    };
    Err(format!("`{name}` is {what}"))
}

fn has_word(ty: FieldType, name: &str) -> bool {
    match ty {
        FieldType::Choice(words) => words.iter().any(|word| word.name == name),
        FieldType::OneOf(types) => types.iter().any(|ty| has_word(*ty, name)),
        _ => false,
    }
}

/// What could not be read may use the name.
fn readable(analysis: &Analysis) -> Result<(), String> {
    let slip = analysis.diagnostics.iter().find(|diagnostic| {
        diagnostic.severity() == Severity::Error && diagnostic.code.as_str().starts_with("E00")
    });
    match slip {
        Some(slip) => {
            let file = &analysis.sources.get(slip.primary.span.source).name;
            Err(format!("`{file}` has text that cannot be read ({}); mend it first", slip.message))
        }
        None => Ok(()),
    }
}

/// What was not understood may mean what is declared at a place, where it has its name.
fn understood(analysis: &Analysis, place: Span) -> Result<(), String> {
    if !any_errors(&analysis.diagnostics) {
        return Ok(());
    }
    let name = analysis.sources.text(place);
    let home = analysis.home(place);
    let by_path = home.is_some_and(|home| matches!(home.place, Home::Part | Home::Group | Home::File));
    let mut found = None;
    let mut look = |span: Span, is_path: bool| {
        let reaches = if is_path { by_path } else { home.is_some_and(|home| home.span.contains(span)) };
        if reaches && analysis.sources.text(span) == name && analysis.meaning(span).is_none() {
            found.get_or_insert(span);
        }
    };
    for (id, source) in analysis.files() {
        analysis.walk(id, 0..source.text.len(), &mut |piece| match piece {
            Piece::Field(field) => look(field.name.span, true),
            Piece::Construct(Construct { kind: path, .. })
            | Piece::Expr(Expr { kind: ExprKind::Call { function: path, .. }, .. }) => {
                look(path.first.span, false);
                path.rest.iter().for_each(|inner| look(inner.span, true));
            }
            Piece::Expr(Expr { kind: ExprKind::Name(_), span }) => look(*span, false),
            Piece::Expr(Expr { kind: ExprKind::Member { member, .. }, .. }) => look(member.span, true),
            _ => {}
        });
    }
    match found {
        Some(span) => {
            let (file, line) = analysis.line_of(span);
            Err(format!("what `{name}` means at {file}, line {line} is not known; mend that first"))
        }
        None => Ok(()),
    }
}

impl Analysis {
    /// The scope that declares the name at a place.
    fn home(&self, place: Span) -> Option<&Visible> {
        let declares = |scope: &&Visible| scope.names.iter().any(|(_, span, _)| *span == place);
        self.study.notes.scopes.iter().find(declares)
    }

    /// A place for who reads of it: its file, and its line.
    fn line_of(&self, span: Span) -> (&str, usize) {
        (&self.sources.get(span.source).name, self.sources.place_of(span).start.line)
    }
}

/// Whether a name means nothing yet wherever it would be written or seen.
fn free(analysis: &Analysis, place: Span, uses: &[Location], name: &str) -> Result<(), String> {
    let taken = |what: &str, span: Span| {
        let (file, line) = analysis.line_of(span);
        Err(format!("`{name}` is {what} at {file}, line {line}"))
    };
    let scopes = &analysis.study.notes.scopes;
    let home = analysis.home(place);
    // Names hide nothing: neither around the declaration nor inside may there be another one.
    for scope in scopes {
        let related =
            home.is_some_and(|home| home.span.contains(scope.span) || scope.span.contains(home.span));
        let other = scope.names.iter().find(|(known, span, _)| known == name && *span != place);
        if let Some((_, span, _)) = other.filter(|_| related) {
            return taken("declared", *span);
        }
    }
    // A field of what holds the name is asked for in the same way.
    let within = home.is_some_and(|home| matches!(home.place, Home::Part | Home::Group | Home::File));
    if within && PLACED.iter().any(|field| field.name == name) {
        return Err(format!("`{name}` is a field of whatever is placed"));
    }
    if color::named(name).is_some() {
        let colour = (analysis.study.notes.uses.iter()).find(|(span, meaning)| {
            matches!(meaning, Meaning::Color(_)) && analysis.sources.text(*span) == name
        });
        if let Some((span, _)) = colour {
            return taken("used as the built-in colour", *span);
        }
    }
    // Where it is used, another thing of this name may be seen: it stands in a scope of that place.
    let others: Vec<(Span, Span)> = (scopes.iter())
        .flat_map(|scope| scope.names.iter().map(move |(known, span, _)| (scope.span, known, *span)))
        .filter(|(_, known, span)| *known == name && *span != place)
        .map(|(scope, _, span)| (scope, span))
        .collect();
    for location in uses.iter().filter(|_| !others.is_empty()) {
        let Some((id, _)) = analysis.source_at(&location.path) else { continue };
        let used = Span::new(id, location.range.start, location.range.end);
        let is_path = analysis.sources.get(id).text[..location.range.start].trim_end().ends_with('.');
        let is_field = analysis.sources.get(id).text[location.range.end..].trim_start().starts_with(':');
        if is_path || is_field {
            continue;
        }
        if let Some((_, span)) = others.iter().find(|(scope, _)| scope.contains(used)) {
            return taken("declared", *span);
        }
    }
    Ok(())
}
