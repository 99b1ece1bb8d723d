//! Flags of `rtc merge`.

use super::depths;
use clap::Args;
use rt_lang::output::Depth;
use std::path::PathBuf;

pub const EXAMPLES: &str = "\
Examples:
  rtc build room.rt --samples 1024 --shard 1/2 -o part1.exr    on one machine
  rtc build room.rt --samples 1024 --shard 2/2 -o part2.exr    on another
  rtc merge part1.exr part2.exr -o room.exr                    the picture, as one would have made it
  rtc merge --partial part*.exr -o look.png                    what there is so far";

/// Flags of `rtc merge`.
#[derive(Args)]
pub struct Merge {
    /// The shares, in any order: all that `rtc build --shard` made of one picture.
    #[arg(value_name = "PART.exr", required = true)]
    pub parts: Vec<PathBuf>,

    /// Writes the picture here, in the format of the extension: png, exr, jpg, webp, hdr or pfm. May be given
    /// several times. `-` is standard output as PNG, `exr:-` as EXR and so on.
    #[arg(short, long = "output", value_name = "OUT", required = true)]
    pub outputs: Vec<PathBuf>,

    /// Makes a picture of the shares that are there, and tells which are missing, and which are left out as they are not
    /// whole or of another picture.
    #[arg(long)]
    pub partial: bool,

    /// Bits a channel of PNG files.
    #[arg(long, value_name = "8|16", default_value = "8", value_parser = depths())]
    pub bits: Depth,

    /// Says nothing but errors, and so nothing of what `--partial` does without.
    #[arg(short, long)]
    pub quiet: bool,
}
