//! Whatever comes in, the server lives and answers what it can.

use super::super::Desk;
use super::client::{Client, PATIENCE};
use serde_json::{Value, json};
use std::io::Write;
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicI32, Ordering};
use std::time::{Duration, Instant};

const BAD: &str = "sphere { radius: 8deg }\n";

fn code(answer: Result<Value, Value>) -> i64 {
    answer.unwrap_err()["code"].as_i64().unwrap()
}

/// The server does its work still.
#[track_caller]
fn lives(client: &mut Client) {
    client.open("alive.rt", BAD);
    assert_eq!(client.codes("alive.rt", Some(1)), ["E0203"]);
}

#[test]
fn a_session_has_a_beginning_and_an_end() {
    let desk = Desk::new();
    let mut client = Client::silent(&desk);
    assert_eq!(code(client.ask("textDocument/hover", json!({}))), -32002);
    client.tell("textDocument/didOpen", json!({ "textDocument": 3 }));
    let can = client.ask("initialize", json!({ "capabilities": {} })).unwrap();
    assert_eq!(can["capabilities"]["positionEncoding"], "utf-16");
    assert_eq!(code(client.ask("initialize", json!({ "capabilities": {} }))), -32600);
    assert_eq!(client.ask("shutdown", Value::Null), Ok(Value::Null));
    assert_eq!(code(client.ask("textDocument/hover", json!({}))), -32600);
    client.tell("exit", Value::Null);
    assert_eq!(client.code(), Some(0));
}

#[test]
fn an_end_that_was_not_announced_is_a_failure() {
    let desk = Desk::new();
    let mut client = Client::new(&desk);
    client.tell("exit", Value::Null);
    assert_eq!(client.code(), Some(1));
    let mut client = Client::new(&desk);
    client.send_bytes(b"Content-Length: 100\r\n\r\n{\"jsonrpc\"");
    client.hang_up();
    assert_eq!(client.code(), Some(1));
}

#[cfg(unix)]
#[test]
fn the_server_ends_with_the_client() {
    let desk = Desk::new();
    let mut editor = Command::new("sleep").arg("1000").spawn().unwrap();
    let params = json!({ "processId": editor.id(), "capabilities": {} });
    let mut client = Client::silent(&desk).agreed(params.clone());
    client.open("a.rt", BAD);
    let said = client.diagnostics("a.rt", Some(1));
    let page = said[0]["codeDescription"]["href"].as_str().unwrap().strip_prefix("file://").unwrap();
    let folder = std::path::Path::new(page).parent().unwrap();
    assert!(folder.exists());
    // Another one knows whose folder it is.
    let mut other = Client::silent(&desk).agreed(params.clone());
    other.open("a.rt", BAD);
    other.diagnostics("a.rt", Some(1));
    assert!(folder.exists());
    editor.kill().unwrap();
    editor.wait().unwrap();
    // Nobody has hung up.
    assert_eq!((client.code(), other.code()), (Some(1), Some(1)));
    assert!(!folder.exists());
    // A number that is of no process here may be of one elsewhere.
    for process in
        [params["processId"].clone(), json!(null), json!(-1), json!(0), json!(u64::MAX), json!("x")]
    {
        let mut client = Client::silent(&desk).agreed(json!({ "processId": process, "capabilities": {} }));
        std::thread::sleep(Duration::from_millis(50));
        lives(&mut client);
        assert_eq!(client.end(), Some(0));
    }
}

#[cfg(unix)]
#[test]
fn who_holds_the_pipes_of_a_client_that_is_gone_does_not_keep_the_server() {
    let desk = Desk::new();
    let mut editor = Command::new("sleep").arg("1000").spawn().unwrap();
    let mut server = desk.command("lsp").stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    let mut input = server.stdin.take().unwrap();
    let process = json!({ "processId": editor.id(), "capabilities": {} });
    let mut send = move |id: i32, method: &str, params: &Value| {
        let body = json!({ "jsonrpc": "2.0", "id": id, "method": method, "params": params }).to_string();
        write!(input, "Content-Length: {}\r\n\r\n{body}", body.len()).is_ok()
    };
    // More answers than pipes and queues hold, which nobody reads.
    let sent = Arc::new(AtomicI32::new(0));
    let counts = sent.clone();
    let floods = std::thread::spawn(move || {
        assert!(send(0, "initialize", &process));
        (1..).find(|id| {
            counts.store(*id, Ordering::Relaxed);
            !send(*id, "none", &Value::Null)
        })
    });
    // Until no more can be sent.
    let mut before = 0;
    while before == 0 || before != sent.load(Ordering::Relaxed) {
        before = sent.load(Ordering::Relaxed);
        std::thread::sleep(Duration::from_millis(200));
    }
    editor.kill().unwrap();
    editor.wait().unwrap();
    let start = Instant::now();
    while server.try_wait().unwrap().is_none() {
        assert!(start.elapsed() < PATIENCE, "it does not end");
        std::thread::sleep(Duration::from_millis(10));
    }
    floods.join().unwrap();
}

