//! Things that differ in their literals only, as a table: a shape, and for each thing a row of literals.
//!
//! A long list of things written one by one takes most of its memory in trees that are all alike. A row holds what is
//! its own: where it begins, its numbers and where they end. From these follows every place in it.

use super::ast::{Body, Construct, Entry, Expr, ExprKind, Statement, StatementKind, UnaryOp};
use super::places::{self, Visit};
use crate::span::Span;
use smol_str::SmolStr;
use std::sync::Arc;

/// A number without its unit, or a colour with its `#`: bytes of an item.
#[derive(Clone, Copy, Debug)]
pub(super) struct Literal {
    pub(super) start: u32,
    pub(super) end: u32,
}

/// The first item of those that differ in their literals only.
#[derive(Debug)]
pub struct Shape {
    entries: Vec<Entry>,
    /// Where the item begins.
    start: u32,
    literals: Vec<Literal>,
    /// For each end of each place, in the order in which [`places`] visits them: how many literals end before it.
    behind: Vec<(u16, u16)>,
    /// Whether others of this shape can be rows.
    plain: bool,
}

/// Things of a few shapes, one after the other.
#[derive(Debug, Default)]
pub struct Rows {
    shapes: Vec<Arc<Shape>>,
    rows: Vec<Row>,
    /// The literals of all rows: numbers, and colours as 0xrrggbb.
    values: Vec<f64>,
    /// Where they end, counted from the beginning of their item.
    ends: Vec<u16>,
}

#[derive(Clone, Copy, Debug)]
struct Row {
    shape: u32,
    /// Where the item begins.
    start: u32,
    /// Index of its first literal.
    first: u32,
}

impl Shape {
    /// What an item and its literals show; none where its tree has other literals than its text.
    pub(super) fn new(entries: &[Entry], start: u32, literals: &[Literal]) -> Option<Shape> {
        let mut entries = entries.to_vec();
        let mut learn = Learn { start, literals, next: 0, behind: vec![], sound: true };
        entries.iter_mut().for_each(|entry| places::entry(entry, &mut learn));
        let sound = learn.sound && learn.next == literals.len();
        let behind = learn.behind;
        let plain = matches!(entries.as_slice(), [Entry::Statement(statement)] if is_plain(statement));
        sound.then(|| Shape { entries, start, literals: literals.to_vec(), behind, plain })
    }

    /// Whether others of this shape can be rows: things without a name and prefixes, whose fields are written out.
    pub(super) fn is_plain(&self) -> bool {
        self.plain
    }

    /// The entries of another item of this shape, with its literals. Their docs are those of the first.
    pub(super) fn copy(&self, text: &str, start: u32, literals: &[Literal]) -> Vec<Entry> {
        let mut entries = self.entries.clone();
        let ends = literals.iter().zip(&self.literals);
        let shift = start.wrapping_sub(self.start);
        let mut shifts = Vec::with_capacity(literals.len() + 1);
        shifts.push(shift);
        shifts.extend(ends.map(|(own, first)| shift.wrapping_add(own.end.wrapping_sub(first.end))));
        let mut copy = Copy { text, shifts: &shifts, behind: self.behind.iter(), literals: literals.iter() };
        entries.iter_mut().for_each(|entry| places::entry(entry, &mut copy));
        entries
    }

    /// The first thing of this shape: others are like it but for their literals.
    pub fn statement(&self) -> &Statement {
        match self.entries.as_slice() {
            [Entry::Statement(statement)] => statement,
            _ => unreachable!("a row is one statement"),
        }
    }

    /// Which literal the first thing has at a place.
    pub fn literal(&self, place: Span) -> Option<usize> {
        let start = place.start.checked_sub(self.start)?;
        let here = place.source == self.statement().span.source;
        self.literals.binary_search_by_key(&start, |literal| literal.start).ok().filter(|_| here)
    }
}

