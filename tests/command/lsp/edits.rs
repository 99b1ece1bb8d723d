//! However the client edits, both hold the same text.

use super::super::Desk;
use super::client::Client;
use rt_lang::Options;
use rt_lang::files::NoFiles;
use rt_lang::lower::Overrides;
use rt_lang::source::{Source, Sources};
use rt_lang::span::SourceId;
use serde_json::{Value, json};
use std::collections::BTreeSet;

/// A generator of numbers that are the same every time (Marsaglia 2003, xorshift64).
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, end: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % end as u64) as usize
    }
}

/// The lines of a text as an editor has them, without their ends.
fn lines(text: &str) -> Vec<(usize, &str)> {
    let mut lines = vec![];
    let mut start = 0;
    for (at, sign) in text.match_indices(['\n', '\r']) {
        if sign == "\n" && text[..at].ends_with('\r') {
            start = at + 1;
            continue;
        }
        lines.push((start, &text[start..at]));
        start = at + 1;
    }
    lines.push((start, &text[start..]));
    lines
}

fn units(text: &str, encoding: &str) -> usize {
    match encoding {
        "utf-8" => text.len(),
        "utf-16" => text.encode_utf16().count(),
        _ => text.chars().count(),
    }
}

/// A place in a text: its byte, and as the protocol has it.
fn place(text: &str, numbers: &mut Numbers, encoding: &str) -> (usize, Value) {
    let lines = lines(text);
    let number = numbers.below(lines.len());
    let (start, line) = lines[number];
    let at = line.floor_char_boundary(numbers.below(line.len() + 1));
    (start + at, json!({ "line": number, "character": units(&line[..at], encoding) }))
}

/// What editors put in: with characters of one to four bytes, all line ends, and things to be laid out and complained of.
const PIECES: [&str; 14] = [
    "",
    "a",
    "ß",
    "€",
    "😀",
    "\n",
    "\r\n",
    "\r",
    "// 𝄞 \n",
    "x\r\n𝄞y",
    "\n\n",
    "{ 1m }",
    "\nsphere{radius:8deg}\n",
    "\nlet  ä=1m // €\n",
];

fn some_edits(encoding: &str, seed: u64, steps: u32) {
    let desk = Desk::new();
    let mut client = Client::with(&desk, json!({ "general": { "positionEncodings": [encoding] } }));
    let mut numbers = Numbers(seed);
    let mut text = "// 😀\r\nsphere { radius: 1m }\n".to_string();
    client.open("a.rt", &text);
    for step in 1..=steps {
        let version = step as i32 + 1;
        let mut changes = vec![];
        for _ in 0..1 + numbers.below(3) {
            let (a, b) = (place(&text, &mut numbers, encoding), place(&text, &mut numbers, encoding));
            // Mostly short edits, so that the text grows, up to a length.
            let b = if text.len() < 2_000 && numbers.below(8) > 0 { a.clone() } else { b };
            let (start, end) = if a.0 <= b.0 { (a, b) } else { (b, a) };
            let piece = PIECES[numbers.below(PIECES.len())];
            changes.push(json!({ "range": { "start": start.1, "end": end.1 }, "text": piece }));
            text.replace_range(start.0..end.0, piece);
        }
        client.change("a.rt", version, Value::Array(changes));
        if step % (steps / 20) == 0 {
            same_layout(&mut client, &text, encoding);
            same_diagnostics(&mut client, &text, version, encoding);
        }
    }
    assert_eq!(client.end(), Some(0));
}

/// The edits of the server lay out the text that the client holds.
fn same_layout(client: &mut Client, text: &str, encoding: &str) {
    let params = json!({ "textDocument": { "uri": client.uri("a.rt") }, "options": { "tabSize": 2, "insertSpaces": true } });
    let edits = client.ask("textDocument/formatting", params).unwrap();
    let mut laid_out = text.to_string();
    for edit in edits.as_array().unwrap().iter().rev() {
        let byte = |place: &Value| byte(text, place, encoding);
        let range = byte(&edit["range"]["start"])..byte(&edit["range"]["end"]);
        laid_out.replace_range(range, edit["newText"].as_str().unwrap());
    }
    assert_eq!(laid_out, rt_lang::syntax::format(SourceId(0), text).0);
}

/// What the server says of its text is what there is to say of the client's.
fn same_diagnostics(client: &mut Client, text: &str, version: i32, encoding: &str) {
    let mut sources = Sources::default();
    let id = sources.add(Source::new("a.rt", text));
    let overrides = Overrides { every_camera: true, ..Overrides::default() };
    let options = Options { overrides, ..Options::default() };
    let said = rt_lang::compile(&NoFiles, &mut sources, id, &options).diagnostics;
    let wanted: BTreeSet<(String, usize, usize)> = said
        .iter()
        .map(|said| {
            (said.code.as_str().into(), said.primary.span.start as usize, said.primary.span.end as usize)
        })
        .collect();
    let told: BTreeSet<(String, usize, usize)> = client
        .diagnostics("a.rt", Some(version))
        .iter()
        .map(|told| {
            let byte = |place: &Value| byte(text, place, encoding);
            let code = told["code"].as_str().unwrap().to_string();
            (code, byte(&told["range"]["start"]), byte(&told["range"]["end"]))
        })
        .collect();
    // Of a place within a line end the protocol has only the one before it.
    let visible = |(code, start, end): (String, usize, usize)| {
        let before =
            |at: usize| if text[..at].ends_with('\r') && text[at..].starts_with('\n') { at - 1 } else { at };
        (code, before(start), before(end))
    };
    assert_eq!(told, wanted.into_iter().map(visible).collect());
}

/// The byte of a place that the server names, which is there.
fn byte(text: &str, place: &Value, encoding: &str) -> usize {
    let (start, line) = lines(text)[place["line"].as_u64().unwrap() as usize];
    let wanted = place["character"].as_u64().unwrap() as usize;
    let mut ends = (0..=line.len()).filter(|&at| line.is_char_boundary(at));
    start + ends.find(|&at| units(&line[..at], encoding) == wanted).expect("a place between characters")
}

#[test]
fn after_random_edits_in_utf_16_both_hold_the_same_text() {
    some_edits("utf-16", 0x9e37_79b9_7f4a_7c15, 5_000);
}

#[test]
fn after_random_edits_in_utf_8_both_hold_the_same_text() {
    some_edits("utf-8", 0x2545_f491_4f6c_dd1d, 5_000);
}
