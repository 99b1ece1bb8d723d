//! What a path is inside of.
//!
//! Dielectric solids nest. Where several overlap one of them is the medium, and a boundary does what parts the
//! medium before it from the one behind it: often nothing (after Schmidt and Budge, "Simple nested dielectrics in
//! ray traced images", JGT 2002). Among the solids around a point, those that contain another of them are out; of
//! the rest the one declared last is the medium.
//!
//! A fixed order of all solids could not say that: let A lie in B, C stick out of both, and A, C, B be declared in
//! this order. Then A wins over B, B over C, and C over A. So the medium is chosen for each set of solids anew.

use crate::color::Rgb;
use crate::math::DVec3;
use crate::render::exact::Exact;
use crate::scene::nesting::lies_in;
use crate::scene::shape::Bounds;
use crate::scene::{Material, PrimitiveId, Projection, Scene, Shape};
use smallvec::SmallVec;

/// The dielectric solids of a scene.
pub struct Dielectrics<'s> {
    scene: &'s Scene,
    /// Those whose boundary may pass through the lens, or that contain it.
    near_camera: Vec<PrimitiveId>,
    /// Whether any has the index of vacuum, so that its boundary does nothing even outside of all others.
    any_invisible: bool,
    /// Whether any absorbs light.
    any_absorbing: bool,
    is_empty: bool,
}

/// What a boundary does to a path that meets it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Boundary {
    /// It parts nothing: the path goes straight on.
    Nothing,
    /// It reflects and refracts; the number is the refractive index behind it over the one before it.
    Interface(f64),
}

/// The solids that a point of a path lies in, in the order of their declaration, and which of them is the medium.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Inside {
    solids: SmallVec<[PrimitiveId; 4]>,
    medium: Option<PrimitiveId>,
}

impl Inside {
    /// Whether there are none.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.solids.is_empty()
    }

    /// Whether there is none but perhaps this one.
    #[inline]
    fn is_at_most(&self, id: PrimitiveId) -> bool {
        self.solids.iter().all(|&solid| solid == id)
    }
}

impl<'s> Dielectrics<'s> {
    /// Finds those of a scene.
    pub fn new(scene: &'s Scene) -> Dielectrics<'s> {
        let ids = (0..scene.primitives.len() as u32).map(PrimitiveId);
        let solids: Vec<PrimitiveId> = ids.filter(|&id| ior(scene, id).is_some()).collect();
        let any_invisible = solids.iter().any(|&id| ior(scene, id) == Some(1.0));
        let any_absorbing = scene.materials.iter().any(
            |material| matches!(material, Material::Dielectric { absorption, .. } if *absorption != Rgb::ZERO),
        );
        let is_empty = solids.is_empty();
        let near_camera = solids.into_iter().filter(|&id| may_reach_lens(scene, id)).collect();
        Dielectrics { scene, near_camera, any_invisible, any_absorbing, is_empty }
    }

    /// Whether there are none.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.is_empty
    }

    /// Whether any has the index of vacuum, so that its boundary does nothing even outside of all others.
    #[inline]
    pub fn any_invisible(&self) -> bool {
        self.any_invisible
    }

    /// Whether any absorbs light.
    #[inline]
    pub fn any_absorbing(&self) -> bool {
        self.any_absorbing
    }

    /// Whether no camera ray starts within any.
    pub fn are_far_from_camera(&self) -> bool {
        self.near_camera.is_empty()
    }

    /// Sets `inside` to the solids around the start of a camera ray.
    pub fn enter_at(&self, exact: &Exact, start: DVec3, inside: &mut Inside) {
        inside.solids.clear();
        inside.medium = None;
        for &id in &self.near_camera {
            if exact.contains(id, start) {
                self.cross(inside, id, true);
            }
        }
    }

    /// The same for a start anywhere, which takes longer.
    pub fn enter_anywhere(&self, exact: &Exact, start: DVec3, inside: &mut Inside) {
        inside.solids.clear();
        inside.medium = None;
        for id in (0..self.scene.primitives.len() as u32).map(PrimitiveId) {
            if self.is_solid(id) && exact.contains(id, start) {
                self.cross(inside, id, true);
            }
        }
    }

