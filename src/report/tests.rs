use super::*;
use crate::diagnostic::Code;
use crate::source::Source;
use crate::span::SourceId;
use std::time::{Duration, Instant};

const PLAIN: Style = Style { color: false, unicode: true, width: 80 };

fn sources(text: &str) -> (Sources, SourceId) {
    let mut sources = Sources::default();
    let id = sources.add(Source::new("stool.rt", text));
    (sources, id)
}

/// The report on a diagnostic at these bytes of a text.
fn report(text: &str, start: usize, end: usize, label: &str) -> String {
    let (sources, id) = sources(text);
    let diagnostic = Diagnostic::new(Code::E0203, "the message", Span::new(id, start, end)).at(label);
    human(&diagnostic, &sources, PLAIN)
}

#[test]
fn shows_code_place_labels_help_and_uses() {
    let (mut sources, id) = sources("part stool {\n  sphere { radius: 8deg }\n}\n");
    let garden = sources.add(Source::new("garden.rt", "\nstool left { at: 0 }\n"));
    let mut diagnostic =
        Diagnostic::new(Code::E0203, "`radius` wants a length, this is an angle", Span::new(id, 32, 36))
            .at("angle")
            .label(Span::new(id, 15, 21), "of this")
            .help("write `8mm`");
    diagnostic.uses.push(Span::new(garden, 1, 21).into());
    let expected = "\
E0203 × `radius` wants a length, this is an angle
   ╭─[stool.rt:2:20]
 2 │   sphere { radius: 8deg }
   ·   ───┬──           ──┬─
   ·      │               ╰── angle
   ·      ╰── of this
   ╰────
  help: write `8mm`
  in `stool left`, garden.rt:2:1
";
    assert_eq!(human(&diagnostic, &sources, PLAIN), expected);
    let ascii = human(&diagnostic, &sources, Style { unicode: false, ..PLAIN });
    assert!(ascii.is_ascii() && ascii.starts_with("E0203 x "), "{ascii}");
    let colored = human(&diagnostic, &sources, Style { color: true, ..PLAIN });
    assert!(colored.contains('\u{1b}') && !expected.contains('\u{1b}'));
}

#[test]
fn labels_on_lines_far_apart_have_a_frame_each() {
    let (sources, id) = sources("camera {}\n\n\n\ncamera {}\n");
    let diagnostic = Diagnostic::new(Code::E0303, "a second camera", Span::new(id, 13, 19))
        .label(Span::new(id, 0, 6), "the first");
    let expected = "\
E0303 × a second camera
   ╭─[stool.rt:1:1]
 1 │ camera {}
   · ───┬──
   ·    ╰── the first
   ╰────
   ╭─[stool.rt:5:1]
 5 │ camera {}
   · ──────
   ╰────
";
    assert_eq!(human(&diagnostic, &sources, PLAIN), expected);
}

#[test]
fn odd_places_are_shown() {
    let frame = |text: &str| text.split_once('\n').map(|(_, rest)| rest.to_string()).unwrap();
    assert_eq!(frame(&report("", 0, 0, "")), "   ╭─[stool.rt:1:1]\n 1 │ \n   · ▲\n   ╰────\n");
    assert_eq!(frame(&report("ab", 2, 2, "")), "   ╭─[stool.rt:1:3]\n 1 │ ab\n   ·   ▲\n   ╰────\n");
    assert_eq!(frame(&report("ab\n", 3, 3, "")), "   ╭─[stool.rt:2:1]\n 2 │ \n   · ▲\n   ╰────\n");
    assert_eq!(frame(&report("ab\r\ncd", 2, 4, "")), "   ╭─[stool.rt:1:3]\n 1 │ ab\n   ·   ▲\n   ╰────\n");
    assert_eq!(frame(&report("\tx", 1, 2, "")), "   ╭─[stool.rt:1:2]\n 1 │     x\n   ·     ─\n   ╰────\n");
    assert_eq!(frame(&report("灯 x", 4, 5, "")), "   ╭─[stool.rt:1:3]\n 1 │ 灯 x\n   ·    ─\n   ╰────\n");
    // A span over several lines is shown as far as its first goes; one that lies outside, at the end.
    assert_eq!(
        frame(&report("ab {\ncd\n}", 0, 9, "")),
        "   ╭─[stool.rt:1:1]\n 1 │ ab {\n   · ────\n   ╰────\n"
    );
    assert_eq!(frame(&report("ab", 7, 9, "")), "   ╭─[stool.rt:1:3]\n 1 │ ab\n   ·   ▲\n   ╰────\n");
    // Inside a character.
    assert!(report("灯", 1, 2, "lamp").contains("╰── lamp"));
}

#[test]
fn a_source_cannot_steer_the_terminal() {
    let shown = report("a\u{1b}[2J\u{202e}b \u{7}c", 10, 11, "here");
    assert!(!shown.contains(['\u{1b}', '\u{202e}', '\u{7}']), "{shown:?}");
    assert!(shown.contains("a�[2J�b �c"), "{shown}");
}

#[test]
fn a_very_long_line_is_cut_and_soon_shown() {
    let text = format!("{}HERE{}", "é".repeat(20_000_000), " tail".repeat(10_000_000));
    let (sources, id) = sources(&text);
    let start = 40_000_000;
    let diagnostic = Diagnostic::new(Code::E0001, "unexpected", Span::new(id, start, start + 4))
        .at("this")
        .label(Span::new(id, 0, 2), "far to the left")
        .label(Span::new(id, start + 4, text.len()), "all the rest");
    let begin = Instant::now();
    let shown = human(&diagnostic, &sources, PLAIN);
    assert!(begin.elapsed() < Duration::from_secs(1), "{:?}", begin.elapsed());
    assert!(shown.lines().all(|line| line.chars().count() <= 80), "{shown}");
    assert!(shown.contains("stool.rt:1:20000001]") && shown.contains("HERE"), "{shown}");
    assert!(shown.contains("far to the left") && shown.contains("all the rest"), "{shown}");
}

