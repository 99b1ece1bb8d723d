//! Ctrl-C and requests to end: whatever is going on, the process ends soon and leaves no torn file.

use super::Exit;
use super::terminal::Terminal;
use rt_lang::render::Control;
use std::collections::BTreeSet;
use std::io;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// How long the work may take to stop by itself before the process is ended.
const GRACE: Duration = Duration::from_millis(40);

/// Whether the process is asked to end, and what to tidy up then.
#[derive(Clone, Default)]
pub struct Interrupt {
    /// The render that is to stop first.
    control: Arc<Mutex<Option<Arc<Control>>>>,
    unfinished: Arc<Mutex<BTreeSet<PathBuf>>>,
}

impl Interrupt {
    /// Listens for SIGINT, SIGTERM and SIGHUP.
    pub fn install(terminal: Terminal) -> Interrupt {
        let interrupt = Interrupt::default();
        let handler = interrupt.clone();
        // Without a handler the signals end the process all the same, if less tidily.
        let _ = ctrlc::set_handler(move || handler.end(terminal));
        interrupt
    }

    /// Stops this render, and no earlier one, when the process is asked to end.
    pub fn watch(&self, control: Arc<Control>) {
        *lock(&self.control) = Some(control);
    }

    /// Waits for the end that was asked for.
    pub fn wait(&self) -> ! {
        loop {
            std::thread::park();
        }
    }

    /// Makes a file that is removed should the process be asked to end before [`Interrupt::settle`].
    pub fn create<T>(&self, make: impl FnOnce() -> io::Result<(T, PathBuf)>) -> io::Result<T> {
        let mut unfinished = lock(&self.unfinished);
        let (made, path) = make()?;
        unfinished.insert(path);
        Ok(made)
    }

    /// Gives a file its final place, or removes it, with no chance to be interrupted between.
    pub fn settle<T>(&self, path: &PathBuf, finish: impl FnOnce() -> T) -> T {
        let mut unfinished = lock(&self.unfinished);
        let finished = finish();
        unfinished.remove(path);
        finished
    }

    fn end(&self, terminal: Terminal) {
        let control = lock(&self.control).clone();
        if let Some(control) = control {
            control.cancel();
            std::thread::sleep(GRACE);
        }
        // Held until the process is gone, so that nobody makes or moves a file from here on.
        let unfinished = lock(&self.unfinished);
        for path in unfinished.iter() {
            let _ = std::fs::remove_file(path);
        }
        if terminal.interactive {
            // Past the progress bar.
            terminal.line("");
        }
        terminal.line("interrupted");
        std::process::exit(Exit::Interrupted as i32);
    }
}

/// What the locks guard is whole at any time, also after a panic.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
