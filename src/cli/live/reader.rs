//! Reading a scene that somebody is writing.
//!
//! Editors write in many ways: in place, emptying the file first, aside and then renamed, the old one moved away before. What
//! is read in between is half of a text, or none. A scene is compiled when what it reads has come to hold something else
//! than it did; and what looks like half of a text is read again for a while before it is believed.

use crate::cli::Problem;
use crate::cli::args::Reading;
use crate::cli::input;
use crate::cli::scene::{self, Loaded};
use rt_lang::diagnostic::{Code, any_errors};
use rt_lang::lower::Overrides;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};

/// How long half of a text is waited for.
const PATIENCE: Duration = Duration::from_millis(500);
/// How long a text that lacks its end is waited for where it has no errors.
const DOUBT: Duration = Duration::from_millis(50);
/// What has errors behind what looked like half of a text is believed when it has been the same for so long.
const STILL: Duration = Duration::from_millis(30);
/// How often it is looked at meanwhile.
const GLANCE: Duration = Duration::from_millis(5);
/// A file that was changed so recently may change again without a new time.
const FRESH: Duration = Duration::from_secs(1);

/// What a file looks like from outside.
#[derive(Clone, Copy, Debug)]
struct Look {
    length: u64,
    /// When it was written, and when it came to be what it is, also under this name.
    changed: [Option<SystemTime>; 2],
    /// Which file it is, whatever it is called.
    identity: [u64; 2],
    taken: SystemTime,
}

impl Look {
    /// Whether it looks the same, and is old enough to tell by that: a file that was changed just now may change again without
    /// a new time.
    fn tells_same(&self, before: &Look) -> bool {
        let outside = |look: &Look| (look.length, look.changed, look.identity);
        let newest = before.changed.iter().flatten().max();
        let age = newest.and_then(|changed| before.taken.duration_since(*changed).ok());
        outside(self) == outside(before) && age.is_some_and(|age| age > FRESH)
    }
}

/// A file that the scene read.
#[derive(Clone, Debug)]
struct Known {
    look: Option<Look>,
    /// None where there was nothing to read.
    hash: Option<blake3::Hash>,
    length: usize,
}

/// Reads and compiles a scene in another way: of texts that are not saved.
pub type Load = Box<dyn Fn(&Reading, &Overrides) -> Result<Loaded, Problem> + Send>;

/// Reads a scene whenever what it reads has changed.
pub struct Reader {
    scene: PathBuf,
    reading: Reading,
    overrides: Overrides,
    /// In place of the disk: what it gives is whole, and may be new whenever somebody looks.
    load: Option<Load>,
    /// What is written by the one who reads: never a reason to read.
    own: BTreeSet<PathBuf>,
    known: BTreeMap<PathBuf, Known>,
    /// The text that was read last.
    text: String,
    /// Since when it looks as if somebody were writing.
    doubtful: Option<Instant>,
    /// The text that was read meanwhile, and since when it has been the same.
    still: Option<(String, Instant)>,
}

/// What looking at the files leads to.
pub enum Seen {
    /// They hold what they did.
    Same,
    /// They may be half written: look again after this long.
    Later(Duration),
    /// A scene was compiled, or could not be read.
    New(Box<Result<Loaded, Problem>>),
}

impl Reader {
    /// For a scene; nothing is read yet.
    pub fn new(scene: &Path, reading: &Reading, overrides: Overrides, own: &[PathBuf]) -> Reader {
        Reader {
            scene: scene.into(),
            reading: reading.clone(),
            overrides,
            load: None,
            own: own.iter().filter_map(|path| std::path::absolute(path).ok()).collect(),
            known: BTreeMap::new(),
            text: String::new(),
            doubtful: None,
            still: None,
        }
    }

    /// The same, in another way.
    pub fn by(self, load: Load) -> Reader {
        Reader { load: Some(load), ..self }
    }

