//! What a person can have done with a document, while the server goes on.

use super::analyst::Meaning;
use super::documents::Key;
use super::render;
use super::requests::read;
use super::view::View;
use super::work::{Answer, Failure, Told, guarded};
use crate::cli::interrupt::Interrupt;
use crossbeam_channel::{Receiver, Sender, unbounded};
use gen_lsp_types::{ExecuteCommandParams, Uri};
use lsp_server::{ErrorCode, RequestId};
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::thread::Builder;

/// Makes the picture.
pub const RENDER: &str = "rtc.render";
/// Shows the picture while the document is edited.
pub const PREVIEW: &str = "rtc.startPreview";
/// All of them.
pub const ALL: [&str; 2] = [PREVIEW, RENDER];

/// The bytes of stack that making a picture may take.
const STACK: usize = 64 << 20;

/// What a command is about.
#[derive(Clone, Debug, Deserialize)]
pub struct About {
    /// The document.
    pub uri: Uri,
    /// With which of its cameras.
    #[serde(default)]
    pub camera: Option<String>,
}

/// A command that is being done.
pub struct Order {
    /// Of the request.
    pub id: RequestId,
    /// What it is about.
    pub about: About,
    /// The document.
    pub key: Key,
    /// What was known when it came.
    pub view: Arc<View>,
    /// Whether nobody wants it any more.
    pub cancelled: Arc<AtomicBool>,
    /// Who hears of it.
    pub told: Sender<Told>,
    /// Who tidies up where the process ends.
    pub interrupt: Interrupt,
}

/// Reads what is to be done: the command, and what it is about. A bare address does as well.
pub fn wanted(params: Value) -> Answer<(String, About)> {
    let ExecuteCommandParams { command, arguments, .. } = read(params)?;
    if !ALL.contains(&command.as_str()) {
        let message = format!("there is no command `{command}`");
        return Err(Failure::new(ErrorCode::InvalidParams, message));
    }
    let about = match arguments.unwrap_or_default().into_iter().next() {
        Some(Value::String(uri)) => About { uri: uri.into(), camera: None },
        Some(about) => read(about)?,
        None => {
            let message = format!("`{command}` wants the address of a document");
            return Err(Failure::new(ErrorCode::InvalidParams, message));
        }
    };
    Ok((command, about))
}

/// Refuses a camera that a document does not have. Of one with errors it is not known which it has.
pub fn has(meaning: &Meaning, camera: &str) -> Answer<()> {
    let is_there = |cameras: &[String]| cameras.iter().any(|known| known == camera);
    let Some(cameras) = meaning.analysis.cameras().filter(|cameras| !is_there(cameras)) else {
        return Ok(());
    };
    let there = match cameras {
        [] => "none has a name".to_string(),
        [name] => format!("there is `{name}`"),
        names => format!("there are `{}`", names.join("`, `")),
    };
    Err(Failure::plain(format!("no camera is called `{camera}`: {there}")))
}

/// The pictures that are asked for. One thread makes them one after the other, since each takes all of the machine.
#[derive(Default)]
pub struct Renders {
    orders: Option<Sender<Order>>,
    /// The request with which the picture of a document was asked for last.
    by_document: BTreeMap<Key, RequestId>,
}

impl Renders {
    /// Has a picture made, and told of when it is done. The request that it takes the place of, which asked for a picture of
    /// the same document.
    pub fn start(&mut self, order: Order) -> Answer<Option<RequestId>> {
        let orders = match &mut self.orders {
            Some(orders) => orders,
            none => none.insert(start()?),
        };
        let before = self.by_document.insert(order.key.clone(), order.id.clone());
        // As many wait as requests may.
        let _ = orders.send(order);
        Ok(before)
    }

    /// A request is answered.
    pub fn forget(&mut self, id: &RequestId) {
        self.by_document.retain(|_, other| other != id);
    }
}

/// Starts the thread that makes pictures.
fn start() -> Answer<Sender<Order>> {
    let (sender, orders) = unbounded();
    let work = move || make_all(&orders);
    let started = Builder::new().name("render".into()).stack_size(STACK).spawn(work);
    let failure = |error| Failure::plain(format!("cannot start a thread: {error}"));
    started.map(|_| sender).map_err(failure)
}

/// Until nobody asks any more.
fn make_all(orders: &Receiver<Order>) {
    for order in orders {
        let answer = guarded(|| render::render(&order)).and_then(|answer| answer);
        // Nobody listens at the end.
        let _ = order.told.send(Told::Answered(order.id, answer, order.cancelled));
    }
}
