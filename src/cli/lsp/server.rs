//! What a message leads to. The one thread that knows all documents never works for long: whatever takes time is done by
//! others, with the documents as they were.

use super::capabilities::initialized;
use super::client::{Client, encoding};
use super::commands::{self, Order};
use super::diagnostics::Board;
use super::documents::{Documents, Key};
use super::pages::Pages;
use super::preview::{self, Previews};
use super::requests::{self, read};
use super::uri::path_of;
use super::view::{Session, View};
use super::work::{Answer, Desk, Failure, Question, Told};
use crate::cli::Exit;
use crate::cli::interrupt::Interrupt;
use crate::cli::live::watcher::Watcher;
use crossbeam_channel::{Receiver, Sender, bounded, select};
use gen_lsp_types as lsp;
use lsp::LspNotificationMethod as Method;
use lsp_server::{Connection, ErrorCode, Message, Notification, ReqQueue, Request, RequestId, Response};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// The most requests that wait at once.
const MOST_WAITING: usize = 1_000;
/// What threads tell that waits to be heard.
const QUEUE: usize = 64;

/// Tells where the cursor is, by document and position: clients that can send it more often than they ask anything.
const CURSOR: &str = "rtc/cursor";

/// Where in its life the server is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Life {
    /// Before `initialize`.
    New,
    Serving,
    /// Behind `shutdown`.
    Ending,
}

/// The server.
pub struct Server {
    connection: Connection,
    life: Life,
    view: Arc<View>,
    desk: Arc<Desk>,
    told: Receiver<Told>,
    /// Where others tell something.
    tell: Sender<Told>,
    interrupt: Interrupt,
    previews: Previews,
    /// Tells of files that change, where the client does not.
    watcher: Option<Watcher>,
    /// What waits for an answer, each with what says that none is wanted.
    waiting: ReqQueue<Arc<AtomicBool>, ()>,
    count: usize,
    board: Board,
    /// What each open document is made of, as far as that is known.
    reads: BTreeMap<Key, BTreeSet<Key>>,
    /// When files changed last, as documents are stamped.
    changed: BTreeMap<Key, u64>,
}

impl Server {
    /// One that knows nothing yet.
    ///
    /// # Errors
    ///
    /// Where the system gives no more threads.
    pub fn new(connection: Connection, root: Option<PathBuf>, interrupt: Interrupt) -> io::Result<Server> {
        let (tell, told) = bounded(QUEUE);
        let (client, pages) = (Client::default(), Pages::default());
        let (encoding, memory) = (encoding(&Value::Null), Arc::default());
        let session = Session { client, encoding, root, pages, memory };
        let view = View { session: Arc::new(session), documents: Documents::default(), folders: vec![] };
        let view = Arc::new(view);
        Ok(Server {
            connection,
            life: Life::New,
            previews: Previews::new(view.clone()),
            view,
            watcher: None,
            desk: Desk::start(&tell)?,
            told,
            tell,
            interrupt,
            waiting: ReqQueue::default(),
            count: 0,
            board: Board::default(),
            reads: BTreeMap::new(),
            changed: BTreeMap::new(),
        })
    }

    /// Serves until `exit` or the end of the input.
    pub fn run(mut self) -> Exit {
        let (messages, told) = (self.connection.receiver.clone(), self.told.clone());
        loop {
            select! {
                recv(messages) -> message => match message {
                    Ok(Message::Notification(notification)) if Method::from(&*notification.method) == Method::Exit => break,
                    Ok(message) => self.take(message),
                    Err(_) => break,
                },
                recv(told) -> told => match told {
                    Ok(told) => self.hear(told),
                    Err(_) => break,
                },
            }
        }
        // Others may hold what was known, and with it the pages, until the process ends.
        self.view.session.pages.tidy();
        // The protocol's codes: 1 for an end that was not announced.
        if self.life == Life::Ending { Exit::Done } else { Exit::Diagnostics }
    }

    fn take(&mut self, message: Message) {
        match message {
            Message::Request(request) => self.request(request),
            Message::Notification(notification) => {
                // What cannot be read is left alone: nobody waits for an answer.
                let _ = self.notification(notification);
            }
            Message::Response(response) => {
                self.waiting.outgoing.complete(response.id);
            }
        }
    }

