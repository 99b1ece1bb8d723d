//! Materials: densities, furnaces, Fresnel, Snell.

use super::*;
use crate::math::{asin, cos, sin};
use crate::render::bsdf::SMOOTH_ALPHA;
use crate::render::path::LEAST_COSINE;
use adapter::Bsdf;

fn toward(angle: f64) -> DVec3 {
    v(sin(angle), 0.0, cos(angle))
}

#[track_caller]
fn check_density(bsdf: &Bsdf) {
    for angle in [0.1, 0.7, 1.3] {
        let wo = toward(angle);
        let draw = |[lobe, a, b]: [f64; 3]| {
            let sample = bsdf.sample(wo, lobe, [a, b]).filter(|sample| !sample.specular)?;
            let (pdf, f) = (bsdf.pdf(wo, sample.wi), bsdf.eval(wo, sample.wi));
            // The direction was rounded, and a narrow or grazing lobe changes much over so little.
            assert!((sample.pdf / pdf - 1.0).abs() < 5e-3, "{} {pdf}", sample.pdf);
            assert!(
                (sample.weight * pdf - f).abs().max_element() <= 5e-3 * f.max_element(),
                "{}",
                sample.weight
            );
            Some(sample.wi)
        };
        assert_density(draw, |wi| bsdf.pdf(wo, wi));
    }
}

#[test]
fn samples_follow_their_density() {
    let color = Rgb::new(0.9, 0.6, 0.2);
    let glass = |ior: f64, alpha: f64| Bsdf::glass(ior, alpha);
    check_density(&Bsdf::of(Material::Diffuse { color: color.into() }));
    for alpha in [0.2, 0.5, 1.0] {
        check_density(&Bsdf::of(Material::Metal { color: color.into(), alpha }));
        check_density(&glass(1.5, alpha));
        check_density(&glass(1.0 / 1.5, alpha));
        check_density(&Bsdf::of(Material::Plastic { color: color.into(), ior: 1.5, alpha }));
    }
    check_density(&Bsdf::of(Material::Plastic { color: color.into(), ior: 1.5, alpha: 0.0 }));
}

#[test]
fn reflection_is_the_same_both_ways() {
    let color = Rgb::new(0.9, 0.6, 0.2);
    let mut random = Random(4);
    for _ in 0..2000 {
        let (a, b) = (adapter::cosine(random.pair()), adapter::cosine(random.pair()));
        for bsdf in [
            Bsdf::of(Material::Metal { color: color.into(), alpha: 0.3 }),
            Bsdf::glass(1.5, 0.3),
            Bsdf::of(Material::Plastic { color: color.into(), ior: 1.5, alpha: 0.0 }),
            Bsdf::of(Material::Plastic { color: color.into(), ior: 1.7, alpha: 0.3 }),
        ] {
            let (f, g) = (bsdf.eval(a, b) / b.z, bsdf.eval(b, a) / a.z);
            // The half vector of two directions is known to 6e-8 over its length.
            assert!((f - g).abs().max_element() <= 1e-4 * f.max_element() + 1e-6);
        }
        // Refracted radiance over the square of the index is the same both ways.
        let eta = 1.5;
        let w = v(b.x, b.y, -b.z);
        let there = Bsdf::glass(eta, 0.3).eval(a, w).x / b.z;
        let flip = |w: DVec3| v(w.x, w.y, -w.z);
        let back = Bsdf::glass(1.0 / eta, 0.3).eval(flip(w), flip(a)).x / a.z;
        assert!((there * eta * eta - back).abs() <= 2e-4 * back + 1e-6, "{there} {back}");
    }
}

/// A floor of a material under a sky of radiance 1, seen at an angle to its normal.
fn furnace(material: Material, angle: f64) -> Scene {
    let from = 3.0 * v(sin(angle), cos(angle), 0.0);
    scene(from, DVec3::ZERO).with(floor(), material).with_sky(1.0)
}

