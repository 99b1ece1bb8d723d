//! How surfaces scatter light.
//!
//! Directions are unit vectors away from the surface in its local frame, whose z axis is the normal on the side
//! that `wo` (towards the camera) lies on: `wo.z` > 0 always, and `wi.z` < 0 is transmission.
//!
//! Lanes may hold different materials. Each kind that is there is computed in all lanes, and each lane takes its own.

mod dielectric;
pub mod fresnel;
mod metal;
mod microfacet;
mod plastic;
mod specular;

use super::lanes::{Float, Lanes, Mask, Word, apart};
use super::vector::V;
use super::warp;
pub use plastic::Coats;

/// Widths below this are polished: the reflection of a point is narrower than a hundredth of a degree.
pub const SMOOTH_ALPHA: f32 = 1e-4;

/// What a surface does with light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u32)]
pub enum Kind {
    /// Lambertian.
    Diffuse = 0,
    /// A perfect mirror.
    Mirror = 1,
    /// A polished conductor.
    PolishedMetal = 2,
    /// A polished boundary of a dielectric.
    PolishedDielectric = 3,
    /// A conductor.
    Metal = 4,
    /// A rough boundary of a dielectric.
    Dielectric = 5,
    /// A coat over a Lambertian base.
    Plastic = 6,
    /// Glows, and scatters nothing.
    Emitter = 7,
}

/// A material a lane, ready to be asked.
#[derive(Clone, Copy)]
pub struct Bsdfs<L: Lanes> {
    /// A [`Kind`].
    pub kind: L::U,
    /// Reflectance; of plastic that of the base.
    pub color: V<L>,
    /// GGX α.
    pub alpha: L::F,
    /// Of a dielectric the refractive index on the far side over that on the side of `wo`.
    pub eta: L::F,
    /// Of a plastic which coat.
    pub coat: L::U,
}

/// Directions that light is scattered from.
#[derive(Clone, Copy)]
pub struct Samples<L: Lanes> {
    /// Whether there is one.
    pub some: L::M,
    /// Where it comes from.
    pub wi: V<L>,
    /// The BSDF times |cos| of `wi`, divided by the density: what the throughput is multiplied with.
    pub weight: V<L>,
    /// Density in solid angle; for a specular direction the probability to have chosen it.
    pub pdf: L::F,
    /// Whether only this very direction reflects or refracts into `wo`.
    pub specular: L::M,
}

impl<L: Lanes> Samples<L> {
    #[inline(always)]
    fn pick(mask: L::M, yes: Samples<L>, no: Samples<L>) -> Samples<L> {
        Samples {
            some: (mask & yes.some) | (!mask & no.some),
            wi: V::pick(mask, yes.wi, no.wi),
            weight: V::pick(mask, yes.weight, no.weight),
            pdf: mask.pick(yes.pdf, no.pdf),
            specular: (mask & yes.specular) | (!mask & no.specular),
        }
    }
}

impl<L: Lanes> Bsdfs<L> {
    /// The lanes of a kind.
    #[inline(always)]
    pub fn are(&self, l: L, kind: Kind) -> L::M {
        self.kind.is(l.u(kind as u32))
    }

    /// Draws directions in the lanes of a mask. `lobe` chooses between lobes, `u` within one.
    #[inline(always)]
    pub fn sample(
        &self,
        l: L,
        coats: &Coats,
        wo: V<L>,
        lobe: L::F,
        u: [L::F; 2],
        active: L::M,
    ) -> Samples<L> {
        apart(
            l,
            #[inline(always)]
            || self.sample_here(l, coats, wo, lobe, u, active),
        )
    }

