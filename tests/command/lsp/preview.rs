//! `rtc.startPreview`: the page of what stands in the editor.

use super::super::{Desk, read_png};
use super::client::{Client, PATIENCE};
use super::page::{Page, get};
use serde_json::json;
use std::time::{Duration, Instant};

fn scene(width: u32) -> String {
    format!("sphere ball {{ radius: 1m }}\nrender {{ size: ({width}, 18), samples: 1 }}\n")
}

pub fn start(client: &mut Client, name: &str) -> String {
    let arguments = json!([{ "uri": client.uri(name) }]);
    let started = client
        .ask("workspace/executeCommand", json!({ "command": "rtc.startPreview", "arguments": arguments }));
    started.unwrap()["url"].as_str().unwrap().to_string()
}

/// Waits for a picture of a width.
#[track_caller]
fn until_wide(url: &str, width: u32) {
    let start = Instant::now();
    while get(&format!("{url}picture.png")).is_none_or(|png| read_png(&png).0[0] != width) {
        assert!(start.elapsed() < PATIENCE, "no picture is {width} wide");
        std::thread::sleep(Duration::from_millis(10));
    }
}

#[test]
fn the_preview_shows_what_is_not_saved_and_leads_both_ways() {
    let desk = Desk::new();
    let shows = json!({ "window": { "showDocument": { "support": true } } });
    let mut client = Client::with(&desk, shows);
    client.open("scene.rt", &scene(24));
    let url = start(&mut client, "scene.rt");
    let opened = client.wait("a page to open", |message| message["method"] == "window/showDocument");
    assert_eq!((&opened["params"]["uri"], &opened["params"]["external"]), (&json!(url), &json!(true)));
    until_wide(&url, 24);
    client.replace("scene.rt", 2, &scene(30));
    until_wide(&url, 30);
    assert_eq!(start(&mut client, "scene.rt"), url, "one that is served is not served again");
    client.wait("a page to open", |message| message["method"] == "window/showDocument");

    // From the page to the editor.
    let mut page = Page::new(&url);
    let status = page.wait(|message| message["type"] == "status" && message["files"][0].is_string());
    let file = &status["files"][0];
    page.say(&json!({ "type": "open", "file": file, "line": 2, "column": 5 }));
    let shown = client.wait("a place to show", |message| message["method"] == "window/showDocument");
    let at = json!({ "line": 1, "character": 4 });
    assert_eq!(shown["params"]["uri"], client.uri("scene.rt"));
    assert_eq!(shown["params"]["selection"], json!({ "start": at, "end": at }));

    // From the editor to the page, which asks for the pixels of what stands there.
    let position = json!({ "line": 0, "character": 9 });
    let document = json!({ "uri": client.uri("scene.rt") });
    client.tell("rtc/cursor", json!({ "textDocument": document, "position": position }));
    let status = page.wait(|message| message["cursor"]["column"] == 10);
    page.say(&json!({
        "type": "light", "id": 1, "file": status["cursor"]["file"], "line": status["cursor"]["line"],
        "column": status["cursor"]["column"],
    }));
    assert_eq!(page.wait(|message| message["type"] == "light")["ok"], true);
    assert_eq!(client.end(), Some(0));
}

#[test]
fn a_camera_that_there_is_not_is_refused() {
    let desk = Desk::new();
    let mut client = Client::new(&desk);
    let shot = |name: &str| format!("camera {name} {{ from: (0, 1, 6)m, look: (0, 0, 0)m }}\n");
    client.open("scene.rt", &scene(24));
    let mut refused = |version: i32, text: &str, camera: &str, said: &str| {
        client.replace("scene.rt", version, text);
        for command in ["rtc.startPreview", "rtc.render"] {
            let arguments = json!([{ "uri": client.uri("scene.rt"), "camera": camera }]);
            let asked = json!({ "command": command, "arguments": arguments });
            let refused = client.ask("workspace/executeCommand", asked).unwrap_err();
            assert_eq!(refused["message"], said, "{command}");
        }
    };
    let said = "no camera is called `clse`: there are `wide`, `close`";
    refused(2, &(scene(24) + &shot("wide") + &shot("close")), "clse", said);
    refused(3, &(scene(24) + &shot("wide")), "close", "no camera is called `close`: there is `wide`");
    refused(4, &(scene(24) + &shot("")), "wide", "no camera is called `wide`: none has a name");
    assert_eq!(client.end(), Some(0));
}

#[cfg(target_os = "linux")]
#[test]
fn a_preview_ends_with_its_document() {
    let desk = Desk::new();
    let shows = json!({ "window": { "showDocument": { "support": true } } });
    let mut client = Client::with(&desk, shows);
    client.open("scene.rt", &scene(24));
    assert_eq!(client.codes("scene.rt", Some(1)), Vec::<String>::new());
    let before = client.threads();
    // More than are served at once.
    for round in 0..20 {
        let url = start(&mut client, "scene.rt");
        if round == 0 {
            until_wide(&url, 24);
            let mut page = Page::new(&url);
            page.wait(|message| message["type"] == "status");
        }
        assert!(client.threads() > before);
        let document = json!({ "uri": client.uri("scene.rt") });
        client.tell("textDocument/didClose", json!({ "textDocument": document }));
        client.open("scene.rt", &scene(24));
    }
    let document = json!({ "uri": client.uri("scene.rt") });
    client.tell("textDocument/didClose", json!({ "textDocument": document }));
    // Those that all share may have come meanwhile.
    let most = before + std::thread::available_parallelism().unwrap().get() as u64;
    let begin = Instant::now();
    while client.threads() > most {
        assert!(begin.elapsed() < PATIENCE, "{} threads, {before} before", client.threads());
        std::thread::sleep(Duration::from_millis(10));
    }
    assert_eq!(client.end(), Some(0));
}

#[test]
fn what_has_no_place_has_no_preview() {
    let desk = Desk::new();
    let mut client = Client::new(&desk);
    let item = json!({ "uri": "untitled:a", "languageId": "rt", "version": 1, "text": scene(24) });
    client.tell("textDocument/didOpen", json!({ "textDocument": item }));
    for command in ["rtc.startPreview", "rtc.render"] {
        let params = json!({ "command": command, "arguments": ["untitled:a"] });
        let refused = client.ask("workspace/executeCommand", params).unwrap_err();
        assert!(refused["message"].as_str().unwrap().starts_with("save it first"), "{refused}");
    }
    assert_eq!(client.end(), Some(0));
}
