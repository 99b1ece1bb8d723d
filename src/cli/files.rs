//! The disk as a scene may see it: files below one folder, the root, and nothing else.
//!
//! A scene may come from a stranger. A path that a link leads out of the root by is refused, and so is whatever is
//! no plain file, since reading a pipe may never end. What was asked for is kept: the same path gives the same bytes
//! for as long as this lives, and the list tells what a picture depends on, files that were missing included.

use super::{Problem, plain};
use rt_lang::files::{FileError, FilePath, Files};
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The most names of a folder that are listed.
const MOST_NAMES: usize = 10_000;

/// Files below a folder, each read once.
#[derive(Debug)]
pub struct Disk {
    /// As the user knows it, to name files by.
    shown: PathBuf,
    /// Without links.
    root: PathBuf,
    /// What files hold, whatever is saved; by where they are without links.
    held: BTreeMap<PathBuf, Arc<[u8]>>,
    asked: Mutex<BTreeMap<FilePath, Answer>>,
}

type Answer = Result<Arc<[u8]>, FileError>;

/// A file that was asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Asked {
    /// Its path as the user would write it.
    pub path: PathBuf,
    /// How many bytes it has, or why it cannot be used.
    pub size: Result<usize, FileError>,
}

impl Disk {
    /// The files below a folder.
    ///
    /// # Errors
    ///
    /// If it is no folder.
    pub fn below(folder: &Path) -> Result<Disk, Problem> {
        let shown = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        let cannot = |reason: &str| {
            let problem = Problem::new(format!("the root `{}` {reason}", shown.display()));
            problem.help("`--root` names the folder below which a scene may read")
        };
        let root =
            fs::canonicalize(shown).map_err(|error| cannot(&format!("cannot be used: {}", plain(&error))))?;
        if !root.is_dir() {
            return Err(cannot("is no folder"));
        }
        Ok(Disk { shown: shown.into(), root, held: BTreeMap::new(), asked: Mutex::default() })
    }

    /// Where a scene on the disk stands below the root.
    ///
    /// # Errors
    ///
    /// If it does not.
    pub fn path_of(&self, scene: &Path) -> Result<FilePath, Problem> {
        // A scene that is itself a link belongs where the link stands.
        let folder = scene.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let outside = || {
            let (scene, root) = (scene.display(), self.shown.display());
            let problem = Problem::new(format!("the scene `{scene}` does not lie below the root `{root}`"));
            problem.help("give `--root` a folder that holds it")
        };
        let folder = fs::canonicalize(folder).map_err(|_| outside())?;
        let below = folder.strip_prefix(&self.root).map_err(|_| outside())?;
        let names = below.components().map(|name| name.as_os_str().to_string_lossy());
        let name = scene.file_name().map_or("scene.rt".into(), |name| name.to_string_lossy());
        let path: Vec<_> = names.chain([name]).collect();
        match path.as_slice() {
            [name] => Ok(FilePath::root(name)),
            _ => FilePath::root("").join(&path.join("/")).map_err(|_| outside()),
        }
    }

    /// Has a file hold these bytes, whatever is saved, by each path that leads to it.
    pub fn hold(&mut self, file: &Path, bytes: &[u8]) {
        let real = real_path(file).filter(|real| real.starts_with(&self.root));
        self.held.extend(real.map(|real| (real, bytes.into())));
    }

    /// Every file that was asked for, by path.
    pub fn asked(&self) -> Vec<Asked> {
        let all = self.lock();
        let asked = |(path, answer): (&FilePath, &Answer)| Asked {
            path: self.named(path),
            size: answer.as_ref().map(|bytes| bytes.len()).map_err(Clone::clone),
        };
        all.iter().map(asked).collect()
    }

    /// Every file that was asked for, with what it holds if it can be used.
    pub fn held(&self) -> Vec<(PathBuf, Option<Arc<[u8]>>)> {
        self.lock().iter().map(|(path, answer)| (self.named(path), answer.clone().ok())).collect()
    }

    /// The files that were read.
    pub fn read_paths(&self) -> Vec<PathBuf> {
        self.held().into_iter().filter_map(|(path, bytes)| bytes.map(|_| path)).collect()
    }

    /// A file's path as the user would write it.
    fn named(&self, path: &FilePath) -> PathBuf {
        if self.shown.as_os_str() == "." { path.as_str().into() } else { self.shown.join(path.as_str()) }
    }

