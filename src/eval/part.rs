//! Parts and imported files where they are used, and calls of declared functions.

use super::built::Shift;
use super::frame::Frame;
use super::origin::Way;
use super::value::{Inside, PartValue, Site};
use super::{Evaluator, Given, Made, Value};
use crate::check::{Around, Expr, FieldPlace, FileId, FunctionId, Make, PartId, Written};
use crate::schema::{PLACED, group};
use crate::span::Span;
use smallvec::SmallVec;
use std::rc::Rc;

/// What is set aside while a part or function is evaluated.
struct Outside<'p> {
    frame: Rc<Frame>,
    part: Option<&'p crate::check::Part>,
    given: Rc<Vec<Option<Given>>>,
    imported: bool,
}

impl<'p> Evaluator<'p> {
    /// The frame around a part or function; an inner none where there is nothing around it.
    pub(super) fn around(&mut self, around: Around) -> Option<Option<Rc<Frame>>> {
        match around {
            Around::Nothing => Some(None),
            Around::Up(up) => self.frame.outer(up).cloned().map(Some),
            Around::File(file) => self.file(file).map(Some),
        }
    }

    /// What an imported file defines, with its params as they are by default.
    pub(super) fn file(&mut self, file: FileId) -> Option<Rc<Frame>> {
        if let Some(frame) = self.files.get(file.index())? {
            return Some(frame.clone());
        }
        let id = self.program.files[file.index()].part;
        let part = self.program.part(id);
        let span = Span::new(self.program.files[file.index()].source, 0, 0);
        if !self.enter(span) {
            return None;
        }
        let frame = Frame::new(part.slots, None);
        let given = Rc::new(vec![None; part.params.len()]);
        let outside = self.go_inside(frame.clone(), id, given);
        self.imported = true;
        let buffer = self.begin_buffer();
        let uses = std::mem::take(&mut self.uses);
        if self.step(part.cost, span) {
            self.block(&part.block, true);
        }
        self.uses = uses;
        self.end_buffer(buffer);
        self.come_outside(outside);
        self.leave();
        self.files[file.index()] = Some(frame.clone());
        Some(frame)
    }

