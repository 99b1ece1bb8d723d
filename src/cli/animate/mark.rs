//! Frames that are done, each with a record beside it of what it was made of: so that a film that is made again makes only
//! those that are missing or would be others now.

use super::super::interrupt::Interrupt;
use super::super::target::{Target, replace};
use super::super::trace::Plan;
use super::super::{Problem, input};
use rt_lang::aov::{self, Aov};
use rt_lang::output::{Depth, Facts};
use rt_lang::scene::{Scene, identity::Identity};
use std::collections::BTreeMap;
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

/// The largest record that is read.
const LARGEST: u64 = 1 << 16;
/// How names of records end.
const SUFFIX: &str = ".made";
/// How many differences are named.
const MOST_NAMED: usize = 3;

/// What a frame depends on, each with a name and a value.
pub type Subject = Vec<(String, String)>;

/// What is known of a frame.
#[derive(Debug, PartialEq, Eq)]
pub enum Found {
    /// It was never made.
    Nothing,
    /// It is there, as it would be made now.
    Done,
    /// It was made, and is another one, with the reason.
    Other(String),
}

/// What a frame depends on.
pub fn subject(scene: &Scene, plan: &Plan, aovs: &[Aov], depth: Depth) -> Subject {
    let window = plan.window();
    let identity = Identity::new(scene, [window.x, window.y, window.width, window.height]);
    let own = |(name, value): (&str, &str)| (name.to_string(), value.to_string());
    let mut subject: Subject = identity.entries().map(own).collect();
    let limits = plan.limits();
    let names: Vec<&str> =
        Aov::ALL.iter().filter(|(aov, _)| aovs.contains(aov)).map(|(_, name)| *name).collect();
    let more = [
        ("program", Facts::unknown().software),
        ("samples", limits.samples.to_string()),
        ("noise", or_none(limits.noise)),
        ("least samples", limits.least.to_string()),
        ("time", or_none(limits.time.map(|time| time.as_secs_f64()))),
        ("exposure", or_none(scene.develop.exposure)),
        ("tonemap", scene.develop.tonemap.word().to_string()),
        ("bits", if depth == Depth::Sixteen { "16" } else { "8" }.to_string()),
        ("channels", names.join(" ")),
        ("names", aov::names(aovs, plan.from()).map_or("none".into(), |hash| hash.to_hex().to_string())),
        ("denoising", if plan.denoises() { "yes" } else { "no" }.to_string()),
    ];
    subject.extend(more.map(|(name, value)| (name.to_string(), value)));
    subject
}

fn or_none(number: Option<f64>) -> String {
    number.map_or("none".to_string(), |number| number.to_string())
}

/// Where the record of a frame is that goes to these files; none where it goes to none.
fn path(targets: &[Target]) -> Option<PathBuf> {
    let mut name = targets.first()?.path.clone().into_os_string();
    name.push(SUFFIX);
    Some(name.into())
}

/// Looks whether a frame is done. One whose record cannot be read is made anew: that is less than to make none behind it.
pub fn find(subject: &Subject, targets: &[Target]) -> Found {
    let Some(path) = path(targets) else { return Found::Nothing };
    let read =
        input::is_there(&path).and_then(|there| there.then(|| input::read_plain(&path, LARGEST)).transpose());
    let bytes = match read {
        Ok(None) => return Found::Nothing,
        Ok(Some(bytes)) => bytes,
        Err(problem) => return Found::Other(problem.message),
    };
    let text = String::from_utf8(bytes).unwrap_or_default();
    // Values may hold anything, names no colons.
    let recorded: BTreeMap<&str, &str> = text.lines().filter_map(|line| line.split_once(": ")).collect();
    let mut different = vec![];
    for (name, value) in subject {
        match recorded.get(name.as_str()) {
            Some(known) if known == value => {}
            // What is a hash says nothing, and what comes from a file may be anything.
            Some(known) if value.len() < 64 => {
                let known: String = known.escape_debug().take(40).collect();
                different.push(format!("its {name} ({known}, not {value})"));
            }
            _ => different.push(format!("its {name}")),
        }
    }
    if !different.is_empty() {
        different.truncate(MOST_NAMED);
        return Found::Other(format!("it differs in {}", different.join(", ")));
    }
    for target in targets {
        let written = recorded.get(file_entry(target).as_str());
        if !written.is_some_and(|written| is_as_written(&target.path, written)) {
            return Found::Other(format!("`{}` is not the file that was made", target.path.display()));
        }
    }
    Found::Done
}

