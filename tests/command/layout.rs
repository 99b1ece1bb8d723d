//! `rtc fmt`: files, standard input, what `--check` and `--diff` say, and how it ends.

use super::Desk;

/// A scene that is not laid out so, and what becomes of it.
const LOOSE: &str = "// keep me\nsphere{radius:1m}\n";
const NEAT: &str = "// keep me\nsphere { radius: 1m }\n";

fn text(bytes: Vec<u8>) -> String {
    String::from_utf8(bytes).unwrap()
}

#[test]
fn files_are_laid_out_in_place_and_stay_so() {
    let desk = Desk::new();
    desk.put("loose.rt", LOOSE);
    desk.run("fmt loose.rt ball.rt").expect(0, &[]);
    assert_eq!(text(desk.get("loose.rt")), NEAT);
    assert_eq!(text(desk.get("ball.rt")), super::BALL);
    desk.run("fmt loose.rt").expect(0, &[]);
    assert_eq!(text(desk.get("loose.rt")), NEAT);
    assert_eq!(desk.names(), ["ball.rt", "loose.rt"]);
}

#[test]
fn standard_input_goes_to_standard_output() {
    let desk = Desk::new();
    desk.put("loose.rt", LOOSE);
    let ended = desk.feed("fmt -", "loose.rt");
    assert_eq!((ended.code, ended.stderr.as_str()), (Some(0), ""));
    assert_eq!(text(ended.stdout), NEAT);
    assert_eq!(text(desk.get("loose.rt")), LOOSE);
}

#[test]
fn check_and_diff_write_nothing() {
    let desk = Desk::new();
    desk.put("loose.rt", LOOSE);
    let checked = desk.run("fmt --check loose.rt ball.rt");
    assert_eq!((checked.code, text(checked.stdout).as_str()), (Some(1), "loose.rt\n"));
    desk.run("fmt --check ball.rt").expect(0, &[]);
    let shown = desk.run("fmt --diff loose.rt ball.rt");
    assert_eq!((shown.code, shown.stderr.as_str()), (Some(0), ""));
    let expected = "--- loose.rt\n+++ loose.rt\n@@ -1,2 +1,2 @@\n // keep me\n-sphere{radius:1m}\n+sphere { radius: 1m }\n";
    assert_eq!(text(shown.stdout), expected);
    assert_eq!(desk.run("fmt --check --diff loose.rt").code, Some(1));
    assert_eq!(text(desk.get("loose.rt")), LOOSE);
}

#[test]
fn lines_are_laid_out_alone() {
    let desk = Desk::new();
    let loose = "group {\n    sphere{radius:1m}\n    plane{}\n}\nlet a=1\n";
    for (lines, expected) in [
        ("2:2", "group {\n  sphere { radius: 1m }\n    plane{}\n}\nlet a=1\n"),
        ("3:99", "group {\n    sphere{radius:1m}\n  plane {}\n}\nlet a = 1\n"),
        ("4:4", loose),
        ("9:9", loose),
        ("1:18446744073709551615", "group {\n  sphere { radius: 1m }\n  plane {}\n}\nlet a = 1\n"),
    ] {
        desk.put("loose.rt", loose);
        desk.run(&format!("fmt --lines {lines} loose.rt")).expect(0, &[]);
        assert_eq!(text(desk.get("loose.rt")), expected, "{lines}");
    }
    desk.put("loose.rt", loose);
    let shown = desk.run("fmt --lines 5:5 --diff loose.rt");
    assert!(text(shown.stdout).ends_with("\n }\n-let a=1\n+let a = 1\n"));
    for wrong in ["0:1", "2:1", "2", "a:b", "1:", ":"] {
        desk.run(&format!("fmt --lines {wrong} loose.rt")).expect(2, &["such as 3:7"]);
    }
}

#[test]
fn what_is_broken_stays_as_it_is() {
    let desk = Desk::new();
    let broken = "sphere{radius:1m}\nsphere{radius 8 }\n";
    desk.put("broken.rt", broken);
    desk.put("loose.rt", LOOSE);
    desk.run("fmt broken.rt loose.rt").expect(1, &["E0005"]);
    assert_eq!(text(desk.get("broken.rt")), "sphere { radius: 1m }\nsphere{radius 8 }\n");
    assert_eq!(text(desk.get("loose.rt")), NEAT);
    desk.put("bytes.rt", b"sphere { \xFF }");
    desk.run("fmt bytes.rt").expect(1, &["E0009"]);
    assert_eq!(desk.get("bytes.rt"), b"sphere { \xFF }");
    desk.run("fmt missing.rt ball.rt").expect(2, &["missing.rt"]);
    desk.run("fmt").expect(2, &["FILE"]);
}
