//! `rtc info`: what is in a scene, and what it takes to draw it.

use super::args::Info;
use super::files::Asked;
use super::input::size;
use super::scene::{self, Loaded};
use super::target::{print_text, print_words};
use super::terminal::Terminal;
use super::{Exit, Problem};
use rt_lang::files::FileError;
use rt_lang::inventory::{Param, bounds};
use rt_lang::lower::Overrides;
use rt_lang::math::DVec3;
use rt_lang::render;
use rt_lang::scene::{Scene, Target};
use serde_json::{Value, json};
use std::fmt::Write;

/// Prints it, to be read or as one JSON object.
pub fn run(arguments: &Info, terminal: Terminal) -> Result<Exit, Problem> {
    let overrides = arguments.viewpoint.overrides();
    // No picture is taken, so none of several cameras has to be chosen.
    let overrides = Overrides { every_camera: overrides.camera.is_none(), ..overrides };
    let loaded = scene::load(&arguments.scene, &arguments.reading, &overrides)?;
    terminal.diagnostics(&loaded.compiled.diagnostics, &loaded.sources);
    let Some(scene) = &loaded.compiled.scene else { return Ok(Exit::Diagnostics) };
    match arguments.json {
        true => print_text(&format!("{}\n", object(&loaded, scene)))?,
        false => print_words(&words(&loaded, scene))?,
    }
    Ok(Exit::Done)
}

fn object(loaded: &Loaded, scene: &Scene) -> Value {
    let inventory = &loaded.compiled.inventory;
    let triple = |v: DVec3| json!([v.x, v.y, v.z]);
    let files: Vec<Value> = loaded.files.asked().iter().map(file_object).collect();
    let (samples, noise) = match scene.trace.target {
        Target::Samples(samples) => (json!(samples), Value::Null),
        Target::Noise(noise) => (Value::Null, json!(noise)),
    };
    json!({
        "schema": 1,
        "scene": loaded.sources.get(loaded.id).name,
        "params": inventory.params.iter().map(param_object).collect::<Vec<Value>>(),
        "cameras": inventory.cameras,
        "things": inventory.kinds,
        "primitives": scene.primitives.len(),
        "materials": scene.materials.len(),
        "bounds": bounds(scene).map(|bounds| json!({ "min": triple(bounds.min), "max": triple(bounds.max) })),
        "files": files,
        "size": scene.trace.size,
        "samples": samples,
        "noise": noise,
        "bounces": scene.trace.bounces,
        "memory": render::memory(scene),
        "chosen": loaded.compiled.notes,
    })
}

fn param_object(param: &Param) -> Value {
    json!({
        "name": param.name,
        "type": param.ty,
        "default": param.default,
        "range": param.range,
        "doc": param.doc,
    })
}

fn file_object(asked: &Asked) -> Value {
    let path = asked.path.to_string_lossy();
    match &asked.size {
        Ok(size) => json!({ "path": path, "bytes": size }),
        Err(error) => json!({ "path": path, "error": reason(error) }),
    }
}

fn reason(error: &FileError) -> String {
    match error {
        FileError::Missing => "missing".into(),
        FileError::Outside => "outside the root".into(),
        FileError::TooLarge(most) => format!("larger than {most} bytes"),
        FileError::Unreadable(words) => words.clone(),
    }
}

fn words(loaded: &Loaded, scene: &Scene) -> String {
    let mut text = String::new();
    let mut row = |head: &str, words: &str| {
        // Writing to a string does not fail.
        let _ = writeln!(text, "{head:<11} {words}");
    };
    let inventory = &loaded.compiled.inventory;
    for param in &inventory.params {
        let Param { name, ty, default, .. } = param;
        let range = param.range.as_ref().map_or(String::new(), |[low, high]| format!(" in {low} to {high}"));
        let doc = param.doc.as_ref().map_or(String::new(), |doc| format!("  {}", doc.replace('\n', " ")));
        row("param", &format!("{name}: {ty} = {default}{range}{doc}"));
    }
    let counted: Vec<String> =
        inventory.kinds.iter().map(|(kind, count)| format!("{count} {kind}")).collect();
    row("things", &counted.join(", "));
    let surfaces = scene.primitives.len();
    row("primitives", &format!("{surfaces} of {}", counted_of(scene.materials.len(), "material")));
    row("bounds", &bounds(scene).map_or("nothing with an end".into(), |all| spread(all.min, all.max)));
    let unnamed = || "one without a name".to_string();
    let cameras: Vec<String> =
        inventory.cameras.iter().map(|name| name.clone().unwrap_or_else(unnamed)).collect();
    row("cameras", &if cameras.is_empty() { "one is placed".to_string() } else { cameras.join(", ") });
    let [width, height] = scene.trace.size;
    let until = match scene.trace.target {
        Target::Samples(samples) => format!("{samples} samples a pixel"),
        Target::Noise(noise) => format!("as many samples as {}% noise need", noise * 100.0),
    };
    row("picture", &format!("{width}×{height}, {until}, {} bounces", scene.trace.bounces));
    row("memory", &format!("about {}", size(render::memory(scene))));
    for asked in loaded.files.asked() {
        let said = match &asked.size {
            Ok(bytes) => size(*bytes as u64),
            Err(error) => reason(error),
        };
        row("file", &format!("{} ({said})", asked.path.display()));
    }
    for note in &loaded.compiled.notes {
        row("chosen", note);
    }
    text
}

fn counted_of(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// A box in metres, to four digits.
fn spread(min: DVec3, max: DVec3) -> String {
    let size = max - min;
    let show = |v: DVec3| format!("({}, {}, {})m", short(v.x), short(v.y), short(v.z));
    format!("{} to {}, {} wide, high and deep", show(min), show(max), show(size))
}

/// A number to four digits.
pub fn short(x: f64) -> f64 {
    format!("{x:.3e}").parse::<f64>().unwrap_or(x) + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        assert_eq!((short(0.1 + 0.2), short(-0.0), short(12_345_678.0)), (0.3, 0.0, 12_350_000.0));
    }
}