#[test]
fn many_diagnostics_of_a_very_long_line_are_soon_shown() {
    let (sources, id) = sources(&"x ".repeat(50_000_000));
    let at = |start| Diagnostic::new(Code::E0101, "unknown", Span::new(id, start, start + 1)).at("here");
    let many: Vec<Diagnostic> = (0..1000).map(|i| at(99_000_000 + 2 * i)).collect();
    let begin = Instant::now();
    assert!(all(&many, &sources, PLAIN).ends_with("… and 950 more\n1000 errors in stool.rt\n"));
    assert!(begin.elapsed() < Duration::from_secs(5), "{:?}", begin.elapsed());
}

#[test]
fn help_of_several_lines_keeps_them() {
    let (sources, id) = sources("x");
    let diagnostic =
        Diagnostic::new(Code::E0101, "unknown", Span::new(id, 0, 1)).help("write one of\n`a`\n`b`");
    let shown = human(&diagnostic, &sources, PLAIN);
    assert!(shown.ends_with("  help: write one of\n        `a`\n        `b`\n"), "{shown}");
}

#[test]
fn a_very_long_word_in_a_sentence_is_cut() {
    let (sources, id) = sources("x");
    let message = format!("no `{}b` is known", "a".repeat(1_000_000));
    let shown = human(&Diagnostic::new(Code::E0101, message, Span::new(id, 0, 1)), &sources, PLAIN);
    let (first, _) = shown.split_once('\n').unwrap();
    assert!(first.starts_with("E0101 × no `aaa") && first.ends_with("ab` is known"), "{first}");
    assert!(first.chars().count() < 120, "{first}");
}

#[test]
fn they_come_in_order_with_their_count() {
    let (sources, id) = sources("a b c\n");
    let at = |code, start| Diagnostic::new(code, format!("at {start}"), Span::new(id, start, start + 1));
    let text = all(&[at(Code::E0101, 4), at(Code::W0106, 0), at(Code::E0101, 2)], &sources, PLAIN);
    let order: Vec<usize> = ["at 0", "at 2", "at 4"].iter().map(|at| text.find(at).unwrap()).collect();
    assert!(order.is_sorted() && text.ends_with("\n2 errors, 1 warning in stool.rt\n"), "{text}");
    assert_eq!(all(&[], &sources, PLAIN), "");
}

#[test]
fn a_flood_is_cut_and_errors_come_through() {
    let (sources, id) = sources(&"x".repeat(1000));
    let at = |code, start| Diagnostic::new(code, format!("at {start};"), Span::new(id, start, start + 1));
    let mut many: Vec<Diagnostic> = (0..900).map(|start| at(Code::W0106, start)).collect();
    many.push(at(Code::E0101, 950));
    let text = all(&many, &sources, PLAIN);
    assert!(text.contains("at 950;") && text.contains("at 0;") && !text.contains("at 100;"), "{text}");
    assert!(text.ends_with("… and 851 more\n1 error, 900 warnings in stool.rt\n"), "{text}");
}

#[test]
fn a_chain_of_uses_is_shown_outermost_first_and_its_middle_is_left_out() {
    let text = "group a {\n  group b {\n    sphere {}\n  }\n}\n";
    let (sources, id) = sources(text);
    let at = |part: &str| {
        let start = text.find(part).unwrap();
        Span::new(id, start, start + part.len())
    };
    let mut diagnostic = Diagnostic::new(Code::E0302, "`sphere` needs `radius`", at("sphere"));
    diagnostic.uses = vec![at("group a").into(), at("group b").into()];
    let shown = human(&diagnostic, &sources, PLAIN);
    assert!(shown.ends_with("  in `group a`, stool.rt:1:1\n  in `group b`, stool.rt:2:3\n"), "{shown}");

    diagnostic.uses = (0..100).map(|n| [at("group a"), at("group b")][n % 2].into()).collect();
    let shown = human(&diagnostic, &sources, PLAIN);
    assert_eq!(shown.matches("  in `group").count(), 7, "{shown}");
    assert!(
        shown.contains("  … 93 more levels\n") && shown.contains("  in `group a`, stool.rt:1:1\n"),
        "{shown}"
    );

    diagnostic.uses = vec![at("group b").into(); 1_000_000];
    let shown = human(&diagnostic, &sources, PLAIN);
    assert!(shown.ends_with("  in `group b`, stool.rt:2:3, 1000000 levels\n"), "{shown}");
}

#[test]
fn the_same_slip_with_many_values_is_shown_a_few_times() {
    let (sources, id) = sources("sphere {}\n");
    let at = |n: usize| Diagnostic::new(Code::E0401, format!("this is {n}"), Span::new(id, 0, 6));
    let many: Vec<Diagnostic> = (0..1000).map(at).collect();
    let text = all(&many, &sources, PLAIN);
    assert!(text.contains("this is 0") && !text.contains("this is 9\n"), "{text}");
    assert!(text.contains("… 997 more of E0401 at stool.rt:1:1"), "{text}");
    assert!(text.ends_with("1000 errors in stool.rt\n"), "{text}");
}
