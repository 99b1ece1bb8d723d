//! Pictures: PNG, JPEG, WebP, Radiance HDR and OpenEXR to linear colours.
//!
//! The format is told by the first bytes, not by the name. Values of 8 and 16 bits are taken as display-referred
//! with sRGB's curve, floats as linear; embedded profiles and gamma are not looked at.

use crate::color::{Rgb, decode_srgb};
use crate::math::DVec3;
use exr::prelude::{MetaData, ReadChannels, ReadLayers, read};
use image::ImageDecoder;
use image::codecs::{hdr::HdrDecoder, webp::WebPDecoder};
use serde::{Serialize, Serializer};
use std::fmt;
use std::io::Cursor;
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::{bytestream::ZCursor, colorspace::ColorSpace, options::DecoderOptions};

/// The most pixels one picture may have: 8192 × 4096.
pub const MAX_PIXELS: u64 = 1 << 25;

/// A picture in linear colours with sRGB's primaries. Two are equal if their pixels are, which is told by a hash.
pub struct Image {
    width: u32,
    height: u32,
    /// Row by row from the top, each from the left; finite and not negative.
    pixels: Box<[[f32; 3]]>,
    mean: Rgb,
    peak: f64,
    hash: blake3::Hash,
}

/// Why bytes are no picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ImageError {
    /// None of the formats begins like this.
    Unknown,
    /// More than [`MAX_PIXELS`], or none.
    Size(u64, u64),
    /// In the words of the format's reader.
    Broken(&'static str, String),
    /// The pixel at this column and row is not wholly opaque.
    Transparent(usize, usize),
    /// The pixel at this column and row has a channel that is negative or not finite.
    NoColor(usize, usize),
}

impl Image {
    /// A picture of pixels in rows from the top, each from the left.
    ///
    /// # Errors
    ///
    /// If there are none, too many, or one that is no colour.
    ///
    /// # Panics
    ///
    /// If there are not `width` × `height` of them.
    pub fn new(width: u32, height: u32, pixels: Vec<[f32; 3]>) -> Result<Image, ImageError> {
        check_size(width, height)?;
        assert_eq!(pixels.len() as u64, u64::from(width) * u64::from(height));
        let mut hasher = blake3::Hasher::new();
        let (mut mean, mut peak) = (Rgb::ZERO, 0.0f32);
        for (y, row) in pixels.chunks(width as usize).enumerate() {
            let mut bytes = Vec::with_capacity(12 * row.len());
            let mut sum = Rgb::ZERO;
            for (x, pixel) in row.iter().enumerate() {
                if !pixel.iter().all(|channel| (0.0..=f32::MAX).contains(channel)) {
                    return Err(ImageError::NoColor(x, y));
                }
                sum += color(*pixel);
                peak = pixel.iter().copied().fold(peak, f32::max);
                pixel.iter().for_each(|channel| bytes.extend(channel.to_le_bytes()));
            }
            mean += sum / f64::from(width);
            hasher.update(&bytes);
        }
        mean /= f64::from(height);
        let (pixels, peak) = (pixels.into_boxed_slice(), f64::from(peak));
        Ok(Image { width, height, pixels, mean, peak, hash: hasher.finalize() })
    }

