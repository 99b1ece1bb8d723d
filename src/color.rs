//! Colours: linear, with the primaries and white point of sRGB (ITU-R BT.709, D65).

mod css;

pub use css::css;

use crate::math::{DVec3, exp, exp_m1, pow};

/// Linear red, green and blue.
pub type Rgb = DVec3;

/// The share of each channel in luminance (ITU-R BT.709).
const LUMINANCE: DVec3 = DVec3::new(0.2126, 0.7152, 0.0722);

/// Luminance of a linear colour, in the unit of its channels.
#[inline]
pub fn luminance(color: Rgb) -> f64 {
    color.dot(LUMINANCE)
}

/// Decodes one display-referred channel in [0, 1] (IEC 61966-2-1).
pub fn decode_srgb(v: f64) -> f64 {
    if v <= 0.04045 { v / 12.92 } else { pow((v + 0.055) / 1.055, 2.4) }
}

/// Encodes one linear channel in [0, 1] for display (IEC 61966-2-1).
pub fn encode_srgb(v: f64) -> f64 {
    if v <= 0.0031308 { 12.92 * v } else { 1.055 * pow(v, 1.0 / 2.4) - 0.055 }
}

/// A display-referred colour, decoded to linear.
pub fn srgb(r: f64, g: f64, b: f64) -> Rgb {
    Rgb::new(decode_srgb(r), decode_srgb(g), decode_srgb(b))
}

/// A display-referred colour by hue (in turns), saturation and value.
pub fn hsv(hue: f64, saturation: f64, value: f64) -> Rgb {
    let channel = |offset: f64| {
        let k = (offset + 6.0 * (hue - hue.floor())) % 6.0;
        value - value * saturation * k.min(4.0 - k).clamp(0.0, 1.0)
    };
    srgb(channel(5.0), channel(3.0), channel(1.0))
}

/// Reads `rgb` or `rrggbb`, the digits of a `#` colour.
pub fn from_hex(digits: &str) -> Option<Rgb> {
    if !digits.bytes().all(|b| b.is_ascii_hexdigit()) {
        return None;
    }
    let bits = u32::from_str_radix(digits, 16).ok()?;
    match digits.len() {
        3 => Some(from_bits(0x11 * ((bits & 0xf00) << 8 | (bits & 0xf0) << 4 | bits & 0xf))),
        6 => Some(from_bits(bits)),
        _ => None,
    }
}

/// The colour that `#rrggbb` stands for, from 0xrrggbb.
pub fn from_bits(bits: u32) -> Rgb {
    let [_, r, g, b] = bits.to_be_bytes().map(|channel| f64::from(channel) / 255.0);
    srgb(r, g, b)
}

/// Names of colours that stand in every file, with their display-referred value.
pub const NAMED: &[(&str, &str)] = &[
    ("black", "000000"),
    ("white", "ffffff"),
    ("gray", "808080"),
    ("grey", "808080"),
    ("silver", "c0c0c0"),
    ("red", "ff0000"),
    ("green", "008000"),
    ("blue", "0000ff"),
    ("yellow", "ffff00"),
    ("cyan", "00ffff"),
    ("magenta", "ff00ff"),
    ("orange", "ffa500"),
    ("purple", "800080"),
    ("brown", "a52a2a"),
    ("pink", "ffc0cb"),
];

/// The built-in colour of that name.
pub fn named(name: &str) -> Option<Rgb> {
    NAMED.iter().find(|(known, _)| *known == name).and_then(|(_, hex)| from_hex(hex))
}

/// The colour of a black body at a temperature in kelvins, scaled to luminance 1; negative channels (colours
/// outside sRGB) are cut first. Planck's law is integrated against the CIE 1931 observer, in the multi-lobe
/// fit of Wyman, Sloan and Shirley, "Simple analytic approximations to the CIE XYZ color matching functions",
/// JCGT 2013, at every 5 nm from 380 nm to 780 nm.
pub fn blackbody(kelvin: f64) -> Rgb {
    let lobe = |x: f64, peak: f64, below: f64, above: f64| {
        let t = (x - peak) / if x < peak { below } else { above };
        exp(-0.5 * t * t)
    };
    let observer = |nm: f64| {
        DVec3::new(
            1.056 * lobe(nm, 599.8, 37.9, 31.0) + 0.362 * lobe(nm, 442.0, 16.0, 26.7)
                - 0.065 * lobe(nm, 501.1, 20.4, 26.2),
            0.821 * lobe(nm, 568.8, 46.9, 40.5) + 0.286 * lobe(nm, 530.9, 16.3, 31.1),
            1.217 * lobe(nm, 437.0, 11.8, 36.0) + 0.681 * lobe(nm, 459.0, 26.0, 13.8),
        )
    };
    // Second radiation constant hc/k, in nm·K (CODATA 2018). Relative to the red end, so that nothing overflows.
    const C2: f64 = 1.438_776_877e7;
    const RED: f64 = 780.0;
    let planck = |nm: f64| {
        let ratio = RED / nm;
        let x = C2 / (nm * kelvin);
        let x0 = C2 / (RED * kelvin);
        // (e^x0 − 1) / (e^x − 1), written such that it is finite from the coldest to the hottest.
        ratio * ratio * ratio * ratio * ratio * exp(x0 - x) * exp_m1(-x0) / exp_m1(-x)
    };
    let xyz: DVec3 = (0..=80).map(|i| 380.0 + 5.0 * f64::from(i)).map(|nm| observer(nm) * planck(nm)).sum();
    // XYZ to linear sRGB, IEC 61966-2-1.
    let rgb = Rgb::new(
        3.2406255 * xyz.x - 1.5372080 * xyz.y - 0.4986286 * xyz.z,
        -0.9689307 * xyz.x + 1.8757561 * xyz.y + 0.0415175 * xyz.z,
        0.0557101 * xyz.x - 0.2040211 * xyz.y + 1.0569959 * xyz.z,
    )
    .max(Rgb::ZERO);
    rgb / luminance(rgb)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srgb_round_trips() {
        for i in 0..=255 {
            let v = f64::from(i) / 255.0;
            assert!((encode_srgb(decode_srgb(v)) - v).abs() < 1e-12);
        }
    }

    #[test]
    fn hue_goes_red_green_blue() {
        assert!((hsv(0.0, 1.0, 1.0) - Rgb::X).length() < 1e-12);
        assert!((hsv(1.0 / 3.0, 1.0, 1.0) - Rgb::Y).length() < 1e-12);
        assert!((hsv(-1.0 / 3.0, 1.0, 1.0) - Rgb::Z).length() < 1e-12);
        assert!((hsv(0.3, 0.0, 0.5) - srgb(0.5, 0.5, 0.5)).length() < 1e-12);
    }

    #[test]
    fn a_black_body_at_6500_kelvins_is_nearly_white_and_cooler_ones_are_redder() {
        let white = blackbody(6504.0);
        assert!((white - Rgb::ONE).abs().max_element() < 0.06, "{white}");
        for kelvin in [1.0, 800.0, 1900.0, 3200.0, 1e4, 1e6, 1e300] {
            let color = blackbody(kelvin);
            assert!(color.is_finite() && (luminance(color) - 1.0).abs() < 1e-9, "{kelvin} K: {color}");
        }
        assert!(blackbody(3200.0).x > 1.3 && blackbody(3200.0).z < 0.5);
    }
}
