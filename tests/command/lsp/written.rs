//! What is written in the preview goes into the text of the editor, and into the file where the editor has it not.

use super::super::Desk;
use super::client::Client;
use super::page::Page;
use super::preview::start;
use serde_json::{Value, json};

/// With a place behind a character that counts twice in UTF-16.
const SCENE: &str = "/* 😀 */ param size: length = 1m in 10cm to 2m\nsphere { radius: size }\n\
                     render { size: (24, 18), samples: 1 }\n";

/// An editor whose texts can be edited, or not.
fn client(desk: &Desk, takes_edits: bool) -> Client<'_> {
    let edits = json!({ "applyEdit": takes_edits, "workspaceEdit": { "documentChanges": true } });
    Client::with(desk, json!({ "workspace": edits, "window": { "showDocument": { "support": true } } }))
}

/// A page that has set the size.
fn set(url: &str, size: &str) -> Page {
    let mut page = Page::new(url);
    page.wait(|message| message["type"] == "frame");
    set_again(&mut page, size);
    page
}

fn set_again(page: &mut Page, size: &str) {
    page.say(&json!({ "type": "set", "name": "size", "value": size }));
    page.wait(|message| message["params"][0]["value"] == size);
}

fn write(page: &mut Page, id: u32) {
    page.say(&json!({ "type": "write", "id": id, "name": "size" }));
}

/// What the page is told in the end.
fn told(page: &mut Page, id: u32) -> Value {
    page.wait(|message| message["type"] == "wrote" && message["id"] == id)
}

fn asked(client: &mut Client) -> Value {
    client.wait("an edit", |message| message["method"] == "workspace/applyEdit")
}

fn answer(client: &mut Client, asked: &Value, result: Value) {
    client.send(&json!({ "jsonrpc": "2.0", "id": asked["id"], "result": result }));
}

#[test]
fn what_is_open_is_changed_by_the_editor() {
    let desk = Desk::new();
    desk.put("scene.rt", "sphere { radius: 1m }\n");
    let mut client = client(&desk, true);
    client.open("scene.rt", "sphere { radius: 1m }\n");
    client.replace("scene.rt", 7, SCENE);
    let url = start(&mut client, "scene.rt");
    let mut page = set(&url, "1.25m");
    write(&mut page, 1);
    let edit = asked(&mut client);
    let at = |character: u32| json!({ "line": 0, "character": character });
    // Of `1m`, what is another.
    let change = json!([{
        "textDocument": { "uri": client.uri("scene.rt"), "version": 7 },
        "edits": [{ "range": { "start": at(31), "end": at(31) }, "newText": ".25" }],
    }]);
    assert_eq!(edit["params"]["edit"]["documentChanges"], change);
    // Nobody asks for two changes of one version.
    write(&mut page, 2);
    let refused = told(&mut page, 2);
    assert_eq!(
        (&refused["ok"], &refused["error"]),
        (&json!(false), &json!("the editor is changing the text: try it again"))
    );
    answer(&mut client, &edit, json!({ "applied": true }));
    client.change("scene.rt", 8, json!([{ "range": change[0]["edits"][0]["range"], "text": ".25" }]));
    assert_eq!(told(&mut page, 1)["ok"], true);
    let status = page.wait(|message| message["params"][0]["set"] == false);
    assert_eq!(status["params"][0]["default"], "1.25m");
    assert_eq!(desk.get("scene.rt"), b"sphere { radius: 1m }\n", "the file is the editor's to save");
    // It is undone there, and written once more.
    client.replace("scene.rt", 9, SCENE);
    page.wait(|message| message["params"][0]["default"] == "1m");
    set_again(&mut page, "2m");
    write(&mut page, 3);
    assert_eq!(asked(&mut client)["params"]["edit"]["documentChanges"][0]["textDocument"]["version"], 9);
    assert_eq!(client.end(), Some(0));
}

