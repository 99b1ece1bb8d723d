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
fn mattes_are_shares_with_any_filter() {
    let desk = desk();
    desk.put("mitchell.rt", POTS.replace("filter: box", "filter: mitchell"));
    desk.run("build -q mitchell.rt -o pots.exr --aov object,material,depth").expect(0, &[]);
    for layer in ["CryptoObject", "CryptoMaterial"] {
        let mattes = mattes(&desk.get("pots.exr"), layer);
        for pixel in 0..64 * 48 {
            let shares: Vec<f32> = mattes.values().map(|matte| matte[pixel]).collect();
            assert!(shares.iter().all(|share| (0.0..=1.0).contains(share)), "{shares:?} at {pixel}");
            let sum: f32 = shares.iter().sum();
            assert!(sum <= 1.0 + 1e-6, "{sum} at {pixel}");
            if pixel >= 64 * 40 {
                assert!((sum - 1.0).abs() < 1e-6, "{sum} at {pixel}");
            }
        }
    }
}

/// Two files, each with a `paint` of its own and a nameless material at the same place; a material and another made from it;
/// and things that only their place tells apart.
#[test]
fn each_material_and_each_thing_has_a_matte_of_its_own() {
    let desk = Desk::new();
    for (name, color) in [("red", "#ff0000"), ("blue", "#0000ff")] {
        let text = format!(
            "material paint = diffuse {{ color: {color} }}\n\
             sphere ball {{ radius: 40cm, material: paint }}\n\
             box {{ at: (0, 1, 0)m, size: (50, 50, 50)cm, material: diffuse {{ color: {color} }} }}\n"
        );
        desk.put(&format!("{name}.rt"), text);
    }
    let scene = "\
import \"red.rt\" as red
import \"blue.rt\" as blue
red one { at: (-1, 0, 0)m }
blue other { at: (1, 0, 0)m }
material moss = diffuse { color: #00ff00 }
sphere green { at: (0, -1, 0)m, radius: 30cm, material: moss }
sphere pale { at: (1, -1, 0)m, radius: 30cm, material: moss { color: #ddffdd } }
light lamp { at: (-1, -1, 0)m, radius: 30cm, power: 20W }
sphere plain { at: (0, 0, 0)m, radius: 30cm }
let pair = group { for i in range(2) {
  if i == 0 { sphere s { at: (-0.5, 1.5, 0)m, radius: 20cm } }
  if i == 1 { sphere s { at: (0.5, 1.5, 0)m, radius: 20cm } }
} }
pair {}
for k in [0, 1] { sphere twin { at: (k, 1.8, 0)m, radius: 10cm } }
camera { from: (0, 0, 6)m, look: (0, 0, 0)m, width: 4m }
render { size: (80, 80), samples: 4, filter: box }
";
    desk.put("scene.rt", scene);
    desk.run("build -q scene.rt -o a.exr --aov object,material").expect(0, &[]);
    let materials = mattes(&desk.get("a.exr"), "CryptoMaterial");
    let names: Vec<&str> = materials.keys().map(String::as_str).collect();
    assert_eq!(
        names,
        [
            "blue.rt:diffuse:3:55",
            "blue.rt:paint",
            "diffuse",
            "light",
            "red.rt:diffuse:3:55",
            "red.rt:paint",
            "scene.rt:moss:5:17",
            "scene.rt:moss:7:56",
        ]
    );
    // Each covers what is made of it, and nothing else.
    let objects = mattes(&desk.get("a.exr"), "CryptoObject");
    assert_eq!(materials["red.rt:paint"], objects["one.ball"]);
    assert_eq!(materials["blue.rt:paint"], objects["other.ball"]);
    assert_eq!(materials["light"], objects["lamp"]);
    assert_eq!(materials["scene.rt:moss:5:17"], objects["green"]);
    assert_eq!(materials["scene.rt:moss:7:56"], objects["pale"]);
    // And so does each thing.
    let names: Vec<&str> = objects.keys().map(String::as_str).collect();
    assert_eq!(
        names,
        [
            "for:15:1[k = 0].twin",
            "for:15:1[k = 1].twin",
            "green",
            "lamp",
            "one.ball",
            "one.box:3:1",
            "other.ball",
            "other.box:3:1",
            "pale",
            "plain",
            "scene.rt:pair:14:1.group:10:12.for:10:20.s:11:15",
            "scene.rt:pair:14:1.group:10:12.for:10:20.s:12:15",
        ]
    );
    assert!(objects.values().all(|matte| matte.iter().sum::<f32>() > 1.0));
    // No material can be called as all lamps are.
    desk.put("light.rt", "material light = diffuse {}\nsphere { radius: 1m, material: light }\n");
    desk.run("check light.rt").expect(1, &["E0103"]);
    // What is not in view still tells the others apart.
    desk.put("view.rt", scene.replace("look: (0, 0, 0)m, width: 4m", "look: (-1, 0, 0)m, width: 1m"));
    desk.run("build -q view.rt -o b.exr --aov material").expect(0, &[]);
    let materials = mattes(&desk.get("b.exr"), "CryptoMaterial");
    let names: Vec<&str> = materials.keys().map(String::as_str).collect();
    assert_eq!(names, ["red.rt:paint"]);
}

#[test]
fn why_says_what_chose_the_number_of_paths() {
    let desk = desk();
    desk.put("even.rt", POTS.replace("samples: 16", "noise: 5%"));
    for (arguments, by, words) in [
        ("pots.rt 32,24 --samples 4", "command", "from 4 paths, as `--samples` says"),
        ("pots.rt 32,24", "scene", "from 16 paths, the scene's `samples`"),
        ("ball.rt 3,3 --size 16x12", "default", "from 64 paths, the default `samples`"),
        ("even.rt 32,24", "noise", "from 256 paths\nThe scene asks for a level of noise"),
        ("even.rt 32,24 --samples 1", "command", "from 1 path, as `--samples` says"),
    ] {
        let text = printed(&desk, &format!("why {arguments}"));
        assert!(text.contains(words), "{text}");
        let why: Value = serde_json::from_str(&printed(&desk, &format!("why {arguments} --json"))).unwrap();
        assert_eq!(why["samples_by"], by, "{arguments}");
    }
}

#[test]
fn why_tells_of_small_things_together() {
    let desk = Desk::new();
    desk.put(
        "small.rt",
        "\
camera { from: (0, 0, 9)m, look: (0, 0, 0)m, width: 6m }
for x in range(6) { for y in range(6) { sphere { at: (x - 2.5, y - 2.5, 0)m, radius: 40cm } } }
render { size: (1, 1), samples: 512, filter: box }
",
    );
    let text = printed(&desk, "why small.rt 0,0");
    assert!(text.contains("of it shows 33 other things.\n"), "{text}");
    assert!(text.contains("of it shows the background.\n"), "{text}");
    let why: Value = serde_json::from_str(&printed(&desk, "why small.rt 0,0 --json")).unwrap();
    let share = |value: &Value| value["share"].as_f64().unwrap();
    let shown: f64 = why["shows"].as_array().unwrap().iter().map(share).sum();
    let background = why["background"].as_f64().unwrap();
    assert_eq!(why["others"]["count"], 28);
    assert!((shown + share(&why["others"]) + background - 1.0).abs() < 1e-12, "{why}");
    assert!((0.45..0.55).contains(&background), "{why}");
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
    // Why it gives nothing was said before.
    let sealed = |before: &str| {
        format!(
            "plane {{}}\nlight {{ at: (0, 3, 0)m, power: 9W }}\nsphere {{ at: (3, 1, 0)m, radius: 50cm }}\n{before}light {{ at: (3, 1, 0)m, power: 60W }}\nrender {{ size: (8, 8), samples: 64, bounces: 1 }}\n"
        )
    };
    desk.put("sealed.rt", sealed(""));
    let told = desk.run("build sealed.rt --feedback").stderr;
    assert!(told.contains("W0604") && !told.contains("W0705"), "{told}");
    desk.put("sealed.rt", sealed("@allow(W0604, \"lit from outside today\")\n"));
    let told = desk.run("build sealed.rt --feedback").stderr;
    assert!(!told.contains("W0604") && !told.contains("W0705"), "{told}");
}
