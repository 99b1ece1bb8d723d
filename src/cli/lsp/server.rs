//! What a message leads to. The one thread that knows all documents never works for long: whatever takes time is done by
//! others, with the documents as they were.

mod changes;

use super::capabilities::{initialized, watched};
use super::client::{Client, encoding};
use super::commands::{self, Order, Renders};
use super::diagnostics::Board;
use super::documents::{Changed, Documents, Key, MOST_TEXTS};
use super::ending;
use super::events::Events;
use super::pages::Pages;
use super::preview::{self, Previews};
use super::reads::Reads;
use super::render;
use super::requests::{self, Lane, read};
use super::uri::path_of;
use super::view::{Session, View};
use super::work::{Answer, Ask, Desk, Failure, Heard, Question, Told, guarded};
use crate::cli::Exit;
use crate::cli::interrupt::Interrupt;
use crate::cli::live::watcher::Watcher;
use changes::{Held, Looks};
use crossbeam_channel::{Receiver, Sender, bounded, select};
use gen_lsp_types as lsp;
use lsp::LspNotificationMethod as Method;
use lsp_server::{Connection, ErrorCode, Message, Notification, ReqQueue, Request, RequestId, Response};
use serde_json::{Value, json};
use std::io;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// The most requests that wait at once.
const MOST_WAITING: usize = 1_000;
/// The most bytes of texts that are held, those that are no longer so by requests that wait.
const MOST_HELD: usize = 3 * MOST_TEXTS;
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
    renders: Renders,
    /// Tells of files that change, where the client does not.
    watcher: Option<Watcher>,
    /// What it has told.
    events: Arc<Events>,
    rings: Receiver<()>,
    looks: Looks,
    /// What waits for an answer: of the client each with what says that none is wanted, and of the server each with who hears
    /// it.
    waiting: ReqQueue<Arc<AtomicBool>, Heard>,
    /// Of the client.
    count: usize,
    /// Of the server.
    asked: usize,
    held: Held,
    board: Board,
    reads: Reads,
}

impl Server {
    /// One that knows nothing yet.
    ///
    /// # Errors
    ///
    /// Where the system gives no more threads.
    pub fn new(connection: Connection, root: Option<PathBuf>, interrupt: Interrupt) -> io::Result<Server> {
        let (tell, told) = bounded(QUEUE);
        let (events, rings) = Events::new();
        let (client, pages) = (Client::default(), Pages::new(interrupt.clone()));
        let (encoding, memory) = (encoding(&Value::Null), Arc::default());
        let session = Session { client, encoding, root, pages, memory };
        let view = View { session: Arc::new(session), documents: Documents::default(), folders: vec![] };
        let view = Arc::new(view);
        Ok(Server {
            connection,
            life: Life::New,
            previews: Previews::new(view.clone()),
            renders: Renders::default(),
            view,
            watcher: None,
            events: Arc::new(events),
            rings,
            looks: Looks::default(),
            desk: Desk::start(&tell)?,
            told,
            tell,
            interrupt,
            waiting: ReqQueue::default(),
            count: 0,
            asked: 0,
            held: Held::default(),
            board: Board::default(),
            reads: Reads::default(),
        })
    }

    /// Serves until `exit` or the end of the input.
    pub fn run(mut self) -> Exit {
        let (messages, told, rings) =
            (self.connection.receiver.clone(), self.told.clone(), self.rings.clone());
        loop {
            select! {
                recv(messages) -> message => match message {
                    Ok(Message::Notification(notification)) if Method::from(&*notification.method) == Method::Exit => break,
                    Ok(message) => self.take(message),
                    Err(_) => break,
                },
                recv(told) -> told => match told {
                    Ok(Told::Gone) => break,
                    Ok(told) => {
                        // What goes wrong here is reported, and the server lives.
                        let _ = guarded(|| self.hear(told));
                    }
                    Err(_) => break,
                },
                recv(rings) -> _ => {
                    let _ = guarded(|| self.hear_events());
                }
            }
        }
        // Others may be at work until the process ends.
        self.desk.close();
        self.interrupt.close();
        // The protocol's codes: 1 for an end that was not announced.
        if self.life == Life::Ending { Exit::Done } else { Exit::Diagnostics }
    }