    fn lock(&self) -> MutexGuard<'_, BTreeMap<FilePath, Answer>> {
        // An entry is whole or not there.
        self.asked.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn read_now(&self, path: &FilePath, most: usize) -> Answer {
        let path = self.root.join(path.as_str());
        match real_path(&path).and_then(|real| self.held.get(&real)) {
            Some(bytes) if bytes.len() > most => return Err(FileError::TooLarge(most)),
            Some(bytes) => return Ok(bytes.clone()),
            None => {}
        }
        let real = fs::canonicalize(path).map_err(|error| refusal(&error))?;
        if !real.starts_with(&self.root) {
            return Err(FileError::Outside);
        }
        // Asked before it is opened, because opening a pipe waits for its other end.
        plain_file(&fs::metadata(&real).map_err(|error| refusal(&error))?)?;
        let file = File::open(&real).map_err(|error| refusal(&error))?;
        plain_file(&file.metadata().map_err(|error| refusal(&error))?)?;
        let mut bytes = vec![];
        file.take(most as u64 + 1).read_to_end(&mut bytes).map_err(|error| refusal(&error))?;
        if bytes.len() > most { Err(FileError::TooLarge(most)) } else { Ok(bytes.into()) }
    }
}

impl Files for Disk {
    fn read(&self, path: &FilePath, most: usize) -> Answer {
        let mut asked = self.lock();
        match asked.get(path) {
            Some(Ok(bytes)) if bytes.len() > most => return Err(FileError::TooLarge(most)),
            // Too large for one reader, perhaps not for the next.
            Some(Err(FileError::TooLarge(limit))) if most > *limit => {}
            Some(answer) => return answer.clone(),
            None => {}
        }
        let answer = self.read_now(path, most);
        asked.insert(path.clone(), answer.clone());
        answer
    }

    fn list(&self, folder: &str) -> Vec<String> {
        let inside =
            fs::canonicalize(self.root.join(folder)).ok().filter(|real| real.starts_with(&self.root));
        let entries = inside.and_then(|real| fs::read_dir(real).ok()).into_iter().flatten().flatten();
        let named = |entry: fs::DirEntry| {
            let name = entry.file_name().into_string().ok().filter(|name| !name.starts_with('.'))?;
            Some(if entry.path().is_dir() { name + "/" } else { name })
        };
        let mut names: Vec<String> = entries.take(MOST_NAMES).filter_map(named).collect();
        names.sort();
        names
    }

    fn name(&self, path: &FilePath) -> String {
        self.named(path).display().to_string()
    }
}

/// Where a file is, without links; where there is none yet, where it would be.
pub fn real_path(file: &Path) -> Option<PathBuf> {
    let beside = || Some(file.parent()?.canonicalize().ok()?.join(file.file_name()?));
    file.canonicalize().ok().or_else(beside)
}

/// Whether two names that a user may write are of the same file.
pub fn same_name(a: &str, b: &str) -> bool {
    a == b || std::path::absolute(a).ok().is_some_and(|a| std::path::absolute(b).is_ok_and(|b| a == b))
}

fn plain_file(metadata: &fs::Metadata) -> Result<(), FileError> {
    match metadata {
        _ if metadata.is_file() => Ok(()),
        _ if metadata.is_dir() => Err(FileError::Unreadable("is a folder".into())),
        _ => Err(FileError::Unreadable("is no plain file".into())),
    }
}

