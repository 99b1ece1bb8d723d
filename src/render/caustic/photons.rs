//! Photons: where chains from the lamps of a scene end, so that paths know where to look for light.
//!
//! They only guide: no light is taken from them.

use super::chain::{Beams, Ways, meet};
use super::goal::{Goal, Target};
use crate::render::bsdf::{Kind, SMOOTH_ALPHA};
use crate::render::lanes::{Float, Lanes, MOST, Mask, One};
use crate::render::light::Source;
use crate::render::media::Inside;
use crate::render::sampler::{Pair, Sampler, seed_key};
use crate::render::shape::{NOWHERE, Rays};
use crate::render::vector::{V, basis, single, towards};
use crate::render::{Cancelled, Control, Tracer, level, warp};
use crate::scene::{Material, Primitive, Shape};
use rayon::prelude::*;
use std::ops::Range;

/// A chain that ends at a surface that scatters.
#[derive(Clone, Copy, Debug)]
pub struct Photon {
    /// Where.
    pub p: [f32; 3],
    /// The last surface of the chain: where a path from the receiver starts to look.
    pub toward: [f32; 3],
    /// The way back to the lamp.
    pub ways: Ways,
    /// The lamp.
    pub goal: u32,
    /// Which of the lamp's it is.
    pub number: u32,
    /// Its power.
    pub power: f32,
}

/// Photons that are sent out, over all lamps together: so many for each pixel, within limits.
const SENT_BY_PIXEL: f64 = 0.25;
const SENT: std::ops::RangeInclusive<f64> = 1024.0..=32768.0;
/// Photons that are traced together.
const BATCH: u32 = 1024;
/// How often a photon is reflected by glass at least. Rare ways are told of more often than they are gone.
const TOLD: f32 = 0.3;
const SEED: u64 = 0x7068_6f74_6f6e_7321;
/// Polished surfaces beyond which they are not told apart by their place, when there are many lamps too.
const MOST_PAIRS: usize = 1 << 22;

/// A ball that polished surfaces lie in; none for one without end.
type Caster = Option<([f32; 3], f32)>;

/// The polished surfaces of a scene.
pub fn casters(tracer: &Tracer) -> Vec<Caster> {
    let scene = tracer.scene;
    let space = &tracer.space;
    let smooth = |alpha: f64| (alpha as f32) < SMOOTH_ALPHA;
    let polished = |primitive: &&Primitive| match *scene.material(primitive) {
        Material::Mirror { .. } => true,
        Material::Dielectric { alpha, .. } | Material::Metal { alpha, .. } => smooth(alpha),
        _ => false,
    };
    let ball = |primitive: &Primitive| {
        let (center, radius) = match primitive.shape {
            Shape::Sphere { center, radius } => (center, radius),
            _ => {
                let bounds = primitive.shape.bounds()?;
                (bounds.center(), 0.5 * bounds.size().length())
            }
        };
        Some((single(space.point(center)), space.length(radius) as f32))
    };
    scene.primitives.iter().filter(polished).map(ball).collect()
}

/// Photons of one lamp that are traced together.
struct Batch {
    goal: u32,
    numbers: Range<u32>,
    /// The power of each.
    power: f32,
}

/// Sends photons from all lamps. The same each time.
///
/// # Errors
///
/// If the control cancels.
pub fn photons(
    tracer: &Tracer,
    goals: &[Goal],
    casters: &[Caster],
    control: &Control,
) -> Result<Vec<Photon>, Cancelled> {
    // What reaches the polished surfaces from each lamp says how many of the photons it gets.
    let many = goals.len().saturating_mul(casters.len()) > MOST_PAIRS;
    let some = if many { &[None][..] } else { casters };
    let reached: Vec<f64> =
        goals.iter().map(|goal| shares(tracer, goal, some).last().map_or(0.0, |&sum| sum)).collect();
    let total: f64 = reached.iter().sum();
    if !(total > 0.0 && total < f64::INFINITY) {
        return Ok(Vec::new());
    }
    let [width, height] = tracer.scene.trace.size;
    let wanted = (SENT_BY_PIXEL * f64::from(width) * f64::from(height)).clamp(*SENT.start(), *SENT.end());
    let mut batches = Vec::new();
    let (mut sum, mut sent) = (0.0, 0);
    for (goal, reached) in (0..).zip(&reached) {
        sum += reached;
        let until = (sum / total * wanted).round() as u32;
        let power = (reached / f64::from(until - sent)) as f32;
        for start in (0..until - sent).step_by(BATCH as usize) {
            let numbers = start..(start + BATCH).min(until - sent);
            batches.push(Batch { goal, numbers, power });
        }
        sent = until;
    }
    let traced: Vec<Vec<Photon>> = batches
        .par_iter()
        .map(|batch| {
            control.rest();
            if control.is_cancelled() {
                return Vec::new();
            }
            let goal = &goals[batch.goal as usize];
            let shares = shares(tracer, goal, some);
            tracer.level.run(Emission { tracer, goal, casters: some, shares: &shares, batch })
        })
        .collect();
    if control.is_cancelled() {
        return Err(Cancelled);
    }
    Ok(thinned(traced.into_iter().flatten().collect()))
}

