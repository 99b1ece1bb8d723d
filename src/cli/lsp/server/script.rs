//! Whole sessions, as bytes that a fuzzer makes up: documents are opened, edited and closed, files come and go on the disk, and
//! in between somebody asks, cancels, and asks under the same id. Whatever the order, each request is answered once and by an
//! answer of its kind; what is said of each file in the end is what another server says that sees nothing but the end; and behind
//! the last document that is closed nothing is left of it.

use super::super::documents::Key;
use super::super::uri::uri_of;
use super::Server;
use crate::cli::interrupt::Interrupt;
use lsp_server::{Connection, Message, Notification, Request, RequestId, Response};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Much longer than anything here takes.
const PATIENCE: Duration = Duration::from_secs(60);

/// The files. One folder is a link to another.
const FILES: [&str; 4] = ["a.rt", "b.rt", "lib/c.rt", "room/c.rt"];

const TEXTS: [&str; 8] = [
    "",
    "let seat = 1m\n",
    "let seat = 8deg\n",
    "import \"b.rt\" as b\nsphere { radius: b.seat }\n",
    "import \"lib/c.rt\" as c\nlet seat = c.seat\nsphere { radius: seat }\n",
    "import \"room/c.rt\" as c\nsphere { radius: c.seat }\n",
    "sphere {\n",
    "import \"none/d.rt\" as d\nlet seat = 8deg\nlet wide = 2m\n",
];

/// What is asked, and whether the answer is a list.
const ASKED: [(&str, bool); 5] = [
    ("textDocument/hover", false),
    ("textDocument/foldingRange", true),
    ("textDocument/completion", true),
    ("textDocument/documentSymbol", true),
    ("textDocument/inlayHint", true),
];

/// What is said of each file: where, and what.
type Said = BTreeMap<Key, Vec<(Value, Value)>>;

/// A client of a server of its own.
struct Client {
    connection: Connection,
    server: JoinHandle<()>,
    /// What is open: the address and the version.
    open: BTreeMap<usize, (String, i32)>,
    /// What it was told last, by address.
    told: BTreeMap<String, (Option<i64>, Value)>,
    /// Requests that wait, and whether their answers are lists.
    waiting: BTreeMap<RequestId, bool>,
    next: i32,
}

impl Client {
    fn new(folder: &Path) -> Client {
        let (connection, other) = Connection::memory();
        let server = Server::new(other, None, Interrupt::default()).expect("threads");
        let server = std::thread::spawn(move || {
            server.run();
        });
        let (open, told, waiting) = (BTreeMap::new(), BTreeMap::new(), BTreeMap::new());
        let mut client = Client { connection, server, open, told, waiting, next: 1 };
        let folders = json!([{ "uri": uri_of(folder), "name": "here" }]);
        let refreshes = json!({ "refreshSupport": true });
        let watches = json!({ "dynamicRegistration": true });
        let workspace = json!({ "didChangeWatchedFiles": watches, "inlayHint": refreshes });
        let params = json!({ "capabilities": { "workspace": workspace }, "workspaceFolders": folders });
        client.send(Request::new(0.into(), "initialize".into(), params));
        client.waiting.insert(0.into(), false);
        client.tell("initialized", json!({}));
        client
    }

    fn send(&self, message: impl Into<Message>) {
        self.connection.sender.send(message.into()).expect("the server lives");
    }

    fn tell(&self, method: &str, params: Value) {
        self.send(Notification::new(method.into(), params));
    }

    /// Asks something about a document that may not be open.
    fn ask(&mut self, id: RequestId, what: usize, uri: &str) {
        let (method, is_list) = ASKED[what % ASKED.len()];
        let at = json!({ "line": 1, "character": 9 });
        let range = json!({ "start": { "line": 0, "character": 0 }, "end": { "line": 9, "character": 0 } });
        let params = json!({ "textDocument": { "uri": uri }, "position": at, "range": range });
        assert!(self.waiting.insert(id.clone(), is_list).is_none());
        self.send(Request::new(id, method.into(), params));
    }

