//! What a text becomes: numbers of the scene that follow from it.

use crate::folder::Folder;
use rt_lang::math::cos;
use rt_lang::scene::{Light, Projection, Scene};
use rt_lang::source::{Source, Sources};
use rt_lang::{Options, compile};
use std::f64::consts::PI;
use std::path::Path;

/// The scene of a text that names files of `cases/pictures`.
fn scene(text: &str) -> Scene {
    let mut sources = Sources::default();
    let id = sources.add(Source::new("scene.rt", text));
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cases/pictures");
    let compiled = compile(&Folder(folder), &mut sources, id, &Options::default());
    compiled.scene.unwrap_or_else(|| panic!("{text}: {:#?}", compiled.diagnostics))
}

#[test]
fn the_power_of_a_spot_is_what_leaves_its_cone() {
    for (cone, soft) in [(20.0, 0.0), (50.0, 0.4), (120.0, 1.0), (360.0, 0.5)] {
        let scene = scene(&format!(
            "light {{ power: 7W, aim: (0, 0, -1)m, cone: {cone}deg, soft: {soft} }}\nsphere {{ radius: 1m }}"
        ));
        let [Light::Spot { intensity, inner, outer, direction, .. }] = scene.lights[..] else {
            panic!("{:?}", scene.lights)
        };
        assert_eq!(direction.to_array(), [0.0, 0.0, -1.0]);
        // The integral of the falloff, in a thousand rings.
        let falloff = |c: f64| {
            let x = ((c - cos(outer)) / (cos(inner) - cos(outer))).clamp(0.0, 1.0);
            if c >= cos(inner) { 1.0 } else { x * x * (3.0 - 2.0 * x) }
        };
        let rings = (0..100_000).map(|i| 1.0 - 2.0 * (f64::from(i) + 0.5) / 100_000.0);
        let flux: f64 = rings.map(|c| 2.0 * PI * intensity.x * falloff(c) * 2.0 / 100_000.0).sum();
        assert!((flux / 7.0 - 1.0).abs() < 1e-3, "{cone} {soft}: {flux}");
    }
}

#[test]
fn an_orthographic_camera_is_as_wide_as_it_says() {
    let scene = scene("sphere { radius: 1m }\ncamera { width: 3m }\nrender { size: (300, 200) }");
    assert_eq!(scene.camera.projection, Projection::Orthographic);
    assert_eq!(scene.camera.half_extent.to_array(), [1.5, 1.0]);
    assert!(scene.camera.position.length() > 1.0, "everything is in front of it");
}
