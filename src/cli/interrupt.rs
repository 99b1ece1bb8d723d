//! Ctrl-C and requests to end: whatever is going on, the process ends soon and leaves no torn file. SIGUSR1: it keeps what it has.

use super::Exit;
use super::terminal::Terminal;
use rt_lang::render::Control;
use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::path::PathBuf;
use std::process::{Child, ExitStatus};
use std::sync::atomic::{AtomicBool, Ordering::SeqCst};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, TryLockError};
use std::time::{Duration, Instant};

/// How long the work may take to stop by itself before the process is ended.
const GRACE: Duration = Duration::from_millis(40);

/// How often it is looked whether a program has ended.
const PERIOD: Duration = Duration::from_millis(10);

/// How long it is waited for files that are being made or moved: a disk that does not answer must not keep the process.
const PATIENCE: Duration = Duration::from_secs(2);

/// Whether the process is asked to end, and what to tidy up then.
#[derive(Clone, Debug, Default)]
pub struct Interrupt {
    /// The render that is to stop first.
    control: Arc<Mutex<Option<Arc<Control>>>>,
    unfinished: Arc<Mutex<BTreeSet<PathBuf>>>,
    /// Programs that work for this one, and end with it.
    children: Arc<Mutex<BTreeMap<u32, Child>>>,
    /// Whether it was asked to end.
    asked: Arc<AtomicBool>,
    /// Whether the work under way ends the process when it was asked to.
    keeps: Arc<AtomicBool>,
    /// What was kept of the picture at work, in words.
    said: Arc<Mutex<Option<String>>>,
    /// Whether it was asked to keep what there is, and not to end.
    requested: Arc<AtomicBool>,
}

impl Interrupt {
    /// Listens for SIGINT, SIGTERM and, unless it is to be ignored, SIGHUP.
    pub fn install(terminal: Terminal) -> Interrupt {
        let interrupt = Interrupt::default();
        let handler = interrupt.clone();
        // Unheard, the signals end the process all the same, if less tidily.
        let _ = listen(move || handler.end(terminal));
        interrupt
    }

    /// Stops this render, and no earlier one, when the process is asked to end, or was already.
    pub fn watch(&self, control: Arc<Control>) {
        *lock(&self.control) = Some(control.clone());
        // Who asks sets this first, and then looks for a render: one of the two finds the other.
        if self.asked.load(SeqCst) {
            control.cancel();
        }
    }

    /// Takes SIGUSR1 for the request to keep what there is: it would end the process.
    pub fn heed_requests(&self) {
        #[cfg(unix)]
        {
            // Where it cannot be heeded it ends the process.
            let _ = signal_hook::flag::register(signal_hook::consts::SIGUSR1, self.requested.clone());
        }
    }

    /// Whether that was requested since this was asked last.
    pub fn is_requested(&self) -> bool {
        self.requested.swap(false, SeqCst)
    }

    /// From here on who is asked to end leaves that to the work under way, which keeps what there is and then calls
    /// [`Interrupt::kept`]. Asked twice, the process ends at once.
    pub fn keep(&self) {
        *lock(&self.said) = None;
        self.keeps.store(true, SeqCst);
    }

    /// Ends the process if that was asked for, and says what was kept.
    pub fn kept(&self, terminal: Terminal, said: Option<String>) {
        self.keeps.store(false, SeqCst);
        *lock(&self.said) = said.clone();
        // Asked before, nobody else does it.
        if self.asked.load(SeqCst) {
            self.leave(terminal, said)
        }
    }

    /// Waits for the end that was asked for.
    pub fn wait(&self) -> ! {
        loop {
            std::thread::park();
        }
    }

    /// Makes a file or a folder that is removed should the process be asked to end before [`Interrupt::settle`].
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

    /// Removes what is unfinished where the process ends by itself while others are at work: from here on nobody makes a file
    /// or gives one its place.
    pub fn close(&self) {
        let unfinished = lock(&self.unfinished);
        remove(&unfinished);
        // Held until the process is gone.
        std::mem::forget(unfinished);
    }

    /// Ends a program when this one is asked to end, before what it writes is removed. Gives its number.
    pub fn end_with(&self, child: Child) -> u32 {
        let id = child.id();
        lock(&self.children).insert(id, child);
        id
    }

