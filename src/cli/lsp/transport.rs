//! Standard input and output as a connection: what a thread reads, and what another writes.
//!
//! Both queues are short. A client that reads nothing is not answered without end, and one that writes faster than it is
//! answered waits.

use super::ending::{PATIENCE, end_soon};
use super::frame::{self, Frame};
use super::message::{self, Refusal};
use crate::cli::interrupt::Interrupt;
use crossbeam_channel::{Receiver, Sender, bounded};
use gen_lsp_types as lsp;
use lsp_server::{Connection, Message, Notification};
use std::io::{self, BufReader, stdin, stdout};
use std::thread::Builder;

/// Messages that wait in one direction.
const QUEUE: usize = 256;

/// How much stack writes an answer: those of selections lie deep in each other.
const STACK: usize = 8 << 20;

/// What writes. It ends once the connection is gone and all that was sent is written.
pub struct Writer {
    ended: Receiver<()>,
}

impl Writer {
    /// Waits for its end, but not for ever: a client may take nothing any more.
    pub fn finish(self) {
        // Nothing is sent: it goes with the thread.
        let _ = self.ended.recv_timeout(PATIENCE);
    }
}

/// A connection over standard input and output, and what writes. Behind the end of the input the process ends soon.
///
/// # Errors
///
/// Where the system gives no more threads.
pub fn start(interrupt: &Interrupt) -> io::Result<(Connection, Writer)> {
    let (read, receiver) = bounded(QUEUE);
    let (sender, written) = bounded(QUEUE);
    let (ends, ended) = bounded::<()>(0);
    let interrupt = interrupt.clone();
    Builder::new().name("read".into()).spawn(move || {
        read_all(read);
        end_soon(&interrupt)
    })?;
    Builder::new().name("write".into()).stack_size(STACK).spawn(move || {
        write_all(&written);
        drop(ends);
    })?;
    Ok((Connection { sender, receiver }, Writer { ended }))
}

/// Until the input ends or nobody listens.
fn read_all(sender: Sender<Message>) {
    let mut input = BufReader::new(stdin());
    while let Ok(Some(frame)) = frame::read(&mut input) {
        let read = match frame {
            Frame::Body(body) => message::read(&body),
            Frame::Refused(reason) => Err(Refusal::unreadable(reason)),
            Frame::TooLong(length) => {
                // Whoever opened such a document sees nothing else of it.
                let _ = frame::write(&mut stdout().lock(), &message::body(&too_long(length)));
                let most = frame::MOST_BODY;
                Err(Refusal::unreadable(format!("a message has at most {most} bytes, this one has {length}")))
            }
        };
        let goes_on = match read {
            Ok(message) => sender.send(message).is_ok(),
            Err(refusal) => frame::write(&mut stdout().lock(), &refusal.body()).is_ok(),
        };
        if !goes_on {
            return;
        }
    }
}

/// Tells a person that what was sent is not followed.
fn too_long(length: u64) -> Message {
    let mebibytes = |bytes: u64| bytes.div_ceil(1 << 20);
    let message = format!(
        "rtc does not follow a document or an edit of {} MiB: {} MiB are the most. Split it by `import`, or read its numbers with \
         `table`; a document that was open already is followed again once it is closed and opened.",
        mebibytes(length),
        mebibytes(frame::MOST_BODY)
    );
    let params = lsp::ShowMessageParams { kind: lsp::MessageType::Warning, message };
    Notification::new(lsp::LspNotificationMethod::WindowShowMessage.as_str().into(), params).into()
}

/// Until everything is written or nobody reads.
fn write_all(messages: &Receiver<Message>) {
    for message in messages {
        if frame::write(&mut stdout().lock(), &message::body(&message)).is_err() {
            return;
        }
    }
}
