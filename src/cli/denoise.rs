//! `--denoise`: the noise of a traced picture, told from its light by two halves of its samples, is taken out.

use super::Problem;
use super::args::Build;
use rayon::prelude::*;
use rt_lang::denoise::{Clean, Noisy, denoise};
use rt_lang::output::{Channels, DENOISED, DENOISED_ALPHA, Picture, Plane};
use rt_lang::render::first::Guides;
use rt_lang::render::making::Making;
use rt_lang::render::{Film, Window};
use std::time::{Duration, Instant};

/// Samples a pixel below which there are no two halves.
pub const LEAST_SAMPLES: u32 = 2;
/// Samples of a pixel whose rays are asked what they meet, at least: that costs little, and light has more noise.
const LEAST_GUIDES: u32 = 16;

/// How many samples of a pixel are asked what they meet, of a picture of so many.
pub fn guide_samples(samples: u32) -> u32 {
    samples.max(LEAST_GUIDES)
}

/// A picture without its noise.
pub struct Denoised {
    /// The picture.
    pub picture: Picture,
    /// How long that took, with finding its guides.
    pub time: Duration,
}

/// Names what does not keep both halves of the samples.
pub fn refuse(arguments: &Build) -> Result<(), Problem> {
    if !arguments.denoise {
        return Ok(());
    }
    let keeps = arguments.keeping.keeps();
    let (flag, help) = match arguments.keeping.shard {
        Some(_) => (
            "--shard",
            "it compares two halves of the samples, which are not kept in shares; `rtc merge` makes the noisy picture of them",
        ),
        None if keeps => ("--checkpoint", "it compares two halves of the samples, which are not kept there"),
        None => return Ok(()),
    };
    Err(Problem::new(format!("`--denoise` and `{flag}` do not go together")).help(help))
}

/// A number of samples that has no halves.
pub fn refuse_samples(arguments: &Build, most: u32) -> Result<(), Problem> {
    if !arguments.denoise || most >= LEAST_SAMPLES {
        return Ok(());
    }
    let problem = Problem::new("`--denoise` needs 2 samples a pixel, and here is 1");
    Err(problem.help("it compares two halves of them; from 4 on it does well"))
}

/// Takes the noise out of a picture that is traced in halves; the time counts from the start that is given.
pub fn denoised(picture: &Picture, making: &Making, guides: Guides, start: Instant) -> Option<Denoised> {
    let film = making.film();
    let films = making.halves()?;
    let share = over(film, |x, y| films[0].samples(x, y) as f32 / film.samples(x, y) as f32);
    let alpha = picture
        .alpha
        .as_ref()
        .map(|_| films.each_ref().map(|half| over(half, |x, y| half.alpha(x, y) as f32)));
    let halves = films.each_ref().map(means);
    drop(films);
    let variance = over(film, |x, y| {
        let error = film.error(x, y);
        (error * error) as f32
    });
    let noisy = Noisy { size: picture.size, halves, alpha, share, variance, guides };
    let Clean { mut pixels, mut alpha } = denoise(&noisy);
    // Where nothing is covered, there is nothing to denoise.
    if let (Some(alpha), Some(covered)) = (&mut alpha, &picture.alpha) {
        let traced = picture.pixels.iter().zip(covered);
        for ((pixel, alpha), (traced, covered)) in pixels.iter_mut().zip(alpha).zip(traced) {
            if *covered == 0.0 {
                (*pixel, *alpha) = (*traced, 0.0);
            }
        }
    }
    Some(Denoised { picture: Picture { pixels, alpha, ..picture.clone() }, time: start.elapsed() })
}

/// The picture as a layer of an EXR.
pub fn layer(picture: &Picture, channels: &mut Channels) {
    for (channel, name) in DENOISED.into_iter().enumerate() {
        let values = picture.pixels.iter().map(|pixel| pixel[channel]).collect();
        channels.planes.push(Plane { name: name.into(), values });
    }
    if let Some(values) = picture.alpha.clone() {
        channels.planes.push(Plane { name: DENOISED_ALPHA.into(), values });
    }
}

fn means(film: &Film) -> Vec<[f32; 3]> {
    over(film, |x, y| film.mean(x, y).to_array().map(|v| v as f32))
}

/// A value of each pixel, row by row.
fn over<T: Send>(film: &Film, value: impl Fn(u32, u32) -> T + Sync) -> Vec<T> {
    let Window { x: left, y: top, width, height } = film.window();
    let value = &value;
    let row = |y: u32| (left..left + width).map(move |x| value(x, y));
    (top..top + height).into_par_iter().flat_map_iter(row).collect()
}
