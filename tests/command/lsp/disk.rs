//! What happens on the disk, told by the client or seen by the server.

use super::super::Desk;
use super::client::Client;
use serde_json::{Value, json};
use std::time::Duration;

const SCENE: &str = "import \"lib/woods.rt\" as woods\nsphere { radius: 1m, material: woods.oak }\n";
const SOUND: &str = "material oak = diffuse { color: #705848 }\n";
const WRONG: &str = "material oak = diffuse { color: 8 }\n";

/// What a client can do that watches files.
fn watches() -> Value {
    json!({ "workspace": { "didChangeWatchedFiles": { "dynamicRegistration": true } } })
}

fn put_library(desk: &Desk, text: &str) {
    std::fs::create_dir_all(desk.path("lib")).unwrap();
    desk.put("lib/woods.rt", text);
}

#[test]
fn a_folder_that_goes_is_gone_with_what_is_in_it() {
    let desk = Desk::new();
    put_library(&desk, SOUND);
    let mut client = Client::with(&desk, watches());
    let asked = client.wait("what to watch", |message| message["method"] == "client/registerCapability");
    let watchers = &asked["params"]["registrations"][0]["registerOptions"]["watchers"];
    assert_eq!(watchers[1], json!({ "globPattern": "**", "kind": 5 }));
    client.open("scene.rt", SCENE);
    assert_eq!(client.codes("scene.rt", Some(1)), Vec::<String>::new());
    let folder = json!({ "uri": client.uri("lib"), "type": 3 });
    std::fs::remove_dir_all(desk.path("lib")).unwrap();
    client.tell("workspace/didChangeWatchedFiles", json!({ "changes": [folder] }));
    assert_eq!(client.codes("scene.rt", Some(1)), ["E0501"]);
    put_library(&desk, SOUND);
    let folder = json!({ "uri": client.uri("lib"), "type": 1 });
    client.tell("workspace/didChangeWatchedFiles", json!({ "changes": [folder] }));
    assert_eq!(client.codes("scene.rt", Some(1)), Vec::<String>::new());
    assert_eq!(client.end(), Some(0));
}

#[test]
fn what_lies_outside_of_the_folders_of_a_client_is_seen_to_change() {
    let desk = Desk::new();
    put_library(&desk, SOUND);
    // One file was opened, and no folder.
    let mut client = Client::silent(&desk).agreed(json!({ "capabilities": watches() }));
    client.open("scene.rt", SCENE);
    assert_eq!(client.codes("scene.rt", Some(1)), Vec::<String>::new());
    put_library(&desk, WRONG);
    assert_eq!(client.codes("lib/woods.rt", None), ["E0205"]);
    assert_eq!(client.end(), Some(0));
}

#[test]
fn a_file_that_nobody_reads_makes_no_difference() {
    let desk = Desk::new();
    put_library(&desk, SOUND);
    let refreshes = json!({ "workspace": { "inlayHint": { "refreshSupport": true } } });
    let mut client = Client::with(&desk, refreshes);
    client.open("scene.rt", SCENE);
    assert_eq!(client.codes("scene.rt", Some(1)), Vec::<String>::new());
    let is_refresh = |message: &Value| message["method"] == "workspace/inlayHint/refresh";
    // Once, since it may have changed before it was watched.
    client.wait("a look", is_refresh);
    for name in ["lib/.woods.rt.swp", "lib/woods.rt~", "scene.png", "other.rt"] {
        desk.put(name, WRONG);
    }
    std::thread::sleep(Duration::from_millis(300));
    assert!(!client.has(is_refresh));
    put_library(&desk, WRONG);
    assert_eq!(client.codes("lib/woods.rt", None), ["E0205"]);
    assert_eq!(client.end(), Some(0));
}

#[cfg(unix)]
#[test]
fn what_is_open_is_read_through_links() {
    let desk = Desk::new();
    put_library(&desk, WRONG);
    std::os::unix::fs::symlink("lib", desk.path("rooms")).unwrap();
    std::os::unix::fs::symlink("lib/woods.rt", desk.path("linked.rt")).unwrap();
    for (name, import) in [
        ("rooms/woods.rt", "lib/woods.rt"),
        ("lib/woods.rt", "rooms/woods.rt"),
        ("lib/woods.rt", "linked.rt"),
    ] {
        let mut client = Client::new(&desk);
        let uri = client.uri("").trim_end_matches('/').to_string() + "/" + name;
        let open = |version: i32, text: &str| json!({ "textDocument": { "uri": uri, "languageId": "rt", "version": version, "text": text } });
        let published = |version: i32| {
            let uri = uri.clone();
            move |message: &Value| message["params"]["uri"] == uri && message["params"]["version"] == version
        };
        client.tell("textDocument/didOpen", open(1, SOUND));
        client.wait("diagnostics", published(1));
        client.open("scene.rt", &SCENE.replace("lib/woods.rt", import));
        // It would be said there as of the version that is open.
        assert_eq!(client.codes("scene.rt", Some(1)), Vec::<String>::new(), "{name} as {import}");
        assert!(!client.has(|message| message["params"]["diagnostics"][0].is_object()), "{name} as {import}");
        client.tell("textDocument/didOpen", open(2, "material elm = diffuse { color: #705848 }\n"));
        let codes = client.codes("scene.rt", Some(1));
        assert!(!codes.is_empty(), "{name} as {import}");
        assert_eq!(client.end(), Some(0));
    }
}
