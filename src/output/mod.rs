//! Pictures to the bytes of image files, and back. Everything happens in memory, and nothing but the picture
//! goes into the bytes: no time, no host, so the same picture is always the same file.
//!
//! Two families of formats: those that hold scene radiance ([`Format::is_linear`]), and those that hold the
//! picture as developed for a display. Developing starts from the very `f32` values that the linear formats
//! hold, so an EXR developed later gives the same bytes as a PNG written at once.

pub mod animation;
mod displayed;
mod linear;
mod openexr;

use crate::color::Rgb;
use crate::develop::is_burnt_out;
use crate::scene::Tonemap;
use rayon::prelude::*;
use std::fmt;

pub use openexr::{
    DENOISED, DENOISED_ALPHA, DENOISED_BY, decode as decode_exr, decode_denoised, decode_head, decode_shown,
    decode_words, is_exr,
};

/// The most pixels a picture in memory may have: 16384 × 8192.
pub const MOST_PIXELS: u64 = 1 << 27;

/// Scene radiance on a grid of pixels: a whole picture, or a window cropped out of one.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Where its top left pixel lies in the whole picture, from the whole's top left.
    pub offset: [u32; 2],
    /// Width and height of the whole picture.
    pub whole: [u32; 2],
    /// Linear red, green and blue (sRGB's primaries) in W/(m²·sr), row by row from the top left. Finite.
    /// Where there is an alpha, of what covers the pixel times its share of it (associated alpha).
    pub pixels: Vec<[f32; 3]>,
    /// The share of each pixel that is covered, in [0, 1]; none where all of every pixel is.
    pub alpha: Option<Vec<f32>>,
}

impl Picture {
    /// Collects the window of `size` at `offset` from a function of a pixel's x and y in the whole picture.
    /// What is beyond the range of `f32` becomes its greatest value.
    pub fn gather(
        whole: [u32; 2],
        offset: [u32; 2],
        size: [u32; 2],
        radiance: impl Fn(u32, u32) -> Rgb + Sync,
    ) -> Picture {
        let row = |y| (0..size[0]).map(move |x| (offset[0] + x, offset[1] + y));
        let rows = (0..size[1]).into_par_iter().flat_map_iter(row);
        let pixels = rows.map(|(x, y)| radiance(x, y).to_array().map(|v| finite(v as f32))).collect();
        Picture { size, offset, whole, pixels, alpha: None }
    }

    /// The same with the share of each pixel that is covered.
    pub fn with_alpha(self, alpha: impl Fn(u32, u32) -> f64 + Sync) -> Picture {
        let Picture { size, offset, .. } = self;
        let row = |y| (0..size[0]).map(move |x| (offset[0] + x, offset[1] + y));
        let rows = (0..size[1]).into_par_iter().flat_map_iter(row);
        let alpha = rows.map(|(x, y)| share(alpha(x, y) as f32)).collect();
        Picture { alpha: unless_whole(alpha), ..self }
    }

    /// The share of the pixels that [`is_burnt_out`].
    pub fn burnt_out(&self, stops: f64, tonemap: Tonemap) -> f64 {
        let burnt = |pixel: &&[f32; 3]| is_burnt_out(Rgb::from_array(pixel.map(f64::from)), stops, tonemap);
        self.pixels.iter().filter(burnt).count() as f64 / self.pixels.len().max(1) as f64
    }

    /// Rows of pixels from the top.
    fn rows(&self) -> impl DoubleEndedIterator<Item = &[[f32; 3]]> {
        self.pixels.chunks_exact(self.size[0] as usize)
    }
}

/// What is not a number is nothing; what is too large is the largest.
fn finite(v: f32) -> f32 {
    if v.is_nan() { 0.0 } else { v.clamp(f32::MIN, f32::MAX) }
}

/// The shares of pixels that are covered, unless all of every pixel is.
fn unless_whole(alpha: Vec<f32>) -> Option<Vec<f32>> {
    alpha.iter().any(|&share| share < 1.0).then_some(alpha)
}

/// A share of a whole; what is not a number is none.
fn share(v: f32) -> f32 {
    if v.is_nan() { 0.0 } else { v.clamp(0.0, 1.0) }
}

/// What an EXR holds beside its picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Channels {
    /// Further channels.
    pub planes: Vec<Plane>,
    /// Further channels of whole numbers.
    pub words: Vec<Words>,
    /// Further attributes, each a name and a text in ASCII.
    pub texts: Vec<(String, String)>,
}

/// A channel of 32-bit whole numbers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Words {
    /// With the layer before a dot: `sums.samples`.
    pub name: String,
    /// A value for each pixel of the picture, row by row from the top left.
    pub values: Vec<u32>,
}

/// Where the pixels of a picture lie: see [`Picture`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Where its top left pixel lies in the whole picture.
    pub offset: [u32; 2],
    /// Width and height of the whole picture.
    pub whole: [u32; 2],
}

/// What the head of an EXR says.
#[derive(Clone, Debug, PartialEq)]
pub struct Head {
    /// Where its pixels lie.
    pub frame: Frame,
    /// How the picture came about.
    pub facts: Facts,
    /// The attributes that are texts, by their names.
    pub texts: Vec<(String, String)>,
    /// The names of the channels of whole numbers.
    pub words: Vec<String>,
    /// Those of all others.
    pub others: Vec<String>,
}

