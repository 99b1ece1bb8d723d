//! When a picture is done, how its samples are kept, and which share of them is made.

use clap::Args;
use clap::builder::{PathBufValueParser, TypedValueParser};
use std::path::PathBuf;
use std::str::FromStr;
use std::time::Duration;

/// When to stop, besides what [`super::Taking`] says.
#[derive(Args)]
pub struct Halting {
    /// Stops when it has traced for so long: `90s`, `10min`, `2h`. It says how many samples those were, which give the same
    /// picture again.
    #[arg(long, value_name = "TIME", value_parser = time)]
    pub time: Option<Duration>,

    /// Gives every pixel this many samples before noise is judged. By default 64.
    #[arg(long, value_name = "N", value_parser = super::values::samples, allow_negative_numbers = true)]
    pub min_samples: Option<u32>,
}

/// How work is kept.
#[derive(Args)]
pub struct Keeping {
    /// Keeps the samples in this file, or if none is named beside the picture that the first `-o` names: every now and then, at
    /// the end, and when the process is asked to end. Run again, it goes on from there; with a higher limit it adds samples to a
    /// picture that was done.
    #[arg(long, value_name = "FILE", num_args = 0..=1, require_equals = true,
        value_parser = PathBufValueParser::new().try_map(checkpoint))]
    pub checkpoint: Option<Option<PathBuf>>,

    /// How often they are kept: every so long, as `60s` or `5min`, or whenever so many samples a pixel came, as `100spp`. By
    /// default `60s`.
    #[arg(long, value_name = "60s|100spp", value_parser = every)]
    pub checkpoint_every: Option<Every>,

    /// Goes on from the samples that were kept: `auto` where there are some, `never` begins afresh, and a file must be there.
    /// Keeps them too, as `--checkpoint` does.
    #[arg(long, value_name = "auto|never|FILE", num_args = 0..=1, require_equals = true,
        default_missing_value = "auto", value_parser = resume)]
    pub resume: Option<Resume>,

    /// Waits for so long while another process is writing the same picture, share, frame or film, and then goes on from what that one
    /// has left. Without it, that is an error.
    #[arg(long, value_name = "TIME", value_parser = time)]
    pub wait: Option<Duration>,

    /// Makes one of N shares of the samples, all of the picture with fewer of them, as an EXR for `rtc merge`: `2/8`. `auto`
    /// takes both from a Slurm job array 1-N, `auto/N` the first from Slurm's or Kubernetes' index.
    #[arg(long, value_name = "I/N|auto", value_parser = share)]
    pub shard: Option<Shard>,
}

impl Keeping {
    /// Whether samples are kept.
    pub fn keeps(&self) -> bool {
        self.checkpoint.is_some() || self.resume.is_some()
    }

    /// How often they are kept.
    pub fn every(&self) -> Every {
        self.checkpoint_every.unwrap_or(Every::Time(Duration::from_secs(60)))
    }
}

/// How often samples are kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Every {
    /// Every so long.
    Time(Duration),
    /// Every so many samples a pixel.
    Samples(u32),
}

/// Where to go on from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Resume {
    /// The checkpoint, if there is one.
    Auto,
    /// Nothing.
    Never,
    /// This file.
    From(PathBuf),
}

/// Which share of the samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shard {
    /// The first number of the second.
    Given(u32, u32),
    /// What the scheduler says.
    Auto,
    /// The one that the scheduler says, of so many.
    AutoOf(u32),
}

/// A year.
const LONGEST: Duration = Duration::from_secs(365 * 24 * 3600);

pub fn time(text: &str) -> Result<Duration, String> {
    let wanted = || "a time with its unit, such as 90s, 10min or 2h".to_string();
    let units = [("ms", 1e-3), ("min", 60.0), ("s", 1.0), ("h", 3600.0)];
    let read = |(unit, seconds): (&str, f64)| Some(f64::from_str(text.strip_suffix(unit)?).ok()? * seconds);
    let seconds = units.into_iter().find_map(read).ok_or_else(wanted)?;
    match seconds {
        seconds if seconds > LONGEST.as_secs_f64() => {
            Err(format!("a time of a year at most, which is {}h", LONGEST.as_secs() / 3600))
        }
        seconds if seconds > 0.0 => Ok(Duration::from_secs_f64(seconds)),
        seconds if seconds <= 0.0 => Err("a time above 0, such as 90s".into()),
        _ => Err(wanted()),
    }
}

