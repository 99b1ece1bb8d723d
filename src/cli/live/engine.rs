//! What a new text leads to, and what pages ask for.

use super::desk::{Desk, Job, Question};
use super::hub::{Hub, Param, Reply, Request, Said, State};
use super::reader::{Reader, Seen};
use super::said::{said, unreadable};
use super::store::{CHANGING, Store};
use super::watcher::Watcher;
use crate::cli::args::Watch;
use crate::cli::scene::Loaded;
use crate::cli::terminal::Terminal;
use crate::cli::{Exit, Problem};
use rt_lang::change;
use rt_lang::diagnostic::any_errors;
use rt_lang::render::Window;
use rt_lang::source::Sources;
use rt_lang::span::SourceId;
use rt_lang::syntax::{self, ast};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

/// What is said where a picture is asked about before the first.
const NO_PICTURE: &str = "there is no picture yet";

/// How long a text may take to say what was put there.
const PATIENCE: Duration = Duration::from_secs(3);
/// What is said where it does not.
const NOT_THERE: &str = "it was written, but the text says something else: try it again";

/// A value that was put into the text.
struct Written {
    /// What is set.
    set: String,
    /// What is to stand in the text.
    default: String,
    /// Until when it is waited for.
    until: Instant,
    reply: Reply<Result<(), String>>,
}

/// Reads, compiles, and decides.
pub struct Engine {
    scene: PathBuf,
    quiet: bool,
    reader: Reader,
    watcher: Watcher,
    desk: Arc<Desk>,
    hub: Arc<Hub>,
    store: Box<dyn Store>,
    terminal: Terminal,
    /// What is set, by the command line and by pages.
    set: BTreeMap<String, String>,
    /// Of that, what the text had and has no more. Set again when it comes back.
    gone: BTreeSet<String>,
    /// The params that the text has had.
    had: BTreeSet<String>,
    /// What was put into the text, until it is seen there.
    written: BTreeMap<String, Written>,
    /// Which of them are new.
    fresh: Vec<String>,
    generation: u64,
    /// The job that was put on the desk last.
    job: Option<Arc<Job>>,
    /// What was said last.
    said: Said,
    /// When to look again whether somebody is still writing.
    again: Option<Instant>,
}

impl Engine {
    /// Puts the parts together.
    pub fn new(
        arguments: &Watch,
        mut reader: Reader,
        watcher: Watcher,
        desk: Arc<Desk>,
        hub: Arc<Hub>,
        store: Box<dyn Store>,
        terminal: Terminal,
    ) -> Engine {
        let scene = arguments.scene.clone();
        let name = scene.display().to_string();
        hub.say(|status| status.scene = name);
        let (set, said) = (reader.take_settings(), Said::default());
        let quiet = arguments.quiet;
        Engine {
            scene,
            fresh: vec![],
            quiet,
            reader,
            watcher,
            desk,
            hub,
            store,
            terminal,
            set,
            gone: BTreeSet::new(),
            had: BTreeSet::new(),
            written: BTreeMap::new(),
            generation: 0,
            job: None,
            said,
            again: None,
        }
    }

    /// Does what is asked until that is to end.
    pub fn run(mut self, requests: &Receiver<Request>) -> Result<Exit, Problem> {
        self.watcher.follow([self.scene.clone()]);
        self.look(true);
        loop {
            let wake = self.written.values().map(|written| written.until).chain(self.again).min();
            let mut waiting = match wake {
                None => match requests.recv() {
                    Ok(request) => vec![request],
                    Err(_) => return Ok(Exit::Done),
                },
                Some(wake) => match requests.recv_timeout(wake.saturating_duration_since(Instant::now())) {
                    Ok(request) => vec![request],
                    Err(RecvTimeoutError::Timeout) => vec![Request::Look],
                    Err(RecvTimeoutError::Disconnected) => return Ok(Exit::Done),
                },
            };
            // Of what has come in the meantime, one look at the files is enough, and the newest value of each param.
            waiting.extend(requests.try_iter());
            let (mut look, mut set) = (false, false);
            for request in waiting {
                match request {
                    Request::End => return Ok(Exit::Done),
                    Request::Look => look = true,
                    Request::Set { name, value } => set |= self.set(name, value),
                    Request::Written { name, default, answer, reply } => {
                        look |= self.wait_for(name, default, answer, reply);
                    }
                    other => self.answer(other),
                }
            }
            if look || set {
                let settled = self.settle();
                self.look(set || settled);
            }
        }
    }

