//! Tells when files may have changed.
//!
//! It is the folders that are watched, not the files: a file that is replaced by renaming is another one. What a link leads
//! through is watched too, and of a file that is missing the nearest folder that is there.

use crate::cli::Problem;
use notify::event::{AccessKind, AccessMode, EventKind};
use notify::{RecommendedWatcher, RecursiveMode, Watcher as _};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
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

type Tell = std::sync::Arc<dyn Fn() + Send + Sync>;

impl Watcher {
    /// Calls `tell` whenever a watched file may have changed, or every so often where a period is given.
    pub fn new(
        period: Option<Duration>,
        tell: impl Fn() + Send + Sync + 'static,
    ) -> Result<Watcher, Problem> {
        let tell: Tell = std::sync::Arc::new(tell);
        let mut watcher = Watcher { system: None, folders: BTreeMap::new(), tell: tell.clone() };
        match period {
            Some(period) => poll(period, &tell)?,
            None => {
                let told = move |event: notify::Result<notify::Event>| {
                    if event.is_ok_and(|event| is_change(event.kind)) {
                        tell();
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
        let mut wanted = BTreeSet::new();
        for file in files {
            places(&file, &mut wanted, MOST_LINKS);
        }
        // A folder that was made anew is another one, though it has the name.
        let gone = |(folder, identity): (&PathBuf, &Option<[u64; 2]>)| {
            (!wanted.contains(folder) || *identity != identity_of(folder)).then(|| folder.clone())
        };
        for folder in self.folders.iter().filter_map(gone).collect::<Vec<_>>() {
            // It may be gone for the system too.
            let _ = system.unwatch(&folder);
            self.folders.remove(&folder);
        }
        let (mut deaf, mut fresh) = (false, false);
        for folder in wanted {
            if self.folders.contains_key(&folder) {
                continue;
            }
            let identity = identity_of(&folder);
            match system.watch(&folder, RecursiveMode::NonRecursive) {
                Ok(()) => {
                    fresh = true;
                    self.folders.insert(folder, identity);
                }
                // One that has gone in the meantime changes what is above it, which is looked at next.
                Err(_) => deaf |= folder.is_dir(),
            }
        }
        if deaf && poll(PERIOD, &self.tell).is_ok() {
            // The system watches no more folders than it likes.
            self.system = None;
        } else if fresh {
            // What changed before it was watched was not told.
            (self.tell)();
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

/// Reading a file is no change of it.
fn is_change(kind: EventKind) -> bool {
    !matches!(kind, EventKind::Access(access) if access != AccessKind::Close(AccessMode::Write))
}

/// The folders in which a change may make a path lead to something else.
fn places(path: &Path, found: &mut BTreeSet<PathBuf>, links: usize) {
    let Ok(path) = std::path::absolute(path) else { return };
    let folder = |path: &Path| path.parent().map(Path::to_path_buf);
    // The nearest folder that is there; what comes to be in it is looked at again.
    let there = path.ancestors().skip(1).find(|folder| folder.is_dir());
    found.extend(there.map(Path::to_path_buf));
    for part in path.ancestors() {
        let Ok(target) = fs::read_link(part) else { continue };
        let Some(around) = folder(part) else { continue };
        if links > 0 {
            let rest = path.strip_prefix(part).unwrap_or(Path::new(""));
            let target = around.join(target);
            let target = if rest.as_os_str().is_empty() { target } else { target.join(rest) };
            places(&target, found, links - 1);
        }
        found.insert(around);
    }
}

/// Tells every so often, as long as somebody else may want to tell as well.
fn poll(period: Duration, tell: &Tell) -> Result<(), Problem> {
    let tell = std::sync::Arc::downgrade(tell);
    let started = std::thread::Builder::new().name("poll".into()).spawn(move || {
        loop {
            std::thread::sleep(period);
            match tell.upgrade() {
                Some(tell) => tell(),
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
        let mut found = BTreeSet::new();
        places(path, &mut found, MOST_LINKS);
        found
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
        for watched in ["links", "links/now/deep"] {
            assert!(found.contains(&at(watched)), "{watched}: {found:?}");
        }
        assert!(
            found
                .iter()
                .any(|found| fs::canonicalize(found).unwrap() == fs::canonicalize(at("v1/deep")).unwrap())
        );
        assert!(folders(&at("loop")).contains(folder.path()));
    }
}
