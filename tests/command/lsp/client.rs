//! An editor that does what it is told.

use super::super::Desk;
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

/// Much longer than anything here takes, also on a busy machine.
pub const PATIENCE: Duration = Duration::from_secs(60);

/// A session with the server, which runs in a folder.
pub struct Client<'d> {
    pub desk: &'d Desk,
    child: Child,
    input: Option<ChildStdin>,
    messages: Receiver<Value>,
    /// What came that nobody has looked at.
    kept: Vec<Value>,
    next: i32,
    /// Whether it takes tokens of progress at once.
    pub agrees: bool,
}

impl<'d> Client<'d> {
    /// Starts the server, and says nothing yet.
    pub fn silent(desk: &'d Desk) -> Client<'d> {
        Client::started(desk, "lsp")
    }

    /// Starts it with arguments.
    pub fn started(desk: &'d Desk, arguments: &str) -> Client<'d> {
        Client::of(desk, desk.command(arguments))
    }

    /// Starts it with a folder of its own for what does not last.
    pub fn in_place(desk: &'d Desk, temporary: &std::path::Path) -> Client<'d> {
        let mut command = desk.command("lsp");
        command.env("TMPDIR", temporary);
        Client::of(desk, command)
    }

    fn of(desk: &'d Desk, mut command: Command) -> Client<'d> {
        let mut child =
            command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::inherit()).spawn().unwrap();
        let mut output = BufReader::new(child.stdout.take().unwrap());
        let (sender, messages) = channel();
        std::thread::spawn(move || {
            while let Some(message) = read(&mut output) {
                if sender.send(message).is_err() {
                    return;
                }
            }
        });
        let input = child.stdin.take();
        Client { desk, child, input, messages, kept: vec![], next: 1, agrees: true }
    }

    /// Starts it, and agrees on what both can do.
    pub fn with(desk: &'d Desk, capabilities: Value) -> Client<'d> {
        let client = Client::silent(desk);
        let folder = json!({ "uri": client.uri(""), "name": "desk" });
        client.agreed(json!({ "capabilities": capabilities, "workspaceFolders": [folder] }))
    }

    /// Agrees on what both can do, and where.
    pub fn agreed(mut self, params: Value) -> Client<'d> {
        self.ask("initialize", params).unwrap();
        self.tell("initialized", json!({}));
        self
    }

    /// One that can do what most can.
    pub fn new(desk: &'d Desk) -> Client<'d> {
        Client::with(
            desk,
            json!({
                "general": { "positionEncodings": ["utf-16"] },
                "textDocument": {
                    "hover": { "contentFormat": ["markdown"] },
                    "completion": { "completionItem": { "snippetSupport": true } },
                    "documentSymbol": { "hierarchicalDocumentSymbolSupport": true },
                },
                "workspace": { "workspaceEdit": { "documentChanges": true } },
            }),
        )
    }

    /// The address of a file of the folder.
    pub fn uri(&self, name: &str) -> String {
        format!("file://{}", self.desk.path(name).canonicalize().unwrap_or(self.desk.path(name)).display())
    }

    /// Sends bytes as they are.
    pub fn send_bytes(&mut self, bytes: &[u8]) {
        // A server that is gone shows elsewhere.
        let _ =
            self.input.as_mut().unwrap().write_all(bytes).and_then(|()| self.input.as_mut().unwrap().flush());
    }

    pub fn send(&mut self, message: &Value) {
        let body = message.to_string();
        self.send_bytes(format!("Content-Length: {}\r\n\r\n{body}", body.len()).as_bytes());
    }

    pub fn tell(&mut self, method: &str, params: Value) {
        self.send(&json!({ "jsonrpc": "2.0", "method": method, "params": params }));
    }

    /// Asks without waiting, and gives the id.
    pub fn begin(&mut self, method: &str, params: Value) -> i32 {
        let id = self.next;
        self.next += 1;
        self.send(&json!({ "jsonrpc": "2.0", "id": id, "method": method, "params": params }));
        id
    }

    /// Asks, and waits for the answer: what it is, or its error.
    pub fn ask(&mut self, method: &str, params: Value) -> Result<Value, Value> {
        let id = self.begin(method, params);
        self.answer(&json!(id))
    }

    /// Waits for the answer to a request.
    pub fn answer(&mut self, id: &Value) -> Result<Value, Value> {
        let message =
            self.wait("an answer", |message| message["id"] == *id && message.get("method").is_none());
        match message.get("error") {
            Some(error) => Err(error.clone()),
            None => Ok(message["result"].clone()),
        }
    }

    /// Waits for a message, and keeps all others.
    #[track_caller]
    pub fn wait(&mut self, what: &str, wanted: impl Fn(&Value) -> bool) -> Value {
        let start = Instant::now();
        loop {
            if let Some(at) = self.kept.iter().position(&wanted) {
                return self.kept.remove(at);
            }
            match self.messages.recv_timeout(PATIENCE.saturating_sub(start.elapsed())) {
                Ok(message) => self.keep(message),
                Err(error) => panic!("no {what} comes ({error}), but: {:#?}", self.kept),
            }
        }
    }

    /// Whether none of these was answered once more.
    pub fn wait_nothing_for(&self, ids: &[i32]) -> bool {
        !self.kept.iter().any(|message| ids.iter().any(|id| message["id"] == *id))
    }

    /// Opens a document with a text.
    pub fn open(&mut self, name: &str, text: &str) {
        let item = json!({ "uri": self.uri(name), "languageId": "rt", "version": 1, "text": text });
        self.tell("textDocument/didOpen", json!({ "textDocument": item }));
    }

    /// Puts another text in its place.
    pub fn replace(&mut self, name: &str, version: i32, text: &str) {
        self.change(name, version, json!([{ "text": text }]));
    }

    pub fn change(&mut self, name: &str, version: i32, changes: Value) {
        let document = json!({ "uri": self.uri(name), "version": version });
        self.tell("textDocument/didChange", json!({ "textDocument": document, "contentChanges": changes }));
    }

    /// Waits for the diagnostics of a document in a version; their codes.
    #[track_caller]
    pub fn codes(&mut self, name: &str, version: Option<i32>) -> Vec<String> {
        let said = self.diagnostics(name, version);
        said.iter().map(|said| said["code"].as_str().unwrap_or("").to_string()).collect()
    }

    #[track_caller]
    pub fn diagnostics(&mut self, name: &str, version: Option<i32>) -> Vec<Value> {
        let uri = self.uri(name);
        let message = self.wait(&format!("diagnostics of {name} in version {version:?}"), |message| {
            message["method"] == "textDocument/publishDiagnostics"
                && message["params"]["uri"] == *uri
                && message["params"]["version"] == json!(version)
        });
        message["params"]["diagnostics"].as_array().unwrap().clone()
    }

    /// Asks about a place of a document.
    pub fn at(&mut self, method: &str, name: &str, line: u32, character: u32) -> Result<Value, Value> {
        let params = json!({
            "textDocument": { "uri": self.uri(name) },
            "position": { "line": line, "character": character },
        });
        self.ask(method, params)
    }

    /// Ends the session as it should be, and gives the exit code.
    pub fn end(mut self) -> Option<i32> {
        assert_eq!(self.ask("shutdown", Value::Null), Ok(Value::Null));
        self.tell("exit", Value::Null);
        self.code()
    }

    /// Has the system end it.
    #[cfg(unix)]
    pub fn terminate(&mut self) {
        let pid = self.child.id().to_string();
        assert!(std::process::Command::new("kill").args(["-TERM", &pid]).status().unwrap().success());
    }

    /// What of what has come is so.
    pub fn has(&mut self, wanted: impl Fn(&Value) -> bool) -> bool {
        while let Ok(message) = self.messages.try_recv() {
            self.keep(message);
        }
        self.kept.iter().any(wanted)
    }

    fn keep(&mut self, message: Value) {
        if self.agrees && message["method"] == "window/workDoneProgress/create" {
            self.agree(&message);
        }
        self.kept.push(message);
    }

    /// Answers a request of the server with nothing.
    pub fn agree(&mut self, request: &Value) {
        self.send(&json!({ "jsonrpc": "2.0", "id": request["id"], "result": null }));
    }

    /// Sends nothing any more.
    pub fn hang_up(&mut self) {
        self.input = None;
    }

    /// The exit code of a server that ends by itself.
    pub fn code(&mut self) -> Option<i32> {
        let start = Instant::now();
        while start.elapsed() < PATIENCE {
            if let Some(status) = self.child.try_wait().unwrap() {
                return status.code();
            }
            std::thread::sleep(Duration::from_millis(2));
        }
        panic!("it does not end");
    }

    /// The most memory it has held so far, in bytes.
    #[cfg(target_os = "linux")]
    pub fn memory(&self) -> u64 {
        1024 * self.status("VmHWM")
    }

    /// How many threads it has.
    #[cfg(target_os = "linux")]
    pub fn threads(&self) -> u64 {
        self.status("Threads")
    }

    /// What the system tells of it.
    #[cfg(target_os = "linux")]
    fn status(&self, name: &str) -> u64 {
        let status = std::fs::read_to_string(format!("/proc/{}/status", self.child.id())).unwrap();
        let line = status.lines().find(|line| line.starts_with(name)).unwrap();
        line.split_whitespace().nth(1).unwrap().parse().unwrap()
    }
}

impl Drop for Client<'_> {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn read(output: &mut impl BufRead) -> Option<Value> {
    let mut length = 0;
    loop {
        let mut line = String::new();
        if output.read_line(&mut line).ok()? == 0 {
            return None;
        }
        match line.trim_end().split_once(": ") {
            Some(("Content-Length", value)) => length = value.parse().expect("a length"),
            Some(_) => {}
            None => break,
        }
    }
    let mut body = vec![0; length];
    output.read_exact(&mut body).ok()?;
    let message: Value = serde_json::from_slice(&body).expect("only frames on standard output");
    assert_eq!(message["jsonrpc"], "2.0");
    Some(message)
}
