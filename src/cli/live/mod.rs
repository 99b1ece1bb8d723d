//! `rtc watch`: the picture follows the text.
//!
//! ```text
//! watcher ──▶ engine: reader ──▶ desk ──▶ painter ──▶ hub ──▶ pages
//!                ▲                           └──────▶ writer ──▶ files
//!                └───────────── requests ◀──────────── hub
//! ```
//!
//! | module | what it holds |
//! |---|---|
//! | [`watcher`] | when files may have changed |
//! | [`reader`] | texts that somebody is writing |
//! | [`engine`] | what a new text leads to |
//! | [`desk`] | where work waits |
//! | [`painter`], [`work`] | tracing the newest scene, step by step |
//! | [`mix`] | lamps that became brighter, before they are traced |
//! | [`answers`], [`lit`] | why a pixel looks as it does, and where a place of the text is seen |
//! | [`store`] | where the text is kept, for who changes it |
//! | [`writer`] | pictures to files, in the background |
//! | [`said`] | what the compiler says, as a page shows it |
//! | [`hub`] | what everybody may know, and ask |
//! | [`serve`] | the page |
//! | [`editor`] | how a place in a file is opened |

mod answers;
mod bomb;
mod desk;
mod editor;
mod engine;
pub mod hub;
mod lit;
mod mix;
mod painter;
mod reader;
mod said;
mod serve;
pub mod store;
pub mod watcher;
mod work;
mod writer;

use super::args::Watch;
use super::build::{paths, refuse_idle_depth, refuse_inputs_as_outputs, targets};
use super::input::is_standard;
use super::interrupt::Interrupt;
use super::target::{Target, print};
use super::terminal::Terminal;
use super::{Exit, Problem, build, plain};
use bomb::{Bomb, Broken};
use desk::Desk;
pub use editor::Opened;
use editor::{Editor, Tell};
use engine::Engine;
use hub::{Cursor, Hub, Request};
use painter::Painter;
use rayon::ThreadPoolBuilder;
use reader::{Load, Reader};
use serve::Wanted;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::Receiver;
use std::time::Duration;
use store::{Saved, Store};
use watcher::Watcher;
use writer::Writer;

/// Follows a scene until the process is asked to end.
pub fn run(arguments: &Watch, terminal: Terminal, interrupt: &Interrupt) -> Result<Exit, Problem> {
    let targets = outputs(arguments)?;
    let outputs = paths(&targets);
    if !arguments.quiet {
        let written =
            if targets.is_empty() { String::new() } else { format!(", writing {}", build::names(&targets)) };
        terminal.line(&format!("watching {}{written}", arguments.scene.display()));
    }
    let Started { hub, requests, desk, .. } =
        start(arguments, targets, terminal, interrupt, |_, _| bomb::exit())?;
    if let Some(address) = arguments.serve {
        let editor = Editor::new(arguments.editor_url.clone(), arguments.open_with)?;
        show(hub.clone(), Wanted { address, editor }, arguments.open)?;
    }
    let watcher = follow_files(arguments, &hub)?;
    let reader = Reader::new(&arguments.scene, &arguments.reading, arguments.taking.overrides(), outputs);
    let store = Box::new(Saved::at(&arguments.scene, interrupt));
    Engine::new(arguments, reader, watcher, desk, hub, store, terminal).run(&requests)
}

/// A preview that is served until it is dropped; its threads end soon after.
pub struct Live {
    /// The address of its page.
    pub url: String,
    hub: Arc<Hub>,
    desk: Arc<Desk>,
    broken: Arc<AtomicBool>,
}

impl Drop for Live {
    fn drop(&mut self) {
        self.hub.end();
        self.desk.close();
    }
}

impl Live {
    /// Whether it is served no more, since something in it is a bug.
    pub fn is_broken(&self) -> bool {
        self.broken.load(Ordering::Relaxed)
    }

    /// What is shown may be out of date.
    pub fn look(&self) {
        self.hub.ask(Request::Look);
    }

    /// A cursor stands at a place, line and column from 1.
    pub fn point(&self, file: &str, line: u32, column: u32) {
        self.hub.say(|status| status.cursor = Some(Cursor { file: file.into(), line, column }));
    }
}

