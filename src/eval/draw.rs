//! Things: made with their fields, and put into the picture or kept as a prototype.

use super::built::{Built, NONE, Stored};
use super::value::{Group, Inside, PartValue};
use super::{Evaluator, Given, Made, Placed, Value, errors};
use crate::check::{Base, FieldPlace, Make};
use crate::schema::{Category, KindId, PLACED, group};
use crate::span::Span;
use smallvec::SmallVec;
use std::rc::Rc;

/// What a thing begins as.
pub(super) enum Begun {
    Made(KindId, Option<Rc<Made>>),
    Part(Rc<PartValue>),
    Invalid,
}

impl<'p> Evaluator<'p> {
    /// A thing that is not drawn.
    pub(super) fn make(&mut self, make: &Make) -> Value {
        match self.begin(make) {
            Begun::Invalid => Value::Invalid,
            Begun::Part(base) => self.part_value(make, &base),
            Begun::Made(kind, base) if kind == group::KIND => self.group_value(make, base),
            Begun::Made(kind, base) => {
                if let Some(block) = &make.block {
                    self.block(block, false);
                }
                Value::Made(self.assemble(kind, base, make))
            }
        }
    }

    /// What stands before `{`.
    pub(super) fn begin(&mut self, make: &Make) -> Begun {
        match &make.base {
            Base::Kind(kind) => Begun::Made(*kind, None),
            Base::Prototype(prototype) => match self.expr(prototype) {
                Value::Made(base) => Begun::Made(base.kind, Some(base)),
                Value::Part(part) => Begun::Part(part),
                _ => Begun::Invalid,
            },
            Base::Part { part, around } => match self.around(*around) {
                Some(around) => {
                    let params = vec![None; self.program.part(*part).params.len()];
                    let placed = [const { None }; PLACED.len()];
                    let span = make.written.span;
                    Begun::Part(Rc::new(PartValue { part: *part, around, params, placed, span }))
                }
                None => Begun::Invalid,
            },
            Base::Invalid => Begun::Invalid,
        }
    }

    /// A thing with its fields, each in its range.
    fn assemble(&mut self, kind: KindId, base: Option<Rc<Made>>, make: &Make) -> Rc<Made> {
        let mut mask = 0;
        let mut values = SmallVec::with_capacity(make.fields.len());
        let common = kind.get().fields.len();
        for (place, expr) in &make.fields {
            let index = match *place {
                FieldPlace::Index(index) => index,
                FieldPlace::Placed(index) => common + index,
                FieldPlace::Param(_) => continue,
            };
            let value = self.expr(expr);
            mask |= 1 << index;
            let field = kind.field(index);
            values.push(match errors::out_of_range(kind, field, &value, expr.span) {
                Some(diagnostic) => self.report(diagnostic),
                None => value,
            });
        }
        let base = base.map(flat);
        let span = self.here(make.written.span);
        // What a prototype holds, the thing holds; a group adds its own.
        let group = base.as_ref().and_then(|base| base.group.clone());
        let (written, row) = (make.written.clone(), self.row_index());
        Rc::new(Made { kind, span, mask, values, written, row, base, group })
    }

    /// Puts a thing into the picture. Gives what its name means, where that is wanted.
    pub(super) fn draw(&mut self, make: &Make, span: Span, named: bool) -> Option<Value> {
        let first = self.out().things.len() as u32;
        let drawn = match self.begin(make) {
            Begun::Invalid => None,
            Begun::Part(part) => {
                let prototype = matches!(make.base, Base::Prototype(_));
                self.draw_part(make, &part, prototype, span, named)
            }
            Begun::Made(kind, base) => match kind.get().category {
                Category::Material => None,
                Category::Block if self.imported => return None,
                Category::Group => self.draw_group(make, base, span),
                _ => {
                    if let Some(block) = &make.block {
                        self.block(block, false);
                    }
                    let made = self.assemble(kind, base, make);
                    self.emit(made, span).map(|made| (made, None, Default::default()))
                }
            },
        };
        let Some((made, inside, shift)) = drawn else {
            self.incomplete = true;
            return named.then_some(Value::Invalid);
        };
        named.then(|| {
            let id = self.out().place(first);
            let (level, group) = (self.buffers.len() - 1, self.group);
            Value::Thing(Rc::new(Placed { id, level, stands: group, from: group, made, inside, shift }))
        })
    }

    /// Adds a thing to the innermost buffer.
    pub(super) fn emit(&mut self, made: Rc<Made>, span: Span) -> Option<Rc<Made>> {
        if !self.count_things(1, span) {
            return None;
        }
        let (outer, group, level) = (self.link, self.group, self.buffers.len() - 1);
        let aims = level > 0 && made.values.iter().any(|value| matches!(value, Value::Thing(_)));
        let out = self.out();
        // The text of a prototype is not where the thing was put into the picture.
        let link = out.link(span, outer);
        out.aims |= aims;
        out.things.push(Stored { made: made.clone(), group, link });
        Some(made)
    }

