//! A clear coat over a Lambertian base, with the light that the coat reflects back down counted.
//!
//! Light enters through the coat with T(μ), is reflected by the base any number of times while the coat's
//! inside returns 1 − T̄/η² of it, and leaves with T(μ)/η². That sums to
//! a T(μo) T(μi) / (π η² (1 − a (1 − T̄/η²))), which conserves energy exactly for a = 1: T̄ is the mean of T over
//! the hemisphere, weighted by the cosine, and by reciprocity the inside's mean transmittance is T̄/η².

use super::microfacet::{distribution, masking, sample_visible, shadowing, visible_pdf};
use super::{SMOOTH_ALPHA, Sample, fresnel, reflect, specular};
use crate::oracle::warp;
use rt_lang::color::{Rgb, luminance};
use rt_lang::math::{DVec3, PI};

/// A coat: its shape, and what it lets through.
#[derive(Clone, Debug, PartialEq)]
pub struct Coat {
    ior: f64,
    alpha: f64,
    /// Transmittance at cosines (i/`STEPS`)², for a rough coat; a smooth one is computed.
    table: Vec<f64>,
    /// Mean transmittance over the hemisphere, weighted by the cosine.
    mean: f64,
}

/// Intervals of the table; squares of the index put more of them at grazing angles.
const STEPS: usize = 64;
/// Strata in each direction for one entry.
const STRATA: usize = 32;

impl Coat {
    /// Tabulates a coat of this refractive index and GGX α.
    pub fn new(ior: f64, alpha: f64) -> Coat {
        let mut coat = Coat { ior, alpha, table: Vec::new(), mean: 0.0 };
        if alpha >= SMOOTH_ALPHA {
            coat.table = (0..=STEPS)
                .map(|i| {
                    let root = i as f64 / STEPS as f64;
                    1.0 - coat.reflectance((root * root).max(1e-6))
                })
                .collect();
        }
        coat.mean = coat.integrate_mean();
        coat
    }

    /// Whether this is the coat of that refractive index and GGX α.
    pub fn is(&self, ior: f64, alpha: f64) -> bool {
        self.ior == ior && self.alpha == alpha
    }

    /// The share that goes through at a cosine, in [0, 1].
    fn transmittance(&self, cosine: f64) -> f64 {
        if self.table.is_empty() {
            return 1.0 - fresnel::dielectric(cosine, self.ior).reflectance;
        }
        let place = cosine.max(0.0).sqrt() * STEPS as f64;
        let step = (place as usize).min(STEPS - 1);
        let within = place - step as f64;
        self.table[step] * (1.0 - within) + self.table[step + 1] * within
    }

    /// The share that a rough coat reflects, by a stratified sum over the facets seen.
    fn reflectance(&self, cosine: f64) -> f64 {
        let wo = DVec3::new((1.0 - cosine * cosine).max(0.0).sqrt(), 0.0, cosine);
        let stratum = |i: usize| (i as f64 + 0.5) / STRATA as f64;
        let mut sum = 0.0;
        for i in 0..STRATA {
            for j in 0..STRATA {
                let h = sample_visible(wo, self.alpha, [stratum(i), stratum(j)]);
                let wi = reflect(wo, h);
                if wi.z > 0.0 {
                    let share = shadowing(wo, wi, self.alpha) / masking(wo, self.alpha);
                    sum += fresnel::dielectric(wo.dot(h), self.ior).reflectance * share;
                }
            }
        }
        sum / (STRATA * STRATA) as f64
    }

    /// 2 ∫ T(μ) μ dμ by the midpoint rule in s = √μ, in which the table is linear.
    fn integrate_mean(&self) -> f64 {
        const POINTS: usize = 64 * STEPS;
        let value = |i: usize| {
            let s = (i as f64 + 0.5) / POINTS as f64;
            4.0 * s * s * s * self.transmittance(s * s)
        };
        (0..POINTS).map(value).sum::<f64>() / POINTS as f64
    }

    /// What the base adds to the BSDF, divided by T(μi) T(μo).
    fn base(&self, color: Rgb) -> Rgb {
        let squared = self.ior * self.ior;
        color / (PI * squared * (Rgb::ONE - color * (1.0 - self.mean / squared)))
    }

    /// Probability to sample the coat rather than the base: its share of what is reflected.
    fn choice(&self, color: Rgb, wo: DVec3) -> f64 {
        let through = self.transmittance(wo.z);
        let base = luminance(self.base(color)) * PI * self.mean * through;
        let coat = 1.0 - through;
        if coat + base > 0.0 { coat / (coat + base) } else { 1.0 }
    }

    fn is_smooth(&self) -> bool {
        self.table.is_empty()
    }
}

pub(super) fn sample(color: Rgb, coat: &Coat, wo: DVec3, lobe: f64, u: [f64; 2]) -> Option<Sample> {
    let choice = coat.choice(color, wo);
    let wi = if lobe >= choice {
        warp::cosine(u)
    } else if coat.is_smooth() {
        let weight = Rgb::splat((1.0 - coat.transmittance(wo.z)) / choice);
        return Some(Sample { wi: specular::mirrored(wo), weight, pdf: choice, specular: true });
    } else {
        reflect(wo, sample_visible(wo, coat.alpha, u))
    };
    let pdf = pdf(color, coat, wo, wi);
    let weight = eval(color, coat, wo, wi) / pdf;
    (wi.z > 0.0 && pdf > 0.0).then_some(Sample { wi, weight, pdf, specular: false })
}

pub(super) fn eval(color: Rgb, coat: &Coat, wo: DVec3, wi: DVec3) -> Rgb {
    if wi.z <= 0.0 {
        return Rgb::ZERO;
    }
    let base = coat.base(color) * (coat.transmittance(wo.z) * coat.transmittance(wi.z) * wi.z);
    if coat.is_smooth() {
        return base;
    }
    let h = (wo + wi).normalize();
    let reflectance = fresnel::dielectric(wo.dot(h), coat.ior).reflectance;
    base + reflectance * distribution(h, coat.alpha) * shadowing(wo, wi, coat.alpha) / (4.0 * wo.z)
}

pub(super) fn pdf(color: Rgb, coat: &Coat, wo: DVec3, wi: DVec3) -> f64 {
    if wi.z <= 0.0 {
        return 0.0;
    }
    let choice = coat.choice(color, wo);
    let base = (1.0 - choice) * warp::cosine_pdf(wi.z);
    if coat.is_smooth() {
        return base;
    }
    let h = (wo + wi).normalize();
    base + choice * visible_pdf(wo, h, coat.alpha) / (4.0 * wo.dot(h))
}