/// A channel of 32-bit floats.
#[derive(Clone, Debug, PartialEq)]
pub struct Plane {
    /// With the layer before a dot: `normal.X`.
    pub name: String,
    /// A value for each pixel of the picture, row by row from the top left.
    pub values: Vec<f32>,
}

/// How a picture came about: kept in the attributes of an EXR.
#[derive(Clone, Debug, PartialEq)]
pub struct Facts {
    /// The program and its version.
    pub software: String,
    /// The least and the most samples of a pixel.
    pub samples: Option<[u32; 2]>,
    /// The noise, as a share of white.
    pub noise: Option<f64>,
    /// What it stopped at: samples, noise or time.
    pub limit: Option<String>,
    /// What chose the random numbers.
    pub seed: Option<u64>,
    /// The scene's canonical hash in hexadecimal.
    pub scene: Option<String>,
    /// Stops the picture is developed at.
    pub stops: Option<f64>,
    /// The curve it is developed with.
    pub tonemap: Option<Tonemap>,
}

impl Facts {
    /// Nothing known but the program that writes.
    pub fn unknown() -> Facts {
        let software = format!("rtc {}", env!("CARGO_PKG_VERSION"));
        Facts {
            software,
            samples: None,
            noise: None,
            limit: None,
            seed: None,
            scene: None,
            stops: None,
            tonemap: None,
        }
    }

    /// What a picture is developed with where nothing is said: as it is, with the language's default curve.
    fn developing(&self) -> (f64, Tonemap) {
        (self.stops.unwrap_or(0.0), self.tonemap.unwrap_or(Tonemap::Neutral))
    }
}

/// A format of image files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Developed, lossless, 8 or 16 bits a channel.
    Png,
    /// Scene radiance in 32-bit floats.
    Exr,
    /// Scene radiance as RGBE: a shared exponent, 8 bits a channel.
    Hdr,
    /// Scene radiance in 32-bit floats, without any facts.
    Pfm,
    /// Developed, lossy, quality 95.
    Jpeg,
    /// Developed, lossless, 8 bits a channel.
    WebP,
}

/// Every extension with its format, the one to recommend first.
const EXTENSIONS: &[(&str, Format)] = &[
    ("png", Format::Png),
    ("exr", Format::Exr),
    ("jpg", Format::Jpeg),
    ("jpeg", Format::Jpeg),
    ("webp", Format::WebP),
    ("hdr", Format::Hdr),
    ("pfm", Format::Pfm),
];

impl Format {
    /// The format that a file's extension names, in either case.
    pub fn from_extension(extension: &str) -> Option<Format> {
        let known = EXTENSIONS.iter().find(|(name, _)| name.eq_ignore_ascii_case(extension));
        known.map(|(_, format)| *format)
    }

    /// Every extension that is known.
    pub fn extensions() -> impl Iterator<Item = &'static str> {
        EXTENSIONS.iter().map(|(name, _)| *name)
    }

    /// Whether it holds scene radiance, before exposure and tone mapping.
    pub fn is_linear(self) -> bool {
        matches!(self, Format::Exr | Format::Hdr | Format::Pfm)
    }

    /// Why a transparent picture cannot be held, if it cannot.
    pub fn refuses_alpha(self) -> Option<CannotEncode> {
        let name = match self {
            Format::Png | Format::WebP | Format::Exr => return None,
            Format::Jpeg => "JPEG",
            Format::Hdr => "HDR",
            Format::Pfm => "PFM",
        };
        Some(CannotEncode(format!("{name} cannot be transparent; PNG, WebP and EXR can")))
    }

    /// Why a picture of this size cannot be held, if it cannot.
    pub fn refuses(self, size: [u32; 2]) -> Option<CannotEncode> {
        let (name, most) = match self {
            Format::WebP => ("WebP", 16_384),
            Format::Jpeg => ("JPEG", 65_535),
            _ => return None,
        };
        let reason =
            format!("{name} holds at most {most} pixels a side, this picture is {}×{}", size[0], size[1]);
        size.iter().any(|&side| side > most).then_some(CannotEncode(reason))
    }
}

/// Bits a channel where the format leaves a choice.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Depth {
    /// 256 steps.
    #[default]
    Eight,
    /// 65536 steps.
    Sixteen,
}

/// Why a picture did not become bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CannotEncode(String);

impl fmt::Display for CannotEncode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// Why bytes did not become a picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CannotDecode(String);

impl fmt::Display for CannotDecode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// The bytes of an image file. `depth` matters to PNG alone.
pub fn encode(
    picture: &Picture,
    facts: &Facts,
    format: Format,
    depth: Depth,
) -> Result<Vec<u8>, CannotEncode> {
    let transparent = picture.alpha.as_ref().and_then(|_| format.refuses_alpha());
    if let Some(reason) = format.refuses(picture.size).or(transparent) {
        return Err(reason);
    }
    match format {
        Format::Png => displayed::png(picture, facts.developing(), depth),
        Format::Jpeg => displayed::jpeg(picture, facts.developing()),
        Format::WebP => displayed::webp(picture, facts.developing()),
        Format::Exr => openexr::encode(picture, facts, Channels::default()),
        Format::Hdr => Ok(linear::hdr(picture, facts)),
        Format::Pfm => Ok(linear::pfm(picture)),
    }
}

/// The bytes of an EXR with more than the picture.
pub fn encode_exr(picture: &Picture, facts: &Facts, channels: Channels) -> Result<Vec<u8>, CannotEncode> {
    openexr::encode(picture, facts, channels)
}

#[cfg(test)]
mod tests;
