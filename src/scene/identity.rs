//! What a picture's samples depend on, in parts that have names: so that two pictures that are not the same can be told apart
//! in words.

use super::{Background, Scene, digest};

/// What the samples of a picture depend on, each with a name and a value. The value of what is large is its hash.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Identity {
    /// Always the same names in the same order.
    entries: Vec<(&'static str, String)>,
}

/// The names of the entries that are hashes.
const HASHES: [&str; 4] = ["surfaces", "materials", "lights", "camera"];
/// The names of the others.
const VALUES: [&str; 7] = ["size", "crop", "seed", "bounces", "indirect", "filter", "background"];

impl Identity {
    /// That of a window of a scene's picture: x, y, width and height.
    pub fn new(scene: &Scene, crop: [u32; 4]) -> Identity {
        let trace = &scene.trace;
        let hashes = [
            digest(&scene.primitives),
            digest(&(&scene.materials, &scene.textures, &scene.images, &scene.frames)),
            digest(&scene.lights),
            digest(&scene.camera),
        ];
        let [width, height] = trace.size;
        let [x, y, columns, rows] = crop;
        let values = [
            format!("{width}x{height}"),
            format!("{x},{y},{columns},{rows}"),
            trace.seed.to_string(),
            trace.bounces.to_string(),
            trace.indirect.to_string(),
            trace.filter.word().to_string(),
            trace.background.word().to_string(),
        ];
        let hashes = HASHES.into_iter().zip(hashes.map(|hash| hash.to_hex().to_string()));
        Identity { entries: hashes.chain(VALUES.into_iter().zip(values)).collect() }
    }

    /// One whose values are known by name; none where one is missing.
    pub fn from_values(value: impl Fn(&str) -> Option<String>) -> Option<Identity> {
        let names = HASHES.into_iter().chain(VALUES);
        let entries = names.map(|name| Some((name, value(name)?))).collect::<Option<_>>()?;
        Some(Identity { entries })
    }

    /// Every name with its value.
    pub fn entries(&self) -> impl Iterator<Item = (&'static str, &str)> {
        self.entries.iter().map(|(name, value)| (*name, value.as_str()))
    }

    fn value(&self, name: &str) -> &str {
        self.entries().find(|(known, _)| *known == name).map_or("", |(_, value)| value)
    }

    /// Width and height of the whole picture in pixels; 0 where they are none.
    pub fn size(&self) -> [u32; 2] {
        let (width, height) = self.value("size").split_once('x').unwrap_or_default();
        [width, height].map(|side| side.parse().unwrap_or(0))
    }

    /// The window of the picture: x, y, width and height; none where it is no such thing.
    pub fn crop(&self) -> Option<[u32; 4]> {
        let numbers: Option<Vec<u32>> = self.value("crop").split(',').map(|text| text.parse().ok()).collect();
        numbers?.try_into().ok()
    }

    /// Whether what nothing covers is transparent.
    pub fn is_transparent(&self) -> bool {
        self.value("background") == Background::Transparent.word()
    }

    /// In what another is different, as one writes it: `another camera` or `--seed 7 (kept: 0)`, where the other is the kept one.
    pub fn differences(&self, other: &Identity, called: &str) -> Vec<String> {
        // Who changes the size of a whole picture has not cropped it.
        let cropped = !(self.is_whole() && other.is_whole());
        let ([width, height], [columns, rows]) = (self.size(), other.size());
        // A picture of another shape is seen by another camera, whatever the scene says of it.
        let reshaped = u64::from(width) * u64::from(rows) != u64::from(columns) * u64::from(height);
        let pairs = self.entries.iter().zip(&other.entries);
        let different = pairs.filter(|((name, own), (_, other))| match *name {
            "crop" if !cropped => false,
            "camera" if reshaped => false,
            _ => own != other,
        });
        different
            .map(|((name, own), (_, other))| match *name {
                _ if name == &"camera" => "another camera".to_string(),
                _ if HASHES.contains(name) => format!("other {name}"),
                "size" | "crop" | "seed" => difference(&format!("`--{name} {own}`"), called, other),
                _ => difference(&format!("`{name}: {own}`"), called, other),
            })
            .collect()
    }

    /// Whether nothing is cropped.
    fn is_whole(&self) -> bool {
        let [width, height] = self.size();
        self.crop() == Some([0, 0, width, height])
    }
}

/// What is asked for, with what another has in its place: `--seed 7 (kept: 0)`. What comes from a file may be anything.
pub fn difference(own: &str, called: &str, other: &str) -> String {
    format!("{own} ({called}: {})", other.escape_debug().take(40).collect::<String>())
}
