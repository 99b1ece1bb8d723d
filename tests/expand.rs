//! A flat text says the same scene: `cases/pictures`, `cases/diagnostics/fine-*`, `cases/expand` and the examples.

use crate::folder::Folder;
use rt_lang::files::{Contents, FilePath};
use rt_lang::scene::Scene;
use rt_lang::source::{Source, Sources};
use rt_lang::{Options, compile, expand};
use std::path::{Path, PathBuf};

#[test]
fn the_flat_text_compiles_to_the_same_scene() {
    let mut compared = 0;
    for path in scenes() {
        let Some((scene, contents)) = scene(&std::fs::read_to_string(&path).unwrap(), &path) else {
            continue;
        };
        let place = FilePath::root("scene.rt");
        let flat = expand::expand(&scene, &contents, &place).unwrap();
        let (again, contents) =
            self::scene(&flat, &path).unwrap_or_else(|| panic!("{} gives no scene:\n{flat}", path.display()));
        let name = path.display();
        assert_eq!(again.primitives.len(), scene.primitives.len(), "{name}");
        for (found, wanted) in again.primitives.iter().zip(scene.primitives.iter()) {
            assert_eq!(
                (&found.shape, found.material, found.frame),
                (&wanted.shape, wanted.material, wanted.frame),
                "{name}"
            );
        }
        assert_eq!((&again.textures, &again.frames), (&scene.textures, &scene.frames), "{name}\n{flat}");
        assert_eq!(again.lights, scene.lights, "{name}\n{flat}");
        assert_eq!(again.camera, scene.camera, "{name}\n{flat}");
        assert_eq!(again.hash(), scene.hash(), "{name}\n{flat}\n{again:#?}\n{scene:#?}");
        assert_eq!((again.develop, again.trace), (scene.develop, scene.trace), "{name}");
        // Once flat, it stays as it is.
        assert_eq!(expand::expand(&again, &contents, &place).as_ref(), Ok(&flat), "{name}");
        compared += 1;
    }
    assert!(compared > 30, "{compared} scenes were compared");
}

#[test]
fn the_flat_text_reads_well() {
    let (scene, contents) =
        scene(include_str!("cases/expand/everything.rt"), Path::new("cases/expand/everything.rt")).unwrap();
    insta::with_settings!({
        prepend_module_to_snapshot => false, omit_expression => true, snapshot_path => "cases/expand"
    }, {
        insta::assert_snapshot!("everything", expand::expand(&scene, &contents, &FilePath::root("scene.rt")).unwrap());
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

fn scene(text: &str, path: &Path) -> Option<(Scene, Contents)> {
    let mut sources = Sources::default();
    let id = sources.add(Source::new("scene.rt", text));
    let compiled = compile(&Folder::of(path), &mut sources, id, &Options::default());
    compiled.scene.map(|scene| (scene, compiled.contents))
}
