//! What an editor asks, and what it is told.

use super::super::Desk;
use super::client::{Client, PATIENCE};
use serde_json::{Value, json};

const SCENE: &str = "\
/// How many balls.
param count: int = 3 in 1 to 9
material red = diffuse { color: #d94f30 }
for i in range(count) {
  sphere { at: (i, 0, 0)m, radius: 40cm, material: red }
}
camera { from: (0, 1, 4)m, look: (0, 0.5, 0)m }
";

fn document(client: &Client, name: &str) -> Value {
    json!({ "textDocument": { "uri": client.uri(name) } })
}

#[test]
fn diagnostics_appear_while_typing_and_clear_on_a_mend_and_on_closing() {
    let desk = Desk::new();
    let mut client = Client::new(&desk);
    client.open("a.rt", "sphere { radius: 8deg }\n");
    let said = client.diagnostics("a.rt", Some(1));
    assert_eq!((said.len(), &said[0]["code"], &said[0]["severity"]), (1, &json!("E0203"), &json!(1)));
    assert_eq!(
        said[0]["range"],
        json!({ "start": { "line": 0, "character": 17 }, "end": { "line": 0, "character": 21 } })
    );
    let page = said[0]["codeDescription"]["href"].as_str().unwrap().strip_prefix("file://").unwrap();
    assert!(std::fs::read_to_string(page).unwrap().starts_with("# E0203"));
    let at = json!({ "start": { "line": 0, "character": 18 }, "end": { "line": 0, "character": 21 } });
    client.change("a.rt", 2, json!([{ "range": at, "text": "mm" }]));
    assert_eq!(client.codes("a.rt", Some(2)), Vec::<String>::new());
    client.replace("a.rt", 3, "let a = 1m\nsphere { radius: 1m }\n");
    let said = client.diagnostics("a.rt", Some(3));
    assert_eq!(
        (&said[0]["code"], &said[0]["severity"], &said[0]["tags"]),
        (&json!("W0106"), &json!(2), &json!([1]))
    );
    let document = document(&client, "a.rt");
    client.tell("textDocument/didClose", document);
    assert_eq!(client.codes("a.rt", None), Vec::<String>::new());
    assert_eq!(client.end(), Some(0));
    assert!(!std::path::Path::new(page).exists(), "it tidies up");
}

#[test]
fn imports_are_read_from_open_documents_first() {
    let desk = Desk::new();
    desk.put("woods.rt", "material oak = diffuse { color: #705848 }\n");
    let mut client = Client::new(&desk);
    client.open("scene.rt", "import \"woods.rt\" as woods\nsphere { radius: 1m, material: woods.oak }\n");
    assert_eq!(client.codes("scene.rt", Some(1)), Vec::<String>::new());
    // What is being written is not saved yet, and is what counts.
    client.open("woods.rt", "material oak = diffuse { color: 8mm }\n");
    assert_eq!(client.codes("woods.rt", Some(1)), ["E0205"]);
    client.replace("woods.rt", 2, "material elm = diffuse { color: #705848 }\n");
    // What the scene found in the first text is no more so; and it is no scene of its own, in which something is to stand.
    assert_eq!(client.codes("woods.rt", Some(2)), Vec::<String>::new());
    assert_eq!(client.codes("scene.rt", Some(1)), ["E0101"]);
    client.replace("woods.rt", 3, "material oak = diffuse { color: #705848 }\n");
    assert_eq!(client.codes("scene.rt", Some(1)), Vec::<String>::new());
    client.replace("woods.rt", 4, "material elm = diffuse { color: #705848 }\n");
    assert_eq!(client.codes("scene.rt", Some(1)), ["E0101"]);
    // Closed without saving, it is what it was.
    let document = document(&client, "woods.rt");
    client.tell("textDocument/didClose", document);
    assert_eq!(client.codes("scene.rt", Some(1)), Vec::<String>::new());
    assert_eq!(client.end(), Some(0));
}

#[test]
fn what_another_text_imports_is_no_scene_of_its_own() {
    let desk = Desk::new();
    let mut client = Client::new(&desk);
    let woods = "\
material oak = diffuse { color: #705848 }
param height: length = 1m
part stool {
  let seat = 45cm
  sphere { radius: 1m }
}
";
    let by_itself = ["E0302", "W0106", "W0106", "W0106", "W0106"];
    desk.put("woods.rt", woods);
    client.open("woods.rt", woods);
    assert_eq!(client.codes("woods.rt", Some(1)), by_itself);
    // What is not used within stays so.
    client.open("scene.rt", "import \"woods.rt\" as woods\nsphere { radius: 1m, material: woods.oak }\n");
    assert_eq!(client.codes("woods.rt", Some(1)), ["W0106"]);
    let document = document(&client, "scene.rt");
    client.tell("textDocument/didClose", document);
    assert_eq!(client.codes("woods.rt", Some(1)), by_itself);
    assert_eq!(client.end(), Some(0));
}

#[test]
fn what_is_wrong_in_an_imported_file_is_said_there() {
    let desk = Desk::new();
    desk.put("woods.rt", "material oak = diffuse { color: 8 }\n");
    let mut client = Client::new(&desk);
    client.open("scene.rt", "import \"woods.rt\" as woods\nsphere { radius: 1m, material: woods.oak }\n");
    assert_eq!(client.codes("woods.rt", None), ["E0205"]);
    assert_eq!(client.codes("scene.rt", Some(1)), Vec::<String>::new());
    // Mended by somebody else.
    desk.put("woods.rt", "material oak = diffuse { color: #705848 }\n");
    let changes = json!([{ "uri": client.uri("woods.rt"), "type": 2 }]);
    client.tell("workspace/didChangeWatchedFiles", json!({ "changes": changes }));
    assert_eq!(client.codes("woods.rt", None), Vec::<String>::new());
    // Wrong once more, it is said as long as somebody reads it.
    desk.put("woods.rt", "material oak = diffuse { color: 8 }\n");
    let changes = json!([{ "uri": client.uri("woods.rt"), "type": 2 }]);
    client.tell("workspace/didChangeWatchedFiles", json!({ "changes": changes }));
    assert_eq!(client.codes("woods.rt", None), ["E0205"]);
    let document = document(&client, "scene.rt");
    client.tell("textDocument/didClose", document);
    assert_eq!(client.codes("woods.rt", None), Vec::<String>::new());
    assert_eq!(client.end(), Some(0));
}

#[test]
fn places_that_belong_to_a_message_are_told_with_it() {
    let desk = Desk::new();
    desk.put("woods.rt", "part stool {\n  param seat: length = 45cm\n  sphere { radius: seat - 50cm }\n}\n");
    let mut client = Client::new(&desk);
    client.open("twice.rt", "let a = 1m\nlet a = 2m\nsphere { radius: a }\n");
    let said = client.diagnostics("twice.rt", Some(1));
    let first = &said[0]["relatedInformation"][0];
    assert_eq!(
        (&said[0]["code"], &first["location"]["range"]["start"]["line"]),
        (&json!("E0102"), &json!(0))
    );
    // The uses that led into a part of another file.
    let scene = "import \"woods.rt\" as woods\nwoods.stool { seat: 40cm }\n";
    client.open("scene.rt", scene);
    let said = client.diagnostics("woods.rt", None);
    let used = &said[0]["relatedInformation"][0];
    assert_eq!(
        (&said[0]["code"], &used["location"]["uri"]),
        (&json!("E0401"), &json!(client.uri("scene.rt")))
    );
    assert_eq!(used["location"]["range"]["start"]["line"], 1, "{used}");
    assert_eq!(client.end(), Some(0));
}

#[test]
fn what_is_shown_in_texts_that_read_an_edited_one_is_asked_for_again() {
    let desk = Desk::new();
    let refreshes = json!({ "inlayHint": { "refreshSupport": true } });
    let mut client = Client::with(&desk, json!({ "workspace": refreshes }));
    client.open("sizes.rt", "let seat = 45cm\n");
    client.open("scene.rt", "import \"sizes.rt\" as sizes\nsphere { radius: sizes.seat }\n");
    assert_eq!(client.codes("scene.rt", Some(1)), Vec::<String>::new());
    client.replace("sizes.rt", 2, "let seat = 50cm\n");
    client.wait("to be told to ask again", |message| message["method"] == "workspace/inlayHint/refresh");
    assert_eq!(client.end(), Some(0));
}

#[test]
fn an_edit_that_makes_no_sense_leaves_no_wrong_text() {
    let desk = Desk::new();
    let mut client = Client::new(&desk);
    let woods = "material oak = diffuse { color: #705848 }\n";
    client.open("woods.rt", woods);
    client.open("scene.rt", "import \"woods.rt\" as woods\nsphere { radius: 1m, material: woods.oak }\n");
    assert_eq!(client.codes("scene.rt", Some(1)), Vec::<String>::new());
    let at = json!({ "line": -1, "character": 0 });
    client.change("woods.rt", 2, json!([{ "range": { "start": at, "end": at }, "text": "x" }]));
    let said = client.diagnostics("woods.rt", Some(2));
    assert!(
        said[0]["message"].as_str().unwrap().ends_with("close this document and open it again"),
        "{said:?}"
    );
    assert_eq!(client.codes("scene.rt", Some(1)), ["E0501"]);
    let mut params = document(&client, "woods.rt");
    params["options"] = json!({ "tabSize": 2, "insertSpaces": true });
    client.ask("textDocument/formatting", params).unwrap_err();
    client.replace("woods.rt", 3, woods);
    assert_eq!(client.codes("woods.rt", Some(3)), Vec::<String>::new());
    assert_eq!(client.codes("scene.rt", Some(1)), Vec::<String>::new());
    assert_eq!(client.end(), Some(0));
}

#[test]
fn what_is_beside_a_text_that_is_no_file_is_not_known() {
    let desk = Desk::new();
    let mut client = Client::new(&desk);
    let uri = "git:/scenes/a.rt?%7B%22ref%22%3A%22~%22%7D";
    let text = "import \"lib.rt\" as lib\nsphere { radius: 1m }\n";
    let item = json!({ "uri": uri, "languageId": "rt", "version": 1, "text": text });
    client.tell("textDocument/didOpen", json!({ "textDocument": item }));
    let said = client.wait("diagnostics", |message| message["params"]["uri"] == uri);
    let found = &said["params"]["diagnostics"][0];
    assert_eq!(found["code"], "E0501");
    assert!(found["message"].as_str().unwrap().contains("save it first"), "{found}");
    assert_eq!(client.end(), Some(0));
}

#[test]
fn a_document_that_was_never_saved_is_understood() {
    let desk = Desk::new();
    let mut client = Client::new(&desk);
    let item = json!({ "uri": "untitled:Untitled-1", "languageId": "rt", "version": 1, "text": "sphere { radius: 8deg }" });
    client.tell("textDocument/didOpen", json!({ "textDocument": item }));
    let said = client.wait("diagnostics", |message| message["params"]["uri"] == "untitled:Untitled-1");
    assert_eq!(said["params"]["diagnostics"][0]["code"], "E0203");
    assert_eq!(client.end(), Some(0));
}

#[test]
fn a_picture_is_made_of_what_is_not_saved() {
    let desk = Desk::new();
    let mut client = Client::with(&desk, json!({ "window": { "workDoneProgress": true } }));
    client.open("ball.rt", "sphere { radius: 1m }\nrender { size: (24, 18), samples: 1 }\n");
    let about = json!([{ "uri": client.uri("ball.rt"), "camera": null }]);
    let made = client.ask("workspace/executeCommand", json!({ "command": "rtc.render", "arguments": about }));
    assert!(made.unwrap()["path"].as_str().unwrap().ends_with("ball.png"));
    assert_eq!(super::super::read_png(&desk.get("ball.png")).0, [24, 18]);
    client.replace("ball.rt", 2, "sphere { radius: 8deg }\n");
    let refused =
        client.ask("workspace/executeCommand", json!({ "command": "rtc.render", "arguments": about }));
    assert_eq!(
        refused.unwrap_err()["message"],
        "the scene has an error: `radius` wants a length, this is an angle"
    );
    assert_eq!(client.end(), Some(0));
}

#[test]
fn a_picture_that_is_being_made_can_be_cancelled_where_its_progress_is_shown() {
    let desk = Desk::new();
    let mut client = Client::with(&desk, json!({ "window": { "workDoneProgress": true } }));
    client.open("ball.rt", "sphere { radius: 1m }\nrender { size: (320, 240), samples: 1000000 }\n");
    let arguments = json!([client.uri("ball.rt")]);
    let asked =
        client.begin("workspace/executeCommand", json!({ "command": "rtc.render", "arguments": arguments }));
    let begun = client.wait("progress", begins);
    assert_eq!(begun["params"]["value"]["cancellable"], true);
    client.wait("progress", |message| message["params"]["value"]["kind"] == "report");
    client.tell("window/workDoneProgress/cancel", json!({ "token": begun["params"]["token"] }));
    assert_eq!(client.answer(&json!(asked)).unwrap_err()["code"], -32800);
    client.wait("progress", |message| message["params"]["value"]["kind"] == "end");
    assert!(!desk.path("ball.png").exists());
    assert_eq!(client.end(), Some(0));
}

#[test]
fn progress_is_told_of_once_the_client_has_agreed_to_it() {
    let desk = Desk::new();
    let mut client = Client::with(&desk, json!({ "window": { "workDoneProgress": true } }));
    client.agrees = false;
    client.open("a.rt", ENDLESS);
    let is_create = |message: &Value| message["method"] == "window/workDoneProgress/create";
    let is_progress = |message: &Value| message["method"] == "$/progress";
    let end = |client: &mut Client, asked: i32| {
        client.tell("$/cancelRequest", json!({ "id": asked }));
        assert_eq!(client.answer(&json!(asked)).unwrap_err()["code"], -32800);
    };
    let asked = render(&mut client, "a.rt");
    let create = client.wait("a token", is_create);
    std::thread::sleep(std::time::Duration::from_millis(500));
    assert!(!client.has(is_progress), "nobody has agreed");
    client.agree(&create);
    let begun = client.wait("progress", is_progress);
    assert_eq!(
        (&begun["params"]["token"], &begun["params"]["value"]["kind"]),
        (&create["params"]["token"], &json!("begin"))
    );
    end(&mut client, asked);
    client.wait("progress", |message| message["params"]["value"]["kind"] == "end");
    // One who refuses hears nothing.
    while client.has(is_progress) {
        client.wait("progress", is_progress);
    }
    let asked = render(&mut client, "a.rt");
    let create = client.wait("a token", is_create);
    let error = json!({ "code": -32603, "message": "no" });
    client.send(&json!({ "jsonrpc": "2.0", "id": create["id"], "error": error }));
    std::thread::sleep(std::time::Duration::from_millis(500));
    end(&mut client, asked);
    assert!(!client.has(is_progress), "it was refused");
    assert_eq!(client.end(), Some(0));
}

#[test]
fn a_picture_does_not_replace_what_its_scene_reads() {
    let desk = Desk::new();
    let mut client = Client::new(&desk);
    let small = "render { size: (24, 18), samples: 1 }\n";
    client.open("room.rt", &format!("sphere {{ radius: 1m }}\n{small}"));
    let arguments = json!([client.uri("room.rt")]);
    let render = json!({ "command": "rtc.render", "arguments": arguments });
    client.ask("workspace/executeCommand", render.clone()).unwrap();
    let made = desk.get("room.png");
    let text = format!("sphere {{ radius: 1m }}\nsky {{ image: \"room.png\" }}\n{small}");
    client.replace("room.rt", 2, &text);
    let refused = client.ask("workspace/executeCommand", render).unwrap_err();
    assert!(refused["message"].as_str().unwrap().ends_with("would be replaced by the picture"), "{refused}");
    assert_eq!(desk.get("room.png"), made);
    assert_eq!(client.end(), Some(0));
}

/// A scene whose picture is never done.
const ENDLESS: &str = "sphere { radius: 1m }\nrender { size: (320, 240), samples: 1000000 }\n";

/// Asks for the picture of a document.
fn render(client: &mut Client, name: &str) -> i32 {
    let arguments = json!([client.uri(name)]);
    client.begin("workspace/executeCommand", json!({ "command": "rtc.render", "arguments": arguments }))
}

fn begins(message: &Value) -> bool {
    message["params"]["value"]["kind"] == "begin"
}

#[test]
fn pictures_are_made_one_after_the_other_and_of_a_document_one() {
    let desk = Desk::new();
    let mut client = Client::with(&desk, json!({ "window": { "workDoneProgress": true } }));
    client.open("a.rt", ENDLESS);
    client.open("b.rt", ENDLESS);
    let first = render(&mut client, "a.rt");
    client.wait("progress", begins);
    let other = render(&mut client, "b.rt");
    std::thread::sleep(std::time::Duration::from_millis(500));
    assert!(!client.has(begins), "two are made at once");
    let second = render(&mut client, "a.rt");
    assert_eq!(client.answer(&json!(first)).unwrap_err()["code"], -32800);
    client.wait("progress", begins);
    client.tell("$/cancelRequest", json!({ "id": other }));
    assert_eq!(client.answer(&json!(other)).unwrap_err()["code"], -32800);
    client.wait("progress", begins);
    client.tell("$/cancelRequest", json!({ "id": second }));
    assert_eq!(client.answer(&json!(second)).unwrap_err()["code"], -32800);
    assert_eq!(client.end(), Some(0));
}

#[test]
fn nothing_is_left_lying_about_at_the_end() {
    let desk = Desk::new();
    let mut client = Client::with(&desk, json!({ "window": { "workDoneProgress": true } }));
    client.open("a.rt", ENDLESS);
    render(&mut client, "a.rt");
    client.wait("progress", begins);
    let is_begun = |name: &String| name.ends_with(".tmp");
    let start = std::time::Instant::now();
    while !desk.names().iter().any(is_begun) {
        assert!(start.elapsed() < PATIENCE, "{:?}", desk.names());
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    assert_eq!(client.end(), Some(0));
    assert_eq!(desk.names(), ["ball.rt"]);
}

#[cfg(unix)]
#[test]
fn pages_are_removed_where_the_system_ends_the_server() {
    let desk = Desk::new();
    let mut client = Client::new(&desk);
    client.open("a.rt", "sphere { radius: 8deg }\n");
    let said = client.diagnostics("a.rt", Some(1));
    let page = said[0]["codeDescription"]["href"].as_str().unwrap().strip_prefix("file://").unwrap();
    let folder = std::path::Path::new(page).parent().unwrap();
    assert!(folder.exists());
    client.terminate();
    client.code();
    assert!(!folder.exists());
}

#[cfg(unix)]
#[test]
fn a_root_may_be_named_through_a_link() {
    let desk = Desk::new();
    for folder in ["real", "real/rooms", "real/common"] {
        std::fs::create_dir(desk.path(folder)).unwrap();
    }
    std::os::unix::fs::symlink(desk.path("real"), desk.path("link")).unwrap();
    desk.put("real/common/woods.rt", "material oak = diffuse { color: #705848 }\n");
    let scene = "import \"../common/woods.rt\" as woods\nsphere { radius: 1m, material: woods.oak }\n";
    for (root, folder) in [("link", "link"), ("real", "link"), ("link", "real"), ("real", "real")] {
        let mut client =
            Client::started(&desk, &format!("lsp --root {root}")).agreed(json!({ "capabilities": {} }));
        // As the client writes it, and not where links lead.
        let uri = format!("file://{}", desk.path(folder).join("rooms/scene.rt").display());
        let item = json!({ "uri": uri, "languageId": "rt", "version": 1, "text": scene });
        client.tell("textDocument/didOpen", json!({ "textDocument": item }));
        let said = client.wait("diagnostics", |message| message["params"]["uri"] == *uri);
        assert_eq!(said["params"]["diagnostics"], json!([]), "{root} {folder}");
        assert_eq!(client.end(), Some(0));
    }
}

#[test]
fn every_question_has_an_answer() {
    let desk = Desk::new();
    let mut client = Client::new(&desk);
    client.open("a.rt", SCENE);
    let whole = json!({ "start": { "line": 0, "character": 0 }, "end": { "line": 7, "character": 0 } });
    let with = |client: &Client, more: Value| {
        let mut params = document(client, "a.rt");
        for (name, value) in more.as_object().unwrap() {
            params[name] = value.clone();
        }
        params
    };
    let at = json!({ "line": 1, "character": 7 });
    let options = json!({ "tabSize": 2, "insertSpaces": true });
    let colour = json!({ "red": 0.5, "green": 0, "blue": 1, "alpha": 1 });
    for (method, more) in [
        ("hover", json!({ "position": at })),
        ("completion", json!({ "position": at })),
        ("signatureHelp", json!({ "position": { "line": 3, "character": 15 } })),
        ("definition", json!({ "position": { "line": 3, "character": 16 } })),
        ("references", json!({ "position": at, "context": { "includeDeclaration": true } })),
        ("documentHighlight", json!({ "position": at })),
        ("prepareRename", json!({ "position": at })),
        ("documentSymbol", json!({})),
        ("foldingRange", json!({})),
        ("selectionRange", json!({ "positions": [at] })),
        ("semanticTokens/full", json!({})),
        ("semanticTokens/range", json!({ "range": whole })),
        ("documentColor", json!({})),
        ("colorPresentation", json!({ "color": colour, "range": whole })),
        ("inlayHint", json!({ "range": whole })),
        ("formatting", json!({ "options": options })),
        ("rangeFormatting", json!({ "range": whole, "options": options })),
        ("documentLink", json!({})),
        ("codeAction", json!({ "range": whole, "context": { "diagnostics": [] } })),
        ("codeLens", json!({})),
    ] {
        let params = with(&client, more);
        client
            .ask(&format!("textDocument/{method}"), params)
            .unwrap_or_else(|error| panic!("{method}: {error}"));
    }
    client.ask("workspace/symbol", json!({ "query": "red" })).unwrap();
    assert_eq!(client.end(), Some(0));
}