    fn answer(&mut self, request: Request) {
        match request {
            Request::End | Request::Look | Request::Set { .. } | Request::Written { .. } => {}
            Request::Write { name, reply } => self.write(name, reply),
            Request::Crop(window) => self.crop(window),
            Request::Pause(paused) => {
                self.desk.pause(paused);
                self.hub.say(|status| {
                    status.paused = paused;
                    status.state = match status.state {
                        State::Rendering if paused => State::Paused,
                        State::Paused if !paused => State::Rendering,
                        state => state,
                    }
                });
            }
            Request::Why { x, y, patient, reply } => match self.job {
                Some(_) => self.desk.ask(Question::Why { pixel: [x, y], patient, reply }),
                None => drop(reply.send(Err(NO_PICTURE.into()))),
            },
            Request::Light { file, line, column, reply } => match self.job {
                Some(_) => self.desk.ask(Question::Light { file, place: [line, column], reply }),
                None => drop(reply.send(Err(NO_PICTURE.into()))),
            },
        }
    }

    fn crop(&self, window: Option<[u32; 4]>) {
        let Some(job) = &self.job else { return };
        let [width, height] = job.scene().trace.size;
        // Whoever drags goes over the edge.
        let inside = window.and_then(|[x, y, w, h]| {
            let (x, y) = (x.min(width), y.min(height));
            let (w, h) = (w.min(width - x), h.min(height - y));
            (w > 0 && h > 0).then_some(Window { x, y, width: w, height: h })
        });
        self.desk.put_first(inside);
        self.hub.say(|status| status.crop = inside.map(|w| [w.x, w.y, w.width, w.height]));
    }

    /// Takes a setting; whether anything is different then.
    fn set(&mut self, name: String, value: String) -> bool {
        // Its name is put before `=`: anything else would set something else.
        let known = self.hub.status().params.iter().any(|param| param.name == name);
        let changed = match value.trim() {
            "" => self.set.remove(&name).is_some(),
            _ if !known => false,
            value => self.set.insert(name.clone(), value.into()).as_deref() != Some(value),
        };
        if changed {
            self.fresh.push(name);
        }
        changed
    }

    /// Looks whether there is a new text.
    fn look(&mut self, anyway: bool) {
        self.again = None;
        let Engine { reader, desk, set, gone, hub, .. } = self;
        let set = set.iter().filter(|(name, _)| !gone.contains(*name));
        let set: BTreeMap<String, String> = set.map(|(name, value)| (name.clone(), value.clone())).collect();
        let reads = || hub.say(|status| status.state = State::Compiling);
        let before = hub.status().state;
        match desk.reading(|| reader.look(&set, anyway, reads)) {
            // What lies on the way to a missing file may have come.
            Seen::Same => self.watcher.follow(self.reader.files()),
            Seen::Later(wait) => {
                self.watcher.follow(self.reader.files());
                self.hub.say(|status| status.state = before);
                self.again = Some(Instant::now() + wait);
            }
            Seen::New(loaded) => {
                self.watcher.follow(self.reader.files());
                match self.notice_gone(&loaded) {
                    true => self.look(true),
                    false => self.take(*loaded),
                }
            }
        }
    }

    /// A param that is set may be taken out of the text, or be broken for a moment: it is no mistake of whoever edits. Whether
    /// other params are gone now than before.
    fn notice_gone(&mut self, loaded: &Result<Loaded, Problem>) -> bool {
        let Ok(loaded) = loaded else { return false };
        let params = &loaded.compiled.inventory.params;
        let names: BTreeSet<String> = params.iter().map(|param| param.name.clone()).collect();
        let set = self.set.keys().filter(|name| self.had.contains(*name) && !names.contains(*name));
        let gone = set.cloned().collect();
        self.had.extend(names);
        let other = gone != self.gone;
        self.gone = gone;
        other
    }

