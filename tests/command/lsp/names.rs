//! Names across files: asked for and changed as somebody does who edits several of them.

use super::super::Desk;
use super::client::Client;
use serde_json::{Value, json};

/// The texts of an editor, which makes the edits it is given.
struct Editor<'d> {
    client: Client<'d>,
    texts: Vec<(&'d str, String)>,
}

impl<'d> Editor<'d> {
    /// Opens texts; `$` before a name stands for the cursor.
    fn new(desk: &'d Desk, texts: &[(&'d str, &str)]) -> (Editor<'d>, &'d str, [usize; 2]) {
        let mut client = Client::new(desk);
        let (mut opened, mut cursor) = (vec![], None);
        for (name, text) in texts {
            let plain = text.replace('$', "");
            if let Some(at) = text.find('$') {
                let line = text[..at].matches('\n').count();
                let begins = text[..at].rfind('\n').map_or(0, |end| end + 1);
                cursor = Some((*name, [line, text[begins..at].encode_utf16().count()]));
            }
            client.open(name, &plain);
            opened.push((*name, plain));
        }
        let (name, at) = cursor.unwrap();
        (Editor { client, texts: opened }, name, at)
    }

    /// The texts once what stands at the cursor has another name, or why it cannot.
    fn rename(
        mut self,
        file: &str,
        [line, character]: [usize; 2],
        name: &str,
    ) -> Result<Vec<String>, String> {
        let params = json!({
            "textDocument": { "uri": self.client.uri(file) },
            "position": { "line": line, "character": character },
            "newName": name,
        });
        let mut answer = self.client.ask("textDocument/rename", params.clone());
        // What has changed on the disk meanwhile is asked about again.
        while answer.as_ref().is_err_and(|error| error["code"] == -32801) {
            answer = self.client.ask("textDocument/rename", params.clone());
        }
        let edit = answer.map_err(|error| error["message"].as_str().unwrap().to_string())?;
        for changed in edit["documentChanges"].as_array().unwrap() {
            let uri = changed["textDocument"]["uri"].as_str().unwrap();
            let text = self.texts.iter_mut().find(|(name, _)| uri.ends_with(&format!("/{name}"))).unwrap();
            let mut edits = changed["edits"].as_array().unwrap().clone();
            edits.sort_by_key(|edit| std::cmp::Reverse(place(&edit["range"]["start"])));
            for edit in edits {
                let [start, end] = ["start", "end"].map(|end| byte(&text.1, place(&edit["range"][end])));
                text.1.replace_range(start..end, edit["newText"].as_str().unwrap());
            }
        }
        assert_eq!(self.client.end(), Some(0));
        Ok(self.texts.into_iter().map(|(_, text)| text).collect())
    }
}

fn place(position: &Value) -> [u64; 2] {
    ["line", "character"].map(|name| position[name].as_u64().unwrap())
}

/// The byte of a place that counts in units of UTF-16.
fn byte(text: &str, [line, character]: [u64; 2]) -> usize {
    let start = text.split_inclusive('\n').take(line as usize).map(str::len).sum::<usize>();
    let mut units = 0;
    let signs = text[start..].char_indices();
    let before = signs.take_while(|(_, sign)| {
        units += sign.len_utf16() as u64;
        units <= character
    });
    start + before.map(|(_, sign)| sign.len_utf8()).sum::<usize>()
}

