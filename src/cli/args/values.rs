//! How the values of flags are read: strictly, and with the right form in each refusal.

use super::Exposure;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use rt_lang::aov::Aov;
use rt_lang::diagnostic::{Code, Severity};
use rt_lang::lower::MAX_PIXELS;
use rt_lang::output::Depth;
use rt_lang::schema::{Key, KindId, Tonemap, Word, camera, render};
use std::net::{Ipv4Addr, SocketAddr};
use std::ops::RangeInclusive;
use std::str::FromStr;

/// More threads than any machine has use for.
const MOST_THREADS: usize = 1024;

pub fn size(text: &str) -> Result<[u32; 2], String> {
    let wanted = || "width x height in pixels, such as 640x480".to_string();
    let (width, height) = text.split_once(['x', 'X', '×']).ok_or_else(wanted)?;
    let side = |text: &str| text.parse::<u64>().map_err(|_| wanted());
    let (width, height) = (side(width)?, side(height)?);
    for side in [width, height] {
        within(render::KIND, &render::SIZE, side, "a side")?;
    }
    if width * height > MAX_PIXELS {
        return Err(format!(
            "{width}×{height} are {} pixels, and at most {MAX_PIXELS} are traced",
            width * height
        ));
    }
    Ok([width as u32, height as u32])
}

/// Where a page is served: on this machine alone, for whoever reaches the page can change the scene.
pub fn address(text: &str) -> Result<SocketAddr, String> {
    let wanted = "an address of this machine, such as 127.0.0.1:8080, or only a port";
    let address = match text.parse::<u16>() {
        Ok(port) => SocketAddr::from((Ipv4Addr::LOCALHOST, port)),
        Err(_) => text.replacen("localhost:", "127.0.0.1:", 1).parse::<SocketAddr>().map_err(|_| wanted)?,
    };
    match address.ip().is_loopback() {
        true => Ok(address),
        false => Err(format!("{} can be reached by others: this wants {wanted}", address.ip())),
    }
}

pub fn samples(text: &str) -> Result<u32, String> {
    let n = whole(text, "a number of paths a pixel, such as 64")?;
    within(render::KIND, &render::SAMPLES, n, "the number")?;
    Ok(n as u32)
}

pub fn seed(text: &str) -> Result<u64, String> {
    let n = whole(text, "a whole number, such as 7")?;
    within(render::KIND, &render::SEED, n, "the seed")?;
    Ok(n)
}

pub fn threads(text: &str) -> Result<usize, String> {
    match whole(text, "a number of threads, such as 4")? {
        0 => Err("at least one thread is needed; leave the flag out for all cores".into()),
        n if n > MOST_THREADS as u64 => Err(format!("at most {MOST_THREADS} threads")),
        n => Ok(n as usize),
    }
}

pub fn crop(text: &str) -> Result<[u32; 4], String> {
    let parts: Vec<u32> = text.split(',').map_while(|part| u32::from_str(part.trim()).ok()).collect();
    match <[u32; 4]>::try_from(parts) {
        Ok([_, _, 0, _] | [_, _, _, 0]) => Err("the window has no pixels".into()),
        Ok(window) if text.split(',').count() == 4 => Ok(window),
        _ => Err("x, y, width and height in whole pixels, such as 0,0,320,240".into()),
    }
}

pub fn lines(text: &str) -> Result<RangeInclusive<usize>, String> {
    let parts =
        text.split_once(':').and_then(|(first, last)| Some((first.parse().ok()?, last.parse().ok()?)));
    match parts {
        Some((first, last)) if (1..=last).contains(&first) => Ok(first..=last),
        _ => Err("the first and the last line, counted from 1, such as 3:7".into()),
    }
}

pub fn pixel(text: &str) -> Result<[u32; 2], String> {
    let parts =
        text.split_once(',').and_then(|(x, y)| Some([x.trim().parse().ok()?, y.trim().parse().ok()?]));
    parts.ok_or_else(|| "column and row in whole pixels, such as 320,240".into())
}

pub fn exposure(text: &str) -> Result<Exposure, String> {
    if text == "auto" {
        return Ok(Exposure::Auto);
    }
    stops(text).map(Exposure::Stops).map_err(|wanted| format!("{wanted}; or auto"))
}

