//! The answers of the library as the protocol has them: places, edits of several files, and what is refused.

use super::super::Desk;
use super::client::Client;
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

fn about(client: &Client, name: &str, more: Value) -> Value {
    let mut params = json!({ "textDocument": { "uri": client.uri(name) } });
    params.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
    params
}

/// The place of some words of a text of ASCII, in its last line that has them.
fn at(text: &str, words: &str) -> [u32; 2] {
    let byte = text.rfind(words).unwrap();
    let line = text[..byte].rfind('\n').map_or(0, |at| at + 1);
    [text[..byte].matches('\n').count() as u32, (byte - line) as u32]
}

/// The edits of an answer, by the end of the address of their file.
fn edits(answer: &Value) -> Vec<(String, usize, Option<i64>)> {
    let change = |change: &Value| {
        let uri = change["textDocument"]["uri"].as_str().unwrap();
        let name = uri.rsplit('/').next().unwrap().to_string();
        (name, change["edits"].as_array().unwrap().len(), change["textDocument"]["version"].as_i64())
    };
    let mut edits: Vec<_> = answer["documentChanges"].as_array().unwrap().iter().map(change).collect();
    edits.sort();
    edits
}

#[test]
fn a_name_tells_what_it_is_and_who_uses_it() {
    let desk = Desk::new();
    let mut client = Client::new(&desk);
    client.open("a.rt", SCENE);
    let [line, character] = at(SCENE, "red }");
    let hover = client.at("textDocument/hover", "a.rt", line, character).unwrap();
    let said = hover["contents"]["value"].as_str().unwrap();
    assert!(said.contains("material red"), "{said}");
    let definition = client.at("textDocument/definition", "a.rt", line, character).unwrap();
    assert_eq!(definition["range"]["start"], json!({ "line": 2, "character": 9 }));
    let highlights = client.at("textDocument/documentHighlight", "a.rt", line, character).unwrap();
    assert_eq!(highlights.as_array().unwrap().len(), 2);
    let named = client.at("textDocument/prepareRename", "a.rt", line, character).unwrap();
    assert_eq!(named["placeholder"], "red");
    let hover = client.at("textDocument/hover", "a.rt", 3, at(SCENE, "count) {")[1]).unwrap();
    let said = hover["contents"]["value"].as_str().unwrap();
    assert!(said.contains("param count: int") && said.contains("How many balls."), "{said}");
    assert_eq!(client.end(), Some(0));
}

#[test]
fn names_are_changed_in_all_files_open_or_not() {
    let desk = Desk::new();
    let woods = "material oak = diffuse { color: #705848 }\n";
    desk.put("woods.rt", woods);
    desk.put("saved.rt", "import \"woods.rt\" as woods\nsphere { radius: 1m, material: woods.oak }\n");
    desk.put("other.rt", "material oak = diffuse {}\nsphere { radius: 1m, material: oak }\n");
    let mut client = Client::new(&desk);
    client.open("woods.rt", woods);
    client.open("open.rt", "import \"woods.rt\" as w\nbox { size: (1, 1, 1)m, material: w.oak }\n");
    let params =
        about(&client, "woods.rt", json!({ "position": { "line": 0, "character": 10 }, "newName": "elm" }));
    let renamed = client.ask("textDocument/rename", params).unwrap();
    let expected = [("open.rt", 1, Some(1)), ("saved.rt", 1, None), ("woods.rt", 1, Some(1))]
        .map(|(a, b, c)| (a.to_string(), b, c));
    assert_eq!(edits(&renamed), expected);
    let params =
        json!({ "position": { "line": 0, "character": 10 }, "context": { "includeDeclaration": true } });
    let params = about(&client, "woods.rt", params);
    let found = client.ask("textDocument/references", params).unwrap();
    assert_eq!(found.as_array().unwrap().len(), 3);
    // A name that is none is refused with the reason.
    let params =
        about(&client, "woods.rt", json!({ "position": { "line": 0, "character": 10 }, "newName": "8" }));
    assert_eq!(client.ask("textDocument/rename", params).unwrap_err()["code"], -32803);
    let symbols = client.ask("workspace/symbol", json!({ "query": "oak" })).unwrap();
    assert_eq!(symbols.as_array().unwrap().len(), 2, "{symbols}");
    assert_eq!(client.end(), Some(0));
}

