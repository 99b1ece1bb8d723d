//! Why a pixel looks as it does: the parts are the whole, and each has its place.

use crate::folder::Folder;
use rt_lang::color::Rgb;
use rt_lang::lower::Overrides;
use rt_lang::math::{PI, exp2};
use rt_lang::render::apart::Apart;
use rt_lang::render::first::MOST_FIRST_SAMPLES;
use rt_lang::render::light::Source as Lamp;
use rt_lang::render::observer::{Contribution, Observer, PathKind};
use rt_lang::render::{Control, Film, Tracer, Window};
use rt_lang::source::{Source, Sources};
use rt_lang::why::{SamplesBy, Why};
use rt_lang::{Compiled, Options, compile};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// A scene that was compiled, with its texts.
pub struct Known {
    pub sources: Sources,
    pub compiled: Compiled,
}

impl Known {
    pub fn of(text: &str) -> Known {
        Known::with(
            &Folder(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/cases/pictures").into()),
            text,
            [32, 24],
        )
    }

    fn with(folder: &Folder, text: &str, size: [u32; 2]) -> Known {
        let mut sources = Sources::default();
        let id = sources.add(Source::new("scene.rt", text));
        let overrides = Overrides { size: Some(size), ..Overrides::default() };
        let compiled = compile(folder, &mut sources, id, &Options { overrides, ..Options::default() });
        assert!(compiled.scene.is_some(), "{text}\n{:#?}", compiled.diagnostics);
        Known { sources, compiled }
    }

    fn tracer(&self) -> Tracer<'_> {
        Tracer::new(self.compiled.scene.as_ref().unwrap())
    }

    fn why(&self, pixel: [u32; 2], samples: u32) -> Why<'_> {
        let tracer = self.tracer();
        let mut apart = Apart::new(tracer.prepass().scale);
        tracer.take_apart(pixel, 0..samples, &mut apart);
        Why::new(pixel, &apart, SamplesBy::Scene, self.compiled.provenance(&self.sources).unwrap())
    }
}

