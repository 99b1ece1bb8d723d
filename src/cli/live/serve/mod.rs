//! `rtc watch --serve`: one page that shows the picture in the making, for this machine alone.
//!
//! | module | what it holds |
//! |---|---|
//! | [`guard`] | who may ask, and for what |
//! | [`token`] | the secret in the address |
//! | [`socket`] | the talk with one page |
//! | [`heard`] | what a page may say |
//! | [`tiles`] | pictures as half floats |
//! | [`save`] | pictures as files |
//!
//! The page itself is in `assets`: plain files that are part of the binary, and the only ones that can be read.

mod guard;
mod heard;
mod save;
mod socket;
mod tiles;
mod token;

use super::super::{Problem, plain};
use super::editor::Editor;
use super::hub::Hub;
use axum::Router;
use axum::body::Body;
use axum::extract::{FromRequestParts, Request, State, WebSocketUpgrade};
use axum::http::{HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::serve::ListenerExt;
use guard::{Guard, Wish};
use std::net::{Ipv4Addr, SocketAddr, TcpListener};
use std::sync::Arc;
use tokio::sync::Semaphore;

/// The port that is taken where none is asked for and it is free, so that a page finds the next run again.
const USUAL_PORT: u16 = 4877;

/// The most pages that are served at once.
const MOST_PAGES: usize = 8;

/// Where a page is served, and what a click on a place does.
pub struct Wanted {
    /// An address of this machine; with port 0 on a port that is free.
    pub address: SocketAddr,
    /// How places are opened.
    pub editor: Editor,
}

/// What all pages share.
struct Shared {
    hub: Arc<Hub>,
    guard: Guard,
    editor: Editor,
    /// One for each page that may come.
    seats: Arc<Semaphore>,
    /// One, for pictures that are saved: each takes memory.
    saving: Semaphore,
}

/// Serves the page from a thread of its own until the process ends. Gives its address, secret included.
pub fn start(hub: Arc<Hub>, wanted: Wanted) -> Result<String, Problem> {
    let listener = listen(wanted.address)?;
    let address = listener.local_addr().map_err(|error| refused(wanted.address, &error))?;
    let token = token::for_port(address.port())
        .map_err(|error| Problem::new(format!("the system gives no random numbers: {error}")))?;
    let url = format!("http://{address}/{token}/");
    let shared = Arc::new(Shared {
        hub,
        guard: Guard::new(address, token),
        editor: wanted.editor,
        seats: Arc::new(Semaphore::new(MOST_PAGES)),
        saving: Semaphore::new(1),
    });
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let runtime = runtime.map_err(|error| refused(address, &error))?;
    let serve = move || {
        runtime.block_on(async {
            // Both fail only as the process runs out of files, and then nothing is served any more.
            let Ok(listener) = tokio::net::TcpListener::from_std(listener) else { return };
            // What is small is sent at once, also behind what is large.
            let listener = listener.tap_io(|stream| {
                let _ = stream.set_nodelay(true);
            });
            let router = Router::new().fallback(answer).with_state(shared);
            let _ = axum::serve(listener, router).await;
        });
    };
    std::thread::Builder::new()
        .name("preview".into())
        .spawn(serve)
        .map_err(|error| refused(address, &error))?;
    Ok(url)
}

/// Listens where it is asked for, or on the usual port, or on a free one.
fn listen(address: SocketAddr) -> Result<TcpListener, Problem> {
    let usual = SocketAddr::from((Ipv4Addr::LOCALHOST, USUAL_PORT));
    let wanted = if address.port() == 0 { TcpListener::bind(usual).ok() } else { None };
    let listener = match wanted {
        Some(listener) => listener,
        None => TcpListener::bind(address).map_err(|error| refused(address, &error))?,
    };
    listener.set_nonblocking(true).map_err(|error| refused(address, &error))?;
    Ok(listener)
}

fn refused(address: SocketAddr, error: &std::io::Error) -> Problem {
    Problem::new(format!("the page cannot be served on {address}: {}", plain(error)))
}

/// Answers one request.
async fn answer(State(shared): State<Arc<Shared>>, request: Request) -> Response {
    let (mut parts, _) = request.into_parts();
    let mut response = match shared.guard.wish(&parts) {
        Err(status) => (status, reason(status)).into_response(),
        Ok(Wish::Redirect(to)) => (StatusCode::PERMANENT_REDIRECT, [(header::LOCATION, to)]).into_response(),
        Ok(Wish::Asset(asset)) => ([(header::CONTENT_TYPE, asset.media)], asset.text).into_response(),
        Ok(Wish::Picture(picture)) => save::answer(&shared, picture).await,
        Ok(Wish::Socket) => match WebSocketUpgrade::from_request_parts(&mut parts, &()).await {
            Ok(upgrade) => socket::answer(shared, upgrade),
            Err(_) => (StatusCode::BAD_REQUEST, "this is a WebSocket").into_response(),
        },
    };
    secure(&mut response);
    response
}

fn reason(status: StatusCode) -> &'static str {
    match status {
        StatusCode::FORBIDDEN => "The address of the page has a secret in it, which `rtc watch` prints.\n",
        StatusCode::METHOD_NOT_ALLOWED => "Only GET is answered.\n",
        StatusCode::BAD_REQUEST => "This cannot be understood.\n",
        _ => "There is no such thing here.\n",
    }
}

/// Nothing but the page's own files is loaded, run or connected to, nothing is kept, nobody else sees it. No page may hold it
/// in a frame but those that Visual Studio Code makes itself, which have schemes of their own.
const HEADERS: &[(&str, &str)] = &[
    (
        "content-security-policy",
        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; connect-src 'self'; \
         base-uri 'none'; form-action 'none'; frame-ancestors vscode-webview: vscode-file:",
    ),
    ("cache-control", "no-store"),
    ("x-content-type-options", "nosniff"),
    ("referrer-policy", "no-referrer"),
    ("cross-origin-opener-policy", "same-origin"),
    ("cross-origin-resource-policy", "same-origin"),
];

fn secure(response: &mut Response<Body>) {
    for (name, value) in HEADERS {
        response.headers_mut().insert(*name, HeaderValue::from_static(value));
    }
}