#[test]
fn materials_that_lose_nothing_vanish_in_a_white_furnace() {
    for angle in [0.0, 0.8, 1.4] {
        assert_shows(&furnace(white(), angle), 64, 1.0, 1e-12);
        assert_shows(&furnace(Material::Mirror { color: Rgb::ONE.into() }, angle), 64, 1.0, 1e-12);
        for (alpha, slack) in [(0.0, 1e-6), (0.04, 3e-3), (0.3, 1e-3), (1.0, 1e-3)] {
            let plastic = Material::Plastic { color: Rgb::ONE.into(), ior: 1.5, alpha };
            assert_shows(&furnace(plastic, angle), 20_000, 1.0, slack);
        }
    }
    let ball = |material| {
        scene(v(0.0, 0.4, 5.0), DVec3::ZERO).with(sphere(DVec3::ZERO, 1.0), material).with_sky(1.0)
    };
    assert_shows(&ball(glass(1.5)).bounces(200), 4000, 1.0, 1e-9);
    assert_shows(&ball(glass(0.7)).bounces(200), 4000, 1.0, 1e-9);
    let mut inside = ball(white());
    inside.camera.position = v(0.0, 0.4, 0.5);
    inside.lights.clear();
    assert_shows(&inside, 64, 0.0, 0.0);
}

/// The GGX reflectance for incidence at an angle, written down again from Walter et al. 2007 and Heitz 2014 and
/// summed over a grid of facet normals; with an index of refraction, what is refracted counts too, as radiance.
fn ggx_albedo(angle: f64, alpha: f64, reflectance: impl Fn(f64) -> f64, refraction: Option<f64>) -> f64 {
    let wo = toward(angle);
    let g1 = |w: DVec3| {
        let tan = (1.0 - w.z * w.z).max(0.0).sqrt() / w.z.abs();
        2.0 / (1.0 + (1.0 + alpha * alpha * tan * tan).sqrt())
    };
    const N: usize = 1500;
    let mut sum = 0.0;
    for i in 0..N {
        // By the angle of the facet, where D is smooth in θ.
        let theta = 0.5 * PI * (i as f64 + 0.5) / N as f64;
        for j in 0..256 {
            let phi = 2.0 * PI * (f64::from(j) + 0.5) / 256.0;
            let h = v(sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta));
            let facing = wo.dot(h);
            if facing <= 0.0 {
                continue;
            }
            let tan = sin(theta) / cos(theta);
            let spread = 1.0 + tan * tan / (alpha * alpha);
            let c4 = cos(theta) * cos(theta) * cos(theta) * cos(theta);
            let d = 1.0 / (PI * alpha * alpha * c4 * spread * spread);
            let weight = d * facing / wo.z * sin(theta);
            let wi = 2.0 * facing * h - wo;
            let r = reflectance(facing);
            if wi.z > 0.0 {
                let (a, b) = (1.0 / g1(wo), 1.0 / g1(wi));
                sum += weight * r / (a + b - 1.0);
            }
            if let Some(eta) = refraction {
                let inner = (1.0 - (1.0 - facing * facing) / (eta * eta)).max(0.0).sqrt();
                let wt = (h * facing - wo) / eta - h * inner;
                if wt.z < 0.0 {
                    sum += weight * (1.0 - r) * g1(wo) * g1(wt) / (eta * eta);
                }
            }
        }
    }
    sum * 0.5 * PI / N as f64 * 2.0 * PI / 256.0
}

#[test]
fn single_scattering_loses_what_its_integral_says() {
    for alpha in [0.1, 0.4, 1.0] {
        for angle in [0.2, 1.2] {
            let metal = |f0: f64| Material::Metal { color: Rgb::splat(f0).into(), alpha };
            for f0 in [1.0, 0.5] {
                let schlick = |c: f64| f0 + (1.0 - f0) * crate::math::pow(1.0 - c, 5.0);
                let expected = ggx_albedo(angle, alpha, schlick, None);
                assert!(expected <= 1.0);
                assert_shows(&furnace(metal(f0), angle), 40_000, expected, 1e-3);
            }
            let r = |c: f64| fresnel_reflectance(c, 1.5);
            let expected = ggx_albedo(angle, alpha, r, Some(1.5));
            let frosted = Material::Dielectric { ior: 1.5, absorption: Rgb::ZERO, alpha };
            assert_shows(&furnace(frosted, angle), 40_000, expected, 1e-3);
        }
    }
    let smooth = Material::Metal { color: Rgb::splat(0.5).into(), alpha: 0.1 * f64::from(SMOOTH_ALPHA) };
    assert_shows(&furnace(smooth, 0.9), 10, 0.5 + 0.5 * crate::math::pow(1.0 - cos(0.9), 5.0), 1e-9);
}