    #[inline(always)]
    fn sample_here(
        &self,
        l: L,
        coats: &Coats,
        wo: V<L>,
        lobe: L::F,
        u: [L::F; 2],
        active: L::M,
    ) -> Samples<L> {
        let mut samples = self.sample_diffuse(l, u);
        let Bsdfs { color, alpha, eta, .. } = *self;
        let mirror = active & (self.are(l, Kind::Mirror) | self.are(l, Kind::PolishedMetal));
        if mirror.any() {
            let metal = self.are(l, Kind::PolishedMetal);
            samples = Samples::pick(mirror, specular::sample_mirror(l, color, metal, wo), samples);
        }
        let polished = active & self.are(l, Kind::PolishedDielectric);
        if polished.any() {
            samples = Samples::pick(polished, specular::sample_dielectric(l, eta, wo, lobe), samples);
        }
        let metal = active & self.are(l, Kind::Metal);
        if metal.any() {
            samples = Samples::pick(metal, metal::sample(l, color, alpha, wo, u), samples);
        }
        let rough = active & self.are(l, Kind::Dielectric);
        if rough.any() {
            samples = Samples::pick(rough, dielectric::sample(l, eta, alpha, wo, lobe, u), samples);
        }
        let plastic = active & self.are(l, Kind::Plastic);
        if plastic.any() {
            let coat = coats.gather(l, self.coat, plastic);
            samples = Samples::pick(
                plastic,
                plastic::sample(l, color, &coat, coats, wo, lobe, u, plastic),
                samples,
            );
        }
        samples.some = samples.some & active;
        samples
    }

    /// The BSDF times |cos| of `wi`, and the density with which [`Bsdfs::sample`] draws it, both without specular
    /// directions.
    #[inline(always)]
    pub fn eval(&self, l: L, coats: &Coats, wo: V<L>, wi: V<L>, active: L::M) -> (V<L>, L::F) {
        apart(
            l,
            #[inline(always)]
            || self.eval_here(l, coats, wo, wi, active),
        )
    }

    #[inline(always)]
    fn eval_here(&self, l: L, coats: &Coats, wo: V<L>, wi: V<L>, active: L::M) -> (V<L>, L::F) {
        let zero = l.f(0.0);
        let Bsdfs { color, alpha, eta, .. } = *self;
        let diffuse = self.are(l, Kind::Diffuse);
        let mut pdf = diffuse.pick(warp::cosine_pdf(l, wi.z), zero);
        let mut value = color * pdf;
        let metal = active & self.are(l, Kind::Metal);
        if metal.any() {
            let (f, density) = metal::eval(l, color, alpha, wo, wi);
            (value, pdf) = (V::pick(metal, f, value), metal.pick(density, pdf));
        }
        let rough = active & self.are(l, Kind::Dielectric);
        if rough.any() {
            let (f, density) = dielectric::eval(l, eta, alpha, wo, wi);
            (value, pdf) = (V::pick(rough, V::all(f), value), rough.pick(density, pdf));
        }
        let plastic = active & self.are(l, Kind::Plastic);
        if plastic.any() {
            let coat = coats.gather(l, self.coat, plastic);
            let (f, density) = plastic::eval(l, color, &coat, coats, wo, wi, plastic);
            (value, pdf) = (V::pick(plastic, f, value), plastic.pick(density, pdf));
        }
        (value, pdf)
    }

    /// Whether every direction is specular, so that sampling lights is in vain.
    #[inline(always)]
    pub fn are_specular(&self, l: L) -> L::M {
        !self.kind.is(l.u(Kind::Diffuse as u32)) & self.kind.below(l.u(Kind::Metal as u32))
    }

    /// Whether light may come through from behind.
    #[inline(always)]
    pub fn transmit(&self, l: L) -> L::M {
        self.are(l, Kind::Dielectric) | self.are(l, Kind::PolishedDielectric)
    }

    /// A direction from a Lambertian surface.
    #[inline(always)]
    fn sample_diffuse(&self, l: L, u: [L::F; 2]) -> Samples<L> {
        let wi = warp::cosine(l, u);
        let pdf = warp::cosine_pdf(l, wi.z);
        Samples { some: l.f(0.0).lt(pdf), wi, weight: self.color, pdf, specular: l.mask(0) }
    }
}

/// `w` mirrored about the half vector `h`.
#[inline(always)]
fn reflect<L: Lanes>(w: V<L>, h: V<L>) -> V<L> {
    h * (w.dot(h) * 2.0) - w
}
