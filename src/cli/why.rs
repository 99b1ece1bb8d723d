//! `rtc why`: what a pixel shows, and where its light comes from.

use super::args::Why as Arguments;
use super::info::short;
use super::target::{print_text, print_words};
use super::terminal::Terminal;
use super::{Exit, Problem, scene as scenes};
use rt_lang::diagnostic::Label;
use rt_lang::lower::Overrides;
use rt_lang::render::Tracer;
use rt_lang::render::apart::Apart;
use rt_lang::report::{self, Style};
use rt_lang::scene::{Scene, Target};
use rt_lang::source::Sources;
use rt_lang::why::{LightShare, PathShare, SamplesBy, Shown, ThingAt, Used, Why};
use std::fmt::Write;

/// Paths to watch where the scene asks for a level of noise: what that takes is known once the whole picture is made.
const ENOUGH: u32 = 256;
/// The most things that are pointed at.
const MOST_POINTED_AT: usize = 3;
/// The least share that is told of: less is 0.0%.
const LEAST_SHARE: f64 = 0.0005;
/// The most lights, and kinds of paths, that are listed.
const MOST_ROWS: usize = 12;

/// Prints it, to be read or as one JSON object.
pub fn run(arguments: &Arguments, terminal: Terminal) -> Result<Exit, Problem> {
    let loaded = scenes::load(&arguments.scene, &arguments.reading, &overrides(arguments))?;
    terminal.diagnostics(&loaded.compiled.diagnostics, &loaded.sources);
    let Some(from) = loaded.compiled.provenance(&loaded.sources) else { return Ok(Exit::Diagnostics) };
    let pixel = arguments.pixel;
    refuse_outside(pixel, from.scene)?;
    let (samples, by) = match from.scene.trace.target {
        Target::Samples(samples) if arguments.samples.is_some() => (samples, SamplesBy::Command),
        Target::Samples(samples) if from.marks.samples.is_some() => (samples, SamplesBy::Scene),
        Target::Samples(samples) => (samples, SamplesBy::Default),
        Target::Noise(_) => (ENOUGH, SamplesBy::Noise),
    };
    let tracer = Tracer::new(from.scene);
    let mut apart = Apart::new(tracer.prepass().scale);
    tracer.take_apart(pixel, 0..samples, &mut apart);
    let why = Why::new(pixel, &apart, by, from);
    if arguments.json {
        let object = serde_json::to_string(&why);
        let object = object.unwrap_or_else(|_| unreachable!("texts and finite numbers are always JSON"));
        print_text(&(object + "\n"))?;
    } else {
        let style = Style { color: false, ..terminal.style() };
        print_words(&words(&why, &loaded.sources.get(loaded.id).name, &loaded.sources, style))?;
    }
    Ok(Exit::Done)
}

fn overrides(arguments: &Arguments) -> Overrides {
    Overrides {
        size: arguments.size,
        samples: arguments.samples,
        seed: arguments.seed,
        ..arguments.viewpoint.overrides()
    }
}

fn refuse_outside([x, y]: [u32; 2], scene: &Scene) -> Result<(), Problem> {
    let [width, height] = scene.trace.size;
    if x < width && y < height {
        return Ok(());
    }
    let problem =
        Problem::new(format!("the pixel {x},{y} lies outside the picture, which is {width}×{height}"));
    Err(problem.help(format!("the first is 0,0 at the top left, the last {},{}", width - 1, height - 1)))
}

/// As a person reads it.
fn words(why: &Why, scene: &str, sources: &Sources, style: Style) -> String {
    let mut text = head(why, scene);
    for shown in why.shows.iter().take(MOST_POINTED_AT) {
        text += &pointed_at(shown, sources, style);
        text.push('\n');
    }
    text += &rest(why);
    text += &values(why);
    text += &table("light", &why.lights, |light| (light_name(light), light.share, light.radiance));
    text += &table("path", &why.paths, |path| (path_name(path), path.share, path.radiance));
    text
}

/// Which pixel this is, and from how many paths it is known, with what chose how many.
fn head(why: &Why, scene: &str) -> String {
    let [x, y] = why.pixel;
    let samples = why.samples;
    let paths = if samples == 1 { "path" } else { "paths" };
    let by = match why.samples_by {
        SamplesBy::Command => ", as `--samples` says",
        SamplesBy::Scene => ", the scene's `samples`",
        SamplesBy::Default => ", the default `samples`",
        SamplesBy::Noise => {
            "\nThe scene asks for a level of noise, so a picture of it may have more or fewer. `rtc build` says how many it took:\n\
             `--samples` with that number gives the very pixel of the picture."
        }
        SamplesBy::Picture => ", which the picture has by now",
    };
    let mut text = format!("pixel {x},{y} of {scene}, from {samples} {paths}{by}\n");
    if why.clipped > 0 {
        let _ =
            writeln!(text, "{} of them are brighter than a picture has room for, and are cut.", why.clipped);
    }
    text.push('\n');
    text
}