    /// The settings of the command line by name, which are then for the caller to give. None where they are not all of
    /// different names, which the compiler will say.
    pub fn take_settings(&mut self) -> BTreeMap<String, String> {
        let pair = |setting: &String| {
            setting.split_once('=').map(|(name, value)| (name.trim().to_string(), value.trim().to_string()))
        };
        let pairs: Option<BTreeMap<String, String>> = self.reading.set.iter().map(pair).collect();
        let whole = pairs.filter(|pairs| pairs.len() == self.reading.set.len());
        if whole.is_some() {
            self.reading.set.clear();
        }
        whole.unwrap_or_default()
    }

    /// The files that matter.
    pub fn files(&self) -> impl Iterator<Item = PathBuf> {
        self.known.keys().cloned().chain([self.scene.clone()])
    }

    /// Looks whether something has changed, and if so reads and compiles. `set` stands beside the settings of the command
    /// line, in whose place it comes; `anyway` compiles also what is the same; `reads` is called before anything is read.
    pub fn look(&mut self, set: &BTreeMap<String, String>, anyway: bool, reads: impl FnOnce()) -> Seen {
        let anyway = anyway || self.load.is_some();
        if !anyway && self.doubtful.is_none() && !self.known.is_empty() && !self.has_changed() {
            return Seen::Same;
        }
        reads();
        let reading = Reading { set: settings(&self.reading.set, set), ..self.reading.clone() };
        // Looked at before they are read: what changes in between looks otherwise later.
        let looks = self.files().map(|path| (absolute(&path), look(&path))).collect();
        let loaded = match &self.load {
            Some(load) => load(&reading, &self.overrides),
            None => scene::load(&self.scene, &reading, &self.overrides),
        };
        let known = self.read_by(&loaded, &looks);
        if let Some(wait) = self.doubt(&loaded, &known) {
            return Seen::Later(wait);
        }
        (self.doubtful, self.still) = (None, None);
        self.known = known;
        if let Ok(loaded) = &loaded {
            self.text.clone_from(&loaded.sources.get(loaded.id).text);
        }
        Seen::New(Box::new(loaded))
    }

    /// How long to wait before what was read is believed, if it looks as if somebody were in the middle of writing it.
    fn doubt(
        &mut self,
        loaded: &Result<Loaded, Problem>,
        known: &BTreeMap<PathBuf, Known>,
    ) -> Option<Duration> {
        if self.load.is_some() {
            return None;
        }
        let had = |path: &PathBuf| self.known.get(path).is_some_and(|before| before.length > 0);
        let emptied = known.iter().any(|(path, now)| now.length == 0 && had(path));
        let (wrong, cut) = match loaded {
            Err(_) => (true, had(&absolute(&self.scene))),
            Ok(loaded) => {
                let text = &loaded.sources.get(loaded.id).text;
                let cut = text.len() < self.text.len() && self.text.starts_with(text.as_str());
                (any_errors(&loaded.compiled.diagnostics), cut)
            }
        };
        // Whoever emptied it, or wrote half of it, may still be writing what has errors.
        let whole = !emptied && !cut;
        if whole && (!wrong || self.doubtful.is_none() || self.is_still(loaded)) {
            return None;
        }
        let since = *self.doubtful.get_or_insert_with(Instant::now);
        let patience = if wrong || emptied { PATIENCE } else { DOUBT };
        (since.elapsed() < patience).then_some(GLANCE)
    }

    /// Whether the text of a scene has been the same for a while.
    fn is_still(&mut self, loaded: &Result<Loaded, Problem>) -> bool {
        let Ok(loaded) = loaded else { return false };
        let text = &loaded.sources.get(loaded.id).text;
        match &self.still {
            Some((known, since)) if known == text => since.elapsed() >= STILL,
            _ => {
                self.still = Some((text.clone(), Instant::now()));
                false
            }
        }
    }

