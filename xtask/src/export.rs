//! Exports against the renderers that they are for: Mitsuba draws what it can, POV-Ray what comes straight from
//! lights. Both make nearly the picture that we make.

use super::{Outcome, Place, run, tools};
use std::fs;
use std::process::Command;

/// Scenes for Mitsuba, with further flags of the export.
const MITSUBA: &[(&str, &str, &[&str])] = &[
    ("room", ROOM, &[]),
    ("balls", BALLS, &["--approximate"]),
    ("lens", LENS, &[]),
    ("parallel", PARALLEL, &["--approximate"]),
    ("dusk", DUSK, &[]),
    ("knot", KNOT, &["--approximate"]),
    ("towers", TOWERS, &["--approximate", "--tessellate", "96"]),
    ("painted", PAINTED, &["--approximate"]),
];

/// Scenes for POV-Ray.
const POV: &[(&str, &str)] = &[("direct", DIRECT), ("spot", SPOT), ("cells", CELLS)];

const ROOM: &str = "\
sphere { at: (0, -100, 0)m, radius: 100m, material: diffuse { color: rgb(0.5, 0.6, 0.7) } }
sphere { at: (-1, 1, 0)m, radius: 1m, material: dielectric {} }
sphere { at: (1.2, 1, 0)m, radius: 1m, material: mirror {} }
box { at: (0, 0.4, 1.8)m, size: (0.8, 0.8, 0.8)m, material: plastic { color: rgb(0.7, 0.2, 0.1) } }
cylinder { at: (2.8, 0.1, 0)m, radius: 50cm, height: 1m, material: diffuse { color: rgb(0.2, 0.6, 0.2) } }
light { at: (2, 5, 4)m, radius: 60cm, power: 500W }
sky { color: rgb(0.3, 0.35, 0.4) }
camera { from: (1, 2.5, 9)m, look: (0.5, 0.7, 0)m, exposure: 0 }
render { size: (160, 120), samples: 256, filter: box, bounces: 6 }
";

const BALLS: &str = "\
plane { material: diffuse { color: rgb(0.5, 0.5, 0.5) } }
sphere { at: (-1, 1, 0)m, radius: 1m, material: metal { color: rgb(0.9, 0.6, 0.2), roughness: 30% } }
sphere { at: (1.2, 1, 0)m, radius: 1m, material: diffuse { color: rgb(0.2, 0.3, 0.8) } }
sun { from: (1, 2, 1), irradiance: 3W/m2, angle: 0deg }
sky { color: rgb(0.3, 0.4, 0.6) }
camera { from: (0, 2, 8)m, look: (0, 0.8, 0)m, exposure: 0 }
render { size: (160, 120), samples: 256, filter: box }
";

const LENS: &str = "\
sphere { at: (0, -100, 0)m, radius: 100m, material: diffuse {} }
sphere { at: (-1, 1, 0)m, radius: 1m, material: diffuse { color: rgb(0.8, 0.2, 0.2) } }
sphere { at: (2, 1, -4)m, radius: 1m, material: diffuse { color: rgb(0.2, 0.8, 0.2) } }
light { at: (3, 6, 4)m, power: 900W }
sky { color: rgb(0.2, 0.2, 0.2) }
camera { from: (0, 2, 8)m, look: (0, 0.8, 0)m, fov: 45deg, exposure: 0, lens { aperture: 40cm, focus: 8m } }
render { size: (160, 120), samples: 256, filter: tent }
";

const PARALLEL: &str = "\
box { at: (0, -0.5, 0)m, size: (9, 1, 9)m, material: diffuse {} }
sphere { at: (0, 1, 0)m, radius: 1m, material: diffuse { color: rgb(0.8, 0.5, 0.2) } }
light { at: (0, 6, 3)m, power: 900W, aim: (0, 0, 0)m, cone: 40deg, soft: 0 }
sky { color: rgb(0.2, 0.2, 0.2) }
camera { from: (3, 4, 8)m, look: (0, 0.8, 0)m, width: 6m, exposure: 0 }
render { size: (160, 120), samples: 256, filter: box }
";

