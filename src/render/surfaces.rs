//! All surfaces of a scene, in the form that rays are tested against.
//!
//! Each surface has a slot. Slots are ordered by kind, so that a few surfaces are tested kind by kind, each in all
//! lanes at once: planes, giants, balls, quadrics; and one ray at a time what is left, see [`Exact`].

mod build;

use super::accel::Tree;
use super::exact::{Exact, SurfacePoint};
use super::lanes::{Float, Lanes, Mask, One, Table, Word, apart};
use super::shape::ball::Ball;
use super::shape::flat::Flat;
use super::shape::giant::Giant;
use super::shape::quadric::Quadric;
use super::shape::{Bundle, FACE_BITS, Face, Hits, NOWHERE, Points, Ratios, Rays, decode, place, slot};
use super::space::{Space, double};
use super::vector::{V, single};
use crate::math::DVec3;
use crate::scene::PrimitiveId;

/// The surfaces, kind by kind.
pub struct Surfaces {
    flats: Vec<Flat>,
    giants: Vec<Giant>,
    /// None where there is a hierarchy, which holds them.
    balls: Vec<Ball>,
    quadrics: Vec<Quadric>,
    exact: Exact,
    space: Space,
    /// The quadrics that are tested one by one, by their place among them.
    direct_quadrics: Vec<u32>,
    /// The hierarchy over the balls, the other quadrics and what is met exactly, if there are many.
    tree: Option<Tree>,
    /// First slots of the kinds after planes, and the number of slots.
    starts: [u32; 5],
    /// Each slot's primitive.
    primitives: Vec<PrimitiveId>,
    /// Each primitive's slot.
    slots: Vec<u32>,
    any_smooth: bool,
    /// Which slots bound a solid.
    closed: Vec<bool>,
    /// Each slot's height function ½κ|y|² + n·y + h about its anchor, y = p − anchor: anchor and κ, or of a ball centre
    /// and radius.
    anchors: Table,
    /// Of planes and giants n and h, and a row of zeros for balls, of which they are 0 and half the radius.
    leans: Table,
}

/// About what a surface takes in the tables.
pub(super) const BYTES_A_SURFACE: usize = size_of::<Ball>() + size_of::<[f32; 4]>() + 13;

impl Surfaces {
    /// The primitive in a slot.
    #[inline]
    pub fn primitive(&self, slot: u32) -> PrimitiveId {
        self.primitives[slot as usize]
    }

    /// The slot of a primitive.
    #[inline]
    pub fn slot(&self, primitive: PrimitiveId) -> u32 {
        self.slots[primitive.0 as usize]
    }

    /// Whether the surface in a slot bounds a solid.
    #[inline]
    pub fn is_closed(&self, slot: u32) -> bool {
        self.closed[slot as usize]
    }

    /// Whether a ray that starts on a surface that may hide itself meets it again below a distance.
    pub fn meets_itself(&self, ray: &Rays<One>, slot: u32, distance: f32) -> bool {
        self.meet_other(slot, ray).t < distance
    }

    /// What rays meet first below a distance, were it not for the surface in a slot of each lane's own. Asked for the
    /// lanes of a mask; the others may say anything.
    #[inline(always)]
    pub fn closest<L: Lanes>(
        &self,
        l: L,
        rays: &Rays<L>,
        limit: L::F,
        except: L::U,
        wanted: L::M,
    ) -> Hits<L> {
        apart(
            l,
            #[inline(always)]
            || self.closest_here(l, rays, limit, except, wanted),
        )
    }

