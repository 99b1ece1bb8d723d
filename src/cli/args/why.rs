//! Flags of `rtc why`.

use super::values::{pixel, samples, seed, size};
use super::{Reading, Viewpoint};
use clap::Args;
use std::path::PathBuf;

pub const EXAMPLES: &str = "\
Examples:
  rtc why balls.rt 320,240                     the middle of a picture of 640×480
  rtc why balls.rt 80,60 --size 160x120        of a smaller one
  rtc why balls.rt 320,240 --json              for programs; docs/why-json.md describes it";

/// Flags of `rtc why`.
#[derive(Args)]
pub struct Why {
    /// The scene; `-` is standard input.
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,

    /// The pixel: column and row, counted from 0 at the top left of the picture.
    #[arg(value_name = "X,Y", value_parser = pixel)]
    pub pixel: [u32; 2],

    /// Prints one JSON object.
    #[arg(long)]
    pub json: bool,

    /// Watches this many paths, in place of the scene's `samples`: the first ones of those that make the picture.
    #[arg(long, value_name = "N", value_parser = samples, allow_negative_numbers = true)]
    pub samples: Option<u32>,

    /// Of a picture this many pixels wide and high, in place of the scene's `size`.
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<[u32; 2]>,

    /// Chooses the random numbers, in place of the scene's `seed`.
    #[arg(long, value_name = "N", value_parser = seed, allow_negative_numbers = true)]
    pub seed: Option<u64>,

    #[command(flatten)]
    #[allow(missing_docs)]
    pub viewpoint: Viewpoint,

    #[command(flatten)]
    #[allow(missing_docs)]
    pub reading: Reading,
}
