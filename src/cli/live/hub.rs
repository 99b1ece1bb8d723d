//! What everybody who looks at a picture in the making may know, and what they may ask.
//!
//! The engine says what is new; a page, or any number of them, takes the newest when it is ready for it. Nobody waits
//! for anybody: what comes in between is never seen by the slow.

use rt_lang::output::Facts;
use rt_lang::scene::Tonemap;
use serde::Serialize;
use std::sync::mpsc;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tokio::sync::{oneshot, watch};

/// A picture at some moment.
#[derive(Debug)]
pub struct Frame {
    /// Of the text that it shows, counted from 1.
    pub generation: u64,
    /// Grows with every frame.
    pub version: u64,
    /// Width and height of the whole picture in pixels.
    pub size: [u32; 2],
    /// One that is held stands for so many pixels across and down: 8 in a first look, else 1.
    pub step: u32,
    /// The least and the most samples of a pixel.
    pub samples: [u32; 2],
    /// Linear red, green and blue in W/(m²·sr) before exposure, the standard error of their luminance (infinite below two
    /// samples), and the share that is covered; row by row from the top.
    pub pixels: Vec<[f32; 5]>,
    /// Whether lamps have changed since it was traced, so that it is a mix of the light of each.
    pub remixed: bool,
    /// How it is developed.
    pub shown: Shown,
    /// How it came about.
    pub facts: Facts,
    /// Whether parts of it may be transparent.
    pub transparent: bool,
}

impl Frame {
    /// Columns and rows that are held.
    pub fn held(&self) -> [u32; 2] {
        self.size.map(|side| side.div_ceil(self.step))
    }
}

/// What is going on.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Status {
    /// The newest text, counted from 1.
    pub generation: u64,
    /// The scene's name.
    pub scene: String,
    /// What is done now.
    pub state: State,
    /// Whether paths are to wait, as soon as there are any.
    pub paused: bool,
    /// What changed last, and what that led to.
    pub reason: Option<String>,
    /// Width and height in pixels; zeros before there was a picture.
    pub size: [u32; 2],
    /// Samples that every pixel has.
    pub samples: u32,
    /// When it is done.
    pub target: Option<Aim>,
    /// The noise reached, as a share of white.
    pub noise: Option<f64>,
    /// Seconds of tracing.
    pub seconds: f64,
    /// Seconds that are left, if that can be told.
    pub left: Option<f64>,
    /// The generation of the picture that is shown.
    pub picture: u64,
    /// How it is developed.
    pub develop: Option<Shown>,
    /// Whether lamps have changed since it was traced.
    pub remixed: bool,
    /// What the compiler says.
    pub diagnostics: Said,
    /// What can be set.
    pub params: Vec<Param>,
    /// What is traced first: left, top, width and height.
    pub crop: Option<[u32; 4]>,
    /// Defaults that were chosen.
    pub notes: Vec<String>,
    /// The files that the scene is made of, as the user names them.
    pub files: Vec<String>,
    /// Where the cursor of an editor stands that tells of it.
    pub cursor: Option<Cursor>,
}

/// A place in a file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Cursor {
    /// The file.
    pub file: String,
    /// From 1.
    pub line: u32,
    /// From 1, in characters.
    pub column: u32,
}

/// What is done now.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum State {
    /// The text is read.
    #[default]
    Compiling,
    /// Paths are traced.
    Rendering,
    /// Paths wait.
    Paused,
    /// The picture is finished.
    Done,
    /// There are errors; the last picture that was good stays.
    Error,
}

/// When a picture is done.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Aim {
    /// With so many samples a pixel.
    Samples(u32),
    /// With noise below this share of white.
    Noise(f64),
}

/// How a picture is developed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Shown {
    /// Exposure in stops.
    pub stops: f64,
    /// The curve, by its word in the language.
    #[serde(serialize_with = "word")]
    pub tonemap: Tonemap,
}

fn word<S: serde::Serializer>(tonemap: &Tonemap, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(tonemap.word())
}

/// What the compiler says.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Said {
    /// How many errors.
    pub errors: usize,
    /// How many warnings.
    pub warnings: usize,
    /// The very text of `rtc check`, without colours.
    pub text: String,
    /// Where in that text a place in a file is named.
    pub places: Vec<Mention>,
}

/// A place in a file, named in a text.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Mention {
    /// The file as the user names it.
    pub file: String,
    /// From 1.
    pub line: usize,
    /// From 1, in characters.
    pub column: usize,
    /// Where its name begins in the text, in UTF-16 units.
    pub start: usize,
    /// And where it ends.
    pub end: usize,
}

/// Something that can be set.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Param {
    /// Its name.
    pub name: String,
    /// Its type as the language writes it.
    #[serde(rename = "type")]
    pub ty: String,
    /// The words above it.
    pub doc: Option<String>,
    /// The expression in the file; empty where the file has no such param any more.
    pub default: String,
    /// The expression in force.
    pub value: String,
    /// Whether it is not the file's.
    pub set: bool,
    /// The least it may be, as written.
    pub low: Option<String>,
    /// The greatest it may be, as written.
    pub high: Option<String>,
}

impl Param {
    /// One that is set, and that the file has no more.
    pub fn gone(name: &str, value: &str) -> Param {
        Param {
            name: name.into(),
            ty: String::new(),
            doc: None,
            default: String::new(),
            value: value.into(),
            set: true,
            low: None,
            high: None,
        }
    }
}

