use super::*;
use ::image::codecs::hdr::HdrEncoder;
use ::image::codecs::jpeg::JpegEncoder;
use ::image::codecs::webp::WebPEncoder;
use ::image::{ExtendedColorType, Rgb as Float};

/// A PNG of so many channels and bits.
fn png(size: [u32; 2], color: png::ColorType, depth: png::BitDepth, data: &[u8]) -> Vec<u8> {
    let mut file = vec![];
    let mut encoder = png::Encoder::new(&mut file, size[0], size[1]);
    encoder.set_color(color);
    encoder.set_depth(depth);
    if color == png::ColorType::Indexed {
        encoder.set_palette(vec![0, 0, 0, 255, 0, 0, 0, 255, 0, 0, 0, 255]);
    }
    encoder.write_header().unwrap().write_image_data(data).unwrap();
    file
}

fn eight(size: [u32; 2], color: png::ColorType, data: &[u8]) -> Result<Image, ImageError> {
    Image::decode(&png(size, color, png::BitDepth::Eight, data))
}

fn jpeg() -> Vec<u8> {
    let mut file = vec![];
    let mut encoder = JpegEncoder::new_with_quality(&mut file, 100);
    encoder.encode(&[[200u8, 100, 50]; 64 * 32].concat(), 64, 32, ExtendedColorType::Rgb8).unwrap();
    file
}

fn webp() -> Vec<u8> {
    let mut file = vec![];
    let pixels = [[255u8, 0, 0], [0, 128, 255]].concat();
    WebPEncoder::new_lossless(&mut file).encode(&pixels, 2, 1, ExtendedColorType::Rgb8).unwrap();
    file
}

fn hdr() -> Vec<u8> {
    let mut file = vec![];
    HdrEncoder::new(&mut file).encode(&[Float([4.0, 2.0, 0.5]), Float([0.0, 0.0, 0.0])], 2, 1).unwrap();
    file
}

fn exr(pixels: [[f32; 3]; 2]) -> Vec<u8> {
    let mut file = vec![];
    let channels = exr::image::SpecificChannels::rgb(|at: exr::math::Vec2<usize>| {
        let [r, g, b] = pixels[at.x()];
        (r, g, b)
    });
    use exr::prelude::WritableImage;
    exr::prelude::Image::from_channels((2, 1), channels).write().to_buffered(Cursor::new(&mut file)).unwrap();
    file
}

#[test]
fn every_kind_of_png_becomes_linear_colours() {
    use png::{BitDepth, ColorType};
    let image = eight([2, 1], ColorType::Rgb, &[255, 0, 51, 128, 128, 128]).unwrap();
    assert_eq!((image.width(), image.height(), image.pixels()), (2, 1, 2));
    assert!((image.pixel(0, 0) - DVec3::new(1.0, 0.0, decode_srgb(0.2))).length() < 1e-7);
    assert!((image.pixel(1, 0) - DVec3::splat(decode_srgb(128.0 / 255.0))).length() < 1e-7);
    assert_eq!(image.peak(), 1.0);
    let grey = eight([1, 2], ColorType::Grayscale, &[255, 0]).unwrap();
    assert_eq!(
        (grey.pixel(0, 0), grey.pixel(0, 1), grey.mean()),
        (DVec3::ONE, DVec3::ZERO, DVec3::splat(0.5))
    );
    let palette = Image::decode(&png([3, 1], ColorType::Indexed, BitDepth::Two, &[0b01_10_11_00])).unwrap();
    assert_eq!([0, 1, 2].map(|x| palette.pixel(x, 0)), [DVec3::X, DVec3::Y, DVec3::Z]);
    let deep = Image::decode(&png([1, 1], ColorType::Grayscale, BitDepth::Sixteen, &[0x80, 0x00])).unwrap();
    assert!((deep.pixel(0, 0).x - decode_srgb(32768.0 / 65535.0)).abs() < 1e-7);
    let opaque = eight([1, 1], ColorType::Rgba, &[255, 255, 255, 255]).unwrap();
    assert_eq!(opaque.pixel(0, 0), DVec3::ONE);
    let clear = eight([2, 2], ColorType::GrayscaleAlpha, &[9, 255, 9, 255, 9, 255, 9, 254]);
    assert_eq!(clear, Err(ImageError::Transparent(1, 1)));
}

