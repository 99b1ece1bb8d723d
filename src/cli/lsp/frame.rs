//! Messages on a stream of bytes: a head with the length, an empty line, the body.
//!
//! Whatever comes in, a message behind it is found: a body that is too long is passed over, a head without a length is left
//! behind, and a line that never ends is not kept. A body whose length was wrong may end in the middle of a line, so the name
//! of the length is looked for anywhere in one: the last one counts.

use std::io::{self, BufRead, Read, Write};

/// The longest body, in bytes: a text of 10 MB with room for what JSON makes of it, several times over.
pub const MOST_BODY: u64 = 64 << 20;
/// The most of a line that is looked at at once, in bytes.
const MOST_LINE: u64 = 4096;
/// What stands before the length, in small letters.
const LENGTH: &[u8] = b"content-length:";

/// What stands next on a stream.
#[derive(Debug, PartialEq, Eq)]
pub enum Frame {
    /// The body of a message.
    Body(Vec<u8>),
    /// A head that tells no length, and why.
    Refused(String),
    /// A message that was passed over, and its length.
    TooLong(u64),
}

/// The next message; none where the stream has ended, also within a message.
///
/// # Errors
///
/// Where the stream cannot be read.
pub fn read(input: &mut impl BufRead) -> io::Result<Option<Frame>> {
    let Some(length) = head(input)? else { return Ok(None) };
    let length = match length {
        Ok(length) if length <= MOST_BODY => length,
        Ok(length) => {
            let passed = io::copy(&mut input.take(length), &mut io::sink())?;
            return Ok((passed == length).then_some(Frame::TooLong(length)));
        }
        Err(reason) => return Ok(Some(Frame::Refused(reason))),
    };
    let mut body = vec![];
    input.take(length).read_to_end(&mut body)?;
    Ok((body.len() as u64 == length).then_some(Frame::Body(body)))
}

/// The length that a head gives, or why it gives none.
fn head(input: &mut impl BufRead) -> io::Result<Option<Result<u64, String>>> {
    let mut length = Err("a message begins with its `Content-Length`".to_string());
    let mut begun = false;
    loop {
        match line(input)? {
            None => return Ok(None),
            Some(Line::Empty) if begun => return Ok(Some(length)),
            // Line ends between messages do no harm.
            Some(Line::Empty) => {}
            Some(Line::Other) => begun = true,
            Some(Line::Length(value)) => {
                begun = true;
                let value = String::from_utf8_lossy(value.trim_ascii());
                length = value.parse().map_err(|_| format!("`{value}` is no length"));
            }
        }
    }
}

/// A line of a head.
enum Line {
    /// Nothing but spaces.
    Empty,
    /// What stands behind the name of the length.
    Length(Vec<u8>),
    Other,
}

/// The next line; none at the end of the stream.
fn line(input: &mut impl BufRead) -> io::Result<Option<Line>> {
    let (mut is_empty, mut length) = (true, None);
    // What a name may have begun in before more is read.
    let mut part = vec![];
    loop {
        let kept = part.len();
        input.take(MOST_LINE).read_until(b'\n', &mut part)?;
        let ends = part.ends_with(b"\n");
        if !ends && ((part.len() - kept) as u64) < MOST_LINE {
            return Ok(None);
        }
        is_empty &= part.trim_ascii().is_empty();
        match part.windows(LENGTH.len()).rposition(|name| name.eq_ignore_ascii_case(LENGTH)) {
            Some(at) => length = Some(part[at + LENGTH.len()..].to_vec()),
            // A number with so much behind it is none.
            None => length
                .iter_mut()
                .filter(|value| (value.len() as u64) < MOST_LINE)
                .for_each(|value| value.extend(&part[kept..])),
        }
        if ends {
            return Ok(Some(match length {
                Some(value) => Line::Length(value),
                None if is_empty => Line::Empty,
                None => Line::Other,
            }));
        }
        part.drain(..part.len().saturating_sub(LENGTH.len() - 1));
    }
}

/// Writes a message.
///
/// # Errors
///
/// Where the stream cannot be written.
pub fn write(output: &mut impl Write, body: &[u8]) -> io::Result<()> {
    write!(output, "Content-Length: {}\r\n\r\n", body.len())?;
    output.write_all(body)?;
    output.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(bytes: &[u8]) -> Vec<Frame> {
        let mut input = bytes;
        std::iter::from_fn(|| read(&mut input).unwrap()).collect()
    }

    fn body(text: &str) -> Frame {
        Frame::Body(text.into())
    }

    #[test]
    fn messages_follow_each_other() {
        let mut bytes = vec![];
        write(&mut bytes, b"one").unwrap();
        write(&mut bytes, b"").unwrap();
        bytes.extend(b"content-length:3\nContent-Type: x\r\n\r\ntwo");
        assert_eq!(all(&bytes), [body("one"), body(""), body("two")]);
    }

    #[test]
    fn behind_a_bad_head_the_next_message_is_found() {
        for bad in ["Content-Length: -1\r\n\r\n", "Content-Length: 1e3\r\n\r\n", "Hello\r\n\r\n", ": :\n\n"] {
            let bytes = format!("{bad}Content-Length: 2\r\n\r\nok");
            let frames = all(bytes.as_bytes());
            assert!(matches!(frames[0], Frame::Refused(_)), "{bad}");
            assert_eq!(frames[1], body("ok"), "{bad}");
        }
    }

    #[test]
    fn behind_a_body_of_another_length_the_next_message_is_found() {
        let long = "x".repeat(10_000);
        for bad in ["Content-Length: 1e3\r\n\r\n{\"a\": 1}", "Content-Length: 3\r\n\r\n{\"a\"", &long] {
            // Wherever the name stands between what is read at once and what is read next.
            for more in 0..40 {
                let bytes =
                    format!("{bad}{}content-LENGTH: 2\r\n\r\nok", " ".repeat(more + 4050 * (more % 2)));
                assert_eq!(all(bytes.as_bytes()).last(), Some(&body("ok")), "{bad:.30} {more}");
            }
        }
        let twice = format!("Content-Length: 9{long}Content-Length: 2\r\n\r\nok");
        assert_eq!(all(twice.as_bytes()), [body("ok")]);
    }

    #[test]
    fn a_long_line_is_not_kept() {
        let bytes = [&[b'x'; 1_000_000][..], b"\nContent-Length: 2\r\n\r\nok"].concat();
        assert_eq!(all(&bytes), [body("ok")]);
        let spaces = [&[b'x'; 1_000][..], &[b' '; 10_000], b"\nContent-Length: 2\r\n\r\nok"].concat();
        assert_eq!(all(&spaces), [body("ok")]);
    }

    #[test]
    fn a_long_body_is_passed_over() {
        let long = io::repeat(b' ').take(MOST_BODY + 1);
        let head = format!("Content-Length: {}\r\n\r\n", MOST_BODY + 1);
        let mut input =
            io::BufReader::new(head.as_bytes().chain(long).chain(&b"Content-Length: 2\r\n\r\nok"[..]));
        assert_eq!(read(&mut input).unwrap(), Some(Frame::TooLong(MOST_BODY + 1)));
        assert_eq!(read(&mut input).unwrap(), Some(body("ok")));
    }

    #[test]
    fn a_stream_may_end_anywhere() {
        let bytes = b"Content-Length: 2\r\n\r\nok";
        for end in 0..bytes.len() {
            assert_eq!(all(&bytes[..end]), [], "{end}");
        }
        assert_eq!(all(b"Content-Length: 18446744073709551615\r\n\r\n{}"), []);
    }
}
