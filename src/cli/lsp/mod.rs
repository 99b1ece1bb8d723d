//! `rtc lsp`: the language server. What it knows of the language is in the library; here is the protocol.
//!
//! ```text
//! stdin ──▶ frame ──▶ message ──▶ server ──▶ work: analyst, requests ──▶ server ──▶ stdout
//!                                   │ documents, board
//! ```
//!
//! | module | what it holds |
//! |---|---|
//! | [`frame`], [`message`], [`transport`] | bytes to messages, whatever the bytes are |
//! | [`ending`] | the end of the process where nobody brings it about |
//! | [`server`] | what a message leads to, from `initialize` to `exit` |
//! | [`client`], [`capabilities`] | what the two sides can do |
//! | [`document`], [`documents`], [`uri`] | the texts as the client edits them, and their addresses |
//! | [`view`], [`world`] | what was known when something was asked, and the files around a document |
//! | [`reads`], [`events`] | which documents mean something else when a file changes |
//! | [`work`], [`analyst`] | the threads that answer, and what documents mean |
//! | [`requests`] | one question of the protocol each |
//! | [`diagnostics`], [`pages`] | what is said of documents, and where it is explained |
//! | [`edits`] | edits that make one text of another, and of several documents |
//! | [`commands`], [`render`], [`preview`] | what a person can have done |
//! | [`buffer`] | the text of a document, for the preview that changes it |

mod analyst;
mod buffer;
mod capabilities;
mod client;
mod commands;
mod diagnostics;
mod document;
mod documents;
mod edits;
mod ending;
mod events;
mod frame;
mod message;
mod pages;
mod preview;
mod reads;
mod render;
mod requests;
mod server;
mod transport;
mod uri;
mod view;
mod work;
mod world;

use super::args::Lsp;
use super::interrupt::Interrupt;
use super::{Exit, Problem, plain};
use server::Server;
#[cfg(fuzzing)]
pub use server::script;

/// Serves until the client says so or is gone.
pub fn run(arguments: &Lsp, interrupt: &Interrupt) -> Result<Exit, Problem> {
    let cannot = |error| Problem::new(format!("cannot start a thread: {}", plain(&error)));
    let root = match &arguments.root {
        None => None,
        Some(root) => Some(std::fs::canonicalize(root).map_err(|error| {
            Problem::new(format!("the root `{}` cannot be used: {}", root.display(), plain(&error)))
        })?),
    };
    let (connection, writer) = transport::start(interrupt).map_err(cannot)?;
    let exit = Server::new(connection, root, interrupt.clone()).map_err(cannot)?.run();
    // What was sent last is written before the process ends.
    writer.finish();
    Ok(exit)
}
