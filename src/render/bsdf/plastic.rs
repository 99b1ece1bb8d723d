//! A clear coat over a Lambertian base, with the light that the coat reflects back down counted.
//!
//! Light enters through the coat with T(μ), is reflected by the base any number of times while the coat's
//! inside returns 1 − T̄/η² of it, and leaves with T(μ)/η². That sums to
//! a T(μo) T(μi) / (π η² (1 − a (1 − T̄/η²))), which conserves energy exactly for a = 1: T̄ is the mean of T over
//! the hemisphere, weighted by the cosine, and by reciprocity the inside's mean transmittance is T̄/η².

use super::microfacet::{distribution, masking, sample_visible, shadowing, visible_pdf};
use super::{SMOOTH_ALPHA, Samples, fresnel, reflect, specular};
use crate::render::lanes::{Float, Lanes, Mask, One, Word};
use crate::render::vector::V;
use crate::render::warp;
use std::f32::consts::{FRAC_1_PI, PI};

/// A coat: its shape, and what it lets through.
#[derive(Clone, Debug, PartialEq)]
pub struct Coat {
    ior: f32,
    alpha: f32,
    /// Mean transmittance over the hemisphere, weighted by the cosine.
    mean: f32,
    /// Transmittance at cosines (i/`STEPS`)², for a rough coat; a smooth one is computed.
    table: Vec<f32>,
}

/// The coats of a scene.
#[derive(Clone, Debug, Default)]
pub struct Coats {
    coats: Vec<Coat>,
}

/// A coat a lane.
#[derive(Clone, Copy)]
pub struct LaneCoats<L: Lanes> {
    index: L::U,
    ior: L::F,
    alpha: L::F,
    mean: L::F,
    smooth: L::M,
}

/// Intervals of the table; squares of the index put more of them at grazing angles.
const STEPS: usize = 64;
/// Strata in each direction for one entry.
const STRATA: usize = 32;

impl Coat {
    /// Tabulates a coat of this refractive index and GGX α.
    pub fn new(ior: f32, alpha: f32) -> Coat {
        let mut coat = Coat { ior, alpha, table: Vec::new(), mean: 0.0 };
        if alpha >= SMOOTH_ALPHA {
            coat.table = (0..=STEPS)
                .map(|i| {
                    let root = i as f32 / STEPS as f32;
                    1.0 - coat.reflectance((root * root).max(1e-6))
                })
                .collect();
        }
        coat.mean = coat.integrate_mean();
        coat
    }

    /// The share that goes through at a cosine, in [0, 1].
    fn transmittance(&self, cosine: f32) -> f32 {
        if self.table.is_empty() {
            return 1.0 - fresnel::dielectric(One, cosine, self.ior).reflectance;
        }
        let place = cosine.clamp(0.0, 1.0).sqrt() * STEPS as f32;
        let step = (place as usize).min(STEPS - 1);
        let within = place - step as f32;
        self.table[step] * (1.0 - within) + self.table[step + 1] * within
    }

    /// The share that a rough coat reflects, by a stratified sum over the facets seen.
    fn reflectance(&self, cosine: f32) -> f32 {
        let wo = V::<One>::new((1.0 - cosine * cosine).max(0.0).sqrt(), 0.0, cosine);
        let stratum = |i: usize| (i as f32 + 0.5) / STRATA as f32;
        let mut sum = 0.0;
        for i in 0..STRATA {
            for j in 0..STRATA {
                let h = sample_visible(One, wo, self.alpha, [stratum(i), stratum(j)]);
                let wi = reflect(wo, h);
                if wi.z > 0.0 {
                    let share = shadowing(One, wo, wi, self.alpha) / masking(One, wo, self.alpha);
                    let reflectance = fresnel::dielectric(One, wo.dot(h), self.ior).reflectance;
                    sum += f64::from(reflectance * share);
                }
            }
        }
        (sum / (STRATA * STRATA) as f64) as f32
    }

    /// 2 ∫ T(μ) μ dμ by the midpoint rule in s = √μ, in which the table is linear.
    fn integrate_mean(&self) -> f32 {
        const POINTS: usize = 64 * STEPS;
        let value = |i: usize| {
            let s = (i as f64 + 0.5) / POINTS as f64;
            4.0 * s * s * s * f64::from(self.transmittance((s * s) as f32))
        };
        ((0..POINTS).map(value).sum::<f64>() / POINTS as f64) as f32
    }
}

impl Coats {
    /// The place of a coat of this refractive index and GGX α, made if need be.
    pub fn index(&mut self, ior: f32, alpha: f32) -> u32 {
        let known = self.coats.iter().position(|coat| coat.ior == ior && coat.alpha == alpha);
        known.unwrap_or_else(|| {
            self.coats.push(Coat::new(ior, alpha));
            self.coats.len() - 1
        }) as u32
    }

