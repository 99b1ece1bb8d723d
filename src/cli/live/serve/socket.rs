//! The talk with one page.
//!
//! A page is told what is new once it has taken what came before, and then only the newest: one that is slow misses what
//! came in between, and nobody waits for it. It is heard all the while: nothing that it says waits behind a picture.

use super::super::hub::{Known, Mask, Request, Status};
use super::Shared;
use super::heard::{self, Heard, MOST_BYTES};
use super::tiles::{self, Sent};
use axum::extract::WebSocketUpgrade;
use axum::extract::ws::{Message, WebSocket};
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use futures_util::stream::{SplitSink, SplitStream};
use futures_util::{SinkExt, StreamExt};
use rt_lang::scene::Tonemap;
use rt_lang::units::UNITS;
use serde::Serialize;
use serde_json::{Value, json};
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::mpsc::{self, OwnedPermit};
use tokio::sync::oneshot;

/// A page that takes nothing for so long is gone.
const PATIENCE: Duration = Duration::from_secs(30);

/// Questions of a page that are not answered yet. Until one of so many is, no more is heard of it.
const MOST_ASKED: usize = 64;

/// The page is gone.
struct Gone;

/// What is sent at the end of a question.
type Answer = Vec<Message>;

/// Begins the talk, if one more page can be served.
pub fn answer(shared: Arc<Shared>, upgrade: WebSocketUpgrade) -> Response {
    let Ok(seat) = shared.seats.clone().try_acquire_owned() else {
        return (StatusCode::SERVICE_UNAVAILABLE, "Too many pages are open.\n").into_response();
    };
    let upgrade = upgrade.max_message_size(MOST_BYTES).max_frame_size(MOST_BYTES);
    upgrade.on_upgrade(async move |socket| {
        let (mouth, ear) = socket.split();
        let (answers, waiting) = mpsc::channel(MOST_ASKED);
        let mut teller = Teller { mouth, shared: shared.clone(), waiting, status: None, sent: None };
        let mut hearer = Hearer { ear, shared, answers };
        // Both end only when the page goes.
        tokio::select! {
            _ = teller.go_on() => {}
            _ = hearer.go_on() => {}
        }
        drop(seat);
    })
}

/// Tells a page what is new.
struct Teller {
    mouth: SplitSink<WebSocket, Message>,
    shared: Arc<Shared>,
    waiting: mpsc::Receiver<Answer>,
    /// What the page knows.
    status: Option<Arc<Status>>,
    sent: Option<Sent>,
}

impl Teller {
    async fn go_on(&mut self) -> Result<(), Gone> {
        let mut news = self.shared.hub.subscribe();
        self.send(text(&self.hello())).await?;
        self.tell().await?;
        loop {
            tokio::select! {
                changed = news.changed() => {
                    changed.map_err(|_| Gone)?;
                    self.tell().await?;
                }
                Some(answer) = self.waiting.recv() => self.give(answer).await?,
            }
        }
    }

    fn hello(&self) -> Value {
        let folder = std::env::current_dir().unwrap_or_default();
        let units: Vec<Value> = UNITS.iter().map(|(name, unit)| json!([name, unit.factor])).collect();
        let tonemaps: Vec<&str> = Tonemap::WORDS.iter().map(|word| word.name).collect();
        json!({
            "type": "hello",
            "version": env!("CARGO_PKG_VERSION"),
            "folder": folder.to_string_lossy(),
            "units": units,
            "tonemaps": tonemaps,
            "editor": { "url": self.shared.editor.template(), "runs": self.shared.editor.runs() },
        })
    }

    /// Tells what the page does not know yet.
    async fn tell(&mut self) -> Result<(), Gone> {
        let status = self.shared.hub.status();
        if self.status.as_ref().is_none_or(|known| !Arc::ptr_eq(known, &status)) {
            self.send(text(&Named { name: "status", told: &*status })).await?;
            self.status = Some(status.clone());
        }
        let Some(frame) = self.shared.hub.frame() else { return Ok(()) };
        if self.sent.as_ref().is_some_and(|sent| sent.frame().version == frame.version) {
            return Ok(());
        }
        let before = self.sent.take();
        let stops = frame.shown.stops;
        let sent = Sent::next(frame, stops, before.as_ref());
        let frame = sent.frame();
        let begin = json!({ "type": "begin", "size": frame.size, "step": frame.step, "scale": sent.scale() });
        self.send(text(&begin)).await?;
        for tile in sent.tiles(before.as_ref()) {
            self.send(Message::Binary(tile.into())).await?;
            while let Ok(answer) = self.waiting.try_recv() {
                self.give(answer).await?;
            }
        }
        let end = json!({
            "type": "frame",
            "generation": frame.generation,
            "version": frame.version,
            "samples": frame.samples,
            "remixed": frame.remixed,
            "develop": frame.shown,
        });
        self.send(text(&end)).await?;
        self.sent = Some(sent);
        Ok(())
    }

    async fn give(&mut self, answer: Answer) -> Result<(), Gone> {
        for message in answer {
            self.send(message).await?;
        }
        Ok(())
    }