    fn request(&mut self, request: Request) {
        let Request { id, method, params } = request;
        if !self.waiting.incoming.is_completed(&id) {
            let failure = Failure::new(ErrorCode::InvalidRequest, format!("the id {id} is in use"));
            return self.send(id, Err(failure));
        }
        match (self.life, lsp::LspRequestMethod::from(&*method)) {
            (Life::New, lsp::LspRequestMethod::Initialize) => {
                let answer = self.initialize(&params);
                self.send(id, answer);
            }
            (Life::New, _) => {
                let code = ErrorCode::ServerNotInitialized;
                self.send(id, Err(Failure::new(code, "`initialize` comes first")));
            }
            (Life::Ending, _) => {
                self.send(id, Err(Failure::new(ErrorCode::InvalidRequest, "`shutdown` has been asked for")));
            }
            (Life::Serving, lsp::LspRequestMethod::Initialize) => {
                self.send(id, Err(Failure::new(ErrorCode::InvalidRequest, "`initialize` comes once")));
            }
            (Life::Serving, lsp::LspRequestMethod::Shutdown) => {
                self.life = Life::Ending;
                self.send(id, Ok(Value::Null));
            }
            (Life::Serving, _) if self.count >= MOST_WAITING => {
                self.send(id, Err(Failure::plain("too many requests wait already")));
            }
            (Life::Serving, lsp::LspRequestMethod::WorkspaceExecuteCommand) => {
                if let Err(failure) = self.execute(id.clone(), params) {
                    self.finish(id, Err(failure));
                }
            }
            (Life::Serving, _) => self.ask(id, &method, params),
        }
    }

    /// Has a question answered.
    fn ask(&mut self, id: RequestId, method: &str, params: Value) {
        let Some((lane, run)) = requests::find(method) else {
            let failure = Failure::new(ErrorCode::MethodNotFound, format!("`{method}` is not known here"));
            return self.send(id, Err(failure));
        };
        let cancelled = self.register(&id);
        // Who asks what is used like what is under the cursor has it there.
        if lsp::LspRequestMethod::from(method) == lsp::LspRequestMethod::TextDocumentDocumentHighlight {
            self.point(&params);
        }
        self.desk.ask(lane, Question { id, run, params, view: self.view.clone(), cancelled });
    }

    /// Has something done.
    fn execute(&mut self, id: RequestId, params: Value) -> Answer<()> {
        let cancelled = self.register(&id);
        let (command, about) = commands::wanted(params)?;
        let (view, told, interrupt) = (self.view.clone(), self.tell.clone(), self.interrupt.clone());
        let order = Order { id, key: Key::of(&about.uri), about, view, cancelled, told, interrupt };
        match command.as_str() {
            commands::PREVIEW => self.preview(&order),
            _ => commands::render(order),
        }
    }

    /// Shows the picture of a document from now on.
    fn preview(&mut self, order: &Order) -> Answer<()> {
        let url = self.previews.start(order)?;
        let answer = preview::browse(&url, &order.view, &order.told);
        self.finish(order.id.clone(), answer);
        Ok(())
    }

    /// Waits for an answer from somebody else, who may see whether it is still wanted.
    fn register(&mut self, id: &RequestId) -> Arc<AtomicBool> {
        let cancelled = Arc::new(AtomicBool::new(false));
        self.count += 1;
        self.waiting.incoming.register(id.clone(), cancelled.clone());
        cancelled
    }

    /// Passes on an answer, unless it was cancelled and so is answered already.
    fn finish(&mut self, id: RequestId, answer: Answer<Value>) {
        if self.waiting.incoming.complete(&id).is_some() {
            self.count -= 1;
            self.send(id, answer);
        }
    }

    fn initialize(&mut self, params: &Value) -> Answer<Value> {
        self.life = Life::Serving;
        let folders = params.get("workspaceFolders").and_then(Value::as_array).cloned().unwrap_or_default();
        let uris = folders.iter().filter_map(|folder| folder.get("uri"));
        let uris: Vec<&str> = uris
            .chain(params.get("rootUri").filter(|_| folders.is_empty()))
            .filter_map(Value::as_str)
            .collect();
        let view = Arc::make_mut(&mut self.view);
        view.folders = uris.into_iter().filter_map(path_of).collect();
        view.session = Arc::new(Session {
            client: Client::read(params),
            encoding: encoding(params),
            root: view.session.root.clone(),
            pages: Pages::default(),
            memory: Arc::default(),
        });
        serde_json::to_value(initialized(view.session.encoding))
            .map_err(|error| Failure::new(ErrorCode::InternalError, error.to_string()))
    }