    fn go_inside(&mut self, frame: Rc<Frame>, part: PartId, given: Rc<Vec<Option<Given>>>) -> Outside<'p> {
        let part = self.program.part(part);
        Outside {
            frame: std::mem::replace(&mut self.frame, frame),
            part: self.part.replace(part),
            given: std::mem::replace(&mut self.given, given),
            imported: self.imported,
        }
    }

    fn come_outside(&mut self, outside: Outside<'p>) {
        self.frame = outside.frame;
        self.part = outside.part;
        self.given = outside.given;
        self.imported = outside.imported;
    }

    /// A part with what it is given here.
    fn with_fields(&mut self, make: &Make, base: &PartValue) -> PartValue {
        if let Some(block) = &make.block {
            self.block(block, false);
        }
        let mut params = base.params.clone();
        let mut placed = base.placed.clone();
        for (place, expr) in &make.fields {
            match *place {
                FieldPlace::Param(index) => {
                    let value = self.expr(expr);
                    self.see(expr, &value);
                    if let Some(param) = params.get_mut(index) {
                        *param = Some(Given { value, span: expr.span });
                    }
                }
                FieldPlace::Placed(index) => placed[index] = Some(self.placed_field(index, expr)),
                FieldPlace::Index(_) => {}
            }
        }
        let (part, around) = (base.part, base.around.clone());
        PartValue { part, around, params, placed, span: make.written.span }
    }

    /// A part that is not drawn.
    pub(super) fn part_value(&mut self, make: &Make, base: &PartValue) -> Value {
        Value::Part(Rc::new(self.with_fields(make, base)))
    }

    /// A part in the picture.
    pub(super) fn draw_part(
        &mut self,
        make: &Make,
        base: &PartValue,
        prototype: bool,
        span: Span,
        named: bool,
    ) -> Option<(Rc<Made>, Inside, Shift)> {
        let part = self.with_fields(make, base);
        let mut chain = vec![span];
        if prototype {
            chain.push(base.span);
        }
        self.draw_part_value(&part, make.written.clone(), &chain, named)
    }

    /// The same, of a part whose fields are known. `chain` is how it came to be drawn, outermost first.
    pub(super) fn draw_part_value(
        &mut self,
        value: &PartValue,
        written: Rc<Written>,
        chain: &[Span],
        named: bool,
    ) -> Option<(Rc<Made>, Inside, Shift)> {
        let span = written.span;
        if !self.count_things(1, span) || !self.enter(span) {
            return None;
        }
        let part = self.program.part(value.part);
        let (outer, outer_link) = (self.group, self.link);
        let mut link = outer_link;
        for &place in chain {
            link = self.out().link(place, link);
        }
        let group = self.out().begin_group(outer);
        (self.group, self.link) = (group, link);
        self.uses.extend(chain.iter().copied().map(Way::from));
        let is_file = self.program.files.iter().any(|file| file.part == value.part);
        let frame = Frame::new(part.slots, value.around.clone());
        let given = Rc::new(value.params.clone());
        let outside = self.go_inside(frame.clone(), value.part, given);
        self.imported |= is_file;
        let mut placed = value.placed.clone();
        if self.step(part.cost, span) {
            self.block(&part.block, false);
            for (index, expr) in &part.fields {
                let own = self.placed_field(*index, expr);
                placed[*index].get_or_insert(own);
            }
        }
        let inside = if named { self.inside(part.inside) } else { None };
        frame.clear();
        self.come_outside(outside);
        self.uses.truncate(self.uses.len() - chain.len());
        (self.group, self.link) = (outer, outer_link);
        self.leave();
        let made = Rc::new(as_group(placed, &written));
        self.out().place_group(group, made.fields());
        Some((made, inside, Shift::default()))
    }

    /// The value of a param of a part that is not drawn.
    pub(super) fn param_of(&mut self, value: &PartValue, index: usize) -> Value {
        if let Some(given) = value.params.get(index).and_then(|given| given.as_ref()) {
            return given.value.clone();
        }
        let part = self.program.part(value.part);
        let Some(param) = part.params.get(index) else { return Value::Invalid };
        if !self.enter(value.span) {
            return Value::Invalid;
        }
        let frame = Frame::new(part.slots, value.around.clone());
        let outside = self.go_inside(frame.clone(), value.part, Rc::new(value.params.clone()));
        let buffer = self.begin_buffer();
        if self.step(part.cost, value.span) {
            self.block(&part.block, true);
        }
        let found = frame.get(param.slot);
        frame.clear();
        self.end_buffer(buffer);
        self.come_outside(outside);
        self.leave();
        found
    }

    /// Calls a declared function.
    pub(super) fn call_declared(
        &mut self,
        function: FunctionId,
        around: Around,
        arguments: &[Expr],
        span: Span,
    ) -> Value {
        let body = &self.program.functions[function.index()];
        let mut values = Vec::with_capacity(body.slots);
        for (argument, (_, declared)) in arguments.iter().zip(&body.parameters) {
            match self.expr(argument) {
                Value::Invalid => return Value::Invalid,
                value => values.push(super::statement::zero_of(declared, value)),
            }
        }
        let Some(around) = self.around(around) else { return Value::Invalid };
        if !self.enter(span) {
            return Value::Invalid;
        }
        let frame = Frame::with(values, body.slots, around);
        let outer = std::mem::replace(&mut self.frame, frame);
        self.uses.push(span.into());
        let value = if self.step(body.cost, span) { self.expr(&body.value) } else { Value::Invalid };
        self.uses.pop();
        self.frame = outer;
        self.leave();
        super::statement::zero_of(&body.result, value)
    }
}

/// A part is a group with these fields.
fn as_group(placed: [Option<Given>; PLACED.len()], written: &Written) -> Made {
    let mut mask = 0;
    let mut values = SmallVec::new();
    let mut spans = vec![];
    for (index, given) in placed.into_iter().enumerate() {
        if let Some(Given { value, span }) = given {
            mask |= 1 << index;
            values.push(value);
            spans.push(span);
        }
    }
    let (name, defined) = (written.name.clone(), written.defined.clone());
    let own = Written { name, defined, span: written.span, fields: spans.into(), rows: None };
    let written = Rc::new(own);
    let site = Rc::new(Site { kind: group::KIND, mask, written, base: None, group: None });
    Made { site, row: 0, values }
}
