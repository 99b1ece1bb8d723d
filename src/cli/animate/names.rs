//! Where the frames of a film go: a file each, with the frame's number in its name, or one file for all.

use super::super::Problem;
use super::super::input::is_standard;
use super::super::target::Target;
use rt_lang::output::Format;
use rt_lang::output::animation::Motion;
use std::fs;
use std::path::{Path, PathBuf};

/// What `-o` means where there are frames.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Output {
    /// A picture a frame.
    Each(Pattern),
    /// A film.
    Film(PathBuf, Form),
}

/// How a film is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// Here.
    Own(Motion),
    /// By ffmpeg, in the container of this name.
    Video(&'static str),
}

/// The names of pictures: a path with the place of a number.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pattern {
    before: String,
    /// The least digits of the number.
    width: usize,
    after: String,
}

/// The containers that ffmpeg is asked for, with its own names of them, by extension.
const CONTAINERS: [(&str, &str); 4] = [("mp4", "mp4"), ("mov", "mov"), ("mkv", "matroska"), ("webm", "webm")];

/// The most digits of a number.
const MOST_DIGITS: usize = 9;

impl Output {
    /// Reads the value of `-o`.
    pub fn from_argument(path: &Path) -> Result<Output, Problem> {
        let text = path.to_string_lossy();
        if path.to_str().is_none() && Pattern::in_name(&text)?.is_some() {
            let problem = Problem::new(format!("`{text}` is not UTF-8, so no frame's number can be put in"));
            return Err(problem.help("give the folder another name, or go into it and leave it out"));
        }
        let form = Form::of(path);
        match (Pattern::in_name(&text)?, form) {
            (Some(_), Some(Form::Video(_))) => {
                let problem = Problem::new(format!("`{text}` is one film, which has no frame's number"));
                Err(problem.help("leave the braces out; a picture a frame has one: `-o frame.{04}.png`"))
            }
            (Some(pattern), _) => {
                // What is wrong with the format, the first frame shows.
                Target::from_argument(&pattern.path(1)).map(|_| Output::Each(pattern))
            }
            (None, Some(form)) => Ok(Output::Film(path.into(), form)),
            (None, None) => Err(not_a_film(path, &text)),
        }
    }

    /// The film beside a scene.
    pub fn beside(scene: &Path) -> Output {
        Output::Film(scene.with_extension("apng"), Form::Own(Motion::Apng))
    }
}

impl Form {
    /// By the extension, or by what stands before `:-`. An animated PNG may be called a PNG; `-` is one.
    fn of(path: &Path) -> Option<Form> {
        if is_standard(path) {
            return Some(Form::Own(Motion::Apng));
        }
        let text = path.to_str().unwrap_or_default();
        let standard = text.strip_suffix(":-");
        let extension = standard.or_else(|| path.extension()?.to_str())?.to_ascii_lowercase();
        match extension.as_str() {
            "apng" | "png" => Some(Form::Own(Motion::Apng)),
            "webp" => Some(Form::Own(Motion::WebP)),
            video if standard.is_none() => {
                CONTAINERS.iter().find(|(name, _)| *name == video).map(|(_, own)| Form::Video(own))
            }
            _ => None,
        }
    }

    /// As one calls it.
    pub fn name(self) -> &'static str {
        match self {
            Form::Own(Motion::Apng) => "animated PNG",
            Form::Own(Motion::WebP) => "animated WebP",
            Form::Video(_) => "video",
        }
    }
}

/// The path that a film on standard output or in a file has for who writes it.
pub fn place(path: &Path) -> PathBuf {
    let standard = path.to_str().is_some_and(|text| text.ends_with(":-"));
    if standard { "-".into() } else { path.into() }
}

/// A name without a number whose format holds one picture, or none.
fn not_a_film(path: &Path, text: &str) -> Problem {
    let extension = path.extension().map(|extension| extension.to_string_lossy().into_owned());
    let known = extension.as_deref().and_then(Format::from_extension);
    match (known, extension) {
        (Some(_), Some(extension)) => {
            let stem = text.strip_suffix(&format!(".{extension}")).unwrap_or(text);
            Problem::new(format!("all frames would go to the one picture `{text}`")).help(format!(
                "say where the frame's number goes: `-o {stem}.{{04}}.{extension}`; or make a film: `-o {stem}.webp`"
            ))
        }
        (None, _) if CONTAINERS.iter().any(|(name, _)| text == format!("{name}:-")) => {
            let problem = Problem::new("a video is written to a file, and not to standard output");
            problem.help("name the file: `-o film.mp4`; `apng:-` and `webp:-` can go there")
        }
        (None, _) if text.ends_with(":-") || extension_is_missing(path) => {
            Problem::new(format!("`{text}` does not say the format of a film")).help(FORMS)
        }
        _ => Problem::new(format!("`{text}` is in no format of films")).help(FORMS),
    }
}

fn extension_is_missing(path: &Path) -> bool {
    path.extension().is_none()
}

const FORMS: &str =
    "films are apng, webp, mp4, mov, mkv and webm; a picture a frame has its number: `-o frame.{04}.png`";

