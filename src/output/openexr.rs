//! OpenEXR: scene radiance in 32-bit floats, with how it came about in the attributes.

use super::{
    CannotDecode, CannotEncode, Channels, Facts, Frame, Head, MOST_PIXELS, Picture, Plane, Words, finite,
    share, unless_whole,
};
use crate::scene::Tonemap;
use exr::image::read::specific_channels::ReadSpecificChannel;
use exr::meta::MetaData;
use exr::meta::attribute::{
    AttributeValue, ChannelDescription, Chromaticities, IntegerBounds, LineOrder, SampleType, Text,
};
use exr::meta::header::{ImageAttributes, LayerAttributes};
use exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, Image, Layer, ReadChannels,
    ReadLayers, Vec2, WritableImage, read,
};
use std::io::Cursor;

// Attributes of our own. `exposure` without a prefix would be the standard's exposure time in seconds.
const SAMPLES: &str = "rtc.samples";
const LEAST_SAMPLES: &str = "rtc.samples.least";
const NOISE: &str = "rtc.noise";
const LIMIT: &str = "rtc.limit";
const SEED: &str = "rtc.seed";
const SCENE: &str = "rtc.scene";
const STOPS: &str = "rtc.exposure";
const TONEMAP: &str = "rtc.tonemap";

/// Chromaticities of sRGB's primaries and white (ITU-R BT.709, D65).
const SRGB: Chromaticities = Chromaticities {
    red: Vec2(0.64, 0.33),
    green: Vec2(0.3, 0.6),
    blue: Vec2(0.15, 0.06),
    white: Vec2(0.3127, 0.329),
};

/// A file with the channels R, G, B and, where there is one, A, and whatever else there is. The display window is the whole
/// picture, the data window what was traced of it.
pub(super) fn encode(picture: &Picture, facts: &Facts, channels: Channels) -> Result<Vec<u8>, CannotEncode> {
    let position = Vec2(picture.offset[0] as i32, picture.offset[1] as i32);
    let size = Vec2(picture.size[0] as usize, picture.size[1] as usize);
    let whole = Vec2(picture.whole[0] as usize, picture.whole[1] as usize);
    let mut image = ImageAttributes::new(IntegerBounds::new((0, 0), whole));
    image.chromaticities = Some(SRGB);
    let mut attributes = attributes(facts, position);
    let Channels { planes: more, words, texts } = channels;
    let texts = texts.iter().filter_map(|(name, value)| Some((text(name)?, text(value)?)));
    attributes.other.extend(texts.map(|(name, value)| (name, AttributeValue::Text(value))));
    let layer = Layer::new(size, attributes, ENCODING, planes(picture, more, words));
    let mut file = Cursor::new(Vec::new());
    let written = Image::empty(image).with_layer(layer).write().to_buffered(&mut file);
    written.map_err(|error| CannotEncode(error.to_string()))?;
    let mut file = file.into_inner();
    sort_header(&mut file).ok_or_else(|| CannotEncode("the header just written cannot be read".into()))?;
    Ok(file)
}

/// All channels, in the order of their names, as the format wants them.
fn planes(picture: &Picture, more: Vec<Plane>, words: Vec<Words>) -> AnyChannels<FlatSamples> {
    let color = ["R", "G", "B"].into_iter().enumerate().map(|(channel, name)| {
        let values = picture.pixels.iter().map(|pixel| pixel[channel]).collect();
        AnyChannel::new(name, FlatSamples::F32(values))
    });
    let alpha = picture.alpha.iter().map(|alpha| AnyChannel::new("A", FlatSamples::F32(alpha.clone())));
    let more = more
        .into_iter()
        .filter_map(|plane| Some(AnyChannel::new(text(&plane.name)?, FlatSamples::F32(plane.values))));
    let words = words
        .into_iter()
        .filter_map(|words| Some(AnyChannel::new(text(&words.name)?, FlatSamples::U32(words.values))));
    AnyChannels::sort(color.chain(alpha).chain(more).chain(words).collect())
}

