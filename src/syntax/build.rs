//! Items to entries of the tree: what the grammar found, and what is said of its slips.

use super::ast::{Body, Broken, Construct, Entry, Expr, ExprKind, Field, Keyword, Name, Statement};
use super::cut::Item;
use super::errors::{self, Sink};
use super::{MAX_DEPTH, value};
use crate::span::{SourceId, Span};
use pest::Parser;
use pest::iterators::{Pair, Pairs};
use smol_str::SmolStr;
use std::cell::{Cell, RefCell};

#[derive(pest_derive::Parser)]
#[grammar = "../grammar/rt.pest"]
struct Grammar;

/// What the grammar found.
pub(super) type Node<'t> = Pair<'t, Rule>;

/// A piece of the tree, and how many expressions lie inside each other in it.
pub(super) type Deep<T> = (T, usize);

/// The words that cannot be names, those of statements and operators still to come among them.
const RESERVED: &[&str] = &[
    "let", "material", "and", "or", "not", "true", "false", "param", "part", "import", "as", "for", "in",
    "if", "then", "else", "fn", "to", "assert",
];

/// Whether a word is one of the language, and so no name.
pub(super) fn is_reserved(word: &str) -> bool {
    RESERVED.contains(&word)
}

/// The entries of items.
pub(super) fn items(source: SourceId, items: &[Item]) -> (Vec<Entry>, Sink) {
    let mut entries = Vec::with_capacity(items.len());
    let mut sink = Sink::new();
    for item in items {
        let (built, slips) = on_enough_stack(item, || entries_of(source, item));
        entries.extend(built);
        sink.append(slips);
    }
    (entries, sink)
}

/// The one expression that an item is, in a text of this length.
pub(super) fn value(source: SourceId, length: usize, item: Option<&Item>) -> (Expr, Sink) {
    match item {
        Some(item) => on_enough_stack(item, || value_of(source, item)),
        None => {
            let mut sink = Sink::new();
            let span = Span::new(source, 0, length);
            sink.push(errors::missing_value("", span));
            (Expr { kind: ExprKind::Invalid, span }, sink)
        }
    }
}

fn entries_of(source: SourceId, item: &Item) -> (Vec<Entry>, Sink) {
    let builder = Builder::new(source, item);
    let entries = if item.skipped {
        vec![builder.unread()]
    } else if let Ok(pairs) = Grammar::parse(Rule::item, &item.text) {
        builder.entries(pairs, true).0
    } else {
        // The grammar takes any text; what it can lack is stack.
        builder.report(errors::exhausted(builder.whole()));
        vec![builder.unread()]
    };
    (entries, builder.sink.into_inner())
}

fn value_of(source: SourceId, item: &Item) -> (Expr, Sink) {
    let builder = Builder::new(source, item);
    let mut expr = Expr { kind: ExprKind::Invalid, span: builder.whole() };
    if !item.skipped {
        match Grammar::parse(Rule::value, &item.text) {
            Ok(pairs) => {
                for pair in pairs {
                    match pair.as_rule() {
                        Rule::expr => expr = value::expression(&builder, pair).0,
                        Rule::extra_all if matches!(expr.kind, ExprKind::Invalid) => {}
                        Rule::extra_all => builder.unexpected(&pair, errors::unexpected_behind),
                        _ => {}
                    }
                }
            }
            Err(_) => builder.report(errors::exhausted(builder.whole())),
        }
    }
    (expr, builder.sink.into_inner())
}

/// From this nesting on an item gets a stack of its own.
const DEEP: usize = 48;

/// Enough for [`MAX_DEPTH`] brackets, each with all that the grammar can put between two of them.
const DEEP_STACK: usize = 64 << 20;

/// Runs `read`, on a larger stack if the item is nested deep: the caller's may be that of a worker thread.
fn on_enough_stack<T: Send>(item: &Item, read: impl FnOnce() -> T + Send) -> T {
    if item.depth < DEEP || item.skipped {
        return read();
    }
    std::thread::scope(|scope| {
        let thread = std::thread::Builder::new().stack_size(DEEP_STACK);
        let handle = thread.spawn_scoped(scope, read).expect("the system has a thread to spare");
        handle.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    })
}

