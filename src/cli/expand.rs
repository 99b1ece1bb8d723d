//! `rtc expand`: the flat scene as a text.

use super::args::Expand;
use super::interrupt::Interrupt;
use super::scene;
use super::target::{Aside, print_text};
use super::terminal::Terminal;
use super::{Exit, Problem};
use rt_lang::expand::expand;
use rt_lang::scene::{Primitive, Scene, Shape};
use std::path::Path;

/// Writes it to standard output, or to a file. On standard output it is meant to lie where the scene does.
pub fn run(arguments: &Expand, terminal: Terminal, interrupt: &Interrupt) -> Result<Exit, Problem> {
    let loaded = scene::load(&arguments.scene, &arguments.reading, &arguments.viewpoint.overrides())?;
    terminal.diagnostics(&loaded.compiled.diagnostics, &loaded.sources);
    let Some(scene) = &loaded.compiled.scene else { return Ok(Exit::Diagnostics) };
    let own = &loaded.sources.get(loaded.id).path;
    let place = match &arguments.output {
        Some(path) if !has_folder(path) => return Err(no_folder(path)),
        Some(path) if names_files(scene) => loaded.files.path_of(path).map_err(|_| outside(path))?,
        _ => own.clone(),
    };
    let text = expand(scene, &loaded.compiled.contents, &place)
        .map_err(|why| Problem::new(format!("this scene has no flat text: {why}")))?;
    match &arguments.output {
        Some(path) => {
            super::export::refuse_scene(&arguments.scene, path)?;
            let mut aside = Aside::beside(path, interrupt)?;
            aside.write(text.as_bytes())?;
            aside.finish()?;
        }
        None => print_text(&text)?,
    }
    Ok(Exit::Done)
}

/// Whether the flat text names pictures or meshes by paths from its own place.
fn names_files(scene: &Scene) -> bool {
    let mesh = |primitive: &Primitive| matches!(primitive.shape, Shape::Mesh(_));
    !scene.images.is_empty() || scene.primitives.iter().any(mesh)
}

/// Whether the folder is there that a file is to be written into.
fn has_folder(path: &Path) -> bool {
    path.parent().is_none_or(|folder| folder.as_os_str().is_empty() || folder.is_dir())
}

fn no_folder(path: &Path) -> Problem {
    let folder = path.parent().unwrap_or(path).display();
    Problem::new(format!("cannot write `{}`: there is no folder `{folder}`", path.display()))
}

fn outside(path: &Path) -> Problem {
    let problem = Problem::new(format!(
        "`{}` does not lie below the root folder, so a text there cannot name the scene's pictures and meshes",
        path.display()
    ));
    problem.help("write it beside the scene, or give `--root` a folder that holds both")
}