    /// Reads a file of any of the formats.
    ///
    /// # Errors
    ///
    /// If it is none of them, broken, too large, or holds pixels that are no colour or not opaque.
    pub fn decode(file: &[u8]) -> Result<Image, ImageError> {
        match file {
            [0x89, b'P', b'N', b'G', ..] => decode_png(file),
            [0xff, 0xd8, 0xff, ..] => decode_jpeg(file),
            [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => decode_webp(file),
            [b'#', b'?', ..] => decode_hdr(file),
            [0x76, 0x2f, 0x31, 0x01, ..] => decode_exr(file),
            _ => Err(ImageError::Unknown),
        }
    }

    /// Pixels across.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Pixels down.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// How many pixels it has.
    pub fn pixels(&self) -> u64 {
        self.pixels.len() as u64
    }

    /// The colour of a pixel, counted from the left and the top.
    pub fn pixel(&self, x: u32, y: u32) -> Rgb {
        color(self.pixels[y as usize * self.width as usize + x as usize])
    }

    /// Of its pixels.
    pub fn hash(&self) -> blake3::Hash {
        self.hash
    }

    /// The mean of all pixels.
    pub fn mean(&self) -> Rgb {
        self.mean
    }

    /// The greatest channel of any pixel.
    pub fn peak(&self) -> f64 {
        self.peak
    }
}

fn color([r, g, b]: [f32; 3]) -> Rgb {
    DVec3::new(f64::from(r), f64::from(g), f64::from(b))
}

fn check_size(width: u32, height: u32) -> Result<(), ImageError> {
    let size = (u64::from(width), u64::from(height));
    let fits = (1..=MAX_PIXELS).contains(&(size.0 * size.1));
    if fits { Ok(()) } else { Err(ImageError::Size(size.0, size.1)) }
}

fn decode_png(file: &[u8]) -> Result<Image, ImageError> {
    let broken = |error: png::DecodingError| ImageError::Broken("PNG", error.to_string());
    let limits = png::Limits { bytes: 8 * MAX_PIXELS as usize };
    let mut decoder = png::Decoder::new_with_limits(Cursor::new(file), limits);
    // Palettes become colours, small depths 8 bits, a transparent colour an alpha channel.
    decoder.set_transformations(png::Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(broken)?;
    check_size(reader.info().width, reader.info().height)?;
    let size = reader.output_buffer_size().ok_or(ImageError::Broken("PNG", "is too large".into()))?;
    let mut bytes = vec![0; size];
    let info = reader.next_frame(&mut bytes).map_err(broken)?;
    bytes.truncate(info.buffer_size());
    let channels = info.color_type.samples();
    match info.bit_depth {
        png::BitDepth::Sixteen => {
            let table = decoding_table(u16::MAX);
            let value = |pair: &[u8]| table[usize::from(u16::from_be_bytes([pair[0], pair[1]]))];
            from_channels(info.width, info.height, bytes.chunks_exact(2).map(value), channels)
        }
        _ => from_bytes(info.width, info.height, &bytes, channels),
    }
}

fn decode_jpeg(file: &[u8]) -> Result<Image, ImageError> {
    let broken = |error: zune_jpeg::errors::DecodeErrors| ImageError::Broken("JPEG", error.to_string());
    // Without the instructions of one processor the pixels are the same on each; what is cut short is refused.
    let options = DecoderOptions::default()
        .set_use_unsafe(false)
        .set_strict_mode(true)
        .jpeg_set_out_colorspace(ColorSpace::RGB);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(file), options);
    decoder.decode_headers().map_err(broken)?;
    let (width, height) = decoder.dimensions().unwrap_or((0, 0));
    let (width, height) = (width as u32, height as u32);
    check_size(width, height)?;
    let bytes = decoder.decode().map_err(broken)?;
    from_bytes(width, height, &bytes, 3)
}

fn decode_webp(file: &[u8]) -> Result<Image, ImageError> {
    let broken = |error: image::ImageError| ImageError::Broken("WebP", error.to_string());
    let decoder = WebPDecoder::new(Cursor::new(file)).map_err(broken)?;
    let (width, height) = decoder.dimensions();
    check_size(width, height)?;
    let channels = usize::from(decoder.color_type().channel_count());
    let mut bytes = vec![0; width as usize * height as usize * channels];
    decoder.read_image(&mut bytes).map_err(broken)?;
    from_bytes(width, height, &bytes, channels)
}

fn decode_hdr(file: &[u8]) -> Result<Image, ImageError> {
    let broken = |error: image::ImageError| ImageError::Broken("HDR", error.to_string());
    let decoder = HdrDecoder::new(Cursor::new(file)).map_err(broken)?;
    let (width, height) = decoder.dimensions();
    check_size(width, height)?;
    let mut bytes = vec![0; 12 * width as usize * height as usize];
    decoder.read_image(&mut bytes).map_err(broken)?;
    let value = |word: &[u8]| f32::from_ne_bytes([word[0], word[1], word[2], word[3]]);
    from_channels(width, height, bytes.chunks_exact(4).map(value), 3)
}

fn decode_exr(file: &[u8]) -> Result<Image, ImageError> {
    let broken = |error: exr::error::Error| ImageError::Broken("EXR", error.to_string());
    let meta = MetaData::read_from_buffered(Cursor::new(file), false).map_err(broken)?;
    for header in &meta.headers {
        let clamp = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
        check_size(clamp(header.layer_size.0), clamp(header.layer_size.1))?;
    }
    let picture = read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            |size, _| (size.width(), vec![[0.0f32; 3]; size.area()]),
            |(width, pixels), at, (r, g, b): (f32, f32, f32)| pixels[at.y() * *width + at.x()] = [r, g, b],
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(file))
        .map_err(broken)?;
    let layer = picture.layer_data;
    Image::new(layer.size.x() as u32, layer.size.y() as u32, layer.channel_data.pixels.1)
}

