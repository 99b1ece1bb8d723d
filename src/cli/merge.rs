//! `rtc merge`: shares of a picture to the picture.

use super::args::Merge;
use super::interrupt::Interrupt;
use super::target::Staged;
use super::terminal::Terminal;
use super::{Exit, Problem, build, keep};
use rt_lang::output::{Channels, Facts};
use rt_lang::render::halt::Limit;
use rt_lang::saved::{self, Head, Merging};
use std::path::{Path, PathBuf};

/// The attribute of an EXR that tells which part of the picture's samples it has, where some are missing.
const SHARES: &str = "rtc.shares";

/// Puts the shares together, one after the other, so that there are never more than two of them in memory.
pub fn run(arguments: &Merge, terminal: Terminal, interrupt: &Interrupt) -> Result<Exit, Problem> {
    let targets = build::targets(&arguments.outputs)?;
    build::refuse_inputs_as_outputs(&arguments.parts, &build::paths(&targets))?;
    build::refuse_idle_depth(arguments.bits, &targets)?;
    // Adding up many shares takes a while: what cannot be written is to be known before.
    let staged: Vec<Staged> =
        targets.iter().map(|target| target.stage(interrupt)).collect::<Result<_, _>>()?;
    let mut merging: Option<Merging> = None;
    for path in in_order(arguments)? {
        let added = add(merging.as_mut(), path);
        match added {
            Ok(None) => {}
            Ok(Some(first)) => {
                let picture = saved::picture(first.film(), &first.subject().identity);
                build::refuse_misfits(&targets, picture.size, picture.alpha.is_some())?;
                merging = Some(first);
            }
            Err(problem) if arguments.partial => {
                if !arguments.quiet {
                    terminal.warning(&problem.help("it is left out"));
                }
            }
            Err(problem) => return Err(problem),
        }
    }
    let merging = merging.ok_or_else(|| Problem::new("there is no share to begin with"))?;
    let missing = merging.missing();
    if !missing.is_empty() && !arguments.partial {
        let of = merging.share().of;
        return Err(Problem::new(missing_words(&missing, of)).help(format!(
            "make what is missing, beginning with `--shard {}/{of}`, or look at what there is with `--partial`",
            missing[0]
        )));
    }
    let (film, identity) = (merging.film(), &merging.subject().identity);
    let samples = film.pixels().first().map_or(0, |pixel| pixel.samples());
    let facts = Facts { limit: Some(Limit::Samples.word().into()), ..merging.facts().clone() };
    let facts = saved::judged(facts, film, [samples; 2]);
    let picture = saved::picture(film, identity);
    let (shares, of) = (merging.share().of as usize - missing.len(), merging.share().of);
    let mut channels = Channels::default();
    if !missing.is_empty() {
        channels.texts.push((SHARES.into(), format!("{shares} of {of}")));
    }
    build::write(&picture, &facts, &channels, arguments.bits, staged)?;
    if !arguments.quiet {
        if !missing.is_empty() {
            terminal.line(&missing_words(&missing, of));
        }
        let [width, height] = picture.size;
        let noise = facts.noise.map_or(String::new(), |noise| format!(" (noise {:.2} %)", noise * 100.0));
        let shares = if shares == 1 { "1 share".to_string() } else { format!("{shares} shares") };
        let names = build::names(&targets);
        terminal.line(&format!("{names}: {width}×{height}, {samples} samples{noise} of {shares}"));
    }
    Ok(Exit::Done)
}

/// The files such that those come first which go with most of the others, so that it is an odd one that is refused.
fn in_order(arguments: &Merge) -> Result<Vec<&Path>, Problem> {
    let parts: Vec<&Path> = arguments.parts.iter().map(PathBuf::as_path).collect();
    let heads: Vec<Option<Head>> = parts.iter().map(|path| keep::head(path)).collect();
    match saved::most_first(&heads) {
        Ok(order) => Ok(order.into_iter().map(|at| parts[at]).collect()),
        // It is said in what they differ when they are put together.
        Err(_) if !arguments.partial => Ok(parts),
        Err([one, other]) => {
            let [one, other] = [one, other].map(|at| parts[at].display());
            let problem = format!(
                "`{one}` and `{other}` are shares of different pictures, and there are as many that go with the one as with the \
                 other"
            );
            Err(Problem::new(problem)
                .help("give those of one picture; without `--partial` it is said in what they differ"))
        }
    }
}

/// Adds the share of a file to those before it, or begins with it.
fn add(merging: Option<&mut Merging>, path: &Path) -> Result<Option<Merging>, Problem> {
    let name = path.display().to_string();
    let cannot = |why: saved::Refused| Problem::new(format!("`{name}` {why}"));
    let saved = keep::load(path, false)?.map_err(|why| {
        cannot(why).help(
            "a share is an EXR that `rtc build --shard I/N` wrote: make it again, or have `--partial` leave it out",
        )
    })?;
    let refuse = |why| {
        cannot(why).help(
            "give each share once, all of one picture, or have `--partial` leave out what does not go with most",
        )
    };
    match merging {
        Some(merging) => merging.add(&name, &saved).map(|()| None).map_err(refuse),
        None => Merging::new(&name, saved).map(Some).map_err(refuse),
    }
}

/// Names the first few of them.
fn missing_words(missing: &[u32], of: u32) -> String {
    const MOST: usize = 8;
    let listed: Vec<String> = missing.iter().take(MOST).map(u32::to_string).collect();
    let more = missing.len().saturating_sub(MOST);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    match missing.len() {
        1 => format!("share {} of {of} is missing", listed.join("")),
        _ => format!("shares {}{more} of {of} are missing", listed.join(", ")),
    }
}