/// Pixels of a picture, chosen or not.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mask {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// A bit a pixel, the highest of a byte first; rows begin with a byte.
    pub bits: Vec<u8>,
}

impl Mask {
    /// Chooses pixels by column and row.
    pub fn of(size: [u32; 2], chosen: impl Fn(u32, u32) -> bool) -> Mask {
        let bytes = size[0].div_ceil(8);
        let byte = |x: u32, y: u32| {
            let columns = (8 * x..(8 * x + 8).min(size[0])).zip((0..8).rev());
            columns.fold(0, |byte, (x, bit)| byte | u8::from(chosen(x, y)) << bit)
        };
        let bits = (0..size[1]).flat_map(|y| (0..bytes).map(move |x| (x, y))).map(|(x, y)| byte(x, y));
        Mask { size, bits: bits.collect() }
    }
}

/// Where an answer goes. Whoever asked may be gone.
pub type Reply<T> = oneshot::Sender<T>;

/// Why a pixel looks as it does.
#[derive(Debug, Serialize)]
pub struct Known {
    /// As `rtc why --json` has it.
    pub why: serde_json::Value,
    /// Whether more samples would tell more.
    pub more: bool,
}

/// What may be asked of the engine.
#[derive(Debug)]
pub enum Request {
    /// Files may have changed.
    Look,
    /// Sets a param to an expression; an empty one is the file's own.
    Set {
        /// The param.
        name: String,
        /// An expression of the language.
        value: String,
    },
    /// Writes the value that is set into the file as the param's default.
    Write {
        /// The param.
        name: String,
        /// Why not, if not.
        reply: Reply<Result<(), String>>,
    },
    /// Whether a value was put into the text, which may be a moment before it is seen there.
    Written {
        /// The param.
        name: String,
        /// Its new default.
        default: String,
        /// Why not, if not.
        answer: Result<(), String>,
        /// Where that goes.
        reply: Reply<Result<(), String>>,
    },
    /// Traces a window first: left, top, width and height.
    Crop(Option<[u32; 4]>),
    /// Lets paths wait, or go on.
    Pause(bool),
    /// Ends.
    End,
    /// Why a pixel looks as it does.
    Why {
        /// Column.
        x: u32,
        /// Row.
        y: u32,
        /// Whether to take all samples that there are, and not only what can be told at once.
        patient: bool,
        /// The answer, or why there is none.
        reply: Reply<Result<Known, String>>,
    },
    /// Which pixels show what stands at a place of a file.
    Light {
        /// The file as [`Status::files`] names it.
        file: String,
        /// From 1.
        line: u32,
        /// From 1; 0 is the line's first word.
        column: u32,
        /// The pixels, or why there are none.
        reply: Reply<Result<Mask, String>>,
    },
}

/// The place where engine and pages meet.
#[derive(Debug)]
pub struct Hub {
    known: Mutex<Newest>,
    version: watch::Sender<u64>,
    requests: mpsc::Sender<Request>,
    /// Whether there is nothing to look at any more.
    ended: watch::Sender<bool>,
}

#[derive(Debug, Default)]
struct Newest {
    frame: Option<Arc<Frame>>,
    status: Arc<Status>,
}

impl Hub {
    /// A place with nothing known yet, and the end at which requests arrive.
    pub fn new() -> (Arc<Hub>, mpsc::Receiver<Request>) {
        let (requests, arriving) = mpsc::channel();
        let (version, ended) = (watch::Sender::new(0), watch::Sender::new(false));
        let hub = Hub { known: Mutex::default(), version, requests, ended };
        (Arc::new(hub), arriving)
    }

    /// The newest picture.
    pub fn frame(&self) -> Option<Arc<Frame>> {
        self.lock().frame.clone()
    }

    /// What is going on.
    pub fn status(&self) -> Arc<Status> {
        self.lock().status.clone()
    }

    /// Changes whenever something is new.
    pub fn subscribe(&self) -> watch::Receiver<u64> {
        self.version.subscribe()
    }

    /// Asks the engine. Nothing comes of it once that has ended.
    pub fn ask(&self, request: Request) {
        let _ = self.requests.send(request);
    }

    /// Ends: the engine, and the page.
    pub fn end(&self) {
        self.ask(Request::End);
        self.ended.send_replace(true);
    }

    /// Waits for the end.
    pub async fn ended(&self) {
        // It fails only where nobody can end it, and so not while this is here.
        let _ = self.ended.subscribe().wait_for(|ended| *ended).await;
    }

    /// Shows a picture.
    pub fn show(&self, frame: Arc<Frame>) {
        let mut known = self.lock();
        let status = Arc::make_mut(&mut known.status);
        (status.size, status.develop, status.remixed) = (frame.size, Some(frame.shown), frame.remixed);
        status.picture = frame.generation;
        known.frame = Some(frame);
        drop(known);
        self.tell();
    }

    /// Says what is going on.
    pub fn say(&self, change: impl FnOnce(&mut Status)) {
        change(Arc::make_mut(&mut self.lock().status));
        self.tell();
    }

    fn tell(&self) {
        self.version.send_modify(|version| *version += 1);
    }

    fn lock(&self) -> MutexGuard<'_, Newest> {
        // Each of the two is replaced as a whole.
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
