//! What the flags ask of a film. Everything that can be seen to be wrong before a file is read is found here.

use super::super::args::{Build, Keeping, Resume};
use super::super::build;
use super::super::input::is_standard;
use super::super::keep;
use super::super::messages::on_standard_output;
use super::super::target::Target;
use super::super::{Problem, plain};
use super::names::{Form, Output, Pattern, place};
use super::{mark, only};
use rt_lang::output::animation::{Motion, Rate};
use rt_lang::output::{Depth, Format};
use rt_lang::source::{Source, Sources};
use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};

/// A scene, and what is made of it.
pub struct Orders {
    /// The scene; `-` is standard input.
    pub scene: PathBuf,
    /// How many frames the whole film has.
    pub of: u32,
    /// Those that are made, by their numbers.
    pub numbers: Vec<u32>,
    /// How fast it is played.
    pub rate: Rate,
    /// The films in one file.
    pub films: Vec<(PathBuf, Form)>,
    /// Pictures a frame.
    each: Vec<Pattern>,
    /// Where frames are kept that no picture holds.
    kept: Option<Pattern>,
}

impl Orders {
    /// Reads the flags of a build that has frames.
    pub fn new(arguments: &Build) -> Result<Orders, Problem> {
        keep::refuse_loose_files(arguments)?;
        keep::refuse_idle(&arguments.keeping)?;
        let [scene] = arguments.scenes.as_slice() else {
            let problem =
                Problem::new(format!("a film is of one scene, and here are {}", arguments.scenes.len()));
            return Err(problem.help("make them one by one"));
        };
        refuse_what_films_cannot(arguments)?;
        let of = arguments.animating.frames.unwrap_or(1);
        let numbers = only::frames(arguments.animating.only.as_ref(), of, &|name| std::env::var(name).ok())?;
        let outputs = match arguments.outputs.as_slice() {
            [] if is_standard(scene) => {
                let problem = Problem::new("a scene from standard input has no name to put its film beside");
                return Err(problem.help("say where it goes: `-o film.webp`"));
            }
            [] => vec![Output::beside(scene)],
            outputs => outputs.iter().map(|path| Output::from_argument(path)).collect::<Result<_, _>>()?,
        };
        let (mut films, mut each) = (vec![], vec![]);
        for output in outputs {
            match output {
                Output::Film(path, form) => films.push((path, form)),
                Output::Each(pattern) => each.push(pattern),
            }
        }
        let default = Rate::new(24, 1).ok_or_else(|| Problem::new("24 frames a second are none"))?;
        let rate = arguments.animating.fps.unwrap_or(default);
        let mut orders = Orders { scene: scene.clone(), of, numbers, rate, films, each, kept: None };
        orders.refuse_misfits(arguments)?;
        orders.refuse_no_places()?;
        orders.kept = orders.kept_frames(arguments)?;
        orders.refuse_shorter_films(arguments)?;
        Ok(orders)
    }

    /// Refuses to replace what the film is made of, by its frames, or by what is kept of them: what was read, and what a text of
    /// the sources names, which another frame may read. Only a file that is there can be one of these, and is it by its name
    /// unless it is a link; so a film of a million frames is seen through at once.
    pub fn refuse_inputs(&self, read: &[PathBuf], sources: &Sources) -> Result<(), Problem> {
        let of_frames: Vec<(PathBuf, bool)> =
            self.written().iter().flat_map(|pattern| pattern.there(&self.numbers)).collect();
        let films: Vec<PathBuf> = self.film_paths().collect();
        let paths = || of_frames.iter().map(|(path, _)| path).chain(&films);
        let written: BTreeSet<&OsStr> = paths().filter_map(|path| path.file_name()).collect();
        let texts = sources.iter().flat_map(|(_, source)| texts(source));
        let named = texts.filter(|path| path.file_name().is_some_and(|name| written.contains(name)));
        let inputs: Vec<PathBuf> = read.iter().cloned().chain(named).collect();
        let names: BTreeSet<_> =
            inputs.iter().filter_map(|input| Some(build::same(input).file_name()?.to_owned())).collect();
        let is_near = |(path, link): &&(PathBuf, bool)| {
            *link || path.file_name().is_some_and(|name| names.contains(name))
        };
        let near = of_frames.iter().filter(is_near).map(|(path, _)| path.clone());
        build::refuse_inputs_as_outputs(&inputs, &films.iter().cloned().chain(near).collect::<Vec<_>>())
    }

