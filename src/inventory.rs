//! What a scene is made of, counted: for people who ask what it holds and what they can set.

use crate::check::{self, Program};
use crate::eval::Things;
use crate::scene::Scene;
use crate::scene::shape::Bounds;
use crate::schema::{Category, camera};
use crate::source::Sources;
use std::collections::BTreeMap;

/// What a scene is made of, groups and parts taken apart and loops run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Inventory {
    /// What can be set, in the order written.
    pub params: Vec<Param>,
    /// How many shapes and lights of each kind there are, by the kind's name.
    pub kinds: BTreeMap<&'static str, usize>,
    /// The cameras in the order written, with the names of those that have one.
    pub cameras: Vec<Option<String>>,
}

/// A setting of a scene, each part of it as it is written there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Param {
    /// Its name.
    pub name: String,
    /// Its type.
    pub ty: String,
    /// What it is where nobody sets it.
    pub default: String,
    /// The least and the greatest it may be.
    pub range: Option<[String; 2]>,
    /// The words above it.
    pub doc: Option<String>,
}

impl Inventory {
    /// Looks through a program and the things it makes.
    pub fn of(program: &Program, sources: &Sources, things: &Things) -> Inventory {
        let file = program.files.last().map(|file| &program.parts[file.part.index()]);
        let params = file.map_or(&[][..], |part| &part.params);
        let mut inventory = Inventory {
            params: params.iter().map(|param| described(param, sources)).collect(),
            ..Inventory::default()
        };
        for kind in things.kinds().map(|kind| kind.get()) {
            if matches!(kind.category, Category::Shape | Category::Light) {
                *inventory.kinds.entry(kind.name).or_default() += 1;
            }
        }
        let cameras = things.of(|kind| kind == camera::KIND).map(|(_, thing)| thing);
        let cameras = cameras.filter(|thing| !thing.hidden);
        inventory.cameras = cameras.map(|thing| thing.name().map(|name| name.to_string())).collect();
        inventory
    }
}

fn described(param: &check::Param, sources: &Sources) -> Param {
    let written = |expr: &check::Expr| sources.text(expr.span).to_string();
    Param {
        name: param.name.to_string(),
        ty: param.declared.written(),
        default: param.written.clone(),
        range: param.range.as_ref().map(|[low, high]| [written(low), written(high)]),
        doc: param.doc.as_ref().map(|doc| doc.to_string()),
    }
}

/// The box around every surface that has an end; none where there is no such surface.
pub fn bounds(scene: &Scene) -> Option<Bounds> {
    let boxes = scene.primitives.iter().filter_map(|primitive| primitive.shape.bounds());
    let all = boxes.fold(Bounds::EMPTY, Bounds::union);
    (!all.is_empty()).then_some(all)
}