/// Renames what stands behind `$` to `new`, and compares with `old` in place of which `new` should stand: written `‹old›`.
#[track_caller]
fn renames(texts: &[(&'static str, &str)]) {
    let desk = Desk::new();
    let begun: Vec<(&str, String)> =
        texts.iter().map(|(name, text)| (*name, text.replace(['‹', '›'], ""))).collect();
    let begun: Vec<(&str, &str)> = begun.iter().map(|(name, text)| (*name, text.as_str())).collect();
    let (editor, file, at) = Editor::new(&desk, &begun);
    let wanted: Vec<String> = texts
        .iter()
        .map(|(_, text)| {
            let pieces = text.split('‹').enumerate().map(|(index, piece)| match index {
                0 => piece.to_string(),
                _ => format!("new{}", piece.split_once('›').unwrap().1),
            });
            pieces.collect::<String>().replace('$', "")
        })
        .collect();
    assert_eq!(editor.rename(file, at, "new"), Ok(wanted));
}

#[test]
fn a_param_of_a_part_is_renamed_where_other_files_give_it() {
    renames(&[
        (
            "stool.rt",
            "part stool {\n  param ‹$seat›: length = 45cm\n  sphere { radius: ‹seat› }\n}\nlet seat_of = 1m\n",
        ),
        (
            "a.rt",
            "import \"stool.rt\" as s\ns.stool left { ‹seat›: 1m, at: (0, 0, 0) }\nsphere { radius: left.‹seat› }\n",
        ),
        (
            "b.rt",
            "import \"stool.rt\" as seats\nlet low = seats.stool { ‹seat›: 30cm }\nlow {}\nseats.stool { ‹seat›: 2m }\n",
        ),
    ]);
    // From where it is given.
    renames(&[
        ("lamp.rt", "param ‹size›: length = 1m\nsphere { radius: ‹size› }\n"),
        ("a.rt", "import \"lamp.rt\" as lamp\nfor size in [1m, 2m] { lamp { $‹size›: size } }\n"),
    ]);
}

#[test]
fn an_alias_is_renamed_in_its_file_alone() {
    renames(&[
        ("woods.rt", "material oak = diffuse {}\n"),
        (
            "a.rt",
            "import \"woods.rt\" as ‹woods›\nsphere { radius: 1m, material: ‹$woods›.oak }\nsphere { radius: 1m, at: (3, 0, 0)m, material: ‹woods›.oak { color: red } }\n",
        ),
        ("b.rt", "import \"woods.rt\" as woods\nsphere { radius: 1m, material: woods.oak }\n"),
    ]);
}

#[test]
fn names_that_are_alike_are_told_apart() {
    // Two loops, each with its own variable.
    renames(&[(
        "a.rt",
        "for ‹$i› in range(3) { sphere { radius: 1cm * (‹i› + 1), at: (‹i›, 0, 0) * 1m } }\nfor i in range(3) { sphere { radius: 1cm, at: (i, 1, 0) * 1m } }\n",
    )]);
    // Members of two parts.
    renames(&[(
        "a.rt",
        "part a { sphere ‹$ball› { radius: 1m } }\npart b { sphere ball { radius: 1m } }\na x {}\nb y { at: (3, 0, 0)m }\ncamera { from: (0, 0, 9)m, look: x.‹ball› }\nlens { focus: y.ball, aperture: 1mm }\n",
    )]);
}

#[test]
fn places_are_counted_as_the_client_does() {
    renames(&[(
        "a.rt",
        "// 😀\r\nlet größe = 1m\r\nlet ‹r› = 2m /* 😀𝄞 */\r\nsphere { radius: /* 😀 */ ‹$r›, at: (größe, /* € */ ‹r›, 0) }\r\n",
    )]);
}

#[test]
fn slips_elsewhere_leave_nothing_out() {
    renames(&[(
        "a.rt",
        "import \"gone.rt\" as l\nlet ‹$r› = 1m\nl { size: ‹r› }\nsfere { radius: ‹r› }\nbox { size: 8deg }\nsphere { radius: ‹r› }\n",
    )]);
    let refused = |text: &'static str| {
        let desk = Desk::new();
        let (editor, file, at) = Editor::new(&desk, &[("a.rt", text)]);
        editor.rename(file, at, "new").unwrap_err()
    };
    let why =
        refused("part p { param $size: length = 1m, sphere { radius: size } }\npp { size: 2m }\np {}\n");
    assert!(why.starts_with("what `size` means at ") && why.contains("a.rt, line 2 is not known"), "{why}");
    let why = refused("let $r = 1m\nsphere { radius: r\n");
    assert!(why.ends_with("mend it first"), "{why}");
    let why = refused("let $r = 1m\nfor new in [1m] { sphere { radius: r + new } }\n");
    assert!(why.starts_with("`new` is declared at ") && why.ends_with("a.rt, line 2"), "{why}");
}

#[test]
fn uses_are_found_from_anywhere() {
    let desk = Desk::new();
    desk.put("saved.rt", "import \"woods.rt\" as w\nsphere { radius: w.r }\n");
    let (mut editor, _, _) = Editor::new(
        &desk,
        &[
            ("woods.rt", "let $r = 1m\n"),
            ("a.rt", "import \"woods.rt\" as w\nsphere { radius: w.r, at: (0, w.r, 0) }\n"),
        ],
    );
    let mut ask = |file: &str, line: u32, character: u32| {
        let params = json!({
            "textDocument": { "uri": editor.client.uri(file) },
            "position": { "line": line, "character": character },
            "context": { "includeDeclaration": true },
        });
        let found = editor.client.ask("textDocument/references", params).unwrap();
        let place = |found: &Value| {
            let file = found["uri"].as_str().unwrap().rsplit('/').next().unwrap().to_string();
            (file, place(&found["range"]["start"]))
        };
        found.as_array().unwrap().iter().map(place).collect::<Vec<_>>()
    };
    let all = ask("woods.rt", 0, 4);
    let wanted = [("a.rt", [1, 19]), ("a.rt", [1, 32]), ("saved.rt", [1, 19]), ("woods.rt", [0, 4])];
    assert_eq!(all, wanted.map(|(file, place)| (file.to_string(), place)));
    assert_eq!(ask("a.rt", 1, 32), all);
    // Of nothing there are none, of what is built in those of the file.
    assert_eq!(ask("a.rt", 1, 8), []);
    assert_eq!(ask("a.rt", 1, 2), [("a.rt".to_string(), [1, 0])]);
    let highlights = editor.client.at("textDocument/documentHighlight", "a.rt", 1, 19).unwrap();
    assert_eq!(highlights.as_array().unwrap().len(), 2);
    let target = editor.client.at("textDocument/definition", "a.rt", 1, 19).unwrap();
    assert_eq!(target["uri"], *editor.client.uri("woods.rt"));
    assert_eq!(editor.client.end(), Some(0));
}
