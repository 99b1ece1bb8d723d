//! The picture in the making, as a file.

use super::super::hub::Frame;
use super::super::writer::picture;
use super::Shared;
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use rt_lang::output::{self, Depth, Facts, Format};
use rt_lang::scene::Tonemap;
use std::path::Path;

/// What is asked for. What is not said is as the scene says it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Saved {
    format: Format,
    stops: Option<f64>,
    tonemap: Option<Tonemap>,
}

impl Saved {
    /// What a name and a query such as `stops=1.5&tonemap=agx` ask for; none where the name is not a picture's.
    pub fn named(name: &str, query: &str) -> Option<Result<Saved, StatusCode>> {
        let format = match name {
            "picture.png" => Format::Png,
            "picture.exr" => Format::Exr,
            _ => return None,
        };
        let mut saved = Saved { format, stops: None, tonemap: None };
        for part in query.split('&').filter(|part| !part.is_empty()) {
            let known = match part.split_once('=') {
                Some(("stops", value)) => {
                    saved.stops = value.parse().ok().filter(|stops: &f64| stops.is_finite());
                    saved.stops.is_some()
                }
                Some(("tonemap", value)) => {
                    saved.tonemap = Tonemap::from_word(value);
                    saved.tonemap.is_some()
                }
                _ => false,
            };
            if !known {
                return Some(Err(StatusCode::BAD_REQUEST));
            }
        }
        Some(Ok(saved))
    }

    fn extension(self) -> &'static str {
        if self.format == Format::Exr { "exr" } else { "png" }
    }
}

/// The newest picture as a file.
pub async fn answer(shared: &Shared, saved: Saved) -> Response {
    let hub = &shared.hub;
    // It is never closed.
    let _turn = shared.saving.acquire().await;
    let Some(frame) = hub.frame().filter(|frame| frame.step == 1) else {
        return (StatusCode::SERVICE_UNAVAILABLE, "There is no picture yet.\n").into_response();
    };
    let name = format!("{}.{}", stem(&hub.status().scene), saved.extension());
    // Large pictures take a while, and others are served on this thread.
    let encoded = tokio::task::spawn_blocking(move || encode(&frame, saved)).await;
    match encoded {
        Ok(Ok(bytes)) => {
            let media = if saved.format == Format::Exr { "image/x-exr" } else { "image/png" };
            let disposition = format!("attachment; filename=\"{name}\"");
            let headers = [(header::CONTENT_TYPE, media), (header::CONTENT_DISPOSITION, &disposition)];
            (headers, bytes).into_response()
        }
        Ok(Err(reason)) => (StatusCode::INTERNAL_SERVER_ERROR, reason).into_response(),
        Err(_) => StatusCode::INTERNAL_SERVER_ERROR.into_response(),
    }
}

fn encode(frame: &Frame, saved: Saved) -> Result<Vec<u8>, String> {
    let facts = Facts {
        stops: saved.stops.or(frame.facts.stops),
        tonemap: saved.tonemap.or(frame.facts.tonemap),
        ..frame.facts.clone()
    };
    let encoded = output::encode(&picture(frame), &facts, saved.format, Depth::Eight);
    encoded.map_err(|reason| reason.to_string())
}

/// The name of the scene's file, as far as it can stand in a header.
fn stem(scene: &str) -> String {
    let stem = Path::new(scene).file_stem().unwrap_or_default().to_string_lossy();
    let plain = |c: char| if c.is_ascii_alphanumeric() || "-_.".contains(c) { c } else { '_' };
    let name: String = stem.chars().map(plain).collect();
    if name.is_empty() { "picture".into() } else { name }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_query_tells_how_to_develop() {
        let named = |query| Saved::named("picture.png", query).unwrap();
        let plain = Saved { format: Format::Png, stops: None, tonemap: None };
        assert_eq!(named(""), Ok(plain));
        let chosen = Saved { stops: Some(-1.5), tonemap: Some(Tonemap::Agx), ..plain };
        assert_eq!(named("stops=-1.5&tonemap=agx"), Ok(chosen));
        for wrong in ["stops=bright", "stops=inf", "tonemap=", "x=1", "stops"] {
            assert_eq!(named(wrong), Err(StatusCode::BAD_REQUEST), "{wrong}");
        }
        assert_eq!(Saved::named("picture.gif", ""), None);
    }

    #[test]
    fn names_stand_in_headers() {
        assert_eq!(stem("examples/one two\".rt"), "one_two_");
        assert_eq!(stem(""), "picture");
    }
}
