//! Exports as texts, and what is said of that which another renderer cannot say. `cargo xtask e2e export` renders
//! exports and compares.

use crate::folder::Folder;
use rt_lang::compile;
use rt_lang::export::{Options, Renderer, export};
use rt_lang::scene::Scene;
use rt_lang::source::{Source, Sources};
use std::path::Path;

#[test]
fn exports_are_as_they_were() {
    insta::with_settings!({
        prepend_module_to_snapshot => false, omit_expression => true, snapshot_path => "cases/export"
    }, {
        for (stem, prefix) in [("small", ""), ("painted", "painted-")] {
            let scene = case(stem);
            for (name, renderer) in RENDERERS {
                let options = Options { stem: stem.into(), approximate: true, tessellate: Some(3) };
                let exported = export(&scene, renderer, options).unwrap();
                let notes: String = exported.notes.iter().map(|note| format!("note: {note}\n")).collect();
                let files: String = exported.files.iter().map(|(name, bytes)| format!("{name}:\n{}", String::from_utf8_lossy(bytes))).collect();
                insta::assert_snapshot!(format!("{prefix}{name}"), exported.text + &notes + &files);
            }
        }
    });
}

#[test]
fn nothing_is_left_out_quietly() {
    let scene = case("small");
    for (name, renderer) in RENDERERS {
        let unsaid = export(&scene, renderer, Options::default()).unwrap_err();
        assert!(unsaid.len() >= 2, "{name}: {unsaid:#?}");
        assert!(unsaid.iter().all(|unsaid| unsaid.what.starts_with(renderer.name())), "{name}: {unsaid:#?}");
    }
}

const RENDERERS: [(&str, Renderer); 3] =
    [("mitsuba", Renderer::Mitsuba), ("pbrt", Renderer::Pbrt), ("pov", Renderer::Pov)];

fn case(stem: &str) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/cases/export/{stem}.rt"));
    let mut sources = Sources::default();
    let id = sources.add(Source::new(format!("{stem}.rt"), std::fs::read_to_string(&path).unwrap()));
    compile(&Folder::of(&path), &mut sources, id, &rt_lang::Options::default()).scene.unwrap()
}