/// Serves a scene that is read by `load` and changed in `store`, and tells of places that are clicked on. `broken` hears of its
/// end where a thread of it panics.
pub fn preview(
    arguments: &Watch,
    load: Load,
    store: Box<dyn Store>,
    tell: Tell,
    broken: Box<dyn Fn() + Send + Sync>,
    terminal: Terminal,
    interrupt: &Interrupt,
) -> Result<Live, Problem> {
    let address = arguments.serve.ok_or_else(|| Problem::new("there is nothing to serve"))?;
    let is_broken = Arc::new(AtomicBool::new(false));
    let ends = is_broken.clone();
    let end = move |hub: &Arc<Hub>, desk: &Arc<Desk>| -> Broken {
        let (hub, desk) = (hub.clone(), desk.clone());
        Arc::new(move || {
            if !ends.swap(true, Ordering::Relaxed) {
                hub.end();
                desk.close();
                broken();
            }
        })
    };
    let Started { hub, requests, desk, broken } = start(arguments, vec![], terminal, interrupt, end)?;
    let mut live = Live { url: String::new(), hub: hub.clone(), desk: desk.clone(), broken: is_broken };
    live.url = serve::start(hub.clone(), Wanted { address, editor: Editor::told(tell) })?;
    let watcher = follow_files(arguments, &hub)?;
    let reader =
        Reader::new(&arguments.scene, &arguments.reading, arguments.taking.overrides(), vec![]).by(load);
    let engine = Engine::new(arguments, reader, watcher, desk, hub, store, terminal);
    let follow = move || {
        let _bomb = Bomb(broken);
        engine.run(&requests)
    };
    let started = std::thread::Builder::new().name("follow".into()).spawn(follow);
    started.map_err(|error| Problem::new(format!("cannot start a thread: {error}")))?;
    Ok(live)
}

/// What is there before anything is read.
struct Started {
    hub: Arc<Hub>,
    requests: Receiver<Request>,
    desk: Arc<Desk>,
    broken: Broken,
}

/// Starts what paints and what writes.
fn start(
    arguments: &Watch,
    targets: Vec<Target>,
    terminal: Terminal,
    interrupt: &Interrupt,
    broken: impl FnOnce(&Arc<Hub>, &Arc<Desk>) -> Broken,
) -> Result<Started, Problem> {
    let threads = || ThreadPoolBuilder::new().num_threads(arguments.taking.threads.unwrap_or(0));
    let problem = |error| Problem::new(format!("cannot start the threads: {error}"));
    let front = threads().build().map_err(problem)?;
    let threads = threads().start_handler(|_| step_back()).build().map_err(problem)?;
    let (hub, requests) = Hub::new();
    let desk = Arc::new(Desk::default());
    let broken = broken(&hub, &desk);
    let names = match targets.as_slice() {
        [] => String::new(),
        targets => format!("{}: ", build::names(targets)),
    };
    let depth = arguments.taking.look.bits;
    let writer = match targets.is_empty() {
        true => None,
        false => Some(Writer::start(targets, depth, interrupt.clone(), terminal)?),
    };
    let painter = Painter {
        desk: desk.clone(),
        hub: hub.clone(),
        writer,
        threads,
        front,
        terminal,
        quiet: arguments.quiet,
        names,
        broken: broken.clone(),
    };
    let started = std::thread::Builder::new().name("paint".into()).spawn(move || painter.run());
    started.map_err(|error| Problem::new(format!("cannot start a thread: {error}")))?;
    Ok(Started { hub, requests, desk, broken })
}

/// Tells when files may have changed.
fn follow_files(arguments: &Watch, hub: &Arc<Hub>) -> Result<Watcher, Problem> {
    let told = hub.clone();
    Watcher::new(arguments.poll.map(Duration::from_millis), move |_| told.ask(Request::Look))
}

