//! What many paths did, as diagnostics about the source.

use super::Provenance;
use crate::diagnostic::{Code, Diagnostic, Use};
use crate::render::feedback::Feedback;
use crate::render::light::Source;
use crate::render::observer::PathKind;
use crate::scene::{Material, OriginId, PrimitiveId};
use crate::span::{SourceId, Span};
use std::collections::{BTreeMap, BTreeSet};

/// The least noise of a picture, as a share of white, whose cause is worth a word: half of it nobody sees.
const LEAST_NOISE: f64 = 0.01;
/// The least share of the noise that one cause has to have.
const LEAST_SHARE: f64 = 0.3;
/// The most places that are named of each kind.
const MOST_PLACES: usize = 20;

impl Provenance<'_> {
    /// What is worth knowing of a picture that has this noise, as a share of white.
    pub fn findings(&self, feedback: &Feedback, noise: f64) -> Vec<Diagnostic> {
        let mut found: Vec<Diagnostic> = self.noisy(feedback, noise).into_iter().collect();
        found.extend(self.idle_lights(feedback).take(MOST_PLACES));
        found.extend(self.never_met(feedback).take(MOST_PLACES));
        found
    }

    /// Points at where the limit of bounces costs most.
    pub fn point_at_cut(&self, diagnostic: Diagnostic, feedback: &Feedback) -> Diagnostic {
        let mut places: BTreeMap<Vec<Span>, (f64, OriginId)> = BTreeMap::new();
        for (id, share) in &feedback.cut {
            let origin = self.scene.primitives[id.0 as usize].origin;
            places.entry(self.origins.chain(origin)).or_insert((0.0, origin)).0 += share;
        }
        let all: f64 = places.values().map(|(share, _)| share).sum();
        match places.into_iter().max_by(|(a, (x, _)), (b, (y, _))| x.total_cmp(y).then(b.cmp(a))) {
            Some((_, (share, origin))) => {
                let words = format!("{:.0}% of it would have gone on from here", 100.0 * share / all);
                self.label(diagnostic, origin, words)
            }
            None => diagnostic,
        }
    }

    /// The one cause of much of the noise.
    fn noisy(&self, feedback: &Feedback, noise: f64) -> Option<Diagnostic> {
        // By place: turns of a loop are one.
        let place = |origin: Option<OriginId>| origin.map(|origin| self.origins.chain(origin));
        let mut causes: BTreeMap<_, (f64, Source, Option<OriginId>)> = BTreeMap::new();
        for ((first, source, kind), share) in &feedback.noise {
            let seen = first.map(|id| self.scene.primitives[id.0 as usize].origin);
            let cause = (place(self.origin(*source)), Cause::from(*kind), place(seen));
            causes.entry(cause).or_insert((0.0, *source, seen)).0 += share;
        }
        let most = causes.into_iter().max_by(|(a, (x, ..)), (b, (y, ..))| x.total_cmp(y).then(b.cmp(a)));
        let ((_, cause, _), (share, source, seen)) = most?;
        let light = self.origin(source);
        if noise < LEAST_NOISE || share < LEAST_SHARE {
            return None;
        }
        let message = format!(
            "{:.0}% of the noise that is left, {:.1}% of white, is light {}",
            100.0 * share,
            100.0 * noise,
            cause.words()
        );
        let (place, other) = if light.is_some() { (light, seen) } else { (seen, None) };
        let diagnostic = self.about(Code::W0704, message, place?);
        let kind = self.thing_kind(source);
        let diagnostic = match light {
            Some(_) => diagnostic.at(format!("of this `{kind}`")),
            None => diagnostic.at(format!("of the `{kind}` that was chosen, as it is seen here")),
        };
        let diagnostic = match other {
            Some(seen) => self.label(diagnostic, seen, "as it is seen here".into()),
            None => diagnostic,
        };
        Some(match cause.help() {
            Some(help) => diagnostic.help(help),
            None => diagnostic,
        })
    }

    /// Lights of which no path brought any, each place once.
    fn idle_lights(&self, feedback: &Feedback) -> impl Iterator<Item = Diagnostic> {
        let giving = feedback.giving.iter().filter_map(|source| self.origin(*source));
        let all =
            self.all_sources().filter_map(|source| Some((self.origin(source)?, self.thing_kind(source))));
        let paths = feedback.paths;
        self.without(giving, all).into_iter().map(move |(origin, kind)| {
            let message = format!("this `{kind}` gives nothing to the picture");
            self.about(Code::W0705, message, origin)
                .at(format!("none of {paths} paths brought light of it"))
                .help("look what stands in its way, or leave it out: `@off`")
        })
    }

    /// Things that no path met, each place once. A light counts as met: of these there is more to say.
    fn never_met(&self, feedback: &Feedback) -> impl Iterator<Item = Diagnostic> {
        let origin = |id: &PrimitiveId| self.scene.primitives[id.0 as usize].origin;
        let lights = self.all_sources().filter_map(|source| self.origin(source));
        let met = feedback.met.iter().map(origin).chain(lights);
        let all = self.scene.primitives.iter().map(|primitive| (primitive.origin, primitive.shape.kind()));
        let paths = feedback.paths;
        self.without(met, all).into_iter().map(move |(origin, kind)| {
            let message = format!("no path meets this `{kind}`");
            self.about(Code::W0706, message, origin).at(format!("none of {paths} came here")).help(
                "if it is not where you want it, look at its `at` and its size; else leave it out: `@off`",
            )
        })
    }

    /// One thing for each place of some things at whose place none of the others stands: turns of a loop are one place.
    fn without(
        &self,
        others: impl Iterator<Item = OriginId>,
        all: impl Iterator<Item = (OriginId, &'static str)>,
    ) -> Vec<(OriginId, &'static str)> {
        let others: BTreeSet<OriginId> = others.collect();
        let mut places: BTreeSet<Vec<Span>> =
            others.iter().map(|origin| self.origins.chain(*origin)).collect();
        let all: BTreeMap<OriginId, &'static str> =
            all.filter(|(origin, _)| !others.contains(origin)).collect();
        all.into_iter().filter(|(origin, _)| places.insert(self.origins.chain(*origin))).collect()
    }

    /// All that may give light.
    fn all_sources(&self) -> impl Iterator<Item = Source> {
        let glowing = (0..).map(PrimitiveId).zip(self.scene.primitives.iter()).filter(|(_, primitive)| {
            matches!(self.scene.material(primitive), Material::Emitter { radiance, .. } if radiance.max_element() > 0.0)
        });
        let lights = (0..self.scene.lights.len() as u32).map(Source::Light);
        lights.chain(glowing.map(|(id, _)| Source::Primitive(id)))
    }

    fn thing_kind(&self, source: Source) -> &'static str {
        match source {
            Source::Primitive(id) => self.thing_of(id).kind,
            Source::Light(_) => self.source(source).kind,
        }
    }

    /// A warning about a thing, with the uses that led to it.
    fn about(&self, code: Code, message: impl Into<String>, origin: OriginId) -> Diagnostic {
        let mut chain = self.origins.chain(origin);
        let span = chain.pop().unwrap_or_else(start);
        let mut diagnostic = Diagnostic::new(code, message, span);
        diagnostic.uses = chain.into_iter().map(Use::from).collect();
        diagnostic
    }

    /// Points at another thing: at the innermost of its places that is not the primary one.
    fn label(&self, diagnostic: Diagnostic, origin: OriginId, text: String) -> Diagnostic {
        let primary = diagnostic.primary.span;
        let apart = |place: &Span| !place.contains(primary) && !primary.contains(*place);
        match self.origins.chain(origin).into_iter().rev().find(apart) {
            Some(span) => diagnostic.label(span, text),
            None => diagnostic,
        }
    }
}