/// A room with everything that light can go by: seen, direct, by a lens, in mirrors and coats, through glass, and from wall
/// to wall; from a sun, a sky, a point, a spot, a ball and a glowing mesh.
const ALL_SORTS: &str = "
sky { color: #203040 }
sun { from: (1, 2, 1), irradiance: 2W/m2, angle: 2deg }
light { at: (0, 3, 2)m, power: 40W }
light { at: (-2, 3, 1)m, power: 40W, aim: (0, 0, 0)m, cone: 40deg }
light { at: (2, 2, 1)m, power: 20W, radius: 10cm }
mesh { file: \"octahedron.obj\", unit: 20cm, at: (0.5, 0.4, 1.3)m, material: emitter { power: 6W } }
plane { material: diffuse { color: #8a8f98 } }
plane { at: (0, 0, -2)m, normal: (0, 0, 1), material: plastic { color: #a08060 } }
sphere { at: (-1, 0.5, 0)m, radius: 50cm, material: mirror {} }
sphere { at: (0, 0.5, 0.2)m, radius: 50cm, material: dielectric {} }
sphere { at: (1, 0.5, 0)m, radius: 50cm, material: dielectric { roughness: 30% } }
camera { from: (0, 1.5, 5)m, look: (0, 0.5, 0)m }
render { filter: mitchell }
";

/// What a path says that it brings.
#[derive(Default)]
struct Told {
    contributions: Vec<Contribution>,
}

impl Observer for Told {
    fn contributed(&mut self, contribution: &Contribution) {
        self.contributions.push(*contribution);
    }
}

/// The sums of what the paths of a pixel say that they bring, each added to its light and kind of path, and by how much they
/// may differ from what arrives: a path adds in single precision, and a film rounds each sample to half a unit.
fn raw_parts(
    tracer: &Tracer,
    [x, y]: [u32; 2],
    samples: u32,
    scale: f64,
) -> (BTreeMap<(Lamp, PathKind), Rgb>, Rgb) {
    let mut parts: BTreeMap<(Lamp, PathKind), Rgb> = BTreeMap::new();
    let mut slack = Rgb::ZERO;
    for sample in 0..samples {
        let mut told = Told::default();
        let sampled = tracer.sample(x, y, sample, &mut told);
        let (mut sum, mut sizes) = (Rgb::ZERO, Rgb::ZERO);
        for part in told.contributions.iter().filter(|part| part.radiance != Rgb::ZERO) {
            sum += sampled.weight * part.radiance;
            sizes += sampled.weight.abs() * part.radiance.abs();
            *parts.entry((part.source, part.kind())).or_default() += sampled.weight * part.radiance;
        }
        // Each sum of so many is off by as many roundings at most, and by those of doubles, which are nothing beside them.
        let rounding = (told.contributions.len() + 1) as f64 * f64::from(f32::EPSILON) / 2.0 * sizes;
        let off = (sum - sampled.radiance).abs();
        assert!(off.cmple(rounding).all(), "{sum} in place of {} at {x}, {y}: {sample}", sampled.radiance);
        slack += rounding + Rgb::splat(0.5 / scale);
    }
    let over = |sum: Rgb| sum / f64::from(samples);
    (parts.into_iter().map(|(key, part)| (key, over(part))).collect(), over(slack))
}

/// The parts of some pixels are a film's, light by light and path by path; gives the kinds of paths there are, each with the
/// number of pixels that have it.
fn assert_parts_are_the_whole(known: &Known, name: &str) -> BTreeMap<PathKind, usize> {
    const SAMPLES: u32 = 24;
    let tracer = known.tracer();
    let [width, height] = known.compiled.scene.as_ref().unwrap().trace.size;
    let scale = tracer.prepass().scale;
    let mut film = Film::new(Window::whole([width, height]), scale);
    tracer.add_samples(&mut film, 0..SAMPLES, &Control::new()).unwrap();
    let mut kinds = BTreeMap::new();
    for index in (0..width * height).step_by(7) {
        let [x, y] = [index % width, index / width];
        let mut apart = Apart::new(scale);
        // In two goes, as a preview may.
        tracer.take_apart([x, y], 0..5, &mut apart);
        tracer.take_apart([x, y], 5..SAMPLES, &mut apart);
        let mean = film.mean(x, y);
        assert_eq!((apart.mean(), apart.error()), (mean, film.error(x, y)), "{name} at {x}, {y}");
        assert_eq!((apart.alpha(), apart.samples()), (film.alpha(x, y), SAMPLES), "{name} at {x}, {y}");
        assert_eq!(apart.clipped(), 0, "{name} at {x}, {y}");
        let (raw, slack) = raw_parts(&tracer, [x, y], SAMPLES, scale);
        let parts: BTreeMap<_, _> =
            apart.parts().map(|(source, kind, part)| ((source, kind), part)).collect();
        assert!(parts.keys().eq(raw.keys()), "{name} at {x}, {y}: {parts:?} in place of {raw:?}");
        for ((key, part), raw) in parts.iter().zip(raw.values()) {
            let close = (*part - raw).abs().max_element() <= 1e-12 * raw.abs().max_element();
            assert!(close, "{name} at {x}, {y}, {key:?}: {part} in place of {raw}");
        }
        let by_light: Rgb = apart.by_light().iter().map(|(_, part)| *part).sum();
        let by_kind: Rgb = apart.by_kind().iter().map(|(_, part)| *part).sum();
        for sum in [by_light, by_kind, parts.values().sum()] {
            let close = (sum - mean).abs().cmple(slack).all();
            assert!(close, "{name} at {x}, {y}: {sum} in place of {mean}, which is not within {slack}");
        }
        for (kind, _) in apart.by_kind() {
            *kinds.entry(kind).or_default() += 1;
        }
    }
    kinds
}

#[test]
fn the_parts_of_a_pixel_are_the_whole() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut caustics = BTreeSet::new();
    for folder in ["tests/cases/pictures", "examples", "examples/garden", "examples/report"] {
        let folder = root.join(folder);
        for entry in std::fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|extension| extension == "rt") {
                let text = std::fs::read_to_string(&path).unwrap();
                let name = path.file_name().unwrap().to_str().unwrap();
                let known = Known::with(&Folder(folder.clone()), &text, [20, 15]);
                if assert_parts_are_the_whole(&known, name).contains_key(&PathKind::Caustic) {
                    caustics.insert(name.to_string());
                }
            }
        }
    }
    // Light that photons found the way of is among it.
    for name in ["marbles.rt", "three-balls.rt", "newton.rt"] {
        assert!(caustics.contains(name), "{caustics:?}");
    }
    let kinds = assert_parts_are_the_whole(&Known::of(ALL_SORTS), "all sorts");
    let wanted = [
        PathKind::Seen,
        PathKind::Direct,
        PathKind::Caustic,
        PathKind::Mirrored,
        PathKind::Refracted,
        PathKind::Indirect(1),
        PathKind::Indirect(2),
    ];
    assert!(wanted.iter().all(|kind| kinds.get(kind).is_some_and(|pixels| *pixels >= 3)), "{kinds:?}");
}

#[test]
fn parts_of_what_is_too_bright_are_cut_alike() {
    const SAMPLES: u32 = 16;
    let text = "\
camera { from: (0, 0, 1.5)m, look: (0, 0, 0)m, fov: 35deg }
box { size: (4, 4, 4)m }
light { at: (0, 1, 0)m, power: 100W }
render { filter: box }
";
    let known = Known::of(text);
    let tracer = known.tracer();
    let taken_apart = |scale: f64| {
        let mut apart = Apart::new(scale);
        tracer.take_apart([16, 12], 0..SAMPLES, &mut apart);
        apart
    };
    let whole = taken_apart(1e12);
    assert_eq!((whole.clipped(), whole.parts().count()), (0, 8));
    // With room for a quarter of it.
    let most = 0.25 * whole.mean().min_element();
    let cut = taken_apart(exp2(42.0) / most);
    assert_eq!((cut.clipped(), cut.mean()), (SAMPLES, Rgb::splat(most)));
    let mut wanted: BTreeMap<PathKind, Rgb> = BTreeMap::new();
    for sample in 0..SAMPLES {
        let mut told = Told::default();
        let kept = most / tracer.sample(16, 12, sample, &mut told).radiance;
        for part in &told.contributions {
            *wanted.entry(part.kind()).or_default() += kept * part.radiance / f64::from(SAMPLES);
        }
    }
    for (kind, part) in cut.by_kind() {
        let close = (part - wanted[&kind]).abs().max_element() < 1e-12 * most;
        assert!(close, "{kind:?}: {part} in place of {}", wanted[&kind]);
    }
}

#[test]
fn what_a_pixel_shows_is_all_of_it() {
    let text = "\
camera { from: (0, 0, 9)m, look: (0, 0, 0)m, width: 6m }
for x in range(6) { for y in range(6) { sphere { at: (x - 2.5, y - 2.5, 0)m, radius: 40cm } } }
render { filter: FILTER }
";
    for filter in ["box", "tent", "gaussian", "mitchell"] {
        let known = Known::with(&Folder(".".into()), &text.replace("FILTER", filter), [1, 1]);
        let why = known.why([0, 0], 1024);
        assert_eq!((why.shows.len(), why.others.count), (8, 28), "{filter}");
        let shown: f64 = why.shows.iter().map(|shown| shown.share).sum();
        assert!(why.shows.iter().all(|shown| shown.share > 0.0) && why.others.share > shown, "{filter}");
        assert!((shown + why.others.share + why.background - 1.0).abs() < 1e-12, "{filter}: {why:?}");
        if filter == "box" {
            let open = 1.0 - 36.0 * PI * 0.4 * 0.4 / 36.0;
            assert!((why.background - open).abs() < 0.01, "{}", why.background);
        }
    }
}

#[test]
fn shares_of_a_pixel_are_shares_with_any_filter() {
    // An upright edge that crosses the columns of pixels at many places, before the sky.
    let text = "\
camera { from: (0, 0, 5)m, look: (0, 0, 0)m, width: 3.2m }
box { at: (-1, 0, 0)m, size: (2, 10, 2)m, place: turn(z: 3deg) }
render { filter: mitchell, background: transparent }
";
    let known = Known::with(&Folder(".".into()), text, [32, 24]);
    let tracer = known.tracer();
    for samples in [1, 2, 16, 64] {
        let hits = tracer.first_hits(Window::whole([32, 24]), samples, &Control::new()).unwrap();
        for (x, y) in (0..24).flat_map(|y| (0..32).map(move |x| (x, y))) {
            let pixel = hits.pixel(x, y);
            let shown: f64 = pixel.shown().iter().map(|(_, share)| *share).sum();
            assert!((0.0..=1.0).contains(&shown), "{shown} at {x}, {y}");
            assert!((shown + pixel.background() - 1.0).abs() < 1e-12, "{shown} at {x}, {y}");
            // The face of the box is 4 m away, its side no farther than 6.
            assert_eq!(pixel.depth().is_some(), shown > 0.0);
            assert!(pixel.depth().is_none_or(|depth| (3.999..6.0).contains(&depth)), "{:?}", pixel.depth());
        }
    }
}

#[test]
fn paths_are_told_by_what_is_seen() {
    let only = |text: &str, pixel: [u32; 2]| {
        let known = Known::of(text);
        let why = known.why(pixel, 64);
        why.paths.iter().map(|path| path.kind).collect::<BTreeSet<_>>()
    };
    let camera = "camera { from: (0, 0, 5)m, look: (0, 0, 0)m, fov: 35deg }\n";
    let lit = |material: &str| format!("{camera}sky {{}}\nsphere {{ radius: 1m, material: {material} }}");
    assert_eq!(only(&lit("diffuse {}"), [16, 12]), BTreeSet::from(["direct"]));
    assert_eq!(only(&lit("mirror {}"), [16, 12]), BTreeSet::from(["mirrored"]));
    assert_eq!(only(&lit("dielectric {}"), [16, 12]), BTreeSet::from(["mirrored", "refracted"]));
    assert_eq!(only(&lit("emitter { radiance: 2W/m2 }"), [16, 12]), BTreeSet::from(["seen"]));
    assert_eq!(only(&lit("diffuse {}"), [0, 0]), BTreeSet::from(["seen"]));
}

#[test]
fn what_a_pixel_shows_has_the_whole_chain_of_uses() {
    let text = "\
part lamp {
  param glow: power = 5W
  sphere bulb { radius: 30cm, material: emitter { power: glow } }
}
material brass = metal { color: #c9a227, roughness: 40% }
material shiny = brass { roughness: 10% }
group row {
  for i in range(3) {
    sphere { at: ((i - 1) * 1m, 0, 0), radius: 40cm, material: shiny }
  }
}
lamp left { at: (-1, 1, 2)m }
light { at: (0, 5, 5)m, power: 60W }
camera { from: (0, 0, 5)m, look: (0, 0, 0)m, fov: 40deg }
";
    let known = Known::of(text);
    let why = known.why([16, 12], 32);
    let [shown] = why.shows.as_slice() else { panic!("{why:#?}") };
    assert_eq!(shown.share, 1.0);
    let uses: Vec<&str> = shown.thing.uses.iter().map(|used| used.text).collect();
    assert_eq!(uses[0], "group row {");
    assert_eq!(uses[1], "for i in range(3) {");
    assert!(uses[2].starts_with("sphere { at: ((i - 1"));
    assert_eq!(shown.thing.uses[2].place.start.line, 9);
    let turns: Vec<Option<&str>> = shown.thing.uses.iter().map(|used| used.turn).collect();
    assert_eq!((turns, shown.thing.number), (vec![None, Some("i = 1"), None], None));
    let material = shown.material.as_ref().unwrap();
    assert_eq!((material.kind, material.name), ("metal", Some("shiny")));
    assert_eq!(material.place.as_ref().unwrap().text, "brass { roughness: 10% }");
    let bulb = why.lights.iter().find(|light| light.thing.kind == "sphere").unwrap();
    let uses: Vec<&str> = bulb.thing.uses.iter().map(|used| used.text).collect();
    assert_eq!(uses[0], "lamp left { at: (-1, 1, 2)m }");
    assert!(uses[1].starts_with("sphere bulb"));
    let shares: f64 = why.lights.iter().map(|light| light.share).sum();
    assert!((shares - 1.0).abs() < 1e-9);
}

#[test]
fn first_hits_are_where_geometry_puts_them() {
    // Seen through parallel rays, half of each pixel of the middle column shows the box, whose face is 4 m away.
    let text = "
camera { from: (0, 0, 5)m, look: (0, 0, 0)m, width: 3.2m }
box { at: (-1, 0, 0)m, size: (2, 10, 2)m, material: diffuse { color: rgb(0.2, 0.4, 0.6) } }
render { filter: box }
";
    let known = Known::with(&Folder(".".into()), text, [33, 24]);
    let scene = known.compiled.scene.as_ref().unwrap();
    let tracer = known.tracer();
    let hits = tracer.first_hits(Window::whole([33, 24]), MOST_FIRST_SAMPLES, &Control::new()).unwrap();
    let covered = hits.pixel(4, 12);
    assert!((covered.depth().unwrap() - 4.0).abs() < 1e-6);
    assert!(covered.normal().unwrap().abs_diff_eq([0.0, 0.0, 1.0].into(), 1e-6));
    assert!(covered.albedo().abs_diff_eq(Rgb::new(0.2, 0.4, 0.6), 1e-6));
    assert_eq!(covered.shown().len(), 1);
    assert_eq!(covered.shown()[0].1, 1.0);
    let open = hits.pixel(30, 12);
    assert_eq!((open.depth(), open.normal(), open.albedo()), (None, None, Rgb::ZERO));
    assert!(open.shown().is_empty());
    let half = hits.pixel(16, 12);
    let share = half.shown()[0].1;
    assert!((share - 0.5).abs() <= 1.0 / f64::from(MOST_FIRST_SAMPLES), "{share}");
    assert!((half.depth().unwrap() - 4.0).abs() < 1e-6 && half.normal().unwrap().z > 0.999);
    assert!(half.albedo().abs_diff_eq(share * Rgb::new(0.2, 0.4, 0.6), 1e-6));
    // The same on any instructions, in any window; and what a pixel that is taken apart shows.
    for level in rt_lang::render::Level::ALL {
        let window = Window { x: 10, y: 10, width: 9, height: 5 };
        let there = Tracer::new(scene).on(level);
        let part = there.first_hits(window, MOST_FIRST_SAMPLES, &Control::new()).unwrap();
        assert!((10..19).all(|x| part.pixel(x, 12) == hits.pixel(x, 12)), "{level:?}");
    }
    let mut apart = Apart::new(1.0);
    tracer.take_apart([16, 12], 0..MOST_FIRST_SAMPLES, &mut apart);
    assert_eq!(apart.firsts(), half);
}

#[test]
fn the_depth_and_normals_of_a_ball_are_a_balls() {
    let text = "camera { from: (0, 0, 5)m, look: (0, 0, 0)m, fov: 30deg }\nsphere { radius: 1m, material: dielectric {} }";
    let size = 61;
    let known = Known::with(&Folder(".".into()), text, [size, size]);
    let tracer = known.tracer();
    let hits = tracer.first_hits(Window::whole([size, size]), 64, &Control::new()).unwrap();
    let middle = hits.pixel(size / 2, size / 2);
    let step = 2.0 * rt_lang::math::tan(15f64.to_radians()) / f64::from(size);
    // The mean over a pixel about the nearest point is a little behind it.
    let depth = middle.depth().unwrap();
    assert!((4.0..4.0 + 16.0 * step * step).contains(&depth), "{depth}");
    for (x, y) in [(30, 40), (40, 30), (22, 25)] {
        let pixel = hits.pixel(x, y);
        let (n, depth) = (pixel.normal().unwrap().normalize(), pixel.depth().unwrap());
        // On the unit ball about the origin the normal is the point.
        assert!((n.z - (5.0 - depth)).abs() < 5e-3, "{n} at depth {depth}");
        let across = (f64::from(x) - f64::from(size / 2)) * step * depth;
        assert!((n.x - across).abs() < 5e-3, "{n} across {across}");
    }
}

#[test]
fn turns_that_are_too_many_are_numbered() {
    let text = "\
let row = group { for i in range(2) { sphere { at: (i * 3m - 1.5m, 0, 0), radius: 1m } } }
row {}
for i in range(10001) { sphere { at: (0, i * 1m + 50m, 0), radius: 20cm } }
camera { from: (0, 0, 9)m, look: (0, 0, 0)m, fov: 60deg }
";
    let known = Known::of(text);
    let from = known.compiled.provenance(&known.sources).unwrap();
    let thing = |index| from.thing(rt_lang::scene::PrimitiveId(index));
    // What a prototype holds shares its turns; so do those behind the first many.
    let held = thing(1);
    assert_eq!(held.number.map(|number| (number.this, number.of)), Some((2, 2)));
    assert!(held.uses.iter().all(|used| used.turn.is_none()));
    assert_eq!(thing(2).uses[0].turn, Some("i = 0"));
    assert_eq!((thing(10_001).uses[0].turn, thing(10_002).uses[0].turn), (Some("i = 9999"), None));
}