impl Pattern {
    /// The pattern of a path; none where it has no braces. Folders may be called whatever they are: theirs are the place of a
    /// number only where they look it.
    fn in_name(text: &str) -> Result<Option<Pattern>, Problem> {
        let start = text.rfind(std::path::is_separator).map_or(0, |at| at + 1);
        let (folders, name) = text.split_at(start);
        let in_folders = Pattern::in_folders(folders);
        let in_file = Pattern::in_file(name)?;
        match (in_folders, in_file) {
            (Some(pattern), in_file) => {
                if in_file.is_some() || Pattern::in_folders(&pattern.after).is_some() {
                    return Err(two_places(text));
                }
                Ok(Some(Pattern { after: pattern.after + name, ..pattern }))
            }
            (None, in_file) => {
                Ok(in_file
                    .map(|pattern| Pattern { before: format!("{folders}{}", pattern.before), ..pattern }))
            }
        }
    }

    /// The first place of a number in the names of folders.
    fn in_folders(text: &str) -> Option<Pattern> {
        text.match_indices('{').find_map(|(at, _)| {
            let (inside, after) = text[at + 1..].split_once('}')?;
            let width = digits(inside)?;
            Some(Pattern { before: text[..at].into(), width, after: after.into() })
        })
    }

    fn in_file(text: &str) -> Result<Option<Pattern>, Problem> {
        if let Some(foreign) = foreign(text) {
            let problem = Problem::new(format!("`{foreign}` is no place for a frame's number"));
            return Err(problem.help("write `{04}`: four digits, with zeros before"));
        }
        let Some((before, rest)) = text.split_once('{') else { return Ok(None) };
        let Some((inside, after)) = rest.split_once('}') else {
            let problem = Problem::new(format!("the `{{` of `{text}` is not closed"));
            return Err(problem.help("the place of a frame's number is `{04}`"));
        };
        if after.contains('{') {
            return Err(two_places(text));
        }
        match digits(inside) {
            Some(width) => Ok(Some(Pattern { before: before.into(), width, after: after.into() })),
            None => {
                let problem = Problem::new(format!("`{{{inside}}}` is no place for a frame's number"));
                Err(problem.help("write `{04}` for four digits with zeros before, or `{}` for none"))
            }
        }
    }

    /// Where the frames of a film are kept, in a folder beside it.
    pub fn kept(film: &str) -> Pattern {
        Pattern { before: format!("{film}.frames/"), width: 6, after: ".exr".into() }
    }

    /// The same with something behind the name.
    pub fn with(self, suffix: &str) -> Pattern {
        Pattern { after: self.after + suffix, ..self }
    }

    /// The file of a frame.
    pub fn path(&self, number: u32) -> PathBuf {
        let Pattern { before, width, after } = self;
        format!("{before}{number:0width$}{after}").into()
    }

    /// Whose file this is; none where it is of no frame.
    pub fn number(&self, path: &str) -> Option<u32> {
        let number = path.strip_prefix(&self.before)?.strip_suffix(&self.after)?.parse().ok()?;
        (self.path(number).to_str() == Some(path)).then_some(number)
    }

    /// Whether there is a folder a frame.
    pub fn has_folders(&self) -> bool {
        self.after.contains(std::path::is_separator)
    }

    /// The files of some frames that are there, each with whether it is a link. Of a folder of a million frames that are to be
    /// made it costs nothing. The numbers are in order.
    pub fn there(&self, numbers: &[u32]) -> Vec<(PathBuf, bool)> {
        let is_link = |path: PathBuf| {
            let link = fs::symlink_metadata(&path).ok()?.is_symlink();
            Some((path, link))
        };
        if self.has_folders() {
            return numbers.iter().filter_map(|number| is_link(self.path(*number))).collect();
        }
        let (folder, _) =
            self.before.split_at(self.before.rfind(std::path::is_separator).map_or(0, |at| at + 1));
        let listed =
            fs::read_dir(if folder.is_empty() { "." } else { folder }).into_iter().flatten().flatten();
        let of_frame = |entry: fs::DirEntry| {
            let path = format!("{folder}{}", entry.file_name().to_str()?);
            let wanted = numbers.binary_search(&self.number(&path)?).is_ok();
            wanted.then(|| (path.into(), entry.file_type().is_ok_and(|kind| kind.is_symlink())))
        };
        listed.filter_map(of_frame).collect()
    }

    /// Where a picture goes.
    pub fn target(&self, number: u32) -> Result<Target, Problem> {
        Target::from_argument(&self.path(number))
    }
}

/// How many digits braces ask for, if they are the place of a number.
fn digits(inside: &str) -> Option<usize> {
    let all = inside.bytes().all(|byte| byte.is_ascii_digit());
    let width = if inside.is_empty() { Some(1) } else { inside.parse().ok() };
    width.filter(|width| all && (1..=MOST_DIGITS).contains(width))
}

fn two_places(text: &str) -> Problem {
    Problem::new(format!("`{text}` has two places for the frame's number")).help("keep one of them")
}

/// Whether a name has the place of a frame's number, so that frames were probably meant.
pub fn has_number(path: &Path) -> bool {
    path.to_str().is_some_and(|text| matches!(Pattern::in_name(text), Ok(Some(_))))
}