    /// Takes what was read.
    fn take(&mut self, loaded: Result<Loaded, Problem>) {
        self.generation += 1;
        match loaded {
            Err(problem) => {
                let said = unreadable(&problem.message, problem.help.as_deref());
                self.fail(said, |terminal| terminal.problem(&problem));
            }
            Ok(loaded) => {
                let Loaded { compiled, sources, .. } = &loaded;
                let said = said(&compiled.diagnostics, sources);
                self.describe(&loaded);
                if any_errors(&compiled.diagnostics) || compiled.scene.is_none() {
                    self.fail(said, |terminal| terminal.diagnostics(&compiled.diagnostics, sources));
                } else {
                    self.succeed(said, loaded);
                }
            }
        }
    }

    fn fail(&mut self, said: Said, say: impl FnOnce(Terminal)) {
        if said != self.said {
            say(self.terminal);
        }
        self.said = said.clone();
        let generation = self.generation;
        self.hub.say(|status| {
            status.state = State::Error;
            status.diagnostics = said;
            status.generation = generation;
        });
    }

    fn succeed(&mut self, said: Said, loaded: Loaded) {
        if said != self.said && said.warnings > 0 && !self.quiet {
            self.terminal.diagnostics(&loaded.compiled.diagnostics, &loaded.sources);
        }
        let had_errors = self.said.errors > 0;
        self.said = said.clone();
        let before = self.job.as_ref().map(|job| &job.loaded);
        let mut names = std::mem::take(&mut self.fresh);
        names.extend(before.iter().flat_map(|before| changed(&before.sources, &loaded.sources)));
        names.extend(before.iter().flat_map(|before| replaced(before, &loaded)));
        let job = Arc::new(Job { generation: self.generation, loaded });
        let notes = job.loaded.compiled.notes.clone();
        let generation = self.generation;
        let resized = self.job.as_ref().is_some_and(|old| old.scene().trace.size != job.scene().trace.size);
        if resized {
            self.desk.put_first(None);
        }
        self.hub.say(|status| {
            status.state = if status.paused { State::Paused } else { State::Rendering };
            status.diagnostics = said;
            status.generation = generation;
            status.notes = notes;
            status.crop = status.crop.filter(|_| !resized);
        });
        if had_errors && !self.quiet {
            self.terminal.line("no errors any more");
        }
        self.job = Some(job.clone());
        self.desk.put(job, names);
    }

    /// Says what can be set, and of which files the scene is made.
    fn describe(&self, loaded: &Loaded) {
        let set = |name: &str| self.set.get(name);
        let mut params: Vec<Param> = loaded
            .compiled
            .inventory
            .params
            .iter()
            .map(|param| Param {
                name: param.name.clone(),
                ty: param.ty.clone(),
                doc: param.doc.clone(),
                default: param.default.clone(),
                value: set(&param.name).unwrap_or(&param.default).clone(),
                set: set(&param.name).is_some(),
                low: param.range.as_ref().map(|[low, _]| low.clone()),
                high: param.range.as_ref().map(|[_, high]| high.clone()),
            })
            .collect();
        let understood = !params.is_empty() || !any_errors(&loaded.compiled.diagnostics);
        let gone = self.gone.iter().filter_map(|name| Some((name, self.set.get(name)?)));
        params.extend(gone.map(|(name, value)| Param::gone(name, value)));
        let files = self.reader.files().map(|path| shown(&path)).collect::<std::collections::BTreeSet<_>>();
        self.hub.say(|status| {
            // A text that could not be understood has no params; those that were are still there to be mended with.
            if understood {
                status.params = params;
            }
            status.files = files.into_iter().collect();
        });
    }

    /// Has what is set written into the scene.
    fn write(&self, name: String, reply: Reply<Result<(), String>>) {
        match self.with_default(&name) {
            Err(why) => drop(reply.send(Err(why))),
            Ok([before, after, default]) => {
                let hub = self.hub.clone();
                let done = move |answer| hub.ask(Request::Written { name, default, answer, reply });
                self.store.replace(&before, &after, Box::new(done));
            }
        }
    }

