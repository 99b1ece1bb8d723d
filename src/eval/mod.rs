//! Program to things: expressions become values, prototypes and groups become the things they stand for.
//!
//! An error in a value is reported once, where it is, and the value becomes [`Value::Invalid`].

mod defaults;
mod errors;
mod expr;
mod functions;
mod origin;
mod read;
mod texture;
mod value;

pub use origin::Origins;
pub use read::{Aim, Focus, Read};
pub use texture::{MAX_TEXTURE_LEVELS, Paint, Pattern, Texture};
pub use value::{Given, Made, ThingId, Value};

use crate::check::{Base, Block, Expr, ExprKind, Make, Program};
use crate::diagnostic::Diagnostic;
use crate::math::DAffine3;
use crate::scene::OriginId;
use crate::schema::{Category, KindId, placed};
use crate::span::Span;
use defaults::Defaults;
use smol_str::SmolStr;
use std::collections::BTreeMap;
use std::ops::Range;
use std::rc::Rc;
use value::Member;

/// The most things a picture may hold.
pub const MAX_THINGS: usize = 10_000_000;

/// The most levels of groups within groups.
pub const MAX_LEVELS: usize = 64;

/// Everything that stands in the picture, groups taken apart.
#[derive(Debug)]
pub struct Things {
    /// In the order written.
    pub things: Vec<Thing>,
    /// Which of them a thing that was named, or a group, has become.
    pub places: BTreeMap<ThingId, Range<usize>>,
    /// Where each came from.
    pub origins: Origins,
    /// The values of fields that are not given.
    pub defaults: Defaults,
    /// Whether something that was written is not among them, since it has an error.
    pub incomplete: bool,
    /// How many things and groups were added so far.
    added: usize,
}

/// One thing of the picture: a shape, a light or a block.
#[derive(Clone, Debug)]
pub struct Thing {
    /// Its kind and fields.
    pub made: Rc<Made>,
    /// The name it was given.
    pub name: Option<SmolStr>,
    /// Where it stands: its own placement and that of the groups around it.
    pub world_from_object: DAffine3,
    /// Its material, or else that of the innermost group that has one.
    pub material: Option<Given>,
    /// Where it came from.
    pub origin: OriginId,
}

/// Evaluates a program.
pub fn eval(program: &Program) -> (Things, Vec<Diagnostic>) {
    let mut evaluator = Evaluator::new();
    let members = evaluator.block(&program.block);
    let Evaluator { mut diagnostics, incomplete, .. } = evaluator;
    let mut things = Things {
        things: vec![],
        places: BTreeMap::new(),
        origins: Origins::default(),
        defaults: Defaults::default(),
        incomplete,
        added: 0,
    };
    let around = Around { placement: DAffine3::IDENTITY, material: None, origin: None };
    if let Err(diagnostic) = things.add_all(&members, &around) {
        diagnostics.push(*diagnostic);
    }
    (things, diagnostics)
}

/// What is known while evaluating.
struct Evaluator {
    /// Values by slot, the innermost scope last.
    frames: Vec<Vec<Value>>,
    diagnostics: Vec<Diagnostic>,
    /// How many things were made: the next [`ThingId`].
    made: u32,
    /// How many members the groups hold, prototypes and those made from them counted alike.
    held: usize,
    /// Whether a statement came to nothing.
    incomplete: bool,
}

impl Evaluator {
    fn new() -> Evaluator {
        Evaluator { frames: vec![], diagnostics: vec![], made: 0, held: 0, incomplete: false }
    }

    fn report(&mut self, diagnostic: Diagnostic) -> Value {
        self.diagnostics.push(diagnostic);
        Value::Invalid
    }

    /// Evaluates a scope by itself, and gives its members.
    fn block(&mut self, block: &Block) -> Vec<Member> {
        let members = self.enter(block);
        self.frames.pop();
        members
    }

    /// Evaluates a scope, leaves its frame in place, and gives the members in the order written.
    fn enter(&mut self, block: &Block) -> Vec<Member> {
        self.frames.push(vec![Value::Invalid; block.bindings.len()]);
        let mut members: Vec<(usize, Member)> = vec![];
        for &slot in &block.order {
            let binding = &block.bindings[slot];
            let mut value = self.expr(&binding.value);
            if binding.drawn
                && let Value::Made(made) = value
            {
                let id = ThingId(self.made);
                self.made += 1;
                members.push((slot, Member { id, name: binding.name.clone(), made, span: binding.span }));
                value = Value::Thing(id);
            }
            self.incomplete |= value == Value::Invalid;
            if let Some(frame) = self.frames.last_mut() {
                frame[slot] = value;
            }
        }
        members.sort_by_key(|(slot, _)| *slot);
        members.into_iter().map(|(_, member)| member).collect()
    }

