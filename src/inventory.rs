//! What stands in a picture, counted: for people who ask what a scene holds.

use crate::eval::{Thing, Things};
use crate::scene::Scene;
use crate::scene::shape::Bounds;
use crate::schema::{Category, camera};
use std::collections::BTreeMap;

/// Counts of what was written, groups taken apart and loops run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Inventory {
    /// How many shapes and lights of each kind there are, by the kind's name.
    pub kinds: BTreeMap<&'static str, usize>,
    /// The cameras in the order written, with the names of those that have one.
    pub cameras: Vec<Option<String>>,
}

impl Inventory {
    /// Counts the things of a picture.
    pub fn of(things: &Things) -> Inventory {
        let mut inventory = Inventory::default();
        for Thing { made, name, .. } in &things.things {
            match made.kind.get().category {
                Category::Shape | Category::Light => {
                    *inventory.kinds.entry(made.kind.get().name).or_default() += 1
                }
                _ if made.kind == camera::KIND => {
                    inventory.cameras.push(name.as_ref().map(|name| name.to_string()))
                }
                _ => {}
            }
        }
        inventory
    }
}

/// The box around every surface that has an end; none where there is no such surface.
pub fn bounds(scene: &Scene) -> Option<Bounds> {
    let boxes = scene.primitives.iter().filter_map(|primitive| primitive.shape.bounds());
    let all = boxes.fold(Bounds::EMPTY, Bounds::union);
    (!all.is_empty()).then_some(all)
}