/// Lossless; lines in order, for the same bytes on any number of threads.
const ENCODING: Encoding = Encoding {
    compression: Compression::ZIP16,
    blocks: Blocks::ScanLines,
    line_order: LineOrder::Increasing,
};

fn attributes(facts: &Facts, position: Vec2<i32>) -> LayerAttributes {
    let mut layer = LayerAttributes { software_name: text(&facts.software), ..LayerAttributes::default() };
    layer.layer_position = position;
    // 64 bits do not fit an integer attribute, and a text shows in every viewer.
    let texts = [
        (SAMPLES, facts.samples.map(|[_, most]| most.to_string())),
        (LEAST_SAMPLES, facts.samples.map(|[least, _]| least.to_string())),
        (SEED, facts.seed.map(|n| n.to_string())),
        (SCENE, facts.scene.clone()),
        (LIMIT, facts.limit.clone()),
        (TONEMAP, facts.tonemap.map(|curve| curve.word().to_string())),
    ];
    let texts = texts.into_iter().filter_map(|(name, value)| Some((name, text(&value?)?)));
    layer.other.extend(texts.map(|(name, value)| (Text::from(name), AttributeValue::Text(value))));
    let numbers = [(STOPS, facts.stops), (NOISE, facts.noise)];
    let numbers = numbers.into_iter().filter_map(|(name, value)| Some((Text::from(name), value?)));
    layer.other.extend(numbers.map(|(name, value)| (name, AttributeValue::F64(value))));
    layer
}

fn text(value: &str) -> Option<Text> {
    Text::new_or_none(value)
}

/// Puts the header's attributes into the order of their names: the writer's is that of a hash map, another
/// at each run. None where the bytes are no header.
///
/// Layout (OpenEXR file layout, "Header"): after 8 bytes of magic number and version come the attributes,
/// each a name and a type ended by zero, a 32-bit length and so many bytes; an empty name ends them.
fn sort_header(file: &mut [u8]) -> Option<()> {
    const START: usize = 8;
    let mut entries: Vec<&[u8]> = vec![];
    let mut rest = file.get(START..)?;
    while *rest.first()? != 0 {
        let name = rest.iter().position(|&byte| byte == 0)? + 1;
        let kind = rest.get(name..)?.iter().position(|&byte| byte == 0)? + 1;
        let length = rest.get(name + kind..)?.first_chunk::<4>()?;
        let end = name + kind + 4 + u32::from_le_bytes(*length) as usize;
        let (entry, after) = rest.split_at_checked(end)?;
        entries.push(entry);
        rest = after;
    }
    entries.sort_unstable();
    let sorted = entries.concat();
    file[START..START + sorted.len()].copy_from_slice(&sorted);
    Some(())
}

/// Reads the first layer with channels R, G, B and maybe A, from any program. What is not a number becomes 0, what is
/// infinite the greatest finite value.
pub fn decode(file: &[u8]) -> Result<(Picture, Facts), CannotDecode> {
    refuse_large(file)?;
    decode_colors(file, ["R", "G", "B"], "A")
}

/// The channels of a picture whose noise was taken out, beside the picture as it was traced.
pub const DENOISED: [&str; 3] = ["denoised.R", "denoised.G", "denoised.B"];
/// Its alpha, if it has any.
pub const DENOISED_ALPHA: &str = "denoised.A";

/// The attribute that names what took the noise out.
pub const DENOISED_BY: &str = "rtc.denoised";

/// The picture of the channels [`DENOISED`], which a build shows, and what it was denoised by, as far as that is said; none
/// where these are not.
pub fn decode_denoised(file: &[u8]) -> Result<Option<(Picture, Option<String>)>, CannotDecode> {
    let meta = refuse_large(file)?;
    let has = |name: &str| {
        let mut channels = meta.headers.iter().flat_map(|header| &header.channels.list);
        channels.any(|channel| channel.name.eq(name))
    };
    if !DENOISED.into_iter().all(has) {
        return Ok(None);
    }
    let mut attributes = meta.headers.iter().flat_map(|header| &header.own_attributes.other);
    let by = attributes.find_map(|(name, value)| match value {
        AttributeValue::Text(text) if name.eq(DENOISED_BY) => Some(text.to_string()),
        _ => None,
    });
    decode_colors(file, DENOISED, DENOISED_ALPHA).map(|(picture, _)| Some((picture, by)))
}

