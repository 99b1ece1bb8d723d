//! What a page may say, as JSON.

use serde::Deserialize;

/// The most bytes of one message.
pub const MOST_BYTES: usize = 64 << 10;

/// A message of a page.
#[derive(Debug, PartialEq, Deserialize)]
#[serde(tag = "type", rename_all = "lowercase", deny_unknown_fields)]
pub enum Heard {
    /// A param is to have this value, or with an empty one the file's own.
    Set {
        /// The param.
        name: String,
        /// An expression.
        value: String,
    },
    /// The value of a param is to be written into the file.
    Write {
        /// Names the answer.
        id: u32,
        /// The param.
        name: String,
    },
    /// This window is to be traced first.
    Crop {
        /// Left, top, width and height in pixels.
        window: Option<[u32; 4]>,
    },
    /// Paths are to wait, or to go on.
    Pause {
        /// To wait.
        on: bool,
    },
    /// Why does this pixel look so?
    Why {
        /// Names the answer.
        id: u32,
        /// Column.
        x: u32,
        /// Row.
        y: u32,
        /// Whether to take all samples that there are, and not only what can be told at once.
        #[serde(default)]
        patient: bool,
    },
    /// Which pixels show what stands here?
    Light {
        /// Names the answer.
        id: u32,
        /// The file, as places name it.
        file: String,
        /// From 1.
        line: u32,
        /// From 1; 0 is the line's first word.
        column: u32,
    },
    /// This place is to be opened in the editor.
    Open {
        /// The file, as places name it.
        file: String,
        /// From 1.
        line: u32,
        /// From 1.
        column: u32,
    },
}

/// Understands a message, or says why not.
pub fn read(text: &str) -> Result<Heard, String> {
    serde_json::from_str(text).map_err(|error| format!("not understood: {error}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_page_says_is_understood() {
        let set = Heard::Set { name: "n".into(), value: "12".into() };
        assert_eq!(read(r#"{"type":"set","name":"n","value":"12"}"#), Ok(set));
        assert_eq!(read(r#"{"type":"crop","window":null}"#), Ok(Heard::Crop { window: None }));
        assert_eq!(
            read(r#"{"type":"why","x":1,"y":2,"id":3}"#),
            Ok(Heard::Why { id: 3, x: 1, y: 2, patient: false })
        );
    }

    #[test]
    fn anything_else_is_refused() {
        let deep = "[".repeat(10_000);
        for text in
            ["", "{}", "7", "null", r#"{"type":"halt"}"#, r#"{"type":"why","id":1,"x":-1,"y":0}"#, &deep]
        {
            assert!(read(text).is_err(), "{text}");
        }
        assert!(read(r#"{"type":"pause","on":true,"x":1}"#).is_err());
        assert!(read(r#"{"type":"crop","window":[1,2,3,4,5]}"#).is_err());
    }
}
