use super::*;
use crate::color::encode_srgb;
use crate::math::exp2;

fn sample() -> Picture {
    let radiance = |x: u32, y: u32| {
        Rgb::new(f64::from(x) / 16.0, exp2(f64::from(y) - 6.0), if x == y { -0.25 } else { 0.1 })
    };
    Picture::gather([40, 30], [7, 5], [20, 12], radiance)
}

fn facts() -> Facts {
    Facts {
        samples: Some([64, 128]),
        seed: Some(u64::MAX),
        scene: Some("c0ffee".into()),
        stops: Some(-1.3),
        tonemap: Some(Tonemap::Agx),
        ..Facts::unknown()
    }
}

fn read_png(file: &[u8]) -> (png::OutputInfo, Vec<u8>) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().unwrap();
    assert_eq!(reader.info().srgb, Some(png::SrgbRenderingIntent::Perceptual));
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    (info, bytes)
}

#[test]
fn what_is_transparent_stays_so() {
    let open = sample().with_alpha(|x, y| f64::from(x + y) / 60.0);
    let file = encode(&open, &facts(), Format::Exr, Depth::Eight).unwrap();
    assert_eq!(decode_exr(&file), Ok((open.clone(), facts())));
    for depth in [Depth::Eight, Depth::Sixteen] {
        let (info, bytes) = read_png(&encode(&open, &facts(), Format::Png, depth).unwrap());
        assert_eq!(info.color_type, png::ColorType::Rgba);
        let step = if depth == Depth::Eight { 4 } else { 8 };
        // The first pixel's share is 12 of 60.
        assert_eq!(bytes[step - step / 4], 51);
        // Its colour is that of what covers it, which is five times as bright as the pixel.
        let mut bright = sample();
        bright.pixels.iter_mut().for_each(|pixel| *pixel = pixel.map(|v| v * 5.0));
        let (_, whole) = read_png(&encode(&bright, &facts(), Format::Png, depth).unwrap());
        assert_eq!(bytes[..step - step / 4], whole[..step - step / 4]);
    }
    let webp = encode(&open, &facts(), Format::WebP, Depth::Eight).unwrap();
    let webp = image::load_from_memory_with_format(&webp, image::ImageFormat::WebP).unwrap();
    assert_eq!((webp.color(), webp.to_rgba8()[(0, 0)].0[3]), (image::ColorType::Rgba8, 51));
    for format in [Format::Jpeg, Format::Hdr, Format::Pfm] {
        assert!(format.refuses_alpha().is_some() && encode(&open, &facts(), format, Depth::Eight).is_err());
    }
    // Where all is covered there is nothing to say.
    assert_eq!(sample().with_alpha(|_, _| 1.0), sample());
}

#[test]
fn an_exr_keeps_every_bit_and_all_facts() {
    let file = encode(&sample(), &facts(), Format::Exr, Depth::Eight).unwrap();
    assert_eq!(decode_exr(&file), Ok((sample(), facts())));
    let meta = exr::meta::MetaData::read_from_buffered(&*file, true).unwrap();
    let primaries = meta.headers[0].shared_attributes.chromaticities.unwrap();
    assert_eq!((primaries.red.0, primaries.white.1), (0.64, 0.329));
}

#[test]
fn the_same_picture_is_the_same_file() {
    for (_, format) in EXTENSIONS {
        let once = encode(&sample(), &facts(), *format, Depth::Eight).unwrap();
        for _ in 0..8 {
            assert!(encode(&sample(), &facts(), *format, Depth::Eight).unwrap() == once, "{format:?}");
        }
    }
}

#[test]
fn developing_an_exr_gives_the_bytes_of_the_direct_png() {
    let file = encode(&sample(), &facts(), Format::Exr, Depth::Eight).unwrap();
    let (picture, known) = decode_exr(&file).unwrap();
    for depth in [Depth::Eight, Depth::Sixteen] {
        let direct = encode(&sample(), &facts(), Format::Png, depth).unwrap();
        assert!(encode(&picture, &known, Format::Png, depth).unwrap() == direct);
    }
}

#[test]
fn a_png_holds_the_nearest_steps() {
    let plain = Facts { stops: Some(0.0), tonemap: Some(Tonemap::None), ..Facts::unknown() };
    let picture = sample();
    let expected: Vec<f64> =
        picture.pixels.iter().flatten().map(|&v| encode_srgb(f64::from(v).clamp(0.0, 1.0))).collect();
    let (info, bytes) = read_png(&encode(&picture, &plain, Format::Png, Depth::Eight).unwrap());
    assert_eq!([info.width, info.height], picture.size);
    for (byte, value) in bytes.iter().zip(&expected) {
        assert!((f64::from(*byte) - value * 255.0).abs() <= 0.5, "{byte} {value}");
    }
    let (info, bytes) = read_png(&encode(&picture, &plain, Format::Png, Depth::Sixteen).unwrap());
    assert_eq!(info.bit_depth, png::BitDepth::Sixteen);
    for (pair, value) in bytes.chunks(2).zip(&expected) {
        let step = u16::from_be_bytes([pair[0], pair[1]]);
        assert!((f64::from(step) - value * 65535.0).abs() <= 0.5, "{step} {value}");
    }
}

