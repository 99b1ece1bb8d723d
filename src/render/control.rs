//! The handle by which whoever started a render watches and stops it.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};

/// Shared between the threads that render and the one that waits: cancels, and tells how far it got.
#[derive(Debug, Default)]
pub struct Control {
    cancelled: AtomicBool,
    done: AtomicU64,
    total: AtomicU64,
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
        self.cancelled.store(true, Relaxed);
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
