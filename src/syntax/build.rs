//! Items to entries of the tree: what the grammar found, and what is said of its slips.

use super::ast::{
    Body, Broken, Comment, Construct, Entry, Expr, ExprKind, Field, Keyword, Name, Path, Prefix, Statement,
    StatementKind,
};
use super::cut::Item;
use super::errors::{self, Sink, statements};
use super::rows::Rows;
use super::shapes::Shapes;
use super::{MAX_DEPTH, docs, statement, value};
use crate::span::{SourceId, Span};
use pest::Parser;
use pest::iterators::{Pair, Pairs};
use smol_str::SmolStr;
use std::borrow::Cow;
use std::cell::{Cell, RefCell};

#[derive(pest_derive::Parser)]
#[grammar = "../grammar/rt.pest"]
struct Grammar;

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
}

/// The entries of items.
pub(super) fn items(source: Source, items: &[Item]) -> (Vec<Entry>, Sink) {
    let mut entries = Vec::with_capacity(items.len());
    let mut sink = Sink::new();
    let mut shapes = Shapes::default();
    let mut rows = Rows::default();
    for item in items {
        // An item with comments inside has places that its text alone does not tell.
        let plain = matches!(item.text, Cow::Borrowed(_)) && !item.skipped && item.depth < DEEP;
        let start = item.start as u32;
        if plain && let Some((shape, literals)) = shapes.recall(&item.text) {
            if shape.is_plain() && !docs::any(&source, item.start) {
                rows.push(shape, &item.text, start, literals);
                continue;
            }
            let mut copies = shape.copy(&item.text, start, literals);
            copies.iter_mut().for_each(|entry| document(source, entry));
            close(&mut rows, &mut entries);
            entries.append(&mut copies);
            continue;
        }
        close(&mut rows, &mut entries);
        let (built, slips) = on_enough_stack(item, || entries_of(source, item));
        if plain && slips.len() == 0 {
            shapes.learn(&built, start);
        }
        entries.extend(built);
        sink.append(slips);
    }
    close(&mut rows, &mut entries);
    (entries, sink)
}

/// Ends a run of rows.
fn close(rows: &mut Rows, entries: &mut Vec<Entry>) {
    if !rows.is_empty() {
        entries.push(std::mem::take(rows).finish());
    }
}

/// Gives a copy of a statement its own doc.
fn document(source: Source, entry: &mut Entry) {
    if let Entry::Statement(statement) = entry {
        let whole = statement.prefixes.first().map_or(statement.span, |prefix| prefix.span);
        statement.doc = docs::of(&source, whole, statement.span);
    }
}

/// The one expression that an item is.
pub(super) fn value(source: Source, item: Option<&Item>) -> (Expr, Sink) {
    match item {
        Some(item) => on_enough_stack(item, || value_of(source, item)),
        None => {
            let mut sink = Sink::new();
            let span = Span::new(source.id, 0, source.text.len());
            sink.push(errors::missing_value("", span));
            (Expr { kind: ExprKind::Invalid, span }, sink)
        }
    }
}