pub fn stops(text: &str) -> Result<f64, String> {
    let stops: f64 = text.parse().map_err(|_| "a number of stops, such as -1.5".to_string())?;
    let range = camera::KIND.field(camera::EXPOSURE.index(camera::KIND)).range;
    let wanted = || format!("a number of stops from {} to {}", range.low, range.high);
    range.contains(stops).then_some(stops).ok_or_else(wanted)
}

fn whole(text: &str, wanted: &str) -> Result<u64, String> {
    text.parse().map_err(|_| wanted.to_string())
}

/// Holds a flag's value to the range of the field that it stands for.
fn within<T>(kind: KindId, key: &Key<T>, n: u64, what: &str) -> Result<(), String> {
    let range = kind.field(key.index(kind)).range;
    let wanted = || format!("{what} is from {} to {}", range.low, range.high);
    // Beyond 2^53 not every number is one of f64.
    let exact = n as f64 as u64 == n;
    (exact && range.contains(n as f64)).then_some(()).ok_or_else(wanted)
}

pub fn tonemaps() -> impl TypedValueParser<Value = Tonemap> {
    let value = |word: &Word| PossibleValue::new(word.name).help(word.doc);
    let words = PossibleValuesParser::new(Tonemap::WORDS.iter().map(value));
    words.try_map(|word| Tonemap::from_word(&word).ok_or("not a curve"))
}

pub fn aov() -> impl TypedValueParser<Value = Aov> {
    let names = PossibleValuesParser::new(Aov::ALL.iter().map(|(_, name)| *name));
    names.try_map(|name| Aov::from_name(&name).ok_or("not a channel"))
}

pub fn depths() -> impl TypedValueParser<Value = Depth> {
    let bits = PossibleValuesParser::new(["8", "16"]);
    bits.map(|bits| if bits == "16" { Depth::Sixteen } else { Depth::Eight })
}

/// Which warnings `--deny` means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Denied {
    /// All of them.
    Warnings,
    /// Those of one code.
    Code(Code),
}

pub fn denied(text: &str) -> Result<Denied, String> {
    if text == "warnings" {
        return Ok(Denied::Warnings);
    }
    let code = Code::ALL.iter().find(|code| code.as_str().eq_ignore_ascii_case(text));
    match code {
        Some(code) if code.severity() == Severity::Warning => Ok(Denied::Code(*code)),
        Some(_) => Err("it is an error already".into()),
        None => Err("`warnings`, or the code of one, such as W0106".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_read_strictly() {
        assert_eq!(size("640x480"), Ok([640, 480]));
        assert_eq!(size("640×480"), Ok([640, 480]));
        for wrong in ["", "640", "640x", "x480", "640x480x3", "-1x5", "0x480", "65537x1", "1e3x5", "6.4x4"] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
        assert_eq!(crop("0,0,320,240"), Ok([0, 0, 320, 240]));
        for wrong in
            ["", "0,0,320", "0,0,320,240,1", "0,0,0,240", "0,0,5,0", "-1,0,5,5", "0,0,5,5,", "a,0,5,5"]
        {
            assert!(crop(wrong).is_err(), "{wrong}");
        }
        assert_eq!(samples("64"), Ok(64));
        assert!(samples("0").is_err() && samples("1.5").is_err() && samples("99999999").is_err());
        assert!(threads("0").is_err() && threads("100000").is_err() && threads("-2").is_err());
        assert_eq!(exposure("-1.25"), Ok(Exposure::Stops(-1.25)));
        assert_eq!(exposure("auto"), Ok(Exposure::Auto));
        assert!(exposure("nan").is_err() && exposure("inf").is_err() && exposure("1000").is_err());
        assert_eq!(denied("warnings"), Ok(Denied::Warnings));
        assert_eq!(denied("w0106"), Ok(Denied::Code(Code::W0106)));
        assert!(denied("E0203").is_err() && denied("W9999").is_err() && denied("").is_err());
        assert!(seed("9007199254740993").is_err() && seed("-1").is_err());
    }
}
