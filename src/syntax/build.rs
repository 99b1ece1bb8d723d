//! What the grammar found in an item to entries of the tree, and what is said of its slips.

mod place;

use super::ast::{
    Argument, Body, Broken, Comment, Construct, Entry, Expr, ExprKind, Field, Name, Path, Statement,
    StatementKind,
};
use super::cut::Item;
use super::errors::{self, Held, Sink, statements};
use super::slips::{ends_invalid, spoil};
use super::{GROUP_WORD, PART_WORDS, angled, docs, statement, value};
use crate::span::{SourceId, Span};
use pest::iterators::{Pair, Pairs};
use smol_str::SmolStr;
use std::cell::{Cell, RefCell};

#[derive(pest_derive::Parser)]
#[grammar = "../grammar/rt.pest"]
pub(super) struct Grammar;

/// What the grammar found.
pub(super) type Node<'t> = Pair<'t, Rule>;

/// A piece of the tree, and how many expressions lie inside each other in it.
pub(super) type Deep<T> = (T, usize);

/// Whether a word is one of the language, and so no name.
pub(super) fn is_reserved(word: &str) -> bool {
    super::RESERVED.contains(&word)
}

/// The text that items were cut from.
#[derive(Clone, Copy)]
pub(super) struct Source<'t> {
    pub(super) id: SourceId,
    pub(super) text: &'t str,
    /// All of its comments, in order.
    pub(super) comments: &'t [Comment],
    /// The deepest tree of an expression.
    pub(super) depth: usize,
    /// Items that were read before.
    pub(super) known: Option<&'t super::Remembered>,
}

fn is_statement(rule: Rule) -> bool {
    use Rule::*;
    matches!(rule, param | part | import | function | repetition | choice | assertion | unfinished)
}

/// Builds the tree of one item.
pub(super) struct Builder<'t> {
    source: Source<'t>,
    text: &'t str,
    base: usize,
    continued: bool,
    pub(super) sink: RefCell<Sink>,
    /// Whether the depth of an expression was complained of; once an item is enough.
    deep: Cell<bool>,
    /// Where the body that is being read has a value in angle brackets in place of a field.
    foreign: Cell<Option<Span>>,
    /// Whether a body without braces was complained of; once an item is enough, as its `else` then has none either.
    pub(super) unbraced: Cell<bool>,
    /// Whether a param can stand where it is: in a file or a part, outside of things.
    pub(super) declares: Cell<bool>,
    /// Whether it is in a group, outside of the things in it.
    pub(super) grouped: Cell<bool>,
    /// The kind of what it is directly in, and of what only stands in that, where something does: of [`PART_WORDS`].
    pub(super) holds_part: Cell<Option<[&'static str; 2]>>,
    /// Whether no field can stand where it is: at the top level, also in what repeats or chooses there.
    top: Cell<bool>,
    /// What was to be fields of the body that is being read, and stands in parentheses that were never closed.
    swallowed: RefCell<Vec<Name>>,
}