fn value_in(entry: &Entry) -> Option<&ExprKind> {
    match entry {
        Entry::Field(field) => Some(&field.value.kind),
        Entry::Statement(statement) => match statement.as_ref() {
            Statement::Definition { value, .. } => Some(&value.kind),
            Statement::Thing { .. } => None,
        },
        Entry::Broken(_) => None,
    }
}

/// Builds the tree of one item.
pub(super) struct Builder<'t> {
    source: SourceId,
    text: &'t str,
    base: usize,
    continued: bool,
    sink: RefCell<Sink>,
    /// Whether the depth of an expression was complained of; once an item is enough.
    deep: Cell<bool>,
}

impl<'t> Builder<'t> {
    fn new(source: SourceId, item: &'t Item) -> Builder<'t> {
        let (sink, deep) = (RefCell::new(Sink::new()), Cell::new(false));
        Builder { source, text: &item.text, base: item.start, continued: item.continued, sink, deep }
    }

    pub(super) fn report(&self, diagnostic: crate::diagnostic::Diagnostic) {
        self.sink.borrow_mut().push(diagnostic);
    }

    // --- Places ---------------------------------------------------------------------------------------------

    fn whole(&self) -> Span {
        self.at(0, self.text.len())
    }

    /// The span of a range of the item.
    pub(super) fn at(&self, start: usize, end: usize) -> Span {
        Span::new(self.source, self.base + start, self.base + end)
    }

    pub(super) fn span(&self, pair: &Node) -> Span {
        let span = pair.as_span();
        self.at(span.start(), span.end())
    }

    /// The text before an offset, without white space at its end.
    pub(super) fn before(&self, offset: usize) -> &'t str {
        self.text[..offset].trim_ascii_end()
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
        if depth > MAX_DEPTH && !self.deep.replace(true) {
            self.report(errors::deep_expression(place));
        }
        depth <= MAX_DEPTH
    }

    // --- Entries --------------------------------------------------------------------------------------------

