//! Files beside a place, to be written and then moved there.
//!
//! Their names are known before, and each is of one process at a time: of the one that holds the file's lock while the name is
//! that of this file. What a process has left that was killed is nobody's, and goes when the next one comes. Nobody removes or
//! moves a file of such a name but under its lock, and only after seeing that the name is still of it: between making a file and
//! locking it others may come, who take it for one that was left. Where several processes may write the same, their names have
//! numbers, which are of nobody for whom another one is in the way.
//!
//! The disks of some farms know no locks. There a file gets a name that no other has, and what was left stays. So it does where
//! another program writes a file: some systems let nobody else write what is locked.
//!
//! What is left must not stand in the way of the next one, so a file can always be written by its owner while it is beside its
//! place, whatever the permissions are that it gets when it is moved there.

use super::interrupt::Interrupt;
use std::fs::{self, File, OpenOptions, Permissions, TryLockError};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::thread;
use std::time::Duration;
use tempfile::{Builder, NamedTempFile};

/// How the names of files end that are being written.
const SUFFIX: &str = ".tmp";

/// How they begin.
const PREFIX: &str = ".rtc-";

/// How often others may come between before it is said that they are at it.
const ATTEMPTS: u32 = 16;

/// How many processes write the same at once before names are chosen for them.
const MOST: u32 = 8;

/// For at least so long a process has what another has left, which it removes.
const MOMENT: Duration = Duration::from_millis(2);

/// The file beside a place of this name.
pub fn path(folder: &Path, name: &str) -> PathBuf {
    folder.join(format!("{PREFIX}{name}{SUFFIX}"))
}

/// Whether a file has such a name.
pub fn is_ours(path: &Path) -> bool {
    let name = path.file_name().and_then(|name| name.to_str());
    name.is_some_and(|name| name.starts_with(PREFIX) && name.ends_with(SUFFIX))
}

/// Makes a file in a folder for what is to be called so, also while others have one for the same, and in nobody's way. Its owner
/// may write it, and besides it has these permissions, or those that the umask leaves. It is the first of `.rtc-NAME.1.tmp` and
/// so on that can be had, or else has a name that no other has.
pub fn any(
    folder: &Path,
    name: &str,
    permissions: Option<Permissions>,
    interrupt: &Interrupt,
) -> io::Result<NamedTempFile> {
    remove_all_left(folder, name);
    let had = numbered(name).find_map(|name| take_name(folder, &name, permissions.clone(), interrupt).ok());
    had.map_or_else(|| lone(folder, permissions, interrupt), Ok)
}

/// Makes a file whose name no other has, for another program that writes it. Nobody holds its lock.
pub fn lone(
    folder: &Path,
    permissions: Option<Permissions>,
    interrupt: &Interrupt,
) -> io::Result<NamedTempFile> {
    create(interrupt, || builder(permissions).prefix(PREFIX).tempfile_in(folder))
}

/// Makes the file `.rtc-NAME.tmp` in a folder and takes it for this process. While it is of another one the error is
/// [`ErrorKind::ResourceBusy`], and where there is something that is no plain file [`ErrorKind::InvalidInput`].
pub fn always(
    folder: &Path,
    name: &str,
    permissions: Option<Permissions>,
    interrupt: &Interrupt,
) -> io::Result<NamedTempFile> {
    remove_all_left(folder, name);
    match take_name(folder, name, permissions.clone(), interrupt) {
        Err(error) if error.kind() == ErrorKind::ResourceBusy => {
            thread::sleep(MOMENT);
            take_name(folder, name, permissions, interrupt)
        }
        taken => taken,
    }
}

/// The names of what several processes write.
fn numbered(name: &str) -> impl Iterator<Item = String> {
    (1..=MOST).map(move |number| format!("{name}.{number}"))
}

/// Removes all that was left for what is called so, by whichever kind of process, as far as it may be.
fn remove_all_left(folder: &Path, name: &str) {
    numbered(name).chain([name.to_string()]).for_each(|name| drop(remove_left(&path(folder, &name))));
}

