//! Warnings about a scene that can be drawn and is probably not the one meant: W0601 to W0609.
//!
//! Each is computed from the scene alone; the tables of origins and places only say where to point. All of them take
//! time nearly in proportion to the number of primitives: what concerns pairs asks a hierarchy of boxes for the pairs
//! whose boxes meet, and at most [`MOST_PAIRS`] of them are looked at for each warning. Beyond that, pairs go
//! unreported, and nothing else changes. A place in the source is named once for each warning, however many things a
//! loop or a part made there.
//!
//! A warning is given only where the method is sure; each function says what it may miss.

mod coincide;
mod errors;
mod faces;
mod lights;
mod media;
mod precision;
mod view;

use crate::diagnostic::{Code, Diagnostic, Use};
use crate::eval::Origins;
use crate::lower::Marks;
use crate::scene::{Camera, Material, OriginId, Primitive, Scene};
use crate::span::Span;
use std::collections::{BTreeMap, BTreeSet};

/// The most pairs that one warning looks at.
pub const MOST_PAIRS: u32 = 4_000_000;

/// The most places that one warning names.
pub const MOST_PLACES: usize = 1000;

/// Looks at a scene.
pub fn lint(scene: &Scene, origins: &Origins, marks: &Marks) -> Vec<Diagnostic> {
    let camera = &scene.camera;
    let mut lint = Lint { scene, camera, origins, marks, named: BTreeMap::new(), found: vec![] };
    view::look(&mut lint);
    lights::look(&mut lint);
    media::look(&mut lint);
    coincide::look(&mut lint);
    precision::look(&mut lint);
    lint.found
}

/// Looks through a camera, which is that of the scene or another one of the source.
pub fn look_through(scene: &Scene, camera: &Camera, origins: &Origins, marks: &Marks) -> Vec<Diagnostic> {
    let mut lint = Lint { scene, camera, origins, marks, named: BTreeMap::new(), found: vec![] };
    view::look(&mut lint);
    lint.found
}

/// What the warnings look at, and what they have found.
struct Lint<'a> {
    scene: &'a Scene,
    /// Through which it is seen.
    camera: &'a Camera,
    origins: &'a Origins,
    marks: &'a Marks,
    /// What was said, so that it is said once.
    named: BTreeMap<Code, BTreeSet<Option<Span>>>,
    found: Vec<Diagnostic>,
}

/// A place in the source, and the uses that led there, outermost first.
struct At {
    span: Span,
    uses: Vec<Span>,
}

impl Lint<'_> {
    fn report(&mut self, diagnostic: Diagnostic) {
        self.found.push(diagnostic);
    }

    /// Whether a warning may name this place: it has not yet, and has not named too many.
    fn is_new(&mut self, code: Code, origin: OriginId) -> bool {
        let place = self.at(origin).map(|at| at.span);
        let named = self.named.entry(code).or_default();
        named.len() < MOST_PLACES && named.insert(place)
    }

    /// Where something came from.
    fn at(&self, origin: OriginId) -> Option<At> {
        let mut uses = self.origins.chain(origin);
        let span = uses.pop()?;
        uses.retain(|place| !place.contains(span));
        Some(At { span, uses })
    }

    /// A warning about a thing.
    fn about(&self, code: Code, message: impl Into<String>, origin: OriginId) -> Diagnostic {
        let at = self.at(origin).unwrap_or_else(|| At { span: errors::start(), uses: vec![] });
        let mut diagnostic = Diagnostic::new(code, message, at.span);
        diagnostic.uses = at.uses.into_iter().map(Use::from).collect();
        diagnostic
    }

    /// Points at another thing: at the innermost of its places that is not the primary one.
    fn label(&self, diagnostic: Diagnostic, origin: OriginId, text: &str) -> Diagnostic {
        let primary = diagnostic.primary.span;
        let apart = |place: &Span| !place.contains(primary) && !primary.contains(*place);
        match self.origins.chain(origin).into_iter().rev().find(apart) {
            Some(span) => diagnostic.label(span, text),
            None => diagnostic,
        }
    }

    fn material(&self, primitive: &Primitive) -> &Material {
        self.scene.material(primitive)
    }

    /// Whether nothing gets through it.
    fn is_opaque(&self, primitive: &Primitive) -> bool {
        match self.material(primitive) {
            Material::Dielectric { .. } => false,
            Material::Diffuse { .. }
            | Material::Mirror { .. }
            | Material::Metal { .. }
            | Material::Plastic { .. }
            | Material::Emitter { .. } => true,
        }
    }
}