#[test]
fn open_documents_are_renamed_together_wherever_they_lie() {
    let desk = Desk::new();
    let woods = "material oak = diffuse { color: #705848 }\n";
    let params = |client: &Client, name: &str, line: u32, character: u32| {
        let at = json!({ "line": line, "character": character });
        let more = json!({ "position": at, "newName": "elm", "context": { "includeDeclaration": true } });
        about(client, name, more)
    };
    let both = [("scene.rt", 1, Some(1)), ("woods.rt", 1, Some(1))].map(|(a, b, c)| (a.to_string(), b, c));
    std::fs::create_dir(desk.path("lib")).unwrap();
    // No folder of a workspace says where they lie together, or only the one of those that are imported.
    for folders in
        [json!([]), json!([{ "uri": format!("file://{}", desk.path("lib").display()), "name": "lib" }])]
    {
        let edits_with = json!({ "workspace": { "workspaceEdit": { "documentChanges": true } } });
        let mut client =
            Client::silent(&desk).agreed(json!({ "capabilities": edits_with, "workspaceFolders": folders }));
        client.open("lib/woods.rt", woods);
        client.open("scene.rt", "import \"lib/woods.rt\" as w\nsphere { radius: 1m, material: w.oak }\n");
        for (name, line, character) in [("lib/woods.rt", 0, 10), ("scene.rt", 1, 34)] {
            let renamed = client.ask("textDocument/rename", params(&client, name, line, character)).unwrap();
            assert_eq!(edits(&renamed), both, "{name}");
            let found =
                client.ask("textDocument/references", params(&client, name, line, character)).unwrap();
            assert_eq!(found.as_array().unwrap().len(), 2, "{name}");
        }
        assert_eq!(client.end(), Some(0));
    }
}

#[test]
fn names_are_changed_in_folders_that_are_otherwise_left_out() {
    for (folder, arguments) in [("target", "lsp"), (".drafts", "lsp"), ("target", "lsp --root .")] {
        let desk = Desk::new();
        std::fs::create_dir(desk.path(folder)).unwrap();
        let woods = "material oak = diffuse { color: #705848 }\n";
        desk.put(&format!("{folder}/woods.rt"), woods);
        desk.put(
            &format!("{folder}/scene.rt"),
            "import \"woods.rt\" as w\nsphere { radius: 1m, material: w.oak }\n",
        );
        let client = Client::started(&desk, arguments);
        let edits_with = json!({ "workspace": { "workspaceEdit": { "documentChanges": true } } });
        let root = json!([{ "uri": client.uri(""), "name": "desk" }]);
        let mut client = client.agreed(json!({ "capabilities": edits_with, "workspaceFolders": root }));
        let name = format!("{folder}/woods.rt");
        client.open(&name, woods);
        let more = json!({ "position": { "line": 0, "character": 10 }, "newName": "elm" });
        let renamed = client.ask("textDocument/rename", about(&client, &name, more)).unwrap();
        let both = [("scene.rt", 1, None), ("woods.rt", 1, Some(1))].map(|(a, b, c)| (a.to_string(), b, c));
        assert_eq!(edits(&renamed), both, "{folder} {arguments}");
        assert_eq!(client.end(), Some(0));
    }
}

#[test]
fn a_workspace_too_deep_to_look_through_is_no_reason_to_rename_a_part() {
    let desk = Desk::new();
    let deep: String = (0..14).map(|_| "in/").collect();
    std::fs::create_dir_all(desk.path(&deep)).unwrap();
    let woods = "material oak = diffuse { color: #705848 }\n";
    desk.put("woods.rt", woods);
    let mut client = Client::started(&desk, "lsp --root .").agreed(json!({ "capabilities": {} }));
    client.open("woods.rt", woods);
    let more = json!({ "position": { "line": 0, "character": 10 }, "newName": "elm" });
    let refused = client.ask("textDocument/rename", about(&client, "woods.rt", more)).unwrap_err();
    assert_eq!(refused["message"], "the workspace has too many files to find all uses");
    assert_eq!(client.end(), Some(0));
}

