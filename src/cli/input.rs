//! Scene files and standard input to sources.

use super::{Problem, plain};
use rt_lang::diagnostic::{Code, Diagnostic};
use rt_lang::source::{Source, Sources};
use rt_lang::span::{SourceId, Span};
use std::fs::{self, File};
use std::io::{self, Read, stdin};
use std::path::Path;

/// A source that was read, and what is wrong with its bytes.
pub struct Input {
    /// Holds the one source.
    pub sources: Sources,
    /// Its id.
    pub id: SourceId,
    /// Why its text is not worth compiling, if it is not.
    pub refused: Option<Diagnostic>,
}

impl Input {
    /// A text that is at hand.
    pub fn of(source: Source) -> Input {
        let mut sources = Sources::default();
        let id = sources.add(source);
        Input { sources, id, refused: None }
    }
}

/// Whether a path means standard input or output.
pub fn is_standard(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Reads a scene of at most so many bytes.
pub fn read(path: &Path, most: usize) -> Result<Input, Problem> {
    let (name, bytes) = if is_standard(path) {
        ("<stdin>".to_string(), limited(stdin().lock(), most as u64))
    } else {
        if path.is_dir() {
            let problem = Problem::new(format!("`{}` is a folder, not a scene", path.display()));
            return Err(problem.help("name a .rt file in it"));
        }
        (path.display().to_string(), File::open(path).and_then(|file| limited(file, most as u64)))
    };
    let bytes = bytes.map_err(|error| Problem::new(format!("cannot read `{name}`: {}", plain(&error))))?;
    Ok(take(name, bytes, most))
}

/// Reads the bytes of a picture that a user names: a file, a pipe or standard input.
pub fn read_bytes(path: &Path, most: u64) -> Result<Vec<u8>, Problem> {
    match is_standard(path) {
        true => all(path, Ok(stdin().lock()), most),
        false => all(path, File::open(path), most),
    }
}

/// Reads the bytes of a file, or of standard input or a pipe where it need not be `plain`, of which the first, so many, are judged
/// before more are read: by `judge`, why there is no use in that, or how many there may be.
pub fn read_judged<E>(
    path: &Path,
    plain: bool,
    first: u64,
    judge: impl FnOnce(&[u8]) -> Result<u64, E>,
) -> Result<Result<Vec<u8>, E>, Problem> {
    let cannot = |error| cannot_read(path, &error);
    let mut from: Box<dyn Read> = match (plain, is_standard(path)) {
        (true, _) => Box::new(open_plain(path).map_err(cannot)?),
        (false, true) => Box::new(stdin().lock()),
        (false, false) => Box::new(File::open(path).map_err(cannot)?),
    };
    let mut bytes = limited(&mut from, first - 1).map_err(cannot)?;
    let most = match judge(&bytes) {
        Ok(most) => most,
        Err(why) => return Ok(Err(why)),
    };
    let rest = most.saturating_sub(bytes.len() as u64);
    bytes.extend(all(path, Ok(from), rest)?);
    Ok(Ok(bytes))
}

/// Reads the bytes of a file that `rtc` has written.
pub fn read_plain(path: &Path, most: u64) -> Result<Vec<u8>, Problem> {
    all(path, open_plain(path), most)
}

/// Whether there is something at a path. Where that cannot be told, it is not taken for nothing.
pub fn is_there(path: &Path) -> Result<bool, Problem> {
    path.try_exists()
        .map_err(|error| Problem::new(format!("cannot read `{}`: {}", path.display(), plain(&error))))
}

/// Opens a plain file; a pipe would be waited for, maybe for ever.
pub fn open_plain(path: &Path) -> io::Result<File> {
    match fs::metadata(path)?.is_file() {
        true => File::open(path),
        false => Err(io::ErrorKind::InvalidInput.into()),
    }
}

/// A file that a user names cannot be read.
pub fn cannot_read(path: &Path, error: &io::Error) -> Problem {
    let reason = match error.kind() {
        io::ErrorKind::InvalidInput => "it is not a file".to_string(),
        _ => plain(error),
    };
    Problem::new(format!("cannot read `{}`: {reason}", path.display()))
}

fn all(path: &Path, from: io::Result<impl Read>, most: u64) -> Result<Vec<u8>, Problem> {
    let bytes = from.and_then(|from| limited(from, most)).map_err(|error| cannot_read(path, &error))?;
    if bytes.len() as u64 > most {
        return Err(Problem::new(format!("`{}` is larger than {}", path.display(), size(most))));
    }
    Ok(bytes)
}

/// A size as one says it.
pub fn size(count: u64) -> String {
    match count {
        0..1024 => format!("{count} bytes"),
        1024..1_048_576 => format!("{:.1} KiB", count as f64 / 1024.0),
        1_048_576..1_073_741_824 => format!("{:.1} MiB", count as f64 / 1_048_576.0),
        _ => format!("{:.1} GiB", count as f64 / 1_073_741_824.0),
    }
}

/// At most one byte more than `most`, so that it shows when there are more.
fn limited(from: impl Read, most: u64) -> io::Result<Vec<u8>> {
    let mut bytes = vec![];
    from.take(most + 1).read_to_end(&mut bytes)?;
    Ok(bytes)
}

fn take(name: String, bytes: Vec<u8>, most: usize) -> Input {
    let too_large = bytes.len() > most;
    let (text, wrong) = match String::from_utf8(if too_large { vec![] } else { bytes }) {
        Ok(text) => (text, None),
        Err(error) => {
            let at = error.utf8_error().valid_up_to();
            let byte = error.as_bytes()[at];
            // Up to the wrong byte the shown text has the same bytes; a few more show where it is.
            let shown = &error.as_bytes()[..error.as_bytes().len().min(at + 200)];
            (String::from_utf8_lossy(shown).into_owned(), Some((at, byte)))
        }
    };
    let mut sources = Sources::default();
    let id = sources.add(Source::new(name, text));
    let refused = match wrong {
        _ if too_large => Some(errors::too_large(id, most)),
        Some((at, byte)) => Some(errors::not_utf8(id, at, byte)),
        None => None,
    };
    Input { sources, id, refused }
}

mod errors {
    use super::*;

    pub fn not_utf8(id: SourceId, at: usize, byte: u8) -> Diagnostic {
        let replacement = char::REPLACEMENT_CHARACTER.len_utf8();
        Diagnostic::new(
            Code::E0009,
            "a scene is UTF-8 text, this is not",
            Span::new(id, at, at + replacement),
        )
        .at(format!("byte 0x{byte:02X}, the {} of the file", ordinal(at + 1)))
        .help("save the file as UTF-8")
    }

    pub fn too_large(id: SourceId, most: usize) -> Diagnostic {
        let message = format!("a scene file is at most {} MiB, this is larger", most >> 20);
        Diagnostic::new(Code::E0406, message, Span::new(id, 0, 0))
    }

    fn ordinal(n: usize) -> String {
        let suffix = match (n % 10, n % 100) {
            (1, last) if last != 11 => "st",
            (2, last) if last != 12 => "nd",
            (3, last) if last != 13 => "rd",
            _ => "th",
        };
        format!("{n}{suffix}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_that_are_no_text_are_pointed_at() {
        let input = take("a.rt".into(), b"sphere {}\n\xc3\xa9 \xff rest".to_vec(), 100);
        let refused = input.refused.unwrap();
        assert_eq!(refused.code, Code::E0009);
        assert_eq!(input.sources.get(input.id).line_column(refused.primary.span.start as usize), (2, 3));
        assert_eq!(refused.primary.text, "byte 0xFF, the 14th of the file");
        assert!(take("a.rt".into(), b"".to_vec(), 100).refused.is_none());
    }

    #[test]
    fn sizes_read_well() {
        assert_eq!([10, 2048, 3 << 20].map(size), ["10 bytes", "2.0 KiB", "3.0 MiB"]);
    }

    #[test]
    fn reading_stops_past_the_limit() {
        assert_eq!(limited(io::repeat(1), 1000).unwrap().len(), 1001);
        assert_eq!(limited(&b"abc"[..], 1000).unwrap(), b"abc");
    }
}