fn refusal(error: &io::Error) -> FileError {
    match error.kind() {
        // A file where a folder should be holds no file either.
        io::ErrorKind::NotFound | io::ErrorKind::NotADirectory => FileError::Missing,
        _ => FileError::Unreadable(plain(error)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A folder `inside` with some files, beside a file `secret` that is none of its business.
    fn disk() -> (tempfile::TempDir, Disk) {
        let folder = tempfile::tempdir().unwrap();
        let inside = folder.path().join("inside");
        fs::create_dir_all(inside.join("rooms")).unwrap();
        fs::write(inside.join("a.rt"), "abc").unwrap();
        fs::write(inside.join("rooms/hall.rt"), "hall").unwrap();
        fs::write(folder.path().join("secret"), "secret").unwrap();
        let disk = Disk::below(&inside).unwrap();
        (folder, disk)
    }

    fn path(written: &str) -> FilePath {
        FilePath::root("").join(written).unwrap()
    }

    #[test]
    fn a_file_is_read_once_and_its_size_is_bounded() {
        let (folder, disk) = disk();
        assert_eq!(disk.read(&path("a.rt"), 2), Err(FileError::TooLarge(2)));
        assert_eq!(disk.read(&path("a.rt"), 3).as_deref(), Ok(&b"abc"[..]));
        fs::write(folder.path().join("inside/a.rt"), "changed").unwrap();
        assert_eq!(disk.read(&path("a.rt"), 100).as_deref(), Ok(&b"abc"[..]));
        assert_eq!(disk.read(&path("a.rt"), 2), Err(FileError::TooLarge(2)));
        assert_eq!(disk.read(&path("rooms/hall.rt"), 100).as_deref(), Ok(&b"hall"[..]));
    }

    #[test]
    fn folders_below_the_root_are_listed() {
        let (_folder, disk) = disk();
        assert_eq!(
            (disk.list(""), disk.list("rooms")),
            (vec!["a.rt".into(), "rooms/".into()], vec!["hall.rt".into()])
        );
        for none in ["..", "/", "none", "a.rt"] {
            assert_eq!(disk.list(none), Vec::<String>::new(), "{none}");
        }
    }

    #[test]
    fn what_is_missing_is_remembered() {
        let (folder, disk) = disk();
        assert_eq!(disk.read(&path("b.rt"), 9), Err(FileError::Missing));
        assert_eq!(disk.read(&path("a.rt/b.rt"), 9), Err(FileError::Missing));
        fs::write(folder.path().join("inside/b.rt"), "late").unwrap();
        assert_eq!(disk.read(&path("b.rt"), 9), Err(FileError::Missing));
        let asked: Vec<(String, bool)> = disk
            .asked()
            .into_iter()
            .map(|asked| (asked.path.file_name().unwrap().to_string_lossy().into(), asked.size.is_ok()))
            .collect();
        assert_eq!(asked, [("b.rt".to_string(), false), ("b.rt".to_string(), false)]);
    }

    #[test]
    fn folders_are_no_files() {
        let (_folder, disk) = disk();
        assert_eq!(disk.read(&path("rooms"), 9), Err(FileError::Unreadable("is a folder".into())));
    }

    #[cfg(unix)]
    #[test]
    fn links_lead_about_but_not_out() {
        use std::os::unix::fs::symlink;
        let (folder, disk) = disk();
        let inside = folder.path().join("inside");
        symlink("../secret", inside.join("out.rt")).unwrap();
        symlink("rooms/hall.rt", inside.join("in.rt")).unwrap();
        symlink("loop.rt", inside.join("loop.rt")).unwrap();
        symlink(folder.path(), inside.join("up")).unwrap();
        symlink("/dev/zero", inside.join("zero")).unwrap();
        assert_eq!(disk.read(&path("out.rt"), 9), Err(FileError::Outside));
        assert_eq!(disk.read(&path("up/secret"), 9), Err(FileError::Outside));
        assert_eq!(disk.read(&path("zero"), 9), Err(FileError::Outside));
        assert_eq!(disk.read(&path("in.rt"), 9).as_deref(), Ok(&b"hall"[..]));
        assert!(matches!(disk.read(&path("loop.rt"), 9), Err(FileError::Unreadable(_))));
        let dev = Disk::below(Path::new("/dev")).unwrap();
        assert_eq!(dev.read(&path("zero"), 9), Err(FileError::Unreadable("is no plain file".into())));
    }

    #[cfg(unix)]
    #[test]
    fn what_is_held_is_read_by_each_path_that_leads_there() {
        use std::os::unix::fs::symlink;
        let (folder, mut disk) = disk();
        let inside = folder.path().join("inside");
        symlink("rooms", inside.join("linked")).unwrap();
        symlink("rooms/hall.rt", inside.join("in.rt")).unwrap();
        symlink("../secret", inside.join("out.rt")).unwrap();
        disk.hold(&inside.join("linked/hall.rt"), b"open");
        disk.hold(&inside.join("linked/new.rt"), b"new");
        disk.hold(&folder.path().join("secret"), b"open");
        for name in ["rooms/hall.rt", "linked/hall.rt", "in.rt"] {
            assert_eq!(disk.read(&path(name), 9).as_deref(), Ok(&b"open"[..]), "{name}");
        }
        assert_eq!(disk.read(&path("rooms/new.rt"), 9).as_deref(), Ok(&b"new"[..]));
        assert_eq!(disk.read(&path("rooms/new.rt"), 2), Err(FileError::TooLarge(2)));
        assert_eq!(disk.read(&path("out.rt"), 9), Err(FileError::Outside));
    }

    #[cfg(unix)]
    #[test]
    fn a_pipe_is_not_waited_for() {
        let (folder, disk) = disk();
        let pipe = folder.path().join("inside/pipe");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status();
        assert!(made.unwrap().success());
        assert_eq!(disk.read(&path("pipe"), 9), Err(FileError::Unreadable("is no plain file".into())));
    }

    #[test]
    fn a_scene_knows_its_place_below_the_root() {
        let (folder, disk) = disk();
        let inside = folder.path().join("inside");
        assert_eq!(disk.path_of(&inside.join("a.rt")).unwrap(), path("a.rt"));
        assert_eq!(disk.path_of(&inside.join("rooms/../rooms/hall.rt")).unwrap(), path("rooms/hall.rt"));
        assert!(disk.path_of(&folder.path().join("secret")).is_err());
        assert!(Disk::below(&inside.join("a.rt")).is_err() && Disk::below(&inside.join("none")).is_err());
    }
}
