//! Directions towards lights, each beside its density.

use super::choice::Chosen;
use super::{GlowingSurface, Kind, Lamp, LightSamples, Lights, NO_SLOT, Receivers, Source};
use crate::math::DVec3;
use crate::render::Tracer;
use crate::render::exact::SurfacePoint;
use crate::render::lanes::{Float, Lanes, Mask, One, Table, Word, apart};
use crate::render::shape::{Face, Points, Rays, encode};
use crate::render::space::double;
use crate::render::vector::{V, single, towards};
use crate::render::warp;

/// Lamps in the form that lanes look up, so that any number of balls and points are drawn together.
pub(super) struct Columns {
    /// Centre and radius: 0 of a point, −1 of what is neither.
    places: Table,
    /// Radiance, of a point its intensity; and bits of a ball's slot.
    radiances: Table,
    /// Whether there are any balls, of them any whose radiance is by place, and any points.
    balls: bool,
    patterned: bool,
    points: bool,
}

impl Columns {
    pub(super) fn new(lamps: &[Lamp]) -> Columns {
        let (mut places, mut radiances) = (Vec::new(), Vec::new());
        let (mut balls, mut patterned, mut points) = (false, false, false);
        for lamp in lamps {
            let ([x, y, z], radius, slot) = match &lamp.kind {
                Kind::Sphere { slot, center, radius } => {
                    (balls, patterned) = (true, patterned | lamp.patterned);
                    (*center, *radius, *slot)
                }
                Kind::Point { position } => {
                    points = true;
                    (*position, 0.0, NO_SLOT)
                }
                _ => ([0.0; 3], -1.0, NO_SLOT),
            };
            let [r, g, b] = lamp.radiance;
            places.push([x, y, z, radius]);
            radiances.push([r, g, b, f32::from_bits(slot)]);
        }
        let (places, radiances) = (Table::new(places), Table::new(radiances));
        Columns { places, radiances, balls, patterned, points }
    }
}

impl Lights {
    /// Draws directions towards the lights that were chosen.
    #[inline(always)]
    pub fn sample<L: Lanes>(
        &self,
        l: L,
        tracer: &Tracer,
        receivers: &Receivers<L>,
        chosen: &Chosen<L>,
        u: [L::F; 2],
        wanted: L::M,
    ) -> LightSamples<L> {
        apart(
            l,
            #[inline(always)]
            || self.sample_here(l, tracer, receivers, chosen, u, wanted),
        )
    }

    #[inline(always)]
    fn sample_here<L: Lanes>(
        &self,
        l: L,
        tracer: &Tracer,
        receivers: &Receivers<L>,
        chosen: &Chosen<L>,
        u: [L::F; 2],
        wanted: L::M,
    ) -> LightSamples<L> {
        let zero = l.f(0.0);
        let mut samples = LightSamples {
            some: l.mask(0),
            wi: V::splat(l, [0.0, 0.0, 1.0]),
            distance: l.f(f32::INFINITY),
            radiance: V::all(zero),
            pdf: l.f(1.0),
            delta: l.mask(0),
            target: l.u(NO_SLOT),
        };
        let index = wanted.pick_word(chosen.index, l.u(0));
        let [x, y, z, radius] = l.look_up(&self.columns.places, index);
        let [r, g, b, slot] = l.look_up(&self.columns.radiances, index);
        let (center, radiance, slot) = (V::<L>::new(x, y, z), V::new(r, g, b), slot.bits());
        let to = center - receivers.p;
        let balls = wanted & !slot.is(l.u(NO_SLOT));
        if self.columns.balls && balls.any() {
            samples.add_balls(l, balls, to, radius, radiance, u);
            samples.target = (balls & samples.some).pick_word(slot, samples.target);
            if self.columns.patterned {
                self.paint(l, tracer, receivers, index, balls & samples.some, &mut samples);
            }
        }
        let points = wanted & !balls & zero.le(radius);
        if self.columns.points && points.any() {
            let squared = to.squared();
            let distance = squared.root();
            let inverse = l.f(1.0) / distance;
            let some = points & zero.lt(squared);
            samples.add(some, to * inverse, distance, radiance * (inverse * inverse), l.f(1.0));
            samples.delta = samples.delta | some;
        }
        // The others one after the other.
        let mut others = wanted & radius.lt(zero);
        while others.any() {
            let at = index.get(others.bits().trailing_zeros() as usize);
            let here = others & index.is(l.u(at));
            self.lamp(at).sample(l, tracer, receivers, chosen.rest, u, here, &mut samples);
            others = others & !here;
        }
        samples
    }

