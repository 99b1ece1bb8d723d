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