impl<'t> Builder<'t> {
    pub(super) fn new(source: Source<'t>, item: &'t Item) -> Builder<'t> {
        Builder {
            source,
            text: &item.text,
            base: item.start,
            continued: item.continued,
            sink: RefCell::new(Sink::default()),
            deep: Cell::new(false),
            foreign: Cell::new(None),
            unbraced: Cell::new(false),
            declares: Cell::new(true),
            grouped: Cell::new(false),
            holds_part: Cell::new(None),
            top: Cell::new(true),
            swallowed: RefCell::default(),
        }
    }

    pub(super) fn report(&self, diagnostic: crate::diagnostic::Diagnostic) {
        self.sink.borrow_mut().push(diagnostic);
    }

    /// `at: (0, 1, 2m, radius: 1m }`: the names among what parentheses hold that were never closed count as given behind them. Gives
    /// whether there are any.
    pub(super) fn swallow(&self, arguments: &mut [Argument]) -> bool {
        let mut swallowed = self.swallowed.borrow_mut();
        let known = swallowed.len();
        swallowed.extend(arguments.iter_mut().filter_map(|argument| argument.name.take()));
        swallowed.len() > known
    }

    /// How much was reported.
    pub(super) fn reported(&self) -> Held {
        self.sink.borrow().held()
    }

    pub(super) fn name(&self, pair: &Node) -> Name {
        Name { text: SmolStr::new(pair.as_str()), span: self.span(pair) }
    }

    /// Reports the first token of a text that should not be there.
    pub(super) fn unexpected(&self, pair: &Node, say: impl Fn(&str, Span) -> crate::diagnostic::Diagnostic) {
        let text = pair.as_str();
        let trimmed = text.trim_ascii_start();
        let start = pair.as_span().start() + (text.len() - trimmed.len());
        // Text that was reported already is not complained of again.
        if !trimmed.starts_with('\u{1}') {
            let token = errors::first_token(trimmed);
            self.report(say(token, self.at(start, start + token.len())));
        }
    }

    /// Whether a tree of this depth is allowed; the first that is not is reported.
    pub(super) fn allows(&self, depth: usize, place: Span) -> bool {
        let most = self.source.depth;
        if depth > most && !self.deep.replace(true) {
            self.report(errors::deep_expression(place, most));
        }
        depth <= most
    }

    /// The deepest tree of an expression.
    pub(super) fn most_depth(&self) -> usize {
        self.source.depth
    }

    /// Entries, and the slips with which some of them end.
    pub(super) fn entries(&self, pairs: Pairs<'t, Rule>, top: bool) -> Deep<Vec<Entry>> {
        let around = self.top.replace(top);
        let (mut entries, mut deepest) = (vec![], 0);
        // Whether a complaint about the last entry, or about its value, explains what follows on its line.
        let (mut explained, mut explained_value) = (false, false);
        // Whether it is a definition with `:` in place of `=`.
        let mut signed = false;
        let mut muted = None;
        // Where the fields begin of a value whose brace is missing: they belong to no body.
        let mut headless: Option<usize> = None;
        // Where the last entry ends, if nothing of it was understood: more of the kind on its line is one slip.
        let mut lost = None;
        // Whether the next entry is what belongs to the last, as behind a mistyped `else`.
        let mut otherwise = false;
        for pair in pairs {
            match pair.as_rule() {
                Rule::semicolon => self.semicolon(&pair),
                Rule::crowded | Rule::extra if self.mistyped_else(&pair, entries.last()) => {
                    otherwise = pair.as_rule() == Rule::crowded;
                }
                Rule::crowded if self.goes_on(&pair, entries.last()) => {
                    (otherwise, muted) = (true, Some(self.reported()));
                }
                // `let r: length 5cm`: that `=` is missing was said.
                Rule::extra if signed => entries.last_mut().into_iter().for_each(spoil),
                Rule::crowded if explained => muted = Some(self.reported()),
                Rule::crowded if self.headless(&pair, entries.last()) => {
                    entries.last_mut().into_iter().for_each(spoil);
                    headless = Some(pair.as_span().start());
                }
                Rule::crowded if self.word_before_kind(&pair, entries.last()) => {
                    entries.last_mut().into_iter().for_each(spoil);
                    (otherwise, muted) = (true, Some(self.reported()));
                }
                Rule::crowded => self.crowded(&pair),
                Rule::extra | Rule::decimal | Rule::listed
                    if explained || explained_value || self.unbraced.get() => {}
                Rule::listed => {
                    self.listed(&pair, entries.last());
                    entries.last_mut().into_iter().for_each(spoil);
                }
                Rule::decimal => {
                    if self.decimal(&pair) {
                        entries.last_mut().into_iter().for_each(spoil);
                    }
                }
                Rule::extra => {
                    self.extra(&pair, entries.last());
                    // What follows behind a comma belongs to it: `rgb 1, 0, 0`.
                    lost = Some(pair.as_span().end());
                    entries.last_mut().into_iter().for_each(spoil);
                    // `radius: my radius`: it is not given again.
                    let field = entries.last().and_then(|last| match last {
                        Entry::Field(field) => Some(field.name.text.clone()),
                        _ => None,
                    });
                    let other = self.begins_otherwise(&pair);
                    let other = other.filter(|name| field.as_ref() != Some(&name.text));
                    entries.extend(
                        other.map(|name| {
                            Entry::Broken(Broken { name: Some(name), span: self.trimmed(&pair) })
                        }),
                    );
                }
                Rule::stray => self.stray(&pair),
                Rule::EOI => {}
                _ => {
                    let known = self.reported();
                    let start = pair.as_span().end() - pair.as_str().trim_ascii_start().len();
                    let end = pair.as_span().start() + pair.as_str().trim_ascii_end().len();
                    if !top && angled::is_angled(&pair) {
                        self.foreign.set(self.foreign.get().or(Some(self.at(start, end))));
                    }
                    signed = pair.as_rule() == Rule::definition
                        && pair.clone().into_inner().nth(2).is_some_and(|sign| sign.as_str() == ":");
                    let (entry, depth) = self.entry(pair, top);
                    let nameless = matches!(entry, Entry::Broken(Broken { name: None, .. }));
                    let again = lost.is_some_and(|lost| !self.text[lost..start].contains('\n'));
                    if let Some(held) = muted.take().or((nameless && again).then_some(known)) {
                        self.sink.borrow_mut().truncate(held);
                    }
                    lost = nameless.then_some(end);
                    explained = matches!(entry, Entry::Broken(_));
                    explained_value = ends_invalid(&entry);
                    deepest = deepest.max(depth);
                    let belongs = headless.is_none_or(|from| self.text[from..start].contains('\n'));
                    let other = std::mem::take(&mut otherwise);
                    if !other && (belongs || !matches!(entry, Entry::Field(_))) {
                        entries.push(entry);
                    }
                    // Those of parentheses inside others were found first.
                    let mut swallowed = self.swallowed.take();
                    swallowed.sort_by_key(|name| name.span.start);
                    let given = |name: Name| Entry::Broken(Broken { span: name.span, name: Some(name) });
                    entries.extend(swallowed.into_iter().map(given));
                }
            }
        }
        self.top.set(around);
        (entries, deepest)
    }

    /// Whether things stand where it is, outside of those in it: in a part or a group.
    pub(super) fn holds_things(&self) -> bool {
        self.declares.get() || self.grouped.get()
    }

    pub(super) fn entry(&self, pair: Node<'t>, top: bool) -> Deep<Entry> {
        let (rule, span) = (pair.as_rule(), self.trimmed(&pair));
        if rule == Rule::marked {
            return self.marked(pair, top);
        }
        if matches!(rule, Rule::broken | Rule::reported) {
            if !top && let Some(name) = self.quoted_field(&pair) {
                return (Entry::Broken(Broken { name: Some(name), span }), 0);
            }
            self.unexpected(&pair, |token, span| match is_reserved(token) {
                true => statements::begins_nothing(token, span),
                false => errors::unexpected_entry(token, span, top),
            });
            return (Entry::Broken(Broken { name: None, span }), 0);
        }
        if is_statement(rule) {
            return statement::statement(self, pair);
        }
        let mut inner = pair.into_inner();
        let first = inner.next().expect("every entry begins with a word");
        match rule {
            Rule::field => self.field(&first, inner, span, top),
            Rule::thing => self.thing(&first, inner, span, top),
            Rule::definition => self.definition(&first, inner, span),
            Rule::equals => self.equals(&first, inner, span, top),
            Rule::undefined => self.undefined(&first, inner, span),
            Rule::uncoloned => self.uncoloned(&first, inner, span, top),
            _ => (self.lone(&first, span, top), 0),
        }
    }

    pub(super) fn expression(&self, mut pairs: Pairs<'t, Rule>) -> Deep<Expr> {
        value::expression(self, pairs.next().expect("the grammar puts an expression here"))
    }

    /// `{ … }`
    pub(super) fn body(&self, pair: Node<'t>) -> Deep<Body> {
        let span = self.span(&pair);
        let (entries, depth) = self.entries(pair.into_inner(), false);
        (Body { entries, span }, depth + 1)
    }

    /// `{ … }` of what repeats or chooses: in it stands what stands around it.
    pub(super) fn block(&self, pair: Node<'t>) -> Deep<Body> {
        let span = self.span(&pair);
        let (entries, depth) = self.entries(pair.into_inner(), self.top.get());
        (Body { entries, span }, depth + 1)
    }

    /// `kind { … }`, without a limit on its depth. The kind is given by its names. None where the body is written as
    /// in another language: that is one slip, whatever else it makes wrong.
    pub(super) fn construct(&self, mut kind: Vec<Name>, body: Node<'t>) -> Deep<Option<Construct>> {
        let (known, around) = (self.reported(), self.foreign.take());
        let declares = self.declares.replace(false);
        let word = if let [word] = &kind[..] { word.text.as_str() } else { "" };
        let grouped = self.grouped.replace(word == GROUP_WORD);
        let part = self.holds_part.replace(PART_WORDS.iter().find(|[whole, _]| word == *whole).copied());
        let (body, depth) = self.body(body);
        self.declares.set(declares);
        self.grouped.set(grouped);
        self.holds_part.set(part);
        if let Some(angled) = self.foreign.replace(around) {
            self.sink.borrow_mut().truncate(known);
            self.report(errors::foreign_body(&kind[0].text, kind[0].span, angled));
            return (None, 0);
        }
        let rest = kind.split_off(1);
        let first = kind.pop().expect("a kind has a name");
        for name in std::iter::once(&first).chain(&rest).filter(|name| is_reserved(&name.text)) {
            self.report(errors::reserved(&name.text, name.span));
        }
        let span = first.span.to(body.span);
        (Some(Construct { kind: Path { first, rest }, body, span }), depth)
    }

    /// `kind { … }` as a value.
    pub(super) fn made(&self, kind: Vec<Name>, body: Node<'t>, span: Span) -> Deep<Expr> {
        match self.construct(kind, body) {
            (Some(construct), depth) => {
                let (span, kind) = (construct.span, ExprKind::Construct(Box::new(construct)));
                (Expr { kind, span }, depth)
            }
            (None, depth) => (Expr { kind: ExprKind::Invalid, span }, depth),
        }
    }

    fn thing(&self, path: &Node<'t>, mut inner: Pairs<'t, Rule>, span: Span, top: bool) -> Deep<Entry> {
        let kind: Vec<Name> = path.clone().into_inner().map(|word| self.name(&word)).collect();
        let next = inner.next().expect("a thing has a body");
        let (name, body) = match inner.next() {
            Some(body) => (Some(self.name(&next)), body),
            None => (None, next),
        };
        let word = kind[0].clone();
        if is_reserved(&word.text) {
            return match name {
                Some(name) if &word.text == "material" && !top && kind.len() == 1 => {
                    self.report(errors::missing_colon("material", word.span, name.span));
                    let place = name.span;
                    let (value, depth) = self.made(vec![name], body, place);
                    self.checked(Entry::Field(Field { name: word, value }), depth, span)
                }
                name => {
                    self.report(match &name {
                        Some(name) if matches!(word.text.as_str(), "let" | "material") => {
                            let slip =
                                errors::missing_equals(&word.text, &name.text, word.span.to(name.span));
                            match &word.text == "material" {
                                true => slip.offer(
                                    "make it `diffuse`",
                                    vec![(name.span.after(), " = diffuse".into())],
                                ),
                                false => slip,
                            }
                        }
                        None if &word.text == "material" && !top && !self.holds_things() => {
                            errors::kindless_material(word.span)
                        }
                        None if matches!(word.text.as_str(), "let" | "material") => {
                            errors::missing_name(&word.text, word.span)
                        }
                        _ => statements::begins_nothing(&word.text, word.span),
                    });
                    // The body's own slips are still worth knowing.
                    self.body(body);
                    let field = &word.text == "material" && !top;
                    (Entry::Broken(Broken { name: name.or_else(|| field.then_some(word)), span }), 0)
                }
            };
        }
        let (Some(construct), depth) = self.construct(kind, body) else {
            return (Entry::Broken(Broken { name, span }), 0);
        };
        if let Some(name) = name.as_ref().filter(|name| is_reserved(&name.text)) {
            // `while true { … }`
            if let Some(habit) = errors::habit(&word.text, word.span) {
                self.report(habit);
                return (Entry::Broken(Broken { name: None, span }), 0);
            }
            self.report(errors::reserved(&name.text, name.span));
        }
        self.checked(self.plain(StatementKind::Thing { name, construct }, span), depth, span)
    }

    /// The doc of a statement that begins there, where its marks begin at `whole`.
    pub(super) fn doc(&self, whole: Span, statement: Span) -> Option<SmolStr> {
        docs::of(&self.source, whole, statement)
    }

    /// A statement with nothing before it but its doc.
    pub(super) fn plain(&self, kind: StatementKind, span: Span) -> Entry {
        let doc = self.doc(span, span);
        Entry::Statement(Box::new(Statement { doc, prefixes: vec![], kind, span }))
    }

    /// The entry, unless it is too deep.
    pub(super) fn checked(&self, entry: Entry, depth: usize, span: Span) -> Deep<Entry> {
        if self.allows(depth, span) {
            return (entry, depth);
        }
        let name = match entry {
            Entry::Field(field) => Some(field.name),
            Entry::Statement(statement) => match statement.kind {
                StatementKind::Thing { name, .. } => name,
                StatementKind::Definition { name, .. }
                | StatementKind::Param { name, .. }
                | StatementKind::Part { name, .. }
                | StatementKind::Import { name, .. }
                | StatementKind::Function { name, .. } => Some(name),
                StatementKind::For { .. } | StatementKind::If { .. } | StatementKind::Assert { .. } => None,
            },
            Entry::Broken(broken) => broken.name,
            Entry::Rows(_) => None,
        };
        (Entry::Broken(Broken { name, span }), 0)
    }
}