#[test]
fn symbols_of_scenes_that_take_long_are_soon_there() {
    let desk = Desk::new();
    for index in 0..200 {
        let scene = format!(
            "let oak{index} = 1m\nfor i in range(300000) {{ sphere {{ at: (sin(i * 1deg), i, 0)m, radius: 1m }} }}\n"
        );
        desk.put(&format!("many{index}.rt"), scene);
    }
    let mut client = Client::new(&desk);
    let symbols = client.ask("workspace/symbol", json!({ "query": "oak" })).unwrap();
    assert_eq!(symbols.as_array().unwrap().len(), 200);
    let first = symbols.as_array().unwrap().iter().find(|symbol| symbol["name"] == "oak0").unwrap();
    assert_eq!(first["location"]["uri"], client.uri("many0.rt"));
    assert_eq!(first["location"]["range"]["start"], json!({ "line": 0, "character": 4 }));
    assert_eq!(client.end(), Some(0));
}

#[test]
fn who_takes_no_snippets_is_given_no_names_that_are_not_there() {
    let desk = Desk::new();
    let completion = json!({ "completion": { "completionItem": { "documentationFormat": ["plaintext"] } } });
    let mut client = Client::with(&desk, json!({ "textDocument": completion }));
    client.open("a.rt", "sphere { radius: cla }\nsph\n");
    for (line, character, label, text) in [(0, 20, "clamp", "clamp("), (1, 3, "sphere", "sphere")] {
        let offered = client.at("textDocument/completion", "a.rt", line, character).unwrap();
        let one = offered.as_array().unwrap().iter().find(|item| item["label"] == label).unwrap();
        assert_eq!(one["textEdit"]["newText"], text);
        assert_eq!(
            (&one["insertTextFormat"], &one["documentation"]["kind"]),
            (&json!(1), &json!("plaintext"))
        );
    }
    assert_eq!(client.end(), Some(0));
}

#[test]
fn folds_of_whole_lines_hide_nothing_that_goes_on() {
    let desk = Desk::new();
    let lines = json!({ "foldingRange": { "lineFoldingOnly": true } });
    let mut client = Client::with(&desk, json!({ "textDocument": lines }));
    client.open("a.rt", "if 1 < 2 {\n  sphere { radius: 1m }\n} else {\n  sphere { radius: 2m }\n}\n");
    let folds = client.ask("textDocument/foldingRange", about(&client, "a.rt", json!({}))).unwrap();
    assert_eq!(folds, json!([{ "startLine": 0, "endLine": 1 }, { "startLine": 2, "endLine": 4 }]));
    assert_eq!(client.end(), Some(0));
}

#[test]
fn a_param_of_a_part_is_renamed_where_it_is_set_and_a_name_that_is_taken_is_refused() {
    let desk = Desk::new();
    desk.put(
        "woods.rt",
        "part stool {\n  param seat: length = 45cm\n  param wide: length = 30cm\n  sphere { radius: seat - wide }\n}\n",
    );
    let mut client = Client::new(&desk);
    client.open("scene.rt", "import \"woods.rt\" as woods\nwoods.stool { seat: 40cm }\n");
    let rename = |client: &mut Client, name: &str| {
        let more = json!({ "position": { "line": 1, "character": 15 }, "newName": name });
        let params = about(client, "scene.rt", more);
        client.ask("textDocument/rename", params)
    };
    let renamed = rename(&mut client, "tall").unwrap();
    let expected = [("scene.rt", 1, Some(1)), ("woods.rt", 2, None)].map(|(a, b, c)| (a.to_string(), b, c));
    assert_eq!(edits(&renamed), expected);
    let refused = rename(&mut client, "wide").unwrap_err();
    assert_eq!(refused["code"], -32803);
    let said = refused["message"].as_str().unwrap();
    assert!(said.contains("`wide` is declared at") && said.ends_with("line 3"), "{said}");
    assert_eq!(client.end(), Some(0));
}