    /// The scene, what it is to become where what is set is the default of a param, and that default.
    fn with_default(&self, name: &str) -> Result<[String; 3], String> {
        let value = self.set.get(name).ok_or_else(|| format!("`{name}` is as the file has it"))?;
        let text = self.store.read()?;
        let compiled = self.job.as_ref().map(|job| &job.loaded.sources.get(job.loaded.id).text);
        if self.said.errors > 0 || compiled != Some(&text) {
            return Err(CHANGING.into());
        }
        // Without comments, which would swallow what stands behind.
        let (expr, slips) = syntax::parse_expression(SourceId(0), value);
        let value = value.get(expr.span.range()).filter(|_| slips.is_empty()).ok_or(CHANGING)?;
        let default = default_of(&text, name).ok_or_else(|| format!("the scene has no param `{name}`"))?;
        let after = format!("{}{value}{}", &text[..default.start], &text[default.end..]);
        Ok([text, after, value.into()])
    }

    /// Passes on why a value was not written, or waits until it is seen in the text; whether to look for it there.
    fn wait_for(
        &mut self,
        name: String,
        default: String,
        answer: Result<(), String>,
        reply: Reply<Result<(), String>>,
    ) -> bool {
        let is_written = answer.is_ok();
        match (answer, self.set.get(&name)) {
            (Ok(()), Some(set)) => {
                let (set, until) = (set.clone(), Instant::now() + PATIENCE);
                self.written.insert(name, Written { set, default, until, reply });
            }
            (answer, _) => drop(reply.send(answer)),
        }
        is_written
    }

    /// Lets go of what is set and stands in the text by now, and answers who had it written; whether there was something.
    fn settle(&mut self) -> bool {
        if self.written.is_empty() {
            return false;
        }
        let text = self.store.read().unwrap_or_default();
        let mut settled = false;
        for (name, written) in std::mem::take(&mut self.written) {
            if default_of(&text, &name).is_some_and(|at| text[at] == *written.default) {
                // It may have been set to something else meanwhile.
                settled |= self.set.get(&name) == Some(&written.set) && self.set.remove(&name).is_some();
                let _ = written.reply.send(Ok(()));
            } else if Instant::now() < written.until {
                self.written.insert(name, written);
            } else {
                let _ = written.reply.send(Err(NOT_THERE.into()));
            }
        }
        settled
    }
}

/// Where the default of a param stands.
fn default_of(text: &str, name: &str) -> Option<Range<usize>> {
    let (file, _) = syntax::parse(SourceId(0), text);
    file.body.entries.iter().find_map(|entry| match entry {
        ast::Entry::Statement(statement) => match &statement.kind {
            ast::StatementKind::Param { name: found, default, .. } if found.text == name => {
                Some(default.span.range())
            }
            _ => None,
        },
        _ => None,
    })
}

/// How a file is named where it lies below the current folder.
fn shown(path: &Path) -> String {
    let here = std::env::current_dir().ok();
    let below = here.and_then(|here| path.strip_prefix(here).ok().map(Path::to_path_buf));
    below.unwrap_or_else(|| path.into()).display().to_string()
}

/// The pictures and meshes that hold something else than before.
fn replaced(before: &Loaded, after: &Loaded) -> Vec<String> {
    let old: BTreeMap<PathBuf, Option<Arc<[u8]>>> = before.files.held().into_iter().collect();
    let texts: BTreeSet<&str> = after.sources.iter().map(|(_, source)| source.name.as_str()).collect();
    let others =
        after.files.held().into_iter().map(|(path, bytes)| (path.display().to_string(), path, bytes));
    let others = others.filter(|(name, path, bytes)| {
        !texts.contains(name.as_str()) && old.get(path).is_some_and(|old| old != bytes)
    });
    others.map(|(name, ..)| name).collect()
}

/// The names of what is different between two readings of a scene.
fn changed(before: &Sources, after: &Sources) -> Vec<String> {
    let old = |name: &str| before.iter().map(|(_, source)| source).find(|source| source.name == name);
    let texts = after.iter().filter_map(|(_, source)| Some((&old(&source.name)?.text, &source.text)));
    texts.filter(|(old, new)| old != new).flat_map(|(old, new)| change::names(old, new)).collect()
}