const TOWERS: &str = "\
plane { material: diffuse {} }
hyperboloid { at: (-1.5, 1.01, 0)m, axes: (0.5, 0.8, 0.5)m, sheets: 1, height: 2m, material: diffuse { color: rgb(0.8, 0.5, 0.2) } }
cone { at: (1.5, 0.01, 0)m, radius: 1m, height: 2m, material: diffuse { color: rgb(0.2, 0.5, 0.8) } }
sky {}
camera { from: (0, 3, 8)m, look: (0, 0.8, 0)m, exposure: 0 }
render { size: (160, 120), samples: 256, filter: box }
";

const DUSK: &str = "\
sky { image: \"dusk.hdr\", turn: -20deg, radiance: 0.8W/m2 }
box { at: (0, -0.5, 0)m, size: (9, 1, 9)m, material: diffuse {} }
sphere { at: (-0.9, 0.7, 0)m, radius: 70cm, material: mirror {} }
sphere { at: (0.9, 0.7, 0)m, radius: 70cm, material: diffuse {} }
camera { from: (0, 1, 5)m, look: (0, 0.9, 0)m, fov: 60deg, exposure: 0 }
render { size: (160, 120), samples: 256, filter: box }
";

const KNOT: &str = "\
mesh { file: \"knot.ply\", unit: 50cm, at: (0, 1.6, 0)m, place: turn(y: 20deg) |> scale(1, 1.2, -1), material: diffuse { color: rgb(0.8, 0.3, 0.2) } }
plane { material: diffuse { color: rgb(0.5, 0.6, 0.7) } }
light { at: (2, 5, 4)m, power: 500W }
sky { radiance: 0.3W/m2 }
camera { from: (0, 2.5, 7)m, look: (0, 1.4, 0)m, exposure: 0 }
render { size: (160, 120), samples: 256, filter: box }
";

