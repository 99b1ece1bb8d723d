//! Things: made with their fields, and put into the picture or kept as a prototype.

use super::built::{Built, NONE};
use super::value::{Group, Inside, PartValue, Site};
use super::{Evaluator, Given, Made, Placed, Value, errors};
use crate::check::{Base, FieldPlace, Make, Written};
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

/// A thing that was just made, and is to be kept somewhere. Its values are the last of the innermost buffer.
pub(super) struct Fresh<'w> {
    kind: KindId,
    mask: u64,
    written: &'w Rc<Written>,
    base: Option<Rc<Made>>,
    /// Of which row, if it is made of rows.
    pub(super) row: u32,
    /// Where its values begin.
    pub(super) values: u32,
}

impl Fresh<'_> {
    /// Whether it was made where others were.
    pub(super) fn is_of(&self, site: &Site) -> bool {
        let same_base = match (&self.base, &site.base) {
            (Some(base), Some(other)) => Rc::ptr_eq(base, other),
            (None, None) => true,
            _ => false,
        };
        same_base && Rc::ptr_eq(self.written, &site.written)
    }

    /// What it has in common with others that are made there.
    pub(super) fn site(&self) -> Rc<Site> {
        let Fresh { kind, mask, .. } = *self;
        // What a prototype holds, the thing holds.
        let group = self.base.as_ref().and_then(|base| base.site.group.clone());
        Rc::new(Site { kind, mask, written: self.written.clone(), base: self.base.clone(), group })
    }
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
                Value::Made(Rc::new(self.made(kind, base, make)))
            }
        }
    }

    /// What stands before `{`.
    pub(super) fn begin(&mut self, make: &Make) -> Begun {
        match &make.base {
            Base::Kind(kind) => Begun::Made(*kind, None),
            Base::Prototype(prototype) => match self.expr(prototype) {
                Value::Made(base) => Begun::Made(base.kind(), Some(base)),
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

    /// A thing with its fields, each in its range, to be put into the innermost buffer.
    fn assemble<'w>(&mut self, kind: KindId, base: Option<Rc<Made>>, make: &'w Make) -> Fresh<'w> {
        let values = self.out().values.len() as u32;
        let mut mask = 0;
        let common = kind.get().fields.len();
        for (place, expr) in &make.fields {
            let index = match *place {
                FieldPlace::Index(index) => index,
                FieldPlace::Placed(index) => common + index,
                FieldPlace::Param(_) => continue,
            };
            mask |= 1 << index;
            let value = self.expr(expr);
            self.see(expr, &value);
            let problem = errors::out_of_range(kind, kind.field(index), &value, expr);
            self.out().values.push(value);
            if let Some(problem) = problem {
                let refused = self.report(problem);
                self.out().values.last_mut().into_iter().for_each(|last| *last = refused.clone());
            }
        }
        Fresh { kind, mask, written: &make.written, base: base.map(flat), row: self.row_index(), values }
    }

    /// A thing with its fields, by itself.
    fn made(&mut self, kind: KindId, base: Option<Rc<Made>>, make: &Make) -> Made {
        let fresh = self.assemble(kind, base, make);
        let values = self.out().values.drain(fresh.values as usize..).collect();
        Made { site: fresh.site(), row: fresh.row, values }
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
                    let fresh = self.assemble(kind, base, make);
                    let drawn = self.emit(fresh, span);
                    if !named {
                        self.incomplete |= !drawn;
                        return None;
                    }
                    drawn.then(|| (self.out().last(), None, Default::default()))
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

    /// Adds a thing to the innermost buffer. False where it is one too many.
    pub(super) fn emit(&mut self, fresh: Fresh, span: Span) -> bool {
        if !self.count_things(1, span) {
            return false;
        }
        let (outer, group) = (self.link, self.group);
        let out = self.out();
        // The text of a prototype is not where the thing was put into the picture.
        let link = out.link(span, outer);
        out.put(fresh, group, link);
        true
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
        let held = base.as_ref().and_then(|base| base.site.group.clone());
        let group = match (&base, &held) {
            (Some(base), Some(held)) => {
                link = self.out().link(base.span(), link);
                let group = self.out().groups.len() as u32;
                shift = self.append(held, outer, link, span);
                inside = held.inside.clone();
                group
            }
            _ => self.out().begin_group(outer),
        };
        (self.group, self.link) = (group, link);
        if let Some(block) = &make.block {
            self.uses.push(span.into());
            self.block(block, false);
            self.uses.pop();
            if let Some(own) = make.inside {
                inside = self.inside(own);
                shift = Default::default();
            }
        }
        let made = self.made(group::KIND, base, make);
        (self.group, self.link) = (outer, outer_link);
        self.leave();
        self.out().place_group(group, made.fields());
        Some((Rc::new(made), inside, shift))
    }

    /// Copies what a group holds into the innermost buffer, where it becomes its newest group.
    fn append(&mut self, held: &Rc<Group>, parent: u32, link: u32, span: Span) -> super::built::Shift {
        // Groups count as well: those of nothing multiply like others.
        let count = held.built.things.len() + held.built.groups.len();
        if !self.count_things(count, span) || !self.step(count as u64, span) {
            self.out().begin_group(parent);
            return super::built::Shift::default();
        }
        let level = self.buffers.len() - 1;
        self.out().append(held, parent, link, level)
    }

    /// A group that is not drawn.
    fn group_value(&mut self, make: &Make, base: Option<Rc<Made>>) -> Value {
        let held = base.as_ref().and_then(|base| base.site.group.clone());
        if make.block.is_none() && held.is_some() {
            return Value::Made(Rc::new(self.made(group::KIND, base, make)));
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
        let mut made = self.made(group::KIND, base, make);
        let built = self.end_buffer(outer);
        self.leave();
        let site = Rc::get_mut(&mut made.site).expect("what was just made is shared with nobody");
        let aims = built.values.iter().any(|value| matches!(value, Value::Thing(_)));
        site.group = Some(Rc::new(Group { built, level: self.buffers.len(), aims, inside }));
        Value::Made(Rc::new(made))
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
        self.see(expr, &value);
        let value = match errors::out_of_range(group::KIND, &PLACED[index], &value, expr) {
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
    let depth = std::iter::successors(Some(&made), |made| made.site.base.as_ref()).count();
    if depth < DEPTH {
        return made;
    }
    let mut mask = 0;
    let mut values = SmallVec::new();
    let mut spans = vec![];
    for index in 0..made.kind().field_count() {
        if let Some((value, span)) = made.fields().find(index) {
            mask |= 1 << index;
            values.push(value.clone());
            spans.push(span);
        }
    }
    let written = crate::check::Written {
        name: made.site.written.name.clone(),
        defined: made.site.written.defined.clone(),
        span: made.span(),
        fields: spans.into(),
        rows: None,
    };
    let (kind, group) = (made.kind(), made.site.group.clone());
    let site = Rc::new(Site { kind, mask, written: Rc::new(written), base: None, group });
    Rc::new(Made { site, row: 0, values })
}
