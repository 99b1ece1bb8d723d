//! What a file says of the samples in it, before they are read.

use super::{
    CHANNELS, CHECKSUM, EARLY_CHANNELS, FORM, JUDGED, PREFIX, PROGRAM, Refused, SCALE, SHARE, START, Share,
    Subject, VERSION, channels, judged_from, refused, unreadable,
};
use crate::output::{self, Facts, Frame, decode_head};
use crate::render::film::MOST_SAMPLES;
use crate::render::{Shown, Window};
use crate::scene::identity::Identity;

/// The head of a file of sums. Nothing tells yet that they are whole.
#[derive(Clone, Debug, PartialEq)]
pub struct Head {
    /// What they are of.
    pub subject: Subject,
    /// How the picture came about.
    pub facts: Facts,
    pub(super) window: Window,
    /// The number of the first sample.
    pub(super) start: u32,
    pub(super) scale: f64,
    pub(super) judged: Option<Shown>,
    /// The attributes that the checksum is of.
    pub(super) texts: Vec<(String, String)>,
    pub(super) checksum: Option<String>,
}

impl Head {
    /// Whether a file is one of sums, in whatever form and whether it can be used or not, by its first bytes; else what it is.
    pub fn recognize(file: &[u8]) -> Result<(), Refused> {
        of_sums(file).map(drop)
    }

    /// More bytes than a file with this head has, whose numbers take as much as they can.
    pub fn most_bytes(&self) -> u64 {
        // What stands beside them is at most the picture's own channels, and where its lines begin.
        const BESIDE: usize = 6;
        const TEXTS: usize = 1 << 20;
        let values = CHANNELS.len() + EARLY_CHANNELS.len() + BESIDE;
        (TEXTS + self.window.pixels() * size_of::<f32>() * values) as u64
    }

    /// Reads the head of a file, for which its first bytes do.
    pub fn decode(file: &[u8]) -> Result<Head, Refused> {
        let (head, form) = of_sums(file)?;
        if form != VERSION {
            let form: String = form.escape_debug().take(8).collect();
            let other =
                format!("holds its sums in form {form}, and this version of rtc reads form {VERSION} alone");
            return refused(format!("{other}: only the version that wrote it can use it"));
        }
        if !has_channels(&head) {
            return refused("has other channels than those of exact sums");
        }
        let text = |name: &str| text(&head, name);
        let program = text(PROGRAM).map(str::to_string);
        let identity = Identity::from_values(|name| text(&format!("{PREFIX}{name}")).map(str::to_string));
        let share = text(SHARE).map(|text| Share::parse(text).ok_or(())).transpose();
        let start = text(START).and_then(|text| text.parse().ok()).filter(|start| *start <= MOST_SAMPLES);
        let scale = text(SCALE).and_then(|text| text.parse().ok());
        let judged = text(JUDGED).map(|words| judged_from(words).ok_or(())).transpose();
        let (Some(program), Some(identity), Ok(share), Some(start), Some(scale), Ok(judged)) =
            (program, identity, share, start, scale, judged)
        else {
            return refused("does not say what it is of");
        };
        let Some(window) = window(head.frame, &identity) else {
            return refused("has its pixels elsewhere than in the crop that it says");
        };
        let checksum = text(CHECKSUM).map(str::to_string);
        let own = |(name, _): &(String, String)| name.starts_with(PREFIX) && name != CHECKSUM;
        let texts = head.texts.iter().filter(|text| own(text)).cloned().collect();
        let subject = Subject { program, identity, share };
        Ok(Head { subject, facts: head.facts, window, start, scale, judged, texts, checksum })
    }
}

/// The head of a file of sums, and their form.
fn of_sums(file: &[u8]) -> Result<(output::Head, String), Refused> {
    let head = decode_head(file).map_err(|reason| unreadable(file, reason))?;
    match text(&head, FORM).map(str::to_string) {
        Some(form) => Ok((head, form)),
        None => refused("is a picture alone: it holds no exact sums, as checkpoints and shares do"),
    }
}

/// The value of an attribute.
fn text<'h>(head: &'h output::Head, name: &str) -> Option<&'h str> {
    head.texts.iter().find(|(known, _)| known == name).map(|(_, value)| value.as_str())
}

/// Whether it has the channels of sums, each once, maybe those of the first samples too, and beside them no more than those of
/// the picture.
fn has_channels(head: &output::Head) -> bool {
    let mut words: Vec<&str> = head.words.iter().map(String::as_str).collect();
    words.sort_unstable();
    let mut expected: Vec<&str> = channels().take(words.len()).collect();
    expected.sort_unstable();
    let colors = ["R", "G", "B", "A"];
    [CHANNELS.len(), CHANNELS.len() + EARLY_CHANNELS.len()].contains(&words.len())
        && words == expected
        && head.others.len() <= colors.len()
        && head.others.iter().all(|name| colors.contains(&name.as_str()))
}

/// The window in which the pixels lie, if it is the one that the samples are of.
fn window(frame: Frame, identity: &Identity) -> Option<Window> {
    let Frame { size: [width, height], offset: [x, y], whole } = frame;
    let ends = |start: u32, length: u32, most: u32| start.checked_add(length).is_some_and(|end| end <= most);
    let lies = whole == identity.size() && identity.crop() == Some([x, y, width, height]);
    (lies && ends(x, width, whole[0]) && ends(y, height, whole[1])).then_some(Window { x, y, width, height })
}