#[cfg(unix)]
#[test]
fn what_a_server_left_that_was_killed_is_removed() {
    let desk = Desk::new();
    let place = desk.path("tmp");
    std::fs::create_dir(&place).unwrap();
    let folders = || -> Vec<_> {
        let entries = std::fs::read_dir(&place).unwrap();
        entries.map(|entry| entry.unwrap().path()).collect()
    };
    let serve = || {
        let mut client = Client::in_place(&desk, &place).agreed(json!({ "capabilities": {} }));
        client.open("a.rt", BAD);
        client.diagnostics("a.rt", Some(1));
        client
    };
    let first = serve();
    assert_eq!(folders().len(), 1);
    let left = folders();
    // Killed.
    drop(first);
    assert_eq!(folders(), left);
    // What is of somebody else stays.
    std::fs::create_dir(place.join("rtc-codes-strange")).unwrap();
    std::fs::write(place.join("rtc-codes-file"), "").unwrap();
    let elsewhere = desk.path("elsewhere");
    std::fs::create_dir(&elsewhere).unwrap();
    std::fs::write(elsewhere.join("lock"), "").unwrap();
    std::os::unix::fs::symlink(&elsewhere, place.join("rtc-codes-link")).unwrap();
    let second = serve();
    assert!(!left[0].exists());
    assert_eq!(folders().len(), 4);
    assert_eq!(second.end(), Some(0));
    assert_eq!(folders().len(), 3);
    assert!(elsewhere.join("lock").exists());
}

#[test]
fn malformed_messages_are_answered_and_the_next_one_is_read() {
    let desk = Desk::new();
    let mut client = Client::new(&desk);
    for (bytes, code) in [
        (&b"Content-Length: 9\r\n\r\n{\"id\": 1, "[..], -32700),
        (b"Content-Length: 3\r\n\r\n\xff\xfe\xfd", -32700),
        (b"Content-Length: many\r\n\r\n", -32700),
        (b"Hello, world!\r\n\r\n", -32700),
        (b"Content-Length: 2\r\n\r\n[]", -32600),
        (b"Content-Length: 4\r\n\r\nnull", -32600),
        // With a body that nobody knows the length of.
        (b"Content-Length: 1e3\r\n\r\n{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"x\"}", -32700),
        (b"Content-Length: 38\r\n\r\n{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"xyz\"}", -32700),
    ] {
        client.send_bytes(bytes);
        assert_eq!(client.answer(&Value::Null).unwrap_err()["code"], code, "{}", bytes.escape_ascii());
    }
    client.send(&json!({ "id": 77 }));
    assert_eq!(client.answer(&json!(77)).unwrap_err()["code"], -32600);
    lives(&mut client);
    assert_eq!(client.end(), Some(0));
}

#[test]
fn what_is_not_known_or_makes_no_sense_is_refused() {
    let desk = Desk::new();
    let mut client = Client::new(&desk);
    assert_eq!(code(client.ask("textDocument/teleport", json!({}))), -32601);
    assert_eq!(code(client.ask("textDocument/hover", json!({ "position": "here" }))), -32602);
    assert_eq!(code(client.at("textDocument/hover", "none.rt", 0, 0)), -32602);
    assert_eq!(code(client.ask("workspace/executeCommand", json!({ "command": "rtc.fly" }))), -32602);
    client.tell("$/anything", json!([1]));
    client.tell("textDocument/didChange", json!({ "textDocument": {} }));
    client.tell("textDocument/didClose", json!({ "textDocument": { "uri": "file:///none.rt" } }));
    client.change("none.rt", 2, json!([{ "text": "sphere {" }]));
    client.send(&json!({ "jsonrpc": "2.0", "id": 4711, "result": null }));
    client.tell("$/cancelRequest", json!({ "id": "none" }));
    lives(&mut client);
    assert_eq!(client.end(), Some(0));
}