    /// What the surface of a dielectric does to a path that enters or leaves it.
    #[inline]
    pub fn boundary(&self, inside: &Inside, id: PrimitiveId, entering: bool) -> Boundary {
        if inside.is_at_most(id) {
            // The common case, with nothing to choose between.
            return interface(self.index(Some(id)), 1.0, entering);
        }
        let others = || inside.solids.iter().copied().filter(|&solid| solid != id);
        let without = self.medium(others);
        // An open surface bounds no medium: it refracts where there is no other, and does nothing within one.
        let within =
            if self.is_solid(id) { self.medium(|| others().chain([id])) } else { without.or(Some(id)) };
        interface(self.index(within), self.index(without), entering)
    }

    /// The refractive index of a medium.
    #[inline]
    fn index(&self, medium: Option<PrimitiveId>) -> f64 {
        medium.and_then(|id| ior(self.scene, id)).unwrap_or(1.0)
    }

    /// Takes a path through the surface of a solid. An open surface bounds no medium.
    #[inline]
    pub fn cross(&self, inside: &mut Inside, id: PrimitiveId, entering: bool) {
        if !self.is_solid(id) {
            return;
        }
        if inside.is_at_most(id) {
            // The common case, with nothing to choose between.
            inside.medium = entering.then_some(id);
            inside.solids.clear();
            if entering {
                inside.solids.push(id);
            }
            return;
        }
        match (entering, inside.solids.binary_search(&id)) {
            (true, Err(place)) => inside.solids.insert(place, id),
            (false, Ok(place)) => {
                inside.solids.remove(place);
            }
            _ => return,
        }
        inside.medium = self.medium(|| inside.solids.iter().copied());
    }

    /// What the medium absorbs, per metre and channel (Beer and Lambert).
    #[inline]
    pub fn absorption(&self, inside: &Inside) -> Rgb {
        let medium = inside.medium.map(|id| self.scene.material(&self.scene.primitives[id.0 as usize]));
        match medium {
            Some(Material::Dielectric { absorption, .. }) => *absorption,
            _ => Rgb::ZERO,
        }
    }

    /// Which of the solids around a point is the medium there.
    fn medium<I: Iterator<Item = PrimitiveId>>(&self, solids: impl Fn() -> I) -> Option<PrimitiveId> {
        let contains_none = |&outer: &PrimitiveId| !solids().any(|inner| self.contains(outer, inner));
        // Containment runs in no circle, so there is always one that contains no other.
        solids().filter(contains_none).max()
    }

    /// Whether one solid lies in another and the other not in it.
    fn contains(&self, outer: PrimitiveId, inner: PrimitiveId) -> bool {
        let (a, b) = (self.shape(outer), self.shape(inner));
        outer != inner && lies_in(b, a) && !lies_in(a, b)
    }

    #[inline]
    fn is_solid(&self, id: PrimitiveId) -> bool {
        ior(self.scene, id).is_some() && self.shape(id).is_closed()
    }

    fn shape(&self, id: PrimitiveId) -> &'s Shape {
        &self.scene.primitives[id.0 as usize].shape
    }
}

/// What parts two refractive indices.
#[inline]
fn interface(within: f64, without: f64, entering: bool) -> Boundary {
    if within == without {
        return Boundary::Nothing;
    }
    Boundary::Interface(if entering { within / without } else { without / within })
}

/// The refractive index of a primitive, if it is a dielectric.
#[inline]
fn ior(scene: &Scene, id: PrimitiveId) -> Option<f64> {
    match scene.material(&scene.primitives[id.0 as usize]) {
        Material::Dielectric { ior, .. } => Some(*ior),
        _ => None,
    }
}

fn may_reach_lens(scene: &Scene, id: PrimitiveId) -> bool {
    let camera = &scene.camera;
    // Filters reach two pixels beyond the edge of the picture, which is one pixel wide at least.
    let reach = match camera.projection {
        Projection::Perspective => camera.lens_radius,
        Projection::Orthographic => 5.0 * camera.half_extent.length(),
    };
    let lens = Bounds { min: camera.position - reach, max: camera.position + reach };
    scene.primitives[id.0 as usize]
        .shape
        .bounds()
        .is_none_or(|bounds| bounds.min.cmple(lens.max).all() && lens.min.cmple(bounds.max).all())
}