#[test]
fn the_other_formats_become_linear_colours() {
    let image = Image::decode(&jpeg()).unwrap();
    assert_eq!((image.width(), image.height()), (64, 32));
    let expected = DVec3::new(200.0, 100.0, 50.0).map(|v| decode_srgb(v / 255.0));
    assert!((image.pixel(40, 20) - expected).length() < 0.02, "{}", image.pixel(40, 20));
    let image = Image::decode(&webp()).unwrap();
    assert_eq!(image.pixel(0, 0), DVec3::X);
    let image = Image::decode(&hdr()).unwrap();
    assert!((image.pixel(0, 0) - DVec3::new(4.0, 2.0, 0.5)).length() < 0.03);
    let image = Image::decode(&exr([[1000.0, 0.25, 0.0], [1.0; 3]])).unwrap();
    assert_eq!((image.pixel(0, 0), image.peak()), (DVec3::new(1000.0, 0.25, 0.0), 1000.0));
}

#[test]
fn what_is_no_colour_is_refused() {
    for bad in [f32::NAN, f32::INFINITY, -0.25] {
        assert_eq!(Image::decode(&exr([[1.0; 3], [0.0, bad, 0.0]])), Err(ImageError::NoColor(1, 0)));
    }
    assert!(matches!(Image::new(0, 3, vec![]), Err(ImageError::Size(0, 3))));
}

#[test]
fn a_size_that_only_the_header_claims_is_refused() {
    let mut file = png([1, 1], png::ColorType::Grayscale, png::BitDepth::Eight, &[0]);
    // Width and height stand behind the signature, the length and the name of the first chunk; then its checksum.
    file[16..24].copy_from_slice(&[0, 1, 0, 0, 0, 1, 0, 0]);
    let sum = crc(&file[12..29]);
    file[29..33].copy_from_slice(&sum.to_be_bytes());
    assert_eq!(Image::decode(&file), Err(ImageError::Size(65536, 65536)));
    let radiance = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1000000 +X 1000000\n";
    assert!(matches!(Image::decode(radiance), Err(ImageError::Size(..))));
}

/// The checksum of PNG chunks (ISO 3309).
fn crc(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0u32, |sum, byte| {
        (0..8).fold(sum ^ u32::from(*byte), |sum, _| (sum >> 1) ^ (0xedb8_8320 & (sum & 1).wrapping_neg()))
    })
}

#[test]
fn files_cut_short_or_spoilt_are_refused_or_read_but_never_more() {
    assert_eq!(Image::decode(b""), Err(ImageError::Unknown));
    assert_eq!(Image::decode(b"GIF89a"), Err(ImageError::Unknown));
    let png = png([2, 2], png::ColorType::Rgb, png::BitDepth::Eight, &[7; 12]);
    for file in [png, jpeg(), webp(), hdr(), exr([[1.0; 3]; 2])] {
        let whole = Image::decode(&file).unwrap();
        for end in 0..file.len() {
            // What is cut off may be empty, but a picture that is told to be one is the same.
            if let Ok(image) = Image::decode(&file[..end]) {
                assert_eq!(image, whole, "{end} of {}", file.len());
            }
        }
        for at in 0..file.len() {
            let mut spoilt = file.clone();
            spoilt[at] ^= 0x55;
            let _ = Image::decode(&spoilt);
        }
    }
}

#[test]
fn equal_pixels_are_equal_pictures() {
    let a = Image::new(2, 1, vec![[0.0; 3], [1.0; 3]]).unwrap();
    let b = Image::new(1, 2, vec![[0.0; 3], [1.0; 3]]).unwrap();
    let c = Image::new(2, 1, vec![[0.0; 3], [1.0, 1.0, 0.5]]).unwrap();
    assert_eq!(a, Image::new(2, 1, vec![[0.0; 3], [1.0; 3]]).unwrap());
    assert!(a != b && a != c);
}
