//! How much work something is, whatever else the machine does meanwhile.

use std::time::Duration;

/// What this gives, and the time that it takes of a processor, on the thread that asks.
pub fn work<T>(run: impl FnOnce() -> T) -> (Duration, T) {
    let before = spent();
    let given = run();
    (spent() - before, given)
}

#[cfg(unix)]
fn spent() -> Duration {
    let spent = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    spent.try_into().unwrap()
}

/// Where threads do not tell, what passes.
#[cfg(not(unix))]
fn spent() -> Duration {
    static BEGIN: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    BEGIN.get_or_init(std::time::Instant::now).elapsed()
}
