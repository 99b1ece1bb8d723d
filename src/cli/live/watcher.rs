//! Tells when files may have changed.
//!
//! It is the folders that are watched, not the files: a file that is replaced by renaming is another one. What a link leads
//! through is watched too, and of a file that is missing the nearest folder that is there.

use crate::cli::Problem;
use notify::event::{AccessKind, AccessMode, EventKind};
use notify::{RecommendedWatcher, RecursiveMode, Watcher as _};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Component, Path, PathBuf};
use std::time::Duration;

/// Links that lead to links, at most.
const MOST_LINKS: usize = 16;

/// How often files are looked at where the system does not tell of changes.
const PERIOD: Duration = Duration::from_millis(500);

/// Watches for changes until it is dropped.
pub struct Watcher {
    /// None where files are looked at from time to time.
    system: Option<RecommendedWatcher>,
    /// Those that are watched, each with what tells it from another of its name.
    folders: BTreeMap<PathBuf, Option<[u64; 2]>>,
    tell: Tell,
}

/// Hears which paths may have changed: files, links, or folders with all that is in them. None where it is not known which.
type Tell = std::sync::Arc<dyn Fn(&[PathBuf]) + Send + Sync>;

impl Watcher {
    /// Calls `tell` whenever a watched file may have changed, or every so often where a period is given.
    pub fn new(
        period: Option<Duration>,
        tell: impl Fn(&[PathBuf]) + Send + Sync + 'static,
    ) -> Result<Watcher, Problem> {
        let tell: Tell = std::sync::Arc::new(tell);
        let mut watcher = Watcher { system: None, folders: BTreeMap::new(), tell: tell.clone() };
        match period {
            Some(period) => poll(period, &tell)?,
            None => {
                let told = move |event: notify::Result<notify::Event>| {
                    match event {
                        Ok(event) if is_change(event.kind) => tell(&event.paths),
                        // Reading a file is no change of it.
                        Ok(_) => {}
                        // Some events may be lost.
                        Err(_) => tell(&[]),
                    }
                };
                match notify::recommended_watcher(told) {
                    Ok(system) => watcher.system = Some(system),
                    Err(_) => poll(PERIOD, &watcher.tell)?,
                }
            }
        }
        Ok(watcher)
    }

    /// Watches these files and no others.
    pub fn follow(&mut self, files: impl IntoIterator<Item = PathBuf>) {
        let Some(system) = &mut self.system else { return };
        let mut wanted: BTreeMap<PathBuf, Vec<PathBuf>> = BTreeMap::new();
        for file in files {
            for folder in trace(&file).folders {
                wanted.entry(folder).or_default().push(file.clone());
            }
        }
        // A folder that was made anew is another one, though it has the name.
        let gone = |(folder, identity): (&PathBuf, &Option<[u64; 2]>)| {
            (!wanted.contains_key(folder) || *identity != identity_of(folder)).then(|| folder.clone())
        };
        for folder in self.folders.iter().filter_map(gone).collect::<Vec<_>>() {
            // It may be gone for the system too.
            let _ = system.unwatch(&folder);
            self.folders.remove(&folder);
        }
        let (mut deaf, mut fresh) = (false, vec![]);
        for (folder, files) in wanted {
            if self.folders.contains_key(&folder) {
                continue;
            }
            let identity = identity_of(&folder);
            match system.watch(&folder, RecursiveMode::NonRecursive) {
                Ok(()) => {
                    fresh.extend(files);
                    self.folders.insert(folder, identity);
                }
                // One that has gone in the meantime changes what is above it, which is looked at next.
                Err(_) => deaf |= folder.is_dir(),
            }
        }
        if deaf && poll(PERIOD, &self.tell).is_ok() {
            // The system watches no more folders than it likes.
            self.system = None;
        } else if !fresh.is_empty() {
            // What changed before it was watched was not told.
            (self.tell)(&fresh);
        }
    }
}

/// What tells a folder from another of the same name.
fn identity_of(folder: &Path) -> Option<[u64; 2]> {
    let metadata = fs::metadata(folder).ok()?;
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        Some([metadata.dev(), metadata.ino()])
    }
    #[cfg(not(unix))]
    metadata.is_dir().then_some([0; 2])
}