fn entries_of(source: Source, item: &Item) -> (Vec<Entry>, Sink) {
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

fn value_of(source: Source, item: &Item) -> (Expr, Sink) {
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

/// Whether a complaint about the end of an entry explains what follows on its line.
fn ends_invalid(entry: &Entry) -> bool {
    let invalid = |value: &Expr| matches!(value.kind, ExprKind::Invalid);
    match entry {
        Entry::Field(field) => invalid(&field.value),
        Entry::Broken(_) | Entry::Rows(_) => false,
        Entry::Statement(statement) => match &statement.kind {
            StatementKind::Definition { value, .. } | StatementKind::Function { value, .. } => invalid(value),
            StatementKind::Param { default, range, .. } => invalid(range.as_ref().unwrap_or(default)),
            StatementKind::Assert { condition, message } => invalid(message.as_ref().unwrap_or(condition)),
            // An empty span is that of a body which is missing.
            StatementKind::Part { body, .. } | StatementKind::For { body, .. } => {
                body.span.range().is_empty()
            }
            StatementKind::If { then, otherwise, .. } => {
                otherwise.as_ref().unwrap_or(then).span.range().is_empty()
            }
            StatementKind::Import { name, .. } => name.span.range().is_empty(),
            StatementKind::Thing { .. } => false,
        },
    }
}

/// Makes the value invalid with which an entry ends, because more stands behind it: what it was to be is not known.
/// What stands in a body of its own is looked at all the same.
fn spoil(entry: &mut Entry) {
    let value = match entry {
        Entry::Field(field) => &mut field.value,
        Entry::Broken(_) | Entry::Rows(_) => return,
        Entry::Statement(statement) => match &mut statement.kind {
            StatementKind::Definition { value, .. } | StatementKind::Function { value, .. } => value,
            StatementKind::Param { default, range, .. } => range.as_mut().unwrap_or(default),
            StatementKind::Assert { condition, message } => message.as_mut().unwrap_or(condition),
            _ => return,
        },
    };
    if !matches!(value.kind, ExprKind::Construct(_)) {
        value.kind = ExprKind::Invalid;
    }
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
    sink: RefCell<Sink>,
    /// Whether the depth of an expression was complained of; once an item is enough.
    deep: Cell<bool>,
}

impl<'t> Builder<'t> {
    fn new(source: Source<'t>, item: &'t Item) -> Builder<'t> {
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
        Span::new(self.source.id, self.base + start, self.base + end)
    }

    pub(super) fn span(&self, pair: &Node) -> Span {
        let span = pair.as_span();
        self.at(span.start(), span.end())
    }

    /// The span without the white space at its end, which a rule takes that ends with something optional.
    pub(super) fn trimmed(&self, pair: &Node) -> Span {
        let span = pair.as_span();
        self.at(span.start(), self.before(span.end()).len().max(span.start()))
    }

    /// The place just behind what stands before a pair.
    pub(super) fn behind(&self, pair: &Node) -> Span {
        let before = self.before(pair.as_span().start()).len();
        self.at(before, before)
    }

    /// The text before an offset, without white space at its end.
    pub(super) fn before(&self, offset: usize) -> &'t str {
        self.text[..offset].trim_ascii_end()
    }

    /// Where the item begins in its file.
    pub(super) fn base(&self) -> usize {
        self.base
    }

    /// Whether white space stands at a place of the source, whatever the item has there.
    pub(super) fn is_blank(&self, place: u32) -> bool {
        self.source.text.as_bytes().get(place as usize).is_some_and(u8::is_ascii_whitespace)
    }

    /// The text behind an offset.
    pub(super) fn after(&self, offset: usize) -> &'t str {
        &self.text[offset..]
    }

    /// Whether the item ends with `;` and the line goes on.
    pub(super) fn continued(&self) -> bool {
        self.continued
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
        // Where the last entry ends, if nothing of it was understood: more of the kind on its line is one slip.
        let mut lost = None;
        for pair in pairs {
            match pair.as_rule() {
                Rule::semicolon => self.semicolon(&pair),
                Rule::crowded if explained => muted = Some(self.sink.borrow().len()),
                Rule::crowded => self.crowded(&pair),
                Rule::extra if explained || explained_value => {}
                Rule::extra => {
                    self.unexpected(&pair, errors::unexpected_extra);
                    entries.last_mut().into_iter().for_each(spoil);
                }
                Rule::stray => self.stray(&pair),
                Rule::EOI => {}
                _ => {
                    let known = self.sink.borrow().len();
                    let start = pair.as_span().end() - pair.as_str().trim_ascii_start().len();
                    let end = pair.as_span().start() + pair.as_str().trim_ascii_end().len();
                    let (entry, depth) = self.entry(pair, top);
                    let nameless = matches!(entry, Entry::Broken(Broken { name: None, .. }));
                    let again = lost.is_some_and(|lost| !self.text[lost..start].contains('\n'));
                    if let Some(length) = muted.take().or((nameless && again).then_some(known)) {
                        self.sink.borrow_mut().truncate(length);
                    }
                    lost = nameless.then_some(end);
                    explained = matches!(entry, Entry::Broken(_));
                    explained_value = ends_invalid(&entry);
                    deepest = deepest.max(depth);
                    entries.push(entry);
                }
            }
        }
        (entries, deepest)
    }

    fn entry(&self, pair: Node<'t>, top: bool) -> Deep<Entry> {
        let (rule, span) = (pair.as_rule(), self.trimmed(&pair));
        if rule == Rule::marked {
            return self.marked(pair, top);
        }
        if matches!(rule, Rule::broken | Rule::reported) {
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

    pub(super) fn expression(&self, mut pairs: Pairs<'t, Rule>) -> Deep<Expr> {
        value::expression(self, pairs.next().expect("the grammar puts an expression here"))
    }

    /// An entry with `@off` and the like before it.
    fn marked(&self, pair: Node<'t>, top: bool) -> Deep<Entry> {
        let span = self.trimmed(&pair);
        let (mut prefixes, mut deepest) = (vec![], 0);
        for pair in pair.into_inner() {
            if pair.as_rule() == Rule::mark {
                let (prefix, depth) = self.prefix(pair);
                deepest = deepest.max(depth);
                prefixes.extend(prefix);
                continue;
            }
            let (mut entry, depth) = self.entry(pair, top);
            match &mut entry {
                Entry::Statement(statement) => {
                    statement.doc = docs::of(&self.source, span, statement.span);
                    statement.prefixes = prefixes;
                }
                Entry::Field(field) => {
                    if let Some(prefix) = prefixes.first() {
                        let mark = format!("@{}", prefix.name.text);
                        self.report(statements::marks_field(&mark, &field.name.text, prefix.span));
                    }
                }
                Entry::Broken(broken) => broken.span = span,
                // The grammar knows nothing of them.
                Entry::Rows(_) => {}
            }
            return self.checked(entry, depth.max(deepest), span);
        }
        if let Some(last) = prefixes.last() {
            self.report(statements::marks_nothing(&format!("@{}", last.name.text), last.span));
        }
        (Entry::Broken(Broken { name: None, span }), 0)
    }

    fn prefix(&self, pair: Node<'t>) -> Deep<Option<Prefix>> {
        let span = self.trimmed(&pair);
        let mut inner = pair.into_inner();
        let Some(word) = inner.next().filter(|word| word.as_rule() == Rule::word) else {
            self.report(statements::missing_mark(Span { end: span.start + 1, ..span }));
            return (None, 0);
        };
        let name = self.name(&word);
        let Some(arguments) = inner.next() else {
            return (Some(Prefix { name, arguments: None, span }), 0);
        };
        let (arguments, depth) = value::arguments(self, arguments);
        (Some(Prefix { name, arguments: Some(arguments), span }), depth)
    }

    /// `{ … }`
    pub(super) fn body(&self, pair: Node<'t>) -> Deep<Body> {
        let span = self.span(&pair);
        let (entries, depth) = self.entries(pair.into_inner(), false);
        (Body { entries, span }, depth + 1)
    }

    /// `kind { … }`, without a limit on its depth. The kind is given by its names.
    pub(super) fn construct(&self, mut kind: Vec<Name>, body: Node<'t>) -> Deep<Construct> {
        let (body, depth) = self.body(body);
        let rest = kind.split_off(1);
        let first = kind.pop().expect("a kind has a name");
        for name in std::iter::once(&first).chain(&rest).filter(|name| is_reserved(&name.text)) {
            self.report(errors::reserved(&name.text, name.span));
        }
        let span = first.span.to(body.span);
        (Construct { kind: Path { first, rest }, body, span }, depth)
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
                    let (construct, depth) = self.construct(vec![name], body);
                    let value = Expr { span: construct.span, kind: ExprKind::Construct(Box::new(construct)) };
                    self.checked(Entry::Field(Field { name: word, value }), depth, span)
                }
                name => {
                    self.report(match &name {
                        Some(name) if matches!(word.text.as_str(), "let" | "material") => {
                            errors::missing_equals(&word.text, &name.text, word.span.to(name.span))
                        }
                        None if matches!(word.text.as_str(), "let" | "material") => {
                            errors::missing_name(&word.text, word.span)
                        }
                        _ => statements::begins_nothing(&word.text, word.span),
                    });
                    // The body's own slips are still worth knowing.
                    self.body(body);
                    (Entry::Broken(Broken { name, span }), 0)
                }
            };
        }
        let (construct, depth) = self.construct(kind, body);
        if let Some(name) = name.as_ref().filter(|name| is_reserved(&name.text)) {
            self.report(errors::reserved(&name.text, name.span));
        }
        self.checked(self.plain(StatementKind::Thing { name, construct }, span), depth, span)
    }

    /// A statement with nothing before it but its doc.
    pub(super) fn plain(&self, kind: StatementKind, span: Span) -> Entry {
        let doc = docs::of(&self.source, span, span);
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

    fn definition(&self, keyword: &Node, mut inner: Pairs<'t, Rule>, span: Span) -> Deep<Entry> {
        let name = self.name(&inner.next().expect("a definition has a name"));
        let sign = inner.next().expect("a definition has `=` or `:`");
        let (value, depth) = self.expression(inner);
        if sign.as_str() == ":" {
            let place = self.span(&sign);
            let edit = self.at(name.span.range().end - self.base, sign.as_span().end());
            self.report(errors::colon_in_definition(keyword.as_str(), &name.text, place, edit));
        } else if let Some(ty) = sign.clone().into_inner().next() {
            let edit = self.at(name.span.range().end - self.base, ty.as_span().end());
            self.report(errors::type_in_definition(keyword.as_str(), &name.text, self.span(&ty), edit));
        }
        if is_reserved(&name.text) {
            self.report(errors::reserved(&name.text, name.span));
        }
        let keyword = if keyword.as_str() == "let" { Keyword::Let } else { Keyword::Material };
        (self.plain(StatementKind::Definition { keyword, name, value }, span), depth)
    }
}