    fn make(&mut self, make: &Make) -> Value {
        let base = match &make.base {
            Base::Kind(kind) => Made::new(*kind, make.span),
            Base::Prototype(prototype) => match self.expr(prototype) {
                Value::Made(made) => Made { proto: Some(made.span), span: make.span, ..(*made).clone() },
                _ => return Value::Invalid,
            },
            Base::Invalid => return Value::Invalid,
        };
        let mut made = base;
        let own = make.block.as_ref().map(|block| self.enter(block));
        for (index, value) in &make.fields {
            let value_found = self.expr(value);
            let field = made.kind.field(*index);
            let checked = match errors::out_of_range(made.kind, field, &value_found, value.span) {
                Some(diagnostic) => self.report(diagnostic),
                None => value_found,
            };
            made.fields[*index] = Some(Given { value: checked, span: value.span });
        }
        if let Some(own) = own {
            self.frames.pop();
            made.levels = own.iter().map(|member| member.made.levels + 1).fold(made.levels, usize::max);
            if made.levels > MAX_LEVELS {
                // Levels further out are too many as well, and nothing new.
                if made.levels == MAX_LEVELS + 1 {
                    self.report(errors::too_many_levels(make.span));
                }
                made.members = [].into();
                return Value::Made(Rc::new(made));
            }
            let before = self.held;
            self.held += made.members.len() + own.len();
            if self.held > MAX_THINGS {
                if before <= MAX_THINGS {
                    self.report(errors::too_many_things(make.span));
                }
                return Value::Invalid;
            }
            let inside = own.iter().map(|member| member.made.inside.saturating_add(1));
            made.inside = inside.fold(made.inside, usize::saturating_add);
            let mut members = made.members.to_vec();
            members.extend(own);
            made.members = members.into();
        }
        Value::Made(Rc::new(made))
    }

    fn expr(&mut self, expr: &Expr) -> Value {
        match &expr.kind {
            ExprKind::Make(make) => self.make(make),
            kind => self.value(kind, expr.span),
        }
    }
}

/// What surrounds a thing: the groups it stands in.
struct Around {
    placement: DAffine3,
    material: Option<Given>,
    origin: Option<OriginId>,
}

impl Things {
    fn add_all(&mut self, members: &[Member], around: &Around) -> Result<(), Box<Diagnostic>> {
        members.iter().try_for_each(|member| self.add(member, around))
    }

    fn add(&mut self, member: &Member, around: &Around) -> Result<(), Box<Diagnostic>> {
        let made = &member.made;
        let first = self.things.len();
        // Before anything is taken apart: groups within groups multiply.
        if self.added.saturating_add(made.inside) >= MAX_THINGS {
            return Err(Box::new(errors::too_many_things(member.span)));
        }
        self.added += 1;
        let mut origin = self.origins.add(member.span, around.origin);
        if let Some(proto) = made.proto {
            origin = self.origins.add(proto, Some(origin));
        }
        let category = made.kind.get().category;
        let placed = matches!(category, Category::Shape | Category::Group);
        let placement = if placed { around.placement * self.placement(made) } else { around.placement };
        let own = placed.then(|| made.fields[placed::MATERIAL.index(made.kind)].clone()).flatten();
        let material = own.or_else(|| around.material.clone());
        if category == Category::Group {
            let inside = Around { placement, material, origin: Some(origin) };
            self.add_all(&made.members, &inside)?;
        } else {
            self.things.push(Thing {
                made: made.clone(),
                name: member.name.clone(),
                world_from_object: placement,
                material,
                origin,
            });
        }
        // A prototype's members are added once for each use; their names mean the first.
        self.places.entry(member.id).or_insert(first..self.things.len());
        Ok(())
    }

    /// The placement that a thing's own fields give: `place`, then `at`.
    fn placement(&mut self, made: &Made) -> DAffine3 {
        let place = made.given(placed::PLACE).map_or(DAffine3::IDENTITY, |(place, _)| place);
        let at = made.given(placed::AT).map_or(crate::math::DVec3::ZERO, |(at, _)| at);
        DAffine3::from_translation(at) * place
    }

    /// A field of a thing: as given, or else its default.
    pub fn read<T: Read>(&self, made: &Made, key: crate::schema::Key<T>) -> T::Out {
        match made.given(key) {
            Some((value, _)) => value,
            None => self.defaults.read(made.kind, key),
        }
    }
}

impl Made {
    /// A thing of a kind with nothing given.
    pub fn new(kind: KindId, span: Span) -> Made {
        Made {
            kind,
            fields: vec![None; kind.field_count()].into(),
            members: [].into(),
            proto: None,
            span,
            levels: 0,
            inside: 0,
        }
    }
}
