//! Where pictures and texts go. A file is written beside its place and moved there when it is whole; until then
//! whatever was there before stays.

use super::build::Context;
use super::input::is_standard;
use super::interrupt::Interrupt;
use super::progress::duration;
use super::{Problem, claim, plain};
use rt_lang::output::Format;
use rt_lang::report::printable_lines;
use std::fs::{self, Permissions};
use std::io::{self, ErrorKind, IsTerminal, Read, Write, stdout};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use tempfile::NamedTempFile;

/// A picture's destination and form.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Target {
    /// As given; `-` is standard output.
    pub path: PathBuf,
    /// By the extension, or by what stands before `:-`.
    pub format: Format,
}

impl Target {
    /// Refuses a place where no file can be.
    pub fn refuse_no_place(&self) -> Result<(), Problem> {
        if is_standard(&self.path) { Ok(()) } else { place(&self.path).map(drop) }
    }

    /// Reads the value of `-o`: a path, `-` for a PNG on standard output, or `exr:-` and the like.
    pub fn from_argument(path: &Path) -> Result<Target, Problem> {
        if is_standard(path) {
            return Ok(Target { path: path.into(), format: Format::Png });
        }
        if let Some(name) = path.to_str().and_then(|text| text.strip_suffix(":-")) {
            let format = Format::from_extension(name).ok_or_else(|| unknown_format(name))?;
            return Ok(Target { path: "-".into(), format });
        }
        if path.is_dir() {
            let problem = Problem::new(format!("the output `{}` is a folder", path.display()));
            return Err(problem.help("name a file in it, such as `picture.png`"));
        }
        let extension = path.extension().ok_or_else(|| {
            let problem = Problem::new(format!("the output `{}` does not say its format", path.display()));
            problem.help(known_formats())
        })?;
        let extension = extension.to_string_lossy();
        let format = Format::from_extension(&extension).ok_or_else(|| unknown_format(&extension))?;
        Ok(Target { path: path.into(), format })
    }

    /// The PNG beside a scene.
    pub fn beside(scene: &Path) -> Target {
        Target { path: scene.with_extension("png"), format: Format::Png }
    }

    /// Makes sure that it can be written, by making the file that will be moved there.
    pub fn stage(&self, interrupt: &Interrupt) -> Result<Staged, Problem> {
        self.stage_as(interrupt, Aside::beside)
    }

    /// The same for a picture that may be begun again and again: see [`Aside::always_beside`].
    pub fn stage_again(&self, interrupt: &Interrupt) -> Result<Staged, Problem> {
        self.stage_as(interrupt, Aside::always_beside)
    }

    fn stage_as(
        &self,
        interrupt: &Interrupt,
        aside: fn(&Path, &Interrupt) -> Result<Aside, Problem>,
    ) -> Result<Staged, Problem> {
        if is_standard(&self.path) {
            if stdout().is_terminal() {
                let problem = Problem::new("a picture is not text: it is not written to a terminal");
                return Err(problem.help("send it to a file or a program: `-o - > picture.png`"));
            }
            return Ok(Staged { target: self.clone(), aside: None });
        }
        let aside = aside(&self.path, interrupt)?;
        Ok(Staged { target: self.clone(), aside: Some(aside) })
    }
}

/// A file that is written beside its place, and moved there when it is whole. Dropped, it leaves no trace.
pub struct Aside {
    /// The place as given.
    path: PathBuf,
    /// The file, and its place with links resolved; none once it is moved.
    file: Option<(NamedTempFile, PathBuf)>,
    /// Those of the file that is replaced.
    permissions: Option<Permissions>,
    interrupt: Interrupt,
}

/// Who may write a file beside its place.
#[derive(Clone, Copy)]
enum Claim {
    /// Each process one of its own.
    Any,
    /// Another program, for this process.
    Lent,
    /// This process alone, under a name with this behind it.
    Always(&'static str),
}

impl Aside {
    /// Makes the file beside its place, which shows that it can be written. Others may do the same at once.
    pub fn beside(path: &Path, interrupt: &Interrupt) -> Result<Aside, Problem> {
        Aside::make(path, Claim::Any, interrupt)
    }

    /// The same for another program that writes it: see [`Aside::lend`].
    pub fn to_lend(path: &Path, interrupt: &Interrupt) -> Result<Aside, Problem> {
        Aside::make(path, Claim::Lent, interrupt)
    }

    /// The same for a place that one process writes again and again: the file has always the same name, so that what is left
    /// of one that was killed is not left for ever. While another process writes there it is an error.
    pub fn always_beside(path: &Path, interrupt: &Interrupt) -> Result<Aside, Problem> {
        Aside::make(path, Claim::Always(""), interrupt)
    }