    /// Refuses to replace a film by some of its frames, where others of it are kept.
    fn refuse_shorter_films(&self, arguments: &Build) -> Result<(), Problem> {
        let others: Vec<u32> =
            (1..=self.of).filter(|number| self.numbers.binary_search(number).is_err()).collect();
        if !arguments.keeping.keeps() || others.is_empty() {
            return Ok(());
        }
        let Some(film) = self.film_paths().find(|path| path.exists()) else { return Ok(()) };
        if self.pictures().all(|pattern| pattern.there(&others).is_empty()) {
            return Ok(());
        }
        let (film, made, of) = (film.display(), self.numbers.len(), self.of);
        let problem = Problem::new(format!(
            "`{film}` would be replaced by {made} of the {of} frames, and others of it are kept"
        ));
        Err(problem.help("leave `--only` out, for what is done is not made again; or name another film"))
    }

    /// The names of the pictures of frames, where they are to be seen or are kept.
    fn pictures(&self) -> impl Iterator<Item = Pattern> {
        self.each.iter().chain(&self.kept).cloned()
    }

    /// The names of all that is written of frames: pictures, and where they are kept, their records and checkpoints.
    fn written(&self) -> Vec<Pattern> {
        let beside = ["", mark::SUFFIX, keep::SUFFIX];
        self.pictures().flat_map(|picture| beside.map(|suffix| picture.clone().with(suffix))).collect()
    }

    fn film_paths(&self) -> impl Iterator<Item = PathBuf> {
        self.films.iter().map(|(path, _)| place(path))
    }

    /// A file that two outputs would go to, if there is one.
    fn twice(&self) -> Option<PathBuf> {
        let mut known = BTreeSet::new();
        if let Some(film) = self.film_paths().find(|path| !known.insert(path.clone())) {
            return Some(film);
        }
        let is_of = |pattern: &Pattern, path: &Path| {
            let number = path.to_str().and_then(|path| pattern.number(path));
            number.is_some_and(|number| self.numbers.binary_search(&number).is_ok())
        };
        (0..self.each.len()).find_map(|at| {
            let (before, pattern) = (&self.each[..at], &self.each[at]);
            let film = known.iter().find(|film| is_of(pattern, film)).cloned();
            // Most films have one name of pictures, and nothing to compare.
            let paths = self.numbers.iter().map(|number| pattern.path(*number));
            film.or_else(|| {
                paths
                    .take_while(|_| !before.is_empty())
                    .find(|path| before.iter().any(|other| is_of(other, path)))
            })
        })
    }

    /// The pictures of a frame.
    pub fn targets(&self, number: u32) -> Result<Vec<Target>, Problem> {
        let mut targets: Vec<Target> =
            self.each.iter().map(|pattern| pattern.target(number)).collect::<Result<_, _>>()?;
        if let Some(kept) = &self.kept {
            targets.push(kept.target(number)?);
        }
        Ok(targets)
    }

    /// What a frame is called.
    pub fn name(&self, number: u32) -> String {
        let frame = format!("frame {number} of {}", self.of);
        match self.each.iter().map(|pattern| pattern.path(number).display().to_string()).collect::<Vec<_>>() {
            names if names.is_empty() => frame,
            names => format!("{}, {frame}", names.join(", ")),
        }
    }

    /// Refuses frames that cannot be written where they go, for want of a folder say. Where only the names of files have the number,
    /// the first frame tells.
    fn refuse_no_places(&self) -> Result<(), Problem> {
        self.each.iter().try_for_each(|pattern| {
            let count = if pattern.has_folders() { self.numbers.len() } else { 1 };
            let mut numbers = self.numbers.iter().take(count);
            numbers.try_for_each(|number| pattern.target(*number)?.refuse_no_place())
        })
    }

    /// Makes the folder of frames that are kept, if there is one.
    pub fn make_folder(&self) -> Result<(), Problem> {
        let first = self.kept.as_ref().map(|kept| kept.path(1));
        let Some(folder) = first.as_deref().and_then(Path::parent) else { return Ok(()) };
        fs::create_dir_all(folder).map_err(|error| {
            Problem::new(format!("cannot make the folder `{}`: {}", folder.display(), plain(&error)))
        })
    }

