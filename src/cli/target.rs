//! Where pictures go. A file is written beside its place and moved there when it is whole; until then
//! whatever was there before stays.

use super::input::is_standard;
use super::interrupt::Interrupt;
use super::{Problem, plain};
use rt_lang::output::Format;
use std::fs::{self, Permissions};
use std::io::{self, IsTerminal, Write, stdout};
use std::path::{Path, PathBuf};
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
        if is_standard(&self.path) {
            if stdout().is_terminal() {
                let problem = Problem::new("a picture is not text: it is not written to a terminal");
                return Err(problem.help("send it to a file or a program: `-o - > picture.png`"));
            }
            return Ok(Staged { target: self.clone(), file: None, interrupt: interrupt.clone() });
        }
        let cannot =
            |reason: String| Problem::new(format!("cannot write `{}`: {reason}", self.path.display()));
        let existing = fs::metadata(&self.path).ok();
        if existing.as_ref().is_some_and(|existing| !existing.is_file()) {
            return Err(cannot("there is something that is not a file".into()));
        }
        // Where a link stands, what it points to is replaced, not the link.
        let path = fs::canonicalize(&self.path).unwrap_or_else(|_| self.path.clone());
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        if !folder.is_dir() {
            return Err(cannot(format!("there is no folder `{}`", folder.display())));
        }
        let made = interrupt.create(|| {
            let file = temporary(existing.map(|existing| existing.permissions())).tempfile_in(folder)?;
            let path = file.path().to_path_buf();
            Ok((file, path))
        });
        let file = made.map_err(|error| cannot(plain(&error)))?;
        Ok(Staged { target: self.clone(), file: Some((file, path)), interrupt: interrupt.clone() })
    }
}

/// Replaces a text that stands at this path, or leaves it as it is.
pub fn replace(path: &Path, bytes: &[u8], interrupt: &Interrupt) -> Result<(), Problem> {
    // A text has no format of pictures, and nothing here asks for it.
    let mut staged = Target { path: path.into(), format: Format::Png }.stage(interrupt)?;
    staged.write(bytes)?;
    staged.finish()
}

/// The permissions of a file that is replaced, else those that the umask leaves.
fn temporary(existing: Option<Permissions>) -> tempfile::Builder<'static, 'static> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".rtc-").suffix(".tmp");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(existing.unwrap_or(Permissions::from_mode(0o666)));
    }
    #[cfg(not(unix))]
    let _ = existing;
    builder
}

fn unknown_format(name: &str) -> Problem {
    Problem::new(format!("`{name}` is no format of pictures")).help(known_formats())
}

fn known_formats() -> String {
    let known = Format::extensions().collect::<Vec<_>>().join(", ");
    format!("the formats are {known}; standard output is `-` (PNG) or `exr:-`")
}

/// A place that has been made sure of. Dropped, it leaves no trace.
pub struct Staged {
    /// What it is for.
    pub target: Target,
    /// The file beside its place, and the place; none for standard output.
    file: Option<(NamedTempFile, PathBuf)>,
    interrupt: Interrupt,
}

impl Staged {
    /// Writes all bytes and waits until they are on the disk.
    pub fn write(&mut self, bytes: &[u8]) -> Result<(), Problem> {
        let written = match &mut self.file {
            Some((file, _)) => {
                let file = file.as_file_mut();
                file.write_all(bytes).and_then(|()| file.sync_all())
            }
            None => {
                let mut stdout = stdout().lock();
                stdout.write_all(bytes).and_then(|()| stdout.flush())
            }
        };
        written.map_err(|error| self.cannot(&error))
    }

    /// Moves the file to its place.
    pub fn finish(mut self) -> Result<(), Problem> {
        let Some((file, place)) = self.file.take() else { return Ok(()) };
        let path = file.path().to_path_buf();
        let moved = self.interrupt.settle(&path, || file.persist(place).map(drop).map_err(|e| e.error));
        moved.map_err(|error| self.cannot(&error))
    }

    fn cannot(&self, error: &io::Error) -> Problem {
        let name = if is_standard(&self.target.path) {
            "standard output".to_string()
        } else {
            format!("`{}`", self.target.path.display())
        };
        Problem::new(format!("cannot write {name}: {}", plain(error)))
    }
}

impl Drop for Staged {
    fn drop(&mut self) {
        if let Some((file, _)) = self.file.take() {
            let path = file.path().to_path_buf();
            self.interrupt.settle(&path, || drop(file));
        }
    }
}