/// The picture as a build shows it: without noise where there is that, else as [`decode`] has it.
pub fn decode_shown(file: &[u8]) -> Result<(Picture, Facts), CannotDecode> {
    let (traced, facts) = decode(file)?;
    Ok((decode_denoised(file)?.map_or(traced, |(picture, _)| picture), facts))
}

/// Reads channels of red, green and blue, and of alpha if there is that.
fn decode_colors(file: &[u8], [r, g, b]: [&str; 3], alpha: &str) -> Result<(Picture, Facts), CannotDecode> {
    let refuse = |error: exr::error::Error| CannotDecode(error.to_string());
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .specific_channels()
        .required(r)
        .required(g)
        .required(b)
        .optional(alpha, 1.0)
        .collect_pixels(
            |size, _| (size.width(), vec![[0.0f32; 3]; size.area()], vec![1.0f32; size.area()]),
            |(width, pixels, alpha), at, (r, g, b, a): (f32, f32, f32, f32)| {
                let index = at.y() * *width + at.x();
                pixels[index] = [r, g, b].map(finite);
                alpha[index] = share(a);
            },
        )
        .first_valid_layer()
        .all_attributes()
        .from_buffered(Cursor::new(file))
        .map_err(refuse)?;
    let layer = image.layer_data;
    let display = image.attributes.display_window;
    let (_, pixels, alpha) = layer.channel_data.pixels;
    let offset = layer.attributes.layer_position - display.position;
    let picture = Picture {
        size: [layer.size.x() as u32, layer.size.y() as u32],
        offset: [offset.x().max(0) as u32, offset.y().max(0) as u32],
        whole: [display.size.x() as u32, display.size.y() as u32],
        pixels,
        alpha: unless_whole(alpha),
    };
    Ok((picture, facts(&layer.attributes)))
}

/// What the head of a file of one layer says, from its first bytes alone.
pub fn decode_head(file: &[u8]) -> Result<Head, CannotDecode> {
    let meta = refuse_large(file)?;
    let [header] = meta.headers.as_slice() else {
        return Err(CannotDecode(format!("it has {} layers, and one is wanted", meta.headers.len())));
    };
    let (layer, display) = (&header.own_attributes, header.shared_attributes.display_window);
    let offset = layer.layer_position - display.position;
    let [Ok(x), Ok(y)] = [offset.x(), offset.y()].map(u32::try_from) else {
        return Err(CannotDecode("its pixels lie outside of the picture".into()));
    };
    let texts = layer.other.iter().filter_map(|(name, value)| match value {
        AttributeValue::Text(text) => Some((name.to_string(), text.to_string())),
        _ => None,
    });
    let mut texts: Vec<(String, String)> = texts.collect();
    texts.sort();
    let (words, others) = header.channels.list.iter().partition::<Vec<_>, _>(|channel| {
        channel.sample_type == SampleType::U32 && channel.sampling == Vec2(1, 1)
    });
    let names = |channels: Vec<&ChannelDescription>| {
        channels.into_iter().map(|channel| channel.name.to_string()).collect()
    };
    let frame = Frame {
        size: [header.layer_size.x() as u32, header.layer_size.y() as u32],
        offset: [x, y],
        whole: [display.size.x() as u32, display.size.y() as u32],
    };
    Ok(Head { frame, facts: facts(layer), texts, words: names(words), others: names(others) })
}

/// How many bytes may come of one: deflate repeats 258 bytes by 2 bits at best (RFC 1951, 3.2.5).
const MOST_EXPANSION: u64 = 1032;