    /// Keeps a place for this process as long as this lives, also between one writing and the next. Nothing is written to it.
    pub fn hold(path: &Path, interrupt: &Interrupt) -> Result<Aside, Problem> {
        Aside::make(path, Claim::Always(".lock"), interrupt)
    }

    fn make(path: &Path, claim: Claim, interrupt: &Interrupt) -> Result<Aside, Problem> {
        let permissions = fs::metadata(path).ok().map(|existing| existing.permissions());
        let place = place(path)?;
        let folder = folder(&place);
        // Of the place, so that whoever comes by another link finds the same.
        let name = place.file_name().unwrap_or_default().to_string_lossy();
        let refused = |error| cannot_write(&shown(path), &error);
        let file = match claim {
            Claim::Any => claim::any(folder, &name, permissions.clone(), interrupt).map_err(refused)?,
            Claim::Lent => claim::lone(folder, permissions.clone(), interrupt).map_err(refused)?,
            Claim::Always(suffix) => {
                let name = format!("{name}{suffix}");
                claim::always(folder, &name, permissions.clone(), interrupt).map_err(|error| {
                    let left = claim::path(folder, &name);
                    match error.kind() == ErrorKind::PermissionDenied && left.exists() {
                        true => refused(error)
                            .help(format!("`{}` was left by another user: remove it", left.display())),
                        false => refused(error),
                    }
                })?
            }
        };
        Ok(Aside { path: path.into(), file: Some((file, place)), permissions, interrupt: interrupt.clone() })
    }

    /// Writes all bytes and waits until they are on the disk.
    pub fn write(&mut self, bytes: &[u8]) -> Result<(), Problem> {
        let Some((file, _)) = &mut self.file else { return Ok(()) };
        let written = file.as_file_mut().write_all(bytes);
        written.map_err(|error| cannot_write(&shown(&self.path), &error))?;
        self.sync()
    }

    /// The file, for who writes it piece by piece, and then calls [`Aside::sync`].
    pub fn file(&self) -> io::Result<fs::File> {
        self.file.as_ref().map_or(Err(io::ErrorKind::NotFound.into()), |(file, _)| file.as_file().try_clone())
    }

    /// The name of the file, if it is one [`Aside::to_lend`], for another program that writes it; then comes [`Aside::sync`].
    pub fn lend(&self) -> PathBuf {
        self.file.as_ref().map_or_else(PathBuf::new, |(file, _)| file.path().to_path_buf())
    }

    /// Waits until what was written is on the disk.
    pub fn sync(&mut self) -> Result<(), Problem> {
        let Some((file, _)) = &self.file else { return Ok(()) };
        let synced = file.as_file().sync_all();
        synced.map_err(|error| cannot_write(&shown(&self.path), &error))
    }

