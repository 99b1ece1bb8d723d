//! Developing: from scene radiance to what a display shows.

use crate::color::{Rgb, decode_srgb, encode_srgb};
use crate::math::{DMat3, DVec3, exp2, ln};
use crate::schema::Tonemap;

/// The display-referred colour (sRGB, each channel in [0, 1]) of a scene radiance at an exposure in stops.
pub fn display(radiance: Rgb, stops: f64, tonemap: Tonemap) -> Rgb {
    let exposed = (radiance * exp2(stops)).max(Rgb::ZERO);
    // Radiance may be anything a file can hold; beyond this every curve is flat.
    let exposed = exposed.min(Rgb::splat(1e12));
    let linear = match tonemap {
        Tonemap::Neutral => neutral(exposed),
        Tonemap::None => exposed,
        Tonemap::Agx => agx(exposed),
    };
    let linear = linear.clamp(Rgb::ZERO, Rgb::ONE);
    Rgb::new(encode_srgb(linear.x), encode_srgb(linear.y), encode_srgb(linear.z))
}

/// Whether a radiance is burnt out: above white in every channel, and shown as white or as good as. A single channel
/// at its end is a bright colour, no loss.
pub fn is_burnt_out(radiance: Rgb, stops: f64, tonemap: Tonemap) -> bool {
    const AS_GOOD_AS_WHITE: f64 = 250.0 / 255.0;
    let exposed = radiance.min_element() * exp2(stops);
    exposed > 1.0 && display(radiance, stops, tonemap).min_element() >= AS_GOOD_AS_WHITE
}

/// Khronos PBR Neutral (Khronos Group, "PBR Neutral Tone Mapper specification", 2024).
fn neutral(color: Rgb) -> Rgb {
    const FRESNEL: f64 = 0.04;
    const START: f64 = 0.8 - FRESNEL;
    const DESATURATION: f64 = 0.15;
    let least = color.min_element();
    let offset = if least < 2.0 * FRESNEL { least - least * least / (4.0 * FRESNEL) } else { FRESNEL };
    let color = color - offset;
    let peak = color.max_element();
    if peak < START {
        return color;
    }
    let room = 1.0 - START;
    let compressed = 1.0 - room * room / (peak + room - START);
    let grey = 1.0 - 1.0 / (DESATURATION * (peak - compressed) + 1.0);
    (color * (compressed / peak)).lerp(Rgb::splat(compressed), grey)
}

/// AgX (Troy Sobotka, 2022), with the sixth-degree fit of its default contrast curve by Benjamin Wrensch,
/// "Minimal AgX implementation", 2023.
fn agx(color: Rgb) -> Rgb {
    const INSET: DMat3 = DMat3::from_cols(
        DVec3::new(0.842479062253094, 0.0423282422610123, 0.0423756549057051),
        DVec3::new(0.0784335999999992, 0.878468636469772, 0.0784336),
        DVec3::new(0.0792237451477643, 0.0791661274605434, 0.879142973793104),
    );
    const LEAST_STOPS: f64 = -12.47393;
    const MOST_STOPS: f64 = 4.026069;
    const CONTRAST: [f64; 7] = [-0.00232, 0.1191, 0.4298, -6.868, 31.96, -40.14, 15.5];
    let curve = |v: f64| {
        let stops = ln(v.max(1e-10)) / std::f64::consts::LN_2;
        let x = (stops.clamp(LEAST_STOPS, MOST_STOPS) - LEAST_STOPS) / (MOST_STOPS - LEAST_STOPS);
        CONTRAST.iter().rev().fold(0.0, |sum, factor| sum * x + factor)
    };
    let inset = INSET * color;
    let shown = INSET.inverse() * DVec3::new(curve(inset.x), curve(inset.y), curve(inset.z));
    // The curve yields display-referred values; linear ones are wanted here.
    let shown = shown.clamp(Rgb::ZERO, Rgb::ONE);
    Rgb::new(decode_srgb(shown.x), decode_srgb(shown.y), decode_srgb(shown.z))
}

#[cfg(test)]
mod tests {
    use super::*;

    const CURVES: [Tonemap; 3] = [Tonemap::Neutral, Tonemap::None, Tonemap::Agx];

    #[test]
    fn curves_rise_and_stay_in_range() {
        for curve in CURVES {
            let mut last = -1.0;
            for i in -200..=300 {
                let shown = display(Rgb::splat(exp2(f64::from(i) / 10.0)), 0.0, curve);
                assert!(shown.cmpge(Rgb::ZERO).all() && shown.cmple(Rgb::ONE).all(), "{curve:?} {i} {shown}");
                assert!(shown.y >= last - 1e-3, "{curve:?} falls at {i}: {last} to {}", shown.y);
                last = shown.y;
            }
        }
    }

    #[test]
    fn black_stays_black_and_a_stop_is_a_factor_of_two() {
        for curve in CURVES {
            assert!(display(Rgb::ZERO, 3.0, curve).max_element() < 1e-2);
            let color = Rgb::new(0.05, 0.1, 0.2);
            assert_eq!(display(color, 1.0, curve), display(2.0 * color, 0.0, curve));
        }
    }

    #[test]
    fn white_is_not_burnt_out_and_what_is_above_it_is() {
        for curve in CURVES {
            assert!(!is_burnt_out(Rgb::ONE, 0.0, curve));
            assert!(!is_burnt_out(Rgb::new(100.0, 0.5, 0.5), 0.0, Tonemap::None));
            assert!(is_burnt_out(Rgb::splat(100.0), 0.0, curve), "{curve:?}");
            assert!(is_burnt_out(Rgb::ONE, 7.0, curve), "{curve:?}");
        }
    }

    #[test]
    fn strange_radiance_is_shown_as_something() {
        for curve in CURVES {
            for value in [f64::INFINITY, -1.0, f64::MAX, f64::MIN_POSITIVE] {
                assert!(display(Rgb::new(value, 0.5, 0.0), 100.0, curve).is_finite());
            }
        }
    }
}
