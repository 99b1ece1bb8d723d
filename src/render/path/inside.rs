//! What paths are inside of, and the boundaries that they pass straight through.

use super::{MOST_PASSES, Paths};
use crate::render::Tracer;
use crate::render::functions::exp_negative;
use crate::render::lanes::{Float, Lanes, Mask, One, Word};
use crate::render::media::{Boundary, Inside};
use crate::render::shape::{Hits, NOWHERE, Points, Rays, slot};
use crate::render::vector::{V, single};
use crate::scene::{Material, PrimitiveId, Projection};

/// What the paths are inside of.
pub struct Media<L: Lanes> {
    pub inside: Vec<Inside>,
    /// Lanes within any solid.
    pub any: u32,
    /// What absorbs there.
    pub absorption: V<L>,
    /// What camera rays through a pinhole are inside of.
    start: Inside,
}

impl<L: Lanes> Paths<L> {
    /// Finds what fresh paths are inside of.
    #[inline(always)]
    pub fn enter_media(&mut self, l: L, tracer: &Tracer, fresh: L::M) {
        let camera = &tracer.scene.camera;
        let pinhole = camera.lens_radius == 0.0 && camera.projection == Projection::Perspective;
        let media = &mut self.media;
        if tracer.dielectrics.are_far_from_camera() || pinhole && media.start.is_empty() {
            // Only what the paths before were inside of has to be forgotten.
            for lane in (fresh & l.mask(media.any)).lanes() {
                media.inside[lane].clone_from(&media.start);
                media.moved(tracer, lane);
            }
            return;
        }
        for lane in fresh.lanes() {
            if pinhole {
                media.inside[lane].clone_from(&media.start);
            } else {
                let start = tracer.space.world(self.rays.o, lane);
                tracer.dielectrics.enter_at(tracer.surfaces.exact(), start, &mut media.inside[lane]);
            }
            media.moved(tracer, lane);
        }
    }

    /// Finds the relative index of boundaries of dielectrics, and takes the paths on that meet one that parts nothing.
    #[expect(clippy::too_many_arguments, reason = "all that is known of what was met")]
    #[inline(always)]
    pub fn meet_boundaries(
        &mut self,
        l: L,
        tracer: &Tracer,
        hits: &Hits<L>,
        points: &Points<L>,
        entering: L::M,
        boundaries: L::M,
        eta: &mut L::F,
    ) -> L::M {
        let entering = entering.bits();
        let (mut passing, mut lost) = (0, 0);
        for lane in boundaries.lanes() {
            let id = tracer.surfaces.primitive(slot(hits.place.get(lane)));
            let enters = entering >> lane & 1 == 1;
            match tracer.dielectrics.boundary(&self.media.inside[lane], id, enters) {
                Boundary::Interface(ratio) => eta.set(lane, ratio as f32),
                Boundary::Nothing => {
                    passing |= 1 << lane;
                    self.media.cross(tracer, lane, id, enters);
                    let passes = self.passes.get(lane) + 1;
                    self.passes.set(lane, passes);
                    lost |= u32::from(passes > MOST_PASSES) << lane;
                }
            }
        }
        let passing = l.mask(passing);
        self.rays.o = V::pick(passing, points.p, self.rays.o);
        self.rays.start = passing.pick_word(hits.place, self.rays.start);
        self.rays.detail = passing.pick_word(hits.detail, self.rays.detail);
        self.alive = self.alive & !l.mask(lost);
        passing
    }
}

impl<L: Lanes> Media<L> {
    /// Of paths that have not begun.
    pub fn new(l: L, tracer: &Tracer) -> Media<L> {
        let mut start = Inside::default();
        tracer.dielectrics.enter_at(tracer.surfaces.exact(), tracer.scene.camera.position, &mut start);
        Media { inside: vec![Inside::default(); L::N], any: 0, absorption: V::all(l.f(0.0)), start }
    }

    /// Takes a path through the surface of a solid.
    #[inline]
    pub fn cross(&mut self, tracer: &Tracer, lane: usize, id: PrimitiveId, entering: bool) {
        tracer.dielectrics.cross(&mut self.inside[lane], id, entering);
        self.moved(tracer, lane);
    }

    /// Notes what holds of a path that has come into another set of solids.
    #[inline]
    fn moved(&mut self, tracer: &Tracer, lane: usize) {
        let inside = &self.inside[lane];
        self.any = self.any & !(1 << lane) | u32::from(!inside.is_empty()) << lane;
        if tracer.dielectrics.any_absorbing() {
            let sigma = tracer.dielectrics.absorption(inside) * tracer.space.unit();
            self.absorption.set(lane, single(sigma));
        }
    }
}

/// The share of radiance that comes along a ray from a distance, through boundaries that part nothing.
pub fn seen_through(
    tracer: &Tracer,
    mut ray: Rays<One>,
    distance: f32,
    except: u32,
    inside: &mut Inside,
) -> [f32; 3] {
    let mut rest = distance;
    let mut visible = V::<One>::all(1.0);
    for _ in 0..MOST_PASSES {
        let hits = tracer.surfaces.closest(One, &ray, rest, One.u(except), true);
        let place = hits.place.get(0);
        let travelled = if place == NOWHERE { rest } else { hits.t };
        let sigma = tracer.dielectrics.absorption(inside) * tracer.space.unit();
        let sigma = V::splat(One, single(sigma));
        visible = visible.times(transmission(One, sigma, travelled));
        if place == NOWHERE {
            return visible.get(0);
        }
        let id = tracer.surfaces.primitive(slot(place));
        let point = tracer.surfaces.points(One, &ray, &hits, true);
        let entering = point.n.dot(ray.d) < 0.0;
        let material = tracer.scene.material(&tracer.scene.primitives[id.0 as usize]);
        let passes = matches!(material, Material::Dielectric { .. })
            && tracer.dielectrics.boundary(inside, id, entering) == Boundary::Nothing;
        if !passes {
            break;
        }
        tracer.dielectrics.cross(inside, id, entering);
        ray = Rays { o: point.p, start: hits.place, detail: hits.detail, ..ray };
        rest -= hits.t;
    }
    [0.0; 3]
}

/// The share of light that is left after a distance in a medium (Beer and Lambert).
#[inline(always)]
pub fn transmission<L: Lanes>(l: L, absorption: V<L>, distance: L::F) -> V<L> {
    V::new(left(l, absorption.x, distance), left(l, absorption.y, distance), left(l, absorption.z, distance))
}

#[inline(always)]
fn left<L: Lanes>(l: L, absorption: L::F, distance: L::F) -> L::F {
    // Neither a clear medium without end nor an opaque one without depth is 0 × ∞.
    let zero = l.f(0.0);
    let none = absorption.le(zero) | distance.le(zero);
    none.pick(l.f(1.0), exp_negative(l, none.pick(zero, -(absorption * distance))))
}
