//! A picture in the making as an EXR that shows it and holds its exact sums, and back: what a checkpoint is, and a share of the
//! samples that another machine took.
//!
//! Beside R, G, B and maybe A, which any program shows, there are the channels of [`CHANNELS`] in whole numbers, and as
//! attributes what the sums depend on ([`Identity`]), and a checksum over all of these. What is read may be anything: it is
//! refused, with a reason, unless it is whole and its numbers can be sums of samples.

mod head;
mod merge;

use crate::output::{CannotDecode, Channels, Facts, Picture, Words, decode_words, encode_exr, is_exr};
use crate::render::film::{LIGHT_WORDS, LightSums, MOST_SAMPLES, Pixel, WORDS};
use crate::render::making::Making;
use crate::render::{Film, Shown, Window};
use crate::scene::{Tonemap, identity::Identity};
pub use head::Head;
pub use merge::{Merging, most_first};
use std::fmt;
use std::ops::Range;

/// The channels of exact sums: the words of a pixel (see [`Pixel::words`]), and how many samples it is to have.
pub const CHANNELS: [&str; WORDS + 1] = [
    "sums.red.0",
    "sums.red.1",
    "sums.green.0",
    "sums.green.1",
    "sums.blue.0",
    "sums.blue.1",
    "sums.red.red.0",
    "sums.red.red.1",
    "sums.red.red.2",
    "sums.red.red.3",
    "sums.green.green.0",
    "sums.green.green.1",
    "sums.green.green.2",
    "sums.green.green.3",
    "sums.blue.blue.0",
    "sums.blue.blue.1",
    "sums.blue.blue.2",
    "sums.blue.blue.3",
    "sums.red.green.0",
    "sums.red.green.1",
    "sums.red.green.2",
    "sums.red.green.3",
    "sums.red.blue.0",
    "sums.red.blue.1",
    "sums.red.blue.2",
    "sums.red.blue.3",
    "sums.green.blue.0",
    "sums.green.blue.1",
    "sums.green.blue.2",
    "sums.green.blue.3",
    "sums.covered.0",
    "sums.covered.1",
    "sums.open.0",
    "sums.open.1",
    "sums.samples",
    "sums.aim",
];

/// The channels that a picture in the making has besides where its first samples are kept apart ([`Making::early`]): the words of
/// their light (see [`LightSums::words`]), of half the last power of two of them and of that.
pub const EARLY_CHANNELS: [&str; 2 * LIGHT_WORDS] = [
    "early.half.red.0",
    "early.half.red.1",
    "early.half.green.0",
    "early.half.green.1",
    "early.half.blue.0",
    "early.half.blue.1",
    "early.half.covered.0",
    "early.half.covered.1",
    "early.half.open.0",
    "early.half.open.1",
    "early.last.red.0",
    "early.last.red.1",
    "early.last.green.0",
    "early.last.green.1",
    "early.last.blue.0",
    "early.last.blue.1",
    "early.last.covered.0",
    "early.last.covered.1",
    "early.last.open.0",
    "early.last.open.1",
];

/// The form of these files. Another number is another form.
const VERSION: &str = "4";

// Attributes. Those of the identity have its names behind this.
const PREFIX: &str = "rtc.saved.";
const FORM: &str = "rtc.saved.version";
const PROGRAM: &str = "rtc.saved.program";
const SHARE: &str = "rtc.saved.share";
const START: &str = "rtc.saved.start";
const JUDGED: &str = "rtc.saved.judged";
const SCALE: &str = "rtc.saved.scale";
const CHECKSUM: &str = "rtc.saved.checksum";

/// What samples are of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Subject {
    /// The program that traces them, with its version.
    pub program: String,
    /// What they depend on.
    pub identity: Identity,
    /// Which share of the samples they are, where others make the rest.
    pub share: Option<Share>,
}

/// A picture in the making, as it was read.
#[derive(Clone, Debug, PartialEq)]
pub struct Saved {
    /// What it is of.
    pub subject: Subject,
    /// The samples.
    pub making: Making,
    /// How the picture came about.
    pub facts: Facts,
}

/// One of several shares of a picture's samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Share {
    /// From 1 to the number of shares.
    pub index: u32,
    /// How many there are.
    pub of: u32,
    /// Samples a pixel of all shares together.
    pub samples: u32,
}

impl Share {
    /// Its samples: each share is of as many as any other, or one more.
    pub fn range(&self) -> Range<u32> {
        let bound = |index: u32| (u64::from(self.samples) * u64::from(index) / u64::from(self.of)) as u32;
        bound(self.index - 1)..bound(self.index)
    }