pub fn every(text: &str) -> Result<Every, String> {
    let samples = text.strip_suffix("spp").map(super::values::samples);
    match samples {
        Some(samples) => samples.map(Every::Samples),
        None => time(text).map(Every::Time).map_err(|wanted| format!("{wanted}; or samples, such as 100spp")),
    }
}

/// A share of white, in per cent or as a number.
pub fn noise(text: &str) -> Result<f64, String> {
    let (number, unit) = text.strip_suffix('%').map_or((text, 1.0), |number| (number, 0.01));
    let noise = f64::from_str(number).map(|number| number * unit);
    noise
        .ok()
        .filter(|noise| *noise > 0.0 && *noise <= 1.0)
        .ok_or_else(|| "a share of white above 0 and up to 100%, such as 1%".to_string())
}

fn checkpoint(file: PathBuf) -> Result<PathBuf, String> {
    match file.to_str() {
        Some("-") => Err("a file, for what is written to standard output cannot be read again".into()),
        Some(word @ ("auto" | "never")) => {
            Err(format!("a file: `{word}` is for `--resume`, and a file of that name is `./{word}`"))
        }
        _ => Ok(file),
    }
}

fn resume(text: &str) -> Result<Resume, String> {
    Ok(match text {
        "auto" => Resume::Auto,
        "never" => Resume::Never,
        "" => return Err("`auto`, `never`, or a file".into()),
        "-" => return Err("`auto`, `never`, or a file, for samples are not read from standard input".into()),
        file => Resume::From(file.into()),
    })
}

fn share(text: &str) -> Result<Shard, String> {
    let wanted = || "one of so many, such as 2/8; `auto`, or `auto/8`".to_string();
    let Some((index, of)) = text.split_once('/') else {
        return if text == "auto" { Ok(Shard::Auto) } else { Err(wanted()) };
    };
    let of: u32 = of.parse().ok().filter(|of| *of > 0).ok_or_else(wanted)?;
    if index == "auto" {
        return Ok(Shard::AutoOf(of));
    }
    let index: u32 = index.parse().map_err(|_| wanted())?;
    match (1..=of).contains(&index) {
        true => Ok(Shard::Given(index, of)),
        false => Err(format!("shares are counted from 1 to {of}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_read_strictly() {
        let seconds = |text| time(text).map(|time| time.as_secs_f64());
        let times = [("30s", 30.0), ("1.5h", 5400.0), ("2min", 120.0), ("250ms", 0.25)];
        assert!(times.into_iter().all(|(text, expected)| seconds(text) == Ok(expected)));
        for wrong in ["", "30", "0s", "-1s", "nans", "infs", "1e99s", "5m", "s"] {
            assert!(time(wrong).is_err(), "{wrong}");
        }
        assert_eq!(every("100spp"), Ok(Every::Samples(100)));
        assert_eq!(every("60s"), Ok(Every::Time(Duration::from_secs(60))));
        assert!(every("0spp").is_err() && every("spp").is_err() && every("60").is_err());
        assert_eq!((noise("1%"), noise("0.01"), noise("100%")), (Ok(0.01), Ok(0.01), Ok(1.0)));
        assert!(["", "%", "0%", "101%", "-1%", "nan", "inf"].into_iter().all(|text| noise(text).is_err()));
        assert_eq!((share("2/8"), share("auto")), (Ok(Shard::Given(2, 8)), Ok(Shard::Auto)));
        assert_eq!(share("auto/8"), Ok(Shard::AutoOf(8)));
        assert!(
            ["", "0/8", "9/8", "1/0", "1", "1/2/3", "auto/", "auto/0"].into_iter().all(|t| share(t).is_err())
        );
    }
}
