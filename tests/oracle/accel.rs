//! Finds what a ray meets first: a hierarchy of boxes over what has bounds, a list of what has none.
//!
//! Two surfaces at equal distance are told apart by their index, so the answer does not depend on the shape of the
//! hierarchy.

use super::shape::{Face, Place, Ray, Tree, intersect};
use rt_lang::math::DVec3;
use rt_lang::render::exact::Hierarchy;
use rt_lang::scene::shape::Bounds;
use rt_lang::scene::{Primitive, PrimitiveId, Shape};
use std::collections::BTreeMap;

/// The hierarchy, over borrowed surfaces.
pub struct Accel<'s> {
    primitives: &'s [Primitive],
    hierarchy: Hierarchy,
    /// Of each mesh, once however often it stands in the scene.
    trees: Vec<Tree>,
    /// For each surface the place of its tree among them; empty where there is no mesh.
    tree_of: Vec<u32>,
    /// Those asked for every ray: without end, or so large that a box around them would be met by most rays.
    always: Vec<u32>,
}

/// Where a ray meets something.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    /// Distance along the ray, above 0.
    pub t: f64,
    /// What it meets.
    pub place: Place,
}

/// So few surfaces are asked one by one.
const FEW: usize = 8;
/// A box that has this share of the area of the box around everything is met by about that share of rays.
const LARGE: f64 = 0.2;
impl<'s> Accel<'s> {
    /// Builds the hierarchy.
    pub fn new(primitives: &'s [Primitive]) -> Accel<'s> {
        let mut items = Vec::new();
        let mut always = Vec::new();
        for (id, primitive) in (0..).zip(primitives) {
            match primitive.shape.bounds() {
                Some(bounds) if bounds.min.is_finite() && bounds.max.is_finite() => {
                    items.push((id, bounds));
                }
                _ => always.push(id),
            }
        }
        let whole = items.iter().fold(Bounds::EMPTY, |sum, (_, bounds)| sum.union(*bounds));
        let few = items.len() <= FEW;
        items.retain(|(id, bounds): &(u32, Bounds)| {
            // What a ray asks of a mesh beyond its box is not little.
            let simple = !matches!(primitives[*id as usize].shape, Shape::Mesh(_));
            let large = simple && (few || bounds.half_area() >= LARGE * whole.half_area());
            if large {
                always.push(*id);
            }
            !large
        });
        always.sort_unstable();
        let (trees, tree_of) = trees(primitives);
        Accel { primitives, hierarchy: Hierarchy::new(items), trees, tree_of, always }
    }

    /// The least distance above 0 at which a ray meets a surface. `start` is the face that it starts on, if it starts
    /// on this very surface.
    #[inline]
    pub fn intersect(&self, id: PrimitiveId, ray: &Ray, start: Option<Face>) -> Option<(f64, Face)> {
        match &self.primitives[id.0 as usize].shape {
            Shape::Mesh(instance) => self.tree(id).intersect(instance, ray, start),
            shape => intersect(shape, ray, start),
        }
    }

    /// Whether a point lies in a solid.
    pub fn contains(&self, id: PrimitiveId, p: DVec3) -> bool {
        match &self.primitives[id.0 as usize].shape {
            Shape::Mesh(instance) => self.tree(id).contains(instance, p),
            shape => shape.contains(p),
        }
    }

    fn tree(&self, id: PrimitiveId) -> &Tree {
        &self.trees[self.tree_of[id.0 as usize] as usize]
    }

    /// What the ray meets first.
    pub fn closest(&self, ray: &Ray) -> Option<Hit> {
        self.closest_but(ray, f64::INFINITY, None)
    }

    /// What the ray meets first below a distance, were it not for one surface.
    pub fn closest_but(&self, ray: &Ray, distance: f64, except: Option<PrimitiveId>) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        let mut limit = distance;
        self.visit(ray, distance, except, |hit| {
            let nearer = match best {
                None => hit.t < limit,
                Some(last) => hit.t < last.t || hit.t == last.t && hit.place.primitive < last.place.primitive,
            };
            if nearer {
                limit = hit.t;
                best = Some(hit);
            }
            Some(limit)
        });
        best
    }

    /// Whether the ray meets anything below a distance, but for one surface.
    pub fn occluded(&self, ray: &Ray, distance: f64, except: Option<PrimitiveId>) -> bool {
        let mut found = false;
        self.visit(ray, distance, except, |hit| {
            found = hit.t < distance;
            (!found).then_some(distance)
        });
        found
    }

    /// Shows every surface that the ray may meet to `meet`, which returns how far still to look, or none to stop.
    fn visit(
        &self,
        ray: &Ray,
        mut limit: f64,
        except: Option<PrimitiveId>,
        mut meet: impl FnMut(Hit) -> Option<f64>,
    ) {
        let mut test = |id: u32| -> Option<Option<f64>> {
            let primitive = PrimitiveId(id);
            if except == Some(primitive) {
                return None;
            }
            let start = ray.start.filter(|start| start.primitive == primitive).map(|start| start.face);
            let (t, face) = self.intersect(primitive, ray, start)?;
            Some(meet(Hit { t, place: Place { primitive, face } }))
        };
        for &id in &self.always {
            if let Some(answer) = test(id) {
                let Some(nearer) = answer else { return };
                limit = nearer;
            }
        }
        self.hierarchy.walk(ray.origin, ray.direction, limit, |id| {
            if let Some(answer) = test(id) {
                limit = answer?;
            }
            Some(limit)
        });
    }
}

/// The hierarchies of all meshes, and for each surface which of them it has.
fn trees(primitives: &[Primitive]) -> (Vec<Tree>, Vec<u32>) {
    let mut known = BTreeMap::new();
    let mut trees = Vec::new();
    let mut tree_of = Vec::new();
    for (id, primitive) in primitives.iter().enumerate() {
        let Shape::Mesh(instance) = &primitive.shape else { continue };
        let place = *known.entry(*instance.mesh.hash().as_bytes()).or_insert_with(|| {
            trees.push(Tree::new(&instance.mesh));
            trees.len() as u32 - 1
        });
        tree_of.resize(primitives.len(), u32::MAX);
        tree_of[id] = place;
    }
    (trees, tree_of)
}
