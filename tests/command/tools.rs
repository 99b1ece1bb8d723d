//! The commands that make no picture: explaining, inspecting, beginning, completing; and messages for programs.

use super::Desk;
use rt_lang::diagnostic::Code;
use rt_lang::explain::{Example, Piece, Role, page, pieces};
use serde_json::Value;
use std::collections::BTreeSet;

impl super::Ended {
    /// What was said on standard output.
    fn printed(&self) -> String {
        String::from_utf8(self.stdout.clone()).unwrap()
    }
}

/// The diagnostics that a command gave as JSON, one object a line.
fn objects(printed: &str) -> Vec<Value> {
    printed
        .lines()
        .map(|line| serde_json::from_str(line).unwrap_or_else(|_| panic!("no JSON: {line}")))
        .collect()
}

/// The bytes of an example: `\xNN` stands for one where the page says so.
fn bytes(example: &Example) -> Vec<u8> {
    if !example.bytes {
        return example.text.into();
    }
    let mut parts = example.text.split("\\x");
    let mut bytes: Vec<u8> = parts.next().unwrap().into();
    for part in parts {
        bytes.push(u8::from_str_radix(&part[..2], 16).unwrap());
        bytes.extend(part[2..].bytes());
    }
    bytes
}

/// The codes that the examples of one role on a page give.
fn codes_given(page: &str, role: Role) -> BTreeSet<String> {
    let desk = Desk::new();
    let mut command = desk.command("check --message-format json scene.rt");
    for piece in pieces(page) {
        let Piece::Example(example) = piece else { continue };
        if example.role.is_some_and(|other| other != role) {
            continue;
        }
        if example.build {
            command = desk.command("build --message-format json scene.rt");
        }
        if example.feedback {
            command.arg("--feedback");
        }
        command.args(example.set.iter().flat_map(|value| ["--set", value]));
        desk.put(example.file.unwrap_or("scene.rt"), bytes(&example));
    }
    let ended = super::ended(command.output().unwrap());
    assert!(ended.code == Some(0) || ended.code == Some(1), "{}", ended.stderr);
    objects(&ended.printed()).iter().map(|object| object["code"].as_str().unwrap().to_string()).collect()
}

