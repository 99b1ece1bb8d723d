//! Addresses of files, and the files themselves.
//!
//! A client may write one address in several ways, so files are told apart by their paths.

use std::fmt::Write;
use std::path::{Path, PathBuf};

/// The path of an address that begins with `file:`; none of another, or of one on another machine.
pub fn path_of(uri: &str) -> Option<PathBuf> {
    let (scheme, rest) = uri.split_once(':')?;
    if !scheme.eq_ignore_ascii_case("file") {
        return None;
    }
    let rest = rest.split(['?', '#']).next()?;
    let path = match rest.strip_prefix("//") {
        Some(rest) => {
            let (host, path) = rest.split_at(rest.find('/')?);
            (host.is_empty() || host.eq_ignore_ascii_case("localhost")).then_some(path)?
        }
        None => rest,
    };
    to_path(decoded(path))
}

/// The address of an absolute path.
pub fn uri_of(path: &Path) -> String {
    let mut uri = "file://".to_string();
    let bytes = path.as_os_str().as_encoded_bytes();
    if bytes.first() != Some(&b'/') {
        // A drive.
        uri.push('/');
    }
    for &byte in bytes {
        match byte {
            b'\\' if cfg!(windows) => uri.push('/'),
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'.' | b'_' | b'~' | b'/' => {
                uri.push(byte.into())
            }
            _ => {
                let _ = write!(uri, "%{byte:02X}");
            }
        }
    }
    uri
}

/// The bytes that `%XX` stands for; what is no such thing stays as it is.
fn decoded(text: &str) -> Vec<u8> {
    let digit = |byte: Option<&u8>| byte.and_then(|byte| (*byte as char).to_digit(16));
    let bytes = text.as_bytes();
    let mut decoded = Vec::with_capacity(bytes.len());
    let mut at = 0;
    while at < bytes.len() {
        let value = digit(bytes.get(at + 1)).zip(digit(bytes.get(at + 2)));
        match value.filter(|_| bytes[at] == b'%') {
            Some((high, low)) => {
                decoded.push((16 * high + low) as u8);
                at += 3;
            }
            None => {
                decoded.push(bytes[at]);
                at += 1;
            }
        }
    }
    decoded
}

#[cfg(unix)]
fn to_path(bytes: Vec<u8>) -> Option<PathBuf> {
    use std::os::unix::ffi::OsStringExt;
    let path = PathBuf::from(std::ffi::OsString::from_vec(bytes));
    path.is_absolute().then_some(path)
}

#[cfg(not(unix))]
fn to_path(bytes: Vec<u8>) -> Option<PathBuf> {
    let text = String::from_utf8(bytes).ok()?;
    let path = PathBuf::from(text.strip_prefix('/').unwrap_or(&text));
    path.is_absolute().then_some(path)
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_for_a_path_leads_to_it() {
        for path in ["/a.rt", "/a b/é#?%20.rt", "/C:/x", "/😀"] {
            assert_eq!(path_of(&uri_of(Path::new(path))).as_deref(), Some(Path::new(path)));
        }
        assert_eq!(uri_of(Path::new("/a b/ä.rt")), "file:///a%20b/%C3%A4.rt");
    }

    #[test]
    fn addresses_are_read_however_they_are_written() {
        let path = |uri| path_of(uri).map(|path| path.display().to_string());
        for uri in ["file:///a%3ab.rt", "file:///a:b.rt", "FILE://localhost/a:b.rt", "file:/a:b.rt#4"] {
            assert_eq!(path(uri).as_deref(), Some("/a:b.rt"), "{uri}");
        }
        assert_eq!(path("file:///100%.rt").as_deref(), Some("/100%.rt"));
        for none in ["untitled:Untitled-1", "file://host/a.rt", "file:a.rt", "a.rt", "file://", ""] {
            assert_eq!(path(none), None, "{none}");
        }
    }
}