const PAINTED: &str = "\
plane { material: diffuse { color: checker(rgb(0.7, 0.7, 0.7), rgb(0.2, 0.1, 0.1), 70cm) } }
box { at: (-1.6, 0.6, 0)m, size: (1.2, 1.2, 1.2)m, place: turn(y: 30deg), material: diffuse { color: stripes(rgb(0.8, 0.2, 0.1), checker(rgb(0.9, 0.9, 0.9), rgb(0.1, 0.1, 0.1), 15cm), width: 30cm, along: (1, 1, 0)) } }
box { at: (1.5, 0.75, 1)m, size: (1, 1.5, 0.2)m, place: turn(y: -30deg), material: diffuse { color: image(\"letter.png\", size: 40cm) } }
sphere { at: (0, 0.7, 0)m, radius: 70cm, place: turn(y: 50deg) |> turn(x: 20deg), material: diffuse { color: image(\"letter.png\") } }
light { at: (2, 5, 4)m, power: 500W }
sky { radiance: 0.3W/m2 }
camera { from: (0, 4, 7)m, look: (0, 0.4, 0)m, exposure: 0 }
render { size: (160, 120), samples: 256, filter: box }
";

/// Files that the scenes name, among the cases of pictures.
const FILES: &[&str] = &["dusk.hdr", "knot.ply", "letter.png"];

const DIRECT: &str = "\
plane { material: diffuse { color: rgb(0.5, 0.6, 0.7) } }
hyperboloid { at: (-1.5, 1.01, 0)m, axes: (0.5, 0.8, 0.5)m, sheets: 1, height: 2m, material: diffuse { color: rgb(0.8, 0.5, 0.2) } }
cone { at: (1.5, 0.01, 0)m, radius: 1m, height: 2m, material: diffuse { color: rgb(0.2, 0.5, 0.8) } }
sphere { at: (0, 0.8, 1.5)m, radius: 80cm, material: mirror {} }
paraboloid { at: (3.5, 0.01, 0)m, radius: 70cm, height: 1m, open: true, material: diffuse {} }
light { at: (2, 5, 4)m, power: 500W }
sun { from: (-1, 2, 1), irradiance: 1W/m2, angle: 0deg }
camera { from: (0, 3, 8)m, look: (0.5, 0.8, 0)m, exposure: 0 }
render { size: (160, 120), samples: 64, filter: box, indirect: false }
";

const SPOT: &str = "\
plane { material: diffuse { color: rgb(0.5, 0.6, 0.7) } }
box { at: (0, 0.51, 0)m, size: (1, 1, 1)m, place: turn(y: 30deg), material: diffuse { color: rgb(0.8, 0.3, 0.3) } }
light { at: (2, 5, 4)m, power: 300W, aim: (0, 0, 0)m, cone: 40deg, soft: 50% }
camera { from: (0, 3, 8)m, look: (0, 0.8, 0)m, width: 8m, exposure: 0 }
render { size: (160, 120), samples: 64, filter: box, indirect: false }
";

const CELLS: &str = "\
plane { material: diffuse { color: checker(rgb(0.7, 0.7, 0.7), rgb(0.2, 0.1, 0.1), 70cm) } }
box { at: (-1.6, 0.61, 0)m, size: (1.2, 1.2, 1.2)m, place: turn(y: 30deg), material: diffuse { color: stripes(rgb(0.8, 0.2, 0.1), checker(rgb(0.9, 0.9, 0.9), rgb(0.1, 0.1, 0.1), 15cm), width: 30cm, along: (1, 1, 0)) } }
sphere { at: (0, 0.8, 0)m, radius: 80cm, place: turn(z: 20deg), material: diffuse { color: checker(rgb(0.2, 0.3, 0.8), rgb(0.9, 0.9, 0.9), 40cm) } }
cylinder { at: (1.8, 0.01, 0)m, radius: 60cm, height: 1m, material: diffuse { color: checker(rgb(0.2, 0.8, 0.3), stripes(rgb(0.9, 0.9, 0.9), rgb(0.5, 0.1, 0.1), width: 5cm, along: (0, 1, 0)), 25cm) } }
box { at: (0, 0.31, 2)m, size: (0.6, 0.6, 0.6)m, material: mirror { color: stripes(rgb(0.9, 0.9, 0.9), rgb(0.3, 0.3, 0.3), width: 10cm, along: (0, 1, 0)) } }
light { at: (2, 5, 4)m, power: 500W }
camera { from: (0, 3, 8)m, look: (0, 0.6, 0.5)m, exposure: 0 }
render { size: (160, 120), samples: 64, filter: box, indirect: false }
";

/// Exports, renders and compares each scene.
pub fn agreement(place: &Place) -> Outcome {
    tools::povray()?;
    let python = tools::mitsuba(&place.desk.with_file_name("mitsuba"))?;
    let script = place.root.join("xtask/e2e/export.py");
    for file in FILES {
        let from = place.root.join("tests/cases/pictures").join(file);
        fs::copy(&from, place.desk.join(file)).map_err(|error| format!("{}: {error}", from.display()))?;
    }
    for (name, text, flags) in MITSUBA {
        println!("Mitsuba, {name}:");
        let export = prepare(place, name, text, "xml", flags)?;
        let ours = place.desk.join(format!("{name}.pfm"));
        run(Command::new(&python).arg(&script).arg("mitsuba").arg(export).arg(ours))?;
    }
    for (name, text) in POV {
        println!("POV-Ray, {name}:");
        let export = prepare(place, name, text, "pov", &[])?;
        let theirs = place.desk.join(format!("{name}.pov.exr"));
        let mut pov = Command::new("povray");
        pov.args(["+W160", "+H120", "+A0.0", "+AM1", "+R4", "-D", "-GA", "+FE"]);
        pov.arg(format!("+I{}", export.display())).arg(format!("+O{}", theirs.display()));
        run(&mut pov)?;
        let ours = place.desk.join(format!("{name}.pfm"));
        run(Command::new(&python).arg(&script).arg("pov").arg(theirs).arg(ours))?;
    }
    Ok(())
}

/// Writes a scene, our picture of it, and its export, whose path is given.
fn prepare(
    place: &Place,
    name: &str,
    text: &str,
    extension: &str,
    flags: &[&str],
) -> Result<std::path::PathBuf, String> {
    let scene = place.desk.join(format!("{name}.rt"));
    fs::write(&scene, text).map_err(|error| format!("{}: {error}", scene.display()))?;
    let export = scene.with_extension(extension);
    run(Command::new(&place.rtc).arg("export").arg(&scene).arg("-o").arg(&export).args(flags))?;
    run(Command::new(&place.rtc)
        .args(["build", "--quiet"])
        .arg(&scene)
        .arg("-o")
        .arg(scene.with_extension("pfm")))?;
    Ok(export)
}
