//! The Lambertian surface.

use super::Sample;
use crate::oracle::warp;
use rt_lang::color::Rgb;
use rt_lang::math::{DVec3, PI};

pub(super) fn sample(color: Rgb, u: [f64; 2]) -> Option<Sample> {
    let wi = warp::cosine(u);
    let pdf = pdf(wi);
    (pdf > 0.0).then_some(Sample { wi, weight: color, pdf, specular: false })
}

pub(super) fn eval(color: Rgb, wi: DVec3) -> Rgb {
    color * (wi.z.max(0.0) / PI)
}

pub(super) fn pdf(wi: DVec3) -> f64 {
    warp::cosine_pdf(wi.z)
}