/// Where nothing was written.
fn start() -> Span {
    Span::new(SourceId(0), 0, 0)
}

/// Kinds of paths, as far as they matter for what to do about noise.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Cause {
    Seen,
    Direct,
    Caustic,
    Mirrored,
    Refracted,
    Indirect,
}

impl From<PathKind> for Cause {
    fn from(kind: PathKind) -> Cause {
        match kind {
            PathKind::Seen => Cause::Seen,
            PathKind::Direct => Cause::Direct,
            PathKind::Caustic => Cause::Caustic,
            PathKind::Mirrored => Cause::Mirrored,
            PathKind::Refracted => Cause::Refracted,
            PathKind::Indirect(_) => Cause::Indirect,
        }
    }
}

impl Cause {
    fn words(self) -> &'static str {
        match self {
            Cause::Seen => "at the edge of what glows",
            Cause::Direct => "that comes straight from where it shines",
            Cause::Caustic => "that comes by mirrors or glass",
            Cause::Mirrored => "seen in something polished",
            Cause::Refracted => "seen through something clear",
            Cause::Indirect => "that comes by way of other surfaces",
        }
    }

    fn help(self) -> Option<&'static str> {
        match self {
            Cause::Direct => Some("a smaller light makes harder shadows and less noise"),
            Cause::Caustic => Some("a larger light is met more easily by way of mirrors and glass"),
            Cause::Indirect => Some("light the place directly, for instance by a larger light or a `sky`"),
            Cause::Seen | Cause::Mirrored | Cause::Refracted => None,
        }
    }
}
