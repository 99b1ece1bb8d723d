//! Lights that give nothing, W0603, and lights that are shut in, W0604.

use super::{Lint, MOST_PAIRS, errors};
use crate::color::Rgb;
use crate::diagnostic::Code;
use crate::math::DVec3;
use crate::scene::boxes::Boxes;
use crate::scene::nesting::lies_in;
use crate::scene::shape::Bounds;
use crate::scene::{Light, Material, OriginId, Primitive, Shape};
use std::collections::BTreeSet;
use std::ops::ControlFlow;

pub(super) fn look(lint: &mut Lint) {
    if !dark(lint) {
        sealed(lint);
    }
}

/// W0603: there are lights, and each has power, radiance or irradiance 0, or is black. Exact.
fn dark(lint: &mut Lint) -> bool {
    let glows = |material: &Material| matches!(material, Material::Emitter { .. });
    let gives =
        lint.scene.lights.iter().any(|light| brightness(light) != Rgb::ZERO)
            || lint.scene.materials.iter().any(
                |material| matches!(material, Material::Emitter { radiance, .. } if *radiance != Rgb::ZERO),
            );
    if gives {
        return false;
    }
    let glowing = lint.scene.primitives.iter().filter(|primitive| glows(lint.material(primitive)));
    let glowing = glowing.map(|primitive| primitive.origin).take(1);
    let origins: Vec<OriginId> = lint.marks.lights.iter().flatten().copied().chain(glowing).collect();
    let Some((first, others)) = origins.split_first() else { return false };
    let diagnostic = errors::dark(lint, *first, others);
    lint.report(diagnostic);
    true
}

/// What a light gives, in whatever it is measured.
fn brightness(light: &Light) -> Rgb {
    match light {
        Light::Point { intensity, .. } | Light::Spot { intensity, .. } => *intensity,
        Light::Sun { irradiance, .. } => *irradiance,
        Light::Sky { radiance, .. } => *radiance,
    }
}

/// Something that glows and has a place.
enum Lamp<'a> {
    Point(DVec3),
    Surface(&'a Shape),
}

/// W0604: a point light or a glowing surface lies in an opaque solid, and the camera does not. A point is found
/// exactly; of surfaces, [`lies_in`] says which it finds. Every opaque solid asks for the lamps whose boxes meet its
/// own.
fn sealed(lint: &mut Lint) {
    let lamps = lamps(lint);
    let bounded = lamps.iter().enumerate().map(|(i, (lamp, _))| (lamp.bounds(), i as u32));
    let boxes = Boxes::new(bounded.filter_map(|(bounds, i)| Some((bounds?, i))).collect());
    let everywhere = Bounds { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY };
    let camera = lint.scene.camera.position;
    let mut pairs = 0;
    let mut known = BTreeSet::new();
    let mut found = vec![];
    for solid in lint.scene.primitives.iter() {
        if lamps.is_empty() || pairs >= MOST_PAIRS {
            break;
        }
        if !solid.shape.is_closed() || !lint.is_opaque(solid) || solid.shape.contains(camera) {
            continue;
        }
        boxes.meeting(solid.shape.bounds().unwrap_or(everywhere), |i| {
            pairs += 1;
            let (lamp, origin) = &lamps[i as usize];
            if !known.contains(&i) && lamp.is_sealed_by(&solid.shape) {
                known.insert(i);
                found.push((*origin, solid.origin));
            }
            if pairs < MOST_PAIRS { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        });
    }
    for (lamp, solid) in found {
        if lint.is_new(Code::W0604, lamp) {
            let diagnostic = errors::sealed(lint, lamp, solid);
            lint.report(diagnostic);
        }
    }
}

fn lamps<'a>(lint: &Lint<'a>) -> Vec<(Lamp<'a>, OriginId)> {
    let points = lint.scene.lights.iter().zip(&lint.marks.lights).filter_map(|(light, origin)| {
        let position = match light {
            Light::Point { position, .. } | Light::Spot { position, .. } => *position,
            Light::Sun { .. } | Light::Sky { .. } => return None,
        };
        Some((Lamp::Point(position), (*origin)?))
    });
    let glows = |primitive: &&Primitive| matches!(lint.material(primitive), Material::Emitter { .. });
    let surfaces = lint.scene.primitives.iter().filter(glows);
    points.chain(surfaces.map(|primitive| (Lamp::Surface(&primitive.shape), primitive.origin))).collect()
}

impl Lamp<'_> {
    fn bounds(&self) -> Option<Bounds> {
        match self {
            Lamp::Point(p) => Some(Bounds { min: *p, max: *p }),
            Lamp::Surface(shape) => shape.bounds(),
        }
    }

    fn is_sealed_by(&self, solid: &Shape) -> bool {
        match self {
            Lamp::Point(p) => solid.contains(*p),
            Lamp::Surface(shape) => !std::ptr::eq(*shape, solid) && *shape != solid && lies_in(shape, solid),
        }
    }
}