#[test]
fn ids_may_come_in_any_order_and_an_id_in_use_is_refused() {
    let desk = Desk::new();
    let mut client = Client::new(&desk);
    client.open("a.rt", &much());
    let params =
        json!({ "textDocument": { "uri": client.uri("a.rt") }, "position": { "line": 0, "character": 1 } });
    let ids = [json!(900), json!("b"), json!(-3), json!("900"), json!(2)];
    for id in &ids {
        client.send(&json!({ "jsonrpc": "2.0", "id": id, "method": "textDocument/hover", "params": params }));
    }
    for id in ids.iter().rev() {
        client.answer(id).unwrap();
    }
    // Ids may be used again once they are answered; of two at a time the second is refused, while the first takes its time.
    client.replace("a.rt", 2, &format!("{}\n", much()));
    for _ in 0..2 {
        client.send(&json!({ "jsonrpc": "2.0", "id": 5, "method": "textDocument/hover", "params": params }));
    }
    assert_eq!(code(client.answer(&json!(5))), -32600);
    client.answer(&json!(5)).unwrap();
    assert_eq!(client.end(), Some(0));
}

/// Something to be busy with.
fn much() -> String {
    (0..3000).map(|i| format!("sphere {{ at: ({i}, 0, 0)m, radius: 1m }}\n")).collect()
}

#[test]
fn an_id_that_was_given_up_may_be_that_of_another_request() {
    let desk = Desk::new();
    let mut client = Client::new(&desk);
    let uri = client.uri("a.rt");
    for round in 0..20 {
        // The one is at work on while it is cancelled, and the other waits behind it.
        client.tell(
            "textDocument/didOpen",
            json!({ "textDocument": { "uri": uri, "languageId": "rt", "version": round, "text": much() } }),
        );
        let position = json!({ "line": 0, "character": 1 });
        let hover = json!({ "textDocument": { "uri": uri }, "position": position });
        client.send(&json!({ "id": "same", "method": "textDocument/hover", "params": hover }));
        client.tell("$/cancelRequest", json!({ "id": "same" }));
        client.send(&json!({ "id": "same", "method": "textDocument/codeLens", "params": hover }));
        let _ = client.answer(&json!("same"));
        let lenses = client.answer(&json!("same")).unwrap();
        assert!(lenses.is_array(), "{lenses}");
    }
    assert_eq!(client.end(), Some(0));
}

#[test]
fn documents_may_have_odd_names_and_odd_letters() {
    let desk = Desk::new();
    let mut client = Client::new(&desk);
    let folder = client.uri("");
    let names = ["vscode-remote://ssh/a.rt", "git:/a.rt?b", "x", "file:///%00.rt", "file://elsewhere/a.rt"];
    let names = names.map(String::from).into_iter().chain([folder.clone(), format!("{folder}%ff.rt")]);
    for uri in names {
        let item = json!({ "uri": uri, "languageId": "rt", "version": 1, "text": BAD });
        client.tell("textDocument/didOpen", json!({ "textDocument": item }));
        let said = client.wait("diagnostics", |message| message["params"]["uri"] == *uri);
        assert_eq!(said["params"]["diagnostics"][0]["code"], "E0203", "{uri}");
    }
    // Half a character is one of the same width, and what is behind it keeps its place.
    client.open("a.rt", "sphere { radius: 1m }\n");
    let uri = client.uri("a.rt");
    let text = r"/*\ud83d*/ sphere { radius: 8deg }\n";
    let body = format!(
        r#"{{"method":"textDocument/didChange","params":{{"textDocument":{{"uri":"{uri}","version":2}},"contentChanges":[{{"text":"{text}"}}]}}}}"#
    );
    client.send_bytes(format!("Content-Length: {}\r\n\r\n{body}", body.len()).as_bytes());
    let said = client.diagnostics("a.rt", Some(2));
    assert_eq!(said[0]["range"]["start"], json!({ "line": 0, "character": 23 }));
    // An edit that says of no version what it is of is an edit.
    let at = json!({ "line": 0, "character": 23 });
    let changes = json!([{ "range": { "start": at, "end": at }, "text": "1m //" }]);
    let document = json!({ "uri": uri });
    client.tell("textDocument/didChange", json!({ "textDocument": document, "contentChanges": changes }));
    assert_eq!(client.codes("a.rt", Some(2)), ["E0002"]);
    assert_eq!(client.end(), Some(0));
}

#[test]
fn a_request_that_is_cancelled_is_answered_once() {
    let desk = Desk::new();
    let mut client = Client::new(&desk);
    client.open("a.rt", &much());
    let uri = client.uri("a.rt");
    let params = json!({ "textDocument": { "uri": uri } });
    let ids: Vec<i32> =
        (0..20).map(|_| client.begin("textDocument/documentSymbol", params.clone())).collect();
    for id in &ids {
        client.tell("$/cancelRequest", json!({ "id": id }));
    }
    let answers: Vec<_> = ids.iter().map(|id| client.answer(&json!(id))).collect();
    assert!(answers.iter().filter_map(|answer| answer.as_ref().err()).all(|error| error["code"] == -32800));
    assert!(answers.iter().any(Result::is_err), "none was cancelled in time");
    lives(&mut client);
    assert!(client.wait_nothing_for(&ids), "one was answered twice");
}

