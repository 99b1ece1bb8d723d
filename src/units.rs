//! Dimensions and units. Every quantity is held in metres, radians, watts and kelvins.

use crate::math::PI;
use std::fmt;

/// Exponents of the base dimensions, so that quantities multiply and divide.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Dim {
    /// Exponent of length.
    pub length: i8,
    /// Exponent of angle.
    pub angle: i8,
    /// Exponent of power.
    pub power: i8,
    /// Exponent of temperature.
    pub temperature: i8,
}

/// A plain number.
pub const NONE: Dim = Dim { length: 0, angle: 0, power: 0, temperature: 0 };
/// Metres.
pub const LENGTH: Dim = Dim { length: 1, ..NONE };
/// Radians.
pub const ANGLE: Dim = Dim { angle: 1, ..NONE };
/// Watts.
pub const POWER: Dim = Dim { power: 1, ..NONE };
/// Kelvins.
pub const TEMPERATURE: Dim = Dim { temperature: 1, ..NONE };
/// Watts per square metre: irradiance, and radiance (per steradian, as the language writes it).
pub const RADIANCE: Dim = Dim { power: 1, length: -2, ..NONE };

/// Exponents beyond this are refused, long before they overflow.
const MAX_EXPONENT: i8 = 30;

impl Dim {
    /// The dimension of a product; none when an exponent grows beyond reason.
    pub fn times(self, other: Dim) -> Option<Dim> {
        self.combine(other, |a, b| a + b)
    }

    /// The dimension of a quotient; none when an exponent grows beyond reason.
    pub fn over(self, other: Dim) -> Option<Dim> {
        self.combine(other, |a, b| a - b)
    }

    /// The dimension of a square root, if every exponent is even.
    pub fn root(self) -> Option<Dim> {
        let halves = self.exponents().map(|e| if e % 2 == 0 { Some(e / 2) } else { None });
        match halves {
            [Some(length), Some(angle), Some(power), Some(temperature)] => {
                Some(Dim { length, angle, power, temperature })
            }
            _ => None,
        }
    }

    fn exponents(self) -> [i8; 4] {
        [self.length, self.angle, self.power, self.temperature]
    }

    fn combine(self, other: Dim, f: impl Fn(i8, i8) -> i8) -> Option<Dim> {
        let dim = Dim {
            length: f(self.length, other.length),
            angle: f(self.angle, other.angle),
            power: f(self.power, other.power),
            temperature: f(self.temperature, other.temperature),
        };
        dim.exponents().iter().all(|e| e.abs() <= MAX_EXPONENT).then_some(dim)
    }

    /// A unit a writer would reach for, to show in messages.
    pub fn example_unit(self) -> String {
        match self {
            NONE => String::new(),
            LENGTH => "m".into(),
            ANGLE => "deg".into(),
            POWER => "W".into(),
            TEMPERATURE => "K".into(),
            RADIANCE => "W/m2".into(),
            other => other.in_units(),
        }
    }

    fn in_units(self) -> String {
        let factor = |(name, e): (&str, i8)| match e.abs() {
            1 => name.to_string(),
            n => format!("{name}{n}"),
        };
        let named = [("W", self.power), ("K", self.temperature), ("m", self.length), ("rad", self.angle)];
        let over: Vec<String> = named.into_iter().filter(|n| n.1 > 0).map(factor).collect();
        let under: Vec<String> = named.into_iter().filter(|n| n.1 < 0).map(factor).collect();
        let over = if over.is_empty() { "1".to_string() } else { over.join("·") };
        if under.is_empty() { over } else { format!("{over}/{}", under.join("/")) }
    }
}

impl fmt::Display for Dim {
    /// As one says it: `a length`, `an angle`, `a quantity in W/m`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            NONE => f.write_str("a number"),
            LENGTH => f.write_str("a length"),
            ANGLE => f.write_str("an angle"),
            POWER => f.write_str("a power"),
            TEMPERATURE => f.write_str("a temperature"),
            Dim { length: 2, angle: 0, power: 0, temperature: 0 } => f.write_str("an area"),
            other => write!(f, "a quantity in {}", other.in_units()),
        }
    }
}

/// A unit: its dimension, and how many base units it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// What it measures.
    pub dim: Dim,
    /// One of it in base units.
    pub factor: f64,
}

/// Every simple unit by its written name.
pub const UNITS: &[(&str, Unit)] = &[
    ("nm", Unit { dim: LENGTH, factor: 1e-9 }),
    ("um", Unit { dim: LENGTH, factor: 1e-6 }),
    ("mm", Unit { dim: LENGTH, factor: 1e-3 }),
    ("cm", Unit { dim: LENGTH, factor: 1e-2 }),
    ("m", Unit { dim: LENGTH, factor: 1.0 }),
    ("km", Unit { dim: LENGTH, factor: 1e3 }),
    ("in", Unit { dim: LENGTH, factor: 0.0254 }),
    ("ft", Unit { dim: LENGTH, factor: 0.3048 }),
    ("deg", Unit { dim: ANGLE, factor: PI / 180.0 }),
    ("rad", Unit { dim: ANGLE, factor: 1.0 }),
    ("turn", Unit { dim: ANGLE, factor: 2.0 * PI }),
    ("mW", Unit { dim: POWER, factor: 1e-3 }),
    ("W", Unit { dim: POWER, factor: 1.0 }),
    ("kW", Unit { dim: POWER, factor: 1e3 }),
    ("K", Unit { dim: TEMPERATURE, factor: 1.0 }),
    ("%", Unit { dim: NONE, factor: 0.01 }),
];

