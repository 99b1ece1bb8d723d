//! Entries with a slip in their form: what is said of them, and what is still understood.

use super::angled;
use super::ast::{Argument, Broken, Entry, Expr, ExprKind, Field, Name, StatementKind, TypeName};
use super::build::{Builder, Deep, Node, Rule, is_reserved};
use super::errors::{self, statements};
use super::{BLANKS, PLACED_WORDS, beside, is_name, is_word, leading, value};
use crate::diagnostic::Diagnostic;
use crate::span::Span;
use pest::iterators::Pairs;

/// Whether a complaint about the end of an entry explains what follows on its line.
pub(super) fn ends_invalid(entry: &Entry) -> bool {
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

/// The value of a definition that is a name alone.
pub(super) fn bare_name(entry: &mut Entry) -> Option<(smol_str::SmolStr, &mut Expr)> {
    let Entry::Statement(statement) = entry else { return None };
    let StatementKind::Definition { value, .. } = &mut statement.kind else { return None };
    let ExprKind::Name(name) = &value.kind else { return None };
    Some((name.clone(), value))
}

/// The value of a field or a definition.
pub(super) fn value_of(entry: &Entry) -> Option<&Expr> {
    match entry {
        Entry::Field(field) => Some(&field.value),
        Entry::Statement(statement) => match &statement.kind {
            StatementKind::Definition { value, .. } => Some(value),
            _ => None,
        },
        _ => None,
    }
}

/// Makes the value invalid with which an entry ends, because more stands behind it: what it was to be is not known.
/// What stands in a body of its own is looked at all the same.
pub(super) fn spoil(entry: &mut Entry) {
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

impl<'t> Builder<'t> {
    /// `radius: 5cm`, or a slip of that form.
    pub(super) fn field(
        &self,
        word: &Node,
        mut inner: Pairs<'t, Rule>,
        span: Span,
        top: bool,
    ) -> Deep<Entry> {
        let name = self.name(word);
        let lost = |name| (Entry::Broken(Broken { name, span }), 0);
        let value = inner.next().expect("a field has a value");
        // `to:` is the name of a field elsewhere, and what it is called here depends on the kind.
        let field =
            &name.text == "material" || !top && matches!(name.text.as_str(), "to" | "in" | "as" | "part");
        if is_reserved(&name.text) && !field {
            // The `else:` of an `if …:` was explained there.
            if !self.unbraced.get() || &name.text != "else" {
                self.report(statements::begins_nothing(&name.text, name.span));
            }
            return lost(None);
        }
        let only = value.clone().into_inner().next().map(|only| only.as_rule());
        match only {
            Some(Rule::bare_body) if top => return self.signed_body(name, ":", value, span),
            Some(Rule::bare_body) => {
                let (value, depth) = self.kindless(&name.text, value);
                return (Entry::Field(Field { name, value }), depth);
            }
            Some(Rule::absent) if top => {
                self.report(errors::missing_body(&name.text, name.span));
                return lost(Some(name));
            }
            _ => {}
        }
        if let Some(typed) = self.typed(&name, &value, span) {
            return typed;
        }
        let (value, depth) = value::expression(self, value);
        (Entry::Field(Field { name, value }), depth)
    }

    /// `h: length = 1m`: a param without its word, or a field with a type.
    fn typed(&self, name: &Name, value: &Node<'t>, span: Span) -> Option<Deep<Entry>> {
        // Most values are looked at no further.
        value.clone().into_inner().nth(1).filter(|sign| sign.as_rule() == Rule::foreign_equals)?;
        let (ty, sign, given) = value::at_equals(value)?;
        let word = ty.first().filter(|word| super::TYPE_WORDS.contains(&word.as_str().trim_ascii_end()))?;
        let place = self.trimmed(word);
        let ty = Name { text: word.as_str().trim_ascii_end().into(), span: place };
        let (default, depth) = value::part_of(self, given);
        if !self.declares.get() {
            let edit = Span { start: name.span.end, ..self.span(&sign) };
            self.report(statements::type_in_field(&name.text, place, edit));
            return Some((Entry::Field(Field { name: name.clone(), value: default }), depth));
        }
        self.report(statements::missing_param(name, &ty.text));
        let param =
            StatementKind::Param { name: name.clone(), ty: TypeName::Named(ty), default, range: None };
        Some(self.checked(self.plain(param, span), depth + 1, span))
    }

    /// `1,5m`, a number with a decimal comma, or `0,1,0`, values without parentheses: whether it is one of them; else
    /// the value behind the comma belongs to nothing.
    pub(super) fn decimal(&self, pair: &Node) -> bool {
        let comma = pair.as_span().start();
        let is_digit = |c: char| c.is_ascii_digit() || c == '_';
        let whole = self.all_before(comma);
        let digits = whole.len() - whole.trim_end_matches(is_digit).len();
        let number = errors::first_token(&pair.as_str()[1..]);
        if digits == 0 || whole[..whole.len() - digits].ends_with('.') {
            let place = self.at(comma + 1, comma + 1 + number.len());
            self.report(errors::unexpected_entry(number, place, false));
            return false;
        }
        if self.holds_components(pair) {
            let behind = pair.as_str().trim_ascii_end().len();
            self.report(self.bare_components(self.at(comma - digits, comma + behind)));
            return true;
        }
        let place = self.at(comma - digits, comma + 1 + number.len());
        let edit = self.at(comma, comma + 1);
        self.report(errors::decimal_comma(&whole[whole.len() - digits..], number, place, edit));
        true
    }

    /// `at: 0, 1, 0`, values without parentheses behind a field; behind anything else the first belongs to nothing.
    pub(super) fn listed(&self, pair: &Node, before: Option<&Entry>) {
        let all = self.trimmed(pair);
        match before.and_then(value_of) {
            Some(value) => self.report(self.bare_components(Span { start: value.span.start, ..all })),
            None => {
                let rest = pair.as_str()[1..].trim_ascii_start();
                let start = pair.as_span().end() - rest.len();
                let token = errors::first_token(rest);
                self.report(errors::unexpected_entry(token, self.at(start, start + token.len()), false));
            }
        }
    }

    fn bare_components(&self, span: Span) -> Diagnostic {
        let commas = self.written(span).map_or(0, |text| text.matches(',').count());
        errors::bare_components(span, commas + 1)
    }

    /// Whether what begins with a comma between digits goes on with another, or closes an angle bracket.
    fn holds_components(&self, pair: &Node) -> bool {
        let behind = pair.as_str()[1..].split(['(', '[', '{', '"', '\n']).next().unwrap_or("");
        let before = self.all_before(pair.as_span().start());
        let line = before.rsplit('\n').next().unwrap_or("");
        behind.contains(',') || (behind.contains('>') && line.rfind('<') > line.rfind('>'))
    }

    /// `radius = 5cm`
    pub(super) fn equals(
        &self,
        word: &Node,
        mut inner: Pairs<'t, Rule>,
        span: Span,
        top: bool,
    ) -> Deep<Entry> {
        let name = self.name(word);
        let sign = inner.next().expect("this slip is about `=`");
        let value = inner.next().expect("this slip has a value");
        let only = value.clone().into_inner().next().map(|only| only.as_rule());
        if top && only == Some(Rule::bare_body) && !is_reserved(&name.text) {
            return self.signed_body(name, "=", value, span);
        }
        let given = value.as_str();
        let (value, depth) = value::expression(self, value);
        if word.as_str() == "let" || (top && word.as_str() == "material") {
            self.report(errors::missing_name(word.as_str(), name.span));
            return (Entry::Broken(Broken { name: None, span }), 0);
        }
        if is_reserved(&name.text) && &name.text != "material" {
            self.report(statements::begins_nothing(&name.text, name.span));
        } else if top || self.begins_definition(&name.text) {
            // `n = n + 1`
            let changes = given
                .strip_prefix(name.text.as_str())
                .is_some_and(|rest| rest.trim_ascii_start().starts_with(['+', '-', '*', '/']));
            self.report(match changes {
                true => errors::changed(&name.text, name.span),
                false => errors::missing_let(&name.text, name.span),
            });
        } else {
            let edit = self.at(word.as_span().end(), sign.as_span().end());
            self.report(errors::equals_in_field(&name.text, self.span(&sign), edit));
            return (Entry::Field(Field { name, value }), depth);
        }
        (Entry::Broken(Broken { name: Some(name), span }), 0)
    }

    /// `let a 5`
    pub(super) fn undefined(&self, keyword: &Node, mut inner: Pairs<'t, Rule>, span: Span) -> Deep<Entry> {
        let name = self.name(&inner.next().expect("this slip has a name"));
        let start = name.span.range().start - self.base();
        let text = self.after(start);
        let whole = leading(text, "-").trim_end_matches('-');
        if whole.contains('-') && text[whole.len()..].trim_start_matches(BLANKS).starts_with('=') {
            self.report(errors::no_name(keyword.as_str(), whole, self.at(start, start + whole.len())));
            return (Entry::Broken(Broken { name: Some(name), span }), 0);
        }
        // `let mut i = 0`
        let behind = text[name.text.len()..].trim_start_matches(BLANKS);
        let second = leading(behind, "");
        let begins = behind[second.len()..].trim_start_matches(BLANKS).starts_with('=') && is_name(second);
        if begins && matches!(name.text.as_str(), "mut" | "mutable" | "var" | "const" | "rec") {
            let start = self.text_len() - behind.len();
            let second = Name { text: second.into(), span: self.at(start, start + second.len()) };
            self.report(errors::word_in_definition(keyword.as_str(), &name, &second));
            return (Entry::Broken(Broken { name: Some(second), span }), 0);
        }
        // `let my radius = 1m`
        if begins {
            let end = self.text_len() - behind.len() + second.len();
            let (place, joined) = (name.span.to(self.at(end, end)), format!("{}_{second}", name.text));
            self.report(errors::name_of_words(&format!("{} {second}", name.text), &joined, place));
            return (Entry::Broken(Broken { name: None, span }), 0);
        }
        let place = self.span(keyword).to(name.span);
        if text[name.text.len()..].trim_start_matches(BLANKS).starts_with('(') {
            self.report(errors::function_by_let(keyword.as_str(), &name.text, place));
            return (Entry::Broken(Broken { name: Some(name), span }), 0);
        }
        self.report(errors::missing_equals(keyword.as_str(), &name.text, place));
        (Entry::Broken(Broken { name: Some(name), span }), 0)
    }

    /// `radius 50cm`
    pub(super) fn uncoloned(
        &self,
        word: &Node,
        mut inner: Pairs<'t, Rule>,
        span: Span,
        top: bool,
    ) -> Deep<Entry> {
        let name = self.name(word);
        if let Some(mistyped) = self.mistyped(&name, word.as_span().end(), span) {
            return (mistyped, 0);
        }
        let value = inner.next().expect("this slip has a value");
        // `background-color: red`
        let whole = leading(self.after(word.as_span().start()), "-");
        let rest = self.after(word.as_span().start() + whole.len()).trim_start_matches(BLANKS);
        if whole.contains('-') && rest.starts_with(':') && !top {
            let place = self.at(word.as_span().start(), word.as_span().start() + whole.len());
            self.report(errors::no_name("", whole, place));
            return (Entry::Broken(Broken { name: None, span }), 0);
        }
        if let Some(entry) = self.before_statement(&name, &value, span) {
            return (entry, 0);
        }
        let value_span = self.at(value.as_span().start(), self.before(value.as_span().end()).len());
        let field = &name.text == "material" && !top;
        if let Some(named) = self.named_otherwise(&name, &value, span).filter(|_| !is_reserved(&name.text)) {
            return named;
        }
        if (top || self.holds_things())
            && let Some(named) = self.named_with_colon(&name, &value, span)
        {
            return (named, 0);
        }
        if let Some(declared) = self.type_before_name(&name, &value, span) {
            return (declared, 0);
        }
        if let Some(named) = self.name_of_words(&name, value.as_span().start(), top) {
            return (named, 0);
        }
        let no_name = self.no_name(&name.text, value.as_span().start());
        if let Some((diagnostic, name)) = no_name.filter(|_| !is_reserved(&name.text)) {
            self.report(diagnostic);
            return (Entry::Broken(Broken { name, span }), 0);
        }
        if is_reserved(&name.text) && !field {
            if !self.digit_first(&name.text, word.as_span().end()) {
                self.report(statements::begins_nothing(&name.text, name.span));
            }
        } else if !top && is_placement(&name.text) && value.as_str().starts_with('(') {
            self.report(errors::placement_alone(&name.text, name.span.to(value_span)));
        } else if let Some(color) = only(&value, Rule::angled_color).filter(|_| !top) {
            let (value, depth) = angled::color(self, color, Some(&name));
            return (Entry::Field(Field { name, value }), depth);
        } else if !top && self.begins_field(&value) {
            // `sphere radius: 1m }`
            self.report(errors::no_brace(&name.text, name.span, value_span));
            return (Entry::Broken(Broken { name: None, span }), 0);
        } else if let Some(named) = self.thing_or_field(&name, &value, span, top) {
            return (named, 0);
        } else if !top {
            self.report(errors::missing_colon(&name.text, name.span, value_span));
            let (value, depth) = value::expression(self, value);
            return (Entry::Field(Field { name, value }), depth);
        } else if let Some(defined) = self.otherwise_written(&name, &value, value_span) {
            return (Entry::Broken(Broken { name: defined, span }), 0);
        } else if is_word(value.as_str().trim_end())
            && !self.after(value.as_span().end()).trim_ascii_start().starts_with(':')
        {
            self.report(errors::missing_body(
                &self.before(value.as_span().end())[span.range().start - self.base()..],
                value_span,
            ));
        } else {
            self.report(errors::no_brace(&name.text, name.span, value_span));
        }
        let name = Some(name).filter(|name| !is_reserved(&name.text));
        (Entry::Broken(Broken { name, span }), 0)
    }

    /// `length r = 1m`: a definition as languages have it that name its type.
    fn type_before_name(&self, ty: &Name, value: &Node<'t>, span: Span) -> Option<Entry> {
        let mut inner = value.clone().into_inner();
        let (name, sign) = (inner.next()?, inner.next()?);
        let named = sign.as_rule() == Rule::foreign_equals && is_name(name.as_str().trim_ascii_end());
        if !named || !super::TYPE_WORDS.contains(&ty.text.as_str()) || is_reserved(&ty.text) {
            return None;
        }
        let name = Name { text: name.as_str().trim_ascii_end().into(), span: self.trimmed(&name) };
        self.report(statements::type_before_name(ty, &name));
        Some(Entry::Broken(Broken { name: Some(name), span }))
    }

    /// Whether `x = 5` at this place is a definition without its word: in a part or a group, which have few fields.
    fn begins_definition(&self, word: &str) -> bool {
        self.holds_things() && word != "material" && !PLACED_WORDS.contains(&word)
    }

    /// Whether what was taken for a value is the name of a field, with `:` behind it.
    fn begins_field(&self, value: &Node) -> bool {
        is_word(value.as_str().trim_end())
            && self.after(value.as_span().end()).trim_ascii_start().starts_with(':')
    }

    /// A statement as other languages have it. Gives what it declares.
    fn otherwise_written(&self, word: &Name, value: &Node, place: Span) -> Option<Option<Name>> {
        let diagnostic = errors::habit(&word.text, word.span)?;
        self.report(diagnostic);
        let text = errors::first_token(value.as_str());
        let place = Span { end: place.start + text.len() as u32, ..place };
        Some(is_name(text).then(|| Name { text: text.into(), span: place }))
    }

    /// `radius`
    pub(super) fn lone(&self, word: &Node, span: Span, top: bool) -> Entry {
        let name = self.name(word);
        let word_end = word.as_span().end();
        if self.after(word_end).starts_with('.')
            && !is_reserved(&name.text)
            && let Some(name) = self.bodiless_path(&name, word_end, top)
        {
            return Entry::Broken(Broken { name, span });
        }
        let behind = self.after(word_end);
        let start = word_end + behind.len() - behind.trim_start_matches(BLANKS).len();
        if start > word_end
            && let Some((diagnostic, given)) = self.no_name(&name.text, start)
        {
            self.report(diagnostic);
            return Entry::Broken(Broken { name: given, span });
        }
        self.report(match name.text.as_str() {
            keyword @ ("let" | "material") if top || keyword == "let" => {
                errors::missing_name(keyword, name.span)
            }
            word if is_reserved(word) && word != "material" => statements::begins_nothing(word, name.span),
            word if top && errors::changes(self.after(word_end)) => errors::changed(word, name.span),
            word if top => errors::missing_body(word, name.span),
            word => errors::lone_name(word, name.span, self.holds_things()),
        });
        Entry::Broken(Broken { name: Some(name), span })
    }

    /// `;` where a comma or nothing should stand.
    pub(super) fn semicolon(&self, pair: &Node) {
        // What stands behind all of them, as in `;;`, counts.
        let rest = self.after(pair.as_span().end()).trim_start_matches(|c| c == ';' || BLANKS.contains(&c));
        let ends = if rest.is_empty() { !self.continued() } else { rest.starts_with(['\n', '}', ',', ')']) };
        let replacement = if ends { "" } else { "," };
        self.sink.borrow_mut().push_semicolon(self.span(pair), replacement);
    }

    /// `min(1m 2m)`: text behind a value among others.
    pub(super) fn extra_value(&self, pair: &Node, closer: &str, before: Option<&Argument>) {
        // Behind one value one comma mends it.
        let alone = pair.as_str().split_whitespace().count() == 1;
        let behind = before.filter(|_| alone).map(|before| before.value.span.after());
        self.unexpected(pair, |token, span| errors::unexpected_in_brackets(token, span, closer, behind));
    }

    /// `let ball = sphere radius: 1m`: whether the brace behind the kind is the slip. Behind the name of a value it is a comma:
    /// `color: red roughness: 20%`.
    pub(super) fn headless(&self, pair: &Node, before: Option<&Entry>) -> bool {
        if before.is_some_and(|before| matches!(before, Entry::Field(_)) && !beside::is_made(before)) {
            return false;
        }
        let Some(value) = before.and_then(value_of) else { return false };
        let ExprKind::Name(kind) = &value.kind else { return false };
        let rest = self.after(pair.as_span().start()).trim_ascii_start();
        let word = errors::first_token(rest);
        if !is_name(word) || !rest[word.len()..].trim_ascii_start().starts_with(':') {
            return false;
        }
        let start = self.base() + self.text_len() - rest.len();
        let place = Span::new(value.span.source, start, start + word.len());
        self.report(errors::no_brace(kind, value.span, place));
        true
    }

    /// An item that was not parsed. What it seems to define counts as given, unless its name was read from other characters.
    pub(super) fn unread(&self) -> Entry {
        let mut words = self.after(0).split_ascii_whitespace();
        let _kind = words.next();
        let name = words.next().filter(|word| is_name(word));
        let name = name.map(|word| {
            let start = word.as_ptr().addr() - self.after(0).as_ptr().addr();
            Name { text: word.into(), span: self.at(start, start + word.len()) }
        });
        let name = name.filter(|name| self.written(name.span) == Some(name.text.as_str()));
        Entry::Broken(Broken { name, span: self.whole() })
    }

    pub(super) fn crowded(&self, pair: &Node) {
        let start = pair.as_span().start();
        let rest = self.after(start);
        let skipped = rest.len() - rest.trim_start_matches(BLANKS).len();
        let word = errors::first_token(&rest[skipped..]);
        let start = start + skipped;
        let edit = self.at(self.before(start).len(), start);
        let behind = self.after(start + word.len()).trim_start_matches(BLANKS);
        let next = leading(behind, "");
        // Of two words and a body, the first may be anything.
        let statement = super::NAMING_WORDS.contains(&word) && is_name(next);
        let by_itself = statement || is_name(word) && behind.starts_with(':');
        let slip = errors::crowded(word, self.at(start, start + word.len()), edit);
        self.report(if by_itself { slip } else { slip.ask("add a comma") });
    }

    pub(super) fn stray(&self, pair: &Node) {
        let span = self.span(pair);
        match pair.as_str() {
            ";" => self.sink.borrow_mut().push_semicolon(span, ""),
            sign => self.report(errors::stray_separator(span, sign)),
        }
    }
}

/// What an expression is made of, if that is one thing by this rule.
fn only<'t>(value: &Node<'t>, rule: Rule) -> Option<Node<'t>> {
    let mut inner = value.clone().into_inner();
    let first = inner.next().filter(|first| first.as_rule() == rule)?;
    inner.next().is_none().then_some(first)
}

/// Whether a word makes a placement.
pub(super) fn is_placement(word: &str) -> bool {
    matches!(word, "scale" | "turn" | "move" | "matrix" | "rotate" | "translate")
}