    /// Whether there is such a share. There are no more of them than samples, so that none is empty.
    pub fn is_one(&self) -> bool {
        (1..=self.of).contains(&self.index) && self.of <= self.samples && self.samples <= MOST_SAMPLES
    }

    fn parse(text: &str) -> Option<Share> {
        let (index, rest) = text.split_once('/')?;
        let (of, samples) = rest.split_once(" of ")?;
        let share =
            Share { index: index.parse().ok()?, of: of.parse().ok()?, samples: samples.parse().ok()? };
        share.is_one().then_some(share)
    }
}

/// As `2/4 of 64`.
impl fmt::Display for Share {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{} of {}", self.index, self.of, self.samples)
    }
}

/// Why something is not taken, in words that follow the name of its file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refused(String);

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

fn refused<T>(reason: impl Into<String>) -> Result<T, Refused> {
    Err(Refused(reason.into()))
}

impl Subject {
    /// The bytes of the file of a picture of this in the making.
    pub fn encode(&self, making: &Making, facts: &Facts) -> Result<Vec<u8>, Refused> {
        let mut channels =
            Channels { words: words(making), texts: self.texts(making), ..Channels::default() };
        let checksum = checksum(&channels, facts);
        channels.texts.push((CHECKSUM.into(), checksum));
        let bytes = encode_exr(&picture(making.film(), &self.identity), facts, channels);
        bytes.map_err(|reason| Refused(reason.to_string()))
    }

    /// The attributes of the file, in order, but for the checksum.
    fn texts(&self, making: &Making) -> Vec<(String, String)> {
        let own = |(name, value): (&str, &str)| (format!("{PREFIX}{name}"), value.to_string());
        let mut texts: Vec<(String, String)> = self.identity.entries().map(own).collect();
        texts.extend([
            (FORM.into(), VERSION.into()),
            (PROGRAM.into(), self.program.clone()),
            (START.into(), making.start().to_string()),
            (SCALE.into(), format!("{:e}", making.film().scale())),
        ]);
        texts.extend(making.judged().map(|shown| (JUDGED.into(), judged_words(shown))));
        texts.extend(self.share.map(|share| (SHARE.into(), share.to_string())));
        texts.sort();
        texts
    }
    /// Why samples of another subject, of which messages tell by this word, are none of this one, if they are not.
    pub fn refuses(&self, other: &Subject, called: &str) -> Option<String> {
        if self.program != other.program {
            return Some(format!(
                "it was made by `{}`, and this is {}",
                other.program.escape_debug(),
                self.program
            ));
        }
        let differences = self.identity.differences(&other.identity, called);
        if !differences.is_empty() {
            return Some(format!("it is of another picture: {}", differences.join(", ")));
        }
        if self.share == other.share {
            return None;
        }
        let name = |share: Option<Share>| match share {
            Some(Share { index, of, samples }) => format!("`--shard {index}/{of} --samples {samples}`"),
            None => "no `--shard`".to_string(),
        };
        Some(format!("it has other samples: {} ({called}: {})", name(self.share), name(other.share)))
    }
}

impl Saved {
    /// Reads a file. Its pixels are read only where its head promises the sums, and nothing besides that takes memory.
    pub fn decode(file: &[u8]) -> Result<Saved, Refused> {
        let head = Head::decode(file)?;
        let mut words = decode_words(file).map_err(|reason| unreadable(file, reason))?;
        words.sort_by_key(|words| channels().position(|name| name == words.name));
        let Head { subject, facts, window, start, scale, judged, texts, checksum: said } = head;
        let known = channels().take(words.len());
        let is_known = words.iter().map(|words| words.name.as_str()).eq(known);
        let channels = Channels { words, texts, ..Channels::default() };
        if !is_known || said != Some(checksum(&channels, &facts)) {
            return refused("is damaged: what it holds is not what was written");
        }
        let making = making(window, start, scale, judged, &channels.words)
            .ok_or_else(|| Refused("holds numbers that are no sums of samples".into()))?;
        Ok(Saved { subject, making, facts })
    }
}

/// Why nothing can be read of a file.
fn unreadable(file: &[u8], reason: CannotDecode) -> Refused {
    Refused(match is_exr(file) {
        true => format!("cannot be read: {reason}"),
        false => format!("is no checkpoint and no share of a picture: {reason}"),
    })
}

/// All channels there may be, in their order.
fn channels() -> impl Iterator<Item = &'static str> {
    CHANNELS.into_iter().chain(EARLY_CHANNELS)
}