/// What the pixel shows besides the things that are pointed at.
fn rest(why: &Why) -> String {
    if why.shows.is_empty() {
        return "It shows nothing but the background.\n\n".into();
    }
    let listed = why.shows.iter().skip(MOST_POINTED_AT);
    let others = listed.len() + why.others.count;
    let share = listed.map(|shown| shown.share).sum::<f64>() + why.others.share;
    let things = if others == 1 { "another thing".into() } else { format!("{others} other things") };
    let mut text = String::new();
    for (share, what) in [(share, things), (why.background, "the background".into())] {
        if share >= LEAST_SHARE {
            let _ = writeln!(text, "{} of it shows {what}.", percent(share));
        }
    }
    if !text.is_empty() {
        text.push('\n');
    }
    text
}

fn pointed_at(shown: &Shown, sources: &Sources, style: Style) -> String {
    let Shown { share, thing, material } = shown;
    let which = thing.number.map_or(String::new(), |number| {
        format!(", number {} of the {} that are made there", number.this, number.of)
    });
    let much = if *share > 1.0 - LEAST_SHARE { "it".into() } else { format!("{} of it", percent(*share)) };
    let message = format!("{much} shows a `{}`{which}", thing.kind);
    let made_of = material.as_ref().map_or(String::new(), |material| {
        let named = material.name.map_or(String::new(), |name| format!("`{name}`, a "));
        let at =
            material.place.as_ref().map_or(" that was chosen".into(), |used| format!(" at {}", at(used)));
        format!("of {named}`{}`{at}", material.kind)
    });
    // The outermost use is the one that is meant; from there it goes inwards.
    let Some((outermost, inner)) = thing.uses.split_first() else { return message + "\n" };
    let mut text =
        report::remark(&message, &Label { span: outermost.span, text: made_of }, &[], sources, style);
    for used in inner {
        let turn = used.turn.map_or(String::new(), |turn| format!(", {turn}"));
        let _ = writeln!(text, "  made at {}{turn}", at(used));
    }
    text
}

fn values(why: &Why) -> String {
    let mut text = String::new();
    let mut row = |head: &str, words: String| {
        // Writing to a string does not fail.
        let _ = writeln!(text, "{head:<11} {words}");
    };
    row("radiance", format!("{} W/(m²·sr) (red, green, blue)", triple(why.radiance)));
    if let Some(error) = why.error {
        let luminance = rt_lang::color::luminance(why.radiance.into());
        let share =
            if luminance > 0.0 { format!(", {} of it", percent(error / luminance)) } else { String::new() };
        row("error", format!("{} (standard error of the luminance{share})", short(error)));
    }
    if why.coverage < 1.0 {
        row("coverage", percent(why.coverage));
    }
    if let Some(depth) = why.depth {
        row("depth", format!("{}m", short(depth)));
    }
    if let Some(normal) = why.normal {
        row("normal", triple(normal));
    }
    text.push('\n');
    text
}

/// A table of what adds up to the pixel; empty where nothing does.
fn table<T>(head: &str, parts: &[T], row: impl Fn(&T) -> (String, f64, [f64; 3])) -> String {
    if parts.is_empty() {
        return format!("no {head} adds anything\n");
    }
    let rows: Vec<_> = parts.iter().take(MOST_ROWS).map(row).collect();
    let width = rows.iter().map(|(name, ..)| name.chars().count()).chain([head.len()]).max().unwrap_or(0);
    let mut text = format!("{head:<width$}  share   adds\n");
    for (name, share, radiance) in rows {
        let _ = writeln!(text, "{name:<width$}  {:>6}  {}", percent(share), triple(radiance));
    }
    if parts.len() > MOST_ROWS {
        let _ = writeln!(text, "and {} more", parts.len() - MOST_ROWS);
    }
    text.push('\n');
    text
}

fn light_name(light: &LightShare) -> String {
    let LightShare { thing, count, .. } = light;
    let ThingAt { kind, number, uses } = thing;
    let turns: Vec<&str> = uses.iter().filter_map(|used| used.turn).collect();
    let which = match number {
        None if !turns.is_empty() => format!(" ({})", turns.join(", ")),
        Some(number) => format!(" number {} of {}", number.this, number.of),
        None if *count > 1 => format!(", {count} of them"),
        None => String::new(),
    };
    // The outermost use is where one looks first; the thing itself is where it is changed.
    let place = match uses.as_slice() {
        [] => ", which was chosen".into(),
        [own] => format!(" at {}", at(own)),
        [outer, .., own] => format!(" at {}, by {}", at(own), at(outer)),
    };
    format!("`{kind}`{which}{place}")
}

fn path_name(path: &PathShare) -> String {
    match (path.kind, path.order) {
        ("indirect", Some(1)) => "indirect, by 1 other surface".into(),
        ("indirect", Some(order)) => format!("indirect, by {order} other surfaces"),
        (kind, _) => kind.into(),
    }
}

fn at(used: &Used) -> String {
    format!("{}:{}:{}", used.place.file, used.place.start.line, used.place.start.column)
}

fn percent(share: f64) -> String {
    format!("{:.1}%", 100.0 * share + 0.0)
}

fn triple(v: [f64; 3]) -> String {
    let [x, y, z] = v.map(short);
    format!("({x}, {y}, {z})")
}
