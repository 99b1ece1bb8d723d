//! A flat text says the same scene: `cases/pictures`, `cases/diagnostics/fine-*`, `cases/expand` and the examples.

use crate::folder::Folder;
use rt_lang::scene::{Primitive, Scene, Shape};
use rt_lang::source::{Source, Sources};
use rt_lang::{Options, compile, expand};
use std::path::{Path, PathBuf};

#[test]
fn the_flat_text_compiles_to_the_same_scene() {
    let mut compared = 0;
    for path in scenes() {
        let Some(scene) = scene(&std::fs::read_to_string(&path).unwrap(), &path) else { continue };
        let Ok(flat) = expand::expand(&scene) else {
            let mesh = |primitive: &Primitive| matches!(primitive.shape, Shape::Mesh(_));
            let painted = !scene.textures.is_empty() || !scene.images.is_empty();
            assert!(painted || scene.primitives.iter().any(mesh), "{}", path.display());
            continue;
        };
        let again =
            self::scene(&flat, &path).unwrap_or_else(|| panic!("{} gives no scene:\n{flat}", path.display()));
        let name = path.display();
        assert_eq!(again.primitives.len(), scene.primitives.len(), "{name}");
        for (found, wanted) in again.primitives.iter().zip(&scene.primitives) {
            assert_eq!((&found.shape, found.material), (&wanted.shape, wanted.material), "{name}");
        }
        assert_eq!(again.camera, scene.camera, "{name}\n{flat}");
        assert_eq!(again.hash(), scene.hash(), "{name}\n{flat}\n{again:#?}\n{scene:#?}");
        assert_eq!((again.develop, again.trace), (scene.develop, scene.trace), "{name}");
        // Once flat, it stays as it is.
        assert_eq!(expand::expand(&again).as_ref(), Ok(&flat), "{name}");
        compared += 1;
    }
    assert!(compared > 30, "{compared} scenes were compared");
}

#[test]
fn the_flat_text_reads_well() {
    let scene =
        scene(include_str!("cases/expand/everything.rt"), Path::new("cases/expand/everything.rt")).unwrap();
    insta::with_settings!({
        prepend_module_to_snapshot => false, omit_expression => true, snapshot_path => "cases/expand"
    }, {
        insta::assert_snapshot!("everything", expand::expand(&scene).unwrap());
    });
}

/// Every scene there is that is meant to compile.
fn scenes() -> Vec<PathBuf> {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let folders = [
        "tests/cases/pictures",
        "tests/cases/expand",
        "tests/cases/diagnostics",
        "examples",
        "examples/report",
    ];
    let mut found: Vec<PathBuf> = folders
        .iter()
        .flat_map(|folder| std::fs::read_dir(root.join(folder)).unwrap())
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "rt"))
        .collect();
    found.sort();
    found
}

fn scene(text: &str, path: &Path) -> Option<Scene> {
    let mut sources = Sources::default();
    let id = sources.add(Source::new("scene.rt", text));
    compile(&Folder::of(path), &mut sources, id, &Options::default()).scene
}