impl Rows {
    pub(super) fn push(&mut self, shape: &Arc<Shape>, text: &str, start: u32, literals: &[Literal]) {
        let same = |known: &Arc<Shape>| Arc::ptr_eq(known, shape);
        let index = self.shapes.iter().position(same).unwrap_or_else(|| {
            self.shapes.push(shape.clone());
            self.shapes.len() - 1
        });
        self.rows.push(Row { shape: index as u32, start, first: self.values.len() as u32 });
        let literal = |literal: &Literal| &text[literal.start as usize..literal.end as usize];
        self.values.extend(literals.iter().map(|place| value(literal(place))));
        self.ends.extend(literals.iter().map(|literal| literal.end as u16));
    }

    /// Gives back memory that is not needed once nothing is added.
    pub(super) fn finish(mut self) -> Entry {
        self.rows.shrink_to_fit();
        self.values.shrink_to_fit();
        self.ends.shrink_to_fit();
        Entry::Rows(Arc::new(self))
    }

    /// How many things it holds.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether it holds none.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The shapes of its things.
    pub fn shapes(&self) -> &[Arc<Shape>] {
        &self.shapes
    }

    /// From the first of its things to the last.
    pub fn span(&self) -> Span {
        let place = |row| self.place(row, self.shapes[self.shape(row)].statement().span);
        place(0).to(place(self.len() - 1))
    }

    /// Which of the shapes a thing has.
    pub fn shape(&self, row: usize) -> usize {
        self.rows[row].shape as usize
    }

    /// A literal of a thing: a number, or a colour as 0xrrggbb.
    pub fn value(&self, row: usize, literal: usize) -> f64 {
        self.values[self.rows[row].first as usize + literal]
    }

    /// Where a thing has what stands at a place of the first of its shape. A place elsewhere stays as it is.
    pub fn place(&self, row: usize, place: Span) -> Span {
        let Row { shape, start, first } = self.rows[row];
        let shape = &self.shapes[shape as usize];
        if !shape.statement().span.contains(place) {
            return place;
        }
        let moved = |offset: u32| {
            let within = offset - shape.start;
            let behind = shape.literals.partition_point(|literal| literal.end <= within);
            let before = behind.checked_sub(1).map(|last| {
                (u32::from(self.ends[first as usize + last])).wrapping_sub(shape.literals[last].end)
            });
            (start + within).wrapping_add(before.unwrap_or(0))
        };
        Span { start: moved(place.start), end: moved(place.end), ..place }
    }

    /// A thing as the statement that was written, in the text it was read from.
    pub fn statement(&self, row: usize, text: &str) -> Statement {
        let Row { shape, start, first } = self.rows[row];
        let shape = &self.shapes[shape as usize];
        let place = self.place(row, shape.statement().span);
        let text = text.get(place.range()).unwrap_or("");
        let ends = &self.ends[first as usize..][..shape.literals.len()];
        let mut end = (0, 0);
        let literals: Vec<Literal> = ends
            .iter()
            .zip(&shape.literals)
            .map(|(&own, literal)| {
                let start = literal.start - end.0 + end.1;
                end = (literal.end, u32::from(own));
                Literal { start, end: end.1 }
            })
            .collect();
        match shape.copy(text, start, &literals).pop() {
            Some(Entry::Statement(statement)) => Statement { doc: None, ..*statement },
            _ => unreachable!("a row is one statement"),
        }
    }
}

/// Entries with a statement for each row.
pub(super) fn written_out(entries: Vec<Entry>, text: &str) -> Vec<Entry> {
    if !entries.iter().any(|entry| matches!(entry, Entry::Rows(_))) {
        return entries;
    }
    let mut all = vec![];
    for entry in entries {
        match entry {
            Entry::Rows(rows) => {
                let statement = |row| Entry::Statement(Box::new(rows.statement(row, text)));
                all.extend((0..rows.len()).map(statement));
            }
            entry => all.push(entry),
        }
    }
    all
}

