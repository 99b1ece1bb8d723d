//! Films: what changes from frame to frame, and which frames are made.

use clap::Args;
use rt_lang::output::animation::Rate;
use std::ops::RangeInclusive;

/// The most frames of a film: nine hours of 30 a second.
const MOST_FRAMES: u32 = 1_000_000;

/// What makes a film of a scene.
#[derive(Args)]
pub struct Animating {
    /// Makes a film in which a `param` goes from one value to another: `--sweep "t = 0 to 1"`; with `until` in place of `to`
    /// the last frame comes before the end, for a loop. May be given several times.
    #[arg(long, value_name = "PARAM = A to B", requires = "frames")]
    pub sweep: Vec<String>,

    /// Makes so many frames. Where their numbers go stands in the name: `-o film.{04}.png`; without, `-o` is one film: apng or
    /// png, webp, or by ffmpeg mp4, mov, mkv or webm.
    #[arg(long, value_name = "N", requires = "sweep", value_parser = frames, allow_negative_numbers = true)]
    pub frames: Option<u32>,

    /// Makes only these frames, counted from 1: `1-10,20-`. `auto` makes the one that Slurm's or Kubernetes' index names,
    /// `auto/N` one of N runs of frames.
    #[arg(long, value_name = "LIST|auto", requires = "frames", value_parser = only)]
    pub only: Option<Only>,

    /// Plays so many frames a second: `25`, `23.976` or `30000/1001`. By default 24.
    #[arg(long, value_name = "N", requires = "frames", value_parser = rate)]
    pub fps: Option<Rate>,
}

/// Which frames are made.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Only {
    /// Those of these ranges; one without an end goes to the last frame.
    Listed(Vec<(u32, Option<u32>)>),
    /// The one that the scheduler says.
    Auto,
    /// The run that the scheduler says, of so many.
    AutoOf(u32),
}

fn frames(text: &str) -> Result<u32, String> {
    let count = text.parse().ok().filter(|count| (1..=MOST_FRAMES).contains(count));
    count.ok_or_else(|| format!("a number of frames from 1 to {MOST_FRAMES}, such as 48"))
}

fn only(text: &str) -> Result<Only, String> {
    match text.strip_prefix("auto") {
        Some("") => return Ok(Only::Auto),
        Some(of) => {
            let of = of.strip_prefix('/').and_then(|of| of.parse().ok()).filter(|of| *of > 0);
            return of
                .map(Only::AutoOf)
                .ok_or_else(|| "`auto`, or `auto/8` for one of 8 runs of frames".into());
        }
        None => {}
    }
    text.split(',').map(|part| range(part.trim())).collect::<Result<_, _>>().map(Only::Listed)
}

/// `7`, `1-10` or `20-`.
fn range(text: &str) -> Result<(u32, Option<u32>), String> {
    let wanted = || "numbers of frames and ranges of them, such as 1-10,15,20-".to_string();
    let number = |text: &str| match text.parse() {
        Ok(0) => Err("frames are counted from 1".to_string()),
        Ok(number) => Ok(number),
        Err(_) => Err(wanted()),
    };
    let (first, last) = match text.split_once('-') {
        None => (number(text)?, Some(number(text)?)),
        Some((first, "")) => (number(first)?, None),
        Some((first, last)) => (number(first)?, Some(number(last)?)),
    };
    match last {
        Some(last) if last < first => Err(format!("the range {first}-{last} ends before it begins")),
        last => Ok((first, last)),
    }
}

fn rate(text: &str) -> Result<Rate, String> {
    text.parse()
        .map_err(|()| "frames a second from 0.01 to 1000, such as 25, 23.976 or 30000/1001".to_string())
}

impl Only {
    /// The ranges that are listed, of so many frames.
    pub fn ranges(listed: &[(u32, Option<u32>)], of: u32) -> impl Iterator<Item = RangeInclusive<u32>> {
        listed.iter().map(move |(first, last)| *first..=last.unwrap_or(of))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_read_strictly() {
        assert_eq!(only("1-10,20-"), Ok(Only::Listed(vec![(1, Some(10)), (20, None)])));
        assert_eq!(only("7, 9"), Ok(Only::Listed(vec![(7, Some(7)), (9, Some(9))])));
        assert_eq!((only("auto"), only("auto/8")), (Ok(Only::Auto), Ok(Only::AutoOf(8))));
        for wrong in
            ["", "0", "1-0", "5-3", "-3", "a", "1,", "1--2", "1-2-3", "auto/", "auto/0", "automatic", "1.5"]
        {
            assert!(only(wrong).is_err(), "{wrong}");
        }
    }
}