fn take_name(
    folder: &Path,
    name: &str,
    permissions: Option<Permissions>,
    interrupt: &Interrupt,
) -> io::Result<NamedTempFile> {
    let (prefix, path) = (format!("{PREFIX}{name}"), path(folder, name));
    for _ in 0..ATTEMPTS {
        // Not while a file is being made, for whoever is asked to end waits for that, and these files are of others.
        let made = remove_left(&path).and_then(|()| {
            let mut builder = builder(permissions.clone());
            builder.prefix(&prefix).rand_bytes(0);
            create(interrupt, || take(builder.tempfile_in(folder)?))
        });
        match made {
            // Others came between.
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            // There are no locks.
            Err(error) if error.kind() == ErrorKind::Unsupported => {
                let prefix = format!("{prefix}-");
                return create(interrupt, || builder(permissions).prefix(&prefix).tempfile_in(folder));
            }
            made => return made,
        }
    }
    Err(ErrorKind::ResourceBusy.into())
}

/// Whether the name of a file is still of it.
pub fn is_own(file: &NamedTempFile) -> bool {
    is_at(file.as_file(), file.path())
}

/// Removes a file, unless its name is of another one by now.
pub fn discard(file: NamedTempFile) {
    if !is_own(&file) {
        // Kept is what others have there.
        let _ = file.keep();
    }
}

fn builder<'a>(permissions: Option<Permissions>) -> Builder<'a, 'static> {
    let mut builder = Builder::new();
    builder.suffix(SUFFIX);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let mode = permissions.map_or(0o666, |permissions| permissions.mode() & 0o777 | 0o600);
        builder.permissions(Permissions::from_mode(mode));
    }
    #[cfg(not(unix))]
    let _ = permissions;
    builder
}

fn create(
    interrupt: &Interrupt,
    make: impl FnOnce() -> io::Result<NamedTempFile>,
) -> io::Result<NamedTempFile> {
    interrupt.create(|| {
        let file = make()?;
        let path = file.path().to_path_buf();
        Ok((file, path))
    })
}

/// Locks a file that was made. Where another process has come before, it is that one's: it already exists.
fn take(file: NamedTempFile) -> io::Result<NamedTempFile> {
    let locked = lock(file.as_file());
    match locked {
        Ok(()) if is_own(&file) => Ok(file),
        Err(error) if error.kind() == ErrorKind::Unsupported => Err(error),
        _ => {
            let _ = file.keep();
            Err(ErrorKind::AlreadyExists.into())
        }
    }
}

/// Removes what a process has left that was killed, and not what one is writing.
fn remove_left(path: &Path) -> io::Result<()> {
    let left = match fs::symlink_metadata(path) {
        // Opening a pipe may never end.
        Ok(left) if !left.is_file() => Err(ErrorKind::InvalidInput.into()),
        // Some systems lock only what may be written; what another user has left may often be read alone.
        Ok(_) => match OpenOptions::new().read(true).write(true).open(path) {
            Err(error) if error.kind() == ErrorKind::PermissionDenied => File::open(path),
            opened => opened,
        },
        Err(error) => Err(error),
    };
    let left = match left {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(()),
        left => left?,
    };
    lock(&left)?;
    match is_at(&left, path) {
        true => fs::remove_file(path),
        false => Err(ErrorKind::AlreadyExists.into()),
    }
}

/// Locks a file for this process. While another one has it the error is [`ErrorKind::ResourceBusy`], and where nothing can
/// be locked [`ErrorKind::Unsupported`].
fn lock(file: &File) -> io::Result<()> {
    file.try_lock().map_err(|error| match error {
        TryLockError::WouldBlock => ErrorKind::ResourceBusy.into(),
        TryLockError::Error(_) => ErrorKind::Unsupported.into(),
    })
}