#[test]
fn what_follows_from_a_scene_stands_beside_it() {
    let desk = Desk::new();
    let mut client = Client::new(&desk);
    let scene = "let r = 2 * 15cm\nsphere { radius: r }\n\
                 camera { from: (0, 1, 4)m, look: (0, 0, 0)m, lens { focal: 50mm, stop: 2, focus: 4m } }\n";
    client.open("a.rt", scene);
    let whole = json!({ "start": { "line": 0, "character": 0 }, "end": { "line": 3, "character": 0 } });
    let params = about(&client, "a.rt", json!({ "range": whole }));
    let hints = client.ask("textDocument/inlayHint", params).unwrap();
    let said: Vec<(u64, &str)> = hints
        .as_array()
        .unwrap()
        .iter()
        .map(|hint| (hint["position"]["line"].as_u64().unwrap(), hint["label"].as_str().unwrap()))
        .collect();
    assert!(said.iter().any(|(line, text)| *line == 0 && text.contains("30cm")), "{said:?}");
    // 2 atan(36mm / (2 · 50mm)).
    assert!(said.iter().any(|(line, text)| *line == 2 && text.contains("39.6deg")), "{said:?}");
    let link = "sky { image: \"dawn.png\" }\nimport \"woods.rt\" as woods\n";
    desk.put("woods.rt", "material oak = diffuse {}\n");
    client.replace("a.rt", 2, link);
    let params = about(&client, "a.rt", json!({}));
    let links = client.ask("textDocument/documentLink", params).unwrap();
    let targets: Vec<&str> =
        links.as_array().unwrap().iter().map(|link| link["target"].as_str().unwrap()).collect();
    assert!(targets.contains(&&*client.uri("woods.rt")), "{targets:?}");
    assert_eq!(client.end(), Some(0));
}

#[test]
fn slips_have_mends_and_warnings_can_be_allowed() {
    let desk = Desk::new();
    let mut client = Client::new(&desk);
    client.open("a.rt", "sphere { radius = 8mm }\nlet spare = 1m\n");
    let whole = json!({ "start": { "line": 0, "character": 0 }, "end": { "line": 2, "character": 0 } });
    let ask = |client: &mut Client, only: Value| {
        let context = json!({ "diagnostics": [], "only": only });
        let params = about(client, "a.rt", json!({ "range": whole, "context": context }));
        client.ask("textDocument/codeAction", params).unwrap()
    };
    let mends = ask(&mut client, json!(["quickfix"]));
    assert_eq!(
        (&mends[0]["isPreferred"], &mends[0]["diagnostics"][0]["code"]),
        (&json!(true), &json!("E0003"))
    );
    assert_eq!(edits(&mends[0]["edit"]), [("a.rt".to_string(), 1, Some(1))]);
    let all = ask(&mut client, json!(["source.fixAll"]));
    assert_eq!((all.as_array().unwrap().len(), &all[0]["kind"]), (1, &json!("source.fixAll")));
    // What shows only behind another mend is mended as well: `=` hides that nothing is called `raduis`.
    let slips = "sphere { raduis = 8 mm }\r\nlet spare = 1m\r\n";
    client.replace("a.rt", 2, slips);
    let all = ask(&mut client, json!(["source.fixAll"]));
    let edit = &all[0]["edit"]["documentChanges"][0]["edits"][0];
    assert_eq!(edit["newText"], "sphere { radius: 8mm }\r\n");
    let automatic = json!({ "diagnostics": [], "triggerKind": 2 });
    let params = about(&client, "a.rt", json!({ "range": whole, "context": automatic }));
    let offered = client.ask("textDocument/codeAction", params).unwrap();
    let offered: Vec<&Value> = offered.as_array().unwrap().iter().map(|one| &one["kind"]).collect();
    assert!(!offered.is_empty() && offered.iter().all(|kind| **kind == "quickfix"), "{offered:?}");
    client.replace("a.rt", 3, "sphere { radius: 8mm }\nlet spare = 1m\n");
    let allowed = ask(&mut client, Value::Null);
    let titles: Vec<&str> =
        allowed.as_array().unwrap().iter().filter_map(|one| one["title"].as_str()).collect();
    assert!(titles.iter().any(|title| title.to_lowercase().contains("allow")), "{titles:?}");
    assert_eq!(client.end(), Some(0));
}

