//! `rtc explain`: the page on a code.

use super::args::Explain;
use super::target::print;
use super::{Exit, Problem};
use anstream::{AutoStream, ColorChoice};
use rt_lang::diagnostic::{Code, Severity};
use rt_lang::explain::{Example, Piece, Role, page, pieces};
use rt_lang::syntax::RESERVED;
use std::io::stdout;

/// Prints the page, or the list.
pub fn run(arguments: &Explain) -> Result<Exit, Problem> {
    let color = AutoStream::choice(&stdout()) != ColorChoice::Never;
    let text = match &arguments.code {
        Some(asked) => shown(page(find(asked)?), color),
        None => list(),
    };
    print(text.as_bytes())?;
    Ok(Exit::Done)
}

fn list() -> String {
    let line = |code: &Code| {
        let kind = if code.severity() == Severity::Warning { " (warning)" } else { "" };
        format!("{}  {}{kind}\n", code.as_str(), code.title())
    };
    Code::ALL.iter().map(line).collect()
}

/// The code that is asked for: as written, in small letters, by its digits, by its title, or as `@allow` names it.
fn find(asked: &str) -> Result<Code, Problem> {
    let asked = asked.trim();
    let same = |code: &&Code| {
        let name = code.as_str();
        let is_title = code.title().eq_ignore_ascii_case(asked) || code.name() == asked;
        name.eq_ignore_ascii_case(asked) || name[1..] == *asked || is_title
    };
    Code::ALL.iter().find(same).copied().ok_or_else(|| unknown(asked))
}

fn unknown(asked: &str) -> Problem {
    let problem = Problem::new(format!("no message has the code `{asked}`"));
    let upper = asked.to_uppercase();
    // What a word is in, one may have in mind; of codes, those that are one slip away, swapped digits among them.
    let about = |code: &&Code| asked.chars().count() > 3 && code.title().contains(&asked.to_lowercase());
    let near = |code: &&Code| {
        let close = strsim::osa_distance(code.as_str(), &upper) == 1;
        close || code.as_str()[1..] == upper[upper.char_indices().nth(1).map_or(upper.len(), |(at, _)| at)..]
    };
    let mut found: Vec<&Code> = Code::ALL.iter().filter(about).collect();
    if found.is_empty() && asked.len() < 20 {
        found = Code::ALL.iter().filter(near).collect();
    }
    match found.as_slice() {
        [] => problem.help("`rtc explain --list` lists all of them"),
        found => {
            let named = |code: &&Code| format!("{} ({})", code.as_str(), code.title());
            let named: Vec<String> = found.iter().take(4).map(named).collect();
            problem.help(format!("did you mean {}?", named.join(", or ")))
        }
    }
}

/// A page to be read on a terminal, in columns as they are, with colours or without.
fn shown(page: &str, color: bool) -> String {
    let mut text = String::new();
    for piece in pieces(page) {
        match piece {
            Piece::Head(head) => text.push_str(&format!("{}\n", paint(head, BOLD, color))),
            Piece::Prose(line) => text.push_str(&format!("{}\n", prose(line, color))),
            Piece::Example(example) => text.push_str(&block(&example, color)),
        }
    }
    text
}

const BOLD: &str = "1";
const DIM: &str = "2";
const RED: &str = "31";
const GREEN: &str = "32";
const YELLOW: &str = "33";
const BLUE: &str = "34";
const CYAN: &str = "36";

fn paint(text: &str, style: &str, color: bool) -> String {
    if color { format!("\u{1b}[{style}m{text}\u{1b}[0m") } else { text.to_string() }
}

/// A line of prose; between back quotes stands code.
fn prose(line: &str, color: bool) -> String {
    if !color {
        return line.to_string();
    }
    let parts = line.split('`').enumerate();
    parts.map(|(n, part)| if n % 2 == 1 { paint(part, CYAN, true) } else { part.to_string() }).collect()
}

fn block(example: &Example, color: bool) -> String {
    let mut head = match example.role {
        Some(Role::Fail) => paint("fails", RED, color),
        Some(Role::Fixed) => paint("mended", GREEN, color),
        None => String::new(),
    };
    let file = example.file.map(|name| format!("in {name}"));
    let set = example.set.iter().map(|value| format!("with --set {value}"));
    for words in file.into_iter().chain(set) {
        head.push_str(if head.is_empty() { "" } else { ", " });
        head.push_str(&words);
    }
    let lines = example.text.lines().map(|line| format!("    {}\n", highlight(line, color)));
    format!("  {head}:\n{}", lines.collect::<String>())
}

/// A line of a scene in colours.
fn highlight(line: &str, color: bool) -> String {
    if !color {
        return line.to_string();
    }
    let mut text = String::new();
    let mut rest = line;
    while let Some(first) = rest.chars().next() {
        let word = |c: char| c.is_alphanumeric() || matches!(c, '_' | '.' | '%');
        let length = match first {
            _ if rest.starts_with("//") => rest.len(),
            '"' => rest[1..].find('"').map_or(rest.len(), |end| end + 2),
            '#' | '@' => 1 + rest[1..].find(|c| !word(c)).unwrap_or(rest.len() - 1),
            _ if word(first) => rest.find(|c| !word(c)).unwrap_or(rest.len()),
            _ => first.len_utf8(),
        };
        let (token, behind) = rest.split_at(length);
        let style = match first {
            _ if token.starts_with("//") => Some(DIM),
            '"' => Some(GREEN),
            '#' | '0'..='9' => Some(CYAN),
            '@' => Some(YELLOW),
            _ if word(first) && behind.trim_start().starts_with('{') => Some(BLUE),
            _ if RESERVED.contains(&token) => Some(BOLD),
            _ => None,
        };
        text.push_str(&style.map_or(token.to_string(), |style| paint(token, style, true)));
        rest = behind;
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_found_however_they_are_written() {
        for asked in ["E0203", "e0203", "0203", "wrong dimension", "Wrong Dimension", " E0203 "] {
            assert_eq!(find(asked).unwrap(), Code::E0203, "{asked}");
        }
        let help = |asked| find(asked).unwrap_err().help.unwrap();
        assert!(help("E0230").starts_with("did you mean E0203"), "{}", help("E0230"));
        assert!(help("W0203").contains("E0203"), "{}", help("W0203"));
        assert!(help("cycle").contains("E0104"), "{}", help("cycle"));
        for nonsense in ["", "é", "xyzzy", "E", &"9".repeat(10_000)] {
            assert!(help(nonsense).contains("--list") || nonsense == "E", "{nonsense}");
        }
    }

    #[test]
    fn pages_are_plain_without_colours_and_the_same_words_with_them() {
        for &code in Code::ALL {
            let plain = shown(page(code), false);
            assert!(!plain.contains('\u{1b}') && !plain.contains("```"), "{plain}");
            let colored = shown(page(code), true);
            let stripped = anstream::adapter::strip_str(&colored).to_string();
            assert_eq!(stripped.replace('`', ""), plain.replace('`', ""));
        }
        let colored = highlight("sphere { radius: 8mm } // a ball", true);
        assert!(
            colored.contains("\u{1b}[34msphere\u{1b}[0m") && colored.contains("\u{1b}[2m// a ball"),
            "{colored}"
        );
    }
}