/// Leaves out some photons far from the camera, where less of the picture depends on them, and gives their power to
/// those that are left.
fn thinned(mut photons: Vec<Photon>) -> Vec<Photon> {
    let squared = |p: [f32; 3]| V::splat(One, p).squared();
    let mut distances: Vec<f32> = photons.iter().map(|photon| squared(photon.p)).collect();
    distances.sort_unstable_by(f32::total_cmp);
    let Some(&near) = distances.get(distances.len() / 4) else { return photons };
    let mut sum = 0.0;
    photons.retain_mut(|photon| {
        let kept = (near / squared(photon.p)).min(1.0);
        let before: f32 = sum;
        sum = (sum + kept) % 1024.0;
        photon.power /= kept;
        sum.floor() != before.floor()
    });
    photons
}

/// Running sums of what each polished surface receives from a lamp, were nothing in between.
fn shares(tracer: &Tracer, goal: &Goal, casters: &[Caster]) -> Vec<f64> {
    let strength = f64::from(goal.strength);
    let mut sum = 0.0;
    let received = |caster: &Caster| match (goal.target, caster) {
        (Target::Near { center, .. }, Some((middle, radius))) => {
            let squared = (V::splat(One, center) - V::splat(One, *middle)).squared();
            let cosine = (1.0 - f64::from(radius * radius / squared)).max(0.0).sqrt();
            0.5 * strength * (1.0 - cosine)
        }
        (Target::Near { .. }, None) => strength,
        (Target::Far { .. }, caster) => {
            let (_, radius) = caster.unwrap_or(seen(tracer));
            strength * crate::math::PI * f64::from(radius) * f64::from(radius)
        }
    };
    casters
        .iter()
        .map(|caster| {
            sum += received(caster);
            sum
        })
        .collect()
}

/// A ball that holds much of what the camera sees, to stand for a surface without end.
fn seen(tracer: &Tracer) -> ([f32; 3], f32) {
    let size = tracer.space.length(tracer.size) as f32;
    ((V::splat(One, single(tracer.scene.camera.forward)) * size).get(0), 2.0 * size)
}

/// Photons to send.
struct Emission<'a, 's> {
    tracer: &'a Tracer<'s>,
    goal: &'a Goal,
    casters: &'a [Caster],
    shares: &'a [f64],
    batch: &'a Batch,
}

impl level::Task for Emission<'_, '_> {
    type Output = Vec<Photon>;
    fn run<L: Lanes>(self, l: L) -> Vec<Photon> {
        l.run(
            #[inline(always)]
            || self.send(l),
        )
    }
}

impl Emission<'_, '_> {
    #[inline(always)]
    fn send<L: Lanes>(&self, l: L) -> Vec<Photon> {
        let mut photons = Vec::new();
        let start = self.around();
        let mut insides = vec![Inside::default(); L::N];
        for first in self.batch.numbers.clone().step_by(L::N) {
            let count = (L::N as u32).min(self.batch.numbers.end - first);
            let mut columns = [[0.0; MOST]; 6];
            for lane in 0..count {
                let (o, d) = self.emitted(first + lane);
                for (column, v) in columns.iter_mut().zip(o.into_iter().chain(d)) {
                    column[lane as usize] = v;
                }
                insides[lane as usize].clone_from(&start);
            }
            let [ox, oy, oz, dx, dy, dz] = &columns;
            let o = V::new(l.load(ox), l.load(oy), l.load(oz));
            let d = V::new(l.load(dx), l.load(dy), l.load(dz));
            let rays = Rays { o, d, start: l.u(NOWHERE), detail: l.u(0) };
            let mut numbers = [0; MOST];
            for (lane, number) in numbers.iter_mut().enumerate() {
                *number = first + lane as u32;
            }
            let sampler =
                Sampler::new(l, seed_key(SEED), l.u(self.batch.goal), l.u(0), l.load_words(&numbers));
            let alive = l.mask(u32::MAX >> (32 - count));
            self.trace(l, rays, (&sampler, first), &mut insides, alive, &mut photons);
        }
        // They came in the order in which lanes ended.
        photons.sort_unstable_by_key(|photon| photon.number);
        photons
    }

    /// What the lamp is inside of.
    fn around(&self) -> Inside {
        let mut inside = Inside::default();
        if let Target::Near { center, .. } = self.goal.target {
            let p = self.tracer.space.world(V::splat(One, center), 0);
            self.tracer.dielectrics.enter_anywhere(self.tracer.surfaces.exact(), p, &mut inside);
        }
        inside
    }