#[test]
fn what_fits_is_offered_in_a_broken_statement_too() {
    let desk = Desk::new();
    let mut client = Client::new(&desk);
    client.open("a.rt", "sphere { ra\nbox { }\n");
    let offered = client.at("textDocument/completion", "a.rt", 0, 11).unwrap();
    let radius = offered.as_array().unwrap().iter().find(|item| item["label"] == "radius").unwrap();
    assert_eq!(radius["textEdit"]["range"]["start"], json!({ "line": 0, "character": 9 }));
    client.replace("a.rt", 2, "sphere { radius: linspace(1m, ");
    let called = client.at("textDocument/signatureHelp", "a.rt", 0, 30).unwrap();
    assert!(called["signatures"][0]["label"].as_str().unwrap().starts_with("linspace("), "{called}");
    assert_eq!(called["signatures"][0]["activeParameter"], 1);
    assert_eq!(client.end(), Some(0));
}

#[test]
fn a_file_that_is_open_and_not_saved_is_offered_for_import() {
    let desk = Desk::new();
    desk.put("saved.rt", "");
    let mut client = Client::new(&desk);
    for name in ["new.rt", "saved.rt", "parts/new.rt"] {
        client.open(name, "sphere { radius: 1m }\n");
    }
    client.open("a.rt", "import \"\"\nimport \"parts/\"\n");
    for (line, character, wanted) in
        [(0, 8, vec!["ball.rt", "new.rt", "saved.rt", "parts/"]), (1, 14, vec!["parts/new.rt"])]
    {
        let offered = client.at("textDocument/completion", "a.rt", line, character).unwrap();
        let labels: Vec<&str> =
            offered.as_array().unwrap().iter().filter_map(|item| item["label"].as_str()).collect();
        assert_eq!(labels, wanted);
    }
    assert_eq!(client.end(), Some(0));
}

#[test]
fn the_text_is_told_in_its_parts() {
    let desk = Desk::new();
    let mut client = Client::new(&desk);
    client.open("a.rt", SCENE);
    let none = json!({});
    let mut ask = |method: &str, more: &Value| {
        let params = about(&client, "a.rt", more.clone());
        client.ask(&format!("textDocument/{method}"), params).unwrap()
    };
    let tokens = ask("semanticTokens/full", &none);
    let numbers = tokens["data"].as_array().unwrap().len();
    assert!(numbers > 100 && numbers % 5 == 0, "{numbers}");
    let colours = ask("documentColor", &none);
    assert_eq!(colours[0]["range"]["start"], json!({ "line": 2, "character": 32 }));
    let range = &colours[0]["range"];
    let blue = json!({ "red": 0, "green": 0, "blue": 1, "alpha": 1 });
    let ways = ask("colorPresentation", &json!({ "color": blue, "range": range }));
    assert_eq!(ways[0]["textEdit"]["newText"], "#0000ff");
    let names: Vec<String> = ask("documentSymbol", &none)
        .as_array()
        .unwrap()
        .iter()
        .map(|symbol| symbol["name"].as_str().unwrap().to_string())
        .collect();
    assert!(names.contains(&"count".into()) && names.contains(&"red".into()), "{names:?}");
    let folds = ask("foldingRange", &none);
    assert!(folds.as_array().unwrap().iter().any(|fold| fold["startLine"] == 3), "{folds}");
    let grown = ask("selectionRange", &json!({ "positions": [{ "line": 4, "character": 4 }] }));
    assert!(grown[0]["parent"].is_object(), "{grown}");
    let lenses = ask("codeLens", &none);
    let commands: Vec<&str> =
        lenses.as_array().unwrap().iter().map(|lens| lens["command"]["command"].as_str().unwrap()).collect();
    assert_eq!(commands, ["rtc.startPreview", "rtc.render"]);
    assert_eq!(client.end(), Some(0));
}

