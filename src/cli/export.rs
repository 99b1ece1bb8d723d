//! `rtc export`: the scene for another renderer.

use super::args::Export;
use super::interrupt::Interrupt;
use super::scene::{self, Loaded};
use super::target::Aside;
use super::terminal::Terminal;
use super::{Exit, Problem};
use rt_lang::export::{Exported, Options, Renderer, Unsaid, export};
use std::path::Path;

/// Writes the files that the renderer reads.
pub fn run(arguments: &Export, terminal: Terminal, interrupt: &Interrupt) -> Result<Exit, Problem> {
    let Export { scene: path, output, approximate, tessellate, viewpoint, reading } = arguments;
    let extension = output.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    let Some(renderer) = Renderer::from_extension(extension) else {
        let problem = Problem::new(format!("`{}` is for no renderer that is known", output.display()));
        return Err(problem.help("end it in .xml for Mitsuba 3, .pbrt for pbrt-v4 or .pov for POV-Ray"));
    };
    refuse_scene(path, output)?;
    let loaded = scene::load(path, reading, &viewpoint.overrides())?;
    terminal.diagnostics(&loaded.compiled.diagnostics, &loaded.sources);
    let Some(scene) = &loaded.compiled.scene else { return Ok(Exit::Diagnostics) };
    let stem = output.file_stem().and_then(|stem| stem.to_str()).unwrap_or("scene").to_string();
    let options = Options { stem, approximate: *approximate, tessellate: *tessellate };
    match export(scene, renderer, options) {
        Ok(exported) => write(&exported, output, terminal, interrupt),
        Err(unsaid) => {
            unsaid.iter().for_each(|unsaid| terminal.problem(&problem(unsaid, &loaded)));
            Ok(Exit::Diagnostics)
        }
    }
}

/// Nobody means to replace a scene by what is made of it.
pub fn refuse_scene(scene: &Path, output: &Path) -> Result<(), Problem> {
    let same = |path: &Path| std::fs::canonicalize(path).ok();
    if same(output).is_some() && same(output) == same(scene) {
        return Err(Problem::new(format!("`{}` would be replaced", output.display())));
    }
    Ok(())
}

fn write(
    exported: &Exported,
    output: &Path,
    terminal: Terminal,
    interrupt: &Interrupt,
) -> Result<Exit, Problem> {
    let beside = exported.files.iter().map(|(name, bytes)| (output.with_file_name(name), bytes.as_slice()));
    for (path, bytes) in beside.chain([(output.to_path_buf(), exported.text.as_bytes())]) {
        let mut aside = Aside::beside(&path, interrupt)?;
        aside.write(bytes)?;
        aside.finish()?;
    }
    exported.notes.iter().for_each(|note| terminal.line(&format!("note: {note}")));
    Ok(Exit::Done)
}

/// What cannot be said, with its place.
fn problem(unsaid: &Unsaid, loaded: &Loaded) -> Problem {
    let chain = unsaid.origin.map(|origin| loaded.compiled.origins.chain(origin)).unwrap_or_default();
    let message = match chain.last() {
        Some(span) => {
            let source = loaded.sources.get(span.source);
            let before = &source.text[..span.start as usize];
            let line = before.matches('\n').count() + 1;
            let column = before.rsplit('\n').next().unwrap_or_default().chars().count() + 1;
            format!("{}:{line}:{column}: {}", source.name, unsaid.what)
        }
        None => unsaid.what.clone(),
    };
    let problem = Problem::new(message);
    match unsaid.help {
        Some(help) => problem.help(help),
        None => problem,
    }
}
