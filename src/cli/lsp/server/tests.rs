//! What cannot be brought about from outside for certain.

use super::*;
use std::sync::mpsc;
use std::time::Duration;

#[test]
fn the_thread_that_hears_does_not_wait_to_be_heard() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("a.rt");
    std::fs::write(&scene, "sphere { radius: 1m }\n").unwrap();
    let (connection, client) = Connection::memory();
    let mut server = Server::new(connection, None, Interrupt::default()).unwrap();
    let shows = json!({ "capabilities": { "window": { "showDocument": { "support": true } } } });
    server.take(Request::new(1.into(), "initialize".into(), shows).into());
    // As many things are told as can wait.
    while server.tell.try_send(Told::Notifies("x".into(), Value::Null)).is_ok() {}
    let uri = super::super::uri::uri_of(&scene);
    let preview = json!({ "command": commands::PREVIEW, "arguments": [uri] });
    let (done, is_done) = mpsc::channel();
    std::thread::spawn(move || {
        server.take(Request::new(2.into(), "workspace/executeCommand".into(), preview).into());
        let _ = done.send(());
    });
    is_done.recv_timeout(Duration::from_secs(60)).expect("it waits for itself");
    let said: Vec<Message> = client.receiver.try_iter().collect();
    let shown = |message: &Message| matches!(message, Message::Request(request) if request.method == "window/showDocument");
    assert!(said.iter().any(shown), "{said:?}");
}

/// A server that has begun, and whoever talks with it.
fn begun() -> (Server, Connection) {
    let (connection, client) = Connection::memory();
    let mut server = Server::new(connection, None, Interrupt::default()).unwrap();
    server.take(Request::new(0.into(), "initialize".into(), json!({ "capabilities": {} })).into());
    client.receiver.recv().unwrap();
    (server, client)
}

fn open(server: &mut Server, uri: &str, text: &str) {
    let item = json!({ "uri": uri, "languageId": "rt", "version": 1, "text": text });
    let open = json!({ "textDocument": item });
    server.take(Notification::new("textDocument/didOpen".into(), open).into());
}

fn change(server: &mut Server, uri: &str, version: i32) {
    let at = json!({ "line": 0, "character": 0 });
    let document = json!({ "uri": uri, "version": version });
    let changes = json!([{ "range": { "start": at, "end": at }, "text": "/" }]);
    let change = json!({ "textDocument": document, "contentChanges": changes });
    server.take(Notification::new("textDocument/didChange".into(), change).into());
}

fn hover(server: &mut Server, id: i32, uri: &str) {
    let at = json!({ "textDocument": { "uri": uri }, "position": { "line": 0, "character": 0 } });
    server.take(Request::new(id.into(), "textDocument/hover".into(), at).into());
}

#[test]
fn an_answer_is_of_the_request_that_has_the_id_now() {
    let (mut server, client) = begun();
    // Nobody is at work.
    server.desk = Arc::default();
    let id = RequestId::from(7);
    let before = server.register(&id);
    server.take(Notification::new("$/cancelRequest".into(), json!({ "id": 7 })).into());
    let now = server.register(&id);
    server.hear(Told::Answered(id.clone(), Ok(json!("before")), before));
    server.hear(Told::Answered(id, Ok(json!("now")), now));
    let answers: Vec<_> = client.receiver.try_iter().collect();
    let [Message::Response(cancelled), Message::Response(answer)] = &answers[..] else {
        panic!("{answers:?}")
    };
    assert_eq!(cancelled.response_result.as_ref().unwrap_err().code, ErrorCode::RequestCanceled as i32);
    assert_eq!(answer.response_result.as_ref().unwrap(), &json!("now"));
}

#[test]
fn what_waits_holds_no_more_than_so_many_bytes() {
    let (mut server, client) = begun();
    server.desk = Arc::default();
    let (uri, length) = ("untitled:a", 1 << 20);
    open(&mut server, uri, &format!("//{}", " ".repeat(length)));
    for round in 0..200 {
        hover(&mut server, round + 1, uri);
        change(&mut server, uri, round + 2);
    }
    let most = MOST_HELD + 2 * length;
    assert!(server.held.bytes() > MOST_HELD / 2 && server.held.bytes() <= most, "{}", server.held.bytes());
    let refused = client.receiver.try_iter().filter(|said| matches!(said, Message::Response(_))).count();
    assert!((90..120).contains(&refused), "{refused}");
    // Where nobody waits any more, nothing is held.
    for round in 0..200 {
        server.cancel((round + 1).into());
    }
    server.desk = Arc::default();
    change(&mut server, uri, 300);
    assert!(server.held.bytes() < 3 * length, "{}", server.held.bytes());
}

#[test]
fn a_client_that_answers_nothing_is_not_asked_for_ever() {
    let (mut server, client) = begun();
    let (sender, heard) = mpsc::channel();
    for _ in 0..3 * MOST_WAITING {
        let sender = sender.clone();
        let ask = Ask::new(lsp::LspRequestMethod::WorkspaceInlayHintRefresh, Value::Null);
        server.ask_client(ask.then(move |answer| sender.send(answer.is_err()).unwrap()));
    }
    assert_eq!(
        (client.receiver.try_iter().count(), heard.try_iter().count()),
        (MOST_WAITING, 2 * MOST_WAITING)
    );
}

#[test]
fn what_was_told_is_taken_back_where_it_was_told() {
    let folder = tempfile::tempdir().unwrap();
    let (mut server, client) = begun();
    for uri in [format!("file://{}/x(1).rt", folder.path().display()), "file://localhost/none/y.rt".into()] {
        open(&mut server, &uri, "sphere { radius: 8deg }");
        let mut published = vec![];
        while published.len() < 2 {
            while let Ok(told) =
                server.told.recv_timeout(Duration::from_secs(if published.is_empty() { 60 } else { 0 }))
            {
                server.hear(told);
                if !client.receiver.is_empty() {
                    break;
                }
            }
            published.extend(client.receiver.try_iter().map(|said| match said {
                Message::Notification(said) => {
                    (said.params["uri"].clone(), said.params["diagnostics"][0].is_object())
                }
                other => panic!("{other:?}"),
            }));
            let close = json!({ "textDocument": { "uri": uri } });
            server.take(Notification::new("textDocument/didClose".into(), close).into());
        }
        assert_eq!(published, [(json!(uri), true), (json!(uri), false)]);
    }
}

proptest::proptest! {
    #![proptest_config(proptest::prelude::ProptestConfig::with_cases(200))]

    #[test]
    fn sessions_come_out_right(script in proptest::collection::vec(proptest::prelude::any::<u8>(), 0..90)) {
        script::run(&script);
    }
}