    fn notification(&mut self, notification: Notification) -> Answer<()> {
        let Notification { method, params } = notification;
        let method = Method::from(&*method);
        if self.life != Life::Serving {
            return Ok(());
        }
        match method {
            Method::Initialized => self.watch(),
            Method::CancelRequest => self.cancel(read(params)?),
            Method::TextDocumentDidOpen => {
                let lsp::DidOpenTextDocumentParams { text_document: item } = read(params)?;
                let key = Arc::make_mut(&mut self.view).documents.open(item.uri, item.version, item.text);
                self.changed_at(vec![key]);
            }
            Method::TextDocumentDidChange => {
                let lsp::DidChangeTextDocumentParams { text_document, content_changes } = read(params)?;
                let key = Key::of(&text_document.text_document_identifier.uri);
                let view = Arc::make_mut(&mut self.view);
                let encoding = view.session.encoding;
                view.documents.change(&key, text_document.version, content_changes, encoding);
                self.changed_at(vec![key]);
            }
            Method::TextDocumentDidClose => {
                let lsp::DidCloseTextDocumentParams { text_document } = read(params)?;
                self.close(&Key::of(&text_document.uri));
            }
            Method::TextDocumentDidSave => {
                let lsp::DidSaveTextDocumentParams { text_document, .. } = read(params)?;
                self.saved_at(vec![Key::of(&text_document.uri)]);
            }
            Method::WorkspaceDidChangeWatchedFiles => {
                let lsp::DidChangeWatchedFilesParams { changes } = read(params)?;
                self.saved_at(changes.iter().map(|change| Key::of(&change.uri)).collect());
            }
            Method::WorkspaceDidChangeWorkspaceFolders => {
                let lsp::DidChangeWorkspaceFoldersParams { event } = read(params)?;
                self.change_folders(&event);
            }
            Method::Custom(CURSOR) => self.point(&params),
            // The others make no difference here.
            _ => {}
        }
        Ok(())
    }

    fn cancel(&mut self, params: lsp::CancelParams) {
        let id: RequestId = match params.id {
            lsp::Id::Int(id) => id.into(),
            lsp::Id::String(id) => id.into(),
        };
        self.desk.drop_question(&id);
        if let Some(cancelled) = self.waiting.incoming.complete(&id) {
            cancelled.store(true, Ordering::Relaxed);
            self.count -= 1;
            self.send(id, Err(Failure::cancelled()));
        }
    }

    /// Has the previews show what stands at the cursor.
    fn point(&self, params: &Value) {
        if let Ok(lsp::TextDocumentPositionParams { text_document, position }) = read(params.clone()) {
            self.previews.point(&self.view, &Key::of(&text_document.uri), position);
        }
    }

    fn change_folders(&mut self, event: &lsp::WorkspaceFoldersChangeEvent) {
        let paths = |folders: &[lsp::WorkspaceFolder]| -> Vec<PathBuf> {
            folders.iter().filter_map(|folder| path_of(folder.uri.as_ref())).collect()
        };
        let (added, removed) = (paths(&event.added), paths(&event.removed));
        let folders = &mut Arc::make_mut(&mut self.view).folders;
        folders.retain(|folder| !removed.contains(folder) && !added.contains(folder));
        folders.extend(added);
        let all = self.view.documents.iter().map(|(key, _)| key.clone()).collect();
        self.touch(all);
    }

    fn close(&mut self, key: &Key) {
        Arc::make_mut(&mut self.view).documents.close(key);
        self.reads.remove(key);
        for told in self.board.close(key, &self.view) {
            self.publish(told);
        }
        // Those that import it read what is saved from now on.
        self.changed_at(vec![key.clone()]);
    }

    /// Open documents have other texts: they and those that are made of them mean something else.
    fn changed_at(&mut self, keys: Vec<Key>) {
        let stamp = self.view.documents.stamp();
        self.changed.extend(keys.iter().map(|key| (key.clone(), stamp)));
        let users = self.users(&keys);
        let documents = &mut Arc::make_mut(&mut self.view).documents;
        let users: Vec<Key> = users.into_iter().filter(|key| documents.touch(key)).collect();
        let open = keys.into_iter().filter(|key| documents.get(key).is_some());
        let looked: Vec<Key> = open.chain(users).collect();
        self.desk.look(looked, &self.view);
        self.previews.follow(&self.view);
    }

    /// Saved files have changed: only those mean something else that read them there.
    fn saved_at(&mut self, keys: Vec<Key>) {
        let stamp = self.view.documents.stamp() + 1;
        let open = |key: &Key| self.view.documents.get(key).is_some();
        let keys: Vec<Key> = keys.into_iter().filter(|key| !open(key)).collect();
        self.changed.extend(keys.iter().map(|key| (key.clone(), stamp)));
        let users = self.users(&keys);
        self.touch(users);
    }

