//! What a picture tells besides its light: why a pixel looks as it does, further channels, and feedback.

use super::Desk;
use exr::prelude::*;
use serde_json::Value;
use std::collections::BTreeMap;

/// A ball of glass and two of clay, made by a loop in a group.
const POTS: &str = "\
sky { color: #203040 }
light { at: (2, 2, 1)m, power: 20W, radius: 10cm }
group pots {
  for i in range(3) {
    sphere pot {
      at: ((i - 1) * 1m, 50cm, 0)
      radius: 50cm
      material: if i == 1 then glass else clay
    }
  }
}
material glass = dielectric {}
material clay = diffuse { color: #a08060 }
plane { material: diffuse { color: #8a8f98 } }
camera { from: (0, 1.5, 5)m, look: (0, 0.5, 0)m }
render { size: (64, 48), samples: 16, filter: box }
";

fn desk() -> Desk {
    let desk = Desk::new();
    desk.put("pots.rt", POTS);
    desk
}

fn printed(desk: &Desk, arguments: &str) -> String {
    let ended = desk.run(arguments);
    assert_eq!((ended.code, ended.stderr.as_str()), (Some(0), ""), "{arguments}");
    String::from_utf8(ended.stdout).unwrap()
}

#[test]
fn why_tells_of_a_pixel() {
    let desk = desk();
    insta::assert_snapshot!("why", printed(&desk, "why pots.rt 32,24"));
    let object: Value = serde_json::from_str(&printed(&desk, "why pots.rt 32,24 --json")).unwrap();
    insta::assert_snapshot!("why-json", serde_json::to_string_pretty(&object).unwrap());
    // A scene in which all is chosen.
    insta::assert_snapshot!("why-chosen", printed(&desk, "why ball.rt 320,240 --samples 4"));
    let nothing = printed(&desk, "why ball.rt 0,0 --samples 4 --size 64x64");
    assert!(nothing.contains("It shows nothing but the background."), "{nothing}");
}

#[test]
fn what_why_says_is_what_the_picture_holds() {
    let desk = desk();
    desk.run("build -q pots.rt -o pots.exr --aov depth,normal,error,samples");
    let channels = channels(&desk.get("pots.exr"));
    for [x, y] in [[32, 24], [10, 40], [50, 20]] {
        let why: Value =
            serde_json::from_str(&printed(&desk, &format!("why pots.rt {x},{y} --json"))).unwrap();
        let same = |name: &str, value: &Value| {
            let held = channels[name][y * 64 + x];
            let told = value.as_f64().unwrap() as f32;
            assert_eq!(held, told, "{name} at {x},{y}");
        };
        for (channel, name) in ["R", "G", "B"].iter().enumerate() {
            same(name, &why["radiance"][channel]);
        }
        for (axis, name) in ["normal.X", "normal.Y", "normal.Z"].iter().enumerate() {
            same(name, &why["normal"][axis]);
        }
        same("depth.Z", &why["depth"]);
        same("error.X", &why["error"]);
        same("samples.X", &why["samples"]);
    }
}

#[test]
fn why_says_what_is_wrong() {
    let desk = desk();
    desk.run("why pots.rt 64,0")
        .expect(2, &["the pixel 64,0 lies outside the picture, which is 64×48", "63,47"]);
    desk.run("why pots.rt 5").expect(2, &["column and row"]);
    desk.run("why pots.rt 5,-1").expect(2, &["column and row"]);
    desk.run("why pots.rt 5,5 --samples 0").expect(2, &["samples"]);
    desk.run("why pots.rt").expect(2, &["X,Y"]);
    desk.run("why missing.rt 0,0").expect(2, &["missing.rt"]);
    desk.put("bad.rt", "sphere { raduis: 1m }\n");
    desk.run("why bad.rt 0,0").expect(1, &["E0301"]);
}

/// The channels of an EXR by name.
fn channels(file: &[u8]) -> BTreeMap<String, Vec<f32>> {
    let image = image(file);
    let channel = |channel: &AnyChannel<FlatSamples>| {
        let FlatSamples::F32(values) = &channel.sample_data else { panic!("{} is no float", channel.name) };
        (channel.name.to_string(), values.clone())
    };
    image.layer_data.channel_data.list.iter().map(channel).collect()
}

fn image(file: &[u8]) -> Image<Layer<AnyChannels<FlatSamples>>> {
    let reader = read().no_deep_data().largest_resolution_level().all_channels();
    reader.first_valid_layer().all_attributes().from_buffered(std::io::Cursor::new(file)).unwrap()
}

#[test]
fn further_channels_go_into_an_exr() {
    let desk = desk();
    desk.run("build pots.rt --aov depth").expect(2, &["`--aov` is for EXR files", "-o picture.exr"]);
    desk.run("build pots.rt -o a.exr --aov depth,depth").expect(2, &["twice"]);
    desk.run("build pots.rt -o a.exr --aov depht").expect(2, &["depht"]);
    desk.run("build -q pots.rt -o plain.exr").expect(0, &[]);
    let all = "depth,normal,albedo,samples,error,object,material";
    desk.run(&format!("build -q pots.rt -o all.exr -o all.png --aov {all}")).expect(0, &[]);
    desk.run(&format!("build -q pots.rt -o again.exr --aov {all} -j 3")).expect(0, &[]);
    assert!(desk.get("all.exr") == desk.get("again.exr"), "any number of threads gives the same bytes");
    let (plain, all) = (channels(&desk.get("plain.exr")), channels(&desk.get("all.exr")));
    assert!(plain.iter().all(|(name, values)| all[name] == *values), "the picture is the same");
    let names: Vec<&str> = all.keys().map(String::as_str).collect();
    assert_eq!(plain.keys().collect::<Vec<_>>(), ["B", "G", "R"]);
    for name in ["albedo.R", "depth.Z", "error.X", "normal.Z", "samples.X", "CryptoObject02.A"] {
        assert!(names.contains(&name), "{names:?}");
    }
    // It can still be developed, to the very picture.
    desk.run("develop -q all.exr -o developed.png").expect(0, &[]);
    assert_eq!(super::read_png(&desk.get("developed.png")), super::read_png(&desk.get("all.png")));
    // The glass lets all light through, the plane lies level, and above is nothing.
    let at = |name: &str, x: usize, y: usize| all[name][y * 64 + x];
    assert_eq!(at("albedo.G", 32, 24), 1.0);
    assert_eq!([at("normal.X", 4, 44), at("normal.Y", 4, 44)], [0.0, 1.0]);
    assert_eq!([at("depth.Z", 1, 1), at("normal.Y", 1, 1), at("albedo.R", 1, 1)], [f32::INFINITY, 0.0, 0.0]);
    assert_eq!(at("samples.X", 7, 7), 16.0);
}

/// Reads mattes as the specification of Cryptomatte 1.2 says: for each name of the manifest its coverage.
fn mattes(file: &[u8], layer: &str) -> BTreeMap<String, Vec<f32>> {
    let image = image(file);
    let texts: BTreeMap<String, String> = image
        .layer_data
        .attributes
        .other
        .iter()
        .filter_map(|(name, value)| match value {
            AttributeValue::Text(text) => Some((name.to_string(), text.to_string())),
            _ => None,
        })
        .collect();
    let key = texts.iter().find(|(name, value)| name.ends_with("/name") && *value == layer);
    let key = key.unwrap_or_else(|| panic!("no {layer} in {texts:?}")).0.strip_suffix("/name").unwrap();
    assert!(key.starts_with("cryptomatte/") && key.len() == "cryptomatte/".len() + 7, "{key}");
    assert_eq!(texts[&format!("{key}/hash")], "MurmurHash3_32");
    assert_eq!(texts[&format!("{key}/conversion")], "uint32_to_float32");
    let manifest: BTreeMap<String, String> =
        serde_json::from_str(&texts[&format!("{key}/manifest")]).unwrap();
    let channels = channels(file);
    let pairs: Vec<[&Vec<f32>; 2]> = (0..)
        .map_while(|level| {
            let channel = |name: &str| channels.get(&format!("{layer}{level:02}.{name}"));
            Some([[channel("R")?, channel("G")?], [channel("B")?, channel("A")?]])
        })
        .flatten()
        .collect();
    let matte = |hex: String| {
        let id = u32::from_str_radix(&hex, 16).unwrap();
        let coverage = |pixel: usize| {
            let shares = pairs.iter().filter(|[ids, _]| ids[pixel].to_bits() == id);
            shares.map(|[_, shares]| shares[pixel]).sum()
        };
        (0..pairs[0][0].len()).map(coverage).collect()
    };
    manifest.into_iter().map(|(name, hex)| (name, matte(hex))).collect()
}

#[test]
fn mattes_are_read_by_name() {
    let desk = desk();
    desk.run("build -q pots.rt -o pots.exr --aov object,material").expect(0, &[]);
    let objects = mattes(&desk.get("pots.exr"), "CryptoObject");
    let names: Vec<&str> = objects.keys().map(String::as_str).collect();
    assert_eq!(
        names,
        ["plane:14:1", "pots.for:4:3[i = 0].pot", "pots.for:4:3[i = 1].pot", "pots.for:4:3[i = 2].pot"]
    );
    let materials = mattes(&desk.get("pots.exr"), "CryptoMaterial");
    let names: Vec<&str> = materials.keys().map(String::as_str).collect();
    assert_eq!(names, ["clay", "diffuse:14:19", "glass"]);
    assert_eq!(materials["glass"], objects["pots.for:4:3[i = 1].pot"]);
    assert_eq!(objects["pots.for:4:3[i = 1].pot"][24 * 64 + 32], 1.0);
    // All that covers a pixel adds up to it, or to nothing where the sky is.
    for pixel in 0..64 * 48 {
        let sum: f32 = objects.values().map(|matte| matte[pixel]).sum();
        assert!((0.0..=1.0 + 1e-5).contains(&sum), "{sum} at {pixel}");
        if pixel >= 64 * 40 {
            assert!((sum - 1.0).abs() < 1e-5, "{sum} at {pixel}");
        }
    }
    // Left and right are alike, but for noise at the edges.
    let area = |name: &str| objects[name].iter().sum::<f32>();
    let [left, right] = [area("pots.for:4:3[i = 0].pot"), area("pots.for:4:3[i = 2].pot")];
    assert!((left - right).abs() < 0.01 * left, "{left} and {right}");
}

#[test]
fn feedback_tells_what_many_paths_did() {
    let desk = Desk::new();
    desk.put(
        "much.rt",
        "\
plane {}
group row {
  for i in range(2) {
    box { at: (i * 2m, 60cm, 0), size: (1, 1, 1)m }
    sphere { at: (i * 2m, 60cm, 0), radius: 30cm }
  }
}
light lamp { at: (-2, 3, 2)m, radius: 1m, power: 100W }
light { at: (0, 3, 0)m, aim: (0, 9, 0)m, cone: 40deg, power: 60W }
camera { from: (0, 2, 5)m, look: (0, 0.5, 0)m }
render { size: (16, 12), samples: 4, bounces: 2 }
",
    );
    let told = desk.run("build much.rt --feedback");
    assert_eq!(told.code, Some(0));
    let shown: String = told
        .stderr
        .lines()
        .filter(|line| !line.contains(" samples (noise "))
        .fold(String::new(), |text, line| text + line + "\n");
    insta::assert_snapshot!("feedback", shown);
    assert_eq!(desk.run("build much.rt").stderr.matches("W07").count(), 0);
    desk.run("build -q --deny W0705 much.rt --feedback").expect(1, &["W0705"]);
    desk.put(
        "allowed.rt",
        "plane {}\nlight { at: (0, 3, 0)m, power: 9W }\n@allow(W0705, \"off today\")\nlight { at: (0, 3, 0)m, aim: (0, 9, 0)m, cone: 40deg, power: 60W }\nrender { size: (8, 8), samples: 64, bounces: 1 }\n",
    );
    let allowed = desk.run("build allowed.rt --feedback");
    assert!(!allowed.stderr.contains("W0705"), "{}", allowed.stderr);
}
