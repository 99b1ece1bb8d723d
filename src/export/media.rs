//! What lies around each dielectric solid, for renderers that have no order of nested solids: they are told the
//! index on both sides of each boundary.

use super::Writer;
use crate::math::DVec3;
use crate::scene::boxes::Boxes;
use crate::scene::nesting::lies_in;
use crate::scene::shape::Bounds;
use crate::scene::{Material, Primitive};
use std::ops::ControlFlow;

/// The refractive index around each primitive: that of the smallest dielectric solid it lies in, else 1.
pub(super) fn surroundings(writer: &mut Writer) -> Vec<f64> {
    let scene = writer.scene;
    let ior = |primitive: &Primitive| match scene.material(primitive) {
        Material::Dielectric { ior, .. } => Some(*ior),
        _ => None,
    };
    let mut around = vec![1.0; scene.primitives.len()];
    let solids: Vec<usize> =
        (0..scene.primitives.len()).filter(|i| ior(&scene.primitives[*i]).is_some()).collect();
    let everywhere = Bounds { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY };
    let bounds = |i: usize| scene.primitives[i].shape.bounds().unwrap_or(everywhere);
    let boxes = Boxes::new(solids.iter().map(|i| (bounds(*i), *i as u32)).collect());
    for &inner in &solids {
        let shape = &scene.primitives[inner].shape;
        let mut smallest: Option<usize> = None;
        let mut crossing = None;
        boxes.meeting(bounds(inner), |outer| {
            let outer = outer as usize;
            let other = &scene.primitives[outer].shape;
            if outer == inner || lies_in(other, shape) {
                return ControlFlow::Continue(());
            }
            if !lies_in(shape, other) {
                crossing = Some(outer);
            } else if smallest.is_none_or(|known| lies_in(other, &scene.primitives[known].shape)) {
                smallest = Some(outer);
            }
            ControlFlow::Continue(())
        });
        if crossing.is_some() {
            let origin = Some(scene.primitives[inner].origin);
            writer.nearly(origin, "does not order dielectrics that overlap", "each is taken to be alone");
        }
        if let Some(index) = smallest.and_then(|outer| ior(&scene.primitives[outer])) {
            around[inner] = index;
        }
    }
    around
}