/// The words of units that are written short.
const SPELT_OUT: &[(&str, &[&str])] = &[
    ("um", &["µm", "μm", "micron", "microns"]),
    ("m", &["meter", "meters", "metre", "metres"]),
    ("cm", &["centimeter", "centimeters", "centimetre", "centimetres"]),
    ("mm", &["millimeter", "millimeters", "millimetre", "millimetres"]),
    ("km", &["kilometer", "kilometers", "kilometre", "kilometres"]),
    ("in", &["inch", "inches"]),
    ("ft", &["foot", "feet"]),
    ("deg", &["degree", "degrees", "º"]),
    ("rad", &["radian", "radians"]),
    ("turn", &["turns"]),
    ("W", &["watt", "watts", "Watt", "Watts"]),
    ("K", &["kelvin", "kelvins", "Kelvin", "ºK"]),
    ("%", &["percent"]),
];

/// The unit that a word means: `metres` is `m`.
pub fn spelt_out(word: &str) -> Option<&'static str> {
    SPELT_OUT.iter().find(|(_, words)| words.contains(&word)).map(|(unit, _)| *unit)
}

/// Units that stand behind the prefixes of SI, and what they measure where that is measured here.
const PREFIXED: &[(&str, Option<Dim>)] = &[
    ("m", Some(LENGTH)),
    ("W", Some(POWER)),
    ("K", Some(TEMPERATURE)),
    ("rad", Some(ANGLE)),
    ("lm", None),
    ("cd", None),
    ("lx", None),
    ("g", None),
    ("s", None),
    ("l", None),
    ("A", None),
    ("V", None),
    ("J", None),
    ("N", None),
    ("Nm", None),
    ("Wh", None),
    ("Hz", None),
    ("Pa", None),
    ("sr", None),
    ("mol", None),
];

/// The prefixes of SI, with none.
const PREFIXES: &[&str] =
    &["", "da", "h", "k", "M", "G", "T", "P", "d", "c", "m", "u", "µ", "μ", "n", "p", "f"];

/// Of a unit of elsewhere, what it measures where that is measured here.
pub fn elsewhere(name: &str) -> Option<Option<Dim>> {
    match name {
        "yd" | "yard" | "yards" | "mi" | "mile" | "miles" => Some(Some(LENGTH)),
        "gon" | "arcmin" | "arcsec" => Some(Some(ANGLE)),
        "hp" => Some(Some(POWER)),
        _ => PREFIXED.iter().find_map(|(unit, dim)| {
            name.strip_suffix(unit).filter(|prefix| PREFIXES.contains(prefix)).map(|_| *dim)
        }),
    }
}

/// Whether this bare word is a unit's name, which therefore cannot be declared.
pub fn is_unit(name: &str) -> bool {
    UNITS.iter().any(|(unit, _)| *unit == name)
}

/// Reads a unit as written behind a number: `mm`, `m2`, `W/m2`. The error is the part that is not a unit.
pub fn parse_unit(text: &str) -> Result<Unit, &str> {
    let mut product = Unit { dim: NONE, factor: 1.0 };
    for (index, part) in text.split('/').enumerate() {
        let name = part.trim_end_matches(|c: char| c.is_ascii_digit());
        let exponent: u32 = match &part[name.len()..] {
            "" => 1,
            digits => digits.parse().map_err(|_| part)?,
        };
        let (_, unit) = UNITS.iter().find(|(unit, _)| *unit == name).ok_or(part)?;
        if exponent == 0 || exponent > 8 {
            return Err(part);
        }
        for _ in 0..exponent {
            let dim = if index == 0 { product.dim.times(unit.dim) } else { product.dim.over(unit.dim) };
            product.dim = dim.ok_or(part)?;
            product.factor =
                if index == 0 { product.factor * unit.factor } else { product.factor / unit.factor };
        }
    }
    Ok(product)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_multiply_and_divide() {
        assert_eq!(parse_unit("W/m2"), Ok(Unit { dim: RADIANCE, factor: 1.0 }));
        assert_eq!(parse_unit("mm2").map(|u| u.dim.length), Ok(2));
        assert_eq!(parse_unit("mmm"), Err("mmm"));
        assert_eq!(parse_unit("W/mmm"), Err("mmm"));
        assert_eq!(parse_unit("m0"), Err("m0"));
        assert_eq!(RADIANCE.to_string(), "a quantity in W/m2");
        assert_eq!(RADIANCE.times(Dim { length: 2, ..NONE }), Some(POWER));
        assert_eq!(LENGTH.root(), None);
        assert_eq!(Dim { length: 2, ..NONE }.root(), Some(LENGTH));
    }
}
