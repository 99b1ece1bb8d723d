//! The formats that hold what a display shows: PNG, JPEG, WebP, all in sRGB.

use super::{CannotEncode, Depth, Picture};
use crate::color::Rgb;
use crate::develop::display;
use crate::scene::Tonemap;
use image::ExtendedColorType;
use rayon::prelude::*;
use std::io::Write;

/// JPEG's quality: artefacts are not seen, at a fifth of a PNG's size.
const QUALITY: u8 = 95;

/// A PNG, said to be in sRGB by its `sRGB` chunk.
pub(super) fn png(
    picture: &Picture,
    developing: (f64, Tonemap),
    depth: Depth,
) -> Result<Vec<u8>, CannotEncode> {
    let bytes = match depth {
        Depth::Eight => eight_bits(picture, developing),
        Depth::Sixteen => sixteen_bits(picture, developing),
    };
    let mut file = Vec::new();
    let encoder = png_encoder(&mut file, picture.size, picture.alpha.is_some(), depth);
    let written = encoder.write_header().and_then(|mut writer| writer.write_image_data(&bytes));
    written.map_err(|error| CannotEncode(error.to_string()))?;
    Ok(file)
}

/// What writes a PNG in sRGB.
pub(super) fn png_encoder<W: Write>(
    to: W,
    [width, height]: [u32; 2],
    alpha: bool,
    depth: Depth,
) -> png::Encoder<'static, W> {
    let mut encoder = png::Encoder::new(to, width, height);
    encoder.set_color(if alpha { png::ColorType::Rgba } else { png::ColorType::Rgb });
    encoder.set_depth(match depth {
        Depth::Eight => png::BitDepth::Eight,
        Depth::Sixteen => png::BitDepth::Sixteen,
    });
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    encoder
}

/// A JPEG; without a profile it is in sRGB by convention.
pub(super) fn jpeg(picture: &Picture, developing: (f64, Tonemap)) -> Result<Vec<u8>, CannotEncode> {
    let mut file = Vec::new();
    let [width, height] = picture.size;
    image::codecs::jpeg::JpegEncoder::new_with_quality(&mut file, QUALITY)
        .encode(&eight_bits(picture, developing), width, height, ExtendedColorType::Rgb8)
        .map_err(|error| CannotEncode(error.to_string()))?;
    Ok(file)
}

/// A lossless WebP; in sRGB by definition.
pub(super) fn webp(picture: &Picture, developing: (f64, Tonemap)) -> Result<Vec<u8>, CannotEncode> {
    let mut file = Vec::new();
    let [width, height] = picture.size;
    let color = if picture.alpha.is_some() { ExtendedColorType::Rgba8 } else { ExtendedColorType::Rgb8 };
    image::codecs::webp::WebPEncoder::new_lossless(&mut file)
        .encode(&eight_bits(picture, developing), width, height, color)
        .map_err(|error| CannotEncode(error.to_string()))?;
    Ok(file)
}

/// Red, green, blue and, where there is one, alpha of each pixel in a byte each.
pub(super) fn eight_bits(picture: &Picture, developing: (f64, Tonemap)) -> Vec<u8> {
    developed(picture, developing, |v| [quantise(v, 255) as u8])
}

/// Red, green, blue and, where there is one, alpha of each pixel in two bytes each, the greater first.
pub(super) fn sixteen_bits(picture: &Picture, developing: (f64, Tonemap)) -> Vec<u8> {
    developed(picture, developing, |v| quantise(v, 65_535).to_be_bytes())
}

fn developed<const BYTES: usize>(
    picture: &Picture,
    (stops, tonemap): (f64, Tonemap),
    store: impl Fn(f64) -> [u8; BYTES] + Sync,
) -> Vec<u8> {
    let channels = if picture.alpha.is_some() { 4 } else { 3 };
    let mut bytes = vec![0; picture.pixels.len() * channels * BYTES];
    bytes.par_chunks_exact_mut(channels * BYTES).zip(picture.pixels.par_iter()).enumerate().for_each(
        |(i, (to, pixel))| {
            let alpha = picture.alpha.as_ref().map_or(1.0, |alpha| f64::from(alpha[i]));
            // What covers the pixel is developed by itself, as these formats hold it (unassociated alpha).
            let whole = if alpha > 0.0 { 1.0 / alpha } else { 1.0 };
            let radiance = whole * Rgb::from_array(pixel.map(f64::from));
            let [r, g, b] = display(radiance, stops, tonemap).to_array();
            for (to, value) in to.chunks_exact_mut(BYTES).zip([r, g, b, alpha]) {
                to.copy_from_slice(&store(value));
            }
        },
    );
    bytes
}

/// The nearest of the steps from 0 to `most`, halves upwards, for a value in [0, 1].
fn quantise(value: f64, most: u16) -> u16 {
    (value * f64::from(most) + 0.5).floor() as u16
}