/// Lets a thread work only where no other wants to: editors, browsers and compilers are not to wait for a picture.
fn step_back() {
    #[cfg(target_os = "linux")]
    {
        /// About a tenth of the share of others.
        const NICENESS: i32 = 10;
        // Where it is refused all is slower, and works. For Linux a process is a thread.
        let _ = rustix::process::setpriority_process(None, NICENESS);
    }
}

/// Serves the page, and says where.
fn show(hub: Arc<Hub>, wanted: Wanted, open: bool) -> Result<(), Problem> {
    let url = serve::start(hub, wanted)?;
    print(format!("{url}\n").as_bytes())?;
    if open {
        let problem = |error| Problem::new(format!("no browser opens: {}", plain(&error)));
        open::that_detached(&url)
            .map_err(|error| problem(error).help("open the printed address yourself"))?;
    }
    Ok(())
}

/// Where the picture goes. Everything that can be seen to be wrong before a file is read is found here.
fn outputs(arguments: &Watch) -> Result<Vec<Target>, Problem> {
    if is_standard(&arguments.scene) {
        return Err(Problem::new("standard input does not change: `rtc watch` wants a file"));
    }
    if arguments.scene.is_dir() {
        let problem = Problem::new(format!("`{}` is a folder, not a scene", arguments.scene.display()));
        return Err(problem.help("name a .rt file in it"));
    }
    if !arguments.scene.exists() {
        let problem = Problem::new(format!("there is no file `{}`", arguments.scene.display()));
        return Err(problem.help("`rtc init` makes a first scene"));
    }
    let targets = match arguments.outputs.as_slice() {
        [] if arguments.serve.is_some() => vec![],
        [] => vec![Target::beside(&arguments.scene)],
        outputs => targets(outputs)?,
    };
    if targets.iter().any(|target| is_standard(&target.path)) {
        return Err(Problem::new("a picture that changes cannot go to standard output"));
    }
    refuse_inputs_as_outputs(std::slice::from_ref(&arguments.scene), &paths(&targets))?;
    refuse_idle_depth(arguments.taking.look.bits, &targets)?;
    targets.iter().try_for_each(Target::refuse_no_place)?;
    Ok(targets)
}

#[cfg(test)]
mod tests {
    use super::desk::Job;
    use super::*;
    use crate::cli::args::{Arguments, Command};
    use crate::cli::files::Disk;
    use crate::cli::input::Input;
    use crate::cli::scene;
    use clap::Parser;
    use rt_lang::files::FilePath;
    use rt_lang::lower::Overrides;
    use rt_lang::source::Source;
    use std::sync::mpsc::channel;

    const PATIENCE: Duration = Duration::from_secs(60);

    #[test]
    fn a_panic_ends_the_preview_and_not_the_process() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.rt");
        std::fs::write(&path, "").unwrap();
        let words = ["rtc", "watch", "--serve", "--quiet", path.to_str().unwrap()];
        let Command::Watch(watch) = Arguments::try_parse_from(words).unwrap().command else { panic!() };
        let loaded = |text: &str| {
            let (disk, source) = (Disk::below(folder.path()).unwrap(), Source::new("a.rt", text));
            let place = FilePath::root("a.rt");
            scene::take_from(disk, place, Input::of(source), &watch.reading, &Overrides::default())
        };
        let start = |load: Load| {
            let (tell, told) = channel();
            let interrupt = Interrupt::default();
            let store = Box::new(Saved::at(&path, &interrupt));
            let broken = Box::new(move || tell.send(()).unwrap());
            let live =
                preview(&watch, load, store, Box::new(drop), broken, Terminal::silent(), &interrupt).unwrap();
            (live, told)
        };
        let panics = start(Box::new(|_, _| panic!("while it reads")));
        let (sound, told) = start(Box::new(|_, _| Err(Problem::new("nothing to paint"))));
        assert!(!sound.is_broken());
        // Of a scene with errors no job is ever made.
        sound.desk.put(Arc::new(Job { generation: 1, loaded: loaded("sphere {") }), vec![]);
        for (live, told) in [panics, (sound, told)] {
            told.recv_timeout(PATIENCE).expect("nobody is told");
            assert!(live.is_broken() && live.desk.take().is_none());
        }
    }
}