/// Whether what stands at a path is this file.
fn is_at(file: &File, path: &Path) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        let id = |metadata: fs::Metadata| (metadata.dev(), metadata.ino());
        let (Ok(own), Ok(there)) = (file.metadata(), fs::symlink_metadata(path)) else { return false };
        id(own) == id(there)
    }
    // Elsewhere nobody can remove a file that is open.
    #[cfg(not(unix))]
    {
        let _ = (file, path);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicU32, Ordering::SeqCst};

    fn claimed(folder: &Path) -> io::Result<NamedTempFile> {
        always(folder, "a.png", None, &Interrupt::default())
    }

    #[test]
    fn a_name_is_of_one_at_a_time_and_what_was_left_goes() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(".rtc-a.png.tmp");
        fs::write(&path, "of one that was killed").unwrap();
        let first = claimed(folder.path()).unwrap();
        assert_eq!((first.path(), fs::read(&path).unwrap()), (path.as_path(), vec![]));
        assert_eq!(claimed(folder.path()).unwrap_err().kind(), ErrorKind::ResourceBusy);
        drop(first);
        assert!(claimed(folder.path()).is_ok() && !path.exists());
    }

    #[test]
    fn a_name_that_another_has_is_no_reason_to_stop_and_what_was_left_goes() {
        let folder = tempfile::tempdir().unwrap();
        let any = |name: &str| super::any(folder.path(), name, None, &Interrupt::default()).unwrap();
        let names = || {
            let names = fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name());
            let mut names: Vec<String> = names.map(|name| name.into_string().unwrap()).collect();
            names.sort();
            names
        };
        let leave = |number: &str| {
            fs::write(folder.path().join(format!(".rtc-a.png{number}.tmp")), "of one that was killed")
                .unwrap();
        };
        ["", ".1", ".2", ".7"].into_iter().for_each(leave);
        let (first, second) = (any("a.png"), any("a.png"));
        assert_eq!(names(), [".rtc-a.png.1.tmp", ".rtc-a.png.2.tmp"]);
        assert!(fs::read(first.path()).unwrap().is_empty());
        // Neither of the two kinds is in the way of the other, and each removes what either has left.
        ["", ".7"].into_iter().for_each(leave);
        let alone = claimed(folder.path()).unwrap();
        assert_eq!(names(), [".rtc-a.png.1.tmp", ".rtc-a.png.2.tmp", ".rtc-a.png.tmp"]);
        let many: Vec<NamedTempFile> = (0..MOST).map(|_| any("a.png")).collect();
        assert_eq!(names().len(), 3 + many.len());
        // With what stands around it, it is too long for a name.
        drop((first, second, alone, many, any(&"n".repeat(250))));
        fs::create_dir(folder.path().join(".rtc-a.png.1.tmp")).unwrap();
        drop(any("a.png"));
        assert_eq!(names(), [".rtc-a.png.1.tmp"], "the folder alone, which is nobody's to remove");
    }

    #[test]
    fn what_is_lent_has_a_name_of_its_own_and_may_be_locked() {
        let folder = tempfile::tempdir().unwrap();
        let [first, second] = [(); 2].map(|()| lone(folder.path(), None, &Interrupt::default()).unwrap());
        assert_ne!(first.path(), second.path());
        lock(&File::open(first.path()).unwrap()).expect("nobody has it");
    }

    #[test]
    fn many_at_once_never_share_a_file() {
        let folder = tempfile::tempdir().unwrap();
        let (within, taken) = (AtomicU32::new(0), AtomicU32::new(0));
        thread::scope(|scope| {
            for _ in 0..8 {
                scope.spawn(|| {
                    for _ in 0..400 {
                        let Ok(file) = claimed(folder.path()) else { continue };
                        assert_eq!(within.fetch_add(1, SeqCst), 0, "of two at once");
                        assert!(is_own(&file), "the name is of another");
                        taken.fetch_add(1, SeqCst);
                        within.fetch_sub(1, SeqCst);
                        // As often left behind, as by one that was killed.
                        if taken.load(SeqCst) % 2 == 0 {
                            let _ = file.keep();
                        }
                    }
                });
            }
        });
        assert!(taken.load(SeqCst) > 100, "{taken:?}");
    }

    #[cfg(unix)]
    #[test]
    fn a_name_that_is_of_another_by_now_is_left_to_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(".rtc-a.png.tmp");
        let file = claimed(folder.path()).unwrap();
        fs::remove_file(&path).unwrap();
        fs::write(&path, "of another").unwrap();
        assert!(!is_own(&file));
        discard(file);
        assert_eq!(fs::read(&path).unwrap(), b"of another");
        let old = NamedTempFile::new_in(folder.path()).unwrap();
        fs::rename(&path, old.path()).unwrap();
        let place = old.path().to_path_buf();
        assert_eq!(take(old).unwrap_err().kind(), ErrorKind::AlreadyExists);
        assert_eq!(fs::read(place).unwrap(), b"of another");
    }

    #[cfg(unix)]
    #[test]
    fn a_pipe_is_not_waited_for() {
        let folder = tempfile::tempdir().unwrap();
        let made = std::process::Command::new("mkfifo").arg(folder.path().join(".rtc-a.png.tmp")).status();
        assert!(made.unwrap().success());
        assert_eq!(claimed(folder.path()).unwrap_err().kind(), ErrorKind::InvalidInput);
    }
}
