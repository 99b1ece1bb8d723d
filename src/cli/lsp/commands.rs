//! What a person can have done with a document.

use super::requests::{Lane, Run};

/// Shows the picture while the document is edited.
pub const PREVIEW: &str = "rtc.startPreview";
/// Makes the picture.
pub const RENDER: &str = "rtc.render";
/// All of them.
pub const ALL: [&str; 2] = [PREVIEW, RENDER];

/// Who does them.
pub fn find(_: &str) -> Option<(Lane, Run)> {
    None
}
