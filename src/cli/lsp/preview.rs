//! The preview of a document, saved or not, served from this process: it follows what stands in the editor, a click on a
//! place of the page leads there, and the pixels are lit that show what stands at the cursor.

use super::analyst::Meaning;
use super::buffer::{Asked as AskedToChange, Buffer};
use super::commands::{About, Order, has};
use super::documents::{Kept, Key, place};
use super::requests::read;
use super::uri::uri_of;
use super::view::View;
use super::work::{Answer, Ask, Asked, Failure, Question, Told};
use crate::cli::Problem;
use crate::cli::args::{Arguments, Command, Reading};
use crate::cli::files::Disk;
use crate::cli::input::Input;
use crate::cli::live::store::Saved;
use crate::cli::live::{self, Live, Opened};
use crate::cli::scene::{self, Loaded};
use crate::cli::terminal::Terminal;
use clap::Parser;
use crossbeam_channel::Sender;
use gen_lsp_types::{self as lsp, Position};
use lsp_server::RequestId;
use rt_lang::lower::Overrides;
use rt_lang::source::Source;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

/// The most previews that are served at once: each has threads of its own.
const MOST: usize = 16;

/// Has the client show something.
pub const SHOW: lsp::LspRequestMethod<'static> = lsp::LspRequestMethod::WindowShowDocument;

/// What is open now, for previews that read it on their own threads.
pub type Newest = Arc<Mutex<Arc<View>>>;

/// The previews that are served, by document and camera.
pub struct Previews {
    newest: Newest,
    changes: AskedToChange,
    served: BTreeMap<(Key, Option<String>), Live>,
    /// Of whose document is looked whether it has the camera.
    wanted: BTreeMap<RequestId, Order>,
}

impl Previews {
    /// None yet.
    pub fn new(view: Arc<View>) -> Previews {
        Previews {
            newest: Arc::new(Mutex::new(view)),
            changes: Arc::default(),
            served: BTreeMap::new(),
            wanted: BTreeMap::new(),
        }
    }

    /// Keeps an order until it is known whether there is what it is about, and gives what finds that out.
    pub fn want(&mut self, order: Order) -> Question {
        let Order { id, about, view, cancelled, .. } = &order;
        let params = json!({ "uri": about.uri, "camera": about.camera });
        let (view, cancelled) = (view.clone(), cancelled.clone());
        let question = Question { id: id.clone(), run: has_camera, params, view, cancelled };
        self.wanted.insert(order.id.clone(), order);
        question
    }

    /// The order of a request that was kept, which is forgotten.
    pub fn wanted(&mut self, id: &RequestId) -> Option<Order> {
        self.wanted.remove(id)
    }

    /// Serves those of a document no more. The requests that wait for one of it.
    pub fn close(&mut self, key: &Key) -> Vec<RequestId> {
        self.served.retain(|(document, _), _| document != key);
        let orders = self.wanted.iter().filter(|(_, order)| order.key == *key);
        orders.map(|(id, _)| id.clone()).collect()
    }

    /// Serves a preview, or finds the one that is served, and gives its address. What is open may have changed since the order.
    pub fn start(&mut self, order: &Order, view: &Arc<View>) -> Answer<String> {
        let Order { key, about, told, interrupt, .. } = order;
        let path =
            key.path().ok_or_else(|| Failure::plain("save it first: what it reads is found from there"))?;
        let served = (key.clone(), about.camera.clone());
        self.served.retain(|_, live| !live.is_broken());
        if let Some(live) = self.served.get(&served) {
            return Ok(live.url.clone());
        }
        if view.documents.get(key).is_none() && !path.is_file() {
            return Err(Failure::plain(format!("there is no file `{}`", path.display())));
        }
        if self.served.len() >= MOST {
            return Err(Failure::plain(format!("{MOST} previews are served already")));
        }
        *lock(&self.newest) = view.clone();
        let wrong = |problem: Problem| Failure::plain(problem.message);
        let watch = flags(path, about.camera.as_deref())?;
        let (newest, of) = (self.newest.clone(), key.clone());
        let load = move |reading: &Reading, overrides: &Overrides| load(&newest, &of, reading, overrides);
        let store = Buffer {
            key: key.clone(),
            saved: Saved::at(path, interrupt),
            newest: self.newest.clone(),
            asked: self.changes.clone(),
            told: told.clone(),
        };
        let (newest, tell, name) = (self.newest.clone(), told.clone(), path.display().to_string());
        let broken = move || drop(tell.send(broken(&name)));
        let told = told.clone();
        let show = move |opened: Opened| show(&newest, &told, &opened);
        let (load, store, show, broken) = (Box::new(load), Box::new(store), Box::new(show), Box::new(broken));
        let live = live::preview(&watch, load, store, show, broken, Terminal::silent(), interrupt);
        let live = live.map_err(wrong)?;
        let url = live.url.clone();
        self.served.insert(served, live);
        Ok(url)
    }

    /// Texts have changed.
    pub fn follow(&self, view: &Arc<View>) {
        if !self.served.is_empty() {
            *lock(&self.newest) = view.clone();
            self.served.values().for_each(Live::look);
        }
    }

