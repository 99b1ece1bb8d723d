//! The talk with one page.
//!
//! A page is told what is new once it has taken what came before, and then only the newest: one that is slow misses what
//! came in between, and nobody waits for it.

use super::super::hub::{Known, Mask, Request, Status};
use super::Shared;
use super::heard::{self, Heard, MOST_BYTES};
use super::tiles::{self, Sent};
use axum::extract::WebSocketUpgrade;
use axum::extract::ws::{Message, WebSocket};
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use rt_lang::scene::Tonemap;
use rt_lang::units::UNITS;
use serde::Serialize;
use serde_json::{Value, json};
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{mpsc, oneshot};

/// A page that takes nothing for so long is gone.
const PATIENCE: Duration = Duration::from_secs(30);

/// Answers that may wait to be sent.
const ANSWERS: usize = 64;

/// The page is gone.
struct Gone;

/// Begins the talk, if one more page can be served.
pub fn answer(shared: Arc<Shared>, upgrade: WebSocketUpgrade) -> Response {
    let Ok(seat) = shared.seats.clone().try_acquire_owned() else {
        return (StatusCode::SERVICE_UNAVAILABLE, "Too many pages are open.\n").into_response();
    };
    let upgrade = upgrade.max_message_size(MOST_BYTES).max_frame_size(MOST_BYTES);
    upgrade.on_upgrade(async move |socket| {
        let (answers, waiting) = mpsc::channel(ANSWERS);
        let mut talk = Talk { socket, shared, answers, status: None, sent: None };
        // It ends when the page goes.
        let _ = talk.go_on(waiting).await;
        drop(seat);
    })
}

struct Talk {
    socket: WebSocket,
    shared: Arc<Shared>,
    answers: mpsc::Sender<Answer>,
    /// What the page knows.
    status: Option<Arc<Status>>,
    sent: Option<Sent>,
}

/// What is sent at the end of a question.
type Answer = Vec<Message>;

impl Talk {
    async fn go_on(&mut self, mut waiting: mpsc::Receiver<Answer>) -> Result<(), Gone> {
        let mut news = self.shared.hub.subscribe();
        self.send(text(&self.hello())).await?;
        self.tell().await?;
        loop {
            tokio::select! {
                changed = news.changed() => {
                    changed.map_err(|_| Gone)?;
                    self.tell().await?;
                }
                message = self.socket.recv() => match message {
                    Some(Ok(Message::Text(text))) => self.hear(&text).await?,
                    // Pings are answered by the library.
                    Some(Ok(Message::Ping(_) | Message::Pong(_))) => {}
                    Some(Ok(Message::Binary(_))) => self.send(misunderstood("not understood: bytes")).await?,
                    Some(Ok(Message::Close(_)) | Err(_)) | None => return Err(Gone),
                },
                Some(answer) = waiting.recv() => {
                    for message in answer {
                        self.send(message).await?;
                    }
                }
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

    /// Does what the page says.
    async fn hear(&mut self, said: &str) -> Result<(), Gone> {
        let hub = &self.shared.hub;
        match heard::read(said) {
            Err(why) => return self.send(misunderstood(&why)).await,
            Ok(Heard::Set { name, value }) => hub.ask(Request::Set { name, value }),
            Ok(Heard::Crop { window }) => hub.ask(Request::Crop(window)),
            Ok(Heard::Pause { on }) => hub.ask(Request::Pause(on)),
            Ok(Heard::Write { id, name }) => {
                self.ask(
                    |reply| Request::Write { name, reply },
                    move |answer| vec![text(&wrote(id, answer))],
                );
            }
            Ok(Heard::Why { id, x, y, patient }) => {
                self.ask(
                    |reply| Request::Why { x, y, patient, reply },
                    move |answer| vec![text(&why(id, answer))],
                );
            }
            Ok(Heard::Light { id, file, line, column }) => {
                self.ask(
                    |reply| Request::Light { file, line, column, reply },
                    move |mask| lit(id, mask.flatten()),
                );
            }
            Ok(Heard::Open { file, line, column }) => {
                let files = &hub.status().files;
                if let Err(why) = self.shared.editor.open(&file, line, column, files) {
                    return self.send(misunderstood(&why)).await;
                }
            }
        }
        Ok(())
    }

    /// Asks the engine, and sends what comes of it when it comes.
    fn ask<T: Send + 'static>(
        &self,
        request: impl FnOnce(oneshot::Sender<T>) -> Request,
        answer: impl FnOnce(Option<T>) -> Answer + Send + 'static,
    ) {
        let (reply, coming) = oneshot::channel();
        self.shared.hub.ask(request(reply));
        let answers = self.answers.clone();
        tokio::spawn(async move {
            let told = answer(coming.await.ok());
            // The page may be gone.
            let _ = answers.send(told).await;
        });
    }

    async fn send(&mut self, message: Message) -> Result<(), Gone> {
        match tokio::time::timeout(PATIENCE, self.socket.send(message)).await {
            Ok(Ok(())) => Ok(()),
            _ => Err(Gone),
        }
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

fn misunderstood(message: &str) -> Message {
    text(&json!({ "type": "error", "message": message }))
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
fn lit(id: u32, mask: Option<Mask>) -> Answer {
    let mut answer = vec![text(&json!({ "type": "light", "id": id, "ok": mask.is_some() }))];
    answer.extend(mask.map(|mask| Message::Binary(tiles::mask(id, &mask).into())));
    answer
}
