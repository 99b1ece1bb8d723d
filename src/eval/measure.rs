//! `bounds(…)`: how far things reach, measured while they are being made.

use super::built::{Built, placement};
use super::{Evaluator, Placed, Thing, Things, Value, errors};
use crate::diagnostic::Diagnostic;
use crate::math::DAffine3;
use crate::scene::OriginId;
use crate::scene::shape::Bounds;
use crate::span::Span;
use std::rc::Rc;

/// Says where a thing is. Lowering knows, and is handed in by whoever puts the stages together.
pub type Measure<'m> = &'m dyn Fn(&Things, &Thing) -> Result<Reach, Box<Diagnostic>>;

/// Where a thing is.
#[derive(Clone, Copy, Debug)]
pub enum Reach {
    /// In no place: a block, a sky.
    Nowhere,
    /// It has no end.
    Endless,
    /// In a box.
    Box(Bounds),
}

/// How many steps measuring one thing counts.
const STEPS: u64 = 16;

impl Evaluator<'_> {
    /// The box around a thing, as seen from where its path begins.
    pub(super) fn bounds(&mut self, value: &Value, span: Span) -> Value {
        match value {
            Value::Thing(thing) => self.bounds_of_placed(thing, span),
            Value::Made(made) => {
                let outer = self.begin_buffer();
                match made.site.group.clone() {
                    Some(held) => {
                        let level = self.buffers.len() - 1;
                        self.out().append(&held, 0, super::built::NONE, level);
                        self.out().place_group(1, made.fields());
                    }
                    None if self.count_things(1, span) => self.out().put_again(made, 0, super::built::NONE),
                    None => {}
                }
                self.bounds_of_buffer(outer, span)
            }
            Value::Part(part) => {
                let outer = self.begin_buffer();
                let written = crate::check::Written {
                    name: None,
                    defined: None,
                    span: part.span,
                    fields: [].into(),
                    rows: None,
                };
                self.draw_part_value(part, Rc::new(written), &[span], false);
                self.bounds_of_buffer(outer, span)
            }
            _ => Value::Invalid,
        }
    }

    fn bounds_of_buffer(&mut self, outer: (u32, u32), span: Span) -> Value {
        let built = self.end_buffer(outer);
        let range = 0..built.things.len() as u32;
        self.bounds_of(&built, range, 0, span)
    }

    fn bounds_of_placed(&mut self, thing: &Placed, span: Span) -> Value {
        let Some(built) = self.buffers.get_mut(thing.level) else { return Value::Invalid };
        // Taken out while it is measured, which may report.
        let built = std::mem::take(built);
        let range = built.places[thing.id.0 as usize].clone();
        let value = self.bounds_of(&built, range, thing.from, span);
        self.buffers[thing.level] = built;
        value
    }

    fn bounds_of(&mut self, built: &Built, range: std::ops::Range<u32>, from: u32, span: Span) -> Value {
        if !self.step(STEPS * u64::from(range.end - range.start), span) {
            return Value::Invalid;
        }
        let mut all = Bounds::EMPTY;
        for stored in &built.things[range.start as usize..range.end as usize] {
            let made = built.fields(stored);
            if !made.is_sound() {
                return Value::Invalid;
            }
            let carried: DAffine3 = built.carries(stored.group, from);
            let thing = Thing {
                made,
                world_from_object: carried * placement(made),
                world_from_grain: None,
                material: None,
                origin: OriginId(0),
                hidden: false,
            };
            match (self.measure)(&self.defaults, &thing) {
                Ok(Reach::Nowhere) => {}
                Ok(Reach::Endless) => return self.report(errors::endless_bounds(span, made.span())),
                Ok(Reach::Box(bounds)) => all = all.union(bounds),
                Err(diagnostic) => return self.report(*diagnostic),
            }
        }
        if all.is_empty() {
            // What came to nothing may have stood there.
            if self.incomplete {
                return Value::Invalid;
            }
            return self.report(errors::no_bounds(span));
        }
        Value::Bounds(Rc::new(all))
    }
}