    /// An item that was not parsed. What it seems to define counts as given.
    fn unread(&self) -> Entry {
        let mut words = self.text.split_ascii_whitespace();
        let _kind = words.next();
        let name = words.next().filter(|word| word.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_'));
        let name = name.map(|word| {
            let start = word.as_ptr().addr() - self.text.as_ptr().addr();
            Name { text: SmolStr::new(word), span: self.at(start, start + word.len()) }
        });
        Entry::Broken(Broken { name, span: self.whole() })
    }

    /// Entries, and the slips with which some of them end.
    fn entries(&self, pairs: Pairs<'t, Rule>, top: bool) -> Deep<Vec<Entry>> {
        let (mut entries, mut deepest) = (vec![], 0);
        // Whether a complaint about the last entry, or about its value, explains what follows on its line.
        let (mut explained, mut explained_value) = (false, false);
        let mut muted = None;
        for pair in pairs {
            match pair.as_rule() {
                Rule::semicolon => self.semicolon(&pair),
                Rule::crowded if explained => muted = Some(self.sink.borrow().len()),
                Rule::crowded => self.crowded(&pair),
                Rule::extra if explained || explained_value => {}
                Rule::extra => self.unexpected(&pair, errors::unexpected_extra),
                Rule::stray => self.stray(&pair),
                Rule::EOI => {}
                _ => {
                    let (entry, depth) = self.entry(pair, top);
                    if let Some(length) = muted.take() {
                        self.sink.borrow_mut().truncate(length);
                    }
                    explained = matches!(entry, Entry::Broken(_));
                    explained_value = matches!(value_in(&entry), Some(ExprKind::Invalid));
                    deepest = deepest.max(depth);
                    entries.push(entry);
                }
            }
        }
        (entries, deepest)
    }

    fn entry(&self, pair: Node<'t>, top: bool) -> Deep<Entry> {
        let (rule, span) = (pair.as_rule(), self.span(&pair));
        if matches!(rule, Rule::broken | Rule::reported) {
            self.unexpected(&pair, |token, span| match is_reserved(token) {
                true => errors::reserved(token, span),
                false => errors::unexpected_entry(token, span, top),
            });
            return (Entry::Broken(Broken { name: None, span }), 0);
        }
        let mut inner = pair.into_inner();
        let first = inner.next().expect("every entry begins with a word");
        match rule {
            Rule::field => {
                let (value, depth) = self.expression(inner);
                (Entry::Field(Field { name: self.name(&first), value }), depth)
            }
            Rule::thing => self.thing(&first, inner, span, top),
            Rule::definition => self.definition(&first, inner, span),
            Rule::equals => self.equals(&first, inner, span, top),
            Rule::undefined => self.undefined(&first, inner, span),
            Rule::uncoloned => self.uncoloned(&first, inner, span, top),
            _ => (self.lone(&first, span, top), 0),
        }
    }

    fn expression(&self, mut pairs: Pairs<'t, Rule>) -> Deep<Expr> {
        value::expression(self, pairs.next().expect("the grammar puts an expression here"))
    }

    /// `kind { … }`, without a limit on its depth.
    pub(super) fn construct(&self, kind: &Node, body: Node<'t>) -> Deep<Construct> {
        let span = self.span(&body);
        let (entries, depth) = self.entries(body.into_inner(), false);
        let kind = self.name(kind);
        let span_all = kind.span.to(span);
        (Construct { kind, body: Body { entries, span }, span: span_all }, depth + 1)
    }

    fn thing(&self, kind: &Node<'t>, mut inner: Pairs<'t, Rule>, span: Span, top: bool) -> Deep<Entry> {
        let next = inner.next().expect("a thing has a body");
        let (name, body) = match inner.next() {
            Some(body) => (Some(next), body),
            None => (None, next),
        };
        let name_of = |name: &Node| self.name(name);
        if is_reserved(kind.as_str()) {
            return match &name {
                Some(name) if kind.as_str() == "material" && !top => {
                    self.report(errors::missing_colon("material", self.span(kind), self.span(name)));
                    let (construct, depth) = self.construct(name, body);
                    let value = Expr { span: construct.span, kind: ExprKind::Construct(Box::new(construct)) };
                    self.checked(Entry::Field(Field { name: name_of(kind), value }), depth, span)
                }
                _ => {
                    let named = name.as_ref().map(name_of);
                    self.report(match &named {
                        Some(name) if matches!(kind.as_str(), "let" | "material") => {
                            errors::missing_equals(kind.as_str(), &name.text, self.span(kind).to(name.span))
                        }
                        _ => errors::reserved(kind.as_str(), self.span(kind)),
                    });
                    // The body's own slips are still worth knowing.
                    self.construct(kind, body);
                    (Entry::Broken(Broken { name: named, span }), 0)
                }
            };
        }
        let (construct, depth) = self.construct(kind, body);
        let name = name.as_ref().map(name_of);
        if let Some(name) = name.as_ref().filter(|name| is_reserved(&name.text)) {
            self.report(errors::reserved(&name.text, name.span));
        }
        self.checked(Entry::Statement(Box::new(Statement::Thing { name, construct })), depth, span)
    }

    /// The entry, unless it is too deep.
    fn checked(&self, entry: Entry, depth: usize, span: Span) -> Deep<Entry> {
        if self.allows(depth, span) {
            return (entry, depth);
        }
        let name = match entry {
            Entry::Field(field) => Some(field.name),
            Entry::Statement(statement) => match *statement {
                Statement::Thing { name, .. } => name,
                Statement::Definition { name, .. } => Some(name),
            },
            Entry::Broken(broken) => broken.name,
        };
        (Entry::Broken(Broken { name, span }), 0)
    }

    fn definition(&self, keyword: &Node, mut inner: Pairs<'t, Rule>, span: Span) -> Deep<Entry> {
        let name = self.name(&inner.next().expect("a definition has a name"));
        let sign = inner.next().expect("a definition has `=` or `:`");
        let (value, depth) = self.expression(inner);
        if sign.as_str() == ":" {
            let place = self.span(&sign);
            let edit = self.at(name.span.range().end - self.base, sign.as_span().end());
            self.report(errors::colon_in_definition(keyword.as_str(), &name.text, place, edit));
        }
        if is_reserved(&name.text) {
            self.report(errors::reserved(&name.text, name.span));
        }
        let keyword = if keyword.as_str() == "let" { Keyword::Let } else { Keyword::Material };
        (Entry::Statement(Box::new(Statement::Definition { keyword, name, value, span })), depth)
    }

    // --- Slips ----------------------------------------------------------------------------------------------

    /// `radius = 5cm`
    fn equals(&self, word: &Node, mut inner: Pairs<'t, Rule>, span: Span, top: bool) -> Deep<Entry> {
        let name = self.name(word);
        let sign = inner.next().expect("this slip is about `=`");
        let (value, depth) = self.expression(inner);
        if word.as_str() == "let" || (top && word.as_str() == "material") {
            self.report(errors::missing_name(word.as_str(), name.span));
            return (Entry::Broken(Broken { name: None, span }), 0);
        }
        if is_reserved(&name.text) && &name.text != "material" {
            self.report(errors::reserved(&name.text, name.span));
        } else if top {
            self.report(errors::missing_let(&name.text, name.span));
        } else {
            let edit = self.at(word.as_span().end(), sign.as_span().end());
            self.report(errors::equals_in_field(&name.text, self.span(&sign), edit));
            return (Entry::Field(Field { name, value }), depth);
        }
        (Entry::Broken(Broken { name: Some(name), span }), 0)
    }

    /// `let a 5`
    fn undefined(&self, keyword: &Node, mut inner: Pairs<'t, Rule>, span: Span) -> Deep<Entry> {
        let name = self.name(&inner.next().expect("this slip has a name"));
        let place = self.span(keyword).to(name.span);
        self.report(errors::missing_equals(keyword.as_str(), &name.text, place));
        (Entry::Broken(Broken { name: Some(name), span }), 0)
    }

    /// `radius 50cm`
    fn uncoloned(&self, word: &Node, mut inner: Pairs<'t, Rule>, span: Span, top: bool) -> Deep<Entry> {
        let name = self.name(word);
        let value = inner.next().expect("this slip has a value");
        let value_span = self.at(value.as_span().start(), self.before(value.as_span().end()).len());
        let field = &name.text == "material" && !top;
        if is_reserved(&name.text) && !field {
            self.report(errors::reserved(&name.text, name.span));
        } else if !top {
            self.report(errors::missing_colon(&name.text, name.span, value_span));
            let (value, depth) = value::expression(self, value);
            return (Entry::Field(Field { name, value }), depth);
        } else if value.as_str().trim_end().bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_') {
            self.report(errors::missing_body(self.before(value.as_span().end()), value_span));
        } else {
            self.report(errors::no_brace(&name.text, name.span, value_span));
        }
        (Entry::Broken(Broken { name: Some(name), span }), 0)
    }