/// Whether something is another than before.
fn is_change(kind: EventKind) -> bool {
    !matches!(kind, EventKind::Access(access) if access != AccessKind::Close(AccessMode::Write))
}

/// How a file is reached.
#[derive(Default)]
struct Trace {
    /// Its path, and those that links make of it on the way.
    names: BTreeSet<PathBuf>,
    /// The folders in which a change may make the path lead to something else.
    folders: BTreeSet<PathBuf>,
}

/// The paths by which a file is reached: a change of one of them, or of a folder on its way, may be a change of the file.
pub fn names(file: &Path) -> BTreeSet<PathBuf> {
    trace(file).names
}

fn trace(path: &Path) -> Trace {
    let mut found = Trace::default();
    if let Ok(path) = std::path::absolute(path) {
        found.follow(path, MOST_LINKS);
    }
    found
}

impl Trace {
    fn follow(&mut self, path: PathBuf, links: usize) {
        // The nearest folder that is there; what comes to be in it is looked at again.
        let there = path.ancestors().skip(1).find(|folder| folder.is_dir());
        self.folders.extend(there.map(Path::to_path_buf));
        for part in path.ancestors() {
            let (Ok(target), Some(around)) = (fs::read_link(part), part.parent()) else { continue };
            self.folders.insert(around.to_path_buf());
            let mut target = joined(around, &target);
            target.extend(path.strip_prefix(part));
            if links > 0 && !self.names.contains(&target) {
                self.names.insert(path.clone());
                self.follow(target, links - 1);
            }
        }
        self.names.insert(path);
    }
}

/// Where a path leads that is told from a folder, without `..`.
fn joined(folder: &Path, path: &Path) -> PathBuf {
    let mut joined = folder.to_path_buf();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir => {
                // Above a link is what is above that to which it leads.
                if joined.is_symlink() {
                    joined = fs::canonicalize(&joined).unwrap_or(joined);
                }
                joined.pop();
            }
            other => joined.push(other),
        }
    }
    joined
}

/// Tells every so often, as long as somebody else may want to tell as well.
fn poll(period: Duration, tell: &Tell) -> Result<(), Problem> {
    let tell = std::sync::Arc::downgrade(tell);
    let started = std::thread::Builder::new().name("poll".into()).spawn(move || {
        loop {
            std::thread::sleep(period);
            match tell.upgrade() {
                Some(tell) => tell(&[]),
                None => return,
            }
        }
    });
    started.map(drop).map_err(|error| Problem::new(format!("cannot start a thread: {error}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folders(path: &Path) -> BTreeSet<PathBuf> {
        trace(path).folders
    }

    #[test]
    fn the_folder_of_a_file_is_watched_or_the_nearest_that_is_there() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("a.rt"), "").unwrap();
        let own = BTreeSet::from([folder.path().to_path_buf()]);
        assert_eq!(folders(&folder.path().join("a.rt")), own);
        assert_eq!(folders(&folder.path().join("none.rt")), own);
        assert_eq!(folders(&folder.path().join("none/of/these.rt")), own);
    }

    #[cfg(unix)]
    #[test]
    fn links_are_watched_with_what_they_lead_to() {
        use std::os::unix::fs::symlink;
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::create_dir_all(at("v1/deep")).unwrap();
        fs::create_dir(at("links")).unwrap();
        fs::write(at("v1/deep/a.rt"), "").unwrap();
        symlink("../v1", at("links/now")).unwrap();
        symlink("loop", at("loop")).unwrap();
        let found = folders(&at("links/now/deep/a.rt"));
        for watched in ["links", "links/now/deep", "v1/deep"] {
            assert!(found.contains(&at(watched)), "{watched}: {found:?}");
        }
        assert!(folders(&at("loop")).contains(folder.path()));
        // Also where a way out of a link goes.
        symlink("links/now/../v1/deep/a.rt", at("back.rt")).unwrap();
        let found = names(&at("back.rt"));
        for name in ["back.rt", "v1/deep/a.rt"] {
            assert!(found.contains(&at(name)), "{name}: {found:?}");
        }
        assert_eq!(names(&at("none.rt")).first(), Some(&at("none.rt")));
    }
}
