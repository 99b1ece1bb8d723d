//! `rtc init`: a folder with a first scene, and hints for editors and git.

use super::args::Init;
use super::{Exit, Problem, plain, target};
use std::fs::{self, OpenOptions};
use std::io::Write;
use std::path::Path;

/// The files of the folder with what is in them.
const FILES: &[(&str, &str)] = &[
    ("scene.rt", include_str!("init/scene.rt")),
    (".editorconfig", include_str!("init/editorconfig")),
    (".gitignore", include_str!("init/gitignore")),
    (".vscode/settings.json", include_str!("init/vscode-settings.json")),
    (".vscode/tasks.json", include_str!("init/vscode-tasks.json")),
];

/// Writes the files, unless one of them is there.
pub fn run(arguments: &Init) -> Result<Exit, Problem> {
    let folder = &arguments.folder;
    let cannot = |path: &Path, error: &std::io::Error| {
        Problem::new(format!("cannot write `{}`: {}", path.display(), plain(error)))
    };
    let there = |(name, _): &&(&str, &str)| folder.join(name).symlink_metadata().is_ok();
    if let Some((name, _)) = FILES.iter().find(there) {
        let problem = Problem::new(format!(
            "`{}` is there already, and nothing is replaced",
            folder.join(name).display()
        ));
        return Err(problem.help("choose another folder: `rtc init balls`"));
    }
    for (name, content) in FILES {
        let path = folder.join(name);
        let holder = path.parent().unwrap_or(folder);
        fs::create_dir_all(holder).map_err(|error| cannot(holder, &error))?;
        // Whoever makes the file first has it.
        let file = OpenOptions::new().write(true).create_new(true).open(&path);
        file.and_then(|mut file| file.write_all(content.as_bytes()))
            .map_err(|error| cannot(&path, &error))?;
    }
    let scene = folder.join("scene.rt");
    let scene = scene.strip_prefix(".").unwrap_or(&scene).display();
    target::print_words(&format!("made {scene}; render it with\n\n  rtc build {scene}\n"))?;
    Ok(Exit::Done)
}
