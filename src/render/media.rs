//! What a path is inside of.
//!
//! Dielectric solids nest. Where several overlap one of them is the medium, and the boundaries of the others
//! do nothing there (Schmidt and Budge, "Simple nested dielectrics in ray traced images", JGT 2002). The one
//! whose box is smaller wins, so that what is contained wins over what contains it; of equal ones, the later.

use crate::color::Rgb;
use crate::math::exp;
use crate::render::shape::Ray;
use crate::scene::shape::Bounds;
use crate::scene::{Material, PrimitiveId, Scene};

/// The dielectric solids of a scene, in the order in which they win.
pub struct Dielectrics<'s> {
    scene: &'s Scene,
    /// For each primitive its rank, greater wins; none if it bounds no medium. Empty if no primitive does.
    ranks: Vec<Option<u32>>,
    /// Those whose boundary may pass through the lens, or that contain it.
    near_camera: Vec<PrimitiveId>,
    /// Whether any has the index of vacuum, so that its boundary does nothing even outside of all others.
    any_invisible: bool,
}

/// What a boundary does to a path that meets it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Boundary {
    /// It parts nothing: the path goes straight on.
    Nothing,
    /// It reflects and refracts; the number is the refractive index behind it over the one before it.
    Interface(f64),
}

/// The solids that a point of a path lies in, the winning one last.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Inside {
    solids: Vec<PrimitiveId>,
}

impl<'s> Dielectrics<'s> {
    /// Finds and ranks those of a scene.
    pub fn new(scene: &'s Scene) -> Dielectrics<'s> {
        let index = |id: PrimitiveId| ior(scene, id);
        let volume = |id: PrimitiveId| {
            scene.primitives[id.0 as usize].shape.bounds().map_or(f64::INFINITY, |bounds| {
                let size = bounds.size();
                size.x * size.y * size.z
            })
        };
        let mut solids: Vec<PrimitiveId> = (0..scene.primitives.len() as u32)
            .map(PrimitiveId)
            .filter(|&id| index(id).is_some() && scene.primitives[id.0 as usize].shape.is_closed())
            .collect();
        solids.sort_by(|&a, &b| volume(b).total_cmp(&volume(a)).then(a.cmp(&b)));
        let mut ranks = vec![None; if solids.is_empty() { 0 } else { scene.primitives.len() }];
        for (rank, id) in (0..).zip(&solids) {
            ranks[id.0 as usize] = Some(rank);
        }
        let near_camera = solids.iter().copied().filter(|&id| may_reach_lens(scene, id)).collect();
        let any_invisible = solids.iter().any(|&id| index(id) == Some(1.0));
        Dielectrics { scene, ranks, near_camera, any_invisible }
    }

    /// Sets `inside` to the solids around the start of a camera ray.
    pub fn enter_at(&self, ray: &Ray, inside: &mut Inside) {
        inside.solids.clear();
        for &id in &self.near_camera {
            if self.scene.primitives[id.0 as usize].shape.contains(ray.origin) {
                self.cross(inside, id, true);
            }
        }
    }

    /// What the surface of a dielectric does to a path that enters or leaves it.
    pub fn boundary(&self, inside: &Inside, id: PrimitiveId, entering: bool) -> Boundary {
        let other = inside.solids.iter().rev().copied().find(|&solid| solid != id);
        if other.is_some_and(|other| self.rank(other) > self.rank(id)) {
            return Boundary::Nothing;
        }
        let without = other.and_then(|other| ior(self.scene, other)).unwrap_or(1.0);
        let within = ior(self.scene, id).unwrap_or(1.0);
        if without == within {
            return Boundary::Nothing;
        }
        Boundary::Interface(if entering { within / without } else { without / within })
    }

    /// Takes a path through the surface of a solid. An open surface bounds no medium.
    pub fn cross(&self, inside: &mut Inside, id: PrimitiveId, entering: bool) {
        let Some(rank) = self.ranks.get(id.0 as usize).copied().flatten() else { return };
        let place = inside.solids.partition_point(|&solid| self.rank(solid) < Some(rank));
        let known = inside.solids.get(place) == Some(&id);
        match (entering, known) {
            (true, false) => inside.solids.insert(place, id),
            (false, true) => {
                inside.solids.remove(place);
            }
            _ => {}
        }
    }

    /// The share of light that is left after a distance in the medium (Beer and Lambert).
    pub fn transmission(&self, inside: &Inside, distance: f64) -> Rgb {
        let medium =
            inside.solids.last().map(|id| self.scene.material(&self.scene.primitives[id.0 as usize]));
        let Some(Material::Dielectric { absorption, .. }) = medium else { return Rgb::ONE };
        // Neither a clear medium without end nor an opaque one without depth is 0 × ∞.
        let channel = |sigma: f64| if sigma == 0.0 || distance == 0.0 { 1.0 } else { exp(-sigma * distance) };
        Rgb::new(channel(absorption.x), channel(absorption.y), channel(absorption.z))
    }

    /// Whether a straight line may cross a boundary that does nothing.
    pub fn may_pass(&self, inside: &Inside) -> bool {
        self.any_invisible || !inside.solids.is_empty()
    }

    fn rank(&self, id: PrimitiveId) -> Option<u32> {
        self.ranks.get(id.0 as usize).copied().flatten()
    }
}

/// The refractive index of a primitive, if it is a dielectric.
fn ior(scene: &Scene, id: PrimitiveId) -> Option<f64> {
    match scene.material(&scene.primitives[id.0 as usize]) {
        Material::Dielectric { ior, .. } => Some(*ior),
        _ => None,
    }
}

fn may_reach_lens(scene: &Scene, id: PrimitiveId) -> bool {
    let camera = &scene.camera;
    let lens =
        Bounds { min: camera.position - camera.lens_radius, max: camera.position + camera.lens_radius };
    scene.primitives[id.0 as usize]
        .shape
        .bounds()
        .is_none_or(|bounds| bounds.min.cmple(lens.max).all() && lens.min.cmple(bounds.max).all())
}
