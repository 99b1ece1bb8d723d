//! Program to things: expressions become values, prototypes, parts and groups become the things they stand for.
//!
//! An error in a value is reported once, where it is, and the value becomes [`Value::Invalid`]. Every file ends, and
//! what it takes is bounded by [`Limits`].

mod built;
mod defaults;
mod draw;
mod errors;
mod expr;
mod frame;
mod functions;
mod limits;
mod list;
mod measure;
mod origin;
mod part;
mod query;
mod read;
mod statement;
mod texture;
mod things;
mod value;
mod watch;

pub use limits::Limits;
pub use list::List;
pub use measure::{Measure, Reach};
pub use origin::Origins;
pub use read::{Aim, Focus, Read};
pub use texture::{MAX_TEXTURE_LEVELS, Paint, Pattern, Texture};
pub use things::{Thing, Things};
pub use value::{Fields, Given, Made, PartValue, Placed, ThingId, Value};
pub use watch::{Seen, Values};

use crate::check::{Expr, ExprKind, Part, Program};
use crate::diagnostic::{Code, Diagnostic};
use crate::span::Span;
use crate::syntax::Rows;
use built::{Built, NONE};
use frame::Frame;
use origin::Way;
use std::cell::Cell;
use std::collections::BTreeSet;
use std::rc::Rc;
use std::sync::Arc;
use watch::Watch;

/// Evaluates a program. `measure` says where a thing is, for `bounds(…)`.
pub fn eval(program: &Program, limits: Limits, measure: Measure) -> (Things, Vec<Diagnostic>) {
    let (things, diagnostics, _) = run(Evaluator::new(program, limits, measure));
    (things, diagnostics)
}

/// The same, with what expressions come to. It is cut short where `stop` says so.
pub fn watch(
    program: &Program,
    limits: Limits,
    measure: Measure,
    stop: &dyn Fn() -> bool,
) -> (Things, Vec<Diagnostic>, Values) {
    let watch = Some(Watch::new(stop));
    run(Evaluator { watch, ..Evaluator::new(program, limits, measure) })
}

fn run(mut evaluator: Evaluator) -> (Things, Vec<Diagnostic>, Values) {
    evaluator.main();
    let Evaluator { diagnostics, incomplete, mut buffers, watch, .. } = evaluator;
    let built = buffers.pop().unwrap_or_default();
    (Things::new(built, incomplete), diagnostics, watch.map(|watch| watch.values).unwrap_or_default())
}

/// What is known while evaluating.
struct Evaluator<'p> {
    program: &'p Program,
    limits: Limits,
    measure: Measure<'p>,
    /// Where defaults are read.
    defaults: Things,
    /// The values of names: of the innermost part, function or file.
    frame: Rc<Frame>,
    /// The part or file that is being evaluated.
    part: Option<&'p Part>,
    /// What it was given, by param.
    given: Rc<Vec<Option<Given>>>,
    /// Imported files with their params as they are by default, once they were asked for.
    files: Vec<Option<Rc<Frame>>>,
    /// Where things are put: the scene, and in it the groups that are not drawn.
    buffers: Vec<Built>,
    /// The group of the innermost buffer in which things are put now.
    group: u32,
    /// How it came to be drawn: a link of the innermost buffer.
    link: u32,
    /// The uses that led here, outermost first.
    uses: Vec<Way>,
    /// How many parts, groups and calls are around.
    levels: usize,
    /// How many expressions are around.
    depth: usize,
    /// The rows that are being evaluated, and which of them is.
    row: Option<(Arc<Rows>, u32)>,
    /// Whether this is an imported file, whose camera and render blocks are ignored.
    imported: bool,
    diagnostics: Vec<Diagnostic>,
    /// What was reported already: a slip in a part or loop is one.
    reported: BTreeSet<(Code, Span)>,
    /// How many things were made.
    things: usize,
    /// How many list items there are.
    live: Rc<Cell<usize>>,
    /// How much was done.
    steps: u64,
    /// Whether a limit was passed: nothing more is done.
    halted: bool,
    /// Whether a statement came to nothing.
    incomplete: bool,
    /// Who looks on.
    watch: Option<Watch<'p>>,
}

impl<'p> Evaluator<'p> {
    fn new(program: &'p Program, limits: Limits, measure: Measure<'p>) -> Evaluator<'p> {
        Evaluator {
            program,
            limits,
            measure,
            defaults: Things::new(Built::new(), false),
            frame: Frame::new(0, None),
            part: None,
            given: Rc::new(vec![]),
            files: vec![None; program.files.len()],
            buffers: vec![Built::new()],
            group: 0,
            link: NONE,
            uses: vec![],
            levels: 0,
            depth: 0,
            row: None,
            imported: false,
            diagnostics: vec![],
            reported: BTreeSet::new(),
            things: 0,
            live: Rc::new(Cell::new(0)),
            steps: 0,
            halted: false,
            incomplete: false,
            watch: None,
        }
    }

    /// Evaluates the file that is drawn.
    fn main(&mut self) {
        let Some(part) = self.program.main() else { return };
        self.frame = Frame::new(part.slots, None);
        self.part = Some(part);
        self.given = Rc::new(vec![None; part.params.len()]);
        if self.step(part.cost, Span::new(self.program.files[0].source, 0, 0)) {
            self.block(&part.block, false);
        }
        self.frame.clear();
        for file in std::mem::take(&mut self.files).into_iter().flatten() {
            file.clear();
        }
    }

    /// Reports what is wrong, once for each place, with the uses that led there.
    fn report(&mut self, mut diagnostic: Diagnostic) -> Value {
        diagnostic.move_places(|place| self.here(place));
        if self.reported.insert((diagnostic.code, diagnostic.primary.span)) {
            let place = diagnostic.primary.span;
            let apart = |way: &&Way| way.turn.is_some() || !way.span.contains(place);
            diagnostic.uses = self.uses.iter().filter(apart).map(Way::shown).collect();
            self.diagnostics.push(diagnostic);
        }
        Value::Invalid
    }

    /// The innermost buffer.
    fn out(&mut self) -> &mut Built {
        self.buffers.last_mut().expect("the scene is a buffer that stays")
    }

    /// An expression by itself, as the value of a default.
    fn alone(expr: &Expr) -> Value {
        let program = Program::default();
        let measure: Measure = &|_, _| Ok(Reach::Nowhere);
        Evaluator::new(&program, Limits::default(), measure).expr(expr)
    }

    /// The value of an expression. Half of all are numbers and names, which are found without a call.
    #[inline(always)]
    fn expr(&mut self, expr: &Expr) -> Value {
        match &expr.kind {
            ExprKind::Number(value) if value.is_finite() => Value::Number(*value),
            ExprKind::Name { up: 0, slot } => self.frame.get(*slot),
            _ => {
                self.deeper(expr.span, |inside| inside.value(&expr.kind, expr.span)).unwrap_or(Value::Invalid)
            }
        }
    }

    /// Finds the value of an expression that may hold others; none where these go too deep.
    #[inline(always)]
    fn deeper<T>(&mut self, span: Span, find: impl FnOnce(&mut Self) -> T) -> Option<T> {
        if self.depth >= limits::MAX_DEPTH {
            self.halt(errors::too_deep(span));
            return None;
        }
        self.depth += 1;
        let value = find(self);
        self.depth -= 1;
        Some(value)
    }
}