    /// Whether a file holds something else than when it was read.
    fn has_changed(&mut self) -> bool {
        let Reader { known, own, .. } = self;
        known.iter_mut().filter(|(path, _)| !own.contains(*path)).any(|(path, known)| {
            let look = look(path);
            let same = match (&look, &known.look) {
                (Some(now), Some(before)) => now.tells_same(before),
                (None, None) => known.hash.is_none(),
                _ => false,
            };
            if same {
                return false;
            }
            known.look = look;
            // Of another length it need not be read.
            let length = look.map_or(0, |look| look.length as usize);
            length != known.length || hashed(path) != known.hash
        })
    }

    /// What a scene has read.
    fn read_by(
        &self,
        loaded: &Result<Loaded, Problem>,
        looks: &BTreeMap<PathBuf, Option<Look>>,
    ) -> BTreeMap<PathBuf, Known> {
        // One that nobody looked at before is read again when something happens.
        let look = |path: &PathBuf| looks.get(path).copied().flatten();
        let asked = loaded.iter().flat_map(|loaded| loaded.files.held());
        let mut known: BTreeMap<PathBuf, Known> = asked
            .map(|(path, bytes)| {
                let path = absolute(&path);
                let (hash, length) =
                    (bytes.as_deref().map(blake3::hash), bytes.map_or(0, |bytes| bytes.len()));
                (path.clone(), Known { look: look(&path), hash, length })
            })
            .collect();
        if loaded.is_err() {
            // What it would read is what it read before.
            known.extend(self.known.iter().map(|(path, known)| (path.clone(), known.clone())));
        }
        let scene = absolute(&self.scene);
        let look = look(&scene);
        let (hash, length) = match loaded {
            // What is no text is not held: it is read again until it is old enough to be known by its time.
            Ok(loaded) if refused(loaded) => (None, usize::MAX),
            Ok(loaded) => {
                let text = &loaded.sources.get(loaded.id).text;
                (Some(blake3::hash(text.as_bytes())), text.len())
            }
            Err(_) => (None, 0),
        };
        known.insert(scene, Known { look, hash, length });
        known
    }
}

/// Settings of the command line, but for those of the same name.
fn settings(given: &[String], set: &BTreeMap<String, String>) -> Vec<String> {
    let name = |setting: &str| setting.split('=').next().unwrap_or("").trim().to_string();
    let kept = given.iter().filter(|setting| !set.contains_key(&name(setting))).cloned();
    kept.chain(set.iter().map(|(name, value)| format!("{name}={value}"))).collect()
}

/// Whether the bytes of a scene were not worth compiling.
fn refused(loaded: &Loaded) -> bool {
    let codes = [Code::E0009, Code::E0406];
    loaded.sources.len() == 1
        && loaded.compiled.diagnostics.iter().any(|diagnostic| codes.contains(&diagnostic.code))
}

fn look(path: &Path) -> Option<Look> {
    let metadata = std::fs::metadata(path).ok()?;
    let (length, taken) = (metadata.len(), SystemTime::now());
    let (named, identity) = identity(&metadata);
    Some(Look { length, changed: [metadata.modified().ok(), named], identity, taken })
}

/// When a file came to be what it is under its name, and which it is.
#[cfg(unix)]
fn identity(metadata: &std::fs::Metadata) -> (Option<SystemTime>, [u64; 2]) {
    use std::os::unix::fs::MetadataExt;
    let since = Duration::new(metadata.ctime().max(0) as u64, metadata.ctime_nsec() as u32);
    (SystemTime::UNIX_EPOCH.checked_add(since), [metadata.dev(), metadata.ino()])
}

#[cfg(not(unix))]
fn identity(metadata: &std::fs::Metadata) -> (Option<SystemTime>, [u64; 2]) {
    (metadata.created().ok(), [0; 2])
}

/// The hash of what a plain file holds.
fn hashed(path: &Path) -> Option<blake3::Hash> {
    let plain = std::fs::metadata(path).is_ok_and(|metadata| metadata.is_file());
    let bytes = plain.then(|| input::read_bytes(path, u64::MAX - 1).ok()).flatten()?;
    Some(blake3::hash(&bytes))
}

fn absolute(path: &Path) -> PathBuf {
    std::path::absolute(path).unwrap_or_else(|_| path.into())
}