    /// Takes in what comes until something is so.
    #[track_caller]
    fn until(&mut self, what: &str, is_so: impl Fn(&Client) -> bool) {
        let start = Instant::now();
        while !is_so(self) {
            match self.connection.receiver.recv_timeout(PATIENCE.saturating_sub(start.elapsed())) {
                Ok(message) => self.hear(message),
                Err(_) => panic!("not {what}: {:?}, told {:?}", self.waiting, self.told),
            }
        }
    }

    fn hear(&mut self, message: Message) {
        match message {
            Message::Response(Response { id, response_result }) => {
                let is_list = self.waiting.remove(&id).unwrap_or_else(|| panic!("{id} is answered again"));
                if let Ok(answer) = response_result {
                    assert!(answer.is_null() || answer.is_array() == is_list, "{id}: {answer}");
                }
            }
            Message::Notification(Notification { method, mut params }) => {
                assert_eq!(method, "textDocument/publishDiagnostics");
                let uri = params["uri"].as_str().expect("an address").to_string();
                self.told.insert(uri, (params["version"].as_i64(), params["diagnostics"].take()));
            }
            Message::Request(Request { id, .. }) => self.send(Response::new_ok(id, Value::Null)),
        }
    }

    /// What is said of each file.
    fn said(&self) -> Said {
        let mut said = Said::new();
        for (uri, (_, all)) in &self.told {
            let all = all.as_array().expect("a list").iter();
            let all: Vec<_> = all.map(|one| (one["range"].clone(), one["message"].clone())).collect();
            if !all.is_empty() {
                let twice = said.insert(Key::of(&uri.clone().into()), all);
                assert!(twice.is_none(), "{uri} has another name: {:?}", self.told);
            }
        }
        said
    }

    /// Waits until all that is open was looked at as it is.
    fn settle(&mut self) {
        for (uri, _) in self.open.clone().into_values() {
            let id = self.fresh();
            self.ask(id, 3, &uri);
        }
        self.until("all answered", |client| client.waiting.is_empty());
        let is_told = |client: &Client, (uri, version): &(String, i32)| {
            client.told.get(uri).is_some_and(|(told, _)| *told == Some(i64::from(*version)))
        };
        self.until("all told", |client| client.open.values().all(|open| is_told(client, open)));
    }

    fn fresh(&mut self) -> RequestId {
        self.next += 1;
        self.next.into()
    }

    /// Closes all, and ends.
    fn end(mut self) {
        for (uri, _) in std::mem::take(&mut self.open).into_values() {
            self.tell("textDocument/didClose", json!({ "textDocument": { "uri": uri } }));
        }
        let id = self.fresh();
        self.waiting.insert(id.clone(), false);
        self.send(Request::new(id, "shutdown".into(), Value::Null));
        self.until("all answered", |client| client.waiting.is_empty());
        self.tell("exit", Value::Null);
        let Client { connection, server, mut told, .. } = self;
        server.join().expect("no panic");
        for message in connection.receiver.try_iter() {
            let Message::Notification(said) = message else { panic!("{message:?} at the end") };
            let uri = said.params["uri"].as_str().expect("an address").to_string();
            told.insert(uri, (None, said.params["diagnostics"].clone()));
        }
        told.retain(|_, (_, said)| said.as_array().is_some_and(|said| !said.is_empty()));
        assert!(told.is_empty(), "left: {told:?}");
    }
}