    /// The open documents that are made of some files, but not these.
    fn users(&self, keys: &[Key]) -> Vec<Key> {
        let uses = |(user, reads): &(&Key, &BTreeSet<Key>)| {
            !keys.contains(user) && keys.iter().any(|key| reads.contains(key))
        };
        self.reads.iter().filter(uses).map(|(user, _)| user.clone()).collect()
    }

    /// Open documents mean something else.
    fn touch(&mut self, keys: Vec<Key>) {
        if keys.is_empty() {
            return;
        }
        let documents = &mut Arc::make_mut(&mut self.view).documents;
        let open: Vec<Key> = keys.into_iter().filter(|key| documents.touch(key)).collect();
        self.desk.look(open, &self.view);
    }

    fn hear(&mut self, told: Told) {
        match told {
            Told::Answered(id, answer) => self.finish(id, answer),
            Told::Changed => self.saved_at(self.reads.values().flatten().cloned().collect()),
            Told::Notifies(method, params) => self.notify(method, params),
            Told::Asks(method, params) => self.ask_client(method, params),
            Told::Looked { key, view, reads, found } => {
                let seen = view.documents.get(&key).map(|document| document.stamp);
                let now = self.view.documents.get(&key).map(|document| document.stamp);
                if now.is_none() || seen != now {
                    return;
                }
                // What it reads may have changed while it was looked at, when nobody knew that it does.
                let stamp = view.documents.stamp();
                let late = |read: &Key| self.changed.get(read).is_some_and(|&changed| changed > stamp);
                let again = reads.iter().any(late);
                self.reads.insert(key.clone(), reads);
                self.follow();
                if again {
                    return self.touch(vec![key]);
                }
                for told in self.board.take(key, found, &self.view) {
                    self.publish(told);
                }
            }
        }
    }

    /// Has the client tell of scenes, and what they read, that change on the disk; or somebody else, where it cannot.
    fn watch(&mut self) {
        if !self.view.session.client.watches {
            let tell = self.tell.clone();
            // One that waits to be heard is as good as two.
            self.watcher = Watcher::new(None, move || drop(tell.try_send(Told::Changed))).ok();
            return;
        }
        let pattern = "**/*.{rt,csv,png,jpg,jpeg,webp,hdr,exr,pfm,ply,obj,stl}";
        let watchers = vec![lsp::FileSystemWatcher {
            glob_pattern: lsp::GlobPattern::Pattern(pattern.into()),
            kind: None,
        }];
        let options = lsp::DidChangeWatchedFilesRegistrationOptions { watchers };
        let registration = lsp::Registration {
            id: "watched-files".into(),
            method: Method::WorkspaceDidChangeWatchedFiles.as_str().into(),
            register_options: serde_json::to_value(options).ok(),
        };
        let params = lsp::RegistrationParams { registrations: vec![registration] };
        let method = lsp::LspRequestMethod::ClientRegisterCapability.as_str().to_string();
        self.ask_client(method, params);
    }

    /// Asks the client something whose answer makes no difference.
    fn ask_client(&mut self, method: String, params: impl serde::Serialize) {
        let request = self.waiting.outgoing.register(method, params, ());
        let _ = self.connection.sender.send(request.into());
    }

    /// Watches the files that are read where they are saved.
    fn follow(&mut self) {
        let Some(watcher) = &mut self.watcher else { return };
        let saved = |key: &&Key| self.view.documents.get(key).is_none();
        let files: BTreeSet<&Key> = self.reads.values().flatten().filter(saved).collect();
        watcher.follow(files.into_iter().filter_map(Key::path).map(PathBuf::from));
    }

    fn publish(&self, params: lsp::PublishDiagnosticsParams) {
        self.notify(Method::TextDocumentPublishDiagnostics.as_str().to_string(), params);
    }

    fn notify(&self, method: String, params: impl serde::Serialize) {
        let _ = self.connection.sender.send(Notification::new(method, params).into());
    }

    /// Sends an answer. Where nobody reads any more, the end of the input follows.
    fn send(&self, id: RequestId, answer: Answer<Value>) {
        let response = match answer {
            Ok(value) => Response::new_ok(id, value),
            Err(Failure { code, message }) => Response::new_err(id, code, message),
        };
        let _ = self.connection.sender.send(response.into());
    }
}