    /// Multiplies the radiance of balls by what their patterns show at the points that were drawn.
    #[inline(always)]
    fn paint<L: Lanes>(
        &self,
        l: L,
        tracer: &Tracer,
        receivers: &Receivers<L>,
        index: L::U,
        balls: L::M,
        samples: &mut LightSamples<L>,
    ) {
        for lane in balls.lanes() {
            let lamp = self.lamp(index.get(lane));
            if let (true, Source::Primitive(id)) = (lamp.patterned, lamp.source) {
                let p = receivers.p + samples.wi * samples.distance;
                let share =
                    tracer.pattern(id, Face::Side, &tracer.sphere_point(id, tracer.space.world(p, lane)));
                samples.radiance.set(lane, V::splat(l, lamp.radiance).times(V::splat(l, share)).get(lane));
            }
        }
    }

    /// Density with which the direction of a ray that has met a glowing surface would have been drawn, the choice of
    /// the light included. One lane.
    pub fn pdf_of_surface(
        &self,
        slot: u32,
        face: Face,
        receivers: &Receivers<One>,
        total: f32,
        wi: V<One>,
        point: &Points<One>,
    ) -> f32 {
        let Some(index) = self.of_slot(slot) else { return 0.0 };
        let lamp = self.lamp(index);
        let density = match &lamp.kind {
            Kind::Sphere { center, radius, .. } => {
                let squared = (V::splat(One, *center) - receivers.p).squared();
                let sine_squared = radius * radius / squared;
                if sine_squared < 1.0 {
                    warp::cone_pdf(One, warp::cone_height(One, sine_squared))
                } else {
                    0.0
                }
            }
            Kind::Surface(surface) => {
                let from = self.space.world(receivers.p, 0);
                let point = SurfacePoint::new(self.space.world(point.p, 0), double(point.n, 0));
                surface.glowing.pdf(from, double(wi, 0), &point, face) as f32
            }
            Kind::Point { .. } | Kind::Spot { .. } | Kind::Sun { .. } | Kind::Sky | Kind::Panorama(_) => 0.0,
        };
        if density > 0.0 { density * self.chance(One, index, receivers, total) } else { 0.0 }
    }
}

impl Lamp {
    /// Draws directions towards it, where it can be seen from there.
    #[expect(clippy::too_many_arguments, reason = "it is told who asks, and adds to what others drew")]
    #[inline(always)]
    fn sample<L: Lanes>(
        &self,
        l: L,
        tracer: &Tracer,
        receivers: &Receivers<L>,
        part: L::F,
        u: [L::F; 2],
        here: L::M,
        samples: &mut LightSamples<L>,
    ) {
        let radiance = V::splat(l, self.radiance);
        match &self.kind {
            Kind::Sun { direction, sine_squared } => {
                let direction = V::splat(l, *direction);
                let far = l.f(f32::INFINITY);
                if *sine_squared == 0.0 {
                    samples.add(here, direction, far, radiance, l.f(1.0));
                    samples.delta = samples.delta | here;
                } else {
                    let height = warp::cone_height(l, l.f(*sine_squared));
                    let wi = towards(l, direction, warp::cone(l, u, height));
                    samples.add(here, wi, far, radiance, warp::cone_pdf(l, height));
                }
            }
            Kind::Spot { position, cone } => {
                let to = V::splat(l, *position) - receivers.p;
                let squared = to.squared();
                let distance = squared.root();
                let wi = to * (l.f(1.0) / distance);
                let share = cone.share(l, -wi);
                let some = here & l.f(0.0).lt(squared) & l.f(0.0).lt(share);
                samples.add(some, wi, distance, radiance * (share / squared), l.f(1.0));
                samples.delta = samples.delta | some;
            }
            Kind::Panorama(sky) => {
                for lane in here.lanes() {
                    let (wi, pdf) = sky.sample([f64::from(u[0].get(lane)), f64::from(u[1].get(lane))]);
                    let color = radiance.times(V::splat(l, single(sky.seen(wi))));
                    let some = if pdf > 0.0 { l.mask(1 << lane) } else { l.mask(0) };
                    samples.add(some, V::splat(l, single(wi)), l.f(f32::INFINITY), color, l.f(pdf as f32));
                }
            }
            Kind::Sky => {
                let local = warp::cosine(l, u);
                let facing = towards(l, receivers.n, local);
                let wi = V::pick(receivers.open, warp::sphere(l, u), facing);
                let pdf = receivers.open.pick(l.f(warp::SPHERE_PDF), warp::cosine_pdf(l, local.z));
                samples.add(here, wi, l.f(f32::INFINITY), radiance, pdf);
            }
            // They are drawn together.
            Kind::Point { .. } | Kind::Sphere { .. } => {}
            Kind::Surface(surface) => {
                for lane in here.lanes() {
                    let u = [f64::from(u[0].get(lane)), f64::from(u[1].get(lane))];
                    let from = tracer.space.world(receivers.p, lane);
                    let sample = surface.sample(tracer, self.patterned, from, part.get(lane), u);
                    let Some((wi, distance, pdf, share)) = sample else { continue };
                    let radiance = radiance.times(V::splat(l, share));
                    samples.add(l.mask(1 << lane), V::splat(l, wi), l.f(distance), radiance, l.f(pdf));
                    samples.target.set(lane, surface.slot);
                }
            }
        }
    }