    fn refuse_misfits(&self, arguments: &Build) -> Result<(), Problem> {
        let first = self.targets(1)?;
        if let Some(twice) = self.twice() {
            return Err(Problem::new(format!("the output `{}` is given twice", twice.display())));
        }
        self.refuse_inputs(&arguments.scenes, &Sources::default())?;
        build::refuse_idle_aovs(&arguments.aov, &first)?;
        let png = |(_, form): &(PathBuf, Form)| *form == Form::Own(Motion::Apng);
        let depth = if self.films.iter().any(png) { Depth::Eight } else { arguments.taking.look.bits };
        build::refuse_idle_depth(depth, &first)?;
        if self.films.is_empty() && arguments.animating.fps.is_some() {
            let problem = Problem::new("`--fps` is for a film in one file, and these are pictures");
            return Err(problem.help("add a film, such as `-o film.webp`, or leave the flag out"));
        }
        let standard = self.films.iter().any(|(path, _)| is_standard(&place(path)));
        if on_standard_output(&arguments.messages) && standard {
            let problem = Problem::new("the film and the messages would both go to standard output");
            return Err(problem.help("write the film to a file, or use `--message-format short`"));
        }
        Ok(())
    }

    /// Where frames are kept, if they are, and no EXR holds them.
    fn kept_frames(&self, arguments: &Build) -> Result<Option<Pattern>, Problem> {
        let held = self.targets(1)?.iter().any(|target| target.format == Format::Exr);
        let Some((film, _)) = self.films.first().filter(|_| arguments.keeping.keeps() && !held) else {
            return Ok(None);
        };
        if is_standard(&place(film)) {
            let problem = Problem::new("a film on standard output has no name to keep its frames beside");
            return Err(problem.help("write it to a file, or keep them: `-o frame.{04}.exr`"));
        }
        let Some(name) = film.to_str() else {
            let problem =
                format!("`{}` is not UTF-8, so its frames cannot be kept beside it", film.display());
            return Err(Problem::new(problem).help("give the film another name"));
        };
        Ok(Some(Pattern::kept(name)))
    }
}

fn refuse_what_films_cannot(arguments: &Build) -> Result<(), Problem> {
    let named = |file: &Path| {
        let problem = Problem::new(format!("`{}` cannot keep all frames of a film", file.display()));
        problem.help("without its name each frame is kept beside its picture")
    };
    match arguments {
        Build { keeping: Keeping { shard: Some(_), .. }, .. } => {
            let problem =
                Problem::new("`--shard` is for one picture, and `--sweep` with `--frames` makes a film");
            Err(problem
                .help("machines share a film by its frames: `--only 1-10`, or `--only auto` in a job array"))
        }
        Build { feedback: true, .. } => {
            let problem =
                Problem::new("`--feedback` is for one picture, and `--sweep` with `--frames` makes a film");
            Err(problem.help("it is of one picture: choose a frame with `--set`"))
        }
        Build { keeping: Keeping { checkpoint: Some(Some(file)), .. }, .. } => Err(named(file)),
        Build { keeping: Keeping { resume: Some(Resume::From(file)), .. }, .. } => Err(named(file)),
        _ => Ok(()),
    }
}

/// The files that texts of a source may name, as a person would write them. It may not even be of the language.
fn texts(source: &Source) -> impl Iterator<Item = PathBuf> {
    let folder = Path::new(&source.name).parent().unwrap_or(Path::new(""));
    let mut rest = source.text.as_str();
    let behind = |text: &'_ str, end: &str| text.find(end).map_or(text.len(), |at| at + end.len());
    let next = move || {
        while let Some(at) = rest.find(['"', '/']) {
            rest = &rest[at..];
            if rest.starts_with("//") {
                rest = &rest[behind(rest, "\n")..];
            } else if rest.starts_with("/*") {
                rest = &rest[behind(rest, "*/")..];
            } else if let Some(text) = rest.strip_prefix('"') {
                let (name, length) = unquoted(text);
                rest = &text[length..];
                return Some(folder.join(name));
            } else {
                rest = &rest[1..];
            }
        }
        None
    };
    std::iter::from_fn(next)
}

/// What a text says, up to its quote or the end of its line, and how much that takes.
fn unquoted(text: &str) -> (String, usize) {
    let (mut said, mut escaped) = (String::new(), false);
    for (at, c) in text.char_indices() {
        match c {
            '\n' => return (said, at),
            '"' if !escaped => return (said, at + 1),
            '\\' if !escaped => escaped = true,
            c => {
                said.push(c);
                escaped = false;
            }
        }
    }
    (said, text.len())
}