    /// Moves the file to its place.
    pub fn finish(mut self) -> Result<(), Problem> {
        let Some((file, place)) = self.file.take() else { return Ok(()) };
        let path = file.path().to_path_buf();
        let moved = self.interrupt.settle(&path, || {
            if !claim::is_own(&file) {
                claim::discard(file);
                return Err(ErrorKind::ResourceBusy.into());
            }
            if let Some(permissions) = self.permissions.take() {
                // Where they cannot be given, what is written counts for more.
                let _ = file.as_file().set_permissions(permissions);
            }
            file.persist(&place).map(drop).map_err(|error| error.error)
        });
        moved.map_err(|error| cannot_write(&shown(&self.path), &error))?;
        sync_folder(&place);
        Ok(())
    }
}

impl Drop for Aside {
    fn drop(&mut self) {
        if let Some((file, _)) = self.file.take() {
            let path = file.path().to_path_buf();
            self.interrupt.settle(&path, || claim::discard(file));
        }
    }
}

/// Writes to standard output what people read. What of it comes from a file steers no terminal, whatever it passes on its way.
pub fn print_words(text: &str) -> Result<(), Problem> {
    print(printable_lines(text).as_bytes())
}

/// Writes a text to standard output: as it is for a program, and for a terminal so that it does not steer it.
pub fn print_text(text: &str) -> Result<(), Problem> {
    if stdout().is_terminal() { print_words(text) } else { print(text.as_bytes()) }
}

/// Writes all there is to standard output, byte by byte as it is.
pub fn print(mut from: impl Read) -> Result<(), Problem> {
    let mut stdout = stdout().lock();
    let written = io::copy(&mut from, &mut stdout).and_then(|_| stdout.flush());
    written.map_err(|error| cannot_write("standard output", &error))
}

/// How many links are followed one after the other, as Linux does.
const MOST_LINKS: usize = 40;

/// The file that is written for a path: where a link stands, what it points to is replaced or made, not the link.
fn place(path: &Path) -> Result<PathBuf, Problem> {
    let cannot = |reason: String| Problem::new(format!("cannot write `{}`: {reason}", path.display()));
    if fs::metadata(path).is_ok_and(|existing| !existing.is_file()) {
        return Err(cannot("there is something that is not a file".into()));
    }
    let mut place = path.to_path_buf();
    // Of a link to what is not there yet the system does not tell the end.
    for _ in 0..MOST_LINKS {
        let Ok(to) = fs::read_link(&place) else { break };
        place = folder(&place).join(to);
    }
    if place.is_symlink() {
        return Err(cannot("its links lead in a circle".into()));
    }
    let place = fs::canonicalize(&place).unwrap_or(place);
    let folder = folder(&place);
    match folder.is_dir() {
        true => Ok(place),
        false => Err(cannot(format!("there is no folder `{}`", folder.display()))),
    }
}

/// The folder that a file lies in.
fn folder(place: &Path) -> &Path {
    place.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// A file as messages call it.
fn shown(path: &Path) -> String {
    format!("`{}`", path.display())
}

fn cannot_write(name: &str, error: &io::Error) -> Problem {
    match error.kind() {
        ErrorKind::ResourceBusy => {
            let problem = Problem::new(format!("cannot write {name}: another process is writing it"))
                .help("wait until that is done, as `--wait` does, or write another file");
            Problem { busy: true, ..problem }
        }
        ErrorKind::InvalidInput => {
            Problem::new(format!("cannot write {name}: what is beside it for that is not a file"))
                .help("remove what has its name with `.rtc-` before it and `.tmp` behind")
        }
        _ => Problem::new(format!("cannot write {name}: {}", plain(error))),
    }
}

/// How often it is tried again what another process has.
const PERIOD: Duration = Duration::from_millis(500);

/// Tries again for so long while another process is at it, and says so once.
pub fn patiently<T>(
    wait: Duration,
    context: &Context,
    mut attempt: impl FnMut() -> Result<T, Problem>,
) -> Result<T, Problem> {
    let (start, mut said) = (Instant::now(), false);
    loop {
        match attempt() {
            Err(problem) if problem.busy && start.elapsed() < wait => {
                if !std::mem::replace(&mut said, true) {
                    context.say(&format!("{}: it is waited for", problem.message));
                }
                std::thread::sleep(PERIOD);
            }
            Err(problem) if problem.busy && said => {
                let waited = format!(
                    "it was waited for {}: give `--wait` longer, or write another file",
                    duration(wait)
                );
                return Err(problem.help(waited));
            }
            ended => return ended,
        }
    }
}

/// Replaces a text that stands at this path, or leaves it as it is.
pub fn replace(path: &Path, bytes: &[u8], interrupt: &Interrupt) -> Result<(), Problem> {
    // A text has no format of pictures, and nothing here asks for it.
    let mut staged = Target { path: path.into(), format: Format::Png }.stage(interrupt)?;
    staged.write(bytes)?;
    staged.finish()
}

/// Waits until it is on the disk which files a folder holds, where that can be asked for: the file is whole either way.
fn sync_folder(place: &Path) {
    if cfg!(unix) {
        let _ = fs::File::open(folder(place)).and_then(|folder| folder.sync_all());
    }
}

fn unknown_format(name: &str) -> Problem {
    let problem = Problem::new(format!("`{name}` is no format of pictures"));
    match name.to_ascii_lowercase().as_str() {
        "apng" | "mp4" | "mov" | "mkv" | "webm" => {
            problem.help("it is one of films, which have frames: `--sweep \"t = 0 to 1\" --frames 48`")
        }
        _ => problem.help(known_formats()),
    }
}

fn known_formats() -> String {
    let known = Format::extensions().collect::<Vec<_>>().join(", ");
    format!("the formats are {known}; standard output is `-` (PNG) or `exr:-`")
}

/// A place that has been made sure of.
pub struct Staged {
    /// What it is for.
    pub target: Target,
    /// The file beside its place; none for standard output.
    aside: Option<Aside>,
}

impl Staged {
    /// Writes all bytes and waits until they are on the disk.
    pub fn write(&mut self, bytes: &[u8]) -> Result<(), Problem> {
        match &mut self.aside {
            Some(aside) => aside.write(bytes),
            None => print(bytes),
        }
    }

    /// Moves the file to its place.
    pub fn finish(self) -> Result<(), Problem> {
        self.aside.map_or(Ok(()), Aside::finish)
    }
}