    /// Of a sky or a sun: whether it is seen in a direction, and the density with which that would have been drawn.
    #[inline(always)]
    pub fn beyond<L: Lanes>(&self, l: L, receivers: &Receivers<L>, w: V<L>, wanted: L::M) -> (L::M, L::F) {
        match &self.kind {
            Kind::Sky => {
                let facing = warp::cosine_pdf(l, receivers.n.dot(w));
                (l.mask(u32::MAX), receivers.open.pick(l.f(warp::SPHERE_PDF), facing))
            }
            Kind::Panorama(sky) => {
                let mut pdf = l.f(0.0);
                for lane in wanted.lanes() {
                    pdf.set(lane, sky.pdf(double(w, lane)) as f32);
                }
                (l.mask(u32::MAX), pdf)
            }
            // By the sine, which is exact for a small disc.
            Kind::Sun { direction, sine_squared } => {
                let direction = V::splat(l, *direction);
                let off = direction.cross(w).squared();
                let seen = l.f(0.0).lt(direction.dot(w))
                    & off.le(l.f(*sine_squared))
                    & l.f(0.0).lt(l.f(*sine_squared));
                (seen, warp::cone_pdf(l, warp::cone_height(l, l.f(*sine_squared))))
            }
            Kind::Point { .. } | Kind::Spot { .. } | Kind::Sphere { .. } | Kind::Surface(_) => {
                (l.mask(0), l.f(0.0))
            }
        }
    }
}

impl GlowingSurface {
    /// A direction to one of its points as direction, distance, density, and what the pattern shows there.
    fn sample(
        &self,
        tracer: &Tracer,
        patterned: bool,
        from: DVec3,
        part: f32,
        u: [f64; 2],
    ) -> Option<([f32; 3], f32, f32, [f32; 3])> {
        let sample = self.glowing.sample(from, f64::from(part), u)?;
        let space = &tracer.space;
        let distance = space.length(sample.distance) as f32;
        // Whether the surface hides the point is asked from there, where its equation is exact.
        let (start, detail) = encode(self.slot, sample.face);
        let back = Rays::<One> {
            o: V::splat(One, single(space.point(sample.point.p))),
            d: V::splat(One, single(-sample.wi)),
            start: One.u(start),
            detail: One.u(detail),
        };
        if sample.hides_itself && tracer.surfaces.meets_itself(&back, self.slot, distance) {
            return None;
        }
        let share = if patterned { tracer.pattern(self.id, sample.face, &sample.point) } else { [1.0; 3] };
        Some((single(sample.wi), distance, sample.pdf as f32, share))
    }
}

impl<L: Lanes> LightSamples<L> {
    #[inline(always)]
    fn add(&mut self, some: L::M, wi: V<L>, distance: L::F, radiance: V<L>, pdf: L::F) {
        self.some = self.some | some;
        self.wi = V::pick(some, wi, self.wi);
        self.distance = some.pick(distance, self.distance);
        self.radiance = V::pick(some, radiance, self.radiance);
        self.pdf = some.pick(pdf, self.pdf);
    }

    /// Draws directions in the cones that balls fill, each seen from `to` before its centre.
    #[inline(always)]
    fn add_balls(&mut self, l: L, balls: L::M, to: V<L>, radius: L::F, radiance: V<L>, u: [L::F; 2]) {
        let squared = to.squared();
        let d = squared.root();
        let inverse = l.f(1.0) / d;
        let radius_squared = radius * radius;
        let sine_squared = radius_squared / squared;
        let height = warp::cone_height(l, sine_squared);
        let local = warp::cone(l, u, height);
        let wi = towards(l, to * inverse, local);
        let off = squared * (local.x * local.x + local.y * local.y);
        let half_chord = (radius_squared - off).greater(l.f(0.0)).root();
        let distance = (d - radius) * (d + radius) / (d * local.z + half_chord);
        let some = balls & sine_squared.lt(l.f(1.0));
        self.add(some, wi, distance, radiance, warp::cone_pdf(l, height));
    }
}