    async fn send(&mut self, message: Message) -> Result<(), Gone> {
        match tokio::time::timeout(PATIENCE, self.mouth.send(message)).await {
            Ok(Ok(())) => Ok(()),
            _ => Err(Gone),
        }
    }
}

/// Hears what a page says.
struct Hearer {
    ear: SplitStream<WebSocket>,
    shared: Arc<Shared>,
    answers: mpsc::Sender<Answer>,
}

impl Hearer {
    async fn go_on(&mut self) -> Result<(), Gone> {
        loop {
            match self.ear.next().await {
                Some(Ok(Message::Text(text))) => self.hear(&text).await?,
                // Pings are answered by the library.
                Some(Ok(Message::Ping(_) | Message::Pong(_))) => {}
                Some(Ok(Message::Binary(_))) => self.refuse("not understood: bytes").await?,
                Some(Ok(Message::Close(_)) | Err(_)) | None => return Err(Gone),
            }
        }
    }

    /// Does what the page says.
    async fn hear(&mut self, said: &str) -> Result<(), Gone> {
        let hub = &self.shared.hub;
        match heard::read(said) {
            Err(why) => self.refuse(&why).await?,
            Ok(Heard::Set { name, value }) => hub.ask(Request::Set { name, value }),
            Ok(Heard::Crop { window }) => hub.ask(Request::Crop(window)),
            Ok(Heard::Pause { on }) => hub.ask(Request::Pause(on)),
            Ok(Heard::Write { id, name }) => {
                let request = |reply| Request::Write { name, reply };
                self.ask(request, move |answer| vec![text(&wrote(id, answer))]).await?;
            }
            Ok(Heard::Why { id, x, y, patient }) => {
                let request = |reply| Request::Why { x, y, patient, reply };
                self.ask(request, move |answer| vec![text(&why(id, answer))]).await?;
            }
            Ok(Heard::Light { id, file, line, column }) => {
                let request = |reply| Request::Light { file, line, column, reply };
                self.ask(request, move |answer| lit(id, answer)).await?;
            }
            Ok(Heard::Open { file, line, column }) => {
                let files = &hub.status().files;
                if let Err(why) = self.shared.editor.open(&file, line, column, files) {
                    self.refuse(&why).await?;
                }
            }
        }
        Ok(())
    }

    /// Asks the engine, and sends what comes of it when it comes.
    async fn ask<T: Send + 'static>(
        &self,
        request: impl FnOnce(oneshot::Sender<T>) -> Request,
        answer: impl FnOnce(Option<T>) -> Answer + Send + 'static,
    ) -> Result<(), Gone> {
        let place = self.place().await?;
        let (reply, coming) = oneshot::channel();
        self.shared.hub.ask(request(reply));
        tokio::spawn(async move {
            let told = answer(coming.await.ok());
            place.send(told);
        });
        Ok(())
    }

    /// Says that something is not done.
    async fn refuse(&self, why: &str) -> Result<(), Gone> {
        let refusal = text(&json!({ "type": "error", "message": why }));
        self.place().await?.send(vec![refusal]);
        Ok(())
    }

    /// A place for an answer among those that wait to be sent.
    async fn place(&self) -> Result<OwnedPermit<Answer>, Gone> {
        self.answers.clone().reserve_owned().await.map_err(|_| Gone)
    }
}

/// Something with its name.
#[derive(Serialize)]
struct Named<'a, T> {
    #[serde(rename = "type")]
    name: &'static str,
    #[serde(flatten)]
    told: &'a T,
}

fn text(message: &impl Serialize) -> Message {
    // Maps with keys that are not texts are all that cannot be written, and there are none.
    Message::Text(serde_json::to_string(message).unwrap_or_default().into())
}

/// The engine has ended, or does not do this now.
const NO_ANSWER: &str = "there is no answer to this now";

fn wrote(id: u32, answer: Option<Result<(), String>>) -> Value {
    match answer.unwrap_or_else(|| Err(NO_ANSWER.into())) {
        Ok(()) => json!({ "type": "wrote", "id": id, "ok": true }),
        Err(error) => json!({ "type": "wrote", "id": id, "ok": false, "error": error }),
    }
}

fn why(id: u32, answer: Option<Result<Known, String>>) -> Value {
    match answer.unwrap_or_else(|| Err(NO_ANSWER.into())) {
        Ok(Known { why, more }) => {
            json!({ "type": "why", "id": id, "ok": true, "why": why, "more": more })
        }
        Err(error) => json!({ "type": "why", "id": id, "ok": false, "error": error }),
    }
}

/// The mask follows where there is one.
fn lit(id: u32, answer: Option<Result<Mask, String>>) -> Answer {
    match answer.unwrap_or_else(|| Err(NO_ANSWER.into())) {
        Ok(mask) => vec![
            text(&json!({ "type": "light", "id": id, "ok": true })),
            Message::Binary(tiles::mask(id, &mask).into()),
        ],
        Err(error) => vec![text(&json!({ "type": "light", "id": id, "ok": false, "error": error }))],
    }
}