    #[inline(always)]
    fn closest_here<L: Lanes>(
        &self,
        l: L,
        rays: &Rays<L>,
        limit: L::F,
        except: L::U,
        wanted: L::M,
    ) -> Hits<L> {
        let bundle = Bundle::new(*rays);
        let mut best = Ratios { over: limit, under: l.f(1.0) };
        let mut met = l.u(NOWHERE);
        let mut at = 0;
        for flat in &self.flats {
            let here = flat.meet(l, &bundle, place(at, Face::Side));
            (best, met) = nearer(l, (best, met), here, at, flat.glows, except);
            at += 1;
        }
        for giant in &self.giants {
            let here = giant.meet(l, &bundle, place(at, Face::Side));
            (best, met) = nearer(l, (best, met), here, at, giant.glows, except);
            at += 1;
        }
        at = self.starts[1];
        for ball in &self.balls {
            let here = ball.meet(l, &bundle, place(at, Face::Side));
            (best, met) = nearer(l, (best, met), here, at, ball.glows, except);
            at += 1;
        }
        for &index in &self.direct_quadrics {
            let at = self.starts[2] + index;
            let quadric = &self.quadrics[index as usize];
            let (t, face) = quadric.meet(l, rays, at);
            let here = Ratios { over: t, under: l.f(1.0) };
            let nearer = counts(l, here, best, at, quadric.glows, except);
            best = pick(nearer, here, best);
            met = nearer.pick_word(face, met);
        }
        let none = met.is(l.u(NOWHERE));
        let mut hits = Hits::<L> { t: none.pick(limit, best.over / best.under), place: met, detail: l.u(0) };
        if let Some(tree) = &self.tree {
            hits = tree.closest(l, self, rays, hits, except, wanted);
        } else if self.starts[3] < self.starts[4] {
            for lane in wanted.lanes() {
                let mut hit = hits.lane(lane);
                self.closest_exact(&rays.lane(lane), &mut hit, except.get(lane));
                hits.set(lane, &hit);
            }
        }
        let none = hits.place.is(l.u(NOWHERE));
        Hits { t: none.pick(l.f(f32::INFINITY), hits.t), ..hits }
    }

    /// Whether rays meet anything below a distance, but for the surface in a slot of each lane's own. Asked for the
    /// lanes of a mask; the others may say anything.
    #[inline(always)]
    pub fn occluded<L: Lanes>(&self, l: L, rays: &Rays<L>, limit: L::F, except: L::U, wanted: L::M) -> L::M {
        apart(
            l,
            #[inline(always)]
            || self.occluded_here(l, rays, limit, except, wanted),
        )
    }

    #[inline(always)]
    fn occluded_here<L: Lanes>(&self, l: L, rays: &Rays<L>, limit: L::F, except: L::U, wanted: L::M) -> L::M {
        let bundle = Bundle::new(*rays);
        let limit = Ratios { over: limit, under: l.f(1.0) };
        let mut found = l.mask(0);
        let mut at = 0;
        for flat in &self.flats {
            let here = flat.meet(l, &bundle, place(at, Face::Side));
            found = found | counts(l, here, limit, at, flat.glows, except);
            at += 1;
        }
        for giant in &self.giants {
            let here = giant.meet(l, &bundle, place(at, Face::Side));
            found = found | counts(l, here, limit, at, giant.glows, except);
            at += 1;
        }
        at = self.starts[1];
        for ball in &self.balls {
            let here = ball.meet(l, &bundle, place(at, Face::Side));
            found = found | counts(l, here, limit, at, ball.glows, except);
            at += 1;
        }
        for &index in &self.direct_quadrics {
            let at = self.starts[2] + index;
            let quadric = &self.quadrics[index as usize];
            let here = Ratios { over: quadric.meet(l, rays, at).0, under: l.f(1.0) };
            found = found | counts(l, here, limit, at, quadric.glows, except);
        }
        let wanted = wanted & !found;
        if let Some(tree) = &self.tree {
            found = found | tree.occluded(l, self, rays, limit.over, except, wanted);
        } else if self.starts[3] < self.starts[4] {
            let mut bits = 0;
            for lane in wanted.lanes() {
                let (ray, distance, except) = (rays.lane(lane), limit.over.get(lane), except.get(lane));
                let hidden = (self.starts[3]..self.starts[4])
                    .any(|slot| slot != except && self.meet_other(slot, &ray).t < distance);
                bits |= u32::from(hidden) << lane;
            }
            found = found | l.mask(bits);
        }
        found
    }