/// The number or colour that a literal is.
fn value(literal: &str) -> f64 {
    let Some(digits) = literal.strip_prefix('#') else { return literal.parse().unwrap_or(f64::NAN) };
    let color = u32::from_str_radix(digits, 16).unwrap_or(0);
    f64::from(match digits.len() {
        3 => 0x11 * ((color & 0xf00) << 8 | (color & 0xf0) << 4 | color & 0xf),
        _ => color,
    })
}

/// Whether a statement is a thing without a name and prefixes, whose type does not depend on its literals.
fn is_plain(statement: &Statement) -> bool {
    let StatementKind::Thing { name: None, construct } = &statement.kind else { return false };
    statement.prefixes.is_empty() && is_plain_construct(construct)
}

fn is_plain_construct(Construct { body: Body { entries, .. }, .. }: &Construct) -> bool {
    entries.iter().all(|entry| matches!(entry, Entry::Field(field) if is_plain_value(&field.value)))
}

fn is_plain_value(value: &Expr) -> bool {
    match &value.kind {
        ExprKind::Number { .. }
        | ExprKind::Quantity { .. }
        | ExprKind::Bool(_)
        | ExprKind::Text(_)
        | ExprKind::Color(_)
        | ExprKind::Name(_) => true,
        ExprKind::Scaled { value, .. }
        | ExprKind::Paren(value)
        | ExprKind::Member { value, .. }
        | ExprKind::Unary { operator: UnaryOp::Negate, operand: value } => is_plain_value(value),
        ExprKind::Tuple(values) => values.iter().all(is_plain_value),
        ExprKind::Construct(construct) => is_plain_construct(construct),
        ExprKind::Invalid
        | ExprKind::List(_)
        | ExprKind::Call { .. }
        | ExprKind::Index { .. }
        | ExprKind::If { .. }
        | ExprKind::Unary { .. }
        | ExprKind::Binary { .. } => false,
    }
}

/// Notes what the places of the first item depend on.
struct Learn<'l> {
    start: u32,
    literals: &'l [Literal],
    /// The literal that comes next.
    next: usize,
    behind: Vec<(u16, u16)>,
    /// Whether the literals of the tree are those of the text.
    sound: bool,
}

impl Learn<'_> {
    fn literal(&mut self, at: Span) {
        let start = at.start.wrapping_sub(self.start);
        self.sound &= self.literals.get(self.next).is_some_and(|literal| literal.start == start);
        self.next += 1;
    }
}

impl Visit for Learn<'_> {
    fn span(&mut self, span: &mut Span) {
        let behind = |offset: u32| {
            let within = offset.wrapping_sub(self.start);
            self.literals.partition_point(|literal| literal.end <= within) as u16
        };
        self.behind.push((behind(span.start), behind(span.end)));
    }

    fn number(&mut self, _: &mut f64, at: Span) {
        self.literal(at);
    }

    fn color(&mut self, _: &mut SmolStr, at: Span) {
        self.literal(at);
    }
}

/// Gives a copy the places and literals of another item.
struct Copy<'c> {
    text: &'c str,
    /// How far a place moves that stands behind so many literals.
    shifts: &'c [u32],
    behind: std::slice::Iter<'c, (u16, u16)>,
    literals: std::slice::Iter<'c, Literal>,
}

impl Copy<'_> {
    fn literal(&mut self) -> &str {
        let literal = self.literals.next().copied().unwrap_or(Literal { start: 0, end: 0 });
        &self.text[literal.start as usize..literal.end as usize]
    }
}

impl Visit for Copy<'_> {
    fn span(&mut self, span: &mut Span) {
        let &(start, end) = self.behind.next().unwrap_or(&(0, 0));
        span.start = span.start.wrapping_add(self.shifts[start as usize]);
        span.end = span.end.wrapping_add(self.shifts[end as usize]);
    }

    fn number(&mut self, value: &mut f64, _: Span) {
        *value = self.literal().parse().unwrap_or(f64::NAN);
    }

    fn color(&mut self, digits: &mut SmolStr, _: Span) {
        *digits = SmolStr::new(&self.literal()[1..]);
    }
}