/// The session that some bytes tell: each three what is done, to which file, and with what.
pub fn run(script: &[u8]) {
    let folder = tempfile::tempdir().expect("a folder");
    let here = folder.path().canonicalize().expect("a folder");
    fs::create_dir(here.join("lib")).expect("a folder");
    #[cfg(unix)]
    std::os::unix::fs::symlink("lib", here.join("room")).expect("a link");
    for file in ["b.rt", "lib/c.rt"] {
        fs::write(here.join(file), TEXTS[1]).expect("it can be written");
    }
    let mut client = Client::new(&here);
    let mut texts: BTreeMap<usize, String> = BTreeMap::new();
    for step in script.chunks_exact(3) {
        let (file, what) = (usize::from(step[1]) % FILES.len(), usize::from(step[2]));
        let path = here.join(FILES[file]);
        // One file has several addresses.
        let plain = uri_of(&path);
        let uri = match client.open.get(&file) {
            Some((uri, _)) => uri.clone(),
            None if what & 64 == 0 => plain.clone(),
            None => plain.replace("file://", "file://localhost"),
        };
        let text = TEXTS[what % TEXTS.len()];
        match step[0] % 9 {
            0 | 1 => match client.open.get_mut(&file) {
                None => {
                    let item = json!({ "uri": uri, "languageId": "rt", "version": 1, "text": text });
                    client.tell("textDocument/didOpen", json!({ "textDocument": item }));
                    client.open.insert(file, (uri, 1));
                    texts.insert(file, text.into());
                }
                Some((_, version)) => {
                    *version += 1;
                    let document = json!({ "uri": uri, "version": *version });
                    let start = json!({ "line": 0, "character": 0 });
                    let before = texts.entry(file).or_default();
                    let change = if what & 32 == 0 {
                        *before = text.into();
                        json!({ "text": text })
                    } else {
                        before.insert_str(0, text);
                        json!({ "range": { "start": start, "end": start }, "text": text })
                    };
                    let changes = json!({ "textDocument": document, "contentChanges": [change] });
                    client.tell("textDocument/didChange", changes);
                }
            },
            2 => {
                if client.open.remove(&file).is_some() {
                    texts.remove(&file);
                    client.tell("textDocument/didClose", json!({ "textDocument": { "uri": uri } }));
                }
            }
            3..6 => {
                let id = client.fresh();
                client.ask(id, what, &uri);
            }
            6 => {
                // The one that was asked last, whose id is used again.
                let id = RequestId::from(client.next);
                client.tell("$/cancelRequest", json!({ "id": client.next }));
                client.until("answered", |client| !client.waiting.contains_key(&id));
                client.ask(id, what, &uri);
            }
            // Saved.
            7 => {
                let done = fs::create_dir_all(here.join("lib")).and_then(|()| fs::write(&path, text));
                done.expect("it can be written");
                let change = json!({ "uri": plain, "type": 2 });
                client.tell("workspace/didChangeWatchedFiles", json!({ "changes": [change] }));
            }
            _ => {
                // A file, or a folder with what is in it.
                let gone = if what & 1 == 0 { here.join("lib") } else { path };
                let _ =
                    if gone.ends_with("lib") { fs::remove_dir_all(&gone) } else { fs::remove_file(&gone) };
                let change = json!({ "uri": uri_of(&gone), "type": 3 });
                client.tell("workspace/didChangeWatchedFiles", json!({ "changes": [change] }));
            }
        }
    }
    client.settle();
    let mut fresh = Client::new(&here);
    for (file, (uri, version)) in &client.open {
        let text = &texts[file];
        let item = json!({ "uri": uri, "languageId": "rt", "version": version, "text": text });
        fresh.tell("textDocument/didOpen", json!({ "textDocument": item }));
        fresh.open.insert(*file, (uri.clone(), *version));
    }
    fresh.settle();
    // What was found to be out of date may still be looked at again.
    let start = Instant::now();
    while client.said() != fresh.said() {
        assert!(start.elapsed() < PATIENCE, "{:#?}\n{:#?}", client.said(), fresh.said());
        for one in [&mut client, &mut fresh] {
            if let Ok(message) = one.connection.receiver.recv_timeout(Duration::from_millis(50)) {
                one.hear(message);
            }
        }
    }
    client.end();
    fresh.end();
}