    /// Where a ray meets a quadric, or what is met exactly.
    pub fn meet_other(&self, slot: u32, ray: &Rays<One>) -> Hits<One> {
        if self.is_quadric(slot) {
            let (t, place) = self.quadrics[(slot - self.starts[2]) as usize].meet(One, ray, slot);
            let met = t > 0.0 && t < f32::INFINITY;
            return if met { Hits { t, place, detail: One.u(0) } } else { Hits::nothing(One) };
        }
        let (hit, slop) = self.exact.meet(self.primitive(slot), slot, ray);
        if hit.t > slop { hit } else { Hits::nothing(One) }
    }

    fn closest_exact(&self, ray: &Rays<One>, hit: &mut Hits<One>, except: u32) {
        for slot in self.starts[3]..self.starts[4] {
            hit.take(self.meet_other(slot, ray), except);
        }
    }

    #[inline]
    fn is_quadric(&self, slot: u32) -> bool {
        (self.starts[2]..self.starts[3]).contains(&slot)
    }

    /// What is met in double precision.
    #[inline]
    pub fn exact(&self) -> &Exact {
        &self.exact
    }

    /// Whether any surface is shaded with another normal than its own.
    #[inline]
    pub fn any_smooth(&self) -> bool {
        self.any_smooth
    }

    /// The points that rays have met, which lie on the surfaces as exactly as numbers can tell.
    #[inline(always)]
    pub fn points<L: Lanes>(&self, l: L, rays: &Rays<L>, hits: &Hits<L>, met: L::M) -> Points<L> {
        apart(
            l,
            #[inline(always)]
            || self.points_here(l, rays, hits, met),
        )
    }

    #[inline(always)]
    fn points_here<L: Lanes>(&self, l: L, rays: &Rays<L>, hits: &Hits<L>, met: L::M) -> Points<L> {
        let near = rays.o + rays.d * met.pick(hits.t, l.f(0.0));
        let slots = met.pick_word(hits.place >> FACE_BITS, l.u(0));
        let leaning = slots.below(l.u(self.starts[1]));
        let [ax, ay, az, last] = l.look_up(&self.anchors, slots);
        let [nx, ny, nz, height] = l.look_up(&self.leans, leaning.pick_word(slots, l.u(self.starts[1])));
        let (anchor, lean) = (V::new(ax, ay, az), V::new(nx, ny, nz));
        let curvature = leaning.pick(last, l.f(1.0) / last);
        let height = leaning.pick(height, last * -0.5);
        let y = near - anchor;
        let slope = lean + y * curvature;
        let above = y.squared() * (curvature * 0.5) + lean.dot(y) + height;
        let squared = slope.squared();
        let n = slope * (l.f(1.0) / squared.root());
        let mut points = Points { p: near - slope * (above / squared), n, shading: n };
        let bent = met & !slots.below(l.u(self.starts[2]));
        for lane in bent.lanes() {
            let point = self.other_point(&rays.lane(lane), &hits.lane(lane));
            points.p.set(lane, point.p.get(0));
            points.n.set(lane, point.n.get(0));
            points.shading.set(lane, point.shading.get(0));
        }
        points
    }

