//! The formats that hold what a display shows: PNG, JPEG, WebP, all in sRGB.

use super::{CannotEncode, Depth, Picture};
use crate::color::Rgb;
use crate::develop::display;
use crate::scene::Tonemap;
use image::ExtendedColorType;
use rayon::prelude::*;

/// JPEG's quality: artefacts are not seen, at a fifth of a PNG's size.
const QUALITY: u8 = 95;

/// A PNG, said to be in sRGB by its `sRGB` chunk.
pub(super) fn png(
    picture: &Picture,
    developing: (f64, Tonemap),
    depth: Depth,
) -> Result<Vec<u8>, CannotEncode> {
    let (bits, bytes) = match depth {
        Depth::Eight => (png::BitDepth::Eight, eight_bits(picture, developing)),
        Depth::Sixteen => (png::BitDepth::Sixteen, sixteen_bits(picture, developing)),
    };
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, picture.size[0], picture.size[1]);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(bits);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let written = encoder.write_header().and_then(|mut writer| writer.write_image_data(&bytes));
    written.map_err(|error| CannotEncode(error.to_string()))?;
    Ok(file)
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
    image::codecs::webp::WebPEncoder::new_lossless(&mut file)
        .encode(&eight_bits(picture, developing), width, height, ExtendedColorType::Rgb8)
        .map_err(|error| CannotEncode(error.to_string()))?;
    Ok(file)
}

/// Red, green and blue of each pixel in a byte each.
fn eight_bits(picture: &Picture, developing: (f64, Tonemap)) -> Vec<u8> {
    developed(picture, developing, |channels| channels.map(|v| [quantise(v, 255) as u8]))
}

/// Red, green and blue of each pixel in two bytes each, the greater first.
fn sixteen_bits(picture: &Picture, developing: (f64, Tonemap)) -> Vec<u8> {
    developed(picture, developing, |channels| channels.map(|v| quantise(v, 65_535).to_be_bytes()))
}

fn developed<const BYTES: usize>(
    picture: &Picture,
    (stops, tonemap): (f64, Tonemap),
    store: impl Fn([f64; 3]) -> [[u8; BYTES]; 3] + Sync,
) -> Vec<u8> {
    let width = picture.size[0] as usize;
    let mut bytes = vec![0; picture.pixels.len() * 3 * BYTES];
    let rows = bytes.par_chunks_mut(width * 3 * BYTES).zip(picture.pixels.par_chunks(width));
    rows.for_each(|(to, from)| {
        for (to, pixel) in to.chunks_exact_mut(3 * BYTES).zip(from) {
            let radiance = Rgb::from_array(pixel.map(f64::from));
            to.copy_from_slice(store(display(radiance, stops, tonemap).to_array()).as_flattened());
        }
    });
    bytes
}

/// The nearest of the steps from 0 to `most`, halves upwards, for a value in [0, 1].
fn quantise(value: f64, most: u16) -> u16 {
    (value * f64::from(most) + 0.5).floor() as u16
}
