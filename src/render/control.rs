//! The handle by which whoever started a render watches, pauses and stops it.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Shared between the threads that render and the one that waits: pauses, cancels, and tells how far it got.
#[derive(Debug, Default)]
pub struct Control {
    cancelled: AtomicBool,
    done: AtomicU64,
    total: AtomicU64,
    paused: AtomicBool,
    /// Woken when paths may go on. Holds since when they wait, and how long they did before.
    going_on: (Mutex<(Option<Instant>, Duration)>, Condvar),
}

/// What a render yields that was told to stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cancelled;

/// How far a render got.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Camera paths traced.
    pub done: u64,
    /// Camera paths planned so far; with a noise target this grows each time the samples are doubled.
    pub total: u64,
}

impl Control {
    /// A handle that has not been used.
    pub fn new() -> Control {
        Control::default()
    }

    /// Asks the render to stop; it does after the paths that are under way.
    pub fn cancel(&self) {
        let _held = self.hold();
        self.cancelled.store(true, Relaxed);
        self.going_on.1.notify_all();
    }

    /// Lets paths wait, or go on.
    pub fn pause(&self, paused: bool) {
        let mut held = self.hold();
        let (since, before) = &mut *held;
        if let Some(since) = since.take() {
            *before += since.elapsed();
        }
        *since = paused.then(Instant::now);
        self.paused.store(paused, Relaxed);
        self.going_on.1.notify_all();
    }

    /// How long paths were to wait.
    pub fn paused_for(&self) -> Duration {
        let (since, before) = *self.hold();
        before + since.map_or(Duration::ZERO, |since| since.elapsed())
    }

    /// Waits while the render is paused.
    pub(super) fn rest(&self) {
        if !self.paused.load(Relaxed) {
            return;
        }
        let mut held = self.hold();
        while self.paused.load(Relaxed) && !self.is_cancelled() {
            held = self.going_on.1.wait(held).unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn hold(&self) -> MutexGuard<'_, (Option<Instant>, Duration)> {
        self.going_on.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether it was asked to stop.
    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Relaxed)
    }

    /// How far it got. The two numbers are read one after the other, so they may be a moment apart.
    pub fn progress(&self) -> Progress {
        Progress { done: self.done.load(Relaxed), total: self.total.load(Relaxed) }
    }

    /// Says that so many more paths will be traced.
    pub fn plan(&self, paths: u64) {
        self.total.fetch_add(paths, Relaxed);
    }

    /// Says that so many more paths have been traced.
    pub fn finish(&self, paths: u64) {
        self.done.fetch_add(paths, Relaxed);
    }
}
