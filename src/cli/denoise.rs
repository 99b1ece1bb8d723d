//! `--denoise`: the noise of a traced picture, told from its light by two halves of its samples, is taken out.

use super::Problem;
use super::args::Build;
use rayon::prelude::*;
use rt_lang::denoise::{Clean, Noisy, denoise, whole_work};
use rt_lang::output::{Channels, DENOISED, DENOISED_ALPHA, DENOISED_BY, Picture, Plane};
use rt_lang::render::film::LightSums;
use rt_lang::render::first::Guides;
use rt_lang::render::making::Making;
use rt_lang::render::{Control, Film, Window};
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

/// A share has neither all samples nor what the filter is guided by, and `rtc merge` has no scene.
pub fn refuse(arguments: &Build) -> Result<(), Problem> {
    if !arguments.denoise || arguments.keeping.shard.is_none() {
        return Ok(());
    }
    let problem =
        Problem::new("`--denoise` and `--shard` do not go together: the noise is that of all samples");
    Err(problem.help(
        "make the shares without it, and `rtc merge` gives the picture as traced; without noise it is made by one machine, \
         as are the frames of a film",
    ))
}

/// Why samples that were kept are none to go on with, if they are not.
pub fn refuses(kept: &Making) -> Option<String> {
    let begun = kept.samples()[1] > 0 && !kept.is_in_halves();
    begun.then(|| {
        "it was begun without `--denoise`, so that two halves of its samples, which that compares, are not told apart".into()
    })
}

/// A number of samples that has no halves.
pub fn refuse_samples(arguments: &Build, most: u32) -> Result<(), Problem> {
    if !arguments.denoise || most >= LEAST_SAMPLES {
        return Ok(());
    }
    let problem = Problem::new("`--denoise` needs 2 samples a pixel, and here is 1");
    Err(problem.help("it compares two halves of them; from 4 on it does well"))
}

/// Takes the noise out of a picture that is traced in halves; the time counts from the start that is given. `control` tells how
/// far it is.
pub fn denoised(
    picture: &Picture,
    making: &Making,
    guides: Guides,
    start: Instant,
    control: &Control,
) -> Option<Denoised> {
    let (film, halves) = (making.film(), making.halves()?);
    let share = halves[0].iter().zip(film.pixels());
    let share = share.map(|(half, all)| half.samples() as f32 / all.samples() as f32).collect();
    let alphas = |lights: &Vec<LightSums>| lights.iter().map(|light| light.alpha() as f32).collect();
    let alpha = picture.alpha.as_ref().map(|_| halves.each_ref().map(alphas));
    let means = |lights: Vec<LightSums>| -> Vec<[f32; 3]> {
        lights.iter().map(|light| light.mean(film.scale()).to_array().map(|v| v as f32)).collect()
    };
    let halves = halves.map(means);
    let variance = over(film, |x, y| {
        let error = film.error(x, y);
        (error * error) as f32
    });
    let noisy = Noisy { size: picture.size, halves, alpha, share, variance, guides };
    control.plan(whole_work(picture.size));
    let Clean { mut pixels, mut alpha } = denoise(&noisy, &|work| control.finish(work));
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

/// A picture without noise as it is written.
#[derive(Clone, Copy)]
pub struct Clear<'p> {
    /// The picture.
    pub picture: &'p Picture,
    /// What took the noise out, if that is known.
    pub by: Option<&'p str>,
}

/// The picture as a layer of an EXR.
pub fn layer(clear: Clear, channels: &mut Channels) {
    let Clear { picture, by } = clear;
    for (channel, name) in DENOISED.into_iter().enumerate() {
        let values = picture.pixels.iter().map(|pixel| pixel[channel]).collect();
        channels.planes.push(Plane { name: name.into(), values });
    }
    if let Some(values) = picture.alpha.clone() {
        channels.planes.push(Plane { name: DENOISED_ALPHA.into(), values });
    }
    channels.texts.extend(by.map(|by| (DENOISED_BY.into(), by.into())));
}

/// A value of each pixel, row by row.
fn over<T: Send>(film: &Film, value: impl Fn(u32, u32) -> T + Sync) -> Vec<T> {
    let Window { x: left, y: top, width, height } = film.window();
    let value = &value;
    let row = |y: u32| (left..left + width).map(move |x| value(x, y));
    (top..top + height).into_par_iter().flat_map_iter(row).collect()
}