    /// The cursor stands somewhere: the pages light up what is there.
    pub fn point(&self, view: &View, key: &Key, position: Position) {
        let Some((path, document)) = key.path().zip(view.documents.get(key)) else { return };
        if self.served.is_empty() {
            return;
        }
        let text = document.text.whole();
        let byte = document.text.byte(place(position), view.session.encoding);
        let line = text[..byte].rfind('\n').map_or(0, |at| at + 1);
        let (row, column) = (text[..line].matches('\n').count() + 1, text[line..byte].chars().count() + 1);
        self.served
            .values()
            .for_each(|live| live.point(&path.display().to_string(), row as u32, column as u32));
    }
}

/// Refuses a camera that a document does not have, and does nothing else.
fn has_camera(asked: &mut Asked, params: Value) -> Answer<Value> {
    let About { uri, camera } = read(params)?;
    let key = Key::of(&uri);
    let meaning = match asked.meaning_of(&key) {
        Some(meaning) => meaning.ok(),
        None => Meaning::find(asked.view, &key, &|| asked.is_cancelled()).map(Arc::new),
    };
    match camera.zip(meaning).map(|(camera, meaning)| has(&meaning, &camera)) {
        Some(Err(failure)) => Err(failure),
        _ => Ok(Value::Null),
    }
}

/// The flags of a command that would serve it.
fn flags(path: &Path, camera: Option<&str>) -> Answer<crate::cli::args::Watch> {
    let mut words = vec!["rtc".into(), "watch".into(), "--serve".into(), "--quiet".into()];
    words.extend(camera.map(|camera| format!("--camera={camera}").into()));
    words.extend(["--".into(), path.as_os_str().to_owned()]);
    match Arguments::try_parse_from(words).map(|arguments| arguments.command) {
        Ok(Command::Watch(watch)) => Ok(watch),
        _ => Err(Failure::plain("this cannot be shown")),
    }
}

/// Compiles a document as it stands in the editor, or as it is saved where it is closed.
fn load(newest: &Newest, key: &Key, reading: &Reading, overrides: &Overrides) -> Result<Loaded, Problem> {
    let view = lock(newest).clone();
    let Some(path) = key.path() else { return Err(Problem::new("this has no place on the disk")) };
    let own = path.parent().unwrap_or(Path::new("/"));
    let root = view.root_of(path);
    let root = root.as_deref().unwrap_or(own);
    let Some(document) = view.documents.get(key) else {
        return scene::load(path, &Reading { root: Some(root.into()), ..reading.clone() }, overrides);
    };
    if document.kept != Kept::Whole {
        return Err(Problem::new(
            "what stands in the editor is not known: close the scene there and open it again",
        ));
    }
    let mut disk = Disk::below(root)?;
    let place = disk.path_of(path)?;
    for (key, document) in view.documents.iter().filter(|(_, document)| document.kept == Kept::Whole) {
        if let Some(path) = key.path() {
            disk.hold(path, document.text.whole().as_bytes());
        }
    }
    let source = Source::new(path.display().to_string(), document.text.whole().to_string());
    Ok(scene::take_from(disk, place, Input::of(source), reading, overrides))
}

/// Says that a preview is served no more.
fn broken(name: &str) -> Told {
    let message = format!("the preview of {name} has ended: this is a bug in rtc. It can be started again.");
    let params = lsp::ShowMessageParams { kind: lsp::MessageType::Error, message };
    Told::Notifies(lsp::LspNotificationMethod::WindowShowMessage.as_str().into(), json!(params))
}

/// Has the client show a place that was clicked on.
fn show(newest: &Newest, told: &Sender<Told>, opened: &Opened) {
    let Ok(path) = std::path::absolute(&opened.file) else { return };
    let view = lock(newest).clone();
    let key = Key::File(path.clone());
    let line = opened.line.saturating_sub(1);
    // Without the text the line is near enough.
    let document = view.documents.get(&key);
    let position = document.and_then(|document| {
        let text = document.text.whole();
        let start = text.split_inclusive('\n').take(line as usize).map(str::len).sum::<usize>();
        let before = text.get(start..)?.chars().take(opened.column.saturating_sub(1) as usize);
        let byte = start + before.map(char::len_utf8).sum::<usize>();
        Some(super::analyst::position(&document.text, byte, view.session.encoding))
    });
    let position = position.unwrap_or(Position { line, character: 0 });
    let uri = document.map_or_else(|| uri_of(&path).into(), |document| document.uri.clone());
    let params = lsp::ShowDocumentParams {
        uri,
        external: None,
        take_focus: Some(true),
        selection: Some(lsp::Range { start: position, end: position }),
    };
    let _ = told.send(Told::Asks(Ask::new(SHOW, json!(params))));
}

/// What asks the client to open a page; where it cannot, the browser itself is told to.
pub fn browse(url: &str, view: &View) -> Answer<Option<Value>> {
    if view.session.client.shows {
        return Ok(Some(json!({ "uri": url, "external": true })));
    }
    let problem = |_| Failure::plain(format!("no browser opens: open {url} yourself"));
    open::that_detached(url).map(|()| None).map_err(problem)
}

/// What is there is replaced as a whole.
pub fn lock(newest: &Newest) -> std::sync::MutexGuard<'_, Arc<View>> {
    newest.lock().unwrap_or_else(PoisonError::into_inner)
}