/// Reads the channels of whole numbers, by name. All channels are in memory for a moment, so [`decode_head`] should have been
/// asked which there are. A file that is too small for what it claims to hold is refused before.
pub fn decode_words(file: &[u8]) -> Result<Vec<Words>, CannotDecode> {
    for header in &refuse_large(file)?.headers {
        let bytes = (header.layer_size.0 as u64 * header.layer_size.1 as u64)
            .saturating_mul(header.channels.bytes_per_pixel as u64);
        if bytes / MOST_EXPANSION > file.len() as u64 {
            return Err(CannotDecode(format!(
                "its {} bytes cannot hold the {bytes} that it claims",
                file.len()
            )));
        }
    }
    let reader = read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer();
    let image = reader.all_attributes().from_buffered(Cursor::new(file)).map_err(plain)?;
    let words = image.layer_data.channel_data.list.into_iter().filter_map(|channel| {
        let AnyChannel { name, sample_data: FlatSamples::U32(values), .. } = channel else { return None };
        Some(Words { name: name.to_string(), values })
    });
    Ok(words.collect())
}

/// What an EXR begins with.
const MAGIC: &[u8] = &[0x76, 0x2f, 0x31, 0x01];

/// Whether a file begins as an EXR does.
pub fn is_exr(file: &[u8]) -> bool {
    file.starts_with(MAGIC)
}

/// What a file is that is no EXR, by how it begins.
fn kind(file: &[u8]) -> &'static str {
    match file {
        [] => "empty",
        [0x89, b'P', b'N', b'G', ..] => "a PNG",
        [0xff, 0xd8, 0xff, ..] => "a JPEG",
        [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => "a WebP",
        [b'#', b'?', ..] => "a Radiance HDR",
        [b'P', b'F', b'\n', ..] => "a PFM",
        _ if std::str::from_utf8(file).is_ok_and(|text| !text.contains('\0')) => "a text",
        _ => "no EXR",
    }
}

/// What is wrong with an EXR of our own form, in words of our own.
fn plain(error: exr::error::Error) -> CannotDecode {
    CannotDecode(match error {
        exr::error::Error::NotSupported(what) => format!("it is of a form that is not read here: {what}"),
        _ => "it is damaged or cut short".into(),
    })
}

/// Refuses what has too many pixels before any memory is taken for them.
fn refuse_large(file: &[u8]) -> Result<MetaData, CannotDecode> {
    if !is_exr(file) {
        return Err(CannotDecode(format!("it is {}", kind(file))));
    }
    let meta = MetaData::read_from_buffered(Cursor::new(file), false).map_err(plain)?;
    for header in &meta.headers {
        let pixels = header.layer_size.0 as u64 * header.layer_size.1 as u64;
        if pixels > MOST_PIXELS {
            return Err(CannotDecode(format!(
                "it has {pixels} pixels, and at most {MOST_PIXELS} are allowed"
            )));
        }
    }
    Ok(meta)
}

fn facts(layer: &LayerAttributes) -> Facts {
    let text = |name: &str| match layer.other.get(&Text::from(name)) {
        Some(AttributeValue::Text(text)) => Some(text.to_string()),
        _ => None,
    };
    let count = |name: &str| text(name)?.parse().ok();
    let number = |name: &str| match layer.other.get(&Text::from(name)) {
        Some(AttributeValue::F64(number)) if number.is_finite() => Some(*number),
        _ => None,
    };
    Facts {
        software: layer.software_name.as_ref().map_or_else(String::new, Text::to_string),
        samples: count(LEAST_SAMPLES).zip(count(SAMPLES)).map(|(least, most)| [least, most]),
        seed: text(SEED).and_then(|n| n.parse().ok()),
        noise: number(NOISE),
        limit: text(LIMIT),
        scene: text(SCENE),
        stops: number(STOPS),
        tonemap: text(TONEMAP).and_then(|word| Tonemap::from_word(&word)),
    }
}
