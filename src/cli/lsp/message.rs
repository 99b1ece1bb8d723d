//! The body of a message: JSON to what is asked.
//!
//! A body of a few megabytes can hold values that take a hundred times as much as numbers and lists of their own, so they
//! are counted before they are made.

use lsp_server::{ErrorCode, Message, Notification, Request, Response};
use serde_json::{Value, json};

/// The most values of one message. Even a completion of thousands of items has fewer.
const MOST_VALUES: usize = 1_000_000;

/// Why a body is no message, and to whom that is said.
#[derive(Debug, PartialEq)]
pub struct Refusal {
    /// The id of the request, as far as it could be read.
    id: Value,
    code: i32,
    message: String,
}

impl Refusal {
    fn new(id: Value, code: ErrorCode, message: impl Into<String>) -> Refusal {
        Refusal { id, code: code as i32, message: message.into() }
    }

    /// For what is no text that could be read.
    pub fn unreadable(message: impl Into<String>) -> Refusal {
        Refusal::new(Value::Null, ErrorCode::ParseError, message)
    }

    /// The answer.
    pub fn body(&self) -> Vec<u8> {
        let error = json!({ "code": self.code, "message": self.message });
        json!({ "jsonrpc": "2.0", "id": self.id, "error": error }).to_string().into_bytes()
    }
}

/// Reads a body.
pub fn read(body: &[u8]) -> Result<Message, Refusal> {
    if values(body) > MOST_VALUES {
        return Err(Refusal::unreadable(format!("a message has at most {MOST_VALUES} values")));
    }
    let value = serde_json::from_slice(body).or_else(|error| match paired(body) {
        Some(body) => serde_json::from_slice(&body),
        None => Err(error),
    });
    let value: Value = value.map_err(|error| Refusal::unreadable(format!("this is no JSON: {error}")))?;
    let invalid = |id: Value, what: &str| Err(Refusal::new(id, ErrorCode::InvalidRequest, what));
    let Value::Object(mut fields) = value else {
        return invalid(Value::Null, "a message is an object");
    };
    let id = fields.remove("id");
    let params = fields.remove("params").unwrap_or_default();
    match (fields.remove("method"), id) {
        (Some(Value::String(method)), None) => Ok(Notification { method, params }.into()),
        (Some(Value::String(method)), Some(id)) => match serde_json::from_value(id.clone()) {
            Ok(id) => Ok(Request { id, method, params }.into()),
            Err(_) => invalid(id, "an id is a whole number of 32 bits or a string"),
        },
        (Some(_), id) => invalid(id.unwrap_or_default(), "a method is a string"),
        (None, Some(id)) if fields.contains_key("result") || fields.contains_key("error") => {
            fields.insert("id".into(), id);
            match serde_json::from_value::<Response>(Value::Object(fields)) {
                Ok(response) => Ok(response.into()),
                Err(_) => invalid(Value::Null, "this is no answer to anything"),
            }
        }
        (None, id) => invalid(id.unwrap_or_default(), "a message has a method"),
    }
}

/// What to send for a message.
pub fn body(message: &Message) -> Vec<u8> {
    // Maps with keys that are no strings are what JSON cannot hold, and no message has them.
    let mut value = serde_json::to_value(message).unwrap_or_default();
    value["jsonrpc"] = "2.0".into();
    value.to_string().into_bytes()
}

/// The same text without halves of characters: editors that count in units of 16 bits may send one, and a text is held in whole
/// characters. In its place comes a character of one unit, so that what is behind stays where it is. None where there is no
/// such half.
fn paired(body: &[u8]) -> Option<Vec<u8>> {
    let unit = |at: usize| {
        let digits = body.get(at..at + 6)?.strip_prefix(b"\\u")?;
        u16::from_str_radix(std::str::from_utf8(digits).ok()?, 16).ok()
    };
    let (mut mended, mut at) = (None, 0);
    while at < body.len() {
        at += match (body[at], unit(at)) {
            (b'\\', Some(0xd800..0xdc00)) if matches!(unit(at + 6), Some(0xdc00..0xe000)) => 12,
            (b'\\', Some(0xd800..0xe000)) => {
                mended.get_or_insert_with(|| body.to_vec())[at..at + 6].copy_from_slice(b"\\ufffd");
                6
            }
            // Whatever it escapes.
            (b'\\', _) => 2,
            _ => 1,
        };
    }
    mended
}