    /// Takes a message in. Where that panics, whoever asked is answered, and the server lives.
    fn take(&mut self, message: Message) {
        let id = match &message {
            Message::Request(request) => Some(request.id.clone()),
            _ => None,
        };
        if let (Err(failure), Some(id)) = (guarded(|| self.do_what_it_says(message)), id) {
            match self.waiting.incoming.is_completed(&id) {
                true => self.send(id, Err(failure)),
                false => self.finish(id, Err(failure)),
            }
        }
    }

    fn do_what_it_says(&mut self, message: Message) {
        match message {
            Message::Request(request) => self.request(request),
            Message::Notification(notification) => {
                // What cannot be read is left alone: nobody waits for an answer.
                let _ = self.notification(notification);
            }
            Message::Response(response) => {
                if let Some(heard) = self.waiting.outgoing.complete(response.id) {
                    self.asked -= 1;
                    heard(
                        response
                            .response_result
                            .map_err(|error| Failure { code: error.code, message: error.message }),
                    );
                }
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
            (Life::Serving, _) if self.count >= MOST_WAITING || self.held.bytes() > MOST_HELD => {
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
            commands::PREVIEW if order.about.camera.is_some() => {
                let question = self.previews.want(order);
                self.desk.ask(Lane::Meaning, question);
                Ok(())
            }
            commands::PREVIEW => {
                let address = self.preview(&order)?;
                self.finish(order.id, Ok(address));
                Ok(())
            }
            _ => {
                if let Some(before) = self.renders.start(order)? {
                    self.cancel(before);
                }
                Ok(())
            }
        }
    }

    /// Shows the picture of a document from now on, and gives the address.
    fn preview(&mut self, order: &Order) -> Answer<Value> {
        let url = self.previews.start(order, &self.view)?;
        // Not through the queue of what is told: who hears it would wait for itself.
        if let Some(page) = preview::browse(&url, &self.view)? {
            self.ask_client(Ask::new(preview::SHOW, page));
        }
        Ok(json!({ "url": url }))
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
            self.renders.forget(&id);
            self.send(id, answer);
        }
    }

    fn initialize(&mut self, params: &Value) -> Answer<Value> {
        self.life = Life::Serving;
        let tell = self.tell.clone();
        ending::with_client(params, &self.interrupt, move || drop(tell.send(Told::Gone)));
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
            pages: Pages::new(self.interrupt.clone()),
            memory: Arc::default(),
        });
        serde_json::to_value(initialized(&view.session.client, view.session.encoding))
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
            Method::CancelRequest => match read::<lsp::CancelParams>(params)?.id {
                lsp::Id::Int(id) => self.cancel(id.into()),
                lsp::Id::String(id) => self.cancel(id.into()),
            },
            Method::WindowWorkDoneProgressCancel => {
                let lsp::WorkDoneProgressCancelParams { token } = read(params)?;
                if let Some(id) = render::request_of(&token) {
                    self.cancel(id);
                }
            }
            Method::TextDocumentDidOpen => {
                let lsp::DidOpenTextDocumentParams { text_document: item } = read(params)?;
                let key = Arc::make_mut(&mut self.view).documents.open(item.uri, item.version, item.text);
                self.changed_at(vec![key]);
            }
            Method::TextDocumentDidChange => {
                let changed: Changed = read(params)?;
                let key = Key::of(&changed.text_document.uri);
                let view = Arc::make_mut(&mut self.view);
                let encoding = view.session.encoding;
                view.documents.change(&key, changed, encoding);
                self.changed_at(vec![key]);
            }
            Method::TextDocumentDidClose => {
                let lsp::DidCloseTextDocumentParams { text_document } = read(params)?;
                self.close(&Key::of(&text_document.uri));
            }
            Method::TextDocumentDidSave => {
                let lsp::DidSaveTextDocumentParams { text_document, .. } = read(params)?;
                self.saved_at(path_of(text_document.uri.as_ref()));
            }
            Method::WorkspaceDidChangeWatchedFiles => {
                let lsp::DidChangeWatchedFilesParams { changes } = read(params)?;
                self.saved_at(changes.iter().filter_map(|change| path_of(change.uri.as_ref())));
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

    fn cancel(&mut self, id: RequestId) {
        self.give_up(id, Failure::cancelled());
    }

    /// Answers a request that somebody may be at work on.
    fn give_up(&mut self, id: RequestId, why: Failure) {
        self.desk.drop_question(&id);
        if let Some(cancelled) = self.waiting.incoming.complete(&id) {
            cancelled.store(true, Ordering::Relaxed);
            self.count -= 1;
            self.renders.forget(&id);
            self.previews.wanted(&id);
            self.send(id, Err(why));
        }
    }

    /// Has the previews show what stands at the cursor.
    fn point(&self, params: &Value) {
        if let Ok(lsp::TextDocumentPositionParams { text_document, position }) = read(params.clone()) {
            self.previews.point(&self.view, &Key::of(&text_document.uri), position);
        }
    }

    fn hear(&mut self, told: Told) {
        match told {
            // It was answered already, and its id may be that of another request by now.
            Told::Answered(_, _, cancelled) if cancelled.load(Ordering::Relaxed) => {}
            Told::Answered(id, answer, _) => {
                let answer = match self.previews.wanted(&id) {
                    Some(order) => {
                        answer.and_then(|_| guarded(|| self.preview(&order)).and_then(|answer| answer))
                    }
                    None => answer,
                };
                self.finish(id, answer);
            }
            Told::Gone => {}
            Told::Unanswered(_, question) if question.cancelled.load(Ordering::Relaxed) => {}
            Told::Unanswered(lane, question) => {
                self.desk.ask(lane, Question { view: self.view.clone(), ..question });
            }
            Told::Notifies(method, params) => self.notify(method, params),
            Told::Asks(ask) => self.ask_client(ask),
            Told::Looked { key, view, reads, found } => {
                let seen = view.documents.get(&key).map(|document| document.stamp);
                let now = self.view.documents.get(&key).map(|document| document.stamp);
                if now.is_none() || seen != now {
                    return;
                }
                let is_late = self.reads.take(&key, reads, view.documents.stamp());
                self.follow();
                if is_late {
                    return self.touch(vec![key]);
                }
                // Once for all that one edit has changed.
                if self.reads.settle(&key) {
                    self.refresh();
                }
                for told in self.board.take(key, found, &self.view) {
                    self.publish(told);
                }
            }
        }
    }

    /// Has the client ask again for what it shows in texts that it did not edit.
    fn refresh(&mut self) {
        let Client { refreshes_hints, refreshes_tokens, .. } = self.view.session.client;
        for (can, method) in [
            (refreshes_hints, lsp::LspRequestMethod::WorkspaceInlayHintRefresh),
            (refreshes_tokens, lsp::LspRequestMethod::WorkspaceSemanticTokensRefresh),
        ] {
            if can {
                self.ask_client(Ask::new(method, Value::Null));
            }
        }
    }

    /// Has the client tell of scenes, and what they read, that change on the disk, if it can.
    fn watch(&mut self) {
        if self.view.session.client.watches {
            self.ask_client(Ask::new(lsp::LspRequestMethod::ClientRegisterCapability, json!(watched())));
        }
    }

    /// Asks the client something.
    fn ask_client(&mut self, Ask { method, params, heard }: Ask) {
        if self.asked >= MOST_WAITING {
            return heard(Err(Failure::plain("the editor answers nothing")));
        }
        self.asked += 1;
        let request = self.waiting.outgoing.register(method, params, heard);
        let _ = self.connection.sender.send(request.into());
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

#[cfg(any(test, fuzzing))]
pub mod script;
#[cfg(test)]
mod tests;
