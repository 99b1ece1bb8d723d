//! What is different between a scene and the one before it: what has to be traced again, and what a person calls it.

mod names;

use crate::color::Rgb;
use crate::scene::{Light, Material, Scene};
pub use names::names;

/// What has to be done again.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// Of the paths.
    pub paths: Paths,
    /// Whether the picture is developed in another way.
    pub developed: bool,
    /// Whether it has enough samples at another time.
    pub target: bool,
}

/// What has to be done of the paths again.
#[derive(Clone, Debug, PartialEq)]
pub enum Paths {
    /// Nothing: all samples stay good.
    Kept,
    /// All, and until then every light counts by a factor: those of [`Scene::lights`], then those of the materials, of which
    /// the ones that do not glow have 1. Surfaces are where they were.
    Lamps(Vec<Rgb>),
    /// All.
    New,
}

/// Compares two scenes.
pub fn between(before: &Scene, after: &Scene) -> Change {
    let paths = match before.hash() == after.hash() {
        true => Paths::Kept,
        false => factors(before, after).map_or(Paths::New, Paths::Lamps),
    };
    Change {
        paths,
        developed: before.develop != after.develop,
        target: before.trace.target != after.trace.target,
    }
}

/// By what each light has become brighter, where nothing else is new.
fn factors(before: &Scene, after: &Scene) -> Option<Vec<Rgb>> {
    if (before.lights.len(), before.materials.len()) != (after.lights.len(), after.materials.len()) {
        return None;
    }
    let lights = before.lights.iter().zip(&after.lights).map(|(before, after)| light_factor(before, after));
    let materials =
        before.materials.iter().zip(&after.materials).map(|(before, after)| glow_factor(before, after));
    let factors: Vec<Rgb> = lights.chain(materials).collect::<Option<_>>()?;
    // With lamps as they were, what is left must be the same.
    let lights = before.lights.clone();
    let relit = Scene { lights, materials: before.materials.clone(), ..after.clone() };
    (relit.hash() == before.hash()).then_some(factors)
}

fn light_factor(before: &Light, after: &Light) -> Option<Rgb> {
    let mut relit = *after;
    let factor = match (before, &mut relit) {
        (Light::Point { intensity: old, .. }, Light::Point { intensity: new, .. })
        | (Light::Spot { intensity: old, .. }, Light::Spot { intensity: new, .. })
        | (Light::Sun { irradiance: old, .. }, Light::Sun { irradiance: new, .. })
        | (Light::Sky { radiance: old, .. }, Light::Sky { radiance: new, .. }) => {
            let factor = ratio(*old, *new);
            *new = *old;
            factor
        }
        _ => None,
    };
    factor.filter(|_| relit == *before)
}

fn glow_factor(before: &Material, after: &Material) -> Option<Rgb> {
    match (before, after) {
        (
            Material::Emitter { radiance: old, pattern: old_pattern },
            Material::Emitter { radiance: new, pattern: new_pattern },
        ) => ratio(*old, *new).filter(|_| old_pattern == new_pattern),
        (before, after) => (before == after).then_some(Rgb::ONE),
    }
}

/// By channel; none where light comes where there was none.
fn ratio(old: Rgb, new: Rgb) -> Option<Rgb> {
    let channel = |old: f64, new: f64| match (old, new) {
        (old, new) if old == new => Some(1.0),
        (old, new) => Some(new / old).filter(|ratio| old > 0.0 && ratio.is_finite()),
    };
    Some(Rgb::new(channel(old.x, new.x)?, channel(old.y, new.y)?, channel(old.z, new.z)?))
}
