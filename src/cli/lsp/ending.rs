//! The end of the process where the client does not bring it about: it is gone, or takes nothing any more.

use crate::cli::Exit;
use crate::cli::interrupt::Interrupt;
use serde_json::Value;
use std::thread::{Builder, sleep};
use std::time::Duration;

/// How often it is looked whether the client is there.
const PERIOD: Duration = Duration::from_secs(1);

/// How long the process may take to end by itself.
pub const PATIENCE: Duration = Duration::from_secs(2);

/// Ends the process where it has not done so by itself a while after there was nobody left to serve. Whoever waits until the
/// client takes a message may wait for ever.
pub fn end_soon(interrupt: &Interrupt) -> ! {
    sleep(PATIENCE);
    interrupt.close();
    std::process::exit(Exit::Diagnostics as i32)
}

/// Tells when the client is gone, by the number of its process as `initialize` has it, and ends with it. What cannot be found
/// at the beginning is not looked for: the number may be of another machine, or of one within this.
pub fn with_client(params: &Value, interrupt: &Interrupt, gone: impl FnOnce() + Send + 'static) {
    let process = params.get("processId").and_then(Value::as_i64).and_then(|id| i32::try_from(id).ok());
    let Some(process) = process.filter(|process| *process > 0 && is_there(*process)) else { return };
    let interrupt = interrupt.clone();
    let watch = move || {
        while is_there(process) {
            sleep(PERIOD);
        }
        gone();
        end_soon(&interrupt)
    };
    // Without it the end of the input tells.
    let _ = Builder::new().name("client".into()).spawn(watch);
}

/// Whether there is a process, as far as the system tells. One of somebody else is there as well.
#[cfg(unix)]
fn is_there(process: i32) -> bool {
    use rustix::io::Errno;
    use rustix::process::{Pid, test_kill_process};
    Pid::from_raw(process).is_some_and(|process| test_kill_process(process) != Err(Errno::SRCH))
}

#[cfg(not(unix))]
fn is_there(_: i32) -> bool {
    false
}