#[test]
fn examples_of_the_pages_fail_by_their_own_code_and_are_mended() {
    let mut wrong = vec![];
    for code in Code::ALL.iter().copied() {
        let fails = codes_given(page(code), Role::Fail);
        if fails != BTreeSet::from([code.as_str().to_string()]) {
            wrong.push(format!("{}: the failing one gives {fails:?}", code.as_str()));
        }
        let mended = codes_given(page(code), Role::Fixed);
        if !mended.is_empty() {
            wrong.push(format!("{}: the mended one gives {mended:?}", code.as_str()));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn explain_prints_pages_and_finds_what_is_meant() {
    let desk = Desk::new();
    let page = desk.run("explain e0203");
    assert_eq!((page.code, page.stderr.as_str()), (Some(0), ""));
    assert!(page.printed().starts_with("E0203: wrong dimension\n"), "{}", page.printed());
    assert!(desk.run("explain unused_name").printed().starts_with("W0106: "));
    let list = desk.run("explain --list").printed();
    assert_eq!(list.lines().count(), Code::ALL.len());
    assert!(list.contains("W0106  unused name (warning)\n"), "{list}");
    desk.run("explain E0230").expect(2, &["no message has the code `E0230`", "did you mean E0203"]);
    desk.run("explain").expect(2, &["CODE"]);
}

#[test]
fn a_message_is_one_json_object_a_line() {
    let desk = Desk::new();
    desk.put("bad.rt", "let spare = 5cm\nsphere { raduis: 1m, at: (0, 1, 4)m }\nsphère {}\n");
    let ended = desk.run("check --message-format json bad.rt");
    assert_eq!((ended.code, ended.stderr.as_str()), (Some(1), ""));
    let printed = ended.printed();
    insta::assert_snapshot!("json", printed);
    for line in printed.lines() {
        let code = serde_json::from_str::<Value>(line).unwrap()["code"].as_str().unwrap().to_string();
        assert_eq!(line.matches(code.as_str()).count(), 1, "{line}");
    }
}

#[test]
fn other_forms_of_messages() {
    let desk = Desk::new();
    desk.put("my bad.rt", "sphere { radius: 8deg }\n");
    let run = |form: &str| {
        let mut command = desk.command(&format!("check --message-format {form}"));
        super::ended(command.arg("my bad.rt").output().unwrap())
    };
    let short = run("short");
    short.expect(1, &["my bad.rt:1:18: error[E0203]: `radius` wants a length, this is an angle\n"]);
    let github = run("github");
    assert_eq!((github.code, github.stderr.as_str()), (Some(1), ""));
    insta::assert_snapshot!("github", github.printed());
    let sarif: Value = serde_json::from_str(&run("sarif").printed()).unwrap();
    assert_eq!(sarif["version"], "2.1.0");
    let rules = sarif["runs"][0]["tool"]["driver"]["rules"].as_array().unwrap();
    assert_eq!(rules.len(), Code::ALL.len());
    let results = &sarif["runs"][0]["results"];
    assert_eq!(rules[results[0]["ruleIndex"].as_u64().unwrap() as usize]["id"], "E0203");
    insta::assert_snapshot!("sarif", serde_json::to_string_pretty(results).unwrap());
    let clean: Value =
        serde_json::from_str(&desk.run("check --message-format sarif ball.rt").printed()).unwrap();
    assert_eq!(clean["runs"][0]["results"], Value::Array(vec![]));
    assert_eq!(desk.run("check --message-format json ball.rt").printed(), "");
}

#[test]
fn warnings_can_be_denied() {
    let desk = Desk::new();
    desk.put("spare.rt", "sphere { radius: 1m }\nlet spare = 5cm\n");
    desk.run("check spare.rt").expect(0, &["W0106"]);
    desk.run("check --deny warnings spare.rt").expect(1, &["W0106", "denied by `--deny`"]);
    desk.run("check --deny w0106 spare.rt").expect(1, &["the warning W0106 is denied"]);
    desk.run("check --deny W0601 spare.rt").expect(0, &["W0106"]);
    desk.run("check --deny E0203 spare.rt").expect(2, &["error already"]);
    desk.quick("-q --deny warnings spare.rt").expect(1, &["W0106"]);
    assert!(!desk.names().contains(&"spare.png".to_string()));
    desk.quick("-q spare.rt").expect(0, &[]);
}

#[test]
fn a_build_writes_messages_for_programs_too() {
    let desk = Desk::new();
    desk.put("spare.rt", "sphere { radius: 1m }\nlet spare = 5cm\n");
    let ended = desk.run("build --size 4x4 --samples 1 --message-format json spare.rt");
    assert_eq!(ended.code, Some(0));
    assert_eq!(objects(&ended.printed())[0]["code"], "W0106");
    desk.quick("--message-format json -o - ball.rt").expect(2, &["both go to standard output"]);
}

#[test]
fn certain_mends_are_made() {
    let desk = Desk::new();
    desk.put("bad.rt", "// keep me\r\nsphere { raduis = 8 mm; at: <0, 1m, 0> }\r\nlet spare = 5cm\r\n");
    let ended = desk.run("check --fix bad.rt");
    ended.expect(0, &["mended bad.rt:2:", "error[E0003]", "error[E0301]", "W0106"]);
    let text = String::from_utf8(desk.get("bad.rt")).unwrap();
    assert_eq!(text, "// keep me\r\nsphere { radius: 8mm, at: (0, 1m, 0) }\r\nlet spare = 5cm\r\n");
    assert_eq!(desk.names(), ["bad.rt", "ball.rt"]);
    let mended = desk.get("bad.rt");
    desk.run("check --fix bad.rt").expect(0, &["W0106"]);
    assert_eq!(desk.get("bad.rt"), mended);

    desk.put("typed.rt", "sphere { radius = 8mm }");
    let ended = desk.feed("check --fix -", "typed.rt");
    assert_eq!((ended.code, ended.printed().as_str()), (Some(0), "sphere { radius: 8mm }"));
    desk.run("check --fix --message-format json -").expect(2, &["both go to standard output"]);
    desk.put("hopeless.rt", "sphere { radius: 8deg }\n");
    desk.run("check --fix hopeless.rt").expect(1, &["E0203"]);
    assert_eq!(desk.get("hopeless.rt"), b"sphere { radius: 8deg }\n");
}

#[test]
fn one_of_several_cameras_is_chosen_where_one_is_wanted() {
    let desk = Desk::new();
    desk.put(
        "two.rt",
        "sphere { radius: 1m }\ncamera a { look: 0 }\ncamera b { from: (0, 0, 9)m, look: 0 }\n",
    );
    assert_eq!(desk.run("check two.rt").code, Some(0));
    // To tell of them all, none has to be.
    let info = desk.run("info two.rt");
    assert_eq!(info.code, Some(0), "{}", info.stderr);
    assert!(info.printed().contains("a, b"), "{}", info.printed());
    for command in ["expand two.rt -o flat.rt", "export two.rt -o two.xml"] {
        assert_eq!(desk.run(command).code, Some(1), "{command}");
        assert_eq!(desk.run(&format!("{command} --camera b")).code, Some(0), "{command}");
    }
    assert!(desk.run("expand two.rt --camera b").printed().contains("from: (0, 0, 9)"));
    desk.put(
        "wrong.rt",
        "sphere { radius: 1m }\ncamera a {}\ncamera b { from: (0, 1, 0)m, look: (0, 1, 0)m }\n",
    );
    let check = desk.run("check --message-format short wrong.rt");
    assert_eq!(check.code, Some(1));
    assert!(check.stderr.contains("E0404"), "{}", check.stderr);
    // What each of them sees is looked at as well.
    desk.put(
        "behind.rt",
        "sphere { radius: 1m }\ncamera a { from: (0, 0, 9)m }\ncamera b { from: (0, 0, 9)m, look: (0, 0, 20)m }\n",
    );
    let check = desk.run("check --message-format short behind.rt");
    assert_eq!(check.code, Some(0));
    assert_eq!(check.stderr.matches("W0602").count(), 1, "{}", check.stderr);
}

#[test]
fn info_tells_what_is_in_a_scene() {
    let desk = Desk::new();
    desk.put("two.rt", "sphere { radius: 1m }\nsphere { radius: 1m, at: (4, 0, 0)m }\ncamera wide {}\nrender { samples: 3 }\n");
    let info = desk.run("info two.rt");
    assert_eq!((info.code, info.stderr.as_str()), (Some(0), ""));
    let printed = info.printed();
    for words in ["2 sphere", "wide", "640×480, 3 samples", "(-1, -1, -1)m to (5, 1, 1)m", "MiB"] {
        assert!(printed.contains(words), "no `{words}` in:\n{printed}");
    }
    let object: Value = serde_json::from_str(&desk.run("info --json two.rt").printed()).unwrap();
    assert_eq!(object["things"]["sphere"], 2);
    assert_eq!(object["cameras"][0], "wide");
    assert_eq!(object["bounds"]["max"][0], 5.0);
    desk.put(
        "set.rt",
        "/// How many.\nparam n: int = 3 in 1 to 9\nfor i in range(n) { sphere { radius: 1m } }\n",
    );
    let printed = desk.run("info set.rt --set n=5").printed();
    assert!(printed.contains("n: int = 3 in 1 to 9  How many.") && printed.contains("5 sphere"), "{printed}");
    let object: Value = serde_json::from_str(&desk.run("info --json set.rt").printed()).unwrap();
    assert_eq!((&object["params"][0]["name"], &object["params"][0]["range"][1]), (&"n".into(), &"9".into()));
    desk.run("info set.rt --set m=5").expect(1, &["E0503"]);
    desk.run("check set.rt --set n=9 --max-things 4").expect(1, &["E0406"]);
    desk.run("check set.rt --max-brackets 1").expect(1, &["E0406", "more than 1 deep"]);
    desk.run("check set.rt --max-brackets 4096 --max-source 4095").expect(0, &[]);
    desk.run("check set.rt --max-brackets 5000").expect(2, &["4096"]);
    desk.put("long.rt", format!("// {}\nsphere {{ radius: 1m }}\n", "x".repeat(1 << 20)));
    desk.run("check long.rt").expect(0, &[]);
    desk.run("check long.rt --max-source 1").expect(1, &["E0406", "1 MiB"]);
    desk.put("bad.rt", "sphere {}\n");
    desk.run("info bad.rt").expect(1, &["E0302"]);
    desk.run("info missing.rt").expect(2, &["missing.rt"]);
    desk.run("info --root nowhere two.rt").expect(2, &["the root `nowhere`"]);
}

#[test]
fn a_first_scene_is_whole_and_replaces_nothing() {
    let desk = Desk::new();
    let made = desk.run("init balls");
    assert_eq!((made.code, made.stderr.as_str()), (Some(0), ""));
    assert!(made.printed().contains("rtc build balls/scene.rt"), "{}", made.printed());
    desk.run("check --deny warnings balls/scene.rt").expect(0, &[]);
    desk.quick("balls/scene.rt").expect(0, &["scene.png"]);
    desk.run("init balls").expect(2, &["is there already"]);
    for name in ["balls/.vscode/settings.json", "balls/.vscode/tasks.json"] {
        serde_json::from_slice::<Value>(&desk.get(name)).unwrap();
    }
    assert!(desk.get("balls/.gitignore").starts_with(b"#"));
    desk.run("init ball.rt").expect(2, &["cannot write"]);
}

#[test]
fn completions_and_manual_pages_know_every_command() {
    let desk = Desk::new();
    let commands = ["build", "check", "develop", "explain", "info", "init", "completions", "man", "why"];
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = desk.run(&format!("completions {shell}"));
        assert_eq!((script.code, script.stderr.as_str()), (Some(0), ""));
        let script = script.printed();
        assert!(commands.iter().all(|command| script.contains(command)), "{shell}");
    }
    let page = desk.run("man").printed();
    assert!(page.contains(".TH RTC 1") && commands.iter().all(|command| page.contains(command)), "{page}");
    assert_eq!(desk.run("man --dir pages").code, Some(0));
    for command in commands {
        let page = String::from_utf8(desk.get(&format!("pages/rtc-{command}.1"))).unwrap();
        assert!(page.contains("SYNOPSIS"), "{command}");
    }
    assert!(!desk.get("pages/rtc.1").is_empty());
}
