//! A page of the preview that does what it is told.

use super::client::PATIENCE;
use serde_json::Value;
use std::io::{Read, Write};
use std::net::TcpStream;

/// Host, with port, and path of an address.
pub fn parts(url: &str) -> (&str, &str) {
    let rest = url.strip_prefix("http://").unwrap();
    rest.split_at(rest.find('/').unwrap())
}

/// What is at an address: the body of the answer, if there is one.
pub fn get(url: &str) -> Option<Vec<u8>> {
    let (host, path) = parts(url);
    let mut stream = TcpStream::connect(host).unwrap();
    write!(stream, "GET {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n").unwrap();
    let mut answer = vec![];
    stream.read_to_end(&mut answer).unwrap();
    let body = answer.windows(4).position(|end| end == b"\r\n\r\n").unwrap() + 4;
    answer.starts_with(b"HTTP/1.1 200").then(|| answer[body..].to_vec())
}

/// The talk of a page, by the letter (RFC 6455).
pub struct Page {
    stream: TcpStream,
}

impl Page {
    pub fn new(url: &str) -> Page {
        let (host, path) = parts(url);
        let mut stream = TcpStream::connect(host).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        write!(
            stream,
            "GET {path}socket HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n\
             Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n"
        )
        .unwrap();
        let mut head = vec![];
        while !head.ends_with(b"\r\n\r\n") {
            let mut byte = [0];
            stream.read_exact(&mut byte).unwrap();
            head.extend(byte);
        }
        assert!(head.starts_with(b"HTTP/1.1 101"), "{}", String::from_utf8_lossy(&head));
        Page { stream }
    }

    /// Sends a short text; its mask changes nothing.
    pub fn say(&mut self, message: &Value) {
        let text = message.to_string();
        let length = u16::try_from(text.len()).unwrap().to_be_bytes();
        self.stream.write_all(&[0x81, 0x80 | 126, length[0], length[1], 0, 0, 0, 0]).unwrap();
        self.stream.write_all(text.as_bytes()).unwrap();
    }

    /// Waits for a text, and passes over all else.
    pub fn wait(&mut self, wanted: impl Fn(&Value) -> bool) -> Value {
        loop {
            let [first, second] = self.take();
            let length = match second {
                126 => u16::from_be_bytes(self.take()).into(),
                127 => u64::from_be_bytes(self.take()),
                short => short.into(),
            };
            let mut body = vec![0; length as usize];
            self.stream.read_exact(&mut body).unwrap();
            let message = serde_json::from_slice(&body).unwrap_or_default();
            if first == 0x81 && wanted(&message) {
                return message;
            }
        }
    }

    /// Waits until nobody talks any more.
    pub fn wait_for_end(&mut self) {
        let mut bytes = [0; 4096];
        // A connection that is reset has ended too.
        while self.stream.read(&mut bytes).is_ok_and(|read| read > 0) {}
    }

    fn take<const N: usize>(&mut self) -> [u8; N] {
        let mut bytes = [0; N];
        self.stream.read_exact(&mut bytes).unwrap();
        bytes
    }
}