/// Fresnel's equations by angles.
fn fresnel_reflectance(cosine: f64, eta: f64) -> f64 {
    let i = crate::math::acos(cosine);
    if sin(i) >= eta {
        return 1.0;
    }
    if i < 1e-9 {
        return ((eta - 1.0) / (eta + 1.0)) * ((eta - 1.0) / (eta + 1.0));
    }
    let t = asin(sin(i) / eta);
    let s = sin(i - t) / sin(i + t);
    let p = crate::math::tan(i - t) / crate::math::tan(i + t);
    0.5 * (s * s + p * p)
}

#[test]
fn glass_reflects_by_fresnel() {
    for ior in [1.33, 1.5, 2.4] {
        for angle in [0.0, 0.5, 1.0, 1.5] {
            let expected = fresnel_reflectance(cos(angle), ior);
            assert!((adapter::fresnel(cos(angle), ior) - expected).abs() < 1e-6);
            // Ink behind the surface lets only the reflection through.
            let ink = Material::Dielectric { ior, absorption: Rgb::INFINITY, alpha: 0.0 };
            assert_shows(&furnace(ink, angle), 20_000, expected, 1e-9);
            let clear = expected + (1.0 - expected) / (ior * ior);
            assert_shows(&furnace(glass(ior), angle), 20_000, clear, 1e-9);
        }
    }
}

#[test]
fn total_reflection_lets_nothing_out() {
    // From below the surface of water, beyond and within the critical angle of 48.6°.
    for (angle, expected) in
        [(0.9, 0.0), (0.7, 1.33 * 1.33 * (1.0 - fresnel_reflectance(cos(0.7), 1.0 / 1.33)))]
    {
        let from = -3.0 * v(sin(angle), cos(angle), 0.0);
        let water = scene(from, DVec3::ZERO)
            .with(Shape::Plane { point: DVec3::ZERO, normal: DVec3::Y }, glass(1.33))
            .with(
                Shape::Plane { point: -10.0 * DVec3::Y, normal: DVec3::Y },
                Material::Diffuse { color: Rgb::ZERO.into() },
            )
            .with_sky(1.0);
        assert_shows(&water, 20_000, expected, 1e-9);
    }
}

#[test]
fn refraction_goes_where_snell_says() {
    let angle = 0.9;
    let from = 3.0 * v(-sin(angle), cos(angle), 0.0);
    let inner = asin(sin(angle) / 1.5);
    let along = v(sin(inner), -cos(inner), 0.0);
    let across = v(cos(inner), sin(inner), 0.0);
    let shown = (1.0 - fresnel_reflectance(cos(angle), 1.5)) / 2.25;
    for (offset, expected) in [(0.0, shown), (0.95, shown), (1.05, 0.0), (-0.95, shown), (-1.05, 0.0)] {
        let lamp = sphere(10.0 * along + 1e-3 * offset * across, 1e-3);
        let scene = scene(from, DVec3::ZERO).with(floor(), glass(1.5)).with(lamp, glow(1.0));
        assert_shows(&scene, 20_000, expected, 1e-9);
    }
}

#[test]
fn grazing_directions_give_finite_light() {
    let color = Rgb::splat(0.5);
    let mut random = Random(6);
    for z in [f64::from(LEAST_COSINE), 1e-3, 1.0] {
        let wo = v((1.0 - z * z).sqrt(), 0.0, z);
        for bsdf in [
            Bsdf::of(Material::Metal { color: color.into(), alpha: f64::from(SMOOTH_ALPHA) }),
            Bsdf::of(Material::Metal { color: color.into(), alpha: 1.0 }),
            Bsdf::glass(1.5, f64::from(SMOOTH_ALPHA)),
            Bsdf::glass(0.1, 1.0),
            Bsdf::glass(1.0 + 1e-6, 0.3),
            Bsdf::of(Material::Plastic { color: color.into(), ior: 1.5, alpha: 0.0 }),
            Bsdf::of(Material::Plastic { color: color.into(), ior: 1.5, alpha: 0.3 }),
        ] {
            for _ in 0..2000 {
                let Some(sample) = bsdf.sample(wo, random.next(), random.pair()) else { continue };
                assert!(sample.weight.is_finite() && sample.pdf > 0.0, "{z}: {sample:?}");
                let f = bsdf.eval(wo, sample.wi);
                assert!(!f.is_nan() && !bsdf.pdf(wo, sample.wi).is_nan(), "{z}: {f}");
            }
        }
    }
}