#[test]
fn an_editor_that_refuses_is_heard() {
    let desk = Desk::new();
    let mut client = client(&desk, true);
    client.open("scene.rt", SCENE);
    let url = start(&mut client, "scene.rt");
    let mut page = set(&url, "2m");
    let error = json!({ "code": -32603, "message": "no" });
    for (id, reply, why) in [
        (1, json!({ "result": { "applied": false, "failureReason": "read only" } }), "it: read only"),
        (2, json!({ "result": { "applied": false } }), "it: it does not say why"),
        (3, json!({ "result": null }), "it: it does not say why"),
        (4, json!({ "error": error }), "it: no"),
        // It says so, and does something else.
        (5, json!({ "result": { "applied": true } }), "the text says something else: try it again"),
    ] {
        write(&mut page, id);
        let mut reply = reply;
        (reply["jsonrpc"], reply["id"]) = (json!("2.0"), asked(&mut client)["id"].clone());
        client.send(&reply);
        let refused = told(&mut page, id);
        assert_eq!(refused["ok"], false, "{refused}");
        assert!(refused["error"].as_str().unwrap().ends_with(why), "{refused}");
    }
    // It stays set, and another version is another question.
    client.replace("scene.rt", 2, &format!("{SCENE}\n"));
    set_again(&mut page, "1.5m");
    write(&mut page, 6);
    assert_eq!(asked(&mut client)["params"]["edit"]["documentChanges"][0]["textDocument"]["version"], 2);
    assert_eq!(client.end(), Some(0));
}

#[test]
fn an_editor_that_takes_no_edits_keeps_its_text() {
    let desk = Desk::new();
    desk.put("scene.rt", SCENE);
    let mut client = client(&desk, false);
    client.open("scene.rt", SCENE);
    let url = start(&mut client, "scene.rt");
    let mut page = set(&url, "2m");
    write(&mut page, 1);
    let refused = told(&mut page, 1);
    assert!(refused["error"].as_str().unwrap().starts_with("this editor lets nobody else"), "{refused}");
    assert_eq!(desk.get("scene.rt"), SCENE.as_bytes());
    assert!(!client.has(|message| message["method"] == "workspace/applyEdit"));
    assert_eq!(client.end(), Some(0));
}

#[test]
fn what_is_closed_is_shown_and_written_as_it_is_saved() {
    let desk = Desk::new();
    desk.put("scene.rt", format!("{SCENE}camera wide {{ from: (0, 1, 6)m, look: (0, 0, 0)m }}\n"));
    let mut client = client(&desk, true);
    let begin = |client: &mut Client, name: &str, camera: &str| {
        let arguments = json!([{ "uri": client.uri(name), "camera": camera }]);
        let params = json!({ "command": "rtc.startPreview", "arguments": arguments });
        client.ask("workspace/executeCommand", params)
    };
    let none = begin(&mut client, "scene.rt", "tall").unwrap_err();
    assert_eq!(none["message"], "no camera is called `tall`: there is `wide`");
    let none = begin(&mut client, "nothing.rt", "wide").unwrap_err();
    assert!(none["message"].as_str().unwrap().starts_with("there is no file"), "{none}");
    let url = begin(&mut client, "scene.rt", "wide").unwrap()["url"].as_str().unwrap().to_string();
    let mut page = set(&url, "2m");
    write(&mut page, 1);
    assert_eq!(told(&mut page, 1)["ok"], true);
    let written = String::from_utf8(desk.get("scene.rt")).unwrap();
    assert!(written.contains("length = 2m in"), "{written}");
    // It follows the file, and the editor from where that has it, and ends with it.
    desk.put("scene.rt", written.replace("length = 2m in", "length = 1.5m in"));
    page.wait(|message| message["params"][0]["default"] == "1.5m");
    client.open("scene.rt", &written.replace("length = 2m in", "length = 1.75m in"));
    page.wait(|message| message["params"][0]["default"] == "1.75m");
    let document = json!({ "uri": client.uri("scene.rt") });
    client.tell("textDocument/didClose", json!({ "textDocument": document }));
    page.wait_for_end();
    assert_eq!(client.end(), Some(0));
}

#[test]
fn a_preview_of_what_is_closed_before_it_is_there_does_not_begin() {
    let desk = Desk::new();
    let mut client = client(&desk, true);
    // Something to be busy with, before it is known which cameras there are.
    let much: String = (0..20000).map(|i| format!("sphere {{ at: ({i}, 0, 0)m, radius: 1m }}\n")).collect();
    client.open("scene.rt", &(much + "camera wide { from: (0, 1, 6)m, look: (0, 0, 0)m }\n"));
    let arguments = json!([{ "uri": client.uri("scene.rt"), "camera": "wide" }]);
    let params = json!({ "command": "rtc.startPreview", "arguments": arguments });
    let id = client.begin("workspace/executeCommand", params);
    let document = json!({ "uri": client.uri("scene.rt") });
    client.tell("textDocument/didClose", json!({ "textDocument": document }));
    let refused = client.answer(&json!(id)).unwrap_err();
    assert_eq!(refused["message"], "the document was closed before its preview was there");
    assert_eq!(client.end(), Some(0));
}
