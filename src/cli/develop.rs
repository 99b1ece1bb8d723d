//! `rtc develop`: an EXR to other forms, without tracing.

use super::args::Develop;
use super::build::Versions;
use super::denoise::Clear;
use super::interrupt::Interrupt;
use super::target::Staged;
use super::terminal::Terminal;
use super::{Exit, Problem, build, input, keep};
use rt_lang::output::{Channels, MOST_PIXELS, decode_denoised, decode_exr, is_exr};
use rt_lang::saved::Head;

/// The largest EXR that is read: the most pixels, uncompressed, with a channel to spare.
pub const LARGEST: u64 = MOST_PIXELS * 16;

/// Develops one picture into all its outputs.
pub fn run(arguments: &Develop, terminal: Terminal, interrupt: &Interrupt) -> Result<Exit, Problem> {
    let targets = build::targets(&arguments.outputs)?;
    build::refuse_inputs_as_outputs(std::slice::from_ref(&arguments.input), &build::paths(&targets))?;
    build::refuse_idle_depth(arguments.look.bits, &targets)?;
    // What is no EXR is told by its beginning; samples that are kept take more than a picture.
    let judge = |start: &[u8]| match Head::decode(start) {
        Ok(head) => Ok(head.most_bytes().max(LARGEST)),
        Err(_) if is_exr(start) => Ok(LARGEST),
        Err(_) => Err(start.to_vec()),
    };
    let bytes = input::read_judged(&arguments.input, false, keep::HEAD, judge)?.unwrap_or_else(|start| start);
    let decoded = decode_exr(&bytes).and_then(|(picture, facts)| {
        let denoised = if arguments.noisy { None } else { decode_denoised(&bytes)? };
        Ok((picture, denoised, facts))
    });
    let (picture, denoised, mut facts) = decoded.map_err(|reason| {
        Problem::new(format!("`{}` is not an EXR that can be developed: {reason}", arguments.input.display()))
            .help("`rtc build scene.rt -o scene.exr` makes one")
    })?;
    facts.stops = arguments.exposure.or(facts.stops);
    facts.tonemap = arguments.look.tonemap.or(facts.tonemap);
    let staged: Result<Vec<Staged>, Problem> = targets.iter().map(|target| target.stage(interrupt)).collect();
    let clear = denoised.as_ref().map(|(picture, by)| Clear { picture, by: by.as_deref() });
    let versions = Versions { traced: &picture, denoised: clear };
    build::write(versions, &facts, &Channels::default(), arguments.look.bits, staged?)?;
    if !arguments.quiet {
        let [width, height] = picture.size;
        let stops = facts.stops.unwrap_or(0.0);
        terminal.line(&format!("{}: {width}×{height}, exposure {stops}", build::names(&targets)));
    }
    Ok(Exit::Done)
}
