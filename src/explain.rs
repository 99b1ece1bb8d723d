//! The page on each diagnostic, `docs/codes/*.md`, that `rtc explain` shows.
//!
//! A page is Markdown: a head with code and title, what it means, an example that fails, its mend, and what to do.
//! The words behind the language of a code block say what it is:
//!
//! | words | the block |
//! |---|---|
//! | `rt fail` | a scene that gives exactly the page's code |
//! | `rt fixed` | the same, mended: it gives nothing |
//! | `file:NAME` | a file beside the scene, of both where neither is said; the scene itself is `scene.rt` |
//! | `set:NAME=EXPR` | is given to the command as `--set` |
//! | `build` | shows only once the picture is made |
//! | `feedback` | shows only where it is asked for, with `--feedback` |
//! | `bytes` | `\xNN` stands for a byte |
//!
//! A test runs every example.

use crate::diagnostic::Code;

macro_rules! pages {
    ($($code:ident)*) => {
        /// The page on a code, in Markdown.
        pub fn page(code: Code) -> &'static str {
            match code {
                $(Code::$code => include_str!(concat!("../docs/codes/", stringify!($code), ".md")),)*
            }
        }
    };
}

pages! {
    E0001 E0002 E0003 E0004 E0005 E0006 E0007 E0008 E0009
    E0101 E0102 E0103 E0104 W0105 W0106
    E0201 E0202 E0203 E0204 E0205 E0206 E0207
    E0301 E0302 E0303 E0304 E0305
    E0401 E0402 E0403 E0404 E0405 E0406 E0407
    E0501 E0502 E0503
    W0601 W0602 W0603 W0604 W0605 W0606 W0607 W0608 W0609
    W0701 W0702 W0703 W0704 W0705 W0706
}

/// What a page is made of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Piece<'p> {
    /// The first line, without its `#`.
    Head(&'p str),
    /// A line of prose; empty between paragraphs.
    Prose(&'p str),
    /// A block of code.
    Example(Example<'p>),
}

/// A block of code on a page.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Example<'p> {
    /// Whether it is the failing one or the mended one; none is of both.
    pub role: Option<Role>,
    /// The name of the file; none is the scene.
    pub file: Option<&'p str>,
    /// Values of `--set`.
    pub set: Vec<&'p str>,
    /// Whether it shows only once the picture is made.
    pub build: bool,
    /// Whether it is given to the command as `--feedback`.
    pub feedback: bool,
    /// Whether `\xNN` in the text stands for a byte.
    pub bytes: bool,
    /// The text, its last line end included.
    pub text: &'p str,
}

/// What an example shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// The slip.
    Fail,
    /// Its mend.
    Fixed,
}

/// Takes a page apart.
pub fn pieces(page: &str) -> Vec<Piece<'_>> {
    let mut pieces = vec![];
    let mut rest = page;
    while !rest.is_empty() {
        let (line, behind) = rest.split_once('\n').unwrap_or((rest, ""));
        rest = behind;
        pieces.push(match (line.strip_prefix("```"), line.strip_prefix("# ")) {
            (Some(words), _) => {
                let end = rest.find("```").unwrap_or(rest.len());
                let text = &rest[..end];
                rest = rest[end..].split_once('\n').map_or("", |(_, behind)| behind);
                Piece::Example(example(words, text))
            }
            (None, Some(head)) => Piece::Head(head),
            (None, None) => Piece::Prose(line),
        });
    }
    pieces
}

fn example<'p>(words: &'p str, text: &'p str) -> Example<'p> {
    let mut example = Example { text, ..Example::default() };
    for word in words.split_whitespace() {
        match word.split_once(':') {
            Some(("file", name)) => example.file = Some(name),
            Some(("set", value)) => example.set.push(value),
            _ => match word {
                "fail" => example.role = Some(Role::Fail),
                "fixed" => example.role = Some(Role::Fixed),
                "build" => example.build = true,
                "feedback" => example.feedback = true,
                "bytes" => example.bytes = true,
                _ => {}
            },
        }
    }
    example
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_page_has_its_head_and_both_examples() {
        for &code in Code::ALL {
            let pieces = pieces(page(code));
            let head = format!("{}: {}", code.as_str(), code.title());
            assert_eq!(pieces[0], Piece::Head(&head));
            for role in [Role::Fail, Role::Fixed] {
                let scenes = pieces.iter().filter(|piece| {
                    matches!(piece, Piece::Example(example) if example.role == Some(role) && example.file.is_none())
                });
                assert_eq!(scenes.count(), 1, "{} has one scene that is {role:?}", code.as_str());
            }
            let prose = pieces.iter().filter(|piece| matches!(piece, Piece::Prose(line) if !line.is_empty()));
            assert!(prose.count() >= 2, "{} says little", code.as_str());
        }
    }

    #[test]
    fn blocks_are_taken_apart() {
        let page = "# A: b\n\nWords.\n```rt fail set:n=3 file:a.rt\nx\ny\n```\n```rt fixed build bytes\n```";
        let fail = Example {
            role: Some(Role::Fail),
            file: Some("a.rt"),
            set: vec!["n=3"],
            text: "x\ny\n",
            ..Example::default()
        };
        let fixed = Example { role: Some(Role::Fixed), build: true, bytes: true, ..Example::default() };
        let found = pieces(page);
        let wanted = [
            Piece::Head("A: b"),
            Piece::Prose(""),
            Piece::Prose("Words."),
            Piece::Example(fail),
            Piece::Example(fixed),
        ];
        assert_eq!(found, wanted);
    }
}