/// Exposure and curve, as `0.5 neutral`.
fn judged_words(shown: Shown) -> String {
    format!("{} {}", shown.stops, shown.tonemap.word())
}

fn judged_from(words: &str) -> Option<Shown> {
    let (stops, tonemap) = words.split_once(' ')?;
    let stops = stops.parse().ok().filter(|stops: &f64| stops.is_finite())?;
    Some(Shown { stops, tonemap: Tonemap::from_word(tonemap)? })
}

/// How a picture came about, with the least and the most samples of a pixel and their noise. One sample does not tell how noisy
/// it is.
pub fn judged(facts: Facts, film: &Film, samples: [u32; 2]) -> Facts {
    let (stops, tonemap) = (facts.stops.unwrap_or(0.0), facts.tonemap.unwrap_or(Tonemap::Neutral));
    let noise = (samples[0] > 1).then(|| film.noise(stops, tonemap));
    Facts { samples: Some(samples), noise, ..facts }
}

/// The picture that sums show.
pub fn picture(film: &Film, identity: &Identity) -> Picture {
    let Window { x, y, width, height } = film.window();
    let whole = identity.size();
    let picture = Picture::gather(whole, [x, y], [width, height], |x, y| film.mean(x, y));
    if identity.is_transparent() { picture.with_alpha(|x, y| film.alpha(x, y)) } else { picture }
}

fn words(making: &Making) -> Vec<Words> {
    let pixels = making.film().pixels();
    let mut values: Vec<Vec<u32>> = (0..WORDS).map(|_| Vec::with_capacity(pixels.len())).collect();
    for pixel in pixels {
        for (values, word) in values.iter_mut().zip(pixel.words()) {
            values.push(word);
        }
    }
    values.push(making.aims());
    let early = making.early().into_iter().flatten();
    let word = |lights: &[LightSums], word: usize| lights.iter().map(|light| light.words()[word]).collect();
    values.extend(early.flat_map(|lights| (0..LIGHT_WORDS).map(move |index| word(lights, index))));
    let named = channels().zip(values);
    named.map(|(name, values)| Words { name: name.to_string(), values }).collect()
}

/// The samples that channels hold, which are those of [`CHANNELS`] in their order, and maybe those of [`EARLY_CHANNELS`].
fn making(
    window: Window,
    start: u32,
    scale: f64,
    judged: Option<Shown>,
    channels: &[Words],
) -> Option<Making> {
    let ([sums @ .., aims], early) = channels.split_at_checked(CHANNELS.len())? else { return None };
    let pixel = |index: usize| Pixel::from_words(words_at(sums, index)?);
    let pixels = (0..window.pixels()).map(pixel).collect::<Option<Vec<Pixel>>>()?;
    let within = |aim: &u32| aim.checked_add(start).is_some_and(|end| end <= MOST_SAMPLES);
    let film = Film::with_pixels(window, scale, pixels).filter(|_| aims.values.iter().all(within))?;
    let making = Making::resumed(film, start, &aims.values, judged)?;
    if early.is_empty() {
        return Some(making);
    }
    let early: Vec<&[Words]> = early.chunks(LIGHT_WORDS).collect();
    making.with_early(|which, index| words_at(early.get(which)?, index))
}

/// The words of a pixel, of as many channels.
fn words_at<const N: usize>(channels: &[Words], index: usize) -> Option<[u32; N]> {
    let mut words = [0; N];
    let (channels, rest) = channels.split_first_chunk::<N>()?;
    for (word, channel) in words.iter_mut().zip(channels) {
        *word = *channel.values.get(index)?;
    }
    rest.is_empty().then_some(words)
}

/// Of texts and whole numbers, each with its name, and of how the picture came about.
fn checksum(channels: &Channels, facts: &Facts) -> String {
    let mut hasher = blake3::Hasher::new();
    let mut text = |text: &str| {
        hasher.update(&(text.len() as u64).to_le_bytes());
        hasher.update(text.as_bytes());
    };
    text(&format!("{facts:?}"));
    for (name, value) in &channels.texts {
        text(name);
        text(value);
    }
    for words in &channels.words {
        hasher.update(words.name.as_bytes());
        for chunk in words.values.chunks(4096) {
            let bytes: Vec<u8> = chunk.iter().flat_map(|word| word.to_le_bytes()).collect();
            hasher.update(&bytes);
        }
    }
    hasher.finalize().to_hex().to_string()
}

#[cfg(test)]
mod tests;
