//! Where the values of names are while a part, function or file is evaluated.

use super::value::Value;
use std::cell::RefCell;
use std::rc::Rc;

/// The values of one part, function or file that is being evaluated.
///
/// A value may hold the frame it was made in, so whoever is done with a frame clears it.
#[derive(Debug)]
pub struct Frame {
    values: RefCell<Vec<Value>>,
    around: Option<Rc<Frame>>,
}

impl Frame {
    /// A frame with so many slots, inside another.
    pub(super) fn new(slots: usize, around: Option<Rc<Frame>>) -> Rc<Frame> {
        Rc::new(Frame { values: RefCell::new(vec![Value::Invalid; slots]), around })
    }

    /// A frame that begins with these values.
    pub(super) fn with(mut values: Vec<Value>, slots: usize, around: Option<Rc<Frame>>) -> Rc<Frame> {
        values.resize(slots, Value::Invalid);
        Rc::new(Frame { values: RefCell::new(values), around })
    }

    /// The frame so many levels out.
    pub(super) fn outer(self: &Rc<Frame>, up: usize) -> Option<&Rc<Frame>> {
        (0..up).try_fold(self, |frame, _| frame.around.as_ref())
    }

    #[inline(always)]
    pub(super) fn get(&self, slot: usize) -> Value {
        match self.values.borrow().get(slot) {
            // Most are.
            Some(Value::Number(x)) => Value::Number(*x),
            Some(value) => value.clone(),
            None => Value::Invalid,
        }
    }

    /// The number in a slot.
    #[inline(always)]
    pub(super) fn number(&self, slot: usize) -> Option<f64> {
        match self.values.borrow().get(slot) {
            Some(Value::Number(x)) => Some(*x),
            _ => None,
        }
    }

    #[inline]
    pub(super) fn set(&self, slot: usize, value: Value) {
        if let Some(place) = self.values.borrow_mut().get_mut(slot) {
            *place = value;
        }
    }

    pub(super) fn clear(&self) {
        // Taken out first: what is dropped may hold this frame.
        let values = self.values.take();
        drop(values);
    }
}