/// Linear values of all codes of a display-referred channel.
fn decoding_table(most: u16) -> Vec<f32> {
    (0..=most).map(|code| decode_srgb(f64::from(code) / f64::from(most)) as f32).collect()
}

/// Pixels of channels of a byte each, display-referred.
fn from_bytes(width: u32, height: u32, bytes: &[u8], channels: usize) -> Result<Image, ImageError> {
    let table = decoding_table(255);
    from_channels(width, height, bytes.iter().map(|byte| table[usize::from(*byte)]), channels)
}

/// Pixels of one (grey), two (grey, alpha), three or four channels. The opaque has the value 1, curve or not. The values
/// are taken one by one, for a picture may be large.
fn from_channels(
    width: u32,
    height: u32,
    mut values: impl ExactSizeIterator<Item = f32>,
    channels: usize,
) -> Result<Image, ImageError> {
    let count = width as usize * height as usize;
    if values.len() != count * channels || !(1..=4).contains(&channels) {
        return Err(ImageError::Broken("picture", "has another size than it says".into()));
    }
    let mut pixels = Vec::with_capacity(count);
    for index in 0..count {
        let mut pixel = [0.0; 4];
        pixel[..channels].iter_mut().zip(&mut values).for_each(|(channel, value)| *channel = value);
        let (color, alpha) = match pixel[..channels] {
            [grey] => ([grey; 3], 1.0),
            [grey, alpha] => ([grey; 3], alpha),
            [r, g, b] => ([r, g, b], 1.0),
            [r, g, b, alpha, ..] => ([r, g, b], alpha),
            [] => ([0.0; 3], 1.0),
        };
        if alpha != 1.0 {
            return Err(ImageError::Transparent(index % width as usize, index / width as usize));
        }
        pixels.push(color);
    }
    Image::new(width, height, pixels)
}

impl fmt::Display for ImageError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ImageError::Unknown => formatter.write_str("is no PNG, JPEG, WebP, HDR or EXR"),
            ImageError::Size(width, height) => {
                write!(formatter, "has {width} × {height} pixels, and 1 to {MAX_PIXELS} are allowed")
            }
            ImageError::Broken(format, why) => write!(formatter, "is a broken {format}: {why}"),
            ImageError::Transparent(x, y) => {
                write!(formatter, "has transparent pixels, first at column {x}, row {y}")
            }
            ImageError::NoColor(x, y) => {
                write!(formatter, "has pixels that are negative or not finite, first at column {x}, row {y}")
            }
        }
    }
}

impl fmt::Debug for Image {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "Image({} × {}, {})", self.width, self.height, self.hash)
    }
}

impl PartialEq for Image {
    fn eq(&self, other: &Image) -> bool {
        (self.width, self.height, self.hash) == (other.width, other.height, other.hash)
    }
}

/// By its hash: a scene's own hash stays cheap.
impl Serialize for Image {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        (self.width, self.height, self.hash.as_bytes()).serialize(serializer)
    }
}

#[cfg(test)]
mod tests;
