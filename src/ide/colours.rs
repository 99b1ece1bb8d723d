//! Colours as they are written, and how another would be.

use super::{Analysis, Colour};

/// The colours that are written in the text.
pub(super) fn colours(_: &Analysis) -> Vec<Colour> {
    vec![]
}

/// The ways to write a colour in place of the one that stands there as `written`, each to replace all of it: in its own form first.
/// Red, green and blue are display-referred, from 0 to 1.
pub fn present(written: &str, value: [f64; 3]) -> Vec<String> {
    let _ = written;
    let byte = |x: f64| (x.clamp(0.0, 1.0) * 255.0).round() as u8;
    let [r, g, b] = value.map(byte);
    vec![format!("#{r:02x}{g:02x}{b:02x}")]
}