#[test]
fn hdr_is_near_and_extremes_are_cut() {
    let values = [1e-45, 1e-38, 3e-38, 1e-3, 0.998, 0.999, 1.0, 1.5, 255.5, 1e6, 1.6e38, f32::MAX, 0.0, -3.0];
    let pixels: Vec<[f32; 3]> = values.iter().map(|&v| [v, v * 0.5, 0.0]).collect();
    let size = [values.len() as u32, 1];
    let picture = Picture { size, offset: [0, 0], whole: size, pixels, alpha: None };
    let file = encode(&picture, &facts(), Format::Hdr, Depth::Eight).unwrap();
    let read = image::load_from_memory_with_format(&file, image::ImageFormat::Hdr).unwrap().into_rgb32f();
    for (pixel, &value) in read.pixels().zip(&values) {
        let nearest = value.clamp(0.0, 1.695e38);
        let error = (f64::from(pixel[0]) - f64::from(nearest)).abs();
        assert!(error <= f64::from(nearest) / 250.0 + 1.2e-38, "{value} became {}", pixel[0]);
    }
}

#[test]
fn a_pfm_goes_upwards() {
    let picture = Picture::gather([2, 2], [0, 0], [2, 2], |x, y| Rgb::splat(f64::from(x + 10 * y)));
    let file = encode(&picture, &facts(), Format::Pfm, Depth::Eight).unwrap();
    let floats = file.strip_prefix(b"PF\n2 2\n-1.0\n").unwrap();
    let first: Vec<f32> =
        floats.chunks(4).step_by(3).map(|v| f32::from_le_bytes(v.try_into().unwrap())).collect();
    assert_eq!(first, [10.0, 11.0, 0.0, 1.0]);
}

#[test]
fn webp_and_png_show_the_same_and_jpeg_nearly() {
    let picture = Picture::gather([64, 48], [0, 0], [64, 48], |x, y| {
        Rgb::new(f64::from(x) / 64.0, f64::from(y) / 48.0, 0.3)
    });
    let (_, png) = read_png(&encode(&picture, &facts(), Format::Png, Depth::Eight).unwrap());
    let decode = |format, kind| {
        let file = encode(&picture, &facts(), format, Depth::Eight).unwrap();
        image::load_from_memory_with_format(&file, kind).unwrap().into_rgb8().into_raw()
    };
    assert!(decode(Format::WebP, image::ImageFormat::WebP) == png);
    let jpeg = decode(Format::Jpeg, image::ImageFormat::Jpeg);
    let mean: f64 =
        jpeg.iter().zip(&png).map(|(a, b)| f64::from(a.abs_diff(*b))).sum::<f64>() / png.len() as f64;
    assert!(mean < 1.5, "{mean}");
}

#[test]
fn radiance_beyond_the_range_stays_finite() {
    let strange = [f64::INFINITY, f64::NAN, 1e300, -1e300];
    let picture = Picture::gather([4, 1], [0, 0], [4, 1], |x, _| Rgb::splat(strange[x as usize]));
    let firsts: Vec<f32> = picture.pixels.iter().map(|pixel| pixel[0]).collect();
    assert_eq!(firsts, [f32::MAX, 0.0, f32::MAX, f32::MIN]);
    for (_, format) in EXTENSIONS {
        assert!(encode(&picture, &facts(), *format, Depth::Eight).is_ok(), "{format:?}");
    }
}

#[test]
fn what_is_no_exr_is_refused() {
    let file = encode(&sample(), &facts(), Format::Exr, Depth::Eight).unwrap();
    assert!(decode_exr(b"").is_err());
    assert!(decode_exr(b"not a picture at all").is_err());
    for end in (0..file.len()).step_by(37) {
        assert!(decode_exr(&file[..end]).is_err(), "cut at {end}");
    }
}

#[test]
fn a_picture_too_large_for_a_format_says_so() {
    assert!(Format::WebP.refuses([16_385, 1]).unwrap().to_string().contains("16384"));
    assert!(Format::Jpeg.refuses([65_536, 1]).is_some());
    assert_eq!(Format::Png.refuses([65_536, 1]), None);
    assert_eq!(Format::from_extension("JPeG"), Some(Format::Jpeg));
    assert_eq!(Format::from_extension("gif"), None);
}
