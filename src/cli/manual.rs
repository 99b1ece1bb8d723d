//! `rtc completions` and `rtc man`: both are made from the flags as they are declared.

use super::args::{Arguments, Completions, Man};
use super::{Exit, Problem, plain, target};
use clap::CommandFactory;
use std::fs;
use std::path::Path;

/// Prints the completion script of a shell.
pub fn completions(arguments: &Completions) -> Result<Exit, Problem> {
    let mut script = vec![];
    clap_complete::generate(arguments.shell, &mut Arguments::command(), "rtc", &mut script);
    target::print(script.as_slice())?;
    Ok(Exit::Done)
}

/// Prints the manual page, or writes one a command into a folder.
pub fn man(arguments: &Man) -> Result<Exit, Problem> {
    let mut command = Arguments::command();
    // Only a built command knows the full names of its parts.
    command.build();
    let Some(folder) = &arguments.dir else {
        target::print(page(command)?.as_slice())?;
        return Ok(Exit::Done);
    };
    let cannot = |path: &Path, error: &std::io::Error| {
        Problem::new(format!("cannot write `{}`: {}", path.display(), plain(error)))
    };
    fs::create_dir_all(folder).map_err(|error| cannot(folder, &error))?;
    let parts = command.get_subcommands().filter(|part| part.get_name() != "help").cloned();
    let pages: Vec<clap::Command> = parts.chain([command.clone()]).collect();
    for command in pages {
        let name = command.get_display_name().unwrap_or(command.get_name()).to_string();
        let path = folder.join(format!("{name}.1"));
        fs::write(&path, page(command)?).map_err(|error| cannot(&path, &error))?;
    }
    Ok(Exit::Done)
}

fn page(command: clap::Command) -> Result<Vec<u8>, Problem> {
    let mut page = vec![];
    // Named as its file is: `rtc-build`.
    let name = command.get_display_name().unwrap_or(command.get_name()).to_string();
    let man = clap_mangen::Man::new(command).title(name.to_uppercase()).manual("rtc manual");
    man.render(&mut page)
        .map_err(|error| Problem::new(format!("cannot make the page: {}", plain(&error))))?;
    Ok(unfilled(String::from_utf8(page).expect("a page is made of texts")).into_bytes())
}

/// The page with its examples as they are written: a reader of manuals joins lines and spreads words where nothing
/// keeps it from that.
///
/// Source: groff(7), the requests `nf` and `fi`.
fn unfilled(page: String) -> String {
    let Some((before, examples)) = page.split_once(".SH EXTRA\n") else { return page };
    let (examples, after) = match examples.find("\n.SH ") {
        Some(end) => examples.split_at(end + 1),
        None => (examples, ""),
    };
    format!("{before}.SH EXAMPLES\n.nf\n{examples}.fi\n{after}")
}
