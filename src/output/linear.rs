//! The plain formats that hold scene radiance: Radiance's HDR and PFM.

use super::{Facts, Picture};

/// The greatest RGBE value: 255/256 times 2 to the power 127.
const GREATEST: f32 = 255.0 / 256.0 * f32::from_bits(0x7f00_0000);

/// A Radiance picture (Greg Ward, "Real pixels", Graphics Gems II, 1991) with flat scan lines, sRGB's
/// primaries. Negative channels are cut, as are those beyond the format's range.
pub(super) fn hdr(picture: &Picture, facts: &Facts) -> Vec<u8> {
    let [width, height] = picture.size;
    let mut file = format!(
        "#?RADIANCE\nSOFTWARE={}\nPRIMARIES=0.64 0.33 0.3 0.6 0.15 0.06 0.3127 0.329\n\
         FORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n",
        facts.software
    )
    .into_bytes();
    // A flat line that began with 2, 2 would read as a packed one; a shared exponent is as small as can be,
    // so one of the mantissas is at least 128 and the third byte of such a pixel shows that it is flat.
    file.extend(picture.pixels.iter().flat_map(|&pixel| rgbe(pixel)));
    file
}

/// Mantissas of the channels and their shared exponent.
fn rgbe(pixel: [f32; 3]) -> [u8; 4] {
    let [r, g, b] = pixel.map(|v| v.clamp(0.0, GREATEST));
    let exponent = exponent(r.max(g).max(b));
    // Too dark for the format, whose least exponent is −127.
    if exponent < -127 {
        return [0; 4];
    }
    let fit = |exponent: i32| {
        // 2^(8 − exponent), exactly: the exponent is in −127 ..= 127.
        let scale = f64::from_bits(((8 - exponent + 1023) as u64) << 52);
        [r, g, b].map(|v| (f64::from(v) * scale + 0.5).floor())
    };
    let rounded = fit(exponent);
    // Rounding up may carry into the next power of two.
    let carried = rounded.iter().any(|&v| v > 255.0) && exponent < 127;
    let (mantissas, exponent) = if carried { (fit(exponent + 1), exponent + 1) } else { (rounded, exponent) };
    let [r, g, b] = mantissas.map(|v| v.min(255.0) as u8);
    [r, g, b, (exponent + 128) as u8]
}

/// The e with 2^(e−1) ≤ v < 2^e; far below any other for 0 and denormal numbers.
fn exponent(v: f32) -> i32 {
    match (v.to_bits() >> 23) as i32 {
        0 => i32::MIN,
        biased => biased - 126,
    }
}

/// A portable float map: little-endian floats, rows from the bottom.
pub(super) fn pfm(picture: &Picture) -> Vec<u8> {
    let mut file = format!("PF\n{} {}\n-1.0\n", picture.size[0], picture.size[1]).into_bytes();
    for row in picture.rows().rev() {
        file.extend(row.iter().flatten().flat_map(|v| v.to_le_bytes()));
    }
    file
}