    /// Those that lanes have, in the lanes of a mask.
    #[inline(always)]
    pub fn gather<L: Lanes>(&self, l: L, index: L::U, mask: L::M) -> LaneCoats<L> {
        let (mut ior, mut alpha, mut mean) = (l.f(1.0), l.f(1.0), l.f(1.0));
        let mut smooth = 0;
        for lane in mask.lanes() {
            let coat = &self.coats[index.get(lane) as usize];
            ior.set(lane, coat.ior);
            alpha.set(lane, coat.alpha);
            mean.set(lane, coat.mean);
            smooth |= u32::from(coat.table.is_empty()) << lane;
        }
        LaneCoats { index, ior, alpha, mean, smooth: l.mask(smooth) }
    }
}

impl<L: Lanes> LaneCoats<L> {
    /// The share that goes through at a cosine, in [0, 1].
    #[inline(always)]
    fn transmittance(&self, l: L, coats: &Coats, cosine: L::F, mask: L::M) -> L::F {
        let mut through = l.f(1.0) - fresnel::dielectric(l, cosine.greater(l.f(0.0)), self.ior).reflectance;
        for lane in (mask & !self.smooth).lanes() {
            through.set(lane, coats.coats[self.index.get(lane) as usize].transmittance(cosine.get(lane)));
        }
        through
    }

    /// What the base adds to the BSDF, divided by T(μi) T(μo).
    #[inline(always)]
    fn base(&self, l: L, color: V<L>) -> V<L> {
        let squared = self.ior * self.ior;
        let returned = l.f(1.0) - self.mean / squared;
        let one = V::all(l.f(1.0));
        let down = (one - color * returned) * (squared * PI);
        V::new(color.x / down.x, color.y / down.y, color.z / down.z)
    }

    /// Probability to sample the coat rather than the base: its share of what is reflected.
    #[inline(always)]
    fn choice(&self, l: L, base: V<L>, through: L::F) -> L::F {
        let base = base.luminance() * self.mean * through * PI;
        let coat = l.f(1.0) - through;
        l.f(0.0).lt(coat + base).pick(coat / (coat + base), l.f(1.0))
    }
}

#[expect(clippy::too_many_arguments, reason = "a coat a lane lies partly in the table of coats")]
#[inline(always)]
pub(super) fn sample<L: Lanes>(
    l: L,
    color: V<L>,
    coat: &LaneCoats<L>,
    coats: &Coats,
    wo: V<L>,
    lobe: L::F,
    u: [L::F; 2],
    mask: L::M,
) -> Samples<L> {
    let zero = l.f(0.0);
    let through = coat.transmittance(l, coats, wo.z, mask);
    let choice = coat.choice(l, coat.base(l, color), through);
    let from_coat = lobe.lt(choice);
    let facet = reflect(wo, sample_visible(l, wo, coat.alpha, u));
    let wi = V::pick(from_coat, facet, warp::cosine(l, u));
    let (value, pdf) = eval(l, color, coat, coats, wo, wi, mask);
    let some = zero.lt(wi.z) & zero.lt(pdf);
    let rough = Samples { some, wi, weight: value * (l.f(1.0) / pdf), pdf, specular: l.mask(0) };
    let all = l.mask(u32::MAX);
    let weight = V::all((l.f(1.0) - through) / choice);
    let mirror = Samples { some: all, wi: specular::mirrored(wo), weight, pdf: choice, specular: all };
    Samples::pick(coat.smooth & from_coat, mirror, rough)
}

/// The BSDF times the cosine, and the density.
#[inline(always)]
pub(super) fn eval<L: Lanes>(
    l: L,
    color: V<L>,
    coat: &LaneCoats<L>,
    coats: &Coats,
    wo: V<L>,
    wi: V<L>,
    mask: L::M,
) -> (V<L>, L::F) {
    let zero = l.f(0.0);
    let above = zero.lt(wi.z);
    let through = coat.transmittance(l, coats, wo.z, mask);
    let base = coat.base(l, color);
    let choice = coat.choice(l, base, through);
    let value = base * (through * coat.transmittance(l, coats, wi.z, mask) * wi.z);
    let pdf = (l.f(1.0) - choice) * (wi.z * FRAC_1_PI);
    let h = (wo + wi).normalized(l);
    let facing = wo.dot(h);
    let reflectance = fresnel::dielectric(l, facing, coat.ior).reflectance;
    let density = distribution(l, h, coat.alpha) * shadowing(l, wo, wi, coat.alpha) / (wo.z * 4.0);
    let coat_value = coat.smooth.pick(zero, reflectance * density);
    let coat_pdf = coat.smooth.pick(zero, choice * visible_pdf(l, wo, h, coat.alpha) / (facing * 4.0));
    (V::pick(above, value + V::all(coat_value), V::all(zero)), above.pick(pdf + coat_pdf, zero))
}