    /// How the unit normals of points change with small steps along their surfaces. Smooth meshes are taken for flat.
    #[inline(always)]
    pub fn bend<L: Lanes>(
        &self,
        l: L,
        hits: &Hits<L>,
        points: &Points<L>,
        steps: [V<L>; 2],
        met: L::M,
    ) -> [V<L>; 2] {
        let slots = met.pick_word(hits.place >> FACE_BITS, l.u(0));
        let [.., last] = l.look_up(&self.anchors, slots);
        let curvature = slots.below(l.u(self.starts[1])).pick(last, l.f(1.0) / last);
        let mut changes = [steps[0] * curvature, steps[1] * curvature];
        let bent = met & !slots.below(l.u(self.starts[2])) & slots.below(l.u(self.starts[3]));
        for lane in bent.lanes() {
            let quadric = &self.quadrics[(slots.get(lane) - self.starts[2]) as usize];
            let face = decode(hits.place.get(lane), hits.detail.get(lane));
            let (p, n) = (V::splat(One, points.p.get(lane)), V::splat(One, points.n.get(lane)));
            let steps = [V::splat(One, steps[0].get(lane)), V::splat(One, steps[1].get(lane))];
            let bent = quadric.bend(&Points { p, n, shading: n }, face, steps);
            changes[0].set(lane, bent[0].get(0));
            changes[1].set(lane, bent[1].get(0));
        }
        changes
    }

    /// The point of a quadric, or of what is met exactly.
    fn other_point(&self, ray: &Rays<One>, hit: &Hits<One>) -> Points<One> {
        let at = slot(hit.place.get(0));
        let face = decode(hit.place.get(0), hit.detail.get(0));
        if self.is_quadric(at) {
            let near = ray.o + ray.d * hit.t;
            return self.quadrics[(at - self.starts[2]) as usize].point(One, near, face);
        }
        let point = self.exact.point(self.primitive(at), ray, hit.t, face);
        let [n, shading] = [point.n, shaded(&point, double(ray.d, 0))].map(|n| V::splat(One, single(n)));
        Points { p: V::splat(One, single(self.space.point(point.p))), n, shading }
    }
}

/// The normal that a point is shaded with, on the side of the surface's own; turned just so far towards that one that the
/// mirror image of the ray is above the surface (Keller et al., "The Iray light transport simulation and rendering
/// system", 2017, appendix A.3).
fn shaded(point: &SurfacePoint, direction: DVec3) -> DVec3 {
    /// The least cosine of the mirror image to the surface's normal.
    const LEAST: f64 = 1e-4;
    if point.shading == point.n {
        return point.n;
    }
    let side = if point.n.dot(direction) < 0.0 { 1.0 } else { -1.0 };
    let (n, shading, wo) = (side * point.n, side * point.shading, -direction);
    let mirrored = 2.0 * wo.dot(shading) * shading - wo;
    let height = mirrored.dot(n);
    if height >= LEAST && wo.dot(shading) > 0.0 {
        return side * shading;
    }
    let lifted = (mirrored + (LEAST - height).max(0.0) * n).normalize();
    let raised = (wo + lifted).normalize_or(n);
    side * if raised.dot(n) > 0.0 { raised } else { n }
}

/// The nearer of what is met already and what is met in a slot.
#[inline(always)]
fn nearer<L: Lanes>(
    l: L,
    (best, met): (Ratios<L>, L::U),
    here: Ratios<L>,
    at: u32,
    glows: bool,
    except: L::U,
) -> (Ratios<L>, L::U) {
    let nearer = counts(l, here, best, at, glows, except);
    (pick(nearer, here, best), nearer.pick_word(l.u(place(at, Face::Side)), met))
}

/// Whether something is met nearer than a limit. Only what glows may be the surface that does not count.
#[inline(always)]
fn counts<L: Lanes>(l: L, here: Ratios<L>, limit: Ratios<L>, at: u32, glows: bool, except: L::U) -> L::M {
    let ahead = here.ahead_of(l, limit);
    if glows { ahead & !except.is(l.u(at)) } else { ahead }
}

#[inline(always)]
fn pick<L: Lanes>(mask: L::M, yes: Ratios<L>, no: Ratios<L>) -> Ratios<L> {
    Ratios { over: mask.pick(yes.over, no.over), under: mask.pick(yes.under, no.under) }
}