    /// A group in the picture: what its prototype holds, then its own members.
    fn draw_group(
        &mut self,
        make: &Make,
        base: Option<Rc<Made>>,
        span: Span,
    ) -> Option<(Rc<Made>, Inside, super::built::Shift)> {
        let (outer, outer_link) = (self.group, self.link);
        if !self.count_things(1, span) || !self.enter(make.written.span) {
            return None;
        }
        let mut link = self.out().link(span, outer_link);
        let mut inside: Inside = None;
        let mut shift = Default::default();
        let held = base.as_ref().and_then(|base| base.group.clone());
        let group = match (&base, &held) {
            (Some(base), Some(held)) => {
                link = self.out().link(base.span, link);
                let group = self.out().groups.len() as u32;
                shift = self.append(held, outer, link, span);
                inside = held.inside.clone();
                group
            }
            _ => self.out().begin_group(outer),
        };
        (self.group, self.link) = (group, link);
        if let Some(block) = &make.block {
            self.uses.push(span);
            self.block(block, false);
            self.uses.pop();
            if let Some(own) = make.inside {
                inside = self.inside(own);
                shift = Default::default();
            }
        }
        let made = self.assemble(group::KIND, base, make);
        (self.group, self.link) = (outer, outer_link);
        self.leave();
        self.out().place_group(group, &made);
        Some((made, inside, shift))
    }

    /// Copies what a group holds into the innermost buffer, where it becomes its newest group.
    fn append(&mut self, held: &Group, parent: u32, link: u32, span: Span) -> super::built::Shift {
        // Groups count as well: those of nothing multiply like others.
        let count = held.built.things.len() + held.built.groups.len();
        if !self.count_things(count, span) || !self.step(count as u64, span) {
            self.out().begin_group(parent);
            return super::built::Shift::default();
        }
        let levels = [held.level, self.buffers.len() - 1];
        self.out().append(&held.built, parent, link, levels)
    }

    /// A group that is not drawn.
    fn group_value(&mut self, make: &Make, base: Option<Rc<Made>>) -> Value {
        let held = base.as_ref().and_then(|base| base.group.clone());
        if make.block.is_none() && held.is_some() {
            return Value::Made(self.assemble(group::KIND, base, make));
        }
        if !self.enter(make.written.span) {
            return Value::Invalid;
        }
        let outer = self.begin_buffer();
        let mut inside: Inside = None;
        if let Some(held) = &held {
            let (level, span) = (self.buffers.len() - 1, make.written.span);
            let shift = self.append(held, 0, NONE, span);
            let names = held.inside.iter().flat_map(|names| names.iter());
            let moved = names.map(|(slot, value)| (*slot, super::query::carried(value, shift, level)));
            inside = Some(moved.collect());
        }
        if let Some(block) = &make.block {
            self.block(block, false);
            if let Some(own) = make.inside {
                inside = self.inside(own);
            }
        }
        let mut made = self.assemble(group::KIND, base, make);
        let built = self.end_buffer(outer);
        self.leave();
        Rc::make_mut(&mut made).group = Some(Rc::new(Group { built, level: self.buffers.len(), inside }));
        Value::Made(made)
    }

    /// Begins to put things aside. [`Evaluator::end_buffer`] gives them.
    pub(super) fn begin_buffer(&mut self) -> (u32, u32) {
        self.buffers.push(Built::new());
        let outer = (self.group, self.link);
        (self.group, self.link) = (0, NONE);
        outer
    }

    pub(super) fn end_buffer(&mut self, outer: (u32, u32)) -> Built {
        (self.group, self.link) = outer;
        self.buffers.pop().unwrap_or_default()
    }

    /// The values of the names that can be referred to from outside.
    pub(super) fn inside(&mut self, inside: crate::check::InsideId) -> Inside {
        let names = &self.program.insides[inside.index()].names;
        Some(names.values().map(|name| (name.slot as u32, self.frame.get(name.slot))).collect())
    }

    /// A field of [`PLACED`] by its index there.
    pub(super) fn placed_field(&mut self, index: usize, expr: &crate::check::Expr) -> Given {
        let value = self.expr(expr);
        let value = match errors::out_of_range(group::KIND, &PLACED[index], &value, expr.span) {
            Some(diagnostic) => self.report(diagnostic),
            None => value,
        };
        Given { value, span: expr.span }
    }
}

/// A prototype that others are made from, without a long chain behind it.
fn flat(made: Rc<Made>) -> Rc<Made> {
    /// Deeper chains are rare, and would make fields slow to find.
    const DEPTH: usize = 4;
    let depth = std::iter::successors(Some(&made), |made| made.base.as_ref()).count();
    if depth < DEPTH {
        return made;
    }
    let mut mask = 0;
    let mut values = SmallVec::new();
    let mut spans = vec![];
    for index in 0..made.kind.field_count() {
        if let Some((value, span)) = made.find(index) {
            mask |= 1 << index;
            values.push(value.clone());
            spans.push(span);
        }
    }
    let written = crate::check::Written {
        name: made.written.name.clone(),
        span: made.span,
        fields: spans.into(),
        rows: None,
    };
    let (kind, span, group) = (made.kind, made.span, made.group.clone());
    Rc::new(Made { kind, span, mask, values, written: Rc::new(written), row: 0, base: None, group })
}