/// The place of a number as other programs write it: `%04d` or `####`.
fn foreign(text: &str) -> Option<&str> {
    if let Some(start) = text.find("##") {
        let rest = &text[start..];
        return Some(&rest[..rest.find(|c| c != '#').unwrap_or(rest.len())]);
    }
    let (start, _) = text.match_indices('%').find(|(start, _)| {
        text[start + 1..].trim_start_matches(|c: char| c.is_ascii_digit()).starts_with('d')
    })?;
    let rest = &text[start..];
    Some(&rest[..rest.find('d').map_or(rest.len(), |end| end + 1)])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Output, String> {
        Output::from_argument(Path::new(text))
            .map_err(|problem| format!("{} / {}", problem.message, problem.help.unwrap_or_default()))
    }

    #[test]
    fn a_number_stands_where_the_braces_are() {
        let path = |text: &str| match read(text) {
            Ok(Output::Each(pattern)) => pattern.path(7).display().to_string(),
            other => panic!("{text}: {other:?}"),
        };
        assert_eq!(path("out.{04}.exr"), "out.0007.exr");
        assert_eq!(path("{}.png"), "7.png");
        assert_eq!(path("a{2}b/c.jpg"), "a07b/c.jpg");
        // Folders are called as they are.
        assert_eq!(path("100%done/{a}/##/%04d/f{}.png"), "100%done/{a}/##/%04d/f7.png");
        assert_eq!(path("{a/{b}/{3}/c.png"), "{a/{b}/007/c.png");
    }

    #[cfg(unix)]
    #[test]
    fn what_is_no_text_is_not_written_as_another_name() {
        use std::os::unix::ffi::OsStrExt;
        let path = |bytes: &'static [u8]| Path::new(std::ffi::OsStr::from_bytes(bytes));
        let refused = Output::from_argument(path(b"q\xff{}.png")).unwrap_err();
        assert!(refused.message.contains("is not UTF-8"), "{}", refused.message);
        let film = Output::from_argument(path(b"q\xff.webp")).unwrap();
        assert_eq!(film, Output::Film(path(b"q\xff.webp").into(), Form::Own(Motion::WebP)));
    }

    #[cfg(unix)]
    #[test]
    fn pictures_that_are_there_are_found() {
        let folder = tempfile::tempdir().unwrap();
        let text = format!("{}/f{{2}}.png", folder.path().display());
        let Ok(Some(pattern)) = Pattern::in_name(&text) else { panic!("{text}") };
        let path = |name: &str| folder.path().join(name);
        for name in ["f01.png", "f1.png", "f07.png", "f100.png", "f01.png.made", "f+1.png"] {
            fs::write(path(name), "").unwrap();
        }
        std::os::unix::fs::symlink("f1.png", path("f03.png")).unwrap();
        let mut there = pattern.there(&[1, 2, 3, 100]);
        there.sort();
        assert_eq!(there, [(path("f01.png"), false), (path("f03.png"), true), (path("f100.png"), false)]);
        let each = Pattern::in_name(&format!("{}{{}}.png/no", path("f0").display())).unwrap().unwrap();
        assert_eq!(each.there(&[1]), []);
    }

    #[test]
    fn films_are_told_by_their_extension() {
        let film = |text: &str| match read(text) {
            Ok(Output::Film(_, form)) => form,
            other => panic!("{text}: {other:?}"),
        };
        for apng in ["100%done/{a}/a.apng", "a.apng", "a.png", "A.PNG", "-", "png:-"] {
            assert_eq!(film(apng), Form::Own(Motion::Apng), "{apng}");
        }
        assert_eq!((film("a.webp"), film("webp:-")), (Form::Own(Motion::WebP), Form::Own(Motion::WebP)));
        assert_eq!((film("a.mp4"), film("a.mkv")), (Form::Video("mp4"), Form::Video("matroska")));
    }

    #[test]
    fn what_is_wrong_with_a_name_is_taught() {
        for (name, message, help) in [
            ("out.exr", "the one picture `out.exr`", "-o out.{04}.exr"),
            ("out.{04}.{04}.exr", "two places", "keep one"),
            ("{04}/{04}.exr", "two places", "keep one"),
            ("{04}/{}/a.exr", "two places", "keep one"),
            ("out.{04.png", "is not closed", "{04}"),
            ("out.{x}.png", "`{x}` is no place", "{04}"),
            ("out.{99}.png", "`{99}` is no place", "{04}"),
            ("out.%04d.png", "`%04d` is no place", "{04}"),
            ("out.####.png", "`####` is no place", "{04}"),
            ("out.{04}.mp4", "one film", "leave the braces out"),
            ("out.{04}.gif", "no format", "png"),
            ("out.gif", "no format of films", "webp"),
            ("out", "does not say", "webp"),
            ("exr:-", "does not say", "webp"),
        ] {
            let said = read(name).unwrap_err();
            assert!(said.contains(message) && said.contains(help), "{name}: {said}");
        }
        assert!(has_number(Path::new("a.{04}.png")) && !has_number(Path::new("a.png")));
    }
}
