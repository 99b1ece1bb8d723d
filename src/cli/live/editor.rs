//! How a place in a file is opened: by a link, or by a command on this machine.

use super::super::Problem;
use std::path::PathBuf;
use std::process::{Command, Stdio};

/// What a click on a place does.
pub struct Editor {
    template: String,
    /// What is done in place of following the address.
    opener: Option<Opener>,
}

/// How places are opened from here.
enum Opener {
    /// By a command, of these words.
    Command(Vec<String>),
    /// By whoever is told.
    Told(Tell),
}

/// Hears of places that are to be opened.
pub type Tell = Box<dyn Fn(Opened) + Send + Sync>;

/// A place that is to be opened.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Opened {
    /// The file, as the scene's files are named.
    pub file: String,
    /// From 1.
    pub line: u32,
    /// From 1, in characters.
    pub column: u32,
}

/// The address of a place where nobody says another.
const ADDRESS: &str = "vscode://file{file}:{line}:{column}";

/// The variable that names the command.
const VARIABLE: &str = "RTC_EDITOR";

impl Editor {
    /// With the address of an editor, and where `open_with` is set, the command of `$RTC_EDITOR` in its place.
    pub fn new(template: String, open_with: bool) -> Result<Editor, Problem> {
        let command = if open_with { Some(std::env::var(VARIABLE).unwrap_or_default()) } else { None };
        Editor::with(template, command.as_deref())
    }

    fn with(template: String, command: Option<&str>) -> Result<Editor, Problem> {
        let scheme = template.split_once(':').map_or("", |(scheme, _)| scheme).to_ascii_lowercase();
        let is_address =
            !scheme.is_empty() && scheme.bytes().all(|b| b.is_ascii_alphanumeric() || b"+-.".contains(&b));
        if !is_address
            || ["javascript", "data", "vbscript"].contains(&scheme.as_str())
            || !template.contains("{file}")
        {
            let problem = Problem::new(format!("`{template}` is not the address of a file in an editor"));
            return Err(problem.help("write one like `vscode://file{file}:{line}:{column}`"));
        }
        let command =
            command.map(|command| command.split_whitespace().map(String::from).collect::<Vec<String>>());
        if command.as_ref().is_some_and(Vec::is_empty) {
            let problem =
                Problem::new(format!("`--open-with` runs the command of ${VARIABLE}, which is not set"));
            return Err(problem
                .help(format!("set it: `export {VARIABLE}='code --goto {{file}}:{{line}}:{{column}}'`")));
        }
        Ok(Editor { template, opener: command.map(Opener::Command) })
    }

    /// One that is told of places.
    pub fn told(tell: Tell) -> Editor {
        Editor { template: ADDRESS.into(), opener: Some(Opener::Told(tell)) }
    }

    /// The address that a place leads to, with `{file}`, `{line}` and `{column}` to be put in.
    pub fn template(&self) -> &str {
        &self.template
    }

    /// Whether places are opened from here.
    pub fn runs(&self) -> bool {
        self.opener.is_some()
    }

    /// Opens a place in one of the files of a scene.
    pub fn open(&self, file: &str, line: u32, column: u32, files: &[String]) -> Result<(), String> {
        let Some(opener) = &self.opener else { return Err("no command opens places here".into()) };
        let path = absolute(file);
        if !files.iter().any(|known| absolute(known) == path) {
            return Err(format!("`{file}` is no file of the scene"));
        }
        let words = match opener {
            Opener::Command(words) => words,
            Opener::Told(tell) => {
                tell(Opened { file: file.into(), line, column });
                return Ok(());
            }
        };
        let filled = filled(words, &path.to_string_lossy(), line, column);
        let Some((program, arguments)) = filled.split_first() else { return Ok(()) };
        spawn(Command::new(program).args(arguments))
            .map_err(|error| format!("`{program}` does not start: {error}"))
    }
}

fn absolute(file: &str) -> PathBuf {
    std::path::absolute(file).unwrap_or_else(|_| file.into())
}

/// The words with a place put in; where they do not say where it goes, it comes behind them.
fn filled(words: &[String], file: &str, line: u32, column: u32) -> Vec<String> {
    let (line, column) = (line.to_string(), column.to_string());
    let mut filled: Vec<String> = words
        .iter()
        .map(|word| put(word, &[("{file}", file), ("{line}", &line), ("{column}", &column)]))
        .collect();
    if !words.iter().any(|word| word.contains("{file}")) {
        filled.push(format!("{file}:{line}:{column}"));
    }
    filled
}

/// Puts values in at once, so that none is looked for in another.
fn put(word: &str, values: &[(&str, &str)]) -> String {
    let mut text = String::new();
    let mut rest = word;
    'rest: while let Some(first) = rest.chars().next() {
        for (name, value) in values {
            if let Some(behind) = rest.strip_prefix(name) {
                text.push_str(value);
                rest = behind;
                continue 'rest;
            }
        }
        text.push(first);
        rest = &rest[first.len_utf8()..];
    }
    text
}

/// Starts a program that nobody waits for but a thread, so that none is left behind as a zombie.
fn spawn(command: &mut Command) -> std::io::Result<()> {
    let mut child = command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).spawn()?;
    std::thread::Builder::new().spawn(move || child.wait())?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINK: &str = "vscode://file{file}:{line}:{column}";

    #[test]
    fn places_are_put_into_the_command() {
        let words = |text: &str| text.split_whitespace().map(String::from).collect::<Vec<String>>();
        assert_eq!(
            filled(&words("code --goto {file}:{line}:{column}"), "/a b.rt", 3, 7),
            ["code", "--goto", "/a b.rt:3:7"]
        );
        assert_eq!(filled(&words("subl"), "/a.rt", 3, 7), ["subl", "/a.rt:3:7"]);
        // A file may have any name.
        assert_eq!(
            filled(&words("vi +{line} {file}"), "/{line};$(rm).rt", 3, 7),
            ["vi", "+3", "/{line};$(rm).rt"]
        );
    }

    #[test]
    fn only_files_of_the_scene_are_opened_and_only_if_asked_for() {
        let files = ["a.rt".to_string()];
        let closed = Editor::with(LINK.into(), None).unwrap();
        assert!(!closed.runs() && closed.open("a.rt", 1, 1, &files).is_err());
        let open = Editor::with(LINK.into(), Some("true")).unwrap();
        assert!(open.open("/etc/passwd", 1, 1, &files).is_err());
        assert!(open.open("a.rt", 1, 1, &files).is_ok());
        assert!(open.open(&absolute("a.rt").to_string_lossy(), 1, 1, &files).is_ok());
    }

    #[test]
    fn addresses_that_run_something_are_refused() {
        for wrong in ["javascript:alert('{file}')", "{file}", "", "vscode://file", "DATA:{file}"] {
            assert!(Editor::with(wrong.into(), None).is_err(), "{wrong}");
        }
        assert!(Editor::with(LINK.into(), Some(" ")).is_err());
    }
}
