//! A scene with all that it reads: from the command line to what the compiler says of it.

use super::Problem;
use super::args::Reading;
use super::files::Disk;
use super::input::{self, Input, is_standard};
use rt_lang::files::FilePath;
use rt_lang::lower::Overrides;
use rt_lang::source::Sources;
use rt_lang::span::SourceId;
use rt_lang::{Compiled, compile};
use std::path::{Path, PathBuf};

/// A scene that was compiled, or refused.
pub struct Loaded {
    /// Its text, and those of all files that it imports.
    pub sources: Sources,
    /// Its own text.
    pub id: SourceId,
    /// What it read.
    pub files: Disk,
    /// What the compiler made of it.
    pub compiled: Compiled,
}

impl Loaded {
    /// The files that were read beside the scene.
    pub fn read(&self) -> Vec<PathBuf> {
        self.files.read_paths()
    }
}

/// Reads and compiles a scene.
pub fn load(path: &Path, reading: &Reading, overrides: &Overrides) -> Result<Loaded, Problem> {
    let input = input::read(path, reading.limits().source)?;
    take(path, input, reading, overrides)
}

/// Compiles a scene that was read.
pub fn take(path: &Path, input: Input, reading: &Reading, overrides: &Overrides) -> Result<Loaded, Problem> {
    let (files, place) = disk(path, reading)?;
    Ok(take_from(files, place, input, reading, overrides))
}

/// Reads a scene that is to be compiled again and again, with what it may read.
pub fn open(path: &Path, reading: &Reading) -> Result<(Disk, Input), Problem> {
    let mut input = input::read(path, reading.limits().source)?;
    let (files, place) = disk(path, reading)?;
    input.sources.place(input.id, place);
    Ok((files, input))
}

/// Compiles a scene that was read and has its place among files.
pub fn take_from(
    files: Disk,
    place: FilePath,
    input: Input,
    reading: &Reading,
    overrides: &Overrides,
) -> Loaded {
    let Input { mut sources, id, refused } = input;
    sources.place(id, place);
    let compiled = match refused {
        Some(refused) => Compiled::refused(refused),
        None => compile(&files, &mut sources, id, &reading.options(overrides.clone())),
    };
    Loaded { sources, id, files, compiled }
}

/// What a scene may read, and its own place there.
fn disk(path: &Path, reading: &Reading) -> Result<(Disk, FilePath), Problem> {
    let own = if is_standard(path) { Path::new("") } else { path.parent().unwrap_or(Path::new("")) };
    let disk = Disk::below(reading.root.as_deref().unwrap_or(own))?;
    let place = if is_standard(path) { FilePath::root("<stdin>") } else { disk.path_of(path)? };
    Ok((disk, place))
}