    /// Waits until that program ends by itself, and tells how; none where it is gone.
    pub fn wait_for_child(&self, id: u32) -> io::Result<Option<ExitStatus>> {
        loop {
            // Not held while waiting, so that it can be ended.
            let mut children = lock(&self.children);
            let Some(child) = children.get_mut(&id) else { return Ok(None) };
            let status = child.try_wait();
            if !matches!(status, Ok(None)) {
                children.remove(&id);
                return status;
            }
            drop(children);
            std::thread::sleep(PERIOD);
        }
    }

    /// Ends that program at once.
    pub fn end_child(&self, id: u32) {
        if let Some(child) = lock(&self.children).remove(&id) {
            kill(child);
        }
    }

    fn end(&self, terminal: Terminal) {
        let again = self.asked.swap(true, SeqCst);
        let control = lock(&self.control).clone();
        if let Some(control) = &control {
            control.cancel();
        }
        if self.keeps.load(SeqCst) && !again {
            return;
        }
        if control.is_some() {
            std::thread::sleep(GRACE);
        }
        self.leave(terminal, None)
    }

    fn leave(&self, terminal: Terminal, said: Option<String>) -> ! {
        // Held until the process is gone, so that nobody makes or moves a file from here on.
        let unfinished = held_soon(&self.unfinished);
        std::mem::take(&mut *lock(&self.children)).into_values().for_each(kill);
        if let Some(unfinished) = &unfinished {
            remove(unfinished);
        }
        if terminal.interactive {
            // Past the progress bar.
            terminal.line("");
        }
        // What was kept before stays kept, whatever was at work since.
        let said = said.or_else(|| held_soon(&self.said).and_then(|said| said.clone()));
        let kept = said.map_or(String::new(), |said| format!("; {said}"));
        terminal.line(&format!("interrupted{kept}"));
        std::process::exit(Exit::Interrupted as i32);
    }
}

/// Calls this, on a thread of its own, whenever the process is asked to end.
#[cfg(unix)]
fn listen(heard: impl Fn() + Send + 'static) -> io::Result<()> {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    let heeded = [SIGINT, SIGTERM, SIGHUP].into_iter().filter(|signal| *signal != SIGHUP || !ignores(SIGHUP));
    let mut signals = signal_hook::iterator::Signals::new(heeded)?;
    let listener = move || signals.forever().for_each(|_| heard());
    std::thread::Builder::new().name("signals".into()).spawn(listener).map(drop)
}

#[cfg(not(unix))]
fn listen(heard: impl Fn() + Send + 'static) -> io::Result<()> {
    ctrlc::set_handler(heard).map_err(io::Error::other)
}

/// Whether who started the process has it ignore a signal, as `nohup` does. Only Linux tells.
#[cfg(unix)]
fn ignores(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    mask.is_some_and(|mask| mask >> (signal - 1) & 1 == 1)
}

/// Removes files, and folders with what is in them, as far as they are there.
fn remove(paths: &BTreeSet<PathBuf>) {
    for path in paths {
        let _ = if path.is_dir() { std::fs::remove_dir_all(path) } else { std::fs::remove_file(path) };
    }
}

/// What a mutex guards; none where it is not free in time.
fn held_soon<T>(mutex: &Mutex<T>) -> Option<MutexGuard<'_, T>> {
    let deadline = Instant::now() + PATIENCE;
    loop {
        match mutex.try_lock() {
            Ok(held) => return Some(held),
            Err(TryLockError::Poisoned(poisoned)) => return Some(poisoned.into_inner()),
            Err(TryLockError::WouldBlock) if Instant::now() >= deadline => return None,
            Err(TryLockError::WouldBlock) => std::thread::sleep(PERIOD),
        }
    }
}

/// Ends a program. One that has ended is none the worse for it.
fn kill(mut child: Child) {
    let _ = child.kill().and_then(|()| child.wait());
}

/// What the locks guard is whole at any time, also after a panic.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_render_that_begins_when_the_end_was_asked_for_stops() {
        let interrupt = Interrupt::default();
        let before = Arc::new(Control::new());
        interrupt.watch(before.clone());
        assert!(!before.is_cancelled());
        interrupt.asked.store(true, SeqCst);
        let next = Arc::new(Control::new());
        interrupt.watch(next.clone());
        assert!(next.is_cancelled());
    }

    #[test]
    fn what_does_not_answer_is_not_waited_for() {
        let mutex = Mutex::new(1);
        let held = lock(&mutex);
        assert!(std::thread::scope(|scope| scope.spawn(|| held_soon(&mutex).is_none()).join().unwrap()));
        drop(held);
        assert_eq!(held_soon(&mutex).as_deref(), Some(&1));
    }
}