/// About how many values a text of JSON makes: never fewer.
fn values(body: &[u8]) -> usize {
    let (mut count, mut inside, mut escaped) = (1, false, false);
    for &byte in body {
        match byte {
            _ if escaped => escaped = false,
            b'\\' => escaped = inside,
            b'"' => inside = !inside,
            b',' | b'[' | b'{' if !inside => count += 1,
            _ => {}
        }
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    fn code(body: &str) -> (i32, Value) {
        let refusal = read(body.as_bytes()).unwrap_err();
        (refusal.code, refusal.id)
    }

    #[test]
    fn what_is_no_message_is_refused_by_its_id() {
        let invalid = ErrorCode::InvalidRequest as i32;
        for text in ["", "{", "\u{0}", "nonsense", &"[".repeat(1000)] {
            assert_eq!(code(text), (ErrorCode::ParseError as i32, Value::Null), "{text}");
        }
        assert_eq!(read(b"\xff").unwrap_err().code, ErrorCode::ParseError as i32);
        for text in ["[]", "3", "{}", r#"[{"id":1,"method":"a"}]"#] {
            assert_eq!(code(text), (invalid, Value::Null), "{text}");
        }
        assert_eq!(code(r#"{"id":7}"#), (invalid, json!(7)));
        assert_eq!(code(r#"{"id":7,"method":3}"#), (invalid, json!(7)));
        assert_eq!(code(r#"{"id":1.5,"method":"a"}"#), (invalid, json!(1.5)));
        assert_eq!(code(r#"{"id":99999999999,"method":"a"}"#), (invalid, json!(99_999_999_999_u64)));
    }

    #[test]
    fn values_are_counted_before_they_are_made() {
        let many = format!(r#"{{"method":"a","params":[{}0]}}"#, "0,".repeat(MOST_VALUES));
        assert_eq!(code(&many).0, ErrorCode::ParseError as i32);
        let text = format!(r#"{{"method":"a","params":"{}\",,"}}"#, ",[{".repeat(MOST_VALUES));
        assert!(read(text.as_bytes()).is_ok());
    }

    #[test]
    fn half_a_character_keeps_its_place() {
        for (text, read_as) in [
            (r"a\ud83d", "a\u{fffd}"),
            (r"\ude00b", "\u{fffd}b"),
            (r"\ud83d\ud83d\ude00\uDE00", "\u{fffd}😀\u{fffd}"),
            (r"\ud83d\n\\ude00\ud83d", "\u{fffd}\n\\ude00\u{fffd}"),
        ] {
            let body = format!(r#"{{"method":"{text}"}}"#);
            let Ok(Message::Notification(read)) = read(body.as_bytes()) else { panic!("{text}") };
            assert_eq!(read.method, read_as);
        }
        assert_eq!(code(r#"{"method":"\ud83d"#).0, ErrorCode::ParseError as i32);
        assert_eq!(code(r#"{"method":"\ud8"}"#).0, ErrorCode::ParseError as i32);
    }

    #[test]
    fn messages_are_told_apart() {
        let kind = |text: &str| match read(text.as_bytes()).unwrap() {
            Message::Request(request) => format!("request {} {}", request.id, request.params),
            Message::Response(response) => format!("response {}", response.id),
            Message::Notification(notification) => format!("notification {}", notification.method),
        };
        assert_eq!(kind(r#"{"id":"x","method":"a","params":null}"#), "request \"x\" null");
        assert_eq!(kind(r#"{"id":4,"result":null}"#), "response 4");
        assert_eq!(kind(r#"{"id":4,"error":{"code":1,"message":""}}"#), "response 4");
        assert_eq!(kind(r#"{"method":"a"}"#), "notification a");
    }
}