    /// `radius`
    fn lone(&self, word: &Node, span: Span, top: bool) -> Entry {
        let name = self.name(word);
        self.report(match name.text.as_str() {
            keyword @ ("let" | "material") if top || keyword == "let" => {
                errors::missing_name(keyword, name.span)
            }
            word if is_reserved(word) && word != "material" => errors::reserved(word, name.span),
            word if top => errors::missing_body(word, name.span),
            word => errors::lone_name(word, name.span),
        });
        Entry::Broken(Broken { name: Some(name), span })
    }

    /// `;` where a comma or nothing should stand.
    pub(super) fn semicolon(&self, pair: &Node) {
        let rest = self.text[pair.as_span().end()..].trim_start_matches([' ', '\t', '\r']);
        let ends = if rest.is_empty() { !self.continued } else { rest.starts_with(['\n', '}', ',', ')']) };
        let replacement = if ends { "" } else { "," };
        self.report(errors::semicolon(self.span(pair), replacement));
    }

    fn crowded(&self, pair: &Node) {
        let start = pair.as_span().start();
        let rest = &self.text[start..];
        let skipped = rest.len() - rest.trim_start_matches([' ', '\t', '\r']).len();
        let word = errors::first_token(&rest[skipped..]);
        let start = start + skipped;
        self.report(errors::crowded(word, self.at(start, start + word.len())));
    }

    fn stray(&self, pair: &Node) {
        let span = self.span(pair);
        match pair.as_str() {
            ";" => self.report(errors::semicolon(span, "")),
            sign => self.report(errors::stray_separator(span, sign)),
        }
    }
}