/// Records that a frame is done, once its files are in their places.
pub fn record(subject: &Subject, targets: &[Target], interrupt: &Interrupt) -> Result<(), Problem> {
    let Some(path) = path(targets) else { return Ok(()) };
    let files = targets.iter().filter_map(|target| Some((file_entry(target), digest(&target.path)?)));
    let entries = subject.iter().cloned().chain(files);
    let text: String = entries.map(|(name, value)| format!("{name}: {value}\n")).collect();
    replace(&path, text.as_bytes(), interrupt)
}

fn file_entry(target: &Target) -> String {
    let name = target.path.file_name().unwrap_or_default().to_string_lossy();
    // A colon ends the name of an entry.
    format!("file {}", name.escape_debug().to_string().replace(':', "\\u{3a}"))
}

/// How many bytes a file has, and their hash. None where it cannot be read.
fn digest(path: &Path) -> Option<String> {
    let file = input::open_plain(path).ok()?;
    let length = file.metadata().ok()?.len();
    let mut hasher = blake3::Hasher::new();
    // What grows meanwhile is not read without end.
    hasher.update_reader(file.take(length)).ok()?;
    Some(format!("{length} {}", hasher.finalize().to_hex()))
}

/// Whether a file is still that of its digest. One of another length is not read, however long it is.
fn is_as_written(path: &Path, written: &str) -> bool {
    let length = fs::metadata(path).map(|file| file.len().to_string()).ok();
    length.as_deref() == written.split(' ').next() && digest(path).as_deref() == Some(written)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rt_lang::output::Format;

    #[test]
    fn a_frame_is_done_as_long_as_nothing_is_another() {
        let folder = tempfile::tempdir().unwrap();
        let target = Target { path: folder.path().join("a: b.png"), format: Format::Png };
        let targets = [target.clone()];
        let subject =
            |seed: &str| -> Subject { vec![("seed".into(), seed.into()), ("camera".into(), "c".repeat(64))] };
        assert_eq!(find(&subject("0"), &targets), Found::Nothing);
        fs::write(&target.path, "picture").unwrap();
        record(&subject("0"), &targets, &Interrupt::default()).unwrap();
        assert_eq!(find(&subject("0"), &targets), Found::Done);
        let why = "it differs in its seed (0, not 7)";
        assert_eq!(find(&subject("7"), &targets), Found::Other(why.into()));
        fs::write(&target.path, "torn").unwrap();
        assert!(
            matches!(find(&subject("0"), &targets), Found::Other(why) if why.contains("is not the file"))
        );
        fs::write(&target.path, "another of as many bytes as it").unwrap();
        record(&subject("0"), &targets, &Interrupt::default()).unwrap();
        fs::write(&target.path, "another of as many bytes as It").unwrap();
        assert!(matches!(find(&subject("0"), &targets), Found::Other(_)));
        fs::write(path(&targets).unwrap(), [0xff, b'\n']).unwrap();
        assert!(matches!(find(&subject("0"), &targets), Found::Other(_)));
        // A record that is none, too large, or no file at all.
        let record_path = path(&targets).unwrap();
        fs::write(&record_path, vec![0; 70_000]).unwrap();
        let large = find(&subject("0"), &targets);
        assert!(matches!(large, Found::Other(why) if why.contains("is larger than 64.0 KiB")));
        fs::remove_file(&record_path).unwrap();
        fs::create_dir(&record_path).unwrap();
        assert!(
            matches!(find(&subject("0"), &targets), Found::Other(why) if why.contains("it is not a file"))
        );
        assert_eq!(find(&subject("0"), &[]), Found::Nothing);
    }
}
