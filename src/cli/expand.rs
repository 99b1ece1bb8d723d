//! `rtc expand`: the flat scene as a text.

use super::args::Expand;
use super::interrupt::Interrupt;
use super::scene;
use super::target::{Aside, print};
use super::terminal::Terminal;
use super::{Exit, Problem};
use rt_lang::expand::expand;
use rt_lang::lower::Overrides;

/// Writes it to standard output, or to a file.
pub fn run(arguments: &Expand, terminal: Terminal, interrupt: &Interrupt) -> Result<Exit, Problem> {
    let loaded = scene::load(&arguments.scene, &arguments.reading, &Overrides::default())?;
    terminal.diagnostics(&loaded.compiled.diagnostics, &loaded.sources);
    let Some(scene) = &loaded.compiled.scene else { return Ok(Exit::Diagnostics) };
    let text = expand(scene).map_err(|why| Problem::new(format!("this scene has no flat text: {why}")))?;
    match &arguments.output {
        Some(path) => {
            super::export::refuse_scene(&arguments.scene, path)?;
            let mut aside = Aside::beside(path, interrupt)?;
            aside.write(text.as_bytes())?;
            aside.finish()?;
        }
        None => print(text.as_bytes())?,
    }
    Ok(Exit::Done)
}