#[test]
fn a_huge_message_is_passed_over() {
    let desk = Desk::new();
    let mut client = Client::new(&desk);
    let length = 65 << 20;
    client.send_bytes(format!("Content-Length: {length}\r\n\r\n").as_bytes());
    let block = vec![b' '; 1 << 20];
    for _ in 0..65 {
        client.send_bytes(&block);
    }
    let told = client.wait("a message", |message| message["method"] == "window/showMessage");
    let told = told["params"]["message"].as_str().unwrap();
    assert!(told.contains("65 MiB: 64 MiB are the most"), "{told}");
    assert_eq!(client.answer(&Value::Null).unwrap_err()["code"], -32700);
    // One that would take gigabytes once it is values.
    let many = format!("{{\"method\":\"x\",\"params\":[{}0]}}", "0,".repeat(10 << 20));
    client.send_bytes(format!("Content-Length: {}\r\n\r\n{many}", many.len()).as_bytes());
    assert_eq!(client.answer(&Value::Null).unwrap_err()["code"], -32700);
    lives(&mut client);
    #[cfg(target_os = "linux")]
    assert!(client.memory() < 400 << 20, "{} MB", client.memory() >> 20);
    assert_eq!(client.end(), Some(0));
}

#[test]
fn a_long_document_is_edited_within_bounds() {
    let desk = Desk::new();
    let mut client = Client::new(&desk);
    let line = "sphere { at: (1, 2, 3)m, radius: 10cm, material: diffuse { color: #d94f30 } }\n";
    let count = (10 << 20) / line.len();
    client.open("long.rt", &line.repeat(count));
    for version in 2..12 {
        let at = json!({ "line": count / 2, "character": 0 });
        client.change("long.rt", version, json!([{ "range": { "start": at, "end": at }, "text": "x" }]));
    }
    let codes = client.codes("long.rt", Some(11));
    assert!(!codes.is_empty());
    #[cfg(target_os = "linux")]
    assert!(client.memory() < 600 << 20, "{} MB", client.memory() >> 20);
    assert_eq!(client.end(), Some(0));
}

#[cfg(target_os = "linux")]
#[test]
fn thousands_of_edits_take_no_more_memory_than_hundreds() {
    let desk = Desk::new();
    let mut client = Client::new(&desk);
    client.open("a.rt", &much());
    let edit = |client: &mut Client, versions: std::ops::Range<i32>| {
        let last = versions.end - 1;
        for version in versions {
            let (end, text) = if version % 2 == 0 { (0, "x") } else { (1, "") };
            let at = |character: u32| json!({ "line": version / 2 % 3000, "character": character });
            let change = json!([{ "range": { "start": at(0), "end": at(end) }, "text": text }]);
            client.change("a.rt", version, change);
        }
        assert_eq!(client.codes("a.rt", Some(last)), Vec::<String>::new());
        client.memory()
    };
    let before = edit(&mut client, 2..502);
    let after = edit(&mut client, 502..20_502);
    assert!(after < before + (32 << 20), "{} MB, then {} MB", before >> 20, after >> 20);
    assert_eq!(client.end(), Some(0));
}

#[test]
fn a_folder_that_vanishes_is_no_reason_to_end() {
    let desk = Desk::new();
    std::fs::create_dir(desk.path("room")).unwrap();
    desk.put("room/woods.rt", "material oak = diffuse { color: #705848 }\n");
    let mut client = Client::new(&desk);
    let scene = "import \"woods.rt\" as woods\nsphere { radius: 1m, material: woods.oak }\n";
    client.open("room/scene.rt", scene);
    assert_eq!(client.codes("room/scene.rt", Some(1)), Vec::<String>::new());
    let uri = client.uri("room/scene.rt");
    std::fs::remove_dir_all(desk.path("room")).unwrap();
    let document = json!({ "uri": uri, "version": 2 });
    let changes = json!([{ "text": format!("{scene}\n") }]);
    client.tell("textDocument/didChange", json!({ "textDocument": document, "contentChanges": changes }));
    let said = client.wait("diagnostics", |message| message["params"]["version"] == 2);
    assert_eq!(said["params"]["diagnostics"][0]["code"], "E0501", "{said}");
    lives(&mut client);
    assert_eq!(client.end(), Some(0));
}