#[test]
fn what_is_selected_is_laid_out_alone() {
    let desk = Desk::new();
    let mut client = Client::new(&desk);
    client.open("a.rt", "sphere{radius:1m}\nbox{size:(1,2,3)m}\nlet  q=1\n");
    let line = |line: u32, end: u32| json!({ "start": { "line": line, "character": 0 }, "end": { "line": end, "character": 0 } });
    let options = json!({ "tabSize": 2, "insertSpaces": true });
    let params = about(&client, "a.rt", json!({ "range": line(1, 2), "options": options }));
    let edits = client.ask("textDocument/rangeFormatting", params).unwrap();
    assert_eq!(edits, json!([{ "range": line(1, 2), "newText": "box { size: (1, 2, 3)m }\n" }]));
    assert_eq!(client.end(), Some(0));
}

#[test]
fn a_file_that_somebody_else_changes_is_seen_where_the_client_does_not_tell() {
    let desk = Desk::new();
    desk.put("woods.rt", "material oak = diffuse { color: 8 }\n");
    let mut client = Client::new(&desk);
    client.open("scene.rt", "import \"woods.rt\" as woods\nsphere { radius: 1m, material: woods.oak }\n");
    assert_eq!(client.codes("woods.rt", None), ["E0205"]);
    desk.put("woods.rt", "material oak = diffuse { color: #705848 }\n");
    assert_eq!(client.codes("woods.rt", None), Vec::<String>::new());
    assert_eq!(client.end(), Some(0));
}

#[test]
fn what_the_editor_cannot_take_is_not_sent() {
    let desk = Desk::new();
    let text = "/// Of `x`.\nfn half(x: number) -> number = x / 2\nsphere { radius: 1m * half(2) }\n";
    let able = json!({
        "rename": { "prepareSupport": true },
        "codeAction": { "codeActionLiteralSupport": { "codeActionKind": { "valueSet": ["quickfix"] } } },
        "signatureHelp": { "signatureInformation": {
            "documentationFormat": ["plaintext", "markdown"],
            "noActiveParameterSupport": true,
        } },
    });
    for (can, kind) in [(true, "markdown"), (false, "plaintext")] {
        let mut client = Client::silent(&desk);
        let told = if can { able.clone() } else { json!({}) };
        let said = client.ask("initialize", json!({ "capabilities": { "textDocument": told } })).unwrap();
        let said = &said["capabilities"];
        let renames = if can { json!({ "prepareProvider": true }) } else { json!(true) };
        assert_eq!(said["renameProvider"], renames);
        assert_eq!(said["codeActionProvider"].is_object(), can, "{said}");
        client.tell("initialized", json!({}));
        client.open("a.rt", text);
        let help = client.at("textDocument/signatureHelp", "a.rt", 2, 27).unwrap();
        assert_eq!(help["signatures"][0]["documentation"]["kind"], kind, "{help}");
        // Where no field is named yet, none is lit: an index that is left out or not there is the first one's.
        let help = client.at("textDocument/signatureHelp", "a.rt", 2, 8).unwrap();
        let made = &help["signatures"][0];
        assert!(made["label"].as_str().unwrap().starts_with("sphere {"), "{help}");
        assert_eq!(made.get("activeParameter"), can.then_some(&Value::Null), "{help}");
        assert_eq!(made.get("parameters").is_some(), can, "{help}");
        assert_eq!(client.end(), Some(0));
    }
}