    /// A ray from the lamp towards a polished surface, as origin and direction.
    fn emitted(&self, number: u32) -> ([f32; 3], [f32; 3]) {
        let sampler = Sampler::new(One, seed_key(SEED), One.u(self.batch.goal), One.u(0), One.u(number));
        let pair = |pair: Pair| sampler.pair(One, pair, One.u(0));
        let (u, v, [choice, _]) = (pair(Pair::Film), pair(Pair::Lens), pair(Pair::Choice));
        let total = self.shares.last().map_or(0.0, |&sum| sum);
        let index = self.shares.partition_point(|&sum| sum <= f64::from(choice) * total);
        let caster = self.casters[index.min(self.casters.len() - 1)];
        let (o, d) = match self.goal.target {
            Target::Near { center, radius } => {
                let o = V::splat(One, center) + warp::sphere(One, v) * radius;
                let d = match caster {
                    Some((middle, size)) => {
                        let to = V::splat(One, middle) - o;
                        let sine_squared = size * size / to.squared();
                        if sine_squared < 1.0 {
                            let height = warp::cone_height(One, sine_squared);
                            towards(One, to.normalized(One), warp::cone(One, u, height))
                        } else {
                            warp::sphere(One, u)
                        }
                    }
                    None => warp::sphere(One, u),
                };
                (o, d)
            }
            Target::Far { direction, sine } => {
                let height = warp::cone_height(One, sine * sine);
                let from = towards(One, V::splat(One, direction), warp::cone(One, v, height));
                let (middle, size) = caster.unwrap_or(seen(self.tracer));
                let [a, b] = warp::disc(One, u);
                let (x, y) = basis(One, from);
                let o = V::splat(One, middle) + (x * a + y * b + from * DISTANT) * size;
                (o, -from)
            }
        };
        (o.get(0), d.normalized(One).get(0))
    }

    /// Follows photons, numbered from the first, through polished surfaces, each way as often as light goes it.
    #[inline(always)]
    fn trace<L: Lanes>(
        &self,
        l: L,
        rays: Rays<L>,
        (sampler, first): (&Sampler<L>, u32),
        insides: &mut [Inside],
        mut alive: L::M,
        photons: &mut Vec<Photon>,
    ) {
        let one = l.f(1.0);
        let except = match self.goal.source {
            Source::Primitive(id) => self.tracer.surfaces.slot(id),
            Source::Light(_) => u32::MAX,
        };
        let mut beams = Beams::new(l, rays);
        let mut ways = [Ways::NONE; MOST];
        let mut power = l.f(self.batch.power);
        for index in 0..=super::chain::MOST_EVENTS {
            beams.weight = V::all(one);
            let far = l.f(f32::INFINITY);
            let met = meet(l, self.tracer, &mut beams, insides, far, l.u(except), alive);
            power = power * beams.weight.luminance();
            let glass = met.bsdfs.are(l, Kind::PolishedDielectric);
            let metal = met.bsdfs.are(l, Kind::PolishedMetal) | met.bsdfs.are(l, Kind::Mirror);
            let dull = met.bsdfs.are(l, Kind::Emitter) | met.bsdfs.are(l, Kind::Dielectric);
            let landed = met.some & !(glass | metal | dull);
            for lane in landed.lanes() {
                let power = power.get(lane);
                if index > 0 && power > 0.0 && power < f32::INFINITY {
                    let (p, toward) = (met.points.p.get(lane), beams.rays.o.get(lane));
                    let ways = ways[lane].reversed();
                    let (goal, number) = (self.batch.goal, first + lane as u32);
                    photons.push(Photon { p, toward, ways, goal, number, power });
                }
            }
            alive = met.some & (glass | metal);
            if !alive.any() {
                break;
            }
            let [choice, _] = sampler.pair(l, Pair::Lobe, l.u(index));
            let reflectance = met.fresnel(l, beams.rays.d).reflectance;
            let told = reflectance.lt(one).pick(reflectance.greater(l.f(TOLD)), one);
            let through = glass & told.le(choice);
            let share = through.pick((one - reflectance) / (one - told), reflectance / told);
            power = glass.pick(power * share, power * met.bsdfs.color.luminance());
            let mut lost = 0;
            for lane in alive.lanes() {
                match ways[lane].then(through.bits() >> lane & 1 == 1) {
                    Some(longer) => ways[lane] = longer,
                    None => lost |= 1 << lane,
                }
            }
            let gone = beams.scatter(l, self.tracer, &met, through, insides);
            alive = alive & gone & !l.mask(lost);
        }
    }
}

/// How far before a polished surface photons of a distant lamp start, in its radii.
const DISTANT: f32 = 1e3;
