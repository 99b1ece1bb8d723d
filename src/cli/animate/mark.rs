//! Frames that are done, each with a record beside it of what it was made of: so that a film that is made again makes only
//! those that are missing or would be others now.

use super::super::interrupt::Interrupt;
use super::super::target::{Target, replace};
use super::super::trace::Plan;
use super::super::{Problem, args, input};
use rt_lang::aov::{self, Aov};
use rt_lang::output::{Depth, Facts};
use rt_lang::scene::Scene;
use rt_lang::scene::identity::{Identity, difference};
use std::collections::BTreeMap;
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

/// The largest record that is read.
const LARGEST: u64 = 1 << 16;
/// How names of records end.
pub const SUFFIX: &str = ".made";
/// How many differences are named.
const MOST_NAMED: usize = 3;

/// How an entry begins that tells whether the others are whole.
const CHECK: &str = "check: ";
/// What messages call what is there, where it is another one.
const CALLED: &str = "made";

/// What a frame depends on.
pub struct Subject {
    /// The program that makes it, with its version.
    program: String,
    identity: Identity,
    settings: Vec<Setting>,
}

/// What a frame depends on besides its samples.
struct Setting {
    name: &'static str,
    value: String,
    /// As one writes it.
    words: String,
}

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
    let limits = plan.limits();
    let channels: Vec<&str> =
        Aov::ALL.iter().filter(|(aov, _)| aovs.contains(aov)).map(|(_, name)| *name).collect();
    // A number, or none; and as its flag takes it.
    let flag = |name, flag, value: Option<String>| Setting {
        name,
        words: value.as_ref().map_or(format!("no `{flag}`"), |value| format!("`{flag} {value}`")),
        value: value.unwrap_or("none".into()),
    };
    let names = aov::names(aovs, plan.from()).map(|hash| hash.to_hex().to_string());
    let settings = vec![
        flag("noise", "--noise", limits.noise.map(share)),
        flag("samples", "--samples", Some(limits.samples.to_string())),
        flag("least samples", "--min-samples", limits.noise.map(|_| limits.least.to_string())),
        flag("time", "--time", limits.time.map(|time| format!("{}s", time.as_secs_f64()))),
        flag("exposure", "--exposure", scene.develop.exposure.map(|stops| stops.to_string())),
        flag("tonemap", "--tonemap", Some(scene.develop.tonemap.word().into())),
        flag("bits", "--bits", Some(if depth == Depth::Sixteen { "16" } else { "8" }.into())),
        flag("channels", "--aov", (!channels.is_empty()).then(|| channels.join(","))),
        Setting {
            name: "denoising",
            value: if plan.denoises() { "yes" } else { "none" }.into(),
            words: if plan.denoises() { "`--denoise`" } else { "no `--denoise`" }.into(),
        },
        Setting { name: NAMES, value: names.unwrap_or("none".into()), words: "other names".into() },
    ];
    Subject { program: Facts::unknown().software, identity, settings }
}

/// A share as `--noise` takes it: in per cent with few digits, or else as the number that it is.
fn share(share: f64) -> String {
    let percent = format!("{}%", (share * 1e6).round() / 1e4);
    if args::noise(&percent) == Ok(share) { percent } else { share.to_string() }
}

/// The setting whose value is a hash.
const NAMES: &str = "names";

impl Subject {
    /// Each name with its value, as they are recorded.
    fn entries(&self) -> impl Iterator<Item = (String, String)> {
        let identity = self.identity.entries().map(|(name, value)| (name.to_string(), value.to_string()));
        let settings = self.settings.iter().map(|setting| (setting.name.to_string(), setting.value.clone()));
        std::iter::once(("program".to_string(), self.program.clone())).chain(identity).chain(settings)
    }

    /// Why a frame of this record is another one, if it is.
    fn refuses(&self, recorded: &BTreeMap<&str, &str>) -> Option<String> {
        let value = |name: &str| recorded.get(name).map(|value| value.to_string());
        let program = value("program").unwrap_or_default();
        if program != self.program {
            return Some(difference(&self.program, CALLED, &program));
        }
        let Some(identity) = Identity::from_values(value) else {
            return Some("its record is damaged".into());
        };
        let mut different = self.identity.differences(&identity, CALLED);
        // With another noise, how many samples it may take says nothing else.
        let noise = self.settings.iter().find(|setting| setting.name == "noise");
        let of_noise = noise.is_some_and(|noise| value(noise.name).as_ref() != Some(&noise.value));
        for Setting { name, value: own, words } in &self.settings {
            match value(name) {
                Some(known) if known == *own => {}
                Some(_) if *name == NAMES => different.push(words.clone()),
                Some(_) if of_noise && ["samples", "least samples"].contains(name) => {}
                Some(known) => different.push(difference(words, CALLED, &known)),
                None => return Some("its record is damaged".into()),
            }
        }
        let more = different.len().saturating_sub(MOST_NAMED);
        different.truncate(MOST_NAMED);
        if more > 0 {
            different.push(format!("and {more} more"));
        }
        (!different.is_empty()).then(|| different.join(", "))
    }
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
    let Some(text) = whole(&bytes) else {
        return Found::Other(format!("its record `{}` is damaged", path.display()));
    };
    // Values may hold anything, names no colons.
    let recorded: BTreeMap<&str, &str> = text.lines().filter_map(|line| line.split_once(": ")).collect();
    if let Some(why) = subject.refuses(&recorded) {
        return Found::Other(why);
    }
    for target in targets {
        let name = target.path.display();
        let why = match recorded.get(file_entry(target).as_str()) {
            Some(written) if is_as_written(&target.path, written) => continue,
            Some(_) if !target.path.exists() => format!("`{name}` is missing"),
            Some(_) => format!("`{name}` was changed"),
            None => format!("it was made without `{name}`"),
        };
        return Found::Other(why);
    }
    Found::Done
}

/// The entries of a record, if it is as it was written.
fn whole(record: &[u8]) -> Option<&str> {
    let (entries, check) = std::str::from_utf8(record).ok()?.rsplit_once(CHECK)?;
    (check.strip_suffix('\n')? == blake3::hash(entries.as_bytes()).to_hex().as_str()).then_some(entries)
}

/// Records that a frame is done, once its files are in their places.
pub fn record(subject: &Subject, targets: &[Target], interrupt: &Interrupt) -> Result<(), Problem> {
    let Some(path) = path(targets) else { return Ok(()) };
    let files = targets.iter().filter_map(|target| Some((file_entry(target), digest(&target.path)?)));
    let entries = subject.entries().chain(files);
    let mut text: String = entries.map(|(name, value)| format!("{name}: {value}\n")).collect();
    let check = blake3::hash(text.as_bytes());
    text.push_str(&format!("{CHECK}{check}\n"));
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
        let subject = |seed: &str| {
            let value = |name: &str| Some(if name == "seed" { seed.into() } else { name.to_string() });
            let identity = Identity::from_values(value).unwrap();
            Subject { program: "rtc 0".into(), identity, settings: vec![] }
        };
        assert_eq!(find(&subject("0"), &targets), Found::Nothing);
        fs::write(&target.path, "picture").unwrap();
        record(&subject("0"), &targets, &Interrupt::default()).unwrap();
        assert_eq!(find(&subject("0"), &targets), Found::Done);
        let why = "`--seed 7` (made: 0)";
        assert_eq!(find(&subject("7"), &targets), Found::Other(why.into()));
        fs::write(&target.path, "torn").unwrap();
        assert!(matches!(find(&subject("0"), &targets), Found::Other(why) if why.contains("was changed")));
        fs::write(&target.path, "another of as many bytes as it").unwrap();
        record(&subject("0"), &targets, &Interrupt::default()).unwrap();
        fs::write(&target.path, "another of as many bytes as It").unwrap();
        assert!(matches!(find(&subject("0"), &targets), Found::Other(_)));
        // A record that is another by a bit, or is none.
        record(&subject("0"), &targets, &Interrupt::default()).unwrap();
        let record_path = path(&targets).unwrap();
        let written = fs::read(&record_path).unwrap();
        for at in 0..written.len() {
            let mut damaged = written.clone();
            damaged[at] ^= 1;
            fs::write(&record_path, damaged).unwrap();
            let found = find(&subject("0"), &targets);
            assert!(matches!(found, Found::Other(why) if why.ends_with("made` is damaged")), "byte {at}");
        }
        fs::write(&record_path, [0xff, b'\n']).unwrap();
        assert!(matches!(find(&subject("0"), &targets), Found::Other(why) if why.contains("is damaged")));
        // One that is too large, or no file at all.
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
